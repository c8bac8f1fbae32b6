//! Triangles over shared vertices, in their own space.

use super::{VertexAttributes, VertexExtras};
use glam::{DVec2, DVec3, Vec2, Vec3, Vec4};

/// Triangles over shared vertices.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Positions.
    pub vertices: Vec<DVec3>,
    /// Three indices into `vertices` each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Shading normals, one a vertex and of any length but 0, or none at all.
    pub normals: Vec<DVec3>,
    /// Texture coordinates, one a vertex, or none at all.
    pub uvs: Vec<DVec2>,
    /// Second texture coordinates, one a vertex, or none at all.
    pub uvs1: Vec<Vec2>,
    /// Linear colours with opacity, which multiply the material's, one a vertex, or none at all.
    pub colors: Vec<Vec4>,
    /// Unit directions along which u grows, and the sign of that along which v grows, as glTF has them; one a vertex, or
    /// none at all.
    pub tangents: Vec<Vec4>,
}

impl Mesh {
    /// The vertices of a triangle.
    pub fn corners(&self, triangle: u32) -> [usize; 3] {
        self.triangles[triangle as usize].map(|i| i as usize)
    }

    /// What corners carry, if anything, their normals in the world being those of `normal`.
    pub fn attributes(&self, corners: [usize; 3], normal: impl Fn(usize) -> Vec3) -> Option<VertexAttributes> {
        (self.has_normals() || !self.uvs.is_empty()).then(|| VertexAttributes {
            normals: self.has_normals().then(|| corners.map(normal)),
            uvs: (!self.uvs.is_empty()).then(|| corners.map(|i| self.uvs[i].as_vec2())),
        })
    }

    /// What corners carry besides, if anything, their tangents in the world being those of `tangent`.
    pub fn extras(&self, corners: [usize; 3], tangent: impl Fn(usize) -> Vec4) -> Option<VertexExtras> {
        self.has_extras().then(|| VertexExtras {
            uvs1: corners.map(|i| self.uvs1.get(i).copied().unwrap_or_default()),
            colors: corners.map(|i| self.colors.get(i).copied().unwrap_or(Vec4::ONE)),
            tangents: if self.tangents.is_empty() { [Vec4::ZERO; 3] } else { corners.map(tangent) },
        })
    }

    fn has_normals(&self) -> bool {
        !self.normals.is_empty()
    }

    fn has_extras(&self) -> bool {
        !self.uvs1.is_empty() || !self.colors.is_empty() || !self.tangents.is_empty()
    }

    /// Whether corners carry anything.
    pub fn has_corner_data(&self) -> bool {
        self.has_normals() || !self.uvs.is_empty() || self.has_extras()
    }

    /// Bytes held, by capacity.
    pub fn bytes(&self) -> usize {
        (self.vertices.capacity() + self.normals.capacity()) * size_of::<DVec3>()
            + self.triangles.capacity() * size_of::<[u32; 3]>()
            + self.uvs.capacity() * size_of::<DVec2>()
            + self.uvs1.capacity() * size_of::<Vec2>()
            + (self.colors.capacity() + self.tangents.capacity()) * size_of::<Vec4>()
    }
}
