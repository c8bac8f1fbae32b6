//! What a ray can meet and how to find it. This room knows no colour.

pub mod aabb;
pub mod shape;

pub use aabb::Aabb;
pub use shape::{Part, PrimitiveId, Shape, VertexAttributes};

/// All shapes of a scene, sorted by type, and the tree over them.
#[derive(Debug)]
pub struct Geometry {}

impl Geometry {
    /// Builds kernels' data and the tree from parts in ascending order of [`PrimitiveId`].
    /// Degenerate parts (zero area, zero length) are dropped and counted in `dropped`.
    pub fn build(_parts: Vec<Part>) -> Self {
        Self {}
    }
}
