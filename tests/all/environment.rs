//! What surrounds a scene: by its file in JSON and XML, by the command line, and as it is told of.

use crate::cli::{Bench, text};
use crate::temporary::Folder;
use glam::Vec3;
use raywalk::scene::environment::{Gradient, SkyImage};
use raywalk::scene::{Environment, EnvironmentChoice, Limits, LoadOptions, Scene, SceneError, Sky, load};
use std::path::Path;
use std::sync::Arc;

/// A Radiance picture of one colour, uncompressed.
pub(super) fn hdr(width: u32, height: u32, pixel: [u8; 4]) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    bytes.extend(pixel.repeat((width * height) as usize));
    bytes
}

/// 1, 0.5 and 0.
const ORANGE: [u8; 4] = [128, 64, 0, 129];

fn json(environment: &str) -> String {
    format!(r#"{{ "version": 1, "render": {{ "environment": {environment} }} }}"#)
}

/// A folder with `sky.hdr`, and how it loads a scene of this environment in either syntax.
fn either(json_value: &str, xml_render: &str, options: &LoadOptions) -> [Result<Scene, SceneError>; 2] {
    let folder = Folder::new();
    folder.write("sky.hdr", hdr(4, 2, ORANGE));
    let xml = folder.write("s.xml", format!(r#"<scene version="1">{xml_render}</scene>"#));
    [folder.load(json(json_value), options), load(&xml, options)]
}

fn orange() -> Sky {
    Sky::Image(Arc::new(SkyImage::new("sky.hdr", (4, 2), vec![[1.0, 0.5, 0.0]; 8].into()).unwrap()))
}

#[test]
fn both_syntaxes_give_the_same_environment() {
    let gradient = |zenith, horizon, ground| Sky::Gradient(Gradient { zenith, horizon, ground });
    let level = Vec3::new(0.5, 0.25, 1.0);
    let cases = [
        (r#""studio""#, r#"<render environment="studio"/>"#, Environment::new(Sky::Studio)),
        (
            r#"{ "zenith": [0.1, 0.2, 0.4], "horizon": [0.5, 0.25, 1], "ground": 0.125, "intensity": 3 }"#,
            r#"<render><environment zenith="0.1 0.2 0.4" horizon="0.5 0.25 1" ground="0.125" intensity="3"/></render>"#,
            Environment {
                intensity: 3.0,
                ..Environment::new(gradient(Vec3::new(0.1, 0.2, 0.4), level, Vec3::splat(0.125)))
            },
        ),
        (
            r##"{ "horizon": [0.5, 0.25, 1], "ground": "#ffffff", "backdrop": false }"##,
            r##"<render><environment horizon="0.5 0.25 1" ground="#ffffff" backdrop="false"/></render>"##,
            Environment { backdrop: false, ..Environment::new(gradient(level, level, Vec3::ONE)) },
        ),
        (
            r#"{ "image": "sky.hdr", "rotation": -270.5, "intensity": 0, "backdrop": true, "comment": "flat" }"#,
            r#"<render><environment image="sky.hdr" rotation="-270.5" intensity="0" backdrop="true"/></render>"#,
            Environment { rotation: -270.5, intensity: 0.0, ..Environment::new(orange()) },
        ),
    ];
    for (json, xml, wanted) in cases {
        for scene in either(json, xml, &LoadOptions::default()) {
            let scene = scene.unwrap();
            assert_eq!(scene.environment.as_ref(), Some(&wanted), "{json}");
            assert!(scene.warnings.iter().all(|warning| warning.message.contains("no object")), "{:?}", scene.warnings);
        }
    }
    let [json, xml] = either("\"studio\"", "<render/>", &LoadOptions::default()).map(Result::unwrap);
    assert!(json.environment.is_some() && xml.environment.is_none());
}

#[test]
fn keys_without_meaning_are_warned_of() {
    let json = r#"{ "horizon": 1, "rotation": 30, "colour": 2 }"#;
    let xml = r#"<render><environment horizon="1" rotation="30" colour="2"/></render>"#;
    for scene in either(json, xml, &LoadOptions::default()) {
        let warnings: Vec<String> = scene.unwrap().warnings.iter().map(ToString::to_string).collect();
        assert!(warnings[0].contains("unknown key \"rotation\"") && warnings[1].contains("colour"), "{warnings:?}");
    }
}

#[test]
fn what_the_load_asks_for_replaces_the_scenes_own() {
    let folder = Folder::new();
    let other = folder.write("other/night.HDR", hdr(2, 1, [1, 2, 4, 130]));
    let chosen = |environment| LoadOptions { environment, ..LoadOptions::default() };
    // The file's own is broken, and not looked at.
    let text = json(r#"{ "image": "missing.hdr" }"#);
    let of = |choice| folder.load(&text, &chosen(choice)).unwrap().environment;
    assert_eq!(of(EnvironmentChoice::None), None);
    assert_eq!(of(EnvironmentChoice::Studio).map(|environment| environment.sky), Some(Sky::Studio));
    let Some(Environment { sky: Sky::Image(image), rotation, intensity, backdrop }) =
        of(EnvironmentChoice::File(other))
    else {
        panic!("no image")
    };
    assert_eq!((image.name.as_str(), image.width, image.height), ("night.HDR", 2, 1));
    assert_eq!((rotation, intensity, backdrop), (0.0, 1.0, true));
    assert!(folder.load(&text, &LoadOptions::default()).is_err());
    let missing = folder.load(&text, &chosen(EnvironmentChoice::File("no/such.hdr".into()))).unwrap_err();
    assert!(missing.to_string().starts_with("no/such.hdr: cannot read the environment: "), "{missing}");
    let is_folder = chosen(EnvironmentChoice::File(folder.path().to_owned()));
    assert!(folder.load(&text, &is_folder).unwrap_err().to_string().contains("not a regular file"));
    // Also around scenes that have no files, and those of models.
    let sky = folder.write("sky.hdr", hdr(4, 2, ORANGE));
    let builtin = raywalk::scene::builtin(&chosen(EnvironmentChoice::File(sky))).unwrap();
    assert_eq!(builtin.environment, Some(Environment::new(orange())));
    let model = r#"{ "version": 1, "objects": [ { "type": "model", "file": "s.json" } ] }"#;
    folder.load(json("\"studio\""), &LoadOptions::default()).unwrap();
    let outer = load(&folder.write("outer.json", model), &LoadOptions::default()).unwrap();
    assert_eq!(outer.environment, None, "a model's own does not count");
}

#[test]
fn odd_values_and_limits_are_told_with_their_place() {
    let folder = Folder::new();
    let size = (2, 1);
    exr::prelude::write_rgb_file(folder.path().join("odd.exr"), size.0, size.1, |x, _| match x {
        0 => (f32::NAN, -1.0_f32, 2.0_f32),
        _ => (f32::INFINITY, 0.5, 0.25),
    })
    .unwrap();
    let text = json("{\n \"image\": \"odd.exr\" }");
    let scene = folder.load(&text, &LoadOptions::default()).unwrap();
    let Some(Environment { sky: Sky::Image(image), .. }) = &scene.environment else { panic!("no image") };
    assert_eq!(image.texels[..], [[0.0, 0.0, 2.0], [2.0, 0.5, 0.25]]);
    let warning = scene.warnings[0].to_string();
    assert!(warning.contains("s.json:2:11 (/render/environment/image)") && warning.contains("1 negative"), "{warning}");
    assert!(scene.warnings[1].message.contains("no object"), "one warning");
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    assert!(folder.load(&text, &strict).unwrap_err().to_string().contains("--strict"));
    let chosen = EnvironmentChoice::File(folder.path().join("odd.exr"));
    let scene =
        folder.load(json("\"studio\""), &LoadOptions { environment: chosen, ..LoadOptions::default() }).unwrap();
    assert!(scene.warnings[0].place.file.ends_with("odd.exr"), "{:?}", scene.warnings);

    folder.write("sky.hdr", hdr(40, 20, ORANGE));
    let limited = |change: fn(&mut Limits)| {
        let mut options = LoadOptions::default();
        change(&mut options.limits);
        folder.load(json(r#"{ "image": "sky.hdr" }"#), &options).unwrap_err().to_string()
    };
    for (change, name) in [
        ((|limits| limits.texture_edge = 39) as fn(&mut Limits), "texture-edge"),
        (|limits| limits.texture_bytes = 40 * 20 * 12 - 1, "texture-bytes"),
        (|limits| limits.file_bytes = 1000, "file-bytes"),
    ] {
        let said = limited(change);
        assert!(said.contains("(/render/environment/image)") && said.contains(&format!("--limit {name}=N")), "{said}");
    }
}

#[test]
fn wide_pictures_are_reduced_and_told_of() {
    let bench = Bench::new();
    bench.write("wide.hdr", hdr(8192, 2, ORANGE));
    bench.write("scene.json", json(r#"{ "image": "wide.hdr", "rotation": 30, "intensity": 2, "backdrop": false }"#));
    let text = bench.done("info scene.json");
    let wanted = "environment image wide.hdr 4096x1 (reduced from 8192x2), rotation 30, intensity 2, not seen behind the scene\n";
    assert!(text.contains(wanted), "{text}");
    assert_eq!(bench.json("info scene.json --json")["environment"], wanted["environment ".len()..].trim_end());
    bench.write("gradient.json", json(r#"{ "horizon": 1 }"#));
    assert!(bench.done("info gradient.json").contains("environment gradient\n"));
}

#[test]
fn the_command_line_chooses_the_environment() {
    let bench = Bench::new();
    bench.write("scene.json", crate::cli::SCENE);
    bench.write("my.hdr", hdr(4, 2, ORANGE));
    assert!(!bench.done("info scene.json").contains("environment"));
    assert!(bench.json("info scene.json --json").get("environment").is_none());
    let told = |line: &str| bench.json(&format!("info --json {line}"))["environment"].clone();
    assert!(told("scene.json --environment studio").as_str().is_some_and(|name| name.starts_with("studio")));
    assert_eq!(told("scene.json --environment my.hdr"), "image my.hdr 4x2");
    assert_eq!(told("--environment my.hdr"), "image my.hdr 4x2", "around the built-in scene");
    let stats = bench.json("render scene.json --environment my.hdr --size 8x8 --stats -");
    assert_eq!(stats["settings"]["environment"], "image my.hdr 4x2");
    bench.done("render scene.json --environment none -o none.png");
    bench.done("render scene.json -o plain.png");
    assert_eq!(bench.read("none.png"), bench.read("plain.png"), "the scene has none");
    let flags = bench.json("tune scene.json --size 32x18 --environment none --max-error flip=0.5 --json");
    assert!(flags["flags"].to_string().contains("--environment none"), "{flags}");

    let said = bench.refused(1, "render scene.json --environment no.hdr");
    assert!(said.starts_with("error: no.hdr: cannot read the environment: "), "{said}");
    bench.write("text.hdr", "no picture at all");
    for command in ["render", "info", "tune --max-error flip=1", "bench --quick -o out"] {
        let said = bench.refused(1, &format!("{command} scene.json --environment text.hdr"));
        assert!(said.contains("text.hdr: cannot decode the environment: it is neither a Radiance"), "{said}");
    }
    let window = bench.run("scene.json --environment no.hdr");
    assert_eq!((window.status.code(), text(&window.stderr).lines().count()), (Some(1), 1));
    assert!(bench.done("render --help").contains("--environment <FILE|studio|none>"));
    assert!(!Path::new("no.hdr").exists());
}
