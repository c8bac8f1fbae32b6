//! Triangles: `{ "type": "triangle", "vertices": [[0,0,0],[1,0,0],[0,1,0]] }`, meshes, rectangles and box faces.
//!
//! Watertight: an edge's side test D·((a-O) x (b-a)) depends only on its two ends, taken in a fixed order, so two
//! triangles that share the edge never both miss. Vertices are therefore stored in ascending order of their
//! coordinates, with a sign for the winding. The distance is the combination of the corners' own depths by the
//! edge functions (as in Woop, Benthin and Wald, JCGT 2(1), 2013): it stays between them however edge-on the
//! triangle is seen, which keeps it consistent with bounding boxes.

use super::{Kernel, SurfacePoint, largest};
use crate::geometry::Aabb;
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use glam::Vec3;

/// The triangle kernel. Fields: three corners in ascending order, then +1, or -1 where sorting turned the winding.
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

    /// Barycentric weights of the three stored corners, not yet divided by their sum.
    #[inline(always)]
    fn weights<S: Simd, F: Lanes<S>>(corners: &[V3<F>; 3], origin: V3<F>, direction: V3<F>) -> [F; 3] {
        let [a, b, c] = *corners;
        let (to_a, to_b) = (a - origin, b - origin);
        let opposite_a = direction.dot(to_b.cross(c - b));
        let opposite_b = direction.dot(to_a.cross(c - a));
        let opposite_c = direction.dot(to_a.cross(b - a));
        [opposite_a, -opposite_b, opposite_c]
    }

    /// How far along the ray each corner lies.
    #[inline(always)]
    fn depths<S: Simd, F: Lanes<S>>(corners: &[V3<F>; 3], origin: V3<F>, direction: V3<F>) -> [F; 3] {
        let [a, b, c] = *corners;
        [(a - origin).dot(direction), (b - origin).dot(direction), (c - origin).dot(direction)]
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

    /// Barycentric weights of the stored corners at the hit, summing to 1.
    #[inline(always)]
    pub fn barycentric<S: Simd, F: Lanes<S>>(fields: &[F; 10], origin: V3<F>, direction: V3<F>) -> [F; 3] {
        let [u, v, w] = Self::weights(&Self::corners(fields), origin, direction);
        let sum = u + v + w;
        [u / sum, v / sum, w / sum]
    }
}

impl Kernel<10> for Triangle {
    fn bounds(fields: &[f32; 10]) -> Aabb {
        Aabb::from_points([0, 3, 6].map(|i| Vec3::from_slice(&fields[i..i + 3])))
    }

    #[inline(always)]
    fn intersect<S: Simd, F: Lanes<S>>(fields: &[F; 10], origin: V3<F>, direction: V3<F>, t_min: F) -> (F::Mask, F) {
        let corners = Self::corners(fields);
        let [u, v, w] = Self::weights(&corners, origin, direction);
        // Compared with zero, not by sign bits: -0.0 on an edge is a hit.
        let zero = F::splat(u.token(), 0.0);
        let front = u.simd_ge(zero) & v.simd_ge(zero) & w.simd_ge(zero);
        let back = u.simd_le(zero) & v.simd_le(zero) & w.simd_le(zero);
        let sum = u + v + w;
        let [depth_a, depth_b, depth_c] = Self::depths(&corners, origin, direction);
        let t = (u * depth_a + v * depth_b + w * depth_c) / sum;
        ((front | back) & sum.simd_ne(zero) & t.simd_gt(t_min), t)
    }

    #[inline(always)]
    fn surface<S: Simd, F: Lanes<S>>(fields: &[F; 10], origin: V3<F>, direction: V3<F>, t: F) -> SurfacePoint<F> {
        let [a, b, c] = Self::corners(fields);
        let normal = (b - a).cross(c - a).scale(fields[9]).normalize();
        let reached = origin + direction.scale(t);
        let position = reached - normal.scale(normal.dot(reached - a));
        let scale = largest(a).max(largest(b)).max(largest(c)).max(largest(position));
        SurfacePoint { position, normal, scale }
    }
}
