//! A mesh that is stored once, and the tree over its triangles.

use crate::geometry::bvh::{self, Bvh, Node, WIDTH};
use crate::geometry::{Aabb, Mesh, PrimitiveKind};
use glam::{DVec3, Vec4};
use rayon::prelude::*;
use std::sync::Arc;

/// A mesh with a tree, in its own space.
#[derive(Debug)]
pub struct SharedMesh {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// The tree; its leaves are those below.
    pub(super) nodes: Vec<Node>,
    /// Boxes of up to eight triangles each.
    pub(super) leaves: Vec<Triangles>,
    bounds: Aabb,
}

/// Up to eight triangles with their boxes, coordinate by coordinate.
#[derive(Clone, Debug)]
pub(super) struct Triangles {
    pub min: [[f32; WIDTH]; 3],
    pub max: [[f32; WIDTH]; 3],
    /// Indices in the mesh.
    pub numbers: [u32; WIDTH],
    pub len: u32,
}

impl SharedMesh {
    /// A tree over all triangles, even those without area: rounding may leave them some elsewhere. `None` if there are
    /// none, or when `wanted` says no.
    pub fn new(mesh: Arc<Mesh>, wanted: &dyn Fn() -> bool) -> Option<Self> {
        let aabb = |triangle: u32| Aabb::from_points(mesh.corners(triangle).map(|i| mesh.vertices[i].as_vec3()));
        let boxes: Vec<Aabb> = (0..mesh.triangles.len() as u32).into_par_iter().map(aabb).collect();
        let bounds = boxes.iter().fold(Aabb::EMPTY, |all, &own| all.union(own));
        let (Bvh { nodes, .. }, members) =
            bvh::build(&boxes, &vec![Some(PrimitiveKind::Triangle); boxes.len()], wanted)?;
        let leaf = |leaf: &bvh::LeafMembers| {
            let [min, max] = [[[0.0; WIDTH]; 3]; 2];
            let mut triangles = Triangles { min, max, numbers: [0; WIDTH], len: leaf.members().len() as u32 };
            for (place, &member) in leaf.members().iter().enumerate() {
                triangles.numbers[place] = member;
                for axis in 0..3 {
                    triangles.min[axis][place] = boxes[member as usize].min[axis];
                    triangles.max[axis][place] = boxes[member as usize].max[axis];
                }
            }
            triangles
        };
        let leaves = members.par_iter().map(leaf).collect();
        Some(Self { mesh, nodes, leaves, bounds })
    }

    /// Largest magnitude of any coordinate.
    pub(super) fn reach(&self) -> f64 {
        self.bounds.min.abs().max(self.bounds.max.abs()).max_element().into()
    }

    /// The middle of its bounds.
    pub(super) fn middle(&self) -> DVec3 {
        self.bounds.center().as_dvec3()
    }

    /// Whether any triangle carries tangents.
    pub fn has_tangents(&self) -> bool {
        self.any(&self.mesh.tangents, Vec4::ZERO)
    }

    /// Whether any triangle carries colours.
    pub fn has_colors(&self) -> bool {
        self.any(&self.mesh.colors, Vec4::ONE)
    }

    /// Whether the corner of any triangle carries something else than `nothing`.
    fn any(&self, carried: &[Vec4], nothing: Vec4) -> bool {
        !carried.is_empty() && self.mesh.triangles.iter().flatten().any(|&i| carried[i as usize] != nothing)
    }

    /// Bytes held, by capacity.
    pub fn bytes(&self) -> usize {
        self.mesh.bytes() + self.nodes.capacity() * size_of::<Node>() + self.leaves.capacity() * size_of::<Triangles>()
    }
}
