//! Disks: `{ "type": "disk", "center": [0,0,0], "normal": [0,1,0], "radius": 1 }`, and the caps of cylinders and cones.

use super::{Kernel, SurfacePoint, largest, vector};
use crate::geometry::{Aabb, Rays};
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use glam::{DVec3, Vec3};

/// The disk kernel. Fields: centre x y z, unit normal x y z, radius.
#[derive(Debug)]
pub struct Disk;

impl Disk {
    /// Packs a disk into fields.
    pub fn fields(center: Vec3, normal: Vec3, radius: f32) -> [f32; 7] {
        [center.x, center.y, center.z, normal.x, normal.y, normal.z, radius]
    }
}

impl Kernel<7> for Disk {
    fn bounds(fields: &[f32; 7]) -> Aabb {
        Aabb::of_disk(Vec3::from_slice(&fields[0..3]), Vec3::from_slice(&fields[3..6]), fields[6])
    }

    fn nearest_to(fields: &[f32; 7], point: DVec3) -> DVec3 {
        let (center, normal) = (vector(fields, 0), vector(fields, 3));
        let from_center = point - center;
        let in_plane = from_center - normal * normal.dot(from_center);
        center + in_plane.clamp_length_max(f64::from(fields[6]))
    }

    #[inline(always)]
    fn intersect<S: Simd, F: Lanes<S>>(fields: &[F; 7], rays: &Rays<F>, t_min: F) -> (F::Mask, F) {
        let Rays { origin, direction, .. } = *rays;
        let to_center = V3::new(fields[0], fields[1], fields[2]) - origin;
        let normal = V3::new(fields[3], fields[4], fields[5]);
        let t = normal.dot(to_center) / normal.dot(direction);
        let from_center = direction.scale(t) - to_center;
        let inside = from_center.dot(from_center).simd_le(fields[6] * fields[6]);
        (inside & t.simd_gt(t_min), t)
    }

    #[inline(always)]
    fn surface<S: Simd, F: Lanes<S>>(fields: &[F; 7], origin: V3<F>, direction: V3<F>, t: F) -> SurfacePoint<F> {
        let center = V3::new(fields[0], fields[1], fields[2]);
        let normal = V3::new(fields[3], fields[4], fields[5]);
        let from_center = direction.scale(t) - (center - origin);
        let in_plane = from_center - normal.scale(normal.dot(from_center));
        SurfacePoint { position: center + in_plane, normal, scale: largest(center) + fields[6] }
    }
}
