//! Shadow rays: which of a tile's light contributions arrive, and in what colour.

mod crossing;
mod verdict;

use super::frame::Frame;
use super::queue::ShadowQueue;
use super::samples::Colors;
use super::stats::CacheCounts;
use super::tile::{Worker, milliseconds_since};
use crate::geometry::beam::{Candidates, Places};
use crate::geometry::{AnyHit, NO_PRIMITIVE, Opaque, Packet, PrimitiveIndex, Rays, Search, Stack, Visitor};
use crate::math::V3;
use crate::settings::Visibility;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::ops::Range;
use std::time::Instant;
use verdict::{Judge, Verdict};

/// What a thread keeps for shadow rays.
#[derive(Debug, Default)]
pub struct ShadowScratch {
    /// For each light the primitive that blocked it last in this tile: the thesis's shadow-object cache.
    last_blocker: Vec<PrimitiveIndex>,
    lists: Option<Box<Lists>>,
}

/// What can be in the way of a run of rays, and of a part of it.
#[derive(Debug, Default)]
struct Lists {
    whole: Candidates,
    part: Candidates,
    places: Places,
}

impl ShadowScratch {
    /// Forgets what the last tile found.
    pub fn begin_tile(&mut self, lights: usize) {
        self.last_blocker.clear();
        self.last_blocker.resize(lights, NO_PRIMITIVE);
    }
}

/// Traces the waiting shadow rays light by light and adds what arrives to the samples, in queue order.
pub(super) fn resolve<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, worker: &mut Worker) {
    // Nothing lies between the eye and what it sees.
    let lit_by_eye = frame.scene.headlight && level == 1;
    let mut shadows = std::mem::take(&mut worker.shadows);
    for (light, queue) in shadows.iter_mut().enumerate() {
        if queue.len() > 0 {
            if lit_by_eye || !frame.plan.shadows {
                queue.add_gains(simd, 0..queue.len(), &mut worker.color);
            } else {
                worker.stats.rays.shadow += queue.len() as u64;
                resolve_light(simd, frame, light, queue, worker);
            }
        }
        queue.clear();
    }
    worker.shadows = shadows;
}

impl ShadowQueue {
    /// Adds the gains of some rays as if nothing were in their way.
    fn add_gains<S: Simd>(&self, simd: S, range: Range<usize>, color: &mut Colors) {
        simd.vectorize(
            #[inline(always)]
            || {
                for at in range.clone().step_by(S::f32s::LEN) {
                    let lanes = (range.end - at).min(S::f32s::LEN);
                    color.add(simd, &self.sample[at..at + S::f32s::LEN], (1 << lanes) - 1, self.gain.load(simd, at));
                }
            },
        );
    }
}

/// Resolves the shadow rays of one light.
fn resolve_light<S: Simd>(simd: S, frame: &Frame<'_>, light: usize, queue: &mut ShadowQueue, worker: &mut Worker) {
    let search = Search::new(&frame.scene.geometry, frame.plan.tree);
    queue.pad();
    if frame.settings.visibility != Visibility::Certified {
        let all = 0..queue.len();
        return resolve_rays(simd, frame, light, queue, all, &Occluders { search, listed: None }, worker);
    }
    let mut lists = worker.shadow_scratch.lists.take().unwrap_or_default();
    for run in queue.runs.windows(2) {
        let range = run[0] as usize..run[1] as usize;
        if !range.is_empty() {
            resolve_run(simd, frame, light, queue, range, &search, &mut lists, worker);
        }
    }
    worker.shadow_scratch.lists = Some(lists);
}

/// Fewer candidates are not worth being sifted for parts of a run.
const FEW: usize = 3;

/// Rays in such a part.
const PART: usize = 64;

/// Resolves shadow rays of one light that start close together.
fn resolve_run<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    light: usize,
    queue: &ShadowQueue,
    range: Range<usize>,
    search: &Search<'_>,
    lists: &mut Lists,
    worker: &mut Worker,
) {
    let start = Instant::now();
    let judge = Judge::new(simd, frame, *search, frame.lights[light].kind, queue, range.clone());
    let verdict = match &judge {
        Some(judge) => judge.judge(simd, &mut lists.whole, &mut worker.stack),
        None => Verdict::Unknown,
    };
    worker.stats.stages_ms.certificate += milliseconds_since(start);
    match (verdict, &judge) {
        (Verdict::Listed, Some(judge)) if lists.whole.len() > FEW => {
            let parts = (range.len() / PART).max(1);
            for part in 0..parts {
                let at = |part: usize| range.start + range.len() * part / parts;
                let own = at(part)..at(part + 1);
                let verdict = judge.judge_part(simd, queue, own.clone(), &lists.whole, &mut lists.part);
                lists.places.take_all(if verdict == Verdict::Unknown { &lists.whole } else { &lists.part });
                let verdict = if verdict == Verdict::Unknown { Verdict::Listed } else { verdict };
                resolve_judged(simd, frame, light, queue, own, verdict, search, &lists.places, worker);
            }
        }
        _ => {
            lists.places.take_all(&lists.whole);
            resolve_judged(simd, frame, light, queue, range, verdict, search, &lists.places, worker);
        }
    }
}

/// Does what a verdict asks for.
fn resolve_judged<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    light: usize,
    queue: &ShadowQueue,
    range: Range<usize>,
    verdict: Verdict,
    search: &Search<'_>,
    places: &Places,
    worker: &mut Worker,
) {
    match verdict {
        Verdict::Dark => {}
        Verdict::Lit => queue.add_gains(simd, range, &mut worker.color),
        Verdict::Listed => {
            let occluders = Occluders { search: *search, listed: Some(places) };
            resolve_rays(simd, frame, light, queue, range, &occluders, worker);
        }
        Verdict::Unknown => {
            let occluders = Occluders { search: *search, listed: None };
            resolve_rays(simd, frame, light, queue, range, &occluders, worker);
        }
    }
}

/// Where to look for what is in a ray's way.
struct Occluders<'a> {
    search: Search<'a>,
    /// All that can be in the way, if that is known.
    listed: Option<&'a Places>,
}

impl Occluders<'_> {
    /// Shows `visitor` what is in the way.
    #[inline(always)]
    fn visit<S: Simd, V: Visitor<S>>(&self, simd: S, rays: &Rays<S::f32s>, stack: &mut Stack, visitor: &mut V) {
        match self.listed {
            Some(places) => self.search.resolve(simd, places, rays, visitor),
            None => {
                let packet = Packet::new(self.search.geometry, rays.origin, rays.direction);
                self.search.traverse(simd, &packet, stack, visitor);
            }
        }
    }
}

/// Traces some of a light's shadow rays and adds what arrives.
fn resolve_rays<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    light: usize,
    queue: &ShadowQueue,
    range: Range<usize>,
    occluders: &Occluders<'_>,
    worker: &mut Worker,
) {
    let Worker { shadow_scratch, stack, color, stats, .. } = worker;
    let last_blocker = &mut shadow_scratch.last_blocker[light];
    simd.vectorize(
        #[inline(always)]
        || {
            let opaque = frame.tables.opaque();
            for at in range.clone().step_by(S::f32s::LEN) {
                let present = (1 << (range.end - at).min(S::f32s::LEN)) - 1;
                let lanes = at..at + S::f32s::LEN;
                let rays = Rays::new(queue.origin.load(simd, at), queue.direction.load(simd, at));
                let sources = S::u32s::from_slice(simd, &queue.source[lanes.clone()]);
                // Lanes beyond the range go nowhere.
                let distance = <S::f32s as SimdBase<S>>::Mask::from_bitmask(simd, present)
                    .select(S::f32s::from_slice(simd, &queue.distance[lanes.clone()]), S::f32s::splat(simd, 0.0));
                let mut visitor = AnyHit::new(simd, distance, sources, opaque);
                if frame.settings.shadow_cache && *last_blocker != NO_PRIMITIVE {
                    occluders.search.test_one(simd, *last_blocker, &rays, &mut visitor);
                    count_cache(&mut stats.shadow_cache, present, visitor.blocked.to_bitmask());
                }
                if !visitor.is_finished() {
                    occluders.visit(simd, &rays, stack, &mut visitor);
                }
                if visitor.blocker != NO_PRIMITIVE {
                    *last_blocker = visitor.blocker;
                }
                let mut gain: V3<S::f32s> = queue.gain.load(simd, at);
                if let Opaque::Listed(listed) = opaque
                    && visitor.passed_transparent
                    && visitor.blocked.any_false()
                {
                    let open = visitor.blocked.select(S::f32s::splat(simd, 0.0), distance);
                    gain = gain * crossing::transmittance(simd, frame, occluders, &rays, sources, listed, open, stack);
                }
                let open = !visitor.blocked.to_bitmask() & present;
                color.add(simd, &queue.sample[lanes], open, gain);
            }
        },
    );
}

/// Counts how often the shadow-object cache was asked, and how often it knew.
#[inline(always)]
fn count_cache(counts: &mut CacheCounts, asked: u64, blocked: u64) {
    counts.queries += u64::from(asked.count_ones());
    counts.hits += u64::from((blocked & asked).count_ones());
}
