//! `full` against a tracer in double precision that is given the same numbers, rounded to f32.
//!
//! In the middle of surfaces, where nothing within two pixels takes another path, primary rays and their lights must
//! agree everywhere. Elsewhere the two may see another side of an edge, and glass and mirrors make differences larger:
//! how many pixels that concerns is a column of the rates.

use super::rates::is_still;
use super::scenes::{self, Stress};
use crate::picture_bits::render;
use crate::tracer::{Seen, Tracer};
use glam::{DVec2, Vec3};
use raywalk::render::Film;
use raywalk::scene::Camera;
use raywalk::settings::{Settings, Visibility};

/// How far colours may be apart, in parts of the larger of 1 and the colour, and distances in parts of the distance.
const TOLERANCE: f64 = 1e-3;
/// How far away, in pixels, another path excuses a difference of primary rays.
const AWAY: i32 = 2;

/// Where single precision does not suffice even there: the scene, per cent of its pixels away from edges that differ over
/// all cameras, and why.
const BEYOND: [(&str, f64, &str); 2] = [
    ("coincident", 0.11, "of faces in the same place, rounding decides which is in front"),
    ("far_spheres", 3.3, "from 10,000 radii on, directions in single precision are coarser than pixels"),
];

/// Looking at many things in double precision takes its time.
fn size(stress: &Stress) -> (u32, u32) {
    if stress.scene.geometry.len() > 1000 { (32, 18) } else { (80, 45) }
}

fn full(depth: Option<u32>) -> Settings {
    Settings { visibility: Visibility::Full, depth, ..Settings::exact() }
}

/// Whether a pixel shows what the double-precision tracer sees there.
fn agrees(film: &Film, x: u32, y: u32, expected: &Seen) -> bool {
    let (color, depth) = (Vec3::from(film.color(x, y)).as_dvec3(), f64::from(film.depth(x, y).unwrap()));
    let off = (color - expected.color).abs() / expected.color.abs().max(glam::DVec3::ONE);
    let same_depth = depth == expected.depth || (depth - expected.depth).abs() <= TOLERANCE * expected.depth;
    same_depth && off.max_element() <= TOLERANCE
}

/// The share of pixels, in per cent, that differ from the double-precision tracer over a scene's own cameras, paths as
/// long as the scene has them.
pub fn differing(stress: &Stress) -> f64 {
    let (size, settings) = (size(stress), full(None));
    let mut differing = 0;
    for &camera in stress.own_cameras() {
        let film = render(&stress.scene, &camera, &settings, size);
        let tracer = Tracer::new(&stress.scene, camera, &settings);
        let pixels = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
        differing += pixels.filter(|&(x, y)| !agrees(&film, x, y, &tracer.look(center(x, y), size))).count();
    }
    100.0 * differing as f64 / (size.0 as usize * size.1 as usize * stress.own_cameras().len()) as f64
}

fn center(x: impl Into<f64>, y: impl Into<f64>) -> DVec2 {
    DVec2::new(x.into() + 0.5, y.into() + 0.5)
}

/// How many pixels of primary rays lie away from any edge, and which of these differ.
fn away_from_edges(stress: &Stress, camera: Camera) -> (usize, Vec<String>) {
    let (size, settings) = (size(stress), full(Some(1)));
    let film = render(&stress.scene, &camera, &settings, size);
    let tracer = Tracer::new(&stress.scene, camera, &settings);
    let (width, height) = (size.0 as i32, size.1 as i32);
    let across = width + 2 * AWAY;
    let seen: Vec<Seen> = (-AWAY..height + AWAY)
        .flat_map(|y| (-AWAY..width + AWAY).map(move |x| center(x, y)))
        .map(|at| tracer.look(at, size))
        .collect();
    let at = |x: i32, y: i32| &seen[((y + AWAY) * across + x + AWAY) as usize];
    let (mut away, mut wrong) = (0, Vec::new());
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let expected = at(x, y);
        let around = (-AWAY..=AWAY).flat_map(|j| (-AWAY..=AWAY).map(move |i| (x + i, y + j)));
        if around.map(|(x, y)| at(x, y).path).any(|path| path != expected.path) {
            continue;
        }
        away += 1;
        if !agrees(&film, x as u32, y as u32, expected) {
            let (color, depth) = (film.color(x as u32, y as u32), film.depth(x as u32, y as u32).unwrap());
            wrong.push(format!("({x}, {y}): {color:?} at {depth}, not {} at {}", expected.color, expected.depth));
        }
    }
    (away, wrong)
}

#[test]
fn primary_rays_agree_with_double_precision_away_from_edges() {
    let (mut compared, mut problems) = (0, Vec::new());
    for stress in scenes::all() {
        let (mut away, mut wrong) = (0, Vec::new());
        for &camera in &stress.cameras {
            let (pixels, differing) = away_from_edges(&stress, camera);
            away += pixels;
            wrong.extend(differing);
        }
        compared += away;
        let measured = 100.0 * wrong.len() as f64 / away as f64;
        let fine = match BEYOND.iter().find(|(name, ..)| *name == stress.name) {
            Some(&(_, expected, _)) => is_still(expected, measured),
            None => wrong.is_empty(),
        };
        if !fine {
            let first = wrong.first().map_or("none", String::as_str);
            problems.push(format!("{}: {measured:.2} % of {away} pixels differ, first {first}", stress.name));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
    assert!(compared > 100_000, "only {compared} pixels lie away from edges: is the comparison still one?");
}
