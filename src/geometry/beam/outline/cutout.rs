//! Triangles with holes: seen like triangles, but they cover nothing.

use super::Outline;
use crate::geometry::beam::projection::{Beam, Points};
use crate::geometry::primitive::{Cutout, Triangle};
use crate::math::Lanes;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

impl Outline<10, 19> for Cutout {
    #[inline(always)]
    fn outline<S: Simd, F: Lanes<S>>(fields: &[F; 10], beam: &Beam<'_>) -> [F; 19] {
        Triangle::outline(fields, beam)
    }

    #[inline(always)]
    fn misses<S: Simd, F: Lanes<S>>(outline: &[F; 19], beam: &Beam<'_>) -> F::Mask {
        Triangle::misses(outline, beam)
    }

    #[inline(always)]
    fn covers<S: Simd, F: Lanes<S>>(outline: &[F; 19], _beam: &Beam<'_>) -> F::Mask {
        F::Mask::splat(outline[0].token(), false)
    }

    const LOOK_FIRST: bool = true;

    #[inline(always)]
    fn is_passed_by<S: Simd, F: Lanes<S>>(outline: &[F; 19], rays: &Points<F>, limit: F) -> F::Mask {
        Triangle::is_passed_by(outline, rays, limit)
    }

    #[inline(always)]
    fn lies_beside<S: Simd, F: Lanes<S>>(outline: &[F; 19], rays: &Points<F>) -> bool {
        Triangle::lies_beside(outline, rays)
    }

    #[inline(always)]
    fn nearest<S: Simd, F: Lanes<S>>(outline: &[F; 19]) -> [F; 3] {
        Triangle::nearest(outline)
    }

    fn farthest(outline: &[f32; 19], beam: &Beam<'_>) -> [f32; 3] {
        Triangle::farthest(outline, beam)
    }
}
