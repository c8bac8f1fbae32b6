//! Images on shapes: whoever looks at a surface from its outside has the image's left on the left and its top on top.

use crate::exactness::wrong_pixels;
use crate::picture_bits::render;
use crate::surfaces::{NEAREST, built, camera, light, material, object, scaled, texture};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use raywalk::scene::desc::{MaterialDesc, MeshDesc, ObjectDesc, SceneDesc, ShapeDesc};
use raywalk::scene::material::{ColorSource, Lookup, Relief};
use raywalk::scene::object::plane_axes;
use raywalk::scene::texture::Sampler;
use raywalk::scene::{Camera, Scene};
use raywalk::settings::Settings;
use std::sync::Arc;

/// Red, green and, below, blue and white: no two of the four quarters change places unnoticed.
const QUARTERS: [[u8; 4]; 4] = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];

/// A shape that shows the quarters.
fn lettered(kind: &'static str, shape: ShapeDesc, transform: Option<DAffine3>) -> Scene {
    let color = ColorSource::textured(Lookup::new(crate::surfaces::name("letter")));
    built(SceneDesc {
        textures: vec![texture("letter", 2, &QUARTERS, NEAREST)],
        materials: vec![MaterialDesc { unlit: true, color, ..material("letter") }],
        objects: vec![ObjectDesc { transform, ..object(kind, "letter", shape) }],
        ..SceneDesc::default()
    })
}

/// Looks at `point` against `normal`, with `up` up, and expects the four quarters of an image around it: those whose corner
/// is its middle or, with `corner`, the point where four images meet.
fn expect(what: &str, scene: &Scene, point: DVec3, normal: DVec3, up: DVec3, corner: bool) {
    let (eye, point) = ((point + normal * 2.0).as_vec3(), point.as_vec3());
    let camera = Camera { up: up.as_vec3(), fov: 8.0, ..camera(eye, point) };
    let film = render(scene, &camera, &Settings::exact(), (32, 32));
    let at = |x: u32, y: u32| film.color(x, y).map(|channel| if channel > 0.5 { 255 } else { 0 });
    let quarters = QUARTERS.map(|[r, g, b, _]| [r, g, b]);
    let seen = [at(10, 10), at(21, 10), at(10, 21), at(21, 21)];
    let expected = if corner { [3, 2, 1, 0] } else { [0, 1, 2, 3] }.map(|i| quarters[i]);
    assert_eq!(seen, expected, "{what}, from {eye} with {up} up");
}

/// What is right and up on an upright or level surface, for whoever sees it from the side of its normal.
fn right_and_up(normal: DVec3) -> [DVec3; 2] {
    if normal.x == 0.0 && normal.z == 0.0 {
        return [DVec3::X, DVec3::NEG_Z * normal.y];
    }
    let right = DVec3::Y.cross(normal).normalize();
    [right, normal.cross(right)]
}

/// Along the axes both ways, upright and tilted.
fn normals() -> impl Iterator<Item = DVec3> {
    let some = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.48, 0.6, -0.64)];
    some.into_iter().flat_map(|normal| [normal, -normal])
}

#[test]
fn flat_surfaces_read_the_right_way_round_from_the_side_of_their_normal() {
    for normal in normals() {
        let [right, up] = right_and_up(normal);
        // The middle of an image.
        let center = right * 0.5 + up * 0.5;
        let corner = center - right * 0.5 - up * 0.5;
        let triangle = vec![corner - right - up, corner + right * 3.0 - up, corner - right + up * 3.0];
        let triangle = MeshDesc { vertices: triangle, triangles: vec![[0, 1, 2]], ..MeshDesc::default() };
        for (kind, shape) in [
            ("plane", ShapeDesc::Plane { point: center, normal }),
            ("disk", ShapeDesc::Disk { center, normal, radius: 0.7 }),
            ("rectangle", ShapeDesc::Rectangle { corner, edge_u: right, edge_v: up }),
            ("rectangle", ShapeDesc::Rectangle { corner: corner + right, edge_u: up, edge_v: -right }),
            ("triangle", ShapeDesc::Mesh(Arc::new(triangle))),
        ] {
            expect(kind, &lettered(kind, shape, None), center, normal, up, false);
        }
    }
}

#[test]
fn every_face_of_a_box_reads_the_right_way_round() {
    let shape = || ShapeDesc::Box { min: DVec3::ZERO, max: DVec3::ONE };
    let turned = DAffine3::from_rotation_translation(DQuat::from_rotation_y(1.1), DVec3::new(3.0, -2.0, 0.5));
    for transform in [DAffine3::IDENTITY, turned, DAffine3::from_scale(DVec3::splat(2.0))] {
        let scene = lettered("box", shape(), Some(transform));
        for axis in DVec3::AXES {
            for normal in [axis, -axis] {
                let middle = transform.transform_point3(DVec3::splat(0.5) + normal * 0.5);
                let [normal, up] = [normal, right_and_up(normal)[1]].map(|v| transform.transform_vector3(v));
                expect("box", &scene, middle, normal.normalize(), up, false);
            }
        }
    }
}

#[test]
fn round_shapes_read_the_right_way_round_and_their_caps_too() {
    let center = DVec3::splat(0.5);
    let scene = lettered("sphere", ShapeDesc::Sphere { center, radius: 0.4 }, None);
    expect("sphere", &scene, center + DVec3::X * 0.4, DVec3::X, DVec3::Y, false);
    for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.48, 0.6, -0.64)] {
        for axis in [axis, -axis] {
            let out = plane_axes(axis.as_vec3())[0].as_dvec3();
            for (kind, radius_top) in [("cylinder", 0.4), ("cone", 0.3)] {
                let [right, up] = right_and_up(axis);
                // The middles of both caps are those of images.
                let middle = right * 0.5 + up * 0.5;
                let (base, top) = (middle - axis * 0.5, middle + axis * 0.5);
                let shape = ShapeDesc::Cone { base, top, radius: 0.4, radius_top, capped: true };
                let scene = lettered(kind, shape, None);
                expect(kind, &scene, middle + out * (0.4 + radius_top) / 2.0, out, axis, false);
                expect("the top", &scene, top, axis, up, false);
                let below = right_and_up(-axis)[1];
                let half = |along: DVec3| (base.dot(along).rem_euclid(1.0) - 0.5).abs() < 1e-6;
                assert!(half(below) && half(right_and_up(-axis)[0]), "the middle of an image");
                expect("the base", &scene, base, -axis, below, false);
            }
        }
    }
}

#[test]
fn four_images_meet_at_the_origin_of_a_plane() {
    let scene = lettered("plane", ShapeDesc::Plane { point: DVec3::ZERO, normal: DVec3::Y }, None);
    expect("plane", &scene, DVec3::ZERO, DVec3::Y, DVec3::NEG_Z, true);
}

/// A box whose normal map leans to the right of each face, lit from `direction`.
fn leaning(towards: DVec3) -> Scene {
    let smooth = Sampler::default();
    let relief = Relief { normal: scaled("lean", 1.0), bump: None, parallax: None };
    built(SceneDesc {
        textures: vec![texture("lean", 1, &[[217, 128, 217, 255]], smooth)],
        materials: vec![MaterialDesc { relief, ..material("lean") }],
        objects: vec![object("box", "lean", ShapeDesc::Box { min: DVec3::ZERO, max: DVec3::ONE })],
        lights: vec![light(DVec3::splat(0.5) + towards * 50.0)],
        ..SceneDesc::default()
    })
}

#[test]
fn relief_leans_to_the_right_with_the_image() {
    for axis in DVec3::AXES {
        for normal in [axis, -axis] {
            let [right, up] = right_and_up(normal);
            let brightness = |side: DVec3| {
                let point = DVec3::splat(0.5) + normal * 0.5;
                let eye = (point + normal * 2.0).as_vec3();
                let camera = Camera { up: up.as_vec3(), ..camera(eye, point.as_vec3()) };
                render(&leaning(normal + side), &camera, &Settings::exact(), (9, 9)).color(4, 4)[0]
            };
            let [lit, averted] = [right, -right].map(brightness);
            assert!(lit > 2.0 * averted, "{normal}: {lit} {averted}");
        }
    }
}

#[test]
fn a_checker_beside_an_image_stays_where_it_is_and_every_bit_is_kept() {
    let checker = |colors: [Vec3; 2]| raywalk::scene::desc::TextureDesc {
        name: crate::surfaces::name("checker"),
        kind: raywalk::scene::desc::TextureKind::Checker(colors),
        size: 0.25,
    };
    let shapes = || {
        let floor = ShapeDesc::Rectangle { corner: DVec3::ZERO, edge_u: DVec3::Z * 2.0, edge_v: DVec3::X * 2.0 };
        vec![
            object("rectangle", "both", floor),
            object("box", "both", ShapeDesc::Box { min: DVec3::splat(0.2), max: DVec3::splat(0.7) }),
            object("sphere", "both", ShapeDesc::Sphere { center: DVec3::new(1.4, 0.5, 0.5), radius: 0.4 }),
        ]
    };
    let scene = |image: bool| {
        let color = ColorSource::textured(Lookup::new(crate::surfaces::name("checker")));
        let relief = Relief { normal: scaled("lean", 0.0).filter(|_| image), bump: None, parallax: None };
        built(SceneDesc {
            textures: vec![checker([Vec3::X, Vec3::Y]), texture("lean", 1, &[[128, 128, 255, 255]], NEAREST)],
            materials: vec![MaterialDesc { color, relief, unlit: true, ..material("both") }],
            objects: shapes(),
            ..SceneDesc::default()
        })
    };
    let (plain, both) = (scene(false), scene(true));
    let view = camera(Vec3::new(1.2, 1.9, 2.6), Vec3::new(0.9, 0.2, 0.6));
    let films = [&plain, &both].map(|scene| render(scene, &view, &Settings::exact(), (64, 64)));
    let differ = (0..64 * 64).filter(|i| films[0].color(i % 64, i / 64) != films[1].color(i % 64, i / 64)).count();
    assert_eq!(differ, 0);
    let wrong = wrong_pixels("both", &both, &[view]);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
