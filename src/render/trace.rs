//! Closest hits for a queue of rays.

use super::frame::Frame;
use super::media::OUTSIDE;
use super::queue::RayQueue;
use super::tile::Worker;
use crate::geometry::{ClosestHit, NO_PRIMITIVE, Packet, Rays, Search, SphereTerms, Stack};
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::ops::Range;

/// Finds the closest hits of the secondary rays in `worker.rays`.
pub(super) fn closest_hits<S: Simd>(simd: S, frame: &Frame<'_>, worker: &mut Worker) {
    let search = Search::new(&frame.scene.geometry, frame.plan.tree);
    trace_queue(simd, &search, 0.0, f32::INFINITY, &mut worker.rays, &mut worker.stack);
}

/// Finds the closest hits of the rays from the eye in `worker.rays`.
pub(super) fn primary_hits<S: Simd>(simd: S, frame: &Frame<'_>, worker: &mut Worker) {
    let search = eye_search(frame);
    trace_queue(simd, &search, frame.camera.near, frame.camera.far, &mut worker.rays, &mut worker.stack);
    count_primary(frame, 0..worker.rays.len(), worker);
}

/// Counts rays from the eye.
fn count_primary(frame: &Frame<'_>, range: Range<usize>, worker: &mut Worker) {
    worker.stats.rays.primary += range.len() as u64;
    if frame.keeps_costs {
        worker.ledger.add_all(&worker.rays.sample[range]);
    }
}

/// Distance of what a ray is taken to see until it is tested; of those that miss it, until they are traced.
pub(super) const PENDING: f32 = -1.0;

/// Tests the pending rays from the eye each against the one primitive that it is taken to see. Appends the places of those
/// that miss it to `missing`; they stay pending.
pub(super) fn test_pending<S: Simd>(simd: S, frame: &Frame<'_>, rays: &mut RayQueue, missing: &mut Vec<u32>) {
    let search = eye_search(frame);
    simd.vectorize(
        #[inline(always)]
        || {
            let eye = V3::splat(simd, frame.camera.eye);
            let (near, far) = (S::f32s::splat(simd, frame.camera.near), S::f32s::splat(simd, frame.camera.far));
            let (zero, nothing) = (S::f32s::splat(simd, 0.0), S::u32s::splat(simd, NO_PRIMITIVE));
            for at in (0..rays.len()).step_by(S::f32s::LEN) {
                let lanes = at..at + S::f32s::LEN;
                let mut t = S::f32s::from_slice(simd, &rays.t[lanes.clone()]);
                let primitives = S::u32s::from_slice(simd, &rays.primitive[lanes.clone()]);
                let sky = t.simd_lt(zero) & primitives.simd_eq(nothing);
                t = sky.select(S::f32s::splat(simd, f32::INFINITY), t);
                let eye_rays = Rays::new(eye, rays.direction.load(simd, at));
                let mut pending = t.simd_lt(zero);
                while pending.any_true() {
                    let primitive = rays.primitive[at + pending.to_bitmask().trailing_zeros() as usize];
                    let own = pending & primitives.simd_eq(S::u32s::splat(simd, primitive));
                    let mut visitor = ClosestHit::new(simd, near, far);
                    search.test_one(simd, primitive, &eye_rays, &mut visitor);
                    t = (own & visitor.primitive.simd_ne(nothing)).select(visitor.t, t);
                    pending &= !own;
                }
                t.store_slice(&mut rays.t[lanes]);
                let mut missed = t.simd_lt(zero).to_bitmask();
                while missed != 0 {
                    missing.push(at as u32 + missed.trailing_zeros());
                    missed &= missed - 1;
                }
            }
        },
    );
}

/// Finds the closest hits of the rays from the eye at the given places of `worker.rays`.
pub(super) fn retrace<S: Simd>(simd: S, frame: &Frame<'_>, places: &[u32], worker: &mut Worker) {
    let Worker { rays, found, .. } = worker;
    found.clear();
    found.extend_from_eye(frame.camera.eye, OUTSIDE, places.len());
    for (to, &from) in places.iter().enumerate() {
        found.direction.set(to, rays.direction.get(from as usize));
        found.sample[to] = rays.sample[from as usize];
    }
    std::mem::swap(rays, found);
    primary_hits(simd, frame, worker);
    let Worker { rays, found, .. } = worker;
    std::mem::swap(rays, found);
    for (from, &to) in places.iter().enumerate() {
        (rays.primitive[to as usize], rays.t[to as usize]) = (found.primitive[from], found.t[from]);
    }
}

/// Finds the closest hits of some of the rays from the eye in `worker.rays`, and perhaps of rays behind them.
pub(super) fn primary_range<S: Simd>(simd: S, frame: &Frame<'_>, range: Range<usize>, worker: &mut Worker) {
    let search = eye_search(frame);
    count_primary(frame, range.clone(), worker);
    trace_range(simd, &search, range, frame.camera.near, frame.camera.far, worker);
}

/// Finds the closest hits of some of the secondary rays in `worker.rays`, and perhaps of rays behind them.
pub(super) fn secondary_range<S: Simd>(simd: S, search: &Search<'_>, range: Range<usize>, worker: &mut Worker) {
    trace_range(simd, search, range, 0.0, f32::INFINITY, worker);
}

/// Finds the closest hits of the given rays, and perhaps of rays behind them.
fn trace_range<S: Simd>(
    simd: S,
    search: &Search<'_>,
    range: Range<usize>,
    t_min: f32,
    t_max: f32,
    worker: &mut Worker,
) {
    let Worker { rays, stack, .. } = worker;
    simd.vectorize(
        #[inline(always)]
        || {
            let (t_min, t_max) = (S::f32s::splat(simd, t_min), S::f32s::splat(simd, t_max));
            for at in range.step_by(S::f32s::LEN) {
                let packet = Packet::new(search.geometry, rays.origins(simd, at), rays.direction.load(simd, at));
                let mut visitor = ClosestHit::new(simd, t_min, t_max);
                search.traverse(simd, &packet, stack, &mut visitor);
                store_hits(simd, &visitor, rays, at);
            }
        },
    );
}

/// Stores what a packet found.
#[inline(always)]
pub(super) fn store_hits<S: Simd>(simd: S, found: &ClosestHit<S>, rays: &mut RayQueue, at: usize) {
    let missed = found.primitive.simd_eq(S::u32s::splat(simd, NO_PRIMITIVE));
    let t = missed.select(S::f32s::splat(simd, f32::INFINITY), found.t);
    t.store_slice(&mut rays.t[at..at + S::f32s::LEN]);
    found.primitive.store_slice(&mut rays.primitive[at..at + S::f32s::LEN]);
}

/// A search by rays that share the eye.
pub(super) fn eye_search<'a>(frame: &Frame<'a>) -> Search<'a> {
    let sphere_terms: SphereTerms<'a> = frame.sphere_terms;
    Search { sphere_terms, ..Search::new(&frame.scene.geometry, frame.plan.tree) }
}

fn trace_queue<S: Simd>(simd: S, search: &Search<'_>, t_min: f32, t_max: f32, rays: &mut RayQueue, stack: &mut Stack) {
    rays.pad();
    simd.vectorize(
        #[inline(always)]
        || {
            let (t_min, t_max) = (S::f32s::splat(simd, t_min), S::f32s::splat(simd, t_max));
            for at in (0..rays.len()).step_by(S::f32s::LEN) {
                let packet = Packet::new(search.geometry, rays.origins(simd, at), rays.direction.load(simd, at));
                let mut visitor = ClosestHit::new(simd, t_min, t_max);
                search.traverse(simd, &packet, stack, &mut visitor);
                store_hits(simd, &visitor, rays, at);
            }
        },
    );
    // The last packet's spare lanes repeated the last ray, and found what it found.
    rays.clear_padding();
}
