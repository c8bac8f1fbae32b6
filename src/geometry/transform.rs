//! From the space of an object to the world, in f64. One text for what is stored in the world and for what is
//! moved there when it is asked for: both give the same bits.

use glam::{DAffine3, DMat3, DVec3, Vec4};

/// From one space to another, and what that does to surfaces.
#[derive(Clone, Copy, Debug)]
pub struct Transform {
    to_world: DAffine3,
    /// The inverse transpose: what normals are moved by.
    normals: DMat3,
    mirrored: bool,
    transformed: bool,
}

impl Transform {
    /// Leaves everything where it is.
    pub const IDENTITY: Self =
        Self { to_world: DAffine3::IDENTITY, normals: DMat3::IDENTITY, mirrored: false, transformed: false };

    /// By a matrix; `None` where it or its inverse leaves the range of numbers.
    pub fn new(to_world: DAffine3) -> Option<Self> {
        let normals = to_world.matrix3.inverse().transpose();
        let determinant = to_world.matrix3.determinant();
        let usable = to_world.is_finite() && normals.is_finite() && determinant != 0.0;
        usable.then_some(Self { to_world, normals, mirrored: determinant < 0.0, transformed: true })
    }

    /// Its matrix.
    pub fn matrix(&self) -> &DAffine3 {
        &self.to_world
    }

    /// Whether there is anything to do.
    pub fn is_identity(&self) -> bool {
        !self.transformed
    }

    /// A point in the world.
    #[inline]
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.to_world.transform_point3(point)
    }

    /// The unit normal in the world of a surface with `normal`; on the same side of the surface, mirrored or not.
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        if self.transformed { (self.normals * normal).normalize_or_zero() } else { normal.normalize_or_zero() }
    }

    /// The unit direction in the world of a surface's tangent, with the sign of its bitangent.
    pub fn tangent(&self, tangent: Vec4) -> Vec4 {
        let along = (self.to_world.matrix3 * tangent.truncate().as_dvec3()).normalize_or_zero();
        let sign = if self.mirrored { -tangent.w } else { tangent.w };
        along.as_vec3().extend(sign)
    }

    /// Whether it swaps left and right, and with that the winding of triangles.
    pub fn is_mirrored(&self) -> bool {
        self.mirrored
    }
}
