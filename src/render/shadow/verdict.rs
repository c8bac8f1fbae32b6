//! Many shadow rays at once: a beam from the light tells whether all arrive, or none, or what can be in their way.

use crate::geometry::beam::{Beam, Blocking, Candidates, Cover, Projection};
use crate::geometry::{NO_PRIMITIVE, Search, Stack};
use crate::math::V3;
use crate::render::frame::Frame;
use crate::render::queue::ShadowQueue;
use crate::scene::light::LightKind;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use std::ops::Range;

/// What a beam tells of its rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Nothing can be in the way of any ray.
    Lit,
    /// Something opaque is in the way of every ray.
    Dark,
    /// Only the listed candidates can be in the way.
    Listed,
    /// Too many things can be in the way, or the rays are too far apart.
    Unknown,
}

/// Fewer rays are not worth a beam.
const LEAST_RAYS: usize = 48;

/// More candidates are not worth testing one by one.
const MOST_CANDIDATES: usize = 32;

/// Wider beams (width over depth) list too much.
const WIDEST: f32 = 0.5;

/// Covers must be farther from a light than so many times what beams allow for: rays end a little before it.
const LEAST_DISTANCE: f32 = 32.0;

/// Judges the shadow rays in `range` of a light's queue.
pub(super) fn judge<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    search: &Search<'_>,
    light: LightKind,
    queue: &ShadowQueue,
    range: Range<usize>,
    candidates: &mut Candidates,
    stack: &mut Stack,
) -> Verdict {
    if range.len() < LEAST_RAYS {
        return Verdict::Unknown;
    }
    let middle = queue.origin.get(range.start + range.len() / 2);
    let (apex, forward, parallel) = match light {
        LightKind::Point { position } | LightKind::Spot { position, .. } => (position, middle - position, false),
        LightKind::Directional { direction } => (middle, direction, true),
    };
    let forward = forward.normalize();
    if !forward.is_finite() {
        return Verdict::Unknown;
    }
    let right = forward.any_orthonormal_vector();
    let axes = [right, right.cross(forward), forward];
    let unbounded = Projection::new(apex, axes, parallel, 0.0, 0.0);
    let Some(extent) = simd.vectorize(
        #[inline(always)]
        || Extent::of(simd, &unbounded, queue, range.clone()),
    ) else {
        return Verdict::Unknown;
    };
    let reach = search.geometry.reach().max(extent.reach);
    let projection = Projection::new(apex, axes, parallel, reach, frame.beam_margin);
    let slack = projection.slack;
    let [nearest, farthest] = extent.z;
    let width = (extent.x[1] - extent.x[0]).max(extent.y[1] - extent.y[0]);
    if !parallel && (nearest < LEAST_DISTANCE * slack || width > WIDEST) {
        return Verdict::Unknown;
    }

    let nearness = |z: f32| if parallel { -z } else { 1.0 / z };
    let source = common_source(simd, queue, range);
    let receiver = source.and_then(|source| search.geometry.plane_of(source));
    let behind = receiver.and_then(|plane| behind_plane(&projection, plane)).unwrap_or([
        0.0,
        0.0,
        nearness(farthest + 4.0 * slack),
    ]);
    let blocking = Blocking { opaque: frame.tables.opaque(), least_nearness: nearness(nearest - 4.0 * slack) };
    let beam = Beam::new(&projection, extent.x, extent.y)
        .beyond(if parallel { 0.0 } else { LEAST_DISTANCE * slack })
        .asking(source.unwrap_or(NO_PRIMITIVE), blocking);
    let listed = search.collect(simd, &beam, Cover::new(&projection, behind), candidates, stack);
    if candidates.blocked {
        Verdict::Dark
    } else if !listed || candidates.len() > MOST_CANDIDATES {
        Verdict::Unknown
    } else if candidates.is_empty() {
        Verdict::Lit
    } else {
        Verdict::Listed
    }
}

/// Nearness of what lies behind a receiving plane for sure, if the light is well off the plane.
fn behind_plane(projection: &Projection, (normal, point): (Vec3, Vec3)) -> Option<[f32; 3]> {
    let slack = projection.slack;
    let [x, y, z] = [projection.right, projection.up, projection.forward].map(|axis| normal.dot(axis));
    let height = normal.dot(point - projection.apex);
    if projection.parallel {
        // z = (height - x q.x - y q.y) / z-component
        (z.abs() > 1.0 / 16.0).then(|| [x / z, y / z, -height / z - 4.0 * slack / z.abs()])
    } else {
        let off = 4.0 * slack / height.abs();
        (off < 0.25).then(|| [x, y, z].map(|component| component / height * (1.0 - off)))
    }
}

/// The one primitive that all rays leave, if there is one that none can come back to.
fn common_source<S: Simd>(simd: S, queue: &ShadowQueue, range: Range<usize>) -> Option<u32> {
    let first = queue.source[range.start];
    simd.vectorize(
        #[inline(always)]
        || {
            let mut same = first != NO_PRIMITIVE;
            let whole = range.len() / S::u32s::LEN * S::u32s::LEN;
            for at in (range.start..range.start + whole).step_by(S::u32s::LEN) {
                same &= S::u32s::from_slice(simd, &queue.source[at..at + S::u32s::LEN]).simd_eq(first).all_true();
            }
            for &source in &queue.source[range.start + whole..range.end] {
                same &= source == first;
            }
            same.then_some(first)
        },
    )
}

/// Where shadow rays start, in view coordinates.
struct Extent {
    x: [f32; 2],
    y: [f32; 2],
    z: [f32; 2],
    /// Largest magnitude of any coordinate in the world.
    reach: f32,
}

impl Extent {
    /// The extent of the rays' starts; `None` if some are not in front of the apex. There must be a packet's worth.
    #[inline(always)]
    fn of<S: Simd>(simd: S, projection: &Projection, queue: &ShadowQueue, range: Range<usize>) -> Option<Self> {
        let lanes = S::f32s::LEN;
        let (infinity, one) = (S::f32s::splat(simd, f32::INFINITY), S::f32s::splat(simd, 1.0));
        let (mut least, mut most) = (V3::all(infinity), V3::all(-infinity));
        let mut reach = S::f32s::splat(simd, 0.0);
        for at in range.clone().step_by(lanes) {
            // The last packet overlaps the one before rather than look beyond the range.
            let start: V3<S::f32s> = queue.origin.load(simd, at.min(range.end - lanes));
            let view = projection.view(start);
            let inverse = if projection.parallel { one } else { one / view.z };
            let (x, y) = (view.x * inverse, view.y * inverse);
            least = V3::new(least.x.min(x), least.y.min(y), least.z.min(view.z));
            most = V3::new(most.x.max(x), most.y.max(y), most.z.max(view.z));
            reach = reach.max(start.x.abs()).max(start.y.abs()).max(start.z.abs());
        }
        let extent = Self {
            x: [least.x.reduce_min(), most.x.reduce_max()],
            y: [least.y.reduce_min(), most.y.reduce_max()],
            z: [least.z.reduce_min(), most.z.reduce_max()],
            reach: reach.reduce_max(),
        };
        let finite = [extent.x, extent.y, extent.z].iter().flatten().all(|v| v.is_finite());
        (finite && (projection.parallel || extent.z[0] > 0.0)).then_some(extent)
    }
}
