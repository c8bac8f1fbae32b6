//! Spheres: `{ "type": "sphere", "center": [0,0,0], "radius": 1 }`.
//!
//! The discriminant is r² - |l|², with l the vector from the centre to the ray's nearest point: unlike b² - c with
//! c = |C-O|² - r², it does not cancel for small or distant spheres (Haines et al., Ray Tracing Gems ch. 7, 2019).

use super::{Kernel, SurfacePoint, largest, vector};
use crate::geometry::{Aabb, Rays};
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::{DVec3, Vec3};

/// The sphere kernel. Fields: centre x y z, radius.
#[derive(Debug)]
pub struct Sphere;

impl Sphere {
    /// Packs a sphere into fields.
    pub fn fields(center: Vec3, radius: f32) -> [f32; 4] {
        [center.x, center.y, center.z, radius]
    }

    /// The terms that depend on the origin alone: centre minus origin, and r².
    #[inline(always)]
    pub fn origin_terms<S: Simd, F: Lanes<S>>(fields: &[F; 4], origin: V3<F>) -> [F; 4] {
        let to_center = V3::new(fields[0], fields[1], fields[2]) - origin;
        [to_center.x, to_center.y, to_center.z, fields[3] * fields[3]]
    }

    /// As [`origin_terms`](Self::origin_terms), but the last term is the difference |C-O|² - r².
    #[inline(always)]
    pub fn difference_terms<S: Simd, F: Lanes<S>>(fields: &[F; 4], origin: V3<F>) -> [F; 4] {
        let to_center = V3::new(fields[0], fields[1], fields[2]) - origin;
        [to_center.x, to_center.y, to_center.z, to_center.dot(to_center) - fields[3] * fields[3]]
    }

    /// Intersects with [`origin_terms`](Self::origin_terms) at hand.
    #[inline(always)]
    pub fn intersect_terms<S: Simd, F: Lanes<S>>(terms: &[F; 4], direction: V3<F>, t_min: F) -> (F::Mask, F) {
        let to_center = V3::new(terms[0], terms[1], terms[2]);
        let b = to_center.dot(direction);
        let l = to_center - direction.scale(b);
        roots(b, terms[3] - l.dot(l), t_min)
    }

    /// Intersects with [`difference_terms`](Self::difference_terms) at hand. Approximate: b² - c cancels where the sphere is
    /// much farther away than its radius.
    #[inline(always)]
    pub fn intersect_difference<S: Simd, F: Lanes<S>>(terms: &[F; 4], direction: V3<F>, t_min: F) -> (F::Mask, F) {
        let b = V3::new(terms[0], terms[1], terms[2]).dot(direction);
        roots(b, b * b - terms[3], t_min)
    }
}

/// The first of b ∓ √discriminant beyond `t_min`.
#[inline(always)]
fn roots<S: Simd, F: Lanes<S>>(b: F, discriminant: F, t_min: F) -> (F::Mask, F) {
    let zero = F::splat(b.token(), 0.0);
    let meets = discriminant.simd_ge(zero);
    let half_chord = meets.select(discriminant, zero).sqrt();
    let near = b - half_chord;
    let t = near.simd_gt(t_min).select(near, b + half_chord);
    (meets & t.simd_gt(t_min), t)
}

impl Kernel<4> for Sphere {
    fn bounds(fields: &[f32; 4]) -> Aabb {
        let center = Vec3::new(fields[0], fields[1], fields[2]);
        Aabb { min: center - fields[3], max: center + fields[3] }
    }

    fn nearest_to(fields: &[f32; 4], point: DVec3) -> DVec3 {
        let center = vector(fields, 0);
        center + (point - center).normalize_or(DVec3::Y) * f64::from(fields[3])
    }

    #[inline(always)]
    fn intersect<S: Simd, F: Lanes<S>>(fields: &[F; 4], rays: &Rays<F>, t_min: F) -> (F::Mask, F) {
        Self::intersect_terms(&Self::origin_terms(fields, rays.origin), rays.direction, t_min)
    }

    #[inline(always)]
    fn surface<S: Simd, F: Lanes<S>>(fields: &[F; 4], origin: V3<F>, direction: V3<F>, t: F) -> SurfacePoint<F> {
        let center = V3::new(fields[0], fields[1], fields[2]);
        // Of a sphere that is smaller than the rounding of its distance, the hit may be the centre.
        let normal = (direction.scale(t) - (center - origin)).normalize_or(-direction);
        let position = center + normal.scale(fields[3]);
        SurfacePoint { position, normal, scale: largest(center) + fields[3] }
    }
}
