//! Lights, cameras and exposure: what the first picture shows.

use super::file::{CORNERS, File, triangle, warnings};
use crate::temporary::Folder;
use glam::Vec3;
use raywalk::render::{Film, Planes, Scratch, render_frame};
use raywalk::scene::light::{Falloff, LightKind};
use raywalk::scene::{Environment, EnvironmentChoice, LoadOptions, Scene, Sky, load};
use raywalk::settings::{Exposure, Settings, ToneMap};
use std::path::Path;

/// A white wall of two triangles in the plane z = 0, 10 wide and high, with the given keys besides.
fn wall(material: &str, rest: &str) -> Scene {
    let mut file = File::default();
    let positions = file.vectors(&[[-5.0, -5.0, 0.0], [5.0, -5.0, 0.0], [5.0, 5.0, 0.0], [-5.0, 5.0, 0.0]]);
    let indices = file.indices(&[0, 1, 2, 0, 2, 3]);
    file.load(&format!(
        r#""meshes": [{{ "primitives": [{{ "material": 0, "indices": {indices}, "attributes": {{ "POSITION": {positions} }} }}] }}],
        "materials": [{material}], {rest}"#
    ))
}

/// The middle of the first picture.
fn middle(scene: &Scene) -> [u8; 3] {
    let mut film = Film::new(9, 9, Planes::default());
    render_frame(scene, &scene.cameras[0].camera, &Settings::exact(), &mut Scratch::new(), &mut film);
    let [r, g, b, _] = *film.rgba()[4 * 40..].first_chunk().expect("81 pixels");
    [r, g, b]
}

const MATTE: &str = r#"{ "pbrMetallicRoughness": { "metallicFactor": 0 } }"#;

#[test]
fn lights_stand_at_their_nodes() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let scene = triangle(&format!(
        r#""materials": [{{}}], "extensions": {{ "KHR_lights_punctual": {{ "lights": [
            {{ "type": "point", "intensity": 4, "color": [1, 0.5, 0.25], "name": "lamp" }},
            {{ "type": "directional" }},
            {{ "type": "spot", "spot": {{ "innerConeAngle": 0, "outerConeAngle": 1.0471975512 }} }}] }} }},
        "nodes": [{{ "translation": [1, 2, 3], "extensions": {{ "KHR_lights_punctual": {{ "light": 0 }} }} }},
            {{ "rotation": [-{half}, 0, 0, {half}], "extensions": {{ "KHR_lights_punctual": {{ "light": 1 }} }} }},
            {{ "name": "beam", "extensions": {{ "KHR_lights_punctual": {{ "light": 2 }} }} }}]"#
    ));
    let [lamp, sun, beam] = &scene.lights[..] else { panic!("three lights") };
    assert_eq!((lamp.name.as_deref(), lamp.color), (Some("lamp"), Vec3::new(4.0, 2.0, 1.0)));
    assert_eq!(
        (lamp.kind, lamp.falloff),
        (LightKind::Point { position: Vec3::new(1.0, 2.0, 3.0) }, Falloff::InverseSquare)
    );
    let LightKind::Directional { direction } = sun.kind else { panic!("{sun:?}") };
    assert!(direction.abs_diff_eq(Vec3::NEG_Y, 1e-6), "{direction}");
    let LightKind::Spot { direction, cos_inner, cos_outer, .. } = beam.kind else { panic!("{beam:?}") };
    assert_eq!((direction, cos_inner, beam.name.as_deref()), (Vec3::NEG_Z, 1.0, Some("beam")));
    assert!((cos_outer - 0.5).abs() < 1e-6);
    assert!(!scene.headlight);
}

#[test]
fn cameras_stand_at_their_nodes() {
    let scene = triangle(
        r#""materials": [{}], "cameras": [{ "name": "eye", "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } },
            { "type": "orthographic", "orthographic": { "xmag": 2, "ymag": 2, "znear": 0, "zfar": 10 } }],
        "nodes": [{ "mesh": 0 }, { "camera": 0, "translation": [0, 0, 5] }, { "camera": 1, "translation": [0.5, 0.5, 2] },
            { "camera": 0, "scale": [0, 0, 0] }]"#,
    );
    let [eye, flat] = &scene.cameras[..] else { panic!("two cameras: {:?}", scene.cameras) };
    assert_eq!((eye.name.as_str(), eye.camera.eye), ("eye", Vec3::new(0.0, 0.0, 5.0)));
    assert!((eye.camera.fov - 57.29578).abs() < 1e-4 && eye.camera.frame(4, 4).forward == Vec3::NEG_Z);
    // What it shows of the middle of the scene is as large: 2 up and down at a distance of 2.
    assert!((flat.camera.fov - 90.0).abs() < 1e-3, "{}", flat.camera.fov);
    assert!(warnings(&scene).iter().any(|warning| warning.contains("orthographic")));
    assert!(warnings(&scene).iter().any(|warning| warning.contains("sees nothing")));
}

#[test]
fn lights_of_any_strength_give_the_same_picture() {
    let lit = |intensity: f64, kind: &str| {
        middle(&wall(
            MATTE,
            &format!(
                r#""extensions": {{ "KHR_lights_punctual": {{ "lights": [{{ "type": "{kind}", "intensity": {intensity} }}] }} }},
                "nodes": [{{ "mesh": 0 }}, {{ "translation": [0, 0, 5], "extensions": {{ "KHR_lights_punctual": {{ "light": 0 }} }} }}]"#
            ),
        ))
    };
    for kind in ["point", "directional"] {
        let usual = lit(100.0, kind);
        assert!((100..250).contains(&usual[0]), "{kind}: {usual:?}");
        for intensity in [0.01, 1.0, 100_000.0] {
            let other = lit(intensity, kind);
            assert!(
                other.iter().zip(usual).all(|(a, b)| a.abs_diff(b) <= 1),
                "{kind} {intensity}: {other:?} {usual:?}"
            );
        }
    }
}

#[test]
fn what_takes_no_light_and_what_glows_are_seen_under_any_light() {
    for intensity in [1, 100_000] {
        let rest = format!(
            r#""extensions": {{ "KHR_lights_punctual": {{ "lights": [{{ "type": "directional", "intensity": {intensity} }}] }} }},
            "nodes": [{{ "mesh": 0 }}, {{ "extensions": {{ "KHR_lights_punctual": {{ "light": 0 }} }} }}]"#
        );
        let unlit = r#"{ "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.2, 0.2, 1] }, "extensions": { "KHR_materials_unlit": {} } }"#;
        assert_eq!(middle(&wall(unlit, &rest)), [188, 124, 124], "{intensity}");
        let glowing = r#"{ "emissiveFactor": [1, 1, 1], "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 1] } }"#;
        let glow = middle(&wall(glowing, &rest));
        assert!(glow[0] > 220, "{intensity}: {glow:?}");
    }
}

#[test]
fn what_takes_no_light_is_seen_as_it_is_under_any_exposure() {
    let sun = r#""extensions": { "KHR_lights_punctual": { "lights": [{ "type": "directional", "intensity": 100000 }] } },
        "nodes": [{ "mesh": 0 }, { "extensions": { "KHR_lights_punctual": { "light": 0 } } }]"#;
    let unlit = r#"{ "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.2, 0.2, 1] }, "extensions": { "KHR_materials_unlit": {} } }"#;
    let glowing = r#"{ "emissiveFactor": [0.25, 0.25, 0.25], "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 1], "metallicFactor": 1 } }"#;
    let (unlit, glowing) = (wall(unlit, sun), wall(glowing, sun));
    // Kept from one frame to the next: what was made for one exposure must not be shown under another.
    let mut scratch = Scratch::new();
    let mut exposed = |scene: &Scene, exposure| {
        let mut film = Film::new(9, 9, Planes::default());
        let settings = Settings { exposure, tone_map: Some(ToneMap::None), ..Settings::exact() };
        render_frame(scene, &scene.cameras[0].camera, &settings, &mut scratch, &mut film);
        (film.rgba()[4 * 40], film.color(4, 4)[0])
    };
    for stops in [0.0, 3.0, -7.5] {
        let (seen, light) = exposed(&unlit, Exposure::Stops(stops));
        assert_eq!(seen, 188, "{stops}");
        assert!((light * stops.exp2() - 0.5).abs() < 1e-6, "{stops}: {light}");
    }
    assert_eq!(exposed(&unlit, Exposure::Auto), exposed(&unlit, Exposure::Scene));
    assert_eq!(exposed(&unlit, Exposure::Auto).0, 188);
    // What glows gives the light that the file says, or more where that would not be seen.
    for (stops, expected) in [(0.0, 137), (-7.5, 137), (1.0, 188)] {
        assert_eq!(exposed(&glowing, Exposure::Stops(stops)).0, expected, "{stops}");
    }
    assert_eq!(exposed(&glowing, Exposure::Auto).0, 137);
}

#[test]
fn the_index_of_refraction_says_what_opaque_surfaces_reflect() {
    let sun = r#""extensions": { "KHR_lights_punctual": { "lights": [{ "type": "directional", "intensity": 3 }] } },
        "nodes": [{ "mesh": 0 }, { "extensions": { "KHR_lights_punctual": { "light": 0 } } }]"#;
    let light = |ior: &str| {
        let black = r#""pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0, "roughnessFactor": 0.5 }"#;
        let scene = wall(&format!("{{ {black} {ior} }}"), sun);
        let mut film = Film::new(9, 9, Planes::default());
        render_frame(&scene, &scene.cameras[0].camera, &Settings::exact(), &mut Scratch::new(), &mut film);
        film.color(4, 4)[0]
    };
    let of = |ior: &str| light(&format!(r#", "extensions": {{ "KHR_materials_ior": {{ "ior": {ior} }} }}"#));
    let usual = light("");
    assert!(usual > 0.0 && of("1.5").to_bits() == usual.to_bits());
    for (ior, f0) in [("1", 0.0), ("2.5", (1.5_f32 / 3.5).powi(2)), ("0", 1.0)] {
        let ratio = of(ior) / usual;
        assert!((ratio - f0 / 0.04).abs() < 1e-3 * (1.0 + ratio), "{ior}: {ratio}");
    }
}

#[test]
fn a_file_without_light_or_camera_is_seen_all_the_same() {
    let scene = wall(MATTE, r#""nodes": [{ "mesh": 0 }]"#);
    assert!(scene.headlight && scene.cameras.len() == 1);
    let seen = middle(&scene);
    assert!((120..250).contains(&seen[0]), "{seen:?}");
    // The same for every frame, and only where it is asked for.
    assert_eq!(scene.stops(Exposure::Scene), scene.auto_exposure);
    assert_eq!(scene.stops(Exposure::Stops(1.5)), 1.5);
}

#[test]
fn vertex_colours_reach_the_picture() {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let view = file.view(&[255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255], "");
    let colors = file.accessor(format!(
        r#"{{ "bufferView": {view}, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4" }}"#
    ));
    let scene = file.load(&format!(
        r#""meshes": [{{ "primitives": [{{ "material": 0, "attributes": {{ "POSITION": {positions}, "COLOR_0": {colors} }} }}] }}],
        "materials": [{MATTE}], "nodes": [{{ "mesh": 0 }}]"#
    ));
    let mut film = Film::new(33, 33, Planes::default());
    render_frame(&scene, &scene.cameras[0].camera, &Settings::exact(), &mut Scratch::new(), &mut film);
    let seen: Vec<_> = film.rgba().chunks_exact(4).filter(|p| p[0] > 0).collect();
    assert!(seen.len() > 50 && seen.iter().all(|p| p[0] > 100 && p[1] < 40 && p[1] == p[2]), "{:?}", seen.first());
}

#[test]
fn a_file_that_says_nothing_of_light_is_lit_by_a_studio_and_a_key_light() {
    let folder = Folder::new();
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let text = |rest: &str| {
        file.text(&format!(
            r#""meshes": [{{ "primitives": [{{ "material": 0, "attributes": {{ "POSITION": {positions} }} }}] }}],
            "materials": [{MATTE}], {rest}"#
        ))
    };
    let alone = folder.write("alone.gltf", text(r#""nodes": [{ "mesh": 0 }]"#));
    let sun = r#""extensions": { "KHR_lights_punctual": { "lights": [{ "type": "directional", "intensity": 10 }] } },
        "nodes": [{ "mesh": 0 }, { "extensions": { "KHR_lights_punctual": { "light": 0 } } }]"#;
    let lit = folder.write("lit.gltf", text(sun));
    let load_as = |path: &Path, environment| {
        load(path, &LoadOptions { environment, ..LoadOptions::default() }).unwrap_or_else(|error| panic!("{error}"))
    };
    let intensity = |scene: &Scene| match &scene.environment {
        Some(Environment { sky: Sky::Studio, intensity, .. }) => *intensity,
        other => panic!("{other:?}"),
    };
    let [alone, lit_too] = [&alone, &lit].map(|path| load_as(path, EnvironmentChoice::Scene));
    assert!(!alone.headlight && alone.lights.len() == 1 && alone.render.ambient == Vec3::ZERO);
    assert!(intensity(&alone) > 0.1);
    // Beside lights it fills shadows with a tenth of what they give, as ambient light did.
    assert!(lit_too.lights.len() == 1 && intensity(&lit_too) > 0.1 && lit_too.render.ambient == Vec3::ZERO);
    // Nothing that is seen is black, behind things neither.
    for scene in [&alone, &lit_too] {
        let mut film = Film::new(33, 33, Planes::default());
        render_frame(scene, &scene.cameras[0].camera, &Settings::exact(), &mut Scratch::new(), &mut film);
        let dark = film.rgba().chunks_exact(4).filter(|pixel| pixel[..3].iter().all(|channel| *channel < 5)).count();
        assert_eq!(dark, 0);
    }
    let bare = load_as(&lit, EnvironmentChoice::None);
    assert!(bare.environment.is_none() && bare.render.ambient != Vec3::ZERO);
}
