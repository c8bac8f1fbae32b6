//! Models: scene files within scenes.

use super::picture;
use crate::corpus::PATIENCE;
use crate::temporary::Folder;
use glam::Vec3;
use raywalk::geometry::Aabb;
use raywalk::scene::light::LightKind;
use raywalk::scene::{LoadOptions, Scene, SceneError, load};
use std::time::Instant;

/// A ball in NFF, of radius 1 around the origin.
const BALL: &str = "b 1 0 0\nf 0 1 0 1 0 1 0 0\ns 0 0 0 1\nl 0 0 5";

fn strict() -> LoadOptions {
    LoadOptions { strict: true, ..LoadOptions::default() }
}

fn with_objects(objects: &str) -> String {
    format!(r#"{{ "version": 1, "objects": [{objects}] }}"#)
}

#[test]
fn a_model_brings_its_objects_materials_and_lights_to_where_it_is_placed() {
    let folder = Folder::new();
    folder.write("models/ball.nff", BALL);
    let scene = folder.load(
        r#"{ "version": 1, "materials": { "f 1": { "color": [1, 0, 0] } }, "objects": [
            { "type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "f 1" },
            { "type": "group", "transform": { "translate": [10, 0, 0] }, "children": [
                { "type": "model", "file": "models/ball.nff", "name": "ball", "transform": { "scale": 2 } } ] },
            { "type": "model", "file": "models/../models/ball.nff" } ] }"#,
        &strict(),
    );
    let scene = scene.unwrap();
    let colors: Vec<Vec3> =
        scene.objects.iter().map(|object| scene.materials[object.material as usize].color.factor).collect();
    assert_eq!(colors, [Vec3::X, Vec3::Y, Vec3::Y]);
    assert_eq!(scene.materials.len(), 2, "the model's material is there once");
    assert_eq!(scene.objects[1].bounds, Aabb { min: Vec3::new(8.0, -2.0, -2.0), max: Vec3::new(12.0, 2.0, 2.0) });
    let positions: Vec<_> = scene.lights.iter().map(|light| light.kind).collect();
    let expected = [Vec3::new(10.0, 0.0, 10.0), Vec3::new(0.0, 0.0, 5.0)];
    assert_eq!(positions, expected.map(|position| LightKind::Point { position }));
    assert_eq!(scene.render.background, Vec3::ZERO, "what a model asks of the picture is left out");
    assert!(!scene.headlight);
}

#[test]
fn models_hold_models_relative_to_their_own_file() {
    let folder = Folder::new();
    folder.write("a/b/ball.nff", BALL);
    folder.write("wall.json", with_objects(r#"{ "type": "box", "min": [0, 0, 0], "max": [1, 1, 1] }"#));
    folder.write(
        "a/room.xml",
        "<scene version=\"1\"><camera position=\"0 0 9\"/><objects><model file=\"b/ball.nff\"/><model file=\"../wall.json\"/></objects></scene>",
    );
    let scene = folder.load(with_objects(r#"{ "type": "model", "file": "a/room.xml" }"#), &strict()).unwrap();
    let kinds: Vec<&str> = scene.objects.iter().map(|object| object.kind).collect();
    assert_eq!(kinds, ["sphere", "box"]);
    assert_eq!(scene.cameras.len(), 1);
    assert_ne!(scene.cameras[0].camera.eye, Vec3::new(0.0, 0.0, 9.0), "a model's cameras are left out");
    assert!(picture(&scene, 32, 18).iter().any(|pixel| *pixel != [0; 3]));
}

#[test]
fn a_model_that_is_placed_often_is_read_once() {
    let folder = Folder::new();
    folder.write("ball.nff", BALL);
    let ball = r#"{ "type": "model", "file": "ball.nff" }"#;
    let text = with_objects(&[ball; 100].join(","));
    let mut options = strict();
    options.limits.set("file-bytes", &(text.len() + BALL.len()).to_string()).unwrap();
    let scene = folder.load(text, &options).unwrap();
    assert_eq!((scene.objects.len(), scene.lights.len(), scene.materials.len()), (100, 100, 1));
}

#[test]
fn images_are_relative_to_the_model() {
    let folder = Folder::new();
    let image = image::RgbImage::from_pixel(2, 2, image::Rgb([255, 0, 0]));
    image.save(folder.write("models/red.png", "")).unwrap();
    let model = r#"{ "version": 1, "textures": { "t": { "image": "red.png" } } }"#;
    folder.write("models/m.json", model);
    let scene = folder.load(with_objects(r#"{ "type": "model", "file": "models/m.json" }"#), &LoadOptions::default());
    assert_eq!(scene.unwrap().textures.len(), 1);
}

/// The error of a scene `s.json` that holds a model `m` of some kind.
fn error_of(model: &str, contents: &str, object: &str) -> String {
    let folder = Folder::new();
    folder.write(model, contents);
    let error = folder.load(with_objects(&format!("\n {object}")), &LoadOptions::default()).unwrap_err();
    let SceneError::Invalid { place, .. } = &error else { panic!("{error}") };
    assert_eq!(place.file.file_name().unwrap(), "s.json");
    assert!(!error.to_string().contains('\n'), "{error:?}");
    error.to_string()
}

#[test]
fn mistakes_are_told_with_both_places() {
    let nff = r#"{ "type": "model", "file": "m/m.nff" }"#;
    let error = error_of("m/m.nff", "l 0 0 1\ns 0 0 0 0", nff);
    assert!(error.contains("s.json:2:29 (/objects/0/file): in this model: "), "{error}");
    assert!(error.contains("m/m.nff:2:9: the radius is 0") || cfg!(not(unix)), "{error}");
    let error = error_of(
        "m.json",
        r#"{ "version": 1, "objects": [ { "type": "model", "file": "n.nff" } ] }"#,
        &nff.replace("m/m.nff", "m.json"),
    );
    assert!(
        error.contains("in this model: ") && error.contains("m.json:1:57 (/objects/0/file): cannot read"),
        "{error}"
    );
    // What does not fit where it is placed the second time is told in the model's file, too.
    let twice = r#"{ "type": "model", "file": "m.nff" }, { "type": "model", "file": "m.nff", "transform": { "scale": [1, 2, 1] } }"#;
    let error = error_of("m.nff", "\ns 0 0 0 1", twice);
    assert!(error.contains("(/objects/1/file)") && error.contains("m.nff:2:1: a sphere cannot be scaled"), "{error}");
}

#[test]
fn what_is_no_model_says_why() {
    let error = |name: &str| error_of("m.txt", "", &format!(r#"{{ "type": "model", "file": "{name}" }}"#));
    assert!(error("m.txt").contains("unknown scene format; known: .json"), "{}", error("m.txt"));
    assert!(error("none.nff").contains("cannot read the model \"none.nff\""));
    assert!(error("../m.txt").contains("cannot read the model"));
    assert!(error("/etc/hostname").contains("leaves the scene's folder"));
    assert!(error(".").contains("unknown scene format") || error(".").contains("not a regular file"));
    assert!(error("").contains("cannot read the model") || error("").contains("not a regular file"));
    let folder = Folder::new();
    folder.write("out.nff", BALL);
    let inner = folder.write("inner/s.json", with_objects(r#"{ "type": "model", "file": "../out.nff" }"#));
    let refused = load(&inner, &LoadOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("leaves the scene's folder"), "{refused}");
}

#[test]
fn models_that_hold_themselves_are_refused() {
    let holds = |file: &str| with_objects(&format!(r#"{{ "type": "model", "file": "{file}" }}"#));
    let folder = Folder::new();
    let itself = folder.load(holds("./s.json"), &LoadOptions::default()).unwrap_err().to_string();
    assert!(itself.contains("the model \"./s.json\" holds itself"), "{itself}");
    folder.write("a.json", holds("b.json"));
    folder.write("b.json", holds("a.json"));
    let around = folder.load(holds("a.json"), &LoadOptions::default()).unwrap_err().to_string();
    assert!(around.contains("the model \"a.json\" holds itself"), "{around}");
}

/// A chain of files, each with `copies` models of the next one; the last holds `last`.
fn chain(folder: &Folder, files: usize, copies: usize, last: &str) -> Result<Scene, SceneError> {
    for i in 1..=files {
        let next = format!(r#"{{ "type": "model", "file": "m{}.json" }}"#, i + 1);
        folder.write(&format!("m{i}.json"), with_objects(&vec![next; copies].join(",")));
    }
    folder.write(&format!("m{}.json", files + 1), with_objects(last));
    folder.load(with_objects(r#"{ "type": "model", "file": "m1.json" }"#), &LoadOptions::default())
}

#[test]
fn depth_and_number_of_models_are_limited() {
    let start = Instant::now();
    let ball = r#"{ "type": "sphere", "center": [0, 0, 0], "radius": 1 }"#;
    assert_eq!(chain(&Folder::new(), 127, 1, ball).unwrap().objects.len(), 1);
    let deep = chain(&Folder::new(), 128, 1, ball).unwrap_err().to_string();
    assert!(deep.contains("limit nesting of 128"), "{deep}");
    let doubled = chain(&Folder::new(), 40, 2, "").unwrap_err().to_string();
    assert!(doubled.contains("limit nodes of 1000000"), "{doubled}");
    let many = chain(&Folder::new(), 6, 10, ball).unwrap_err().to_string();
    assert!(many.contains("limit"), "{many}");
    assert!(start.elapsed() < PATIENCE, "{:?}", start.elapsed());
}

#[test]
fn a_scene_without_an_object_is_its_background_and_a_warning() {
    let text = r#"{ "version": 1, "render": { "background": [1, 0, 0] } }"#;
    let scene = Folder::new().load(text, &LoadOptions::default()).unwrap();
    let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
    assert!(warning.message.contains("no object"), "{warning}");
    assert!(picture(&scene, 8, 8).iter().all(|pixel| *pixel == [255, 0, 0]));
}
