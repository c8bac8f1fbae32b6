//! One lighting state: whether a light reaches all of a patch, or none of it.

use super::verdict::{Judge, Verdict};
use crate::geometry::beam::Candidates;
use crate::geometry::{Geometry, NO_PRIMITIVE, Search};
use crate::math::V3;
use crate::render::extent::Lists;
use crate::render::frame::Frame;
use crate::render::queue::ShadowQueue;
use crate::render::tile::{Worker, milliseconds_since};
use crate::render::visibility::POINTS;
use crate::scene::light::LightKind;
use fearless_simd::{Simd, f32x8};
use std::ops::Range;
use std::time::Instant;

/// How far beyond a patch's points the beam of its shadow rays goes, as a share of their extent: curved patches bulge.
const BULGE: f32 = 1.0 / 16.0;

/// Patches that share a beam where it tells too little of more of them.
const FEW_PATCHES: usize = 4;

/// Settles the waiting shadow rays, [`POINTS`] of each patch, whose samples are numbered patch by patch. What surely
/// arrives is added to the samples; a patch in more than one state of light holds no longer.
pub(in crate::render) fn settle<S: Simd>(simd: S, frame: &Frame<'_>, worker: &mut Worker, holds: &mut [bool]) {
    let start = Instant::now();
    let mut shadows = std::mem::take(&mut worker.shadows);
    let mut lists = worker.lists.take().unwrap_or_default();
    for (light, queue) in frame.lights.iter().zip(&mut shadows) {
        if queue.len() > 0 {
            queue.pad();
            let geometry = &frame.scene.geometry;
            Settlement { light: light.kind, geometry, queue, lists: &mut lists, worker, holds }.settle(simd, frame);
        }
        queue.clear();
    }
    worker.lists = Some(lists);
    worker.shadows = shadows;
    worker.stats.stages_ms.certificate += milliseconds_since(start);
}

/// What it takes to settle the shadow rays of one light.
struct Settlement<'a> {
    light: LightKind,
    geometry: &'a Geometry,
    queue: &'a ShadowQueue,
    lists: &'a mut Lists,
    worker: &'a mut Worker,
    holds: &'a mut [bool],
}

impl Settlement<'_> {
    fn settle<S: Simd>(&mut self, simd: S, frame: &Frame<'_>) {
        let all = 0..self.queue.len();
        if !frame.plan.shadows || frame.scene.headlight {
            self.carry_out(simd, all, Verdict::Lit, None);
        } else if !self.judge(simd, frame, all.clone()) {
            let mut few = all.start..all.start;
            while few.start < all.end {
                for _ in 0..FEW_PATCHES {
                    few.end = self.end_of_patch(few.end);
                }
                if !self.judge(simd, frame, few.clone()) {
                    self.carry_out(simd, few.clone(), Verdict::Unknown, None);
                }
                few.start = few.end;
            }
        }
    }

    /// Settles the patches in a range by one beam; false if that tells nothing.
    fn judge<S: Simd>(&mut self, simd: S, frame: &Frame<'_>, range: Range<usize>) -> bool {
        let search = Search::new(&frame.scene.geometry, frame.plan.tree);
        let Some(judge) = Judge::new(simd, frame, search, self.light, self.queue, range.clone(), BULGE) else {
            return false;
        };
        match judge.judge(simd, &mut self.lists.whole, &mut self.worker.stack) {
            Verdict::Unknown => return false,
            verdict => self.carry_out(simd, range, verdict, Some(&judge)),
        }
        true
    }

    /// Does what a verdict on the patches in a range asks for, patch by patch.
    fn carry_out<S: Simd>(&mut self, simd: S, range: Range<usize>, verdict: Verdict, judge: Option<&Judge<'_>>) {
        let mut own = range.start..range.start;
        while own.start < range.end {
            own.end = self.end_of_patch(own.start);
            let patch = self.patch(own.start);
            let verdict = match judge {
                // Where a light reaches only some of the points it ends in between.
                _ if own.len() < POINTS => Verdict::Unknown,
                Some(judge) if verdict == Verdict::Listed => self.judge_patch(simd, judge, own.clone()),
                _ => verdict,
            };
            match verdict {
                Verdict::Lit => self.queue.add_gains(simd, own.clone(), &mut self.worker.color),
                Verdict::Dark => {}
                Verdict::Listed | Verdict::Unknown => self.holds[patch] = false,
            }
            own.start = own.end;
        }
    }

    /// The verdict on a patch by what can be in the way of all patches.
    fn judge_patch<S: Simd>(&mut self, simd: S, judge: &Judge<'_>, own: Range<usize>) -> Verdict {
        let Lists { whole, part } = &mut *self.lists;
        match judge.judge_part(simd, self.queue, own.clone(), whole, part) {
            // The beam is a rectangle around the patch: its corners know more.
            Verdict::Listed if lie_beside(simd, self.geometry, part, judge, self.queue, own) => Verdict::Lit,
            verdict => verdict,
        }
    }

    /// The patch of a shadow ray.
    fn patch(&self, ray: usize) -> usize {
        self.queue.sample[ray] as usize / POINTS
    }

    /// Where the rays of the patch that begins at `first` end.
    fn end_of_patch(&self, first: usize) -> usize {
        let mut end = first;
        while end < self.queue.len() && self.patch(end) == self.patch(first) {
            end += 1;
        }
        end
    }
}

/// Lanes that hold all points of a patch.
const LANES: usize = 8;

/// Whether no candidate can be in the way of a patch, by the rays to its points.
fn lie_beside<S: Simd>(
    simd: S,
    geometry: &Geometry,
    candidates: &Candidates,
    judge: &Judge<'_>,
    queue: &ShadowQueue,
    own: Range<usize>,
) -> bool {
    simd.vectorize(
        #[inline(always)]
        || {
            // The first stands for the lanes without one.
            let [mut x, mut y, mut z] = queue.origin.get(own.start).to_array().map(|first| [first; LANES]);
            let mut source = queue.source[own.start];
            for (lane, at) in own.enumerate() {
                (x[lane], y[lane], z[lane]) = queue.origin.get(at).into();
                if queue.source[at] != source {
                    source = NO_PRIMITIVE;
                }
            }
            // Rays to a curved patch do not end on a plane: of it only the patch's own surface is known to be no hindrance.
            if !geometry.is_flat(source) {
                return candidates.are_only(source);
            }
            candidates.lie_beside(simd, &judge.points(V3::<f32x8<S>>::load(simd, &x, &y, &z)), source)
        },
    )
}
