//! Bounds of shapes and of scenes.

use crate::geometry::{Aabb, Shape};
use crate::scene::Object;

/// The bounds of a shape in the world; infinite for a plane.
pub fn shape_bounds(shape: &Shape) -> Aabb {
    match *shape {
        Shape::Sphere { center, radius } => Aabb { min: center - radius, max: center + radius },
        Shape::Plane { .. } => Aabb::INFINITE,
        Shape::Triangle { vertices } => Aabb::from_points(vertices),
        Shape::Disk { center, normal, radius } => Aabb::of_disk(center, normal, radius),
        Shape::Cone { base, top, radius_base, radius_top } => {
            let axis = (top - base).normalize_or_zero();
            Aabb::of_disk(base, axis, radius_base).union(Aabb::of_disk(top, axis, radius_top))
        }
    }
}

/// The bounds of all finite objects; empty when there is none.
pub fn finite_bounds(objects: &[Object]) -> Aabb {
    objects.iter().map(|o| o.bounds).filter(Aabb::is_finite).fold(Aabb::EMPTY, Aabb::union)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_lying_disk_is_flat_and_a_tilted_one_is_not() {
        let bounds = |normal| shape_bounds(&Shape::Disk { center: Vec3::ONE, normal, radius: 2.0 });
        assert_eq!(bounds(Vec3::Y), Aabb { min: Vec3::new(-1.0, 1.0, -1.0), max: Vec3::new(3.0, 1.0, 3.0) });
        let tilted = bounds(Vec3::new(0.6, 0.8, 0.0));
        assert!(tilted.max.abs_diff_eq(Vec3::new(1.0 + 1.6, 1.0 + 1.2, 3.0), 1e-5));
    }

    #[test]
    fn a_cone_reaches_both_of_its_ends() {
        let cone = Shape::Cone { base: Vec3::ZERO, top: Vec3::Y * 3.0, radius_base: 1.0, radius_top: 2.0 };
        let bounds = shape_bounds(&cone);
        assert_eq!(bounds, Aabb { min: Vec3::new(-2.0, 0.0, -2.0), max: Vec3::new(2.0, 3.0, 2.0) });
    }
}
