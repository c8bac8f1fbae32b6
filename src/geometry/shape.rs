//! Shapes as scene building hands them over, before they are sorted into kernels' arrays.

use super::Holes;
use glam::{Vec2, Vec3, Vec4};

/// What a hit names: the leaf object, and the primitive within it, both as counted in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PrimitiveId {
    /// Index of the leaf object, depth first in file order.
    pub object: u32,
    /// Index within the object: triangle; box face 0-5; cylinder and cone 0 side, 1 base, 2 top; else 0.
    pub primitive: u32,
}

/// A shape in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// All points at `radius` from `center`.
    Sphere {
        /// Centre.
        center: Vec3,
        /// Radius, > 0.
        radius: f32,
    },
    /// The infinite plane through `point`; as a body, the half-space against `normal`.
    Plane {
        /// Any point on it.
        point: Vec3,
        /// Unit normal.
        normal: Vec3,
    },
    /// A triangle; its geometric normal is (b - a) x (c - a).
    Triangle {
        /// Corners, counter-clockwise seen from outside.
        vertices: [Vec3; 3],
    },
    /// A flat disk.
    Disk {
        /// Centre.
        center: Vec3,
        /// Unit normal.
        normal: Vec3,
        /// Radius, > 0.
        radius: f32,
    },
    /// The open side of a cylinder (equal radii) or truncated cone; normals point outward.
    Cone {
        /// Centre of the base.
        base: Vec3,
        /// Centre of the top.
        top: Vec3,
        /// Radius at the base, >= 0.
        radius_base: f32,
        /// Radius at the top, >= 0, not both 0.
        radius_top: f32,
    },
}

/// What a triangle's corners carry besides positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexAttributes {
    /// Unit shading normals, or `None` for the flat normal.
    pub normals: Option<[Vec3; 3]>,
    /// Texture coordinates.
    pub uvs: Option<[Vec2; 3]>,
}

impl VertexAttributes {
    /// With the corners taken in another order.
    pub fn reordered(self, order: [usize; 3]) -> Self {
        Self { normals: self.normals.map(|n| order.map(|i| n[i])), uvs: self.uvs.map(|uv| order.map(|i| uv[i])) }
    }
}

/// What corners carry besides, of the few triangles that carry more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexExtras {
    /// Second texture coordinates.
    pub uvs1: [Vec2; 3],
    /// Linear colours with opacity, which multiply the material's.
    pub colors: [Vec4; 3],
    /// Unit directions along which u grows, and the sign of that along which v grows; 0 where they follow from the
    /// texture coordinates.
    pub tangents: [Vec4; 3],
}

impl VertexExtras {
    /// With the corners taken in another order.
    pub fn reordered(self, order: [usize; 3]) -> Self {
        Self {
            uvs1: order.map(|i| self.uvs1[i]),
            colors: order.map(|i| self.colors[i]),
            tangents: order.map(|i| self.tangents[i]),
        }
    }
}

/// One shape with its identity. Several parts may share an identity (the two triangles of a rectangle).
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The shape in world space.
    pub shape: Shape,
    /// Whose it is.
    pub id: PrimitiveId,
    /// Corner data, triangles only.
    pub attributes: Option<VertexAttributes>,
    /// More corner data, triangles only.
    pub extras: Option<Box<VertexExtras>>,
    /// Where there are holes in it, triangles only.
    pub holes: Option<Box<Holes>>,
    /// Whether it is seen only from where its corners are counter-clockwise, triangles only. Light and walkers are stopped
    /// from either side.
    pub one_sided: bool,
}

impl Part {
    /// A shape that is seen from all sides and whose corners carry nothing.
    pub fn new(shape: Shape, id: PrimitiveId) -> Self {
        Self { shape, id, attributes: None, extras: None, holes: None, one_sided: false }
    }
}
