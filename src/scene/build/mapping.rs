//! Which texture coordinates an object gets, in its own space.

use crate::scene::desc::{MeshDesc, ShapeDesc};
use crate::scene::object::Mapping;
use glam::{DVec3, Vec3};

/// The mapping of a shape. A group has no surface; what it gets is never looked up.
pub fn mapping(shape: &ShapeDesc) -> Mapping {
    match shape {
        ShapeDesc::Sphere { center, .. } => Mapping::Sphere { center: center.as_vec3() },
        ShapeDesc::Plane { normal, .. } | ShapeDesc::Disk { normal, .. } => planar(*normal),
        ShapeDesc::Rectangle { edge_u, edge_v, .. } => planar(edge_u.cross(*edge_v).normalize_or_zero()),
        ShapeDesc::Cone { base, top, .. } => {
            Mapping::Axial { base: base.as_vec3(), axis: (*top - *base).normalize_or_zero().as_vec3() }
        }
        ShapeDesc::Mesh(mesh) => of_mesh(mesh),
        ShapeDesc::Box { .. } | ShapeDesc::Group { .. } => Mapping::BoxFaces,
    }
}

/// A mesh without coordinates of its own is mapped like a box, each point by its dominant normal axis;
/// a single triangle like the plane it lies in.
fn of_mesh(mesh: &MeshDesc) -> Mapping {
    if !mesh.uvs.is_empty() || !mesh.uvs1.is_empty() {
        return Mapping::Vertex;
    }
    match (&mesh.vertices[..], &mesh.triangles[..]) {
        ([a, b, c], [[0, 1, 2]]) => planar((*b - *a).cross(*c - *a).normalize_or_zero()),
        _ => Mapping::BoxFaces,
    }
}

/// On an axis-aligned surface the two other coordinates in x, y, z order; on a tilted one
/// a = norm(Y x n), u = P·a, v = P·(n x a).
fn planar(normal: DVec3) -> Mapping {
    let [x, y, z] = normal.to_array().map(|v| v != 0.0);
    let (u, v) = match (x, y, z) {
        (true, false, false) => (Vec3::Y, Vec3::Z),
        (false, true, false) => (Vec3::X, Vec3::Z),
        (false, false, true) => (Vec3::X, Vec3::Y),
        _ => {
            let a = DVec3::Y.cross(normal).normalize_or_zero();
            (a.as_vec3(), normal.cross(a).as_vec3())
        }
    };
    Mapping::Planar { u, v }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_aligned_surfaces_use_the_other_two_coordinates_in_order() {
        for sign in [1.0, -1.0] {
            assert_eq!(planar(DVec3::X * sign), Mapping::Planar { u: Vec3::Y, v: Vec3::Z });
            assert_eq!(planar(DVec3::Y * sign), Mapping::Planar { u: Vec3::X, v: Vec3::Z });
            assert_eq!(planar(DVec3::Z * sign), Mapping::Planar { u: Vec3::X, v: Vec3::Y });
        }
    }

    #[test]
    fn tilted_surfaces_use_unit_axes_across_the_normal() {
        let normal = DVec3::new(0.0, 0.6, 0.8);
        let Mapping::Planar { u, v } = planar(normal) else { panic!("a plane maps flat") };
        assert!(u.abs_diff_eq(Vec3::X, 1e-6), "{u}");
        assert!(v.abs_diff_eq(Vec3::new(0.0, 0.8, -0.6), 1e-6), "{v}");
    }
}
