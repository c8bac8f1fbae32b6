//! Which texture coordinates an object gets, in its own space.

use crate::scene::desc::{MeshDesc, ShapeDesc};
use crate::scene::object::Mapping;
use glam::{DAffine3, DVec3};

/// The mapping of a shape. Groups and models have no surface; what they get is never looked up.
pub fn mapping(shape: &ShapeDesc) -> Mapping {
    match shape {
        ShapeDesc::Sphere { center, .. } => Mapping::Sphere { center: center.as_vec3() },
        ShapeDesc::Plane { normal, .. } | ShapeDesc::Disk { normal, .. } => planar(*normal),
        ShapeDesc::Rectangle { edge_u, edge_v, .. } => planar(edge_u.cross(*edge_v).normalize_or_zero()),
        ShapeDesc::Cone { base, top, .. } => {
            Mapping::Axial { base: base.as_vec3(), axis: (*top - *base).normalize_or_zero().as_vec3() }
        }
        ShapeDesc::Mesh(mesh) => of_mesh(mesh),
        ShapeDesc::Box { .. } | ShapeDesc::Group { .. } | ShapeDesc::Model { .. } => Mapping::BoxFaces,
    }
}

/// A mesh without coordinates of its own is mapped like a box, each point by its dominant normal axis;
/// a single triangle like the plane it lies in.
fn of_mesh(mesh: &MeshDesc) -> Mapping {
    if !mesh.uvs.is_empty() || !mesh.uvs1.is_empty() {
        return Mapping::Vertex;
    }
    match (&mesh.vertices[..], &mesh.triangles[..]) {
        (corners @ [_, _, _], [[0, 1, 2]]) => planar(normal_of(corners)),
        _ => Mapping::BoxFaces,
    }
}

fn planar(normal: DVec3) -> Mapping {
    let (checker, image) = axes(normal);
    Mapping::Planar { checker: checker.map(|axis| axis.as_vec3()), image: image.map(|axis| axis.as_vec3()) }
}

/// The axes of checkers and of images on a plane. Checkers: on an axis-aligned surface the two other coordinates in x, y, z
/// order; on a tilted one a = norm(Y x n) and n x a. Images: the latter on whatever does not lie flat, else x and, away from
/// who looks at it, -z on a floor and z on a ceiling.
fn axes(normal: DVec3) -> ([DVec3; 2], [DVec3; 2]) {
    let right = DVec3::Y.cross(normal).normalize_or_zero();
    let tilted = [right, normal.cross(right)];
    match normal.to_array().map(|v| v != 0.0) {
        [true, false, false] => ([DVec3::Y, DVec3::Z], tilted),
        [false, true, false] => ([DVec3::X, DVec3::Z], [DVec3::X, DVec3::NEG_Z * normal.y.signum()]),
        [false, false, true] => ([DVec3::X, DVec3::Y], tilted),
        _ => (tilted, tilted),
    }
}

/// The mapping of a shape, and what takes the world to the space it is in, with that space moved so that its numbers are
/// small near the world's origin. It is moved by whole periods of the object's textures, so they stay where they are.
pub fn anchored(shape: &ShapeDesc, to_object: DAffine3, period: f64) -> (Mapping, DAffine3) {
    let mapping = mapping(shape);
    let across = |normal: DVec3| {
        let ([u, v], _) = axes(normal);
        [u, v, u.cross(v)]
    };
    let axes = match (shape, mapping) {
        (_, Mapping::Vertex) => return (mapping, to_object),
        (ShapeDesc::Plane { normal, .. } | ShapeDesc::Disk { normal, .. }, _) => across(*normal),
        (ShapeDesc::Rectangle { edge_u, edge_v, .. }, _) => across(edge_u.cross(*edge_v).normalize_or_zero()),
        (ShapeDesc::Cone { base, top, .. }, _) => across((*top - *base).normalize_or_zero()),
        (ShapeDesc::Mesh(mesh), Mapping::Planar { .. }) => across(normal_of(&mesh.vertices)),
        _ => DVec3::AXES,
    };
    let whole = |along: f64| if period > 0.0 { (along / period).round() * period } else { along };
    let anchor: DVec3 = axes.iter().map(|axis| *axis * whole(to_object.translation.dot(*axis))).sum();
    let mapping = match (shape, mapping) {
        (ShapeDesc::Sphere { center, .. }, _) => Mapping::Sphere { center: (*center - anchor).as_vec3() },
        (ShapeDesc::Cone { base, .. }, Mapping::Axial { axis, .. }) => {
            Mapping::Axial { base: (*base - anchor).as_vec3(), axis }
        }
        _ => mapping,
    };
    (mapping, DAffine3::from_translation(-anchor) * to_object)
}

/// The unit normal of a triangle.
fn normal_of(corners: &[DVec3]) -> DVec3 {
    let [a, b, c] = corners else { return DVec3::ZERO };
    (*b - *a).cross(*c - *a).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn axis_aligned_surfaces_use_the_other_two_coordinates_in_order() {
        for sign in [1.0, -1.0] {
            let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| match planar(axis * sign) {
                Mapping::Planar { checker, .. } => checker,
                other => panic!("a plane maps flat, not like {other:?}"),
            });
            assert_eq!(axes, [[Vec3::Y, Vec3::Z], [Vec3::X, Vec3::Z], [Vec3::X, Vec3::Y]]);
        }
    }

    #[test]
    fn images_read_the_right_way_round_and_up_from_the_side_of_the_normal() {
        for normal in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.48, 0.6, -0.64)] {
            for normal in [normal, -normal] {
                let Mapping::Planar { image: [right, up], .. } = planar(normal) else { panic!("a plane maps flat") };
                assert!(right.cross(up).abs_diff_eq(normal.as_vec3(), 1e-6), "{normal}: {right} {up}");
                assert!(right.y == 0.0 && up.y >= 0.0, "{normal}: {right} {up}");
                let single = crate::scene::object::image_axes(normal.as_vec3());
                assert!(single[0].abs_diff_eq(right, 1e-6) && single[1].abs_diff_eq(up, 1e-6), "{normal}: {single:?}");
            }
        }
    }

    #[test]
    fn tilted_surfaces_use_unit_axes_across_the_normal() {
        let normal = DVec3::new(0.0, 0.6, 0.8);
        let Mapping::Planar { checker: [u, v], .. } = planar(normal) else { panic!("a plane maps flat") };
        assert!(u.abs_diff_eq(Vec3::X, 1e-6), "{u}");
        assert!(v.abs_diff_eq(Vec3::new(0.0, 0.8, -0.6), 1e-6), "{v}");
    }
}
