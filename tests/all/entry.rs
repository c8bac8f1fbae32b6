//! How scenes without a camera are entered: on foot where there is floor to walk on, else framed from outside.

use crate::temporary::{Folder, load_objects, load_text};
use glam::Vec3;
use raywalk::geometry::Aabb;
use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::build::probe::Probe;
use raywalk::scene::start::{Entry, Unit};
use raywalk::scene::{LoadOptions, Scene, load};
use raywalk::settings::Settings;

const SIZE: (u32, u32) = (320, 180);

/// How much of the width and of the height the pixels span that show one of the first `objects` objects.
fn filled(scene: &Scene, objects: u32) -> [f32; 2] {
    let mut film = Film::new(SIZE.0, SIZE.1, Planes { object: true, ..Planes::default() });
    render_frame(scene, &scene.cameras[0].camera, &Settings::exact(), &mut Scratch::new(), &mut film);
    let pixels = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)));
    let shown = pixels.filter(|&(x, y)| film.object(x, y).is_some_and(|object| object < objects));
    let points = shown.map(|(x, y)| Vec3::new(x as f32, y as f32, 0.0));
    let bounds = Aabb::from_points(points);
    if bounds.is_empty() {
        return [0.0; 2];
    }
    let span = bounds.size() + 1.0;
    [span.x / SIZE.0 as f32, span.y / SIZE.1 as f32]
}

fn assert_fills(scene: &Scene, objects: u32, what: &str) {
    assert_eq!(scene.start.entry, Entry::Framed, "{what}");
    assert!(!scene.on_foot() && scene.start.eye_height.is_none());
    let filled = filled(scene, objects);
    assert!(filled.into_iter().any(|share| share >= 0.66), "{what} fills {filled:?}");
    assert!(filled.into_iter().all(|share| share < 1.0), "{what} fills {filled:?}");
}

fn cuboid(min: [f32; 3], max: [f32; 3]) -> String {
    format!(r#"{{ "type": "box", "min": {min:?}, "max": {max:?} }}"#)
}

fn ball(center: [f32; 3], radius: f32) -> String {
    format!(r#"{{ "type": "sphere", "center": {center:?}, "radius": {radius} }}"#)
}

fn ground(y: f32, half: [f32; 2]) -> String {
    let [x, z] = half;
    format!(
        r#"{{ "type": "rectangle", "corner": [{}, {y}, {z}], "edge_u": [{}, 0, 0], "edge_v": [0, 0, {}] }}"#,
        -x,
        2.0 * x,
        -2.0 * z
    )
}

fn scene(objects: &[String]) -> Scene {
    load_objects(&objects.join(", "))
}

/// The same objects in another unit.
fn scaled(objects: &[String], scale: f32) -> Scene {
    load_objects(&format!(
        r#"{{ "type": "group", "transform": {{ "scale": {scale} }}, "children": [{}] }}"#,
        objects.join(", ")
    ))
}

/// How high the first camera is above what is below it.
fn above_floor(scene: &Scene) -> f32 {
    let eye = scene.cameras[0].camera.eye;
    Probe::new(&scene.geometry).look_along(eye, Vec3::NEG_Y, 0.0).unwrap().distance
}

/// Whether one stands on a floor, as high as a person, and sees something ahead.
fn assert_entered(scene: &Scene, unit: Unit, what: &str) {
    assert!(scene.on_foot(), "{what}: {}", scene.start);
    assert!(matches!(scene.start.entry, Entry::Level | Entry::Interior), "{what}");
    assert_eq!(scene.start.unit, unit, "{what}");
    let metres = above_floor(scene) / unit.per_metre();
    assert!((1.5..1.7).contains(&metres), "{what}: {metres} m");
    assert!((scene.start.eye_height.unwrap() / unit.per_metre() - metres).abs() < 0.05, "{what}");
    let camera = scene.cameras[0].camera;
    let view = (camera.look_at - camera.eye).normalize();
    assert!(view.y.abs() < 0.01, "{what}: level");
    let mut probe = Probe::new(&scene.geometry);
    let ahead = probe.look_along(camera.eye, view, 0.0).map_or(f32::INFINITY, |met| met.distance);
    assert!(ahead >= 1.5 * unit.per_metre(), "{what}: free for {ahead}");
    assert!(filled(scene, u32::MAX)[0] > 0.5, "{what}: something in view");
}

#[test]
fn things_fill_the_picture() {
    let gallery = [
        ("a ball", vec![ball([0.0; 3], 1.0)]),
        ("a box", vec![cuboid([0.0; 3], [1.0, 1.0, 1.0])]),
        ("a tower", vec![cuboid([0.0; 3], [1.0, 30.0, 1.0])]),
        ("a rod", vec![cuboid([0.0; 3], [30.0, 1.0, 1.0])]),
        ("a rod in depth", vec![cuboid([0.0; 3], [1.0, 1.0, 30.0])]),
        ("a picture", vec![cuboid([0.0; 3], [3.0, 2.0, 0.01])]),
        ("a tiny ball", vec![ball([0.0; 3], 1e-4)]),
        ("two balls far apart", vec![ball([0.0; 3], 1.0), ball([20.0, 0.0, -5.0], 1.0)]),
        ("a ball far from the origin", vec![ball([1e5, 0.0, -1e5], 1.0)]),
        ("a cone", vec![r#"{ "type": "cone", "base": [0, 0, 0], "top": [0, 1, 0], "radius": 1 }"#.to_owned()]),
    ];
    for (what, objects) in gallery {
        assert_fills(&scene(&objects), u32::MAX - 1, what);
    }
    let sized = load_text(format!(
        r#"{{ "version": 1, "render": {{ "width": 1600, "height": 900 }}, "objects": [{}] }}"#,
        cuboid([0.0; 3], [30.0, 1.0, 1.0])
    ));
    let [width, _] = filled(&sized.unwrap(), 1);
    assert!(width > 0.85, "a size of the file's own is filled: {width}");
}

#[test]
fn grounds_domes_and_strays_do_not_decide_the_scale() {
    let thing = || vec![ball([0.0, 0.5, 0.0], 0.5), cuboid([0.5, 0.0, -0.5], [1.5, 1.2, 0.5])];
    let with = |more: &[String]| scene(&[&thing()[..], more].concat());
    let large = ground(0.0, [100.0, 100.0]);
    assert_fills(&with(std::slice::from_ref(&large)), 2, "a ground");
    assert_fills(&with(&[ball([0.0; 3], 500.0)]), 2, "a dome");
    assert_fills(&with(&[large, ball([0.0; 3], 500.0)]), 2, "a ground under a dome");
    let crowd: Vec<String> = (0..100).map(|i| ball([(i % 10) as f32, 0.0, (i / 10) as f32], 0.4)).collect();
    assert_fills(&scene(&[&crowd[..], &[ball([5000.0, 0.0, 0.0], 0.4)]].concat()), 100, "a crowd with a stray");
    // Real sizes are told nevertheless.
    assert_eq!(with(&[ground(0.0, [100.0, 100.0])]).bounds().size().x, 200.0);
    // A ground of about the thing's own size stays in the picture.
    assert_fills(&with(&[ground(0.0, [2.0, 2.0])]), 3, "a base");
}

/// Walls on lines of a grid of 4 m, with gaps to walk through.
fn maze() -> Vec<String> {
    let mut objects = vec![cuboid([-12.0, -0.2, -12.0], [12.0, 0.0, 12.0])];
    for end in [-12.0, 11.8] {
        objects.push(cuboid([-12.0, 0.0, end], [12.0, 3.0, end + 0.2]));
        objects.push(cuboid([end, 0.0, -12.0], [end + 0.2, 3.0, 12.0]));
    }
    objects.push(cuboid([-12.0, 0.0, -4.1], [4.0, 3.0, -3.9]));
    objects.push(cuboid([-4.0, 0.0, 3.9], [12.0, 3.0, 4.1]));
    objects.push(cuboid([-8.1, 0.0, -3.0], [-7.9, 3.0, 8.0]));
    objects
}

#[test]
fn a_maze_without_a_roof_is_entered_in_metres_and_in_centimetres() {
    assert_entered(&scene(&maze()), Unit::Metre, "a maze");
    assert_entered(&scaled(&maze(), 100.0), Unit::Centimetre, "a maze in centimetres");
}

/// Two rows of houses along a street.
fn street() -> Vec<String> {
    let mut objects = vec![ground(0.0, [32.0, 20.0])];
    for i in 0..5 {
        let x = -30.0 + 12.0 * i as f32;
        objects.push(cuboid([x, 0.0, -16.0], [x + 10.0, 8.0, -6.0]));
        objects.push(cuboid([x, 0.0, 6.0], [x + 10.0, 6.0 + i as f32, 16.0]));
    }
    objects
}

#[test]
fn a_street_is_entered_and_seen_along_its_length() {
    let town = scene(&street());
    assert_entered(&town, Unit::Metre, "a street");
    let camera = town.cameras[0].camera;
    assert!(camera.eye.z.abs() < 6.0 && camera.eye.x.abs() < 30.0, "{}", camera.eye);
    let view = camera.look_at - camera.eye;
    assert!(view.x.abs() > 2.0 * view.z.abs(), "{view}");
    // On a plain under the sky it is the same town.
    let plain = [&street()[1..], &[ground(0.0, [2000.0, 2000.0]), ball([0.0; 3], 5000.0)]].concat();
    assert_entered(&scene(&plain), Unit::Metre, "a town on a plain");
}

/// A hall with pillars, open at one end.
fn hall(floor: f32) -> Vec<String> {
    let mut objects = vec![
        cuboid([-6.0, floor - 0.2, -15.0], [6.0, floor, 15.0]),
        cuboid([-6.0, floor + 4.0, -15.0], [6.0, floor + 4.2, 15.0]),
        cuboid([-6.0, floor, -15.0], [-5.8, floor + 4.0, 15.0]),
        cuboid([5.8, floor, -15.0], [6.0, floor + 4.0, 15.0]),
        cuboid([-6.0, floor, -15.0], [6.0, floor + 4.0, -14.8]),
    ];
    for i in 0..5 {
        let z = -12.0 + 6.0 * i as f32;
        objects.push(cuboid([-3.2, floor, z], [-2.8, floor + 4.0, z + 0.4]));
        objects.push(cuboid([2.8, floor, z], [3.2, floor + 4.0, z + 0.4]));
    }
    objects
}

#[test]
fn a_hall_and_a_house_of_two_storeys_are_entered() {
    assert_entered(&scene(&hall(0.0)), Unit::Metre, "a hall");
    let house = [hall(0.0), hall(4.2)].concat();
    assert_entered(&scene(&house), Unit::Metre, "a house of two storeys");
    assert_entered(&scaled(&house, 100.0), Unit::Centimetre, "a house in centimetres");
}

#[test]
fn models_of_things_are_not_entered() {
    let car = [
        cuboid([-2.3, 0.3, -0.9], [2.3, 0.9, 0.9]),
        cuboid([-1.2, 0.9, -0.8], [1.2, 1.45, 0.8]),
        ball([1.5, 0.3, 0.9], 0.3),
        ball([-1.5, 0.3, 0.9], 0.3),
    ];
    let table = [
        cuboid([-3.0, 0.7, -2.0], [3.0, 0.75, 2.0]),
        cuboid([-2.9, 0.0, -1.9], [-2.8, 0.7, -1.8]),
        cuboid([2.8, 0.0, 1.8], [2.9, 0.7, 1.9]),
    ];
    let helmet: Vec<String> = (0..40)
        .map(|i| {
            let angle = i as f32 * 2.4;
            let (height, across) = (i as f32 / 20.0 - 1.0, (1.0 - (i as f32 / 20.0 - 1.0).powi(2)).sqrt());
            ball([10.0 * across * angle.cos(), 10.0 * height, 10.0 * across * angle.sin()], 2.5)
        })
        .collect();
    let statue = [ground(0.0, [6.0, 6.0]), cuboid([-0.5, 0.0, -0.5], [0.5, 3.0, 0.5])];
    let plane = [ground(0.0, [50.0, 50.0])];
    let house = [ground(0.0, [9.0, 9.0]), cuboid([-5.0, 0.0, -4.0], [5.0, 6.0, 4.0])];
    let blocks =
        [ground(0.0, [7.5, 7.5]), cuboid([0.0, 0.0, 0.0], [7.0, 4.0, 7.0]), cuboid([-2.0, 0.0, -2.0], [2.0, 9.0, 2.0])];
    let sofa = [
        cuboid([-1.1, 0.1, -0.45], [1.1, 0.4, 0.45]),
        cuboid([-1.1, 0.4, -0.45], [1.1, 0.85, -0.3]),
        cuboid([-1.1, 0.4, -0.3], [-0.95, 0.6, 0.45]),
        cuboid([0.95, 0.4, -0.3], [1.1, 0.6, 0.45]),
    ];
    let board = |y: f32| cuboid([-0.5, y, -0.15], [0.5, y + 0.02, 0.15]);
    let sides = [-0.5, 0.48].map(|x| cuboid([x, 0.0, -0.15], [x + 0.02, 2.0, 0.15]));
    let shelves: Vec<String> = (0..7).map(|i| board(0.33 * i as f32)).chain(sides).collect();
    let things = [
        ("a car", &car[..], 1.0),
        ("a car in centimetres", &car, 100.0),
        ("a car in millimetres", &car, 1000.0),
        ("a table", &table, 1.0),
        ("a table in centimetres", &table, 100.0),
        ("a helmet", &helmet, 1.0),
        ("a statue", &statue, 1.0),
        ("a plane", &plane, 1.0),
        ("a house alone", &house, 1.0),
        ("blocks on a plate", &blocks, 1.0),
        ("a sofa in centimetres", &sofa, 100.0),
        ("a sofa in millimetres", &sofa, 1000.0),
        ("shelves in centimetres", &shelves, 100.0),
        ("shelves in millimetres", &shelves, 1000.0),
    ];
    for (what, objects, scale) in things {
        let scene = scaled(objects, scale);
        assert_eq!(scene.start.entry, Entry::Framed, "{what}");
        assert!(!scene.on_foot(), "{what}");
    }
    assert_fills(&scaled(&car, 100.0), u32::MAX - 1, "a car in centimetres");
}

#[test]
fn a_camera_of_the_file_wins() {
    let text = format!(
        r#"{{ "version": 1, "camera": {{ "position": [0, 9, 0], "look_at": [1, 0, 0] }}, "objects": [{}] }}"#,
        maze().join(", ")
    );
    let scene = load_text(text).unwrap();
    assert_eq!((scene.cameras[0].camera.eye, scene.on_foot()), (Vec3::Y * 9.0, false));
    assert_eq!(scene.start.entry, Entry::Camera);
}

#[test]
fn an_object_of_an_obj_file_may_be_the_spawn_point() {
    let text = "v -9 0 9\nv 9 0 9\nv 9 0 -9\nv -9 0 -9\nv -9 3 -9\nv 9 3 -9\n\
        v 2.9 1 3\nv 3.1 1 3\nv 3 1.2 3\n\
        o level\nf 1 2 3 4\nf 4 3 6 5\no PlayerStart\nf 7 8 9\n";
    let folder = Folder::new();
    let scene = load(&folder.write("s.obj", text), &LoadOptions::default()).unwrap();
    assert_eq!(scene.start.entry, Entry::Spawn("PlayerStart".to_owned()));
    let eye = scene.cameras[0].camera.eye;
    assert!((eye.x - 3.0).abs() < 0.01 && (eye.z - 3.0).abs() < 0.01 && scene.on_foot(), "{eye}");
}
