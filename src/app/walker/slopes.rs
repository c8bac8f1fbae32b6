//! Walks up slopes: what is steeper than 50 degrees and higher than a step is a wall, whatever its shape.

use super::trials::{FORWARD, JUMP, STAND, eye, floor, go, place, quad, someone};
use super::*;
use crate::geometry::Shape;
use std::f32::consts::TAU;

/// The highest step of a person, with what rounding and the length of a tick may add.
const STEP: f64 = 0.4 + 0.005;

/// What became of someone who walked into something for some seconds.
struct Walk {
    /// The greatest height of the feet.
    highest: f64,
    /// Where the feet were at the end.
    end: DVec3,
}

/// Walks along `yaw` from (0, 0, 2) for `seconds`.
fn walk(shapes: impl IntoIterator<Item = Shape>, yaw: f32, seconds: f64) -> Walk {
    let geometry = place(shapes.into_iter().chain([floor()]));
    let mut walker = someone(&geometry, Vec3::new(0.0, 1.6, 2.0), yaw);
    let mut highest = 0.0_f64;
    for _ in 0..(seconds * 60.0) as u32 {
        go(&mut walker, &geometry, FORWARD, 1.0 / 60.0, 60.0);
        highest = highest.max(eye(&walker).y - PERSON);
    }
    Walk { highest, end: eye(&walker) - DVec3::Y * PERSON }
}

/// A surface that rises at an angle from the line z = 0 towards -z, up to a height, and is level behind.
fn ramp(degrees: f32, top: f32) -> Vec<Shape> {
    let z = -top / degrees.to_radians().tan();
    let line = |y: f32, z: f32| [Vec3::new(-9.0, y, z), Vec3::new(9.0, y, z)];
    let ([a, b], [d, c], [e, f]) = (line(0.0, 0.0), line(top, z), line(top, z - 20.0));
    quad([a, b, c, d]).into_iter().chain(quad([d, c, f, e])).collect()
}

/// The plane that rises so without end.
fn plane(degrees: f32) -> Vec<Shape> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    vec![Shape::Plane { point: Vec3::ZERO, normal: Vec3::new(0.0, cos, sin) }]
}

/// A cone on the floor, whose foot is at z = 0.
fn cone(degrees: f32) -> Vec<Shape> {
    let base = Vec3::new(0.0, 0.0, -2.0);
    vec![Shape::Cone {
        base,
        top: base + Vec3::Y * 2.0 * degrees.to_radians().tan(),
        radius_base: 2.0,
        radius_top: 0.0,
    }]
}

/// A ball on the floor, its middle at z = 0; as a mesh if `rings` is not 0.
fn ball(radius: f32, rings: u32) -> Vec<Shape> {
    let center = Vec3::Y * radius;
    let point = |i: u32, j: u32| {
        let (polar, angle) = (TAU / 2.0 * i as f32 / rings as f32, TAU * j as f32 / (2 * rings) as f32);
        center + radius * Vec3::new(polar.sin() * angle.cos(), -polar.cos(), polar.sin() * angle.sin())
    };
    if rings == 0 {
        return vec![Shape::Sphere { center, radius }];
    }
    let cells = (0..rings).flat_map(|i| (0..2 * rings).map(move |j| (i, j)));
    cells.flat_map(|(i, j)| quad([point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)])).collect()
}

#[test]
fn slopes_of_up_to_50_degrees_are_climbed_and_steeper_ones_are_walls() {
    for degrees in [30, 40, 45, 49, 50, 51, 52, 55, 60, 66, 70, 75, 80, 85, 88] {
        let angle = degrees as f32;
        for (name, shapes) in [("ramp", ramp(angle, 9.0)), ("plane", plane(angle)), ("cone", cone(angle))] {
            for yaw in [0.0, 20.0] {
                let Walk { highest, end } = walk(shapes.clone(), yaw, 3.0);
                if degrees <= 50 {
                    // Along 20 degrees one passes by the top of the cone.
                    let is_up = highest > 1.0 || (name == "cone" && yaw != 0.0);
                    assert!(is_up, "{name} of {degrees} degrees along {yaw}: {highest}");
                } else {
                    assert!(highest <= STEP, "{name} of {degrees} degrees along {yaw}: {highest}, at {end}");
                    assert!(name == "cone" || end.z > -0.4, "{name} of {degrees} degrees along {yaw}: {end}");
                }
            }
        }
    }
}

#[test]
fn along_a_steep_slope_one_slides() {
    for degrees in [55, 70, 88] {
        for shapes in [ramp(degrees as f32, 9.0), plane(degrees as f32)] {
            let Walk { end, .. } = walk(shapes, 45.0, 3.0);
            let expected = -7.5 / 2.0_f64.sqrt();
            assert!((end.x - expected).abs() < 0.3, "{degrees} degrees: {end}, not {expected}");
        }
    }
}

#[test]
fn steep_slopes_up_to_a_step_are_steps() {
    for degrees in [52, 60, 75, 88] {
        for (top, is_step) in [(0.1, true), (0.3, true), (0.39, true), (0.43, false), (0.5, false), (1.0, false)] {
            let Walk { highest, end } = walk(ramp(degrees as f32, top), 0.0, 3.0);
            if is_step {
                assert!((end.y - f64::from(top)).abs() < 0.01 && end.z < -4.0, "{top} m at {degrees} degrees: {end}");
            } else {
                assert!(highest <= STEP && end.z > -0.6, "{top} m at {degrees} degrees: {highest}, {end}");
            }
        }
    }
}

#[test]
fn small_balls_are_steps_and_others_are_walls() {
    for (radius, is_step) in
        [(0.1, true), (0.15, true), (0.2, true), (0.25, false), (0.3, false), (0.4, false), (0.5, false), (1.0, false)]
    {
        for rings in [0, 24] {
            for aside in [0.0, 0.5] {
                let shift = |shape: Shape| match shape {
                    Shape::Sphere { center, radius: r } => {
                        Shape::Sphere { center: center + Vec3::X * aside * radius, radius: r }
                    }
                    Shape::Triangle { vertices } => {
                        Shape::Triangle { vertices: vertices.map(|v| v + Vec3::X * aside * radius) }
                    }
                    other => other,
                };
                let Walk { highest, end } = walk(ball(radius, rings).into_iter().map(shift), 0.0, 2.5);
                let what = format!("a ball of {radius} m in {rings} rings, {aside} aside: {highest}, {end}");
                assert!(highest <= STEP, "{what}");
                if is_step {
                    assert!(end.z < -3.0 && highest > 1.5 * f64::from(radius), "{what}");
                } else if aside == 0.0 {
                    assert!(end.z > 0.0, "{what}");
                }
            }
        }
    }
}

#[test]
fn steps_are_in_proportion_to_the_eye_height() {
    for (eye_height, radius, is_step) in [(0.8, 0.1, true), (0.8, 0.15, false), (4.8, 0.5, true), (4.8, 0.8, false)] {
        let geometry = place(ball(radius, 0).into_iter().chain([floor()]));
        let mut walker = Walker::new(Camera::from_yaw_pitch(Vec3::new(0.0, 1.6, 4.0), 0.0, 0.0, 60.0), 12.0);
        assert!(walker.set_eye_height(&geometry, eye_height) && walker.toggle_walking(&geometry));
        walker.set_speed(2.5);
        go(&mut walker, &geometry, FORWARD, 4.0, 60.0);
        let passed = eye(&walker).z < -3.0;
        assert_eq!(passed, is_step, "a ball of {radius} m, eyes at {eye_height} m: {}", eye(&walker));
    }
}

#[test]
fn jumps_do_not_climb_what_is_steep() {
    for degrees in [55, 65, 80] {
        let geometry = place(plane(degrees as f32).into_iter().chain([floor()]));
        let mut walker = someone(&geometry, Vec3::new(0.0, 1.6, 2.0), 0.0);
        for _ in 0..20 {
            go(&mut walker, &geometry, Motion { forward: 1.0, ..JUMP }, 0.3, 60.0);
            go(&mut walker, &geometry, FORWARD, 0.3, 60.0);
        }
        go(&mut walker, &geometry, STAND, 1.5, 60.0);
        let height = eye(&walker).y - PERSON;
        assert!(height <= STEP, "{degrees} degrees: {height}");
        assert!(!walker.is_under_way(), "{degrees} degrees: it ends");
    }
}

#[test]
fn a_steep_slope_leads_down_and_not_up_again() {
    // From a platform of 5 m down a slope of 60 degrees.
    let geometry = place(ramp(60.0, 5.0).into_iter().chain([floor()]));
    let mut walker = someone(&geometry, Vec3::new(0.0, 6.6, -5.0), 180.0);
    go(&mut walker, &geometry, FORWARD, 1.5, 60.0);
    let half = eye(&walker);
    assert!((1.0..4.5).contains(&(half.y - PERSON)), "on the slope: {half}");
    walker.pose.yaw += 180.0;
    go(&mut walker, &geometry, FORWARD, 2.0, 60.0);
    assert!(eye(&walker).y <= half.y + STEP, "{} after {half}", eye(&walker));
    walker.pose.yaw += 180.0;
    go(&mut walker, &geometry, FORWARD, 4.0, 60.0);
    assert!((eye(&walker).y - PERSON).abs() < 0.01, "{}", eye(&walker));
}
