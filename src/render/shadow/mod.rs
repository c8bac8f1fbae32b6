//! Shadow rays: which of a tile's light contributions arrive, and in what colour.

mod crossing;
mod settle;
mod verdict;

use super::extent::{FEW, Lists, parts};
use super::frame::Frame;
use super::queue::ShadowQueue;
use super::samples::Colors;
use super::stats::CacheCounts;
use super::tile::{Worker, milliseconds_since};
use crate::geometry::beam::{Candidates, Points};
use crate::geometry::{AnyHit, NO_PRIMITIVE, Opaque, Packet, PrimitiveIndex, Rays, Search, Stack, Visitor};
use crate::math::V3;
use crossing::{Flight, transmittance};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
pub(super) use settle::settle;
use std::ops::Range;
use std::time::Instant;
use verdict::{Judge, Verdict};

/// What a thread keeps for shadow rays.
#[derive(Debug, Default)]
pub struct ShadowScratch {
    /// For each light the primitive that blocked it last in this tile: the thesis's shadow-object cache.
    last_blocker: Vec<PrimitiveIndex>,
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
    // Nothing lies between the eye and what it sees, but for the backs of one-sided surfaces: they leave its own light be.
    let lit_by_eye = frame.scene.headlight && level == 1;
    let mut shadows = std::mem::take(&mut worker.shadows);
    for (light, queue) in shadows.iter_mut().enumerate() {
        if queue.len() > 0 {
            if lit_by_eye || !frame.plan.shadows {
                queue.add_gains(simd, 0..queue.len(), &mut worker.color);
            } else {
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

/// The shadow rays of one light.
struct LightRays<'a> {
    light: usize,
    queue: &'a ShadowQueue,
    search: Search<'a>,
}

/// Resolves the shadow rays of one light.
fn resolve_light<S: Simd>(simd: S, frame: &Frame<'_>, light: usize, queue: &mut ShadowQueue, worker: &mut Worker) {
    queue.pad();
    let rays = LightRays { light, queue, search: Search::new(&frame.scene.geometry, frame.plan.tree) };
    if !frame.plan.shadow_beams {
        return trace_rays(simd, frame, &rays, 0..queue.len(), None, worker);
    }
    let mut lists = worker.lists.take().unwrap_or_default();
    for run in queue.runs.windows(2) {
        let range = run[0] as usize..run[1] as usize;
        if !range.is_empty() {
            resolve_run(simd, frame, &rays, range, &mut lists, worker);
        }
    }
    worker.lists = Some(lists);
}

/// Fewer rays are not worth a beam.
const LEAST_RAYS: usize = 16;

/// Resolves shadow rays of one light that start close together.
fn resolve_run<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    rays: &LightRays<'_>,
    range: Range<usize>,
    lists: &mut Lists,
    worker: &mut Worker,
) {
    let Lists { whole, part } = lists;
    let start = Instant::now();
    let judge = if range.len() < LEAST_RAYS {
        None
    } else {
        Judge::new(simd, frame, rays.search, frame.lights[rays.light].kind, rays.queue, range.clone(), 0.0)
    };
    let verdict = match &judge {
        Some(judge) => judge.judge(simd, whole, &mut worker.stack),
        None => Verdict::Unknown,
    };
    worker.stats.stages_ms.certificate += milliseconds_since(start);
    let Some(judge) = judge.filter(|_| verdict == Verdict::Listed) else {
        return carry_out(simd, frame, rays, range, verdict, None, worker);
    };
    if whole.len() < FEW {
        let suspects = Some(Suspects { candidates: whole, judge: &judge });
        return carry_out(simd, frame, rays, range, verdict, suspects, worker);
    }
    for own in parts(range) {
        let verdict = judge.judge_part(simd, rays.queue, own.clone(), whole, part);
        let suspects = Some(Suspects { candidates: part, judge: &judge });
        carry_out(simd, frame, rays, own, verdict, suspects, worker);
    }
}

/// What can be in the way of some rays, as a light sees it.
#[derive(Clone, Copy)]
struct Suspects<'a> {
    candidates: &'a Candidates,
    judge: &'a Judge<'a>,
}

/// Does what a verdict on some rays asks for.
fn carry_out<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    rays: &LightRays<'_>,
    range: Range<usize>,
    verdict: Verdict,
    suspects: Option<Suspects<'_>>,
    worker: &mut Worker,
) {
    match verdict {
        Verdict::Dark => worker.stats.certificates.dark += range.len() as u64,
        Verdict::Lit => {
            worker.stats.certificates.lit += range.len() as u64;
            rays.queue.add_gains(simd, range, &mut worker.color);
        }
        Verdict::Listed => trace_rays(simd, frame, rays, range, suspects, worker),
        Verdict::Unknown => trace_rays(simd, frame, rays, range, None, worker),
    }
}

/// Where to look for what is in the way of a packet of rays.
struct Occluders<'a, S: Simd> {
    search: Search<'a>,
    /// All that can be in the way, if that is known, and the rays as their light sees them.
    listed: Option<(&'a Candidates, Points<S::f32s>)>,
}

impl<S: Simd> Occluders<'_, S> {
    /// Shows `visitor` what is in the way.
    #[inline(always)]
    fn visit<V: Visitor<S>>(
        &self,
        simd: S,
        origin: V3<S::f32s>,
        direction: V3<S::f32s>,
        stack: &mut Stack,
        visitor: &mut V,
    ) {
        match &self.listed {
            Some((candidates, points)) => self.search.resolve(simd, candidates, points, origin, direction, visitor),
            None => {
                let packet = Packet::new(self.search.geometry, origin, direction);
                self.search.traverse(simd, &packet, stack, visitor);
            }
        }
    }
}

/// Traces some of a light's shadow rays and adds what arrives.
fn trace_rays<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    rays: &LightRays<'_>,
    range: Range<usize>,
    suspects: Option<Suspects<'_>>,
    worker: &mut Worker,
) {
    let &LightRays { light, queue, search } = rays;
    let Worker { shadow_scratch, stack, color, trails, stats, ledger, .. } = worker;
    let last_blocker = &mut shadow_scratch.last_blocker[light];
    simd.vectorize(
        #[inline(always)]
        || {
            let opaque = frame.tables.opaque(&frame.scene.geometry);
            for at in range.clone().step_by(S::f32s::LEN) {
                let lanes = at..at + S::f32s::LEN;
                let present = (1 << (range.end - at).min(S::f32s::LEN)) - 1;
                let mut gain: V3<S::f32s> = queue.gain.load(simd, at);
                let (origin, direction) = (queue.origin.load(simd, at), queue.direction.load(simd, at));
                // Lanes beyond the range go nowhere.
                let distance = <S::f32s as SimdBase<S>>::Mask::from_bitmask(simd, present)
                    .select(S::f32s::from_slice(simd, &queue.distance[lanes.clone()]), S::f32s::splat(simd, 0.0));
                let sources = S::u32s::from_slice(simd, &queue.source[lanes.clone()]);
                let mut visitor = AnyHit::new(simd, distance, sources, opaque);
                let mut occluders = Occluders { search, listed: None };
                if let Some(Suspects { candidates, judge }) = suspects {
                    let points = judge.points(origin);
                    if candidates.are_passed_by(simd, &points, &visitor) {
                        stats.certificates.lit += u64::from(present.count_ones());
                        color.add(simd, &queue.sample[lanes], present, gain);
                        continue;
                    }
                    occluders.listed = Some((candidates, points));
                }
                stats.rays.shadow += u64::from(present.count_ones());
                if frame.keeps_costs {
                    ledger.add_lanes(&queue.sample[lanes.clone()], present);
                }
                if frame.settings.shadow_cache && suspects.is_none() && *last_blocker != NO_PRIMITIVE {
                    search.test_one(simd, *last_blocker, &Rays::new(origin, direction), &mut visitor);
                    count_cache(&mut stats.shadow_cache, present, visitor.blocked.to_bitmask());
                }
                if !visitor.is_finished() {
                    occluders.visit(simd, origin, direction, stack, &mut visitor);
                }
                if visitor.blocker != NO_PRIMITIVE {
                    *last_blocker = visitor.blocker;
                }
                if let Opaque::Listed(listed) = opaque
                    && visitor.passed_transparent
                    && visitor.blocked.any_false()
                {
                    let limit = visitor.blocked.select(S::f32s::splat(simd, 0.0), distance);
                    let flight = Flight { origin, direction, sources, limit };
                    gain = gain * transmittance(simd, frame, &occluders, &flight, listed, stack);
                }
                let open = !visitor.blocked.to_bitmask() & present;
                if frame.plan.trails {
                    trails.note_light(light, &queue.sample[lanes.clone()], open);
                }
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
