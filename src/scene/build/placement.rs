//! Where an object stands in the world: the product of the transforms above it, kept in f64.

use crate::geometry::Transform;
use crate::scene::desc::problem::{At, Outcome, Problem};
use glam::{Affine3A, DAffine3, DMat3, DVec3, Vec4};

/// How far squared scales along different directions may differ, relative to their size: a rotation
/// matrix written with four digits still counts as uniform.
const UNIFORM_TOLERANCE: f64 = 1e-4;

/// From an object's own space to the world.
#[derive(Clone, Debug)]
pub struct Placement(Transform);

impl Placement {
    /// The world's own space.
    pub const WORLD: Self = Self(Transform::IDENTITY);

    /// A space within this one. `at` is where its transform stands.
    pub fn within(&self, transform: &DAffine3, at: At) -> Outcome<Self> {
        let odd = || Problem::new(at, "with the groups around it, the transform's scale is too large or too small");
        Transform::new(*self.0.matrix() * *transform).map(Self).ok_or_else(odd)
    }

    /// The way to the world.
    pub fn transform(&self) -> &Transform {
        &self.0
    }

    /// A point in the world.
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.0.point(point)
    }

    /// The unit normal in the world of a surface with `normal`; on the same side of the surface, mirrored or not.
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        self.0.normal(normal)
    }

    /// The unit direction in the world of a surface's tangent, with the sign of its bitangent.
    pub fn tangent(&self, tangent: Vec4) -> Vec4 {
        self.0.tangent(tangent)
    }

    /// Whether it swaps left and right, and with that the winding of triangles.
    pub fn is_mirrored(&self) -> bool {
        self.0.is_mirrored()
    }

    /// The factor by which all lengths grow; `None` when it depends on the direction.
    pub fn uniform_scale(&self) -> Option<f64> {
        let m = self.0.matrix().matrix3;
        let squared = m.transpose() * m;
        let size = (squared.x_axis.x + squared.y_axis.y + squared.z_axis.z) / 3.0;
        let apart = (squared - DMat3::from_diagonal(DVec3::splat(size))).to_cols_array();
        apart.iter().all(|d| d.abs() <= UNIFORM_TOLERANCE * size).then(|| size.sqrt())
    }

    /// From the world to the object's own space; `None` where they are the same.
    pub fn world_to_object(&self) -> Option<DAffine3> {
        (!self.0.is_identity()).then(|| self.0.matrix().inverse())
    }
}

/// The same map in single precision.
pub fn narrow(m: DAffine3) -> Affine3A {
    Affine3A::from_mat3_translation(m.matrix3.as_mat3(), m.translation.as_vec3())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scaled(x: f64, y: f64, z: f64) -> Placement {
        Placement::WORLD.within(&DAffine3::from_scale(DVec3::new(x, y, z)), At(0)).unwrap()
    }

    #[test]
    fn tells_uniform_scales_from_others() {
        assert_eq!(Placement::WORLD.uniform_scale(), Some(1.0));
        assert_eq!(scaled(-2.0, 2.0, 2.0).uniform_scale(), Some(2.0));
        assert_eq!(scaled(1.0, 1.0, 1.01).uniform_scale(), None);
        // 30 degrees about z, written with four digits.
        let (x, y) = (DVec3::new(0.8660, 0.5, 0.0), DVec3::new(-0.5, 0.8660, 0.0));
        let turned = DAffine3 { matrix3: DMat3::from_cols(x, y, DVec3::Z), translation: DVec3::ZERO };
        assert!(Placement::WORLD.within(&turned, At(0)).unwrap().uniform_scale().is_some());
    }

    #[test]
    fn normals_stay_across_and_outside() {
        let stretched = scaled(-3.0, 1.0, 1.0);
        let normal = stretched.normal(DVec3::new(1.0, 1.0, 0.0).normalize());
        let along = stretched.point(DVec3::new(1.0, -1.0, 0.0)) - stretched.point(DVec3::ZERO);
        assert!(normal.dot(along).abs() < 1e-12);
        let outside = stretched.point(DVec3::new(1.0, 1.0, 0.0)) - stretched.point(DVec3::ZERO);
        assert!(normal.dot(outside) > 0.0);
        assert!(stretched.is_mirrored() && !scaled(-1.0, -1.0, 1.0).is_mirrored());
    }

    #[test]
    fn scales_that_vanish_together_are_refused() {
        let tiny = scaled(1e-60, 1e-60, 1e-60);
        assert!(tiny.within(&DAffine3::from_scale(DVec3::splat(1e-60)), At(0)).is_err());
    }
}
