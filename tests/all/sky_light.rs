//! The light of skies: against ambient light, against sums over directions, against itself in other forms.

use crate::picture_bits::{PictureBits, render};
use raywalk::scene::environment::{Gradient, SkyImage};
use raywalk::scene::{Environment, LoadOptions, Scene, Sky, load_text};
use raywalk::settings::{Settings, Visibility};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const SIZE: (u32, u32) = (96, 64);

/// Balls of the given materials in a row, seen from far away along -Z, with a light that gives nothing.
fn balls(materials: &[&str], render: &str) -> Scene {
    let named = materials.iter().enumerate().map(|(i, material)| format!(r#""m{i}": {material}"#));
    let ball = |i: usize| {
        let x = 2.2 * (i as f64 - (materials.len() - 1) as f64 / 2.0);
        format!(r#"{{ "type": "sphere", "center": [{x}, 0, 0], "radius": 1, "material": "m{i}" }}"#)
    };
    let text = format!(
        r#"{{ "version": 1, "render": {{ {render} }},
              "camera": {{ "position": [0, 0, 40], "look_at": [0, 0, 0], "fov": 8 }},
              "lights": [{{ "type": "point", "position": [0, 9, 0], "intensity": 0 }}],
              "materials": {{ {} }}, "objects": [{}] }}"#,
        named.collect::<Vec<_>>().join(", "),
        (0..materials.len()).map(ball).collect::<Vec<_>>().join(", ")
    );
    load_text("balls.json", &text, &LoadOptions::default()).expect("the balls are a valid scene")
}

const MATTE: &str = r#"{ "ambient": 0.7, "diffuse": 0.7, "specular": 0, "color": [1, 0.6, 0.2] }"#;

fn metal(roughness: f64) -> String {
    format!(r#"{{ "base_color": 1, "metallic": 1, "roughness": {roughness}, "ambient": 0 }}"#)
}

fn dielectric(roughness: f64) -> String {
    format!(r#"{{ "base_color": 1, "metallic": 0, "roughness": {roughness}, "ambient": 0 }}"#)
}

/// A picture of a sky: its radiance by direction.
fn picture(width: u32, radiance: impl Fn([f64; 3]) -> [f64; 3]) -> Sky {
    let height = width / 2;
    let mut texels = Vec::new();
    for row in 0..height {
        let elevation = PI * (0.5 - (f64::from(row) + 0.5) / f64::from(height));
        for column in 0..width {
            let angle = TAU * ((f64::from(column) + 0.5) / f64::from(width) - 0.5);
            let direction = [elevation.cos() * angle.sin(), elevation.sin(), -elevation.cos() * angle.cos()];
            texels.push(radiance(direction).map(|value| value as f32));
        }
    }
    Sky::Image(Arc::new(SkyImage::new("test.hdr", (width, height), texels.into()).expect("as many as the size says")))
}

fn constant(radiance: f32) -> Sky {
    let all = glam::Vec3::splat(radiance);
    Sky::Gradient(Gradient { zenith: all, horizon: all, ground: all })
}

fn colors(scene: &Scene) -> Vec<[f32; 3]> {
    let film = render(scene, &scene.cameras[0].camera, &Settings::exact(), SIZE);
    (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))).map(|(x, y)| film.color(x, y)).collect()
}

fn greatest_difference(a: &Scene, b: &Scene) -> f32 {
    let pairs = colors(a).into_iter().zip(colors(b));
    pairs
        .flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1], a[2] - b[2]])
        .fold(0.0, |most, difference| most.max(difference.abs()))
}

#[test]
fn a_constant_sky_is_a_background_with_ambient_light() {
    let mirror = r#"{ "ambient": 0, "diffuse": 0, "specular": 0, "reflectivity": 0.5 }"#;
    for radiance in [0.2_f32, 0.8] {
        let flat = balls(&[MATTE, mirror], &format!(r#""background": {radiance}, "ambient": {radiance}"#));
        for sky in [constant(radiance), picture(64, |_| [f64::from(radiance); 3])] {
            let lit = balls(&[MATTE, mirror], r#""ambient": 0"#).with_environment(Some(Environment::new(sky)));
            let difference = greatest_difference(&lit, &flat);
            assert!(difference < 1.0 / 255.0, "{radiance}: off by {difference}");
        }
    }
}

#[test]
fn a_file_without_ambient_light_has_none_beside_a_sky() {
    let sky = r#""environment": { "horizon": 0.5 }"#;
    let without = balls(&[MATTE], sky);
    let with = balls(&[MATTE], &format!(r#"{sky}, "ambient": 0"#));
    assert_eq!(greatest_difference(&without, &with), 0.0);
}

#[test]
fn a_gradient_is_what_its_picture_is() {
    let [zenith, horizon, ground] = [[0.1, 0.3, 0.9], [0.8, 0.7, 0.6], [0.3, 0.1, 0.05]];
    let gradient = |[_, y, _]: [f64; 3]| {
        let end = if y > 0.0 { zenith } else { ground };
        std::array::from_fn(|i| horizon[i] + (end[i] - horizon[i]) * y.abs())
    };
    let materials: Vec<String> =
        [0.05, 0.15, 0.3, 0.6, 1.0].into_iter().flat_map(|r| [metal(r), dielectric(r)]).collect();
    for pair in materials.chunks(2) {
        let scene = balls(&[&pair[0], &pair[1], MATTE], r#""ambient": 0"#);
        let [zenith, horizon, ground] = [zenith, horizon, ground].map(|c| glam::DVec3::from(c).as_vec3());
        let sky = Sky::Gradient(Gradient { zenith, horizon, ground });
        let in_closed_form = scene.with_environment(Some(Environment::new(sky)));
        let of_picture = scene.with_environment(Some(Environment::new(picture(512, gradient))));
        let difference = greatest_difference(&in_closed_form, &of_picture);
        assert!(difference < 0.02, "{}: off by {difference}", pair[0]);
    }
}

/// The light of a half-white sky on a white matte ball, by a sum over directions.
#[test]
fn a_white_ball_under_half_a_sky_is_as_a_sum_over_directions_has_it() {
    let white = r#"{ "ambient": 0, "diffuse": 1, "specular": 0 }"#;
    let side = |x: f64| if x > 0.0 { 1.0 } else { 0.0 };
    let scene = balls(&[white], r#""ambient": 0"#);
    let lit = scene.with_environment(Some(Environment::new(picture(256, |[x, ..]| [side(x); 3]))));
    let film = render(&lit, &lit.cameras[0].camera, &Settings::exact(), SIZE);
    let mut checked = 0;
    for (x, y) in [(48, 32), (57, 32), (52, 32), (44, 32), (39, 32), (48, 41), (53, 37)] {
        if film.depth(x, y).expect("the film keeps depths").is_infinite() {
            continue;
        }
        let normal = film.normal(x, y).expect("the film keeps normals").map(f64::from);
        let (mut sum, mut weights) = (0.0, 0.0);
        for row in 0..200 {
            let up = 1.0 - (2.0 * f64::from(row) + 1.0) / 200.0;
            for column in 0..200 {
                let angle = TAU * (f64::from(column) + 0.5) / 200.0;
                let direction = [(1.0 - up * up).sqrt() * angle.cos(), up, (1.0 - up * up).sqrt() * angle.sin()];
                let cosine: f64 = direction.iter().zip(normal).map(|(d, n)| d * n).sum();
                sum += side(direction[0]) * cosine.max(0.0);
                weights += cosine.max(0.0);
            }
        }
        let difference = f64::from(film.color(x, y)[0]) - sum / weights;
        assert!(difference.abs() < 0.01, "({x}, {y}): off by {difference}");
        checked += 1;
    }
    assert!(checked >= 5, "{checked} points are no test");
}

#[test]
fn white_things_in_a_white_furnace_are_white_at_any_roughness() {
    for step in 2..=20 {
        let roughness = f64::from(step) / 20.0;
        let scene = balls(&[&metal(roughness), &dielectric(roughness)], r#""ambient": 0"#);
        for sky in [constant(1.0), picture(64, |_| [1.0; 3])] {
            let lit = scene.with_environment(Some(Environment::new(sky)));
            let worst = colors(&lit).into_iter().flatten().map(|value| (value - 1.0).abs()).fold(0.0, f32::max);
            assert!(worst < 0.02, "roughness {roughness}: off by {worst}");
        }
    }
}

#[test]
fn skies_are_turned_to_the_left_and_scaled_and_hidden_behind_things() {
    let mirror = r#"{ "ambient": 0, "diffuse": 0, "specular": 0, "reflectivity": 1 }"#;
    // Bright ahead, which is along -Z.
    let sky = picture(256, |[_, _, z]| [(-z).max(0.0); 3]);
    let scene = balls(&[mirror], r#""ambient": 0, "background": [0, 0, 1]"#);
    let of = |environment: Environment| {
        let lit = scene.with_environment(Some(environment));
        let film = render(&lit, &lit.cameras[0].camera, &Settings::exact(), SIZE);
        (film.color(0, 0), film)
    };
    let ((ahead, _), (turned, film)) =
        (of(Environment::new(sky.clone())), of(Environment { rotation: 90.0, ..Environment::new(sky.clone()) }));
    assert!(ahead[0] > 0.95 && turned[0] < 0.2, "{ahead:?} {turned:?}");
    // Turned to the left, the mirror ball shows it on its left.
    let row: Vec<f32> = (0..SIZE.0).map(|x| film.color(x, 32)[0]).collect();
    let brightest = (0..row.len()).max_by(|a, b| row[*a].total_cmp(&row[*b])).expect("a row of pixels");
    assert!(brightest < 48, "column {brightest}");
    let (twice, _) = of(Environment { intensity: 2.0, ..Environment::new(sky.clone()) });
    assert!((twice[0] - 2.0 * ahead[0]).abs() < 1e-5);
    let (hidden, _) = of(Environment { backdrop: false, ..Environment::new(sky) });
    assert_eq!(hidden, [0.0, 0.0, 1.0]);
}

/// Skies are functions of rays and hits alone.
#[test]
fn the_same_bits_whatever_finds_the_hits() {
    let glass = r#"{ "transparency": 1, "ior": 1.5, "ambient": 0, "diffuse": 0, "specular": 0 }"#;
    let (smooth, rough) = (metal(0.02), dielectric(0.4));
    let scene = balls(&[&smooth, &rough, MATTE, glass], "");
    let studio = Environment { rotation: 20.0, ..Environment::new(Sky::Studio) };
    let image = Environment::new(picture(64, |[x, y, z]| [x.abs(), 0.5 + 0.5 * y, z.abs()]));
    for environment in [studio, image] {
        let lit = scene.with_environment(Some(environment));
        let bits = |settings: &Settings| PictureBits::of(&render(&lit, &lit.cameras[0].camera, settings, SIZE));
        let judge = bits(&Settings { visibility: Visibility::Full, bvh: false, ..Settings::exact() });
        for settings in [Settings::exact(), Settings { threads: 1, ..Settings::exact() }] {
            assert_eq!(judge.difference(&bits(&settings)), None);
        }
        assert_eq!(judge.not_a_number(), 0);
    }
}
