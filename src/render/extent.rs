//! How far apart the rays of a run are, as a beam sees them.

use super::queue::Columns;
use crate::geometry::beam::{Candidates, Projection};
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::ops::Range;

/// Fewer candidates are not worth being sifted for parts of a run.
pub const FEW: usize = 3;

/// Rays in such a part.
const PART: usize = 64;

/// What the rays of a run can meet, and those of a part of it.
#[derive(Debug, Default)]
pub struct Lists {
    pub whole: Candidates,
    pub part: Candidates,
}

/// The parts of a run.
pub fn parts(run: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let parts = (run.len() / PART).max(1);
    let at = move |part: usize| run.start + run.len() * part / parts;
    (0..parts).map(move |part| at(part)..at(part + 1))
}

/// Where rays start, in view coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Least and greatest x of rays q = (x, y, 1) to the starts. If directions are given, of all points of the rays: seen
    /// from the apex, they lie between start and direction.
    pub x: [f32; 2],
    /// See `x`.
    pub y: [f32; 2],
    /// Least and greatest depth of starts.
    pub z: [f32; 2],
    /// Largest magnitude of any coordinate of starts in the world.
    pub reach: f32,
    /// Within how much, along x and y, lines pass the apex; 0 if no directions are given.
    pub beside: f32,
}

impl Extent {
    /// Flatter rays (cosine against `forward`) are too far apart.
    const LEAST_COSINE: f32 = 0.5;

    /// The extent of some rays, in perspective if directions are given; `None` if some are not in front of the apex.
    pub fn of<S: Simd>(
        simd: S,
        projection: &Projection,
        starts: &Columns,
        directions: Option<&Columns>,
        range: Range<usize>,
    ) -> Option<Self> {
        simd.vectorize(
            #[inline(always)]
            || {
                let lanes = S::f32s::LEN;
                // Of fewer rays than lanes the first stands for the lanes without one.
                let inside = <S::f32s as SimdBase<S>>::Mask::from_bitmask(simd, (1 << range.len().min(lanes)) - 1);
                let first_start = V3::splat(simd, starts.get(range.start));
                let (infinity, one) = (S::f32s::splat(simd, f32::INFINITY), S::f32s::splat(simd, 1.0));
                let (mut least, mut most) = (V3::all(infinity), V3::all(-infinity));
                let (mut reach, mut beside) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 0.0));
                let mut least_cosine = one;
                for at in range.clone().step_by(lanes) {
                    // The last packet overlaps the one before rather than look beyond the range.
                    let at = at.min(range.end.saturating_sub(lanes).max(range.start));
                    let start: V3<S::f32s> = V3::select(inside, starts.load(simd, at), first_start);
                    let view = projection.view(start);
                    let inverse = if projection.parallel { one } else { one / view.z };
                    let (x, y) = (view.x * inverse, view.y * inverse);
                    least = V3::new(least.x.min(x), least.y.min(y), least.z.min(view.z));
                    most = V3::new(most.x.max(x), most.y.max(y), most.z.max(view.z));
                    reach = reach.max(start.x.abs()).max(start.y.abs()).max(start.z.abs());
                    if let Some(directions) = directions {
                        let ahead = projection.turn(V3::select(
                            inside,
                            directions.load(simd, at),
                            V3::splat(simd, directions.get(range.start)),
                        ));
                        let inverse = one / ahead.z;
                        let (to_x, to_y) = (ahead.x * inverse, ahead.y * inverse);
                        least = V3::new(least.x.min(to_x), least.y.min(to_y), least.z);
                        most = V3::new(most.x.max(to_x), most.y.max(to_y), most.z);
                        least_cosine = least_cosine.min(ahead.z);
                        beside = beside.max((to_x - x).abs().max((to_y - y).abs()) * view.z);
                    }
                }
                let extent = Self {
                    x: [least.x.reduce_min(), most.x.reduce_max()],
                    y: [least.y.reduce_min(), most.y.reduce_max()],
                    z: [least.z.reduce_min(), most.z.reduce_max()],
                    reach: reach.reduce_max(),
                    beside: beside.reduce_max(),
                };
                let mut usable = least_cosine.reduce_min() >= Self::LEAST_COSINE;
                for [from, to] in [extent.x, extent.y, extent.z] {
                    usable &= from.is_finite() && to.is_finite();
                }
                (usable && (projection.parallel || extent.z[0] > 0.0)).then_some(extent)
            },
        )
    }

    /// The extent with so large a share of its size more on every side.
    pub fn widened(self, share: f32) -> Self {
        let by = share * self.width();
        let more = |[from, to]: [f32; 2], by: f32| [from - by, to + by];
        Self { x: more(self.x, by), y: more(self.y, by), z: more(self.z, share * (self.z[1] - self.z[0])), ..self }
    }

    /// The larger of its width and height.
    pub fn width(&self) -> f32 {
        (self.x[1] - self.x[0]).max(self.y[1] - self.y[0])
    }
}
