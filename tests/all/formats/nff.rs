//! NFF scenes: what their entities become, and how mistakes are told.

use crate::temporary::Folder;
use glam::Vec3;
use raywalk::scene::light::{Falloff, LightKind};
use raywalk::scene::material::Model;
use raywalk::scene::{LoadOptions, Scene, SceneError, load};

fn load_nff(text: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
    load(&Folder::new().write("s.nff", text), &LoadOptions::default())
}

#[test]
fn every_entity_becomes_what_it_says() {
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    let scene = load(&Folder::new().write("s.nff", include_str!("every_entity.nff")), &strict).unwrap();
    assert_eq!(scene.format, "NFF");
    assert_eq!(scene.render.background, Vec3::new(0.1, 0.2, 0.3));
    assert_eq!((scene.render.width, scene.render.height), (Some(320), Some(240)));
    let [view] = &scene.cameras[..] else { panic!("one view") };
    let camera = view.camera;
    assert_eq!((camera.eye, camera.look_at), (Vec3::new(0.0, -5.0, 2.0), Vec3::new(0.0, 0.0, 0.5)));
    assert_eq!((camera.up, camera.fov, camera.near), (Vec3::Z, 40.0, 0.0));

    let kinds: Vec<&str> = scene.objects.iter().map(|object| object.kind).collect();
    assert_eq!(kinds, ["sphere", "cone", "cylinder", "polygon", "polygon", "patch"]);
    assert!(scene.objects.iter().all(|object| object.body == (object.kind == "sphere")));
    // Equal fills are one material.
    let materials: Vec<u32> = scene.objects.iter().map(|object| object.material).collect();
    assert_eq!(materials, [0, 1, 1, 0, 0, 0]);
    // A square, a concave polygon of six corners, a triangle.
    assert_eq!(scene.geometry.len(), 3 + 2 + 4 + 1);

    let [red, glass] = &scene.materials[..] else { panic!("two fills") };
    let Model::Phong { ambient, diffuse, specular, shininess } = red.model else { panic!("Phong's model") };
    assert_eq!((ambient, diffuse, specular, shininess), (Vec3::ZERO, Vec3::splat(0.8), Vec3::splat(0.2), 30.0));
    assert_eq!((red.color.factor, red.reflectivity), (Vec3::new(1.0, 0.5, 0.25), Vec3::splat(0.2)));
    assert!(!red.fresnel && !red.is_transparent());
    assert_eq!((glass.transparency, glass.ior, glass.fresnel), (Vec3::splat(0.5), 1.5, true));
}

#[test]
fn lights_without_a_colour_share_the_brightness() {
    let light = |text: &str| -> Vec<Vec3> { load_nff(text).unwrap().lights.iter().map(|l| l.color).collect() };
    assert_eq!(light("l 0 0 1"), [Vec3::ONE]);
    assert_eq!(light("\u{feff}l 0 0 1"), [Vec3::ONE], "after the mark of the byte order");
    let four = light("l 0 0 1\nl 0 0 2 0.5 1 0\nl 0 0 3 # 1 1 1\nl 0 0 4");
    assert_eq!(four, [Vec3::splat(0.5), Vec3::new(0.5, 1.0, 0.0), Vec3::splat(0.5), Vec3::splat(0.5)]);
    let scene = load_nff("l 1 2 3").unwrap();
    assert_eq!(scene.lights[0].kind, LightKind::Point { position: Vec3::new(1.0, 2.0, 3.0) });
    assert_eq!(scene.lights[0].falloff, Falloff::None);
}

/// A scene that leaves no object, the `§` where its first fault is, and words of its message.
const WRONG: &[(&str, &str)] = &[
    ("§sphere 0 0 0 1", "unknown entity \"sphere\""),
    ("l 0 0 1\n §1,5 2 3", "unknown entity \"1,5\""),
    ("s 0 0 §x 1", "expected a number (center), found \"x\""),
    ("s 0 0 0§", "the file ends before radius"),
    ("s 0 0 0 §0", "the radius is 0"),
    ("s 0 0 0 §1e39", "too large"),
    ("s 0 §nan 0 1", "expected a number"),
    ("s 0 0 0\n§l 0 0 1", "expected a number (radius), found \"l\""),
    ("# l\nf 1 §-1 1 1 0 1 0 0", "at least 0"),
    ("b 1 1 §-0.5", "at least 0"),
    ("§v from 0 0 1 at 0 0 0 angle 45", "the view lacks \"up\""),
    ("§v from 0 0 1 at 0 0 1 up 0 1 0 angle 45", "no view"),
    ("§v from 0 0 1 at 0 0 0 up 0 1 0 angle 180", "no view"),
    ("v from 0 0 1 at 0 0 0 up 0 1 0 angle 45 resolution 512 §0", "whole number from 1 to 32768"),
    ("v from 0 0 1 at 0 0 0 up 0 1 0 angle 45 resolution §1e9 1", "whole number from 1 to 32768"),
    ("c 0 0 0 §1 0 0 1 -1", "the same sign"),
    ("c 0 0 0 §0 0 0 1 0", "both radii are 0"),
    ("§c 0 0 0 1 0 0 0 0.5", "different points"),
    ("§p 2 0 0 0 1 0 0", "whole number of at least 3"),
    ("§p 3.5 0 0 0 1 0 0 0 1 0", "whole number of at least 3"),
    ("p 1e18 0 0 0 1 0 0 0 1 0§", "the file ends before corner"),
    ("pp 3 0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0§", "the file ends before normal"),
];

#[test]
fn every_wrong_scene_is_refused_with_its_place() {
    for (text, says) in WRONG {
        let (before, after) = text.split_once('§').unwrap();
        let line = 1 + before.matches('\n').count();
        let column = 1 + before.rsplit('\n').next().unwrap().chars().count();
        let error = load_nff(format!("{before}{after}")).expect_err(text);
        let SceneError::Invalid { place, message } = &error else { panic!("{text}: {error}") };
        assert!(message.contains(says), "{error}\n{text}");
        assert_eq!(place.line_column, Some((line, column)), "{error}\n{text}");
    }
}

#[test]
fn damaged_entities_cost_themselves_alone() {
    let text = "v from 0 0 9 at 0 0 0 up 0 1 0 angle 45 resolution 512 0\nsphere 1 2 3\nl nan 0 0\nf 1 1 x 1 0 1 0 1\n\
                s 0 0 0\ns 1 0 0 1\np 3 0 0 0\n 1 0 0\n 0 inf 0\np 3 0 0 0\n 1 0 0\n 0 1 0\nend s\ns 2 0 0 1";
    let scene = load_nff(text).unwrap();
    let kinds: Vec<&str> = scene.objects.iter().map(|object| object.kind).collect();
    assert_eq!(kinds, ["sphere", "polygon", "sphere"]);
    assert_eq!((scene.cameras.len(), scene.render.width, scene.lights.len()), (1, None, 0));
    let warnings: Vec<String> = scene.warnings.iter().map(ToString::to_string).collect();
    let expected = [
        "s.nff:1:56: 0 is out of range; expected a whole number from 1 to 32768; the resolution is left out",
        "s.nff:2:1: unknown entity \"sphere\"",
        "s.nff:3:3: expected a number (light position), found \"nan\"; the entity l is left out",
        "s.nff:4:7: expected a number (fill colour), found \"x\"; the entity f is left out",
        "s.nff:6:1: expected a number (radius), found \"s\"; the entity s is left out",
        "s.nff:9:4: expected a number (corner), found \"inf\"; the entity p is left out",
        "s.nff:13:1: unknown entity \"end\"",
    ];
    assert_eq!(warnings.len(), expected.len(), "{warnings:#?}");
    for (warning, expected) in warnings.iter().zip(expected) {
        assert!(warning.contains(expected), "{warning}");
    }
}

#[test]
fn oddities_are_warned_of_and_drawn() {
    let text = b"# \xFF\xFE in a comment\nf 1 1 1 1 2 1 1 0\ns 0 0 0 -1\nc 0 0 0 -1 0 0 1 -2\n\
                 pp 3 0 0 0 0 0 1 1 0 0 0 0 0 0 1 0 0 0 1\np 3 0 0 0 1 1 1 2 2 2";
    let scene = load_nff(text).unwrap();
    let warnings: Vec<String> = scene.warnings.iter().map(ToString::to_string).collect();
    let expected = [
        "s.nff:2:1: Ks is 2",
        "s.nff:2:1: index of refraction 0 is taken as 1",
        "s.nff:3:1: a radius below 0 asks for the inside only; both sides are drawn (2 times, the first here)",
        "s.nff:5:1: a normal of length 0",
        "s.nff:6:1: triangles without area: 1 left out",
    ];
    assert_eq!(warnings.len(), expected.len(), "{warnings:#?}");
    for (warning, expected) in warnings.iter().zip(expected) {
        assert!(warning.contains(expected), "{warning}");
    }
    assert_eq!(scene.objects.len(), 4);
    assert_eq!(scene.materials[0].reflectivity, Vec3::ONE);
}
