//! Many shadow rays at once: a beam from the light tells whether all arrive, or none, or what can be in their way.

use crate::geometry::beam::{Beam, Blocking, Candidates, Cover, Points, Projection};
use crate::geometry::{NO_PRIMITIVE, Opaque, PrimitiveIndex, Search, Stack};
use crate::math::{Lanes, V3};
use crate::render::extent::Extent;
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

/// More candidates are not worth testing one by one.
const MOST_CANDIDATES: usize = 64;

/// Wider beams (width over depth) list too much.
const WIDEST: f32 = 0.5;

/// Covers must be farther from a light than so many times what beams allow for: rays end a little before it.
const LEAST_DISTANCE: f32 = 32.0;

/// A light's view of the starts of shadow rays that lie close together.
pub(super) struct Judge<'a> {
    search: Search<'a>,
    opaque: Opaque<'a>,
    projection: Projection,
    /// What nothing that matters lies behind.
    receiver: Cover,
    /// The one primitive that all rays leave and cannot come back to.
    source: PrimitiveIndex,
    extent: Extent,
    /// How far beyond the rays the beam goes, as a share of their extent.
    bulge: f32,
}

impl<'a> Judge<'a> {
    /// A judge of the shadow rays in `range` of a light's queue; `None` if they are too far apart.
    pub fn new<S: Simd>(
        simd: S,
        frame: &'a Frame<'_>,
        search: Search<'a>,
        light: LightKind,
        queue: &ShadowQueue,
        range: Range<usize>,
        bulge: f32,
    ) -> Option<Self> {
        let middle = queue.origin.get(range.start + range.len() / 2);
        let (apex, forward, parallel) = match light {
            LightKind::Point { position } | LightKind::Spot { position, .. } => (position, middle - position, false),
            LightKind::Directional { direction } => (middle, direction, true),
        };
        let forward = forward.try_normalize()?;
        let right = forward.any_orthonormal_vector();
        let axes = [right, right.cross(forward), forward];
        let extent =
            Extent::of(simd, &Projection::new(apex, axes, parallel, 0.0, 0.0), &queue.origin, None, range.clone())?
                .widened(bulge);
        let reach = search.geometry.reach().max(extent.reach);
        let projection = Projection::new(apex, axes, parallel, reach, frame.beam_margin);
        let slack = projection.slack;
        if !parallel && (extent.z[0] < LEAST_DISTANCE * slack || extent.width() > WIDEST) {
            return None;
        }
        let source = common_source(simd, queue, range);
        let behind = source
            .and_then(|source| search.geometry.plane_of(source))
            .and_then(|plane| behind_plane(&projection, plane))
            .unwrap_or([0.0, 0.0, nearness(&projection, extent.z[1] + 4.0 * slack)]);
        let receiver = Cover::new(&projection, behind);
        let (opaque, source) = (frame.tables.opaque(search.geometry), source.unwrap_or(NO_PRIMITIVE));
        Some(Self { search, opaque, projection, receiver, source, extent, bulge })
    }

    /// Judges all of the rays, leaving what can be in their way in `candidates`.
    pub fn judge<S: Simd>(&self, simd: S, candidates: &mut Candidates, stack: &mut Stack) -> Verdict {
        let beam = self.beam(&self.extent);
        let listed = self.search.collect(simd, &beam, self.receiver, candidates, stack);
        if listed { Verdict::of(candidates) } else { Verdict::Unknown }
    }

    /// Judges some of the rays by the candidates of all, leaving what can be in their way in `own`.
    pub fn judge_part<S: Simd>(
        &self,
        simd: S,
        queue: &ShadowQueue,
        part: Range<usize>,
        candidates: &Candidates,
        own: &mut Candidates,
    ) -> Verdict {
        let Some(extent) = Extent::of(simd, &self.projection, &queue.origin, None, part) else {
            return Verdict::Unknown;
        };
        own.filter(simd, candidates, &self.beam(&extent.widened(self.bulge)));
        Verdict::of(own)
    }

    /// Rays to the given starts, as the light sees them.
    #[inline(always)]
    pub fn points<S: Simd, F: Lanes<S>>(&self, starts: V3<F>) -> Points<F> {
        Points::to(&self.projection, starts)
    }

    /// The beam from the light to starts of the given extent.
    fn beam(&self, extent: &Extent) -> Beam<'_> {
        let slack = self.projection.slack;
        let least_distance = if self.projection.parallel { 0.0 } else { LEAST_DISTANCE * slack };
        let least_nearness = nearness(&self.projection, extent.z[0] - 4.0 * slack);
        let blocking = Blocking { opaque: self.opaque, least_nearness };
        Beam::new(&self.projection, extent.x, extent.y).beyond(least_distance).asking(
            self.source,
            blocking,
            MOST_CANDIDATES,
        )
    }
}

impl Verdict {
    /// The verdict that a complete list of candidates means.
    fn of(candidates: &Candidates) -> Self {
        if candidates.blocked {
            Self::Dark
        } else if candidates.is_empty() {
            Self::Lit
        } else {
            Self::Listed
        }
    }
}

/// The nearness at depth z.
fn nearness(projection: &Projection, z: f32) -> f32 {
    if projection.parallel { -z } else { 1.0 / z }
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
