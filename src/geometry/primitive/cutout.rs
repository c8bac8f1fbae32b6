//! Triangles with holes: the kernel of triangles, and a look at the [holes](crate::geometry::holes) where it hits.

use super::{Kernel, SurfacePoint, Triangle};
use crate::geometry::{Aabb, Rays};
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use glam::DVec3;

/// The kernel of triangles with holes. Fields: as of [`Triangle`].
#[derive(Debug)]
pub struct Cutout;

impl Kernel<10> for Cutout {
    const NEEDS_FRAME: bool = true;
    const HAS_HOLES: bool = true;
    const HAS_SIDES: bool = true;

    fn bounds(fields: &[f32; 10]) -> Aabb {
        Triangle::bounds(fields)
    }

    /// Of the whole triangle, holes and all.
    fn nearest_to(fields: &[f32; 10], point: DVec3) -> DVec3 {
        Triangle::nearest_to(fields, point)
    }

    #[inline(always)]
    fn intersect<S: Simd, F: Lanes<S>>(fields: &[F; 10], rays: &Rays<F>, t_min: F) -> (F::Mask, F) {
        Triangle::intersect(fields, rays, t_min)
    }

    #[inline(always)]
    fn intersect_front<S: Simd, F: Lanes<S>>(fields: &[F; 10], rays: &Rays<F>, t_min: F) -> (F::Mask, F) {
        Triangle::intersect_front(fields, rays, t_min)
    }

    #[inline(always)]
    fn surface<S: Simd, F: Lanes<S>>(fields: &[F; 10], origin: V3<F>, direction: V3<F>, t: F) -> SurfacePoint<F> {
        Triangle::surface(fields, origin, direction, t)
    }
}
