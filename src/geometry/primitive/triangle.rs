//! Triangles: `{ "type": "triangle", "vertices": [[0,0,0],[1,0,0],[0,1,0]] }`, meshes, rectangles and box faces.
//!
//! Watertight (after Woop, Benthin and Wald, JCGT 2(1), 2013): each corner is projected along the ray to a point of a
//! plane, by arithmetic that knows of no other corner. An edge function is then a difference of two products, whose
//! sign is never the wrong one: rounding can only make it 0, which counts as inside. So whatever the rounding, a ray
//! into a closed mesh meets one of the triangles around an edge or a corner. The distance is the combination of the
//! corners' own depths by the edge functions, within the triangle's box.

use super::{HIT_PADDING, Kernel, SurfacePoint, largest, vector};
use crate::geometry::{Aabb, Rays};
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::{DVec3, Vec3};

/// Half a unit in the last place.
const ROUNDING: f32 = 1.0 / (1 << 24) as f32;

/// Scales the last field of triangles that are seen from one side only.
const ONE_SIDED: f32 = 2.0;

/// The triangle kernel. Fields: three corners in ascending order, then +1, or -1 where sorting turned the winding; +2 or
/// -2 if it is seen only from where its corners are counter-clockwise.
#[derive(Debug)]
pub struct Triangle;

impl Triangle {
    /// Packs a triangle into fields.
    pub fn fields(vertices: [Vec3; 3]) -> [f32; 10] {
        let order = Self::stored_order(vertices);
        let [a, b, c] = order.map(|i| vertices[i]);
        // Even permutations of (0, 1, 2) keep the winding.
        let winding = if (order[0] + 1) % 3 == order[1] { 1.0 } else { -1.0 };
        [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, winding]
    }

    /// Packs a triangle that may be seen from one side only into fields.
    pub fn fields_of(vertices: [Vec3; 3], one_sided: bool) -> [f32; 10] {
        let mut fields = Self::fields(vertices);
        if one_sided {
            // Normals are scaled by it before they are normalised: a power of two leaves their bits as they are.
            fields[9] *= ONE_SIDED;
        }
        fields
    }

    /// Whether a triangle is seen from one side only, by its last field.
    pub fn has_one_side(winding: f32) -> bool {
        winding.abs() > 1.0
    }

    /// [`has_one_side`](Self::has_one_side), in lanes.
    #[inline(always)]
    pub fn is_one_sided<S: Simd, F: Lanes<S>>(winding: F) -> F::Mask {
        winding.abs().simd_gt(1.0)
    }

    /// Which of the given vertices comes first, second and third in the fields.
    pub fn stored_order(vertices: [Vec3; 3]) -> [usize; 3] {
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| {
            let (a, b) = (vertices[i].to_array(), vertices[j].to_array());
            a.iter().zip(&b).map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
        });
        order
    }

    /// Whether the corners span no area in f64.
    pub fn is_degenerate(vertices: [Vec3; 3]) -> bool {
        let [a, b, c] = vertices.map(|v| v.as_dvec3());
        (b - a).cross(c - a).length_squared() == 0.0
    }

    /// The stored corners in the plane across a ray, relative to it.
    #[inline(always)]
    fn projected<S: Simd, F: Lanes<S>>(corners: &[V3<F>; 3], rays: &Rays<F>) -> [[F; 2]; 3] {
        let Rays { origin, across: [right, up], .. } = *rays;
        let [a, b, c] = [corners[0] - origin, corners[1] - origin, corners[2] - origin];
        [[a.dot(right), a.dot(up)], [b.dot(right), b.dot(up)], [c.dot(right), c.dot(up)]]
    }

    /// Barycentric weights of three projected corners, not yet divided by their sum.
    #[inline(always)]
    fn weights<S: Simd, F: Lanes<S>>([[ax, ay], [bx, by], [cx, cy]]: [[F; 2]; 3]) -> [F; 3] {
        [bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx]
    }

    /// Whether a ray passes through the rectangle around three projected corners. All weights of a triangle that is
    /// seen edge-on may round to 0 anywhere on its line; this keeps hits to the part of the line that it takes up.
    #[inline(always)]
    fn is_around<S: Simd, F: Lanes<S>>([[ax, ay], [bx, by], [cx, cy]]: [[F; 2]; 3]) -> F::Mask {
        let zero = F::splat(ax.token(), 0.0);
        ax.min(bx).min(cx).simd_le(zero)
            & ax.max(bx).max(cx).simd_ge(zero)
            & ay.min(by).min(cy).simd_le(zero)
            & ay.max(by).max(cy).simd_ge(zero)
    }

    /// How far along the ray each corner lies.
    #[inline(always)]
    fn depths<S: Simd, F: Lanes<S>>(corners: &[V3<F>; 3], rays: &Rays<F>) -> [F; 3] {
        let [a, b, c] = *corners;
        let Rays { origin, direction, .. } = *rays;
        [(a - origin).dot(direction), (b - origin).dot(direction), (c - origin).dot(direction)]
    }

    /// Where a ray enters and leaves the box around the corners, widened by [`HIT_PADDING`]. Of a triangle seen edge-on,
    /// or of a needle, the weights are all but rounding errors: what they say of the distance is held to this. (Asking
    /// first whether that is needed made no frame faster.)
    #[inline(always)]
    fn box_interval<S: Simd, F: Lanes<S>>(corners: &[V3<F>; 3], rays: &Rays<F>) -> (F, F) {
        let [a, b, c] = *corners;
        let Rays { origin, inverse, .. } = *rays;
        let padding = (largest(a).max(largest(b)).max(largest(c)) + largest(origin)) * HIT_PADDING;
        let (near_x, far_x) = Self::slab([a.x, b.x, c.x], padding, origin.x, inverse.x);
        let (near_y, far_y) = Self::slab([a.y, b.y, c.y], padding, origin.y, inverse.y);
        let (near_z, far_z) = Self::slab([a.z, b.z, c.z], padding, origin.z, inverse.z);
        (near_x.max(near_y).max(near_z), far_x.min(far_y).min(far_z))
    }

    /// [`box_interval`](Self::box_interval) along one axis.
    #[inline(always)]
    fn slab<S: Simd, F: Lanes<S>>(corners: [F; 3], padding: F, origin: F, inverse: F) -> (F, F) {
        let [a, b, c] = corners;
        let to_min = (a.min(b).min(c) - padding - origin) * inverse;
        let to_max = (a.max(b).max(c) + padding - origin) * inverse;
        (to_min.min(to_max), to_min.max(to_max))
    }

    /// Whether a point lies in the plane of the corners, as far as its coordinates and the arithmetic can tell. A ray from
    /// there would hit or not by the rounding of a distance of zero, and an eye on a wall would see noise.
    #[inline(always)]
    fn holds<S: Simd, F: Lanes<S>>(corners: &[V3<F>; 3], point: V3<F>) -> F::Mask {
        let [a, b, c] = *corners;
        let (normal, from) = ((b - a).cross(c - a), a - point);
        let [x, y, z] = [normal.x * from.x, normal.y * from.y, normal.z * from.z];
        // Axis by axis: the size of a large floor says nothing about the height above it.
        let terms = x.abs() + y.abs() + z.abs();
        let own = (normal.x * point.x).abs() + (normal.y * point.y).abs() + (normal.z * point.z).abs();
        let in_plane = (x + y + z).abs().simd_le((terms * 8.0 + own) * ROUNDING);
        // Areas that leave the range of f32 tell nothing.
        in_plane & largest(normal).simd_gt(0.0)
    }

    /// Unit normal by the winding of the corners. A needle that rounding leaves without one gets one that faces the ray.
    #[inline(always)]
    fn normal<S: Simd, F: Lanes<S>>([a, b, c]: [V3<F>; 3], winding: F, direction: V3<F>) -> V3<F> {
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac).scale(winding);
        let squared = normal.dot(normal);
        let simd = squared.token();
        let usable = squared.simd_ge(F::splat(simd, f32::MIN_POSITIVE)) & squared.simd_le(F::splat(simd, f32::MAX));
        if usable.all_true() {
            return normal.normalize();
        }
        // Squares of areas leave the range of f32 where edges are some 1e-10 or 1e9 long.
        let unit = F::splat(simd, 1.0);
        let (ab, ac) = (ab.scale(unit / largest(ab)), ac.scale(unit / largest(ac)));
        let along = ac.normalize();
        let across = (along.scale(along.dot(direction)) - direction).normalize_or(-direction);
        let scaled = ab.cross(ac).scale(winding).normalize_or(across);
        V3::select(usable, normal.normalize(), scaled)
    }

    /// The stored corners of a triangle given by its fields.
    #[inline(always)]
    fn corners<F: Copy>(fields: &[F; 10]) -> [V3<F>; 3] {
        [
            V3::new(fields[0], fields[1], fields[2]),
            V3::new(fields[3], fields[4], fields[5]),
            V3::new(fields[6], fields[7], fields[8]),
        ]
    }

    /// The one test of a triangle. If `FRONTS`, the backs of those that are seen from one side only are not hit.
    #[inline(always)]
    fn hit<S: Simd, F: Lanes<S>, const FRONTS: bool>(fields: &[F; 10], rays: &Rays<F>, t_min: F) -> (F::Mask, F) {
        let corners = Self::corners(fields);
        let projected = Self::projected(&corners, rays);
        let [u, v, w] = Self::weights(projected);
        // Compared with zero, not by sign bits: -0.0 on an edge is a hit.
        let zero = F::splat(u.token(), 0.0);
        let front = u.simd_ge(zero) & v.simd_ge(zero) & w.simd_ge(zero);
        let back = u.simd_le(zero) & v.simd_le(zero) & w.simd_le(zero);
        let sum = u + v + w;
        let mut inside = (front | back) & sum.simd_ne(zero);
        if FRONTS {
            // The ray flies along the normal where the weights are positive: their frame is right-handed around it. Their
            // signs decide for the very rays that hit, so that a closed surface has no gap between front and back.
            inside &= !(Self::is_one_sided(fields[9]) & (sum * fields[9]).simd_gt(zero));
        }
        if !inside.any_true() {
            return (inside, zero);
        }
        let inside = inside & Self::is_around(projected);
        let [depth_a, depth_b, depth_c] = Self::depths(&corners, rays);
        let t = (u * depth_a + v * depth_b + w * depth_c) / sum;
        let (near, far) = Self::box_interval(&corners, rays);
        let t = t.simd_lt(near).select(near, t);
        let t = t.simd_gt(far).select(far, t);
        let hit = inside & near.simd_le(far) & t.simd_gt(t_min);
        let starts_in_box = hit & near.simd_le(zero);
        if starts_in_box.any_true() {
            return (hit & !(starts_in_box & Self::holds(&corners, rays.origin)), t);
        }
        (hit, t)
    }

    /// Barycentric weights of the stored corners at the hit, summing to 1.
    #[inline(always)]
    pub fn barycentric<S: Simd, F: Lanes<S>>(fields: &[F; 10], rays: &Rays<F>) -> [F; 3] {
        let [u, v, w] = Self::weights(Self::projected(&Self::corners(fields), rays));
        let sum = u + v + w;
        [u / sum, v / sum, w / sum]
    }
}

impl Kernel<10> for Triangle {
    const NEEDS_FRAME: bool = true;
    const HAS_SIDES: bool = true;

    fn bounds(fields: &[f32; 10]) -> Aabb {
        Aabb::from_points([0, 3, 6].map(|i| Vec3::from_slice(&fields[i..i + 3])))
    }

    /// Over the inside, where the point lies within all three edges; else on the nearest edge.
    fn nearest_to(fields: &[f32; 10], point: DVec3) -> DVec3 {
        let corners = [0, 3, 6].map(|first| vector(fields, first));
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let is_inside = |i: usize| {
            let (from, to) = (corners[i], corners[(i + 1) % 3]);
            normal.cross(to - from).dot(point - from) >= 0.0
        };
        if normal != DVec3::ZERO && (0..3).all(is_inside) {
            return point - normal * (normal.dot(point - a) / normal.length_squared());
        }
        let on_edge = |i: usize| {
            let (from, to) = (corners[i], corners[(i + 1) % 3]);
            let edge = to - from;
            let share = edge.dot(point - from) / edge.length_squared();
            // Of an edge without length the share is no number, and its start as good as its end.
            if share > 0.0 { from + edge * share.min(1.0) } else { from }
        };
        let candidates = [0, 1, 2].map(on_edge);
        let nearer = |p: DVec3, q: DVec3| if q.distance_squared(point) < p.distance_squared(point) { q } else { p };
        candidates.into_iter().fold(candidates[0], nearer)
    }

    #[inline(always)]
    fn intersect<S: Simd, F: Lanes<S>>(fields: &[F; 10], rays: &Rays<F>, t_min: F) -> (F::Mask, F) {
        Self::hit::<S, F, false>(fields, rays, t_min)
    }

    #[inline(always)]
    fn intersect_front<S: Simd, F: Lanes<S>>(fields: &[F; 10], rays: &Rays<F>, t_min: F) -> (F::Mask, F) {
        Self::hit::<S, F, true>(fields, rays, t_min)
    }

    #[inline(always)]
    fn surface<S: Simd, F: Lanes<S>>(fields: &[F; 10], origin: V3<F>, direction: V3<F>, t: F) -> SurfacePoint<F> {
        let corners = Self::corners(fields);
        let [a, b, c] = corners;
        let normal = Self::normal(corners, fields[9], direction);
        let reached = origin + direction.scale(t);
        let position = reached - normal.scale(normal.dot(reached - a));
        let scale = largest(a).max(largest(b)).max(largest(c)).max(largest(position));
        SurfacePoint { position, normal, scale }
    }
}
