//! Leaf objects: what ties shapes to a material, a name and texture coordinates.

use crate::geometry::Aabb;
use glam::{Affine3A, Vec2, Vec3, Vec3A};
use std::f32::consts::{PI, TAU};

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

impl Object {
    /// Texture coordinates of a point in the world with its geometric normal. `own` are those that a triangle's
    /// corners carry.
    pub fn texture_coordinates(&self, primitive: u32, position: Vec3, normal: Vec3, own: Option<Vec2>) -> Vec2 {
        let p = self.world_to_object.map_or(position, |m| m.transform_point3(position));
        let planar = |[u, v]: [Vec3; 2]| Vec2::new(p.dot(u), p.dot(v));
        match self.mapping {
            Mapping::Planar { u, v } => planar([u, v]),
            Mapping::BoxFaces => planar(other_axes(self.to_object_normal(normal))),
            Mapping::Sphere { center } => longitude_latitude(p - center),
            Mapping::Axial { base, axis } if primitive == 0 => {
                let from_base = p - base;
                let [a, b] = plane_axes(axis).map(|side| from_base.dot(side));
                Vec2::new(libm::atan2f(b, a) / TAU + 0.5, from_base.dot(axis))
            }
            Mapping::Axial { axis, .. } => planar(plane_axes(axis)),
            Mapping::Vertex => own.unwrap_or(Vec2::ZERO),
        }
    }

    /// A normal of the world in the object's own space; its length may change.
    fn to_object_normal(&self, normal: Vec3) -> Vec3 {
        self.world_to_object.map_or(normal, |m| Vec3::from(m.matrix3.inverse().transpose() * Vec3A::from(normal)))
    }
}

/// The axes along which a plane of unit normal `n` is textured: on an axis-aligned one the two other coordinates in
/// x, y, z order, on a tilted one a = norm(Y x n) and n x a.
pub fn plane_axes(n: Vec3) -> [Vec3; 2] {
    if n.abs().max_element() == 1.0 {
        return other_axes(n);
    }
    let a = Vec3::Y.cross(n).normalize();
    [a, n.cross(a)]
}

/// The two coordinate axes other than the one that `n` lies nearest to, in x, y, z order.
fn other_axes(n: Vec3) -> [Vec3; 2] {
    match n.abs().max_position() {
        0 => [Vec3::Y, Vec3::Z],
        1 => [Vec3::X, Vec3::Z],
        _ => [Vec3::X, Vec3::Y],
    }
}

/// Longitude / 2π and latitude / π from the south pole, of a direction of any length.
fn longitude_latitude(d: Vec3) -> Vec2 {
    let across = libm::sqrtf(d.x * d.x + d.z * d.z);
    Vec2::new(libm::atan2f(d.z, d.x) / TAU + 0.5, libm::atan2f(d.y, across) / PI + 0.5)
}
