//! The sphereflake of Eric Haines's Standard Procedural Databases ("A Proposal for Standard Graphics
//! Environments", IEEE Computer Graphics and Applications 7(11), 1987): on every sphere sit nine of a third its size.

use glam::{DMat3, DVec3};
use std::fmt::Write;

/// Generations after the first sphere: 1 + 9 + 81 + 729 + 6561 = 7,381 spheres.
pub const GENERATIONS: u32 = 4;

/// The scene file, one sphere a line; (9^(`generations` + 1) - 1) / 8 of them.
pub fn scene(generations: u32) -> String {
    let mut text = String::from(HEAD);
    let mut spheres = Vec::new();
    grow(&mut spheres, &children(), DVec3::ZERO, 0.5, DVec3::Z, generations);
    for (center, radius) in spheres {
        let [x, y, z] = center.to_array().map(short);
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            ",\n{{\"type\":\"sphere\",\"center\":[{x},{y},{z}],\"radius\":{},\"material\":\"flake\"}}",
            short(radius)
        );
    }
    text.push_str("\n  ]\n}\n");
    text
}

/// Scene B of the comparisons: everything but the spheres.
const HEAD: &str = r#"{
  "version": 1,
  "comment": "The sphereflake of Eric Haines's Standard Procedural Databases: 7,381 mirroring spheres under three lights. Written by examples/make_scenes.",
  "render": { "width": 1280, "height": 720, "max_depth": 5, "background": [0.078, 0.361, 0.753] },
  "camera": { "position": [2.1, 1.3, 1.7], "look_at": [0, 0, 0], "up": [0, 0, 1], "fov": 45 },
  "cameras": {
    "close": { "comment": "in among the third generation", "position": [0.95, 0.5, 0.75], "look_at": [0.2, 0.1, 0.35], "up": [0, 0, 1], "fov": 50 }
  },
  "materials": {
    "ground": { "color": [1, 0.75, 0.33], "ambient": 0, "diffuse": 1, "specular": 0 },
    "flake":  { "color": [1, 0.9, 0.7], "ambient": 0, "diffuse": 0.5, "specular": 0.5, "shininess": 45.2776, "reflectivity": 0.5 }
  },
  "lights": [
    { "type": "point", "position": [4, 3, 2], "color": [0.4, 0.4, 0.4] },
    { "type": "point", "position": [1, -4, 4], "color": [0.4, 0.4, 0.4] },
    { "type": "point", "position": [-3, 1, 5], "color": [0.4, 0.4, 0.4] }
  ],
  "objects": [
    { "type": "rectangle", "name": "ground", "corner": [-12, -12, -0.5], "edge_u": [24, 0, 0], "edge_v": [0, 24, 0], "material": "ground" }"#;

/// Seven decimals without trailing zeros: under a hundred-thousandth of the smallest radius.
fn short(x: f64) -> String {
    let text = format!("{x:.7}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A sphere, then the nine on it and all of theirs; `up` is the direction in which it sits on its parent.
fn grow(
    spheres: &mut Vec<(DVec3, f64)>,
    children: &[DVec3; 9],
    center: DVec3,
    radius: f64,
    up: DVec3,
    generations: u32,
) {
    spheres.push((center, radius));
    if generations == 0 {
        return;
    }
    let turn = turn_z_to(up);
    for &child in children {
        let direction = turn * child;
        let distance = radius * (1.0 + 1.0 / 3.0);
        grow(spheres, children, center + direction * distance, radius / 3.0, direction, generations - 1);
    }
}

/// Directions of the nine children of a sphere that sits along +Z: six around its equator, three above.
fn children() -> [DVec3; 9] {
    let d = libm::sqrt(0.5);
    let trio = [DVec3::new(d, d, 0.0), DVec3::new(d, 0.0, -d), DVec3::new(0.0, d, -d)];
    let tilt = turn_about(DVec3::new(1.0, -1.0, 0.0), libm::asin(2.0 / libm::sqrt(6.0)));
    std::array::from_fn(|i| turn_about(DVec3::Z, (i / 3) as f64 * std::f64::consts::TAU / 3.0) * (tilt * trio[i % 3]))
}

/// The shortest turn that takes +Z to the unit vector `to`.
fn turn_z_to(to: DVec3) -> DMat3 {
    // Along Z the axis of the turn would be rounding noise.
    if to.truncate().length() < 1e-9 {
        if to.z > 0.0 { DMat3::IDENTITY } else { turn_about(DVec3::Y, std::f64::consts::PI) }
    } else {
        turn_about(DVec3::new(-to.y, to.x, 0.0), libm::acos(to.z))
    }
}

/// Rodrigues' rotation by `angle` radians about `axis`.
fn turn_about(axis: DVec3, angle: f64) -> DMat3 {
    let axis = axis.normalize();
    let (s, c) = (libm::sin(angle), libm::cos(angle));
    let column = |e: DVec3| e * c + axis.cross(e) * s + axis * (axis.dot(e) * (1.0 - c));
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}
