//! Wrong scene files: every one gives an error with its place and what would be right; none a panic.

use crate::corpus::PATIENCE;
use crate::temporary::{Folder, load_text};
use raywalk::scene::{LoadOptions, SceneError};
use std::path::Path;
use std::time::Instant;

/// A wrong scene, the place its error must name and words that must be in the message. The `§` in the text
/// marks where the error is and is removed before loading.
struct Wrong {
    text: &'static str,
    pointer: &'static str,
    says: &'static str,
}

const fn wrong(text: &'static str, pointer: &'static str, says: &'static str) -> Wrong {
    Wrong { text, pointer, says }
}

const WRONG: &[Wrong] = &[
    // The file as a whole.
    wrong("§", "", "not valid JSON"),
    wrong("{ \"version\": 1,\n  \"objects\": [1 §2] }", "", "not valid JSON: expected `,` or `]`"),
    wrong("{ \"version\": 1 } §x", "", "trailing characters"),
    wrong("§[]", "", "expected an object, found a list"),
    wrong("§{}", "", "missing key \"version\""),
    wrong("§{ \"versoin\": 1 }", "", "is it spelled \"versoin\"?"),
    wrong(r#"{ "version": §2 }"#, "/version", "expected 1"),
    wrong(r#"{ "version": §"1" }"#, "/version", "expected a number, found a string"),
    wrong("{ \"version\": 1,\n \"lights\": [],\n §\"lights\": [] }", "/lights", "stands twice"),
    wrong(r#"{ "version": 1, "objects": §{} }"#, "/objects", "expected a list, found an object"),
    wrong(r#"{ "version": 1, "objects": §null }"#, "/objects", "found null"),
    // The picture.
    wrong(r#"{ "version": 1, "render": { "environment": §"sunset" } }"#, "/render/environment", "expected \"studio\""),
    wrong(r#"{ "version": 1, "render": { "environment": §3 } }"#, "/render/environment", "expected an object"),
    wrong(r#"{ "version": 1, "render": { "environment": §{ "zenith": 1 } } }"#, "/render/environment", "a horizon"),
    wrong(
        r#"{ "version": 1, "render": { "environment": §{ "image": "a.hdr", "horizon": 1 } } }"#,
        "/render/environment",
        "either an image or the colours",
    ),
    wrong(
        r#"{ "version": 1, "render": { "environment": { "horizon": 1, "intensity": §-1 } } }"#,
        "/render/environment/intensity",
        "at least 0",
    ),
    wrong(
        r#"{ "version": 1, "render": { "environment": { "horizon": 1, "intensity": §1e39 } } }"#,
        "/render/environment/intensity",
        "too large",
    ),
    wrong(
        r#"{ "version": 1, "render": { "environment": { "horizon": §"blue" } } }"#,
        "/render/environment/horizon",
        "is not a colour",
    ),
    wrong(
        r#"{ "version": 1, "render": { "environment": { "horizon": 1, "backdrop": §1 } } }"#,
        "/render/environment/backdrop",
        "found a number",
    ),
    wrong(
        r#"{ "version": 1, "render": { "environment": { "image": §"nowhere.hdr" } } }"#,
        "/render/environment/image",
        "cannot read the environment \"nowhere.hdr\"",
    ),
    wrong(
        r#"{ "version": 1, "render": { "environment": { "image": §"/etc/hostname" } } }"#,
        "/render/environment/image",
        "leaves the scene's folder",
    ),
    wrong(
        r#"{ "version": 1, "render": { "environment": { "image": §"s.json", "rotation": 9 } } }"#,
        "/render/environment/image",
        "cannot decode the environment \"s.json\"",
    ),
    wrong(r#"{ "version": 1, "render": { "width": §0 } }"#, "/render/width", "whole number from 1 to"),
    wrong(r#"{ "version": 1, "render": { "height": §720.5 } }"#, "/render/height", "whole number"),
    wrong(r#"{ "version": 1, "render": { "height": §1e9 } }"#, "/render/height", "32768"),
    wrong(r#"{ "version": 1, "render": { "max_depth": §65 } }"#, "/render/max_depth", "from 1 to 64"),
    wrong(r#"{ "version": 1, "render": { "background": §[1, 2] } }"#, "/render/background", "expected 3 values"),
    wrong(r#"{ "version": 1, "render": { "ambient": [1, §-1, 1] } }"#, "/render/ambient/1", "at least 0"),
    wrong(r##"{ "version": 1, "render": { "background": §"#12345" } }"##, "/render/background", "#rrggbb"),
    // Cameras.
    wrong(r#"{ "version": 1, "camera": §{} }"#, "/camera", "missing key \"position\""),
    wrong(
        r#"{ "version": 1, "camera": { "position": [1, 2, 3], "look_at": §[1, 2, 3] } }"#,
        "/camera/look_at",
        "another point",
    ),
    wrong(
        r#"{ "version": 1, "camera": §{ "position": [0, 1, 0], "look_at": [0, 0, 0] } }"#,
        "/camera",
        "up is parallel",
    ),
    wrong(
        r#"{ "version": 1, "cameras": { "a/b": { "position": [0, 0, 1], "up": §[0, 0, 2] } } }"#,
        "/cameras/a~1b/up",
        "up is parallel",
    ),
    wrong(r#"{ "version": 1, "camera": { "position": [0, 0, 1], "fov": §180 } }"#, "/camera/fov", "between 0 and 180"),
    wrong(r#"{ "version": 1, "camera": { "position": [0, 0, 1], "fov": §0 } }"#, "/camera/fov", "between 0 and 180"),
    wrong(
        r#"{ "version": 1, "camera": { "position": [0, 0, 1], "near": 2, "far": §1 } }"#,
        "/camera/far",
        "greater than near",
    ),
    wrong(
        r#"{ "version": 1, "camera": { "position": [0, 0, 1], "yaw": 1, "look_at": §[0, 0, 0] } }"#,
        "/camera/look_at",
        "one of them",
    ),
    // Textures and materials.
    wrong(r#"{ "version": 1, "textures": { "t": §{} } }"#, "/textures/t", "either an image or a checker"),
    wrong(
        r#"{ "version": 1, "textures": { "t": { "image": §"no.png" } } }"#,
        "/textures/t/image",
        "cannot read image \"no.png\"",
    ),
    wrong(
        r#"{ "version": 1, "textures": { "t": { "checker": [0, 1], "size": §0 } } }"#,
        "/textures/t/size",
        "greater than 0",
    ),
    wrong(
        r#"{ "version": 1, "textures": { "floor": { "checker": [0, 1] } }, "materials": { "m": { "color": { "texture": §"flor" } } } }"#,
        "/materials/m/color/texture",
        "did you mean \"floor\"?",
    ),
    wrong(r#"{ "version": 1, "materials": { "m": { "ior": §0 } } }"#, "/materials/m/ior", "greater than 0"),
    wrong(r#"{ "version": 1, "materials": { "m": { "color": §true } } }"#, "/materials/m/color", "expected a colour"),
    wrong(
        r#"{ "version": 1, "materials": { "m": { "transparency": §1.5 } } }"#,
        "/materials/m/transparency",
        "from 0 to 1",
    ),
    wrong(r#"{ "version": 1, "materials": { "m": { "roughness": §2 } } }"#, "/materials/m/roughness", "from 0 to 1"),
    wrong(r#"{ "version": 1, "materials": { "m": { "fresnel": §1 } } }"#, "/materials/m/fresnel", "true or false"),
    // Lights.
    wrong(r#"{ "version": 1, "lights": [ { "type": §"sun" } ] }"#, "/lights/0/type", "point, directional, spot"),
    wrong(r#"{ "version": 1, "lights": [ §{ "type": "point" } ] }"#, "/lights/0", "missing key \"position\""),
    wrong(
        r#"{ "version": 1, "lights": [ { "type": "directional", "direction": §[0, 0, 0] } ] }"#,
        "/lights/0/direction",
        "length 0",
    ),
    wrong(
        r#"{ "version": 1, "lights": [ { "type": "spot", "position": [0, 0, 0], "direction": [0, 1, 0], "inner_angle": §40, "outer_angle": 30 } ] }"#,
        "/lights/0/inner_angle",
        "must not exceed",
    ),
    wrong(
        r#"{ "version": 1, "lights": [ { "type": "point", "position": [0, 0, 0], "temperature": §10 } ] }"#,
        "/lights/0/temperature",
        "from 1000 to 40000",
    ),
    wrong(
        r#"{ "version": 1, "lights": [ { "type": "point", "position": [0, 0, 0], "falloff": §"linear" } ] }"#,
        "/lights/0/falloff",
        "inverse_square",
    ),
    wrong(
        r#"{ "version": 1, "lights": [ { "type": "point", "position": [0, 0, 0], "intensity": §-1 } ] }"#,
        "/lights/0/intensity",
        "at least 0",
    ),
    // Objects.
    wrong(r#"{ "version": 1, "objects": [ §{} ] }"#, "/objects/0", "missing key \"type\""),
    wrong(r#"{ "version": 1, "objects": [ { "type": §"shpere" } ] }"#, "/objects/0/type", "did you mean \"sphere\"?"),
    wrong(
        r#"{ "version": 1, "objects": [ §{ "type": "sphere", "center": [0, 0, 0], "raduis": 1 } ] }"#,
        "/objects/0",
        "is it spelled \"raduis\"?",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "sphere", "center": [0, 0, 0], "radius": §0 } ] }"#,
        "/objects/0/radius",
        "greater than 0",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "sphere", "center": [0, 0, 0], "radius": §1e-60 } ] }"#,
        "/objects/0/radius",
        "greater than 0",
    ),
    wrong(
        "{ \"version\": 1,\n  \"objects\": [\n    { \"type\": \"sphere\", \"center\": [0, §1e39, 0], \"radius\": 1 } ] }",
        "/objects/0/center/1",
        "too large",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "sphere", "center": [0, §1e999, 0], "radius": 1 } ] }"#,
        "/objects/0/center/1",
        "number out of range",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "sphere", "center": [0, 0, 0], "radius": 1, "material": §"rde" } ], "materials": { "red": {} } }"#,
        "/objects/0/material",
        "did you mean \"red\"?",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "plane", "point": [0, 0, 0], "normal": §[0, 0, 0] } ] }"#,
        "/objects/0/normal",
        "length 0",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "cylinder", "base": [1, 1, 1], "top": §[1, 1, 1], "radius": 1 } ] }"#,
        "/objects/0/top",
        "equals base",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "cone", "base": [0, 0, 0], "top": [0, 1, 0], "radius": §0 } ] }"#,
        "/objects/0/radius",
        "both 0",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "box", "min": [0, 0, 0], "max": §[1, 0, 1] } ] }"#,
        "/objects/0/max",
        "greater than min",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "rectangle", "corner": [0, 0, 0], "edge_u": [1, 2, 3], "edge_v": §[2, 4, 6] } ] }"#,
        "/objects/0/edge_v",
        "parallel",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "triangle", "vertices": §[[0, 0, 0], [1, 0, 0]] } ] }"#,
        "/objects/0/vertices",
        "expected 3 values, found 2",
    ),
    wrong(
        "{ \"version\": 1, \"objects\": [ { \"type\": \"mesh\", \"vertices\": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],\n \"triangles\": [[0, 1, 2],\n [0, §3, 1]] } ] }",
        "/objects/0/triangles/1/1",
        "index 3 names none of the 3 vertices",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "mesh", "vertices": [[0, 0, 0]], "triangles": [[0, §-1, 0]] } ] }"#,
        "/objects/0/triangles/0/1",
        "index -1",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "mesh", "vertices": [[0, 0, 0], §[1, 0]], "triangles": [] } ] }"#,
        "/objects/0/vertices/1",
        "expected 3 numbers, found 2",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "mesh", "vertices": [[0, 0, 0]], "triangles": [], "normals": §[[0, 1, 0], [0, 1, 0]] } ] }"#,
        "/objects/0/normals",
        "expected one entry a vertex (1), found 2",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "mesh", "vertices": [[0, 0, 0]], "triangles": [], "normals": [§[0, 0, 0]] } ] }"#,
        "/objects/0/normals/0",
        "length 0",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "mesh", "vertices": [[0, 0, 0]], "triangles": [], "uvs": [[0, §"x"]] } ] }"#,
        "/objects/0/uvs/0/1",
        "expected a number, found a string",
    ),
    // Transforms.
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "group", "transform": §{ "scale": [1, 0, 1] } } ] }"#,
        "/objects/0/transform",
        "differ from 0",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "group", "transform": { "matrix": §[1, 0, 0] } } ] }"#,
        "/objects/0/transform/matrix",
        "expected 16 numbers",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "group", "transform": { "matrix": §[1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1] } } ] }"#,
        "/objects/0/transform/matrix",
        "last row",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "group", "transform": { "scale": [1, 2, 1] }, "children": [ §{ "type": "disk", "center": [0, 0, 0], "normal": [0, 1, 0], "radius": 1 } ] } ] }"#,
        "/objects/0/children/0",
        "disk cannot be scaled",
    ),
    wrong(
        r#"{ "version": 1, "objects": [ { "type": "group", "transform": { "scale": 1e30 }, "children": [ §{ "type": "sphere", "center": [1e30, 0, 0], "radius": 1 } ] } ] }"#,
        "/objects/0/children/0",
        "beyond 3.4e38",
    ),
];

#[test]
fn every_wrong_scene_is_refused_with_its_place_and_the_remedy() {
    assert!(WRONG.len() >= 40);
    for Wrong { text, pointer, says } in WRONG {
        let (before, after) = text.split_once('§').unwrap();
        let line = 1 + before.matches('\n').count();
        let column = 1 + before.rsplit('\n').next().unwrap().chars().count();
        let error = load_text(format!("{before}{after}")).expect_err(text);
        let SceneError::Invalid { place, message } = &error else { panic!("{text}: {error}") };
        assert_eq!(place.line_column, Some((line, column)), "{error}\n{text}");
        assert_eq!(place.pointer, *pointer, "{error}\n{text}");
        assert!(message.contains(says), "{error}\n{text}");
        assert!(!error.to_string().contains('\n'), "{error:?}");
    }
}

#[test]
fn text_that_is_not_utf8_says_where() {
    let error = load_text(b"{ \"version\": 1,\n \"\xFF\": 1 }").unwrap_err().to_string();
    assert!(error.contains("s.json:2:3: the text is not UTF-8"), "{error}");
}

#[test]
fn a_byte_order_mark_is_passed_over() {
    load_text("\u{FEFF}{ \"version\": 1 }").unwrap();
    let error = load_text("\u{FEFF}{ \"version\": 2 }").unwrap_err().to_string();
    assert!(error.contains("s.json:1:14 (/version)"), "{error}");
}

#[test]
fn unknown_keys_are_warned_of_and_strict_makes_that_an_error() {
    let text = "{ \"version\": 1,\n  \"comment\": 1, \"objects\": [\n  { \"type\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1, \"colour\": 1, \"nmae\": \"x\" } ] }";
    let scene = load_text(text).unwrap();
    let warnings: Vec<String> = scene.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].contains("s.json:3:57 (/objects/0/colour): unknown key \"colour\""), "{warnings:?}");
    assert!(warnings[1].contains("did you mean \"name\"?"), "{warnings:?}");
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    let error = Folder::new().load(text, &strict).unwrap_err().to_string();
    assert!(error.contains("unknown key") && error.contains("--strict"), "{error}");
}

#[test]
fn keys_without_effect_are_warned_of() {
    let text = r##"{ "version": 1, "materials": { "m": { "base_color": 1, "color": "#ff0000",
        "emission": { "texture": "t", "size": 2 } } }, "textures": { "t": { "checker": [0, 1] } },
        "objects": [ { "type": "group", "material": "m" }, { "type": "sphere", "center": [0, 0, 0], "radius": 1 } ] }"##;
    let pointers: Vec<String> = load_text(text).unwrap().warnings.into_iter().map(|w| w.place.pointer).collect();
    assert_eq!(pointers, ["/materials/m/color", "/materials/m/emission/size", "/objects/0/material"]);
}

#[test]
fn an_exceeded_limit_is_named_and_can_be_raised() {
    let deep = |levels: usize| {
        let (open, close) = (r#"{ "type": "group", "children": ["#.repeat(levels), "] }".repeat(levels));
        format!(r#"{{ "version": 1, "objects": [{open}{close}] }}"#)
    };
    load_text(deep(60)).unwrap();
    let error = load_text(deep(70)).unwrap_err().to_string();
    assert!(error.contains("limit nesting of 128"), "{error}");
    let mut raised = LoadOptions::default();
    raised.limits.set("nesting", "256").unwrap();
    Folder::new().load(deep(126), &raised).unwrap();
    assert!(Folder::new().load(deep(100_000), &raised).is_err());

    let spheres = |n: usize| {
        let sphere = r#"{ "type": "sphere", "center": [0, 0, 0], "radius": 1 }"#;
        format!(r#"{{ "version": 1, "objects": [{}] }}"#, vec![sphere; n].join(","))
    };
    for name in ["objects", "primitives"] {
        let mut lowered = LoadOptions::default();
        lowered.limits.set(name, "3").unwrap();
        Folder::new().load(spheres(3), &lowered).unwrap();
        let error = Folder::new().load(spheres(4), &lowered).unwrap_err().to_string();
        assert!(error.contains("(/objects/3)") && error.contains(&format!("--limit {name}=N")), "{error}");
    }
    let mut lowered = LoadOptions::default();
    lowered.limits.set("lights", "3").unwrap();
    let lights = |n: usize| {
        let light = r#"{ "type": "point", "position": [0, 0, 0] }"#;
        format!(r#"{{ "version": 1, "lights": [{}] }}"#, vec![light; n].join(","))
    };
    Folder::new().load(lights(3), &lowered).unwrap();
    let error = Folder::new().load(lights(4), &lowered).unwrap_err().to_string();
    assert!(error.contains("--limit lights=N"), "{error}");
    let mut lowered = LoadOptions::default();
    lowered.limits.set("file-bytes", "10").unwrap();
    let error = Folder::new().load(spheres(1), &lowered).unwrap_err().to_string();
    assert!(error.contains("file-bytes"), "{error}");
}

#[test]
fn a_flood_of_warnings_stays_short_and_quick() {
    let keys: Vec<String> = (0..50_000).map(|i| format!("\"k{i}\": 0")).collect();
    let start = Instant::now();
    let scene = load_text(format!("{{ \"version\": 1, {} }}", keys.join(","))).unwrap();
    // As many keys as are told one by one, how many more there are, and that there is no object.
    assert_eq!(scene.warnings.len(), 102);
    assert!(start.elapsed() < PATIENCE);
}

#[test]
fn malformed_json_of_the_test_suite_is_refused() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/bad/json");
    let Ok(files) = std::fs::read_dir(folder) else { return };
    for file in files {
        let path = file.unwrap().path();
        let error = raywalk::scene::load(&path, &LoadOptions::default()).expect_err(&path.display().to_string());
        let SceneError::Invalid { place, .. } = error else { panic!("{error}") };
        assert!(place.line_column.is_some(), "{}", path.display());
    }
}
