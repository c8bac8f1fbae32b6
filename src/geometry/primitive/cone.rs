//! Open sides of cylinders and truncated cones:
//! `{ "type": "cone", "base": [0,0,0], "top": [0,1,0], "radius": 0.3, "radius_top": 0.1 }`.
//!
//! The quadratic is solved from the ray's point nearest to the cone's middle, and by the form of the roots that never
//! subtracts nearly equal numbers. Nearest in proportion to the cone, in which heights weigh as much as the radius
//! beside them and its change with them, so that the quadratic's terms are no larger than the cone's radius: a flat
//! cone's wall soon grows far beyond the cone, and along a needle most of the ray is far from the axis.

use super::{Kernel, SurfacePoint, largest, vector};
use crate::geometry::{Aabb, Rays};
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::{DVec3, Vec3};

/// The cone kernel. Fields: middle of the axis x y z, unit axis x y z, half of the height, radius at the middle,
/// growth of the radius per unit of height.
#[derive(Debug)]
pub struct Cone;

impl Cone {
    /// Packs a cone or cylinder into fields. Computed in f64, rounded once.
    pub fn fields(base: Vec3, top: Vec3, radius_base: f32, radius_top: f32) -> [f32; 9] {
        let (base, top) = (base.as_dvec3(), top.as_dvec3());
        let height = (top - base).length();
        let axis = ((top - base) / height).as_vec3();
        let middle = ((base + top) * 0.5).as_vec3();
        let (r0, r1) = (f64::from(radius_base), f64::from(radius_top));
        let radius = ((r0 + r1) * 0.5) as f32;
        let slope = ((r1 - r0) / height) as f32;
        [middle.x, middle.y, middle.z, axis.x, axis.y, axis.z, (height * 0.5) as f32, radius, slope]
    }
}

/// Share of a cone's radius below which its wall counts as its tip.
const NEAR_TIP: f32 = 1.0 / 16.0;

/// A point of a ray, as the cone's quadratic is written down from there.
#[derive(Clone, Copy)]
struct Expansion<F> {
    /// Its distance along the ray.
    t: F,
    /// Its height above the cone's middle.
    height: F,
    /// From the axis to it.
    across: V3<F>,
    /// The cone's radius at its height.
    wall: F,
}

impl<F> Expansion<F> {
    #[inline(always)]
    fn at<S: Simd>(fields: &[F; 9], to_middle: V3<F>, direction: V3<F>, t: F) -> Self
    where
        F: Lanes<S>,
    {
        let axis = V3::new(fields[3], fields[4], fields[5]);
        let [radius, slope] = [fields[7], fields[8]];
        let point = direction.scale(t) - to_middle;
        let height = point.dot(axis);
        Self { t, height, across: point - axis.scale(height), wall: radius + slope * height }
    }
}

impl Kernel<9> for Cone {
    fn bounds(fields: &[f32; 9]) -> Aabb {
        let (middle, axis) = (Vec3::from_slice(&fields[0..3]), Vec3::from_slice(&fields[3..6]));
        let [half_height, radius, slope] = [fields[6], fields[7], fields[8]];
        let end = |height: f32| Aabb::of_disk(middle + axis * height, axis, radius + slope * height);
        end(-half_height).union(end(half_height))
    }

    /// In the half-plane from the axis through the point, the wall is a segment.
    fn nearest_to(fields: &[f32; 9], point: DVec3) -> DVec3 {
        let (middle, axis) = (vector(fields, 0), vector(fields, 3));
        let [half_height, radius, slope] = [fields[6], fields[7], fields[8]].map(f64::from);
        let from_middle = point - middle;
        let height = from_middle.dot(axis);
        let across = from_middle - axis * height;
        let outward = across.normalize_or(axis.any_orthonormal_vector());
        // Along (1, slope) in height and distance from the axis, from the middle's (0, radius).
        let along = (height + slope * (across.length() - radius)) / (1.0 + slope * slope);
        let along = along.clamp(-half_height, half_height);
        middle + axis * along + outward * (radius + slope * along).max(0.0)
    }

    #[inline(always)]
    fn intersect<S: Simd, F: Lanes<S>>(fields: &[F; 9], rays: &Rays<F>, t_min: F) -> (F::Mask, F) {
        let Rays { origin, direction, .. } = *rays;
        let middle = V3::new(fields[0], fields[1], fields[2]);
        let axis = V3::new(fields[3], fields[4], fields[5]);
        let [half_height, radius, slope] = [fields[6], fields[7], fields[8]];
        let zero = F::splat(t_min.token(), 0.0);

        let to_middle = middle - origin;
        let (ascent, climb) = (to_middle.dot(axis), direction.dot(axis));
        let across_step = direction - axis.scale(climb);
        let taper = radius / half_height;
        let height_weight = slope * slope + taper * taper;
        let nearest_t = ((to_middle - axis.scale(ascent)).dot(across_step) + height_weight * ascent * climb)
            / (across_step.dot(across_step) + height_weight * climb * climb);
        let wall_step = slope * climb;
        let a = across_step.dot(across_step) - wall_step * wall_step;
        let mut from = Expansion::at(fields, to_middle, direction, nearest_t);
        let mut b = from.across.dot(across_step) - from.wall * wall_step;
        // Near its tip a cone is far smaller than the terms of this quadratic, whose rounding errors would move a hit
        // by their square root: there it is solved from halfway between its roots.
        let halfway = -b / a;
        let at_tip = (from.wall + wall_step * halfway).abs().simd_lt(radius * NEAR_TIP)
            & (from.height + climb * halfway).abs().simd_lt(half_height * (1.0 + NEAR_TIP));
        if at_tip.any_true() {
            let t = at_tip.select(nearest_t + halfway, nearest_t);
            from = Expansion::at(fields, to_middle, direction, t);
            b = from.across.dot(across_step) - from.wall * wall_step;
        }
        let c = from.across.dot(from.across) - from.wall * from.wall;
        let discriminant = b * b - a * c;
        let meets = discriminant.simd_ge(zero);
        let root = meets.select(discriminant, zero).sqrt();
        let q = -(b + b.simd_lt(zero).select(-root, root));
        let (s0, s1) = (q / a, c / q);
        // A root that is not a number (no quadratic, or a ray along the wall) fails every comparison below.
        let valid0 = (from.height + climb * s0).abs().simd_le(half_height) & (from.t + s0).simd_gt(t_min);
        let valid1 = (from.height + climb * s1).abs().simd_le(half_height) & (from.t + s1).simd_gt(t_min);
        let first = valid0 & (!valid1 | s0.simd_le(s1));
        (meets & (valid0 | valid1), from.t + first.select(s0, s1))
    }

    #[inline(always)]
    fn surface<S: Simd, F: Lanes<S>>(fields: &[F; 9], origin: V3<F>, direction: V3<F>, t: F) -> SurfacePoint<F> {
        let middle = V3::new(fields[0], fields[1], fields[2]);
        let axis = V3::new(fields[3], fields[4], fields[5]);
        let [half_height, radius, slope] = [fields[6], fields[7], fields[8]];
        let from_middle = direction.scale(t) - (middle - origin);
        let height = from_middle.dot(axis);
        // At a tip, or where a needle is thinner than rounding errors, nothing is outward.
        let outward = (from_middle - axis.scale(height)).normalize_or(V3::all(F::splat(t.token(), 0.0)));
        let position = middle + axis.scale(height) + outward.scale(radius + slope * height);
        let normal = (outward - axis.scale(slope)).normalize_or(-direction);
        SurfacePoint { position, normal, scale: largest(middle) + half_height + radius }
    }
}
