//! Shadow rays: which of a tile's light contributions arrive, and in what colour.

use super::frame::Frame;
use super::gather;
use super::queue::ShadowQueue;
use super::samples::Colors;
use super::stats::CacheCounts;
use super::tile::Worker;
use crate::geometry::{AnyHit, NO_PRIMITIVE, NextCrossing, Opaque, Packet, PrimitiveIndex, Search, Stack, Visitor};
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Traces the waiting shadow rays light by light and adds what arrives to the samples, in queue order.
pub(super) fn resolve<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, worker: &mut Worker) {
    let Worker { shadows, last_blocker, stack, color, stats, .. } = worker;
    // Nothing lies between the eye and what it sees.
    let lit_by_eye = frame.scene.headlight && level == 1;
    for (queue, last_blocker) in shadows.iter_mut().zip(last_blocker) {
        if queue.len() == 0 {
            continue;
        }
        if lit_by_eye || !frame.plan.shadows {
            queue.add_gains(simd, color);
            queue.clear();
            continue;
        }
        stats.rays.shadow += queue.len() as u64;
        resolve_light(simd, frame, queue, last_blocker, stack, color, &mut stats.shadow_cache);
        queue.clear();
    }
}

impl ShadowQueue {
    /// Adds every gain as if nothing were in the way.
    fn add_gains<S: Simd>(&self, simd: S, color: &mut Colors) {
        simd.vectorize(
            #[inline(always)]
            || {
                for at in (0..self.len()).step_by(S::f32s::LEN) {
                    let lanes = (self.len() - at).min(S::f32s::LEN);
                    color.add(simd, &self.sample[at..at + S::f32s::LEN], (1 << lanes) - 1, self.gain.load(simd, at));
                }
            },
        );
    }
}

fn resolve_light<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    queue: &mut ShadowQueue,
    last_blocker: &mut PrimitiveIndex,
    stack: &mut Stack,
    color: &mut Colors,
    counts: &mut CacheCounts,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let search = Search::new(&frame.scene.geometry, frame.plan.tree);
            let opaque = frame.tables.opaque();
            queue.pad();
            for at in (0..queue.len()).step_by(S::f32s::LEN) {
                let lanes = (queue.len() - at).min(S::f32s::LEN);
                let packet = Packet::new(search.geometry, queue.origin.load(simd, at), queue.direction.load(simd, at));
                let distance = S::f32s::from_slice(simd, &queue.distance[at..at + S::f32s::LEN]);
                let mut visitor = AnyHit::new(simd, distance, opaque);
                if frame.settings.shadow_cache {
                    ask_last_blocker(simd, &search, &packet, *last_blocker, lanes, &mut visitor, counts);
                }
                if !visitor.is_finished() {
                    search.traverse(simd, &packet, stack, &mut visitor);
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
                    gain = gain * transmittance(simd, frame, &search, &packet, listed, open, stack);
                }
                let open = !visitor.blocked.to_bitmask() & ((1 << lanes) - 1);
                color.add(simd, &queue.sample[at..at + S::f32s::LEN], open, gain);
            }
        },
    );
}

/// The thesis's shadow-object cache: what blocked this light last, in this tile, is tested first.
#[inline(always)]
fn ask_last_blocker<S: Simd>(
    simd: S,
    search: &Search<'_>,
    packet: &Packet<S>,
    last_blocker: PrimitiveIndex,
    lanes: usize,
    visitor: &mut AnyHit<'_, S>,
    counts: &mut CacheCounts,
) {
    if last_blocker == NO_PRIMITIVE {
        return;
    }
    search.test_one(simd, last_blocker, packet, visitor);
    counts.queries += lanes as u64;
    let within = (1_u64 << lanes) - 1;
    counts.hits += u64::from((visitor.blocked.to_bitmask() & within).count_ones());
}

/// What transparent things leave of the light: t·color at each crossing, multiplied in the order of (t, primitive).
/// Lanes whose `limit` is 0 are left out.
fn transmittance<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    search: &Search<'_>,
    packet: &Packet<S>,
    opaque: &[bool],
    limit: S::f32s,
    stack: &mut Stack,
) -> V3<S::f32s> {
    simd.vectorize(
        #[inline(always)]
        || {
            let zero = S::f32s::splat(simd, 0.0);
            let mut arriving: V3<S::f32s> = V3::all(S::f32s::splat(simd, 1.0));
            let (mut last_t, mut last_primitive) = (zero, S::u32s::splat(simd, NO_PRIMITIVE));
            // As for opaque occluders, the interval's end is exclusive.
            let open = limit.simd_gt(zero);
            let mut limit = open.select(S::f32s::from_bits(limit.to_bits() - 1), zero - 1.0);
            loop {
                let mut next = NextCrossing::new(simd, opaque, last_t, last_primitive, limit);
                search.traverse(simd, packet, stack, &mut next);
                let found = next.closest.primitive.simd_ne(S::u32s::splat(simd, NO_PRIMITIVE));
                if !found.any_true() {
                    return arriving;
                }
                let primitives = next.closest.primitive;
                let crossed = gather::transmission(simd, frame, &primitives, packet, next.closest.t);
                arriving = V3::select(found, arriving * crossed, arriving);
                let dark = arriving.x.simd_eq(zero) & arriving.y.simd_eq(zero) & arriving.z.simd_eq(zero);
                limit = (found & !dark).select(limit, zero - 1.0);
                last_t = found.select(next.closest.t, last_t);
                last_primitive = found.select(primitives, last_primitive);
            }
        },
    )
}
