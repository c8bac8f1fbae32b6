//! Damaged files of every format: each gives a scene that can be drawn, or an error; none ends the program.
//!
//! A normal run tries some hundred mutations of each seed, the same ones on every machine; `RAYWALK_FUZZ=SECONDS` goes
//! on for so long with fresh ones.

use super::picture;
use crate::corpus::PATIENCE;
use crate::gltf::broken::rich;
use crate::random::Random;
use crate::temporary::Folder;
use raywalk::scene::{FORMATS, LoadOptions, load};
use std::time::{Instant, SystemTime};

/// Mutations of each seed in a normal run.
const TRIES: usize = 700;

/// A valid file, and what is put into it.
struct Seed {
    name: &'static str,
    /// The scene that it is a part of, where it is none.
    part_of: Option<&'static str>,
    bytes: Vec<u8>,
    tokens: &'static [&'static str],
}

fn seeds() -> Vec<Seed> {
    let (file, rest) = rich();
    let gltf_tokens = &[
        "{",
        "}",
        "[",
        "]",
        "\"",
        ",",
        "-",
        "1e39",
        "null",
        "0",
        "[]",
        "4294967297",
        "18446744073709551615",
        "%",
        "-1",
        ".0",
        "NaN",
        "{}",
        "\"x\"",
        "\\",
    ];
    let sky_tokens = &[
        "\n",
        "\r\n",
        "-Y ",
        "+X ",
        "9999999999",
        "EXPOSURE=0\n",
        "\x01\x01\x01\x7f",
        "\x02\x02\0\x20",
        "\0",
        "\x7f\x7f",
    ];
    vec![
        Seed {
            name: "s.json",
            part_of: None,
            bytes: include_bytes!("../every_type.json").to_vec(),
            tokens: &["{", "}", "[", "]", "\"", ",", "-", "1e39", "null", "0", "[]", "\"texture\":", "\"model\""],
        },
        Seed {
            name: "s.xml",
            part_of: None,
            bytes: include_bytes!("every_type.xml").to_vec(),
            tokens: &[
                "<",
                ">",
                "/>",
                "\"",
                "=",
                ",",
                "-",
                "1e39",
                "<!--",
                "<![CDATA[",
                "&#0;",
                "<!",
                "<model file='s.xml'/>",
            ],
        },
        Seed {
            name: "s.nff",
            part_of: None,
            bytes: include_bytes!("every_entity.nff").to_vec(),
            tokens: &["\n", " ", "#", "-", "1e39", "nan", "p 1e9 ", "pp 4 ", "c ", "0 0 0 0 ", "v ", "f "],
        },
        Seed {
            name: "s.obj",
            part_of: None,
            bytes: include_bytes!("every_statement.obj").to_vec(),
            tokens: &[
                "\n",
                " ",
                "/",
                "-",
                "1e39",
                "nan",
                "f ",
                "f 1 2 3 1 2 3\n",
                "-1",
                "0",
                "\\\n",
                "usemtl ",
                "mtllib s.obj\n",
                "vt 1\n",
            ],
        },
        Seed {
            name: "every_statement.mtl",
            part_of: Some("library.obj"),
            bytes: include_bytes!("every_statement.mtl").to_vec(),
            tokens: &[
                "\n", " ", "#", "-", "1e39", "nan", "newmtl ", "d ", "map_Kd ", "-s ", "-o 1 ", "-bm ", "../", "\\",
            ],
        },
        Seed { name: "sky.hdr", part_of: Some("hdr.json"), bytes: radiance(), tokens: sky_tokens },
        Seed { name: "sky.exr", part_of: Some("exr.json"), bytes: openexr(), tokens: sky_tokens },
        Seed { name: "s.gltf", part_of: None, bytes: file.text(&rest).into_bytes(), tokens: gltf_tokens },
        Seed { name: "s.glb", part_of: None, bytes: file.binary(&rest), tokens: gltf_tokens },
    ]
}

/// A picture of 32 by 4 pixels, run by run.
fn radiance() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 32\n".to_vec();
    for y in 0..4 {
        bytes.extend([2, 2, 0, 32]);
        for component in [200, 100 + y, 50, 129] {
            bytes.extend([128 + 29, component, 3, component, 7, component]);
        }
    }
    bytes
}

/// A picture of as many.
fn openexr() -> Vec<u8> {
    let folder = Folder::new();
    let file = folder.path().join("sky.exr");
    exr::prelude::write_rgb_file(&file, 32, 4, |x, y| (x as f32, y as f32, 0.5_f32)).expect("writable");
    std::fs::read(file).expect("there")
}

/// Damages a file in one to three places.
fn mutated(seed: &Seed, random: &mut Random) -> Vec<u8> {
    let mut bytes = seed.bytes.clone();
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        let end = (at + random.below(40)).min(bytes.len());
        match random.below(5) {
            0 => bytes[at] = random.below(256) as u8,
            1 => drop(bytes.drain(at..end)),
            2 => drop(bytes.splice(at..at, random.pick(seed.tokens).bytes())),
            3 => {
                let copied = bytes[at..end].to_vec();
                let to = random.below(bytes.len());
                drop(bytes.splice(to..to, copied));
            }
            // A digit for another: the file stays valid, the numbers become odd.
            _ => {
                if let Some(offset) = bytes[at..].iter().position(u8::is_ascii_digit) {
                    bytes[at + offset] = b'0' + random.below(10) as u8;
                }
            }
        }
    }
    bytes
}

#[test]
fn every_format_has_a_seed() {
    let seeds = seeds();
    for format in FORMATS {
        let has_seed = |extension: &&str| seeds.iter().any(|seed| seed.name.ends_with(&format!(".{extension}")));
        assert!(format.extensions.iter().any(has_seed), "{}", format.name);
    }
}

#[test]
fn damaged_files_never_end_the_program() {
    let folder = Folder::new();
    folder.write("library.obj", include_str!("every_statement.obj"));
    for kind in ["hdr", "exr"] {
        let sphere = r#"{ "type": "sphere", "center": [0, 0, 0], "radius": 1 }"#;
        let render = format!(r#"{{ "environment": {{ "image": "sky.{kind}" }} }}"#);
        let text = format!(r#"{{ "version": 1, "render": {render}, "objects": [{sphere}] }}"#);
        folder.write(&format!("{kind}.json"), text);
    }
    let fuzz: Option<f64> = std::env::var("RAYWALK_FUZZ").ok().map(|text| text.parse().expect("a number of seconds"));
    let fresh = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64);
    let mut random = Random::new(if fuzz.is_some() { fresh } else { 1 });
    let start = Instant::now();
    let seeds = seeds();
    let mut drawn = vec![0; seeds.len()];
    let mut tries = 0;
    while fuzz.map_or(tries < TRIES, |seconds| start.elapsed().as_secs_f64() < seconds) {
        tries += 1;
        for (seed, drawn) in seeds.iter().zip(&mut drawn) {
            let mutated = folder.write(seed.name, mutated(seed, &mut random));
            let file = seed.part_of.map_or(mutated, |scene| folder.path().join(scene));
            let begun = Instant::now();
            if let Ok(scene) = load(&file, &LoadOptions::default()) {
                picture(&scene, 8, 8);
                *drawn += 1;
            }
            let kept = folder.path().join(seed.name);
            assert!(begun.elapsed() < PATIENCE, "{} takes {:?}", kept.display(), begun.elapsed());
        }
    }
    for (seed, drawn) in seeds.iter().zip(drawn) {
        // Nothing in a library is an error.
        let least = if seed.name.ends_with(".mtl") { tries } else { 1 };
        assert!((least..=tries).contains(&drawn), "{}: {drawn} of {tries} are valid", seed.name);
    }
}
