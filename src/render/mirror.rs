//! What flat mirrors show of the eye's rays: a beam from the mirrored eye tells what a run of mirrored rays can meet.
//!
//! This is beam tracing's step from a mirror onwards (Heckbert and Hanrahan, SIGGRAPH 1984), for candidates only. That
//! rays come from the mirrored eye is not taken for granted: offsets, rounding and bad normals (of needles, say) move
//! them. Seen from any apex, a ray's points lie between its start and its direction; a beam that holds both holds the
//! ray. How far the lines pass by the apex is measured, too, and has to be within half of what beams allow for, which is
//! made twice what kernels need.

use super::extent::{Extent, FEW, Lists, parts};
use super::frame::Frame;
use super::queue::{RUN, RayQueue};
use super::tile::{Worker, milliseconds_since};
use super::trace;
use crate::geometry::beam::{Beam, Candidates, Cover, Points, Projection, SLACK};
use crate::geometry::{ClosestHit, NO_PRIMITIVE, PrimitiveIndex, Search, Stack};
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use std::ops::Range;
use std::time::Instant;

/// Fewer rays are not worth a beam.
const LEAST_RAYS: usize = 48;

/// More candidates are not worth testing one by one.
const MOST_CANDIDATES: usize = 64;

/// Wider beams (width over depth) list too much.
const WIDEST: f32 = 0.5;

/// Rays must start farther from the mirrored eye than so many times what beams allow for.
const LEAST_DISTANCE: f32 = 32.0;

/// Flatter rays (cosine) are not said to stay in front of their mirror.
const FLATTEST: f32 = 1e-5;

/// Finds the closest hits of the rays in `worker.rays`, each of which follows from one from the eye.
pub(super) fn closest_hits<S: Simd>(simd: S, frame: &Frame<'_>, worker: &mut Worker) {
    let search = Search::new(&frame.scene.geometry, frame.plan.tree);
    let mut lists = worker.lists.take().unwrap_or_default();
    worker.rays.pad();
    // Packets may look beyond what they are for: what they store there is overwritten, run after run.
    let (mut traced, mut at) = (0, 0);
    while at < worker.rays.len() {
        let (mirror, run) = next_run(frame, &worker.rays, at);
        at = run.end;
        let view = mirror.filter(|_| run.len() >= LEAST_RAYS).and_then(|mirror| {
            let start = Instant::now();
            let view = View::new(simd, frame, search, mirror, &worker.rays, run.clone());
            let view = view.filter(|view| view.list(simd, &view.extent, &mut lists.whole, &mut worker.stack));
            worker.stats.stages_ms.certificate += milliseconds_since(start);
            view
        });
        if let Some(view) = view {
            trace::secondary_range(simd, &search, traced..run.start, worker);
            traced = run.end;
            worker.stats.certificates.mirrored += run.len() as u64;
            view.find(simd, run, &mut lists, worker);
        }
    }
    trace::secondary_range(simd, &search, traced..at, worker);
    worker.rays.clear_padding();
    worker.lists = Some(lists);
}

/// The plane of a mirror, as the eye sees it.
#[derive(Clone, Copy)]
struct Mirror {
    /// Unit normal on the eye's side.
    normal: Vec3,
    /// Where the mirrored eye is.
    apex: Vec3,
}

impl Mirror {
    fn new(frame: &Frame<'_>, source: PrimitiveIndex) -> Option<Self> {
        let (normal, point) = frame.scene.geometry.plane_of(source)?;
        let height = normal.dot(frame.camera.eye - point);
        let normal = normal * 1.0_f32.copysign(height);
        Some(Self { normal, apex: frame.camera.eye - normal * (2.0 * height.abs()) })
    }

    /// Whether another mirror is likely to lie in the same plane. If not, beams will see it.
    fn is_like(&self, other: &Self) -> bool {
        self.apex.distance(other.apex) <= 1e-5 * self.apex.abs().max_element()
    }
}

/// The next rays that leave one mirror, up to a [`RUN`] of them, and the mirror; `None` for other rays.
fn next_run(frame: &Frame<'_>, rays: &RayQueue, start: usize) -> (Option<Mirror>, Range<usize>) {
    let mut source = rays.source[start];
    let mirror_of = |source| if source == NO_PRIMITIVE { None } else { Mirror::new(frame, source) };
    let mirror = mirror_of(source);
    let last = rays.len().min(start + RUN);
    let mut end = start + 1;
    while end < last {
        let next = rays.source[end];
        if next != source {
            let alike = match (&mirror, mirror_of(next)) {
                (Some(mirror), Some(other)) => mirror.is_like(&other),
                (None, None) => true,
                _ => false,
            };
            if !alike {
                break;
            }
            source = next;
        }
        end += 1;
    }
    (mirror, start..end)
}

/// The mirrored eye's view of rays that leave a mirror close together.
struct View<'a> {
    search: Search<'a>,
    projection: Projection,
    extent: Extent,
    /// The rays stay where this normal's product with a point is at least this.
    lowest: Option<(Vec3, f32)>,
}

impl<'a> View<'a> {
    /// A view of some rays; `None` if they are too far apart.
    fn new<S: Simd>(
        simd: S,
        frame: &Frame<'_>,
        search: Search<'a>,
        Mirror { normal, apex }: Mirror,
        rays: &RayQueue,
        run: Range<usize>,
    ) -> Option<Self> {
        let forward = (rays.origin.get(run.start + run.len() / 2) - apex).try_normalize()?;
        let right = forward.any_orthonormal_vector();
        let axes = [right, right.cross(forward), forward];
        let bare = Projection::new(apex, axes, false, 0.0, 0.0);
        let extent = Extent::of(simd, &bare, &rays.origin, Some(&rays.direction), run.clone())?;
        // Twice as far: kernels need their share of the slack, and the lines that do not quite meet have another.
        let reach = 2.0 * search.geometry.reach().max(extent.reach) + apex.abs().max_element();
        let projection = Projection::new(apex, axes, false, reach, frame.beam_margin);
        let slack = projection.slack;
        // That lines come this close is not a margin that may be given up.
        let close = 0.5 * SLACK * (reach + apex.abs().max_element());
        let usable = extent.z[0] > LEAST_DISTANCE * slack && extent.beside < close && extent.width() < WIDEST;
        usable.then(|| Self { search, projection, extent, lowest: lowest(simd, normal, rays, run) })
    }

    /// Lists what rays of the given extent can meet. False if that is too much.
    fn list<S: Simd>(&self, simd: S, extent: &Extent, candidates: &mut Candidates, stack: &mut Stack) -> bool {
        let nothing = Cover::nothing(&self.projection);
        self.search.collect(simd, &self.beam(extent), nothing, candidates, stack)
    }

    /// Finds the hits of a run by its list.
    fn find<S: Simd>(&self, simd: S, run: Range<usize>, lists: &mut Lists, worker: &mut Worker) {
        let Lists { whole, part } = lists;
        if whole.len() < FEW {
            return self.resolve(simd, whole, run, &mut worker.rays);
        }
        for own in parts(run) {
            let start = Instant::now();
            let rays = &worker.rays;
            let extent = Extent::of(simd, &self.projection, &rays.origin, Some(&rays.direction), own.clone());
            let candidates = match extent {
                Some(extent) => {
                    part.filter(simd, whole, &self.beam(&extent));
                    &*part
                }
                None => &*whole,
            };
            worker.stats.stages_ms.certificate += milliseconds_since(start);
            self.resolve(simd, candidates, own, &mut worker.rays);
        }
    }

    /// The beam of rays of the given extent. Its covers lie in front of the mirror: deeper than all starts.
    fn beam(&self, extent: &Extent) -> Beam<'_> {
        Beam::new(&self.projection, extent.x, extent.y)
            .beyond(extent.z[1] + 4.0 * self.projection.slack)
            .in_front(self.lowest, MOST_CANDIDATES)
    }

    /// Tests some rays against all that they can meet.
    fn resolve<S: Simd>(&self, simd: S, candidates: &Candidates, range: Range<usize>, rays: &mut RayQueue) {
        simd.vectorize(
            #[inline(always)]
            || {
                let (zero, far) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, f32::INFINITY));
                for at in range.step_by(S::f32s::LEN) {
                    let (origin, direction) = (rays.origin.load(simd, at), rays.direction.load(simd, at));
                    let points = Points::past(&self.projection, origin, direction, self.extent.beside);
                    let mut visitor = ClosestHit::new(simd, zero, far);
                    self.search.resolve(simd, candidates, &points, origin, direction, &mut visitor);
                    trace::store_hits(simd, &visitor, rays, at);
                }
            },
        );
    }
}

/// A normal and the least that its product is with any point of the rays; `None` if some of them turn back.
fn lowest<S: Simd>(simd: S, normal: Vec3, rays: &RayQueue, range: Range<usize>) -> Option<(Vec3, f32)> {
    simd.vectorize(
        #[inline(always)]
        || {
            let lanes = S::f32s::LEN;
            let along = V3::splat(simd, normal);
            let mut lowest = S::f32s::splat(simd, f32::INFINITY);
            let mut flattest = lowest;
            for at in range.clone().step_by(lanes) {
                let at = at.min(range.end - lanes);
                lowest = lowest.min(along.dot(rays.origin.load(simd, at)));
                flattest = flattest.min(along.dot(rays.direction.load(simd, at)));
            }
            (flattest.reduce_min() > FLATTEST).then(|| (normal, lowest.reduce_min()))
        },
    )
}
