//! Walks through small places: what must never happen, and what must work.

use super::*;
use crate::geometry::{Part, PrimitiveId, Shape};
use crate::math::random::SplitMix64;
use crate::scene::{LoadOptions, Start, load, load_text};
use std::path::Path;

const EYE: f64 = PERSON;
pub(super) const FORWARD: Motion = Motion { right: 0.0, up: 0.0, forward: 1.0, fast: false, slow: false };
pub(super) const JUMP: Motion = Motion { up: 1.0, forward: 0.0, ..FORWARD };
pub(super) const STAND: Motion = Motion { forward: 0.0, ..FORWARD };

pub(super) fn place(shapes: impl IntoIterator<Item = Shape>) -> Geometry {
    let part = |(i, shape)| Part::new(shape, PrimitiveId { object: i as u32, primitive: 0 });
    Geometry::build(shapes.into_iter().enumerate().map(part).collect())
}

pub(super) fn quad([a, b, c, d]: [Vec3; 4]) -> [Shape; 2] {
    [Shape::Triangle { vertices: [a, b, c] }, Shape::Triangle { vertices: [a, c, d] }]
}

/// The six faces of a box.
fn cuboid(min: Vec3, max: Vec3) -> Vec<Shape> {
    let corner = |i: usize| {
        let pick = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    faces.into_iter().flat_map(|face| quad(face.map(corner))).collect()
}

pub(super) fn floor() -> Shape {
    Shape::Plane { point: Vec3::ZERO, normal: Vec3::Y }
}

/// Someone who looks along `yaw` (0: along -Z, positive turns left) from `eye`, and walks if there is room.
pub(super) fn someone(geometry: &Geometry, eye: Vec3, yaw: f32) -> Walker {
    let mut walker = Walker::new(Camera::from_yaw_pitch(eye, yaw, 0.0, 60.0), 12.0);
    assert!(walker.toggle_walking(geometry), "no room at {eye}");
    walker
}

pub(super) fn go(walker: &mut Walker, geometry: &Geometry, motion: Motion, seconds: f64, fps: f64) {
    for _ in 0..(seconds * fps).round() as usize {
        assert!(walker.advance(geometry, motion, 1.0 / fps));
    }
}

pub(super) fn eye(walker: &Walker) -> DVec3 {
    walker.pose.eye
}

/// Walks at random and shows every place to `check`.
fn stroll(walker: &mut Walker, geometry: &Geometry, seed: u64, fps: f64, seconds: f64, mut check: impl FnMut(DVec3)) {
    let mut random = SplitMix64(seed);
    let mut motion = STAND;
    let frames = (seconds * fps) as usize;
    for frame in 0..frames {
        if frame % (fps / 3.0).ceil() as usize == 0 {
            let axis = |random: &mut SplitMix64| random.within(-1.0, 2.0).floor();
            let fast = random.within(0.0, 1.0) < 0.5;
            motion = Motion { right: axis(&mut random), up: axis(&mut random), forward: 1.0, fast, slow: false };
            walker.pose.yaw += random.within(-90.0, 90.0);
        }
        assert!(walker.advance(geometry, motion, 1.0 / fps));
        check(eye(walker));
    }
}

/// A closed room of 8 x 3 x 6 m with things in it: thin, round, low, leaning, and walls that meet in a wedge.
fn room() -> Geometry {
    let mut shapes = cuboid(Vec3::new(-4.0, 0.0, -3.0), Vec3::new(4.0, 3.0, 3.0));
    let up = |x: f32, z: f32, top: f32| (Vec3::new(x, 0.0, z), Vec3::new(x, top, z));
    for (x, radius) in [(-2.0, 0.01), (-1.0, 0.1), (2.0, 1e-3)] {
        let (base, top) = up(x, 0.5, 3.0);
        shapes.push(Shape::Cone { base, top, radius_base: radius, radius_top: radius });
    }
    shapes.push(Shape::Sphere { center: Vec3::new(1.5, 0.3, -1.5), radius: 0.8 });
    shapes.push(Shape::Disk { center: Vec3::new(-2.5, 0.8, -1.5), normal: Vec3::Y, radius: 0.6 });
    let (base, top) = up(3.0, 2.0, 1.5);
    shapes.push(Shape::Cone { base, top, radius_base: 0.7, radius_top: 0.0 });
    let wall = |a: [f32; 2], b: [f32; 2]| {
        let [a, b] = [a, b].map(|[x, z]| Vec3::new(x, 0.0, z));
        quad([a, b, b + Vec3::Y * 3.0, a + Vec3::Y * 3.0])
    };
    shapes.extend(wall([-4.0, 3.0], [-1.5, 1.5]));
    // A board that leans against the wall.
    shapes.extend(quad([[0.0, 0.0, -2.0], [1.0, 0.0, -2.0], [1.0, 2.0, -3.0], [0.0, 2.0, -3.0]].map(Vec3::from)));
    place(shapes)
}

#[test]
fn nobody_leaves_a_closed_room_at_any_frame_rate() {
    let room = room();
    for (fps, speed) in [(15.0, 2.5), (60.0, 2.5), (240.0, 2.5), (15.0, 300.0), (60.0, 40.0)] {
        for seed in 0..4 {
            let mut walker = someone(&room, Vec3::new(0.0, 1.6, 0.0), 0.0);
            walker.set_speed(speed);
            let (mut farthest, mut before) = (0.0_f64, eye(&walker));
            stroll(&mut walker, &room, seed, fps, 20.0, |eye| {
                let outside = [eye.x.abs() - 4.0, eye.z.abs() - 3.0, -eye.y, eye.y - 3.0];
                let outside = outside.into_iter().fold(f64::NEG_INFINITY, f64::max);
                assert!(outside < -0.2, "{eye} with {speed} m/s at {fps}");
                assert!(room.nearest(eye, 0.2).is_none(), "{eye} touches something");
                let world = World { geometry: &room, up: DVec3::Y };
                assert!(speed > 3.0 || world.is_free(before, eye), "from {before} through something to {eye}");
                before = eye;
                farthest = farthest.max(eye.distance(DVec3::new(0.0, 1.6, 0.0)));
            });
            assert!(farthest > 2.0, "stuck: {farthest} with {speed} m/s at {fps}");
        }
    }
}

#[test]
fn a_walk_is_the_same_at_any_frame_rate() {
    let room = room();
    let at = |fps: f64| {
        let mut walker = someone(&room, Vec3::new(0.0, 1.6, 0.0), 35.0);
        go(&mut walker, &room, FORWARD, 1.0, fps);
        go(&mut walker, &room, Motion { up: 1.0, ..FORWARD }, 0.4, fps);
        go(&mut walker, &room, STAND, 1.0, fps);
        eye(&walker)
    };
    let slow = at(15.0);
    for fps in [60.0, 240.0] {
        assert!(at(fps).distance(slow) < 0.02, "{} {slow}", at(fps));
    }
}

#[test]
fn stairs_of_any_riser_up_to_a_step_are_climbed_and_higher_ones_are_not() {
    for (riser, climbs) in
        [(0.05, true), (0.18, true), (0.3, true), (0.4, true), (0.42, false), (0.46, false), (0.6, false)]
    {
        let step = |i: u32| {
            let (height, z) = (riser * (i + 1) as f32, -2.0 - 0.3 * i as f32);
            cuboid(Vec3::new(-2.0, 0.0, -20.0), Vec3::new(2.0, height, z))
        };
        let stairs = place((0..10).flat_map(step).chain([floor()]));
        for fps in [15.0, 240.0] {
            let mut walker = someone(&stairs, Vec3::new(0.3, 1.6, 0.0), 0.0);
            go(&mut walker, &stairs, FORWARD, 4.0, fps);
            let height = eye(&walker).y - EYE;
            let expected = if climbs { f64::from(riser) * 10.0 } else { 0.0 };
            assert!((height - expected).abs() < 0.02, "risers of {riser}: {height}");
            walker.pose.yaw = 180.0;
            go(&mut walker, &stairs, FORWARD, 4.0, fps);
            assert!((eye(&walker).y - EYE).abs() < 0.02, "down again: {}", eye(&walker));
        }
    }
}

#[test]
fn one_slides_along_walls() {
    let wall = place([floor(), Shape::Plane { point: Vec3::new(0.0, 0.0, -2.0), normal: Vec3::Z }]);
    let mut walker = someone(&wall, Vec3::new(0.0, 1.6, 0.0), -45.0);
    go(&mut walker, &wall, FORWARD, 4.0, 60.0);
    let eye = eye(&walker);
    assert!((eye.z + 1.75).abs() < 0.01, "{eye}");
    assert!((eye.x - 10.0 / 2.0_f64.sqrt()).abs() < 0.1, "{eye}");
}

#[test]
fn backs_that_are_not_seen_stop_the_body() {
    let corners = [[-9.0, 0.0], [9.0, 0.0], [9.0, 3.0], [-9.0, 3.0]].map(|[x, y]| Vec3::new(x, y, -3.0));
    let [a, b, c, d] = corners;
    for wall in [corners, [d, c, b, a]] {
        let part =
            |(i, shape)| Part { one_sided: true, ..Part::new(shape, PrimitiveId { object: i as u32, primitive: 0 }) };
        let shapes = quad(wall).into_iter().chain([floor()]);
        let geometry = Geometry::build(shapes.enumerate().map(part).collect());
        let mut walker = someone(&geometry, Vec3::new(0.0, 1.6, 0.0), 0.0);
        go(&mut walker, &geometry, FORWARD, 4.0, 60.0);
        assert!((-3.0..-2.0).contains(&eye(&walker).z), "{}", eye(&walker));
    }
}

#[test]
fn one_falls_onto_the_floor_and_stays_there() {
    let ground = place([floor()]);
    let mut walker = someone(&ground, Vec3::new(0.0, 30.0, 0.0), 0.0);
    go(&mut walker, &ground, STAND, 1.0, 60.0);
    assert!((eye(&walker).y - (30.0 - 4.905)).abs() < 0.1, "{}", eye(&walker));
    go(&mut walker, &ground, STAND, 4.0, 60.0);
    assert!((eye(&walker).y - EYE).abs() < 1e-3, "{}", eye(&walker));
    assert!(!walker.is_under_way(), "standing still takes no time");
    let before = walker.camera();
    go(&mut walker, &ground, STAND, 1.0, 60.0);
    assert_eq!(walker.camera(), before);
}

#[test]
fn a_jump_is_half_a_metre_high_once_a_press_and_ends_at_ceilings() {
    for (ceiling, expected) in [(100.0, 0.5), (2.0, 0.15)] {
        let hall = place([floor(), Shape::Plane { point: Vec3::Y * ceiling, normal: Vec3::NEG_Y }]);
        let mut walker = someone(&hall, Vec3::new(0.0, 1.6, 0.0), 0.0);
        go(&mut walker, &hall, STAND, 0.5, 60.0);
        let (mut highest, mut jumps) = (0.0_f64, 0);
        let mut last = 0.0;
        for _ in 0..180 {
            go(&mut walker, &hall, JUMP, 1.0 / 60.0, 60.0);
            let height = eye(&walker).y - EYE;
            jumps += u32::from(last < 1e-3 && height > 1e-3);
            (highest, last) = (highest.max(height), height);
        }
        assert!((highest - expected).abs() < 0.02, "{highest}");
        assert!(jumps == 1 && last.abs() < 1e-3, "{jumps} jumps, ends at {last}");
        go(&mut walker, &hall, STAND, 0.1, 60.0);
        assert!(walker.advance(&hall, JUMP, 0.0), "a tap between two frames");
        go(&mut walker, &hall, STAND, 0.1, 60.0);
        assert!(eye(&walker).y - EYE > 0.1);
    }
}

#[test]
fn off_the_edge_of_the_world_one_stays_in_the_air() {
    let island = place(cuboid(Vec3::new(-2.0, -1.0, -2.0), Vec3::new(2.0, 0.0, 2.0)));
    let mut walker = someone(&island, Vec3::new(0.0, 1.6, 0.0), 0.0);
    go(&mut walker, &island, FORWARD, 3.0, 60.0);
    assert!(eye(&walker).z < -7.0 && (eye(&walker).y - EYE).abs() < 1e-3, "{}", eye(&walker));
    go(&mut walker, &island, JUMP, 0.1, 60.0);
    go(&mut walker, &island, STAND, 2.0, 60.0);
    assert!((eye(&walker).y - EYE).abs() < 1e-3, "{}", eye(&walker));
    assert!(!walker.is_under_way());
    // With nothing anywhere, too.
    let nothing = place([]);
    let mut walker = someone(&nothing, Vec3::new(5.0, 5.0, 5.0), 0.0);
    go(&mut walker, &nothing, FORWARD, 1.0, 60.0);
    assert_eq!(eye(&walker).y, 5.0);
}

#[test]
fn one_steps_down_from_a_wall_and_lands_on_lower_ground() {
    let mut shapes = cuboid(Vec3::new(-2.0, -1.0, -2.0), Vec3::new(2.0, 3.0, 2.0));
    shapes.push(floor());
    let tower = place(shapes);
    let mut walker = someone(&tower, Vec3::new(0.0, 4.6, 0.0), 0.0);
    go(&mut walker, &tower, FORWARD, 3.0, 60.0);
    assert!((eye(&walker).y - EYE).abs() < 1e-3, "{}", eye(&walker));
}

#[test]
fn inside_of_something_solid_there_is_room_or_a_word() {
    // A wall of 20 cm: no room in it, none may be found on either side of it.
    let wall = place(cuboid(Vec3::new(-5.0, 0.0, -0.1), Vec3::new(5.0, 3.0, 0.1)).into_iter().chain([floor()]));
    let mut walker = Walker::new(Camera::from_yaw_pitch(Vec3::new(0.0, 1.6, 0.0), 0.0, 0.0, 60.0), 12.0);
    assert!(!walker.toggle_walking(&wall) && !walker.is_walking());
    go(&mut walker, &wall, FORWARD, 0.2, 60.0);
    assert!(eye(&walker).z < -0.1, "flying goes on");
    // The inside of a ball is a room.
    let ball = place([Shape::Sphere { center: Vec3::ZERO, radius: 5.0 }]);
    let mut walker = someone(&ball, Vec3::ZERO, 0.0);
    stroll(&mut walker, &ball, 3, 30.0, 20.0, |eye| assert!(eye.length() < 4.8, "{eye}"));
}

#[test]
fn next_to_a_wall_one_is_moved_off_it_on_the_same_side() {
    let wall = place([floor(), Shape::Plane { point: Vec3::ZERO, normal: Vec3::Z }]);
    for z in [0.01, -0.01, 0.2, -1e-4] {
        let mut walker = someone(&wall, Vec3::new(0.0, 1.6, z), 0.0);
        go(&mut walker, &wall, STAND, 0.5, 60.0);
        assert!(eye(&walker).z * f64::from(z).signum() > 0.2, "{z}: {}", eye(&walker));
    }
}

#[test]
fn a_low_camera_is_raised_and_a_low_ceiling_bends_the_knees() {
    let ground = place([floor()]);
    let mut walker = someone(&ground, Vec3::new(0.0, 0.2, 0.0), 0.0);
    go(&mut walker, &ground, STAND, 1.0, 60.0);
    assert!((eye(&walker).y - EYE).abs() < 1e-3);
    // A corridor of 1.6 m, reached from a hall.
    let mut shapes = vec![floor()];
    shapes.extend(cuboid(Vec3::new(-9.0, 1.6, -9.0), Vec3::new(9.0, 4.0, -2.0)));
    let corridor = place(shapes);
    let mut walker = someone(&corridor, Vec3::new(0.0, 1.3, -4.0), 0.0);
    go(&mut walker, &corridor, FORWARD, 1.0, 60.0);
    assert!(eye(&walker).y < 1.4 && eye(&walker).z < -6.0, "{}", eye(&walker));
    go(&mut walker, &corridor, STAND, 0.5, 60.0);
    assert!(!walker.is_under_way(), "it ends");
}

/// Hills of triangles, up to 3 m high, steep and with ridges.
fn hills() -> Geometry {
    let height = |x: i32, z: i32| {
        let mut random = SplitMix64((x as u64) << 32 ^ z as u32 as u64);
        Vec3::new(x as f32, random.within(0.0, 1.0) as f32 + 2.0 * ((x as f32) * 0.6).sin(), z as f32)
    };
    let cells = (-12..12).flat_map(|x| (-12..12).map(move |z| [(x, z), (x + 1, z), (x + 1, z + 1), (x, z + 1)]));
    let ground = cells.flat_map(|cell| quad(cell.map(|(x, z)| height(x, z))));
    place(ground.chain(cuboid(Vec3::new(-11.5, -9.0, -11.5), Vec3::new(11.5, 9.0, 11.5))))
}

#[test]
fn nobody_falls_through_hills() {
    let hills = hills();
    for (fps, speed) in [(15.0, 2.5), (240.0, 2.5), (30.0, 25.0)] {
        let mut walker = someone(&hills, Vec3::new(0.5, 6.0, 0.5), 0.0);
        walker.set_speed(speed);
        let mut farthest = 0.0_f64;
        stroll(&mut walker, &hills, 7, fps, 30.0, |eye| {
            let world = World { geometry: &hills, up: DVec3::Y };
            let below = world.distance(eye, DVec3::NEG_Y).expect("there is ground");
            assert!(eye.y - below > -2.5, "under the ground: {eye} at {fps}");
            assert!(eye.abs().max_element() < 11.4, "{eye}");
            farthest = farthest.max(eye.length());
        });
        assert!(farthest > 5.0, "stuck: {farthest} at {fps}");
    }
}

#[test]
fn balls_of_every_size_are_walked_among() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/sphereflake.json");
    let scene = load(&file, &LoadOptions::default()).expect("it is ours");
    let mut walker = Walker::in_scene(&scene, scene.cameras[0].camera);
    assert!(walker.set_eye_height(&scene.geometry, 0.3));
    assert!(walker.toggle_walking(&scene.geometry));
    let radius = walker.eye_height() * 0.15;
    stroll(&mut walker, &scene.geometry, 1, 60.0, 30.0, |eye| {
        assert!(scene.geometry.nearest(eye, radius * 0.9).is_none(), "{eye}");
    });
}

#[test]
fn what_is_no_metre_has_another_eye_height() {
    assert_eq!(usual_eye_height(12.0, Some(0.4)), PERSON);
    assert_eq!(usual_eye_height(0.5, Some(0.08)), 0.08, "the first camera's own");
    assert_eq!(usual_eye_height(0.5, None), 0.03);
    assert_eq!(usual_eye_height(5000.0, Some(170.0)), 170.0);
    assert_eq!(usual_eye_height(5000.0, Some(4000.0)), 300.0);
}

#[test]
fn another_eye_height_is_taken_where_it_fits() {
    let hall = place([floor(), Shape::Plane { point: Vec3::Y * 2.5, normal: Vec3::NEG_Y }]);
    let mut walker = someone(&hall, Vec3::new(0.0, 1.6, 0.0), 0.0);
    assert!(walker.set_eye_height(&hall, 1.0));
    go(&mut walker, &hall, STAND, 0.5, 60.0);
    assert!((eye(&walker).y - 1.0).abs() < 1e-3);
    assert!(!walker.set_eye_height(&hall, 5.0) && !walker.set_eye_height(&hall, f64::NAN));
    assert_eq!(walker.eye_height(), 1.0);
}

#[test]
fn a_scene_that_changes_around_a_walker_does_not_hold_them() {
    let before = place([floor()]);
    let after = place(cuboid(Vec3::new(-9.0, 0.0, -0.1), Vec3::new(9.0, 3.0, 0.1)).into_iter().chain([floor()]));
    let mut walker = someone(&before, Vec3::new(0.0, 1.6, 0.0), 0.0);
    go(&mut walker, &before, STAND, 0.5, 60.0);
    walker.lose_footing();
    let stood = walker.camera();
    go(&mut walker, &after, STAND, 0.5, 60.0);
    assert_eq!(walker.camera(), stood, "the view is kept");
    assert!(!walker.advance(&after, FORWARD, 0.01) && !walker.is_walking(), "within a wall there is no room");
    go(&mut walker, &after, FORWARD, 0.5, 60.0);
    assert!(eye(&walker).z < -0.5);
}

/// A closed room, as a scene whose camera stands on its floor or flies in it.
fn room_scene(on_foot: bool) -> Scene {
    let text = r#"{ "version": 1, "camera": { "position": [0, 1.6, 0], "look_at": [0, 1.6, -1] },
        "objects": [ { "type": "box", "min": [-3, -0.1, -3], "max": [3, 0, 3] },
            { "type": "box", "min": [-3, 0, -3.1], "max": [3, 2.5, -3] },
            { "type": "box", "min": [-3, 0, 3], "max": [3, 2.5, 3.1] },
            { "type": "box", "min": [-3.1, 0, -3], "max": [-3, 2.5, 3] },
            { "type": "box", "min": [3, 0, -3], "max": [3.1, 2.5, 3] } ] }"#;
    let scene = load_text("room.json", text, &LoadOptions::default()).expect("right");
    let start = Start { eye_height: on_foot.then_some(1.6), ..scene.start.clone() };
    Scene { start, ..scene }
}

#[test]
fn where_the_first_camera_stands_on_a_floor_one_starts_on_foot_and_stays_inside() {
    let scene = room_scene(true);
    let home = scene.cameras[0].camera;
    let mut walker = Walker::in_scene(&scene, home);
    assert!(walker.is_walking());
    assert_eq!(walker.camera(), home, "bit for bit");
    for turn in [0.0, 400.0, 777.0, 1234.0] {
        walker.look(DVec2::new(turn, 0.0));
        go(&mut walker, &scene.geometry, FORWARD, 5.0, 30.0);
        let eye = eye(&walker);
        assert!(eye.x.abs() < 3.0 && eye.z.abs() < 3.0 && (eye.y - EYE).abs() < 0.01, "{eye}");
    }
    assert!(!Walker::in_scene(&room_scene(false), home).is_walking());
    let elsewhere = Camera { eye: Vec3::new(0.0, 2.4, 1.0), ..home };
    assert!(!Walker::in_scene(&scene, elsewhere).is_walking(), "another camera was asked for");
}

#[test]
fn in_the_next_scene_one_goes_as_it_says_until_the_user_has_chosen() {
    let (level, object) = (room_scene(true), room_scene(false));
    let home = level.cameras[0].camera;
    let mut walker = Walker::in_scene(&object, home);
    walker.enter(&level, home);
    assert!(walker.is_walking());
    walker.enter(&object, home);
    assert!(!walker.is_walking());
    assert!(walker.toggle_walking(&object.geometry));
    walker.enter(&object, home);
    assert!(walker.is_walking(), "the user chose to walk");
    assert!(walker.toggle_walking(&object.geometry));
    walker.enter(&level, home);
    assert!(!walker.is_walking(), "and to fly");
}

#[test]
fn the_speed_has_ends_and_home_resets_it() {
    let scene = room_scene(false);
    let mut walker = Walker::in_scene(&scene, scene.cameras[0].camera);
    let usual = walker.speed();
    (0..200).for_each(|_| walker.scroll(-1.0));
    assert!((walker.speed() * 32.0 / usual - 1.0).abs() < 1e-9);
    let before = eye(&walker);
    go(&mut walker, &scene.geometry, FORWARD, 5.0, 60.0);
    assert!(eye(&walker).distance(before) > 0.1, "W is not dead");
    walker.go_home();
    assert_eq!(walker.speed(), usual);
}

#[test]
fn home_is_home_on_foot_too() {
    let ground = place([floor()]);
    let mut walker = someone(&ground, Vec3::new(0.0, 5.0, 0.0), 0.0);
    go(&mut walker, &ground, FORWARD, 3.0, 60.0);
    walker.go_home();
    go(&mut walker, &ground, STAND, 1.0, 60.0);
    assert_eq!(walker.camera(), walker.home);
    assert!(walker.is_walking() && !walker.is_under_way());
    go(&mut walker, &ground, FORWARD, 2.0, 60.0);
    assert!((eye(&walker).y - EYE).abs() < 1e-2, "{}", eye(&walker));
}

/// A camera at `eye` that is turned as a whole, as those of glTF are: its `up` is across its view.
fn turned(eye: Vec3, yaw: f64, pitch: f64) -> Camera {
    let turn = DQuat::from_rotation_y(yaw.to_radians()) * DQuat::from_rotation_x(pitch.to_radians());
    let (forward, up) = (turn * DVec3::NEG_Z, turn * DVec3::Y);
    Camera { eye, look_at: (eye.as_dvec3() + forward).as_vec3(), up: up.as_vec3(), ..Camera::default() }
}

#[test]
fn a_camera_that_looks_down_with_its_own_up_does_not_tilt_the_scene() {
    let ground = place([floor()]);
    for (yaw, pitch) in [(0.0, -35.0), (130.0, 50.0), (-77.7, -86.0), (20.0, -89.9), (10.0, 0.0)] {
        let home = turned(Vec3::new(3.3, 2.5, -1.7), yaw, pitch);
        let mut walker = Walker::new(home, 12.0);
        assert_eq!(walker.camera(), home, "bit for bit");
        assert!(walker.up().distance(DVec3::Y) < 1e-12, "{} at {pitch}", walker.up());
        assert!(walker.toggle_walking(&ground), "a floor at {pitch}");
        go(&mut walker, &ground, FORWARD, 3.0, 60.0);
        assert!((eye(&walker).y - EYE).abs() < 0.01, "{} at {pitch}", eye(&walker));
        let (before, after) = (home.frame(64, 64), walker.camera().frame(64, 64));
        assert!(pitch.abs() > MAX_PITCH || after.up.abs_diff_eq(before.up, 1e-4), "{} {}", before.up, after.up);
        walker.look(DVec2::new(300.0, 0.0));
        assert!(walker.camera().frame(64, 64).right.y.abs() < 1e-6, "the horizon stays level");
    }
}

#[test]
fn an_up_to_the_side_or_along_another_axis_is_the_scenes() {
    for up in [Vec3::Z, Vec3::NEG_Y, Vec3::X, Vec3::new(0.3, 1.0, 0.1), Vec3::new(0.0, 1e-5, 1.0)] {
        let home = Camera { eye: Vec3::ZERO, look_at: Vec3::new(0.1, 0.3, -0.2), up, ..Camera::default() };
        let walker = Walker::new(home, 12.0);
        assert!(walker.up().distance(up.as_dvec3().normalize()) < 1e-6, "{up}: {}", walker.up());
    }
}
