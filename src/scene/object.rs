//! Leaf objects: what ties shapes to a material, a name and texture coordinates.

use crate::geometry::Aabb;
use glam::{Affine3A, Vec3};

/// How a point of an object gets its texture coordinates. All of it in the object's own space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mapping {
    /// u = p·`u`, v = p·`v`: planes, rectangles, disks, flat triangles without coordinates.
    Planar {
        /// First axis.
        u: Vec3,
        /// Second axis.
        v: Vec3,
    },
    /// Each face maps like an axis-aligned plane by its dominant normal axis: boxes.
    BoxFaces,
    /// Longitude / 2π, latitude / π from the south pole.
    Sphere {
        /// Centre.
        center: Vec3,
    },
    /// Side: angle / 2π, height from the base; caps: planar.
    Axial {
        /// Centre of the base.
        base: Vec3,
        /// Unit axis from base to top.
        axis: Vec3,
    },
    /// Interpolated from the triangles' own coordinates.
    Vertex,
}

/// A leaf object of the scene, as a hit's object index names it.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name, where the file gives one.
    pub name: Option<String>,
    /// The type as the file spells it, such as `sphere`.
    pub kind: &'static str,
    /// Index into the scene's materials.
    pub material: u32,
    /// Whether it bounds a body, in which light bends; otherwise it is thin.
    pub body: bool,
    /// How texture coordinates are found.
    pub mapping: Mapping,
    /// From the world to the object's own space; `None` where they are the same.
    pub world_to_object: Option<Affine3A>,
    /// Bounds in the world; infinite for planes.
    pub bounds: Aabb,
}
