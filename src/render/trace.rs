//! Closest hits for a queue of rays.

use super::frame::Frame;
use super::queue::RayQueue;
use super::tile::Worker;
use crate::geometry::{ClosestHit, NO_PRIMITIVE, Packet, Search, SphereTerms, Stack};
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
    worker.stats.rays.primary += worker.rays.len() as u64;
}

/// Tests the rays from the eye that start at `first` against one primitive only. Misses keep no primitive.
pub(super) fn test_primitive<S: Simd>(simd: S, frame: &Frame<'_>, primitive: u32, first: usize, rays: &mut RayQueue) {
    let search = eye_search(frame);
    simd.vectorize(
        #[inline(always)]
        || {
            for_each_packet(simd, &search, rays, first, frame.camera.near, frame.camera.far, |packet, visitor| {
                search.test_one(simd, primitive, &packet.rays, visitor);
            });
        },
    );
}

/// Finds the closest hits of some of the rays from the eye in `worker.rays`, and perhaps of rays behind them.
pub(super) fn primary_range<S: Simd>(simd: S, frame: &Frame<'_>, range: Range<usize>, worker: &mut Worker) {
    let search = eye_search(frame);
    worker.stats.rays.primary += range.len() as u64;
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
    simd.vectorize(
        #[inline(always)]
        || {
            for_each_packet(simd, search, rays, 0, t_min, t_max, |packet, visitor| {
                search.traverse(simd, packet, stack, visitor);
            });
        },
    );
}

/// Calls `find` for each packet of the queue from `first` on, and stores what it found.
#[inline(always)]
fn for_each_packet<S: Simd>(
    simd: S,
    search: &Search<'_>,
    rays: &mut RayQueue,
    first: usize,
    t_min: f32,
    t_max: f32,
    mut find: impl FnMut(&Packet<S>, &mut ClosestHit<S>),
) {
    rays.pad();
    let (t_min, t_max) = (S::f32s::splat(simd, t_min), S::f32s::splat(simd, t_max));
    for at in (first..rays.len()).step_by(S::f32s::LEN) {
        let packet = Packet::new(search.geometry, rays.origins(simd, at), rays.direction.load(simd, at));
        let mut visitor = ClosestHit::new(simd, t_min, t_max);
        find(&packet, &mut visitor);
        store_hits(simd, &visitor, rays, at);
    }
    // The last packet's spare lanes repeated the last ray, and found what it found.
    rays.clear_padding();
}
