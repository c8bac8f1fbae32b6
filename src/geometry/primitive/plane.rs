//! Infinite planes: `{ "type": "plane", "point": [0,-1,0], "normal": [0,1,0] }`.

use super::{Kernel, SurfacePoint, largest, vector};
use crate::geometry::{Aabb, Rays};
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use glam::{DVec3, Vec3};

/// The plane kernel. Fields: unit normal x y z, distance of the plane from the world's origin along it.
#[derive(Debug)]
pub struct Plane;

impl Plane {
    /// Packs a plane into fields.
    pub fn fields(point: Vec3, normal: Vec3) -> [f32; 4] {
        let distance = point.as_dvec3().dot(normal.as_dvec3()) as f32;
        [normal.x, normal.y, normal.z, distance]
    }
}

impl Kernel<4> for Plane {
    fn bounds(_: &[f32; 4]) -> Aabb {
        Aabb::INFINITE
    }

    fn nearest_to(fields: &[f32; 4], point: DVec3) -> DVec3 {
        let normal = vector(fields, 0);
        point + normal * (f64::from(fields[3]) - normal.dot(point))
    }

    #[inline(always)]
    fn intersect<S: Simd, F: Lanes<S>>(fields: &[F; 4], rays: &Rays<F>, t_min: F) -> (F::Mask, F) {
        let Rays { origin, direction, .. } = *rays;
        let normal = V3::new(fields[0], fields[1], fields[2]);
        let t = (fields[3] - normal.dot(origin)) / normal.dot(direction);
        (t.simd_gt(t_min), t)
    }

    #[inline(always)]
    fn surface<S: Simd, F: Lanes<S>>(fields: &[F; 4], origin: V3<F>, direction: V3<F>, t: F) -> SurfacePoint<F> {
        let normal = V3::new(fields[0], fields[1], fields[2]);
        let reached = origin + direction.scale(t);
        let position = reached + normal.scale(fields[3] - normal.dot(reached));
        SurfacePoint { position, normal, scale: largest(position) + fields[3].abs() }
    }
}
