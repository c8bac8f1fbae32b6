//! What a beam needs to know of each type of primitive: an outline in its view, larger than the kernel's by the
//! margins where it is to be missed, smaller where it is to cover.

mod cone;
mod cutout;
mod disk;
mod plane;
mod sphere;
mod triangle;

use super::projection::{Beam, Cover, Points};
use crate::geometry::primitive::Kernel;
use crate::math::Lanes;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// A primitive type with `N` fields as beams see it: `M` numbers, all relative to the beam's projection.
pub trait Outline<const N: usize, const M: usize>: Kernel<N> {
    /// The numbers of primitives that are given by their fields.
    fn outline<S: Simd, F: Lanes<S>>(fields: &[F; N], beam: &Beam<'_>) -> [F; M];

    /// Where no ray of the beam can hit.
    fn misses<S: Simd, F: Lanes<S>>(outline: &[F; M], beam: &Beam<'_>) -> F::Mask;

    /// Where every ray of the beam hits.
    fn covers<S: Simd, F: Lanes<S>>(outline: &[F; M], beam: &Beam<'_>) -> F::Mask;

    /// Whether [`is_passed_by`](Self::is_passed_by) tells something, and more quickly than the kernel.
    const LOOK_FIRST: bool = false;

    /// Where rays of the beam surely do not hit within `limit`.
    #[inline(always)]
    fn is_passed_by<S: Simd, F: Lanes<S>>(_outline: &[F; M], rays: &Points<F>, _limit: F) -> F::Mask {
        F::Mask::splat(rays.x.token(), false)
    }

    /// Whether surely none of the rays hits, nor any between them: any whose q is a mean of theirs. All must end, or
    /// begin, on one plane.
    #[inline(always)]
    fn lies_beside<S: Simd, F: Lanes<S>>(_outline: &[F; M], _rays: &Points<F>) -> bool {
        false
    }

    /// An upper bound of the nearness of hits, as a product with q.
    fn nearest<S: Simd, F: Lanes<S>>(outline: &[F; M]) -> [F; 3];

    /// A lower bound of the nearness of hits, as a product with q; for what [`covers`](Self::covers).
    fn farthest(outline: &[f32; M], beam: &Beam<'_>) -> [f32; 3];
}

/// Where everything that can be hit lies behind a cover.
#[inline(always)]
pub(super) fn is_behind<S: Simd, F: Lanes<S>>([a, b, c]: [F; 3], beam: &Beam<'_>, cover: &Cover) -> F::Mask {
    let [x, y, z] = cover.nearness;
    beam.range([a - x, b - y, c - z]).1.simd_lt(0.0)
}

/// A nearness that is beaten by nothing.
const NEAREST: f32 = 1e30;

/// A plane is taken for one only if the apex is farther off it than this many times what it may be off by.
const CERTAIN: f32 = 16.0;

/// The nearness of what lies no nearer than view coordinate z, as a product with q.
#[inline(always)]
fn no_nearer_than<S: Simd, F: Lanes<S>>(z: F, beam: &Beam<'_>) -> [F; 3] {
    let simd = z.token();
    let zero = F::splat(simd, 0.0);
    let nearness = if beam.projection.parallel {
        -z
    } else {
        z.simd_gt(zero).select(F::splat(simd, 1.0) / z, F::splat(simd, NEAREST))
    };
    [zero, zero, nearness]
}

/// `a` where the mask is set, else `b`.
#[inline(always)]
fn choose<S: Simd, F: Lanes<S>>(mask: F::Mask, a: [F; 3], b: [F; 3]) -> [F; 3] {
    [mask.select(a[0], b[0]), mask.select(a[1], b[1]), mask.select(a[2], b[2])]
}

/// A form times a number.
#[inline(always)]
fn times<S: Simd, F: Lanes<S>>([a, b, c]: [F; 3], factor: F) -> [F; 3] {
    [a * factor, b * factor, c * factor]
}

/// How far inside of each of the beam's sides a ball reaches. `w` is z in perspective, 1 in parallel projection.
#[inline(always)]
fn ball_heights<S: Simd, F: Lanes<S>>([x, y, w, radius]: [F; 4], beam: &Beam<'_>) -> [F; 4] {
    let [left, right, bottom, top] = beam.side_lengths();
    [
        x - w * beam.x[0] + radius * left,
        w * beam.x[1] - x + radius * right,
        y - w * beam.y[0] + radius * bottom,
        w * beam.y[1] - y + radius * top,
    ]
}

/// Where a ball lies outside of one of the beam's sides.
#[inline(always)]
fn ball_outside<S: Simd, F: Lanes<S>>(ball: [F; 4], beam: &Beam<'_>) -> F::Mask {
    let [left, right, bottom, top] = ball_heights(ball, beam);
    left.min(right).min(bottom.min(top)).simd_lt(0.0)
}
