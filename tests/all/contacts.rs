//! Surfaces that touch: glass on floors, glass against glass, panes on walls.
//!
//! Judged by the tracer in double precision on the same scene pulled apart or pushed together by a hair, and by the
//! order of the file, which must not matter.

use crate::exactness::wrong_pixels;
use crate::picture_bits::{PictureBits, render};
use crate::temporary::load_text;
use crate::tracer::Tracer;
use glam::{DVec2, Vec3};
use raywalk::render::Film;
use raywalk::scene::Scene;
use raywalk::settings::{Settings, Visibility};
use serde_json::{Value, json};

const SIZE: (u32, u32) = (96, 72);

/// How far things are sunk into each other, or apart, to be seen by the tracer: more than its own offsets.
const HAIR: f64 = 1e-6;

fn scene(objects: &[Value], tint: f32) -> Scene {
    let glass =
        |ior: f32| json!({ "transparency": 1, "ior": ior, "ambient": 0, "diffuse": 0, "specular": 0, "color": tint });
    let text = json!({
        "version": 1,
        "render": { "max_depth": 10, "background": [1, 0, 1] },
        "camera": { "position": [1.5, 2.1, 3.7], "look_at": [0.1, 0.4, 0], "fov": 40 },
        "textures": { "squares": { "checker": [[0.9, 0.9, 0.8], [0.1, 0.3, 0.2]], "size": 0.7 } },
        "materials": {
            "glass": glass(1.5),
            "water": glass(1.33),
            "floor": { "color": { "texture": "squares" }, "specular": 0 },
            "mirror": { "color": 0.5, "specular": 0, "reflectivity": 0.5 },
            "pane": { "transparency": 0.5, "color": [1, 0.4, 0.4], "specular": 0 },
            "second": { "transparency": 0.7, "color": [0.4, 1, 0.4], "specular": 0 }
        },
        "lights": [{ "type": "point", "position": [3, 6, 3] }],
        "objects": objects,
    });
    load_text(text.to_string()).unwrap()
}

fn cuboid(min: [f64; 3], max: [f64; 3], material: &str) -> Value {
    json!({ "type": "box", "min": min, "max": max, "material": material })
}

fn floor(material: &str) -> Value {
    json!({ "type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": material })
}

/// The floor as two triangles, so that distances to it are rounded in another way than those to a plane.
fn mesh_floor() -> Value {
    json!({ "type": "mesh", "material": "floor",
        "vertices": [[-9, 0, -9], [9, 0, -9], [9, 0, 9], [-9, 0, 9]], "triangles": [[0, 2, 1], [0, 3, 2]] })
}

fn rectangle(height: f64, material: &str) -> Value {
    json!({ "type": "rectangle", "corner": [-1, height, -1.1], "edge_u": [0, 0, 2], "edge_v": [2, 0, 0], "material": material })
}

/// A place where things touch, by how far they are moved: 0 for touching, positive apart, negative into each other.
type Place = (&'static str, fn(f64) -> Vec<Value>);

/// Whose picture is the limit of bodies sunk into each other.
const SUNK: &[Place] = &[
    ("box on a plane", |e| vec![cuboid([-1.0, e, -1.0], [1.0, 1.0, 1.0], "glass"), floor("floor")]),
    ("box on a mesh", |e| vec![cuboid([-1.0, e, -1.0], [1.0, 1.0, 1.0], "glass"), mesh_floor()]),
    ("box on a mirror", |e| vec![cuboid([-1.0, e, -1.0], [1.0, 1.0, 1.0], "glass"), floor("mirror")]),
    ("cylinder on a plane", |e| {
        let glass =
            json!({ "type": "cylinder", "base": [0, e, 0], "top": [0, 1, 0], "radius": 0.8, "material": "glass" });
        vec![glass, floor("floor")]
    }),
    ("box on a box", |e| {
        let table = cuboid([-1.5, -0.5, -1.5], [1.5, 0.0, 1.5], "floor");
        vec![cuboid([-1.0, e, -1.0], [1.0, 1.0, 1.0], "glass"), table]
    }),
];

/// Whose picture is that of one body, by how far they are moved.
const JOINED: &[Place] = &[
    ("two boxes", |e| {
        let left = cuboid([-1.0, 0.1, -1.0], [-e, 1.0, 1.0], "glass");
        vec![left, cuboid([e, 0.1, -1.0], [1.0, 1.0, 1.0], "glass"), floor("floor")]
    }),
    ("four boxes around an edge", |e| {
        let near = cuboid([-1.0, 0.1, e], [-e, 1.0, 1.0], "glass");
        let far = cuboid([e, 0.1, -1.0], [1.0, 1.0, -e], "glass");
        let left = cuboid([-1.0, 0.1, -1.0], [-e, 1.0, -e], "glass");
        let right = cuboid([e, 0.1, e], [1.0, 1.0, 1.0], "glass");
        vec![near, far, left, right, floor("floor")]
    }),
];

/// Whose picture is the limit of thin things held a little apart.
const APART: &[Place] = &[
    ("pane on a plane", |e| vec![rectangle(e, "pane"), floor("floor")]),
    ("pane on a mesh", |e| vec![rectangle(e, "pane"), mesh_floor()]),
    ("two panes on a plane", |e| vec![rectangle(e * 2.0, "pane"), rectangle(e, "second"), floor("floor")]),
];

/// Whether a picture of things that touch is that of the tracer where they are moved by a hair.
fn check((name, place): &Place, hair: f64, tint: f32, problems: &mut Vec<String>) {
    let settings = Settings { visibility: Visibility::Full, ..Settings::exact() };
    let moved = scene(&place(hair), tint);
    let tracer = Tracer::new(&moved, moved.cameras[0].camera, &settings);
    let touching = scene(&place(0.0), tint);
    let film = render(&touching, &touching.cameras[0].camera, &settings, SIZE);
    let mut off = 0;
    for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
        let expected = tracer.look(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5), SIZE).color;
        let found = Vec3::from(film.color(x, y)).as_dvec3();
        off += usize::from((found - expected).abs().max_element() > 2e-3);
    }
    println!("{name}, tint {tint}: {off} pixels are off");
    // Edges, and the lines where squares meet.
    if off > 40 {
        problems.push(format!("{name}, tint {tint}: {off} pixels are off"));
    }
}

#[test]
fn what_touches_looks_like_the_limit_of_what_is_moved_by_a_hair() {
    let mut problems = Vec::new();
    for tint in [1.0, 0.7] {
        SUNK.iter().for_each(|place| check(place, -HAIR, tint, &mut problems));
        APART.iter().for_each(|place| check(place, HAIR, tint, &mut problems));
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn the_order_in_the_file_does_not_matter() {
    for (name, place) in SUNK.iter().chain(JOINED).chain(&APART[..2]) {
        let objects = place(0.0);
        let reversed: Vec<Value> = objects.iter().rev().cloned().collect();
        let [a, b] = [objects, reversed].map(|objects| {
            let scene = scene(&objects, 0.7);
            render(&scene, &scene.cameras[0].camera, &Settings::exact(), SIZE)
        });
        let off = different(&a, &b, 1e-4);
        assert!(off <= 8, "{name}: {off} pixels depend on the order of the file");
    }
}

#[test]
fn boxes_that_touch_are_one_body() {
    let picture = |objects: &[Value]| {
        let scene = scene(objects, 1.0);
        render(&scene, &scene.cameras[0].camera, &Settings::exact(), SIZE)
    };
    let one = picture(&[cuboid([-1.0, 0.1, -1.0], [1.0, 1.0, 1.0], "glass"), floor("floor")]);
    for (name, place) in JOINED {
        let several = picture(&place(0.0));
        let off = different(&one, &several, 1e-3);
        // Rays that meet edges.
        assert!(off <= 20, "{name}: {off} pixels differ");
    }
}

/// Light that a mirror throws back through a pane in the same place is filtered by it once more.
#[test]
fn a_pane_on_a_mirror_filters_twice() {
    let [touching, apart] = [0.0, HAIR * 1e3].map(|e| {
        let scene = scene(&[rectangle(e, "pane"), floor("mirror")], 1.0);
        render(&scene, &scene.cameras[0].camera, &Settings::exact(), SIZE)
    });
    // The pane's own light on its back is left out.
    assert!(different(&touching, &apart, 0.03) <= 20);
    assert!(different(&touching, &apart, 1e-4) > 20);
}

/// How many pixels of two pictures are apart by more than a bound.
fn different(a: &Film, b: &Film, bound: f32) -> usize {
    (0..SIZE.1)
        .flat_map(|y| (0..SIZE.0).map(move |x| (x, y)))
        .filter(|&(x, y)| (Vec3::from(a.color(x, y)) - Vec3::from(b.color(x, y))).abs().max_element() > bound)
        .count()
}

#[test]
fn water_fills_its_glass_without_a_gap() {
    // The water's surface lies in the inner wall of the glass: light goes from one to the other, with no air between.
    let ball = |radius: f64, material: &str| json!({ "type": "sphere", "center": [0, 1, 0], "radius": radius, "material": material });
    let glass = scene(&[ball(1.0, "glass"), ball(0.8, "water"), floor("floor")], 1.0);
    let touching = scene(&[ball(1.0, "water"), ball(1.0, "glass"), floor("floor")], 1.0);
    let settings = Settings { visibility: Visibility::Full, ..Settings::exact() };
    let film = render(&touching, &touching.cameras[0].camera, &settings, SIZE);
    // Of two balls in one place light enters both and leaves both: the picture is that of one of them.
    let either = ["glass", "water"].map(|material| {
        let one = scene(&[ball(1.0, material), floor("floor")], 1.0);
        render(&one, &one.cameras[0].camera, &settings, SIZE)
    });
    let off = |other: &Film| different(&film, other, 0.02);
    assert!(either.iter().any(|other| off(other) <= 40), "{:?} pixels differ", either.each_ref().map(off));
    assert!(render(&glass, &glass.cameras[0].camera, &settings, SIZE).color(48, 36)[0].is_finite());
}

#[test]
fn an_edge_between_two_triangles_is_crossed_once() {
    // The light, the middle of the pane and the middle of the floor below lie in one line, on the pane's diagonal.
    let pane = json!({ "type": "rectangle", "corner": [-1, 1, -1], "edge_u": [0, 0, 2], "edge_v": [2, 0, 0], "material": "pane" });
    let text = json!({
        "version": 1,
        "camera": { "position": [0, 0.5, 0.001], "look_at": [0, 0, 0], "up": [0, 0, -1], "fov": 30 },
        "materials": { "pane": { "transparency": 0.5, "specular": 0 }, "white": { "specular": 0, "ambient": 0 } },
        "lights": [{ "type": "point", "position": [0, 4, 0] }],
        "objects": [pane, { "type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "white" }],
    });
    let scene = load_text(text.to_string()).unwrap();
    let film = render(&scene, &scene.cameras[0].camera, &Settings::exact(), (33, 33));
    for (x, y) in (0..33).flat_map(|y| (0..33).map(move |x| (x, y))) {
        let [red, ..] = film.color(x, y);
        assert!((0.4..0.6).contains(&red), "({x}, {y}) is {red}");
    }
}

/// A floor that is large beside what stands on it is coarser than that, and things a little above it lie in the same place
/// for rays that leave it.
#[test]
fn large_floors_are_seen_under_small_panes() {
    let picture = |half: f64, height: f64, floor_first: bool, eye: [f64; 3]| {
        let pane = json!({ "type": "rectangle", "corner": [-1, height, -1], "edge_u": [0, 0, 2], "edge_v": [2, 0, 0], "material": "pane" });
        let floor = json!({ "type": "rectangle", "corner": [-half, 0, -half], "edge_u": [0, 0, 2.0 * half], "edge_v": [2.0 * half, 0, 0], "material": "white" });
        let objects = if floor_first { [floor, pane] } else { [pane, floor] };
        let text = json!({
            "version": 1,
            "render": { "background": [0, 0, 1], "ambient": 0 },
            "camera": { "position": eye, "look_at": [0, 0, 0], "up": [0, 0, -1], "fov": 25 },
            "materials": { "pane": { "transparency": 0.5, "fresnel": false, "color": 1, "specular": 0, "ambient": 0, "diffuse": 0 },
                           "white": { "color": 1, "specular": 0, "ambient": 0 } },
            "lights": [{ "type": "directional", "direction": [0, -1, 0] }],
            "objects": objects,
        });
        let scene = load_text(text.to_string()).unwrap();
        let settings = [Settings::exact(), Settings::balanced()];
        settings.map(|settings| render(&scene, &scene.cameras[0].camera, &settings, (48, 48)))
    };
    for half in [2.0, 300.0, 1000.0, 3000.0] {
        for floor_first in [true, false] {
            for (height, eye) in [
                (0.0, [0.0, 3.0, 0.0]),
                (1e-6, [0.0, 3.0, 0.0]),
                (1e-5, [0.0, 3.0, 0.0]),
                (1e-4, [0.0, 3.0, 0.0]),
                (1e-2, [0.0, 3.0, 0.0]),
                (0.0, [0.0, 0.5, 2.5]),
            ] {
                if half < 10.0 && eye[1] < 1.0 {
                    continue;
                }
                for film in picture(half, height, floor_first, eye) {
                    for (x, y) in (12..36).flat_map(|y| (12..36).map(move |x| (x, y))) {
                        let [red, _, blue] = film.color(x, y);
                        let shows_floor = (red - blue).abs() < 1e-4;
                        let is_filtered_twice = eye[1] < 1.0 || (red - 0.25).abs() < 1e-3;
                        assert!(
                            shows_floor && is_filtered_twice,
                            "±{half}, {height} above, floor first {floor_first}: ({x}, {y}) is {red}, {blue}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn many_panes_in_one_place_hide_no_floor() {
    let panes = std::iter::repeat_n(rectangle(0.0, "pane"), 40);
    for objects in [
        panes.clone().chain([floor("floor")]).collect::<Vec<_>>(),
        std::iter::once(floor("floor")).chain(panes).collect(),
    ] {
        let scene = scene(&objects, 1.0);
        let settings = Settings { depth: Some(60), ..Settings::exact() };
        let film = render(&scene, &scene.cameras[0].camera, &settings, SIZE);
        let [red, green, blue] = film.color(SIZE.0 / 2, SIZE.1 / 2 + 4);
        assert!(blue < 0.5 && (red - blue).abs() < 0.6 && green < 0.6, "{red} {green} {blue}");
    }
}

#[test]
fn what_touches_keeps_every_bit() {
    let mut problems = Vec::new();
    for (name, place) in SUNK.iter().chain(JOINED).chain(APART) {
        let scene = scene(&place(0.0), 0.7);
        let cameras: Vec<_> = scene.cameras.iter().map(|named| named.camera).collect();
        problems.extend(wrong_pixels(name, &scene, &cameras));
        let first = render(&scene, &cameras[0], &Settings::exact(), SIZE);
        assert_eq!(PictureBits::of(&first).not_a_number(), 0, "{name}");
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}
