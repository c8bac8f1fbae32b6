//! An adversary of every shortcut: scenes and cameras made so that many pixels are decided within rounding errors of
//! the wrong answer, compared bit for bit with brute force.
//!
//! It knows where blocks of pixels meet (`view`) and puts outlines exactly there (`graze`), as seen by the eye, by a
//! light or in a mirror; it puts things all but in the same place (`families`), and the eye where a tracer divides by
//! nothing (`aimed`). Scenes are files for the public loader. One that fails is shrunk and written to a file, whose
//! `comment` says what differed; files in `tests/regressions` are tried at every run.
//!
//! A normal run tries a fixed number of scenes, the same ones on every machine. `RAYWALK_FUZZ=SECONDS` goes on for so
//! long with fresh ones; `RAYWALK_KEEP=1` writes failures to `tests/regressions` instead of the temporary folder.

mod aimed;
mod families;
mod graze;
mod judge;
mod receiver;
mod shrink;
mod stage;
mod view;

use crate::random::Random;
use crate::temporary::load_text;
use families::{FAMILIES, Family};
use judge::Judge;
use raywalk::scene::{LoadOptions, load};
use raywalk::settings::Settings;
use serde_json::{Value, json};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};

/// Smaller scenes that are tried to shrink one failure.
const SHRINKING: usize = 1500;
/// Failures of a family after which it is given up.
const ENOUGH: usize = 3;

/// What came of some scenes.
#[derive(Default)]
struct Findings {
    tried: u32,
    /// Files that the loader refused, such as those where rounding left nothing of a cylinder.
    refused: u32,
    failures: Vec<String>,
}

/// Seeds of a family's scenes, given its number: the same ones on every run.
fn seeds(family: usize) -> impl Iterator<Item = u64> {
    (family as u64) << 32..
}

/// Tries scenes of a family.
fn attack(family: &Family, seeds: impl Iterator<Item = u64>) -> Findings {
    let mut judge = Judge::new(1.0);
    let mut findings = Findings::default();
    for seed in seeds {
        if findings.failures.len() >= ENOUGH {
            break;
        }
        let mut random = Random::new(seed);
        let file = families::compose(family, &mut random);
        let Ok(scene) = load_text(file.to_string()) else {
            findings.refused += 1;
            continue;
        };
        findings.tried += 1;
        let candidates = judge::candidates(&mut random);
        if let Some((candidate, _)) = judge.complaints(&scene, &candidates).pop() {
            findings.failures.push(report(&mut judge, family.name, seed, file, candidate));
        }
    }
    findings
}

/// Shrinks a failure and writes it down; says where.
fn report(judge: &mut Judge, family: &str, seed: u64, file: Value, candidate: &judge::Named) -> String {
    let mut small = shrink::shrink(file, SHRINKING, &mut |file| judge.complaint(file, candidate).is_some());
    let complaint = judge.complaint(&small, candidate).unwrap_or_else(|| "failed once, and never again".to_owned());
    let mut hasher = DefaultHasher::new();
    small.to_string().hash(&mut hasher);
    small["comment"] = json!(format!("{family}: {complaint}"));
    let keep = std::env::var_os("RAYWALK_KEEP").is_some();
    let folder = if keep { regressions() } else { PathBuf::from(env!("CARGO_TARGET_TMPDIR")) };
    let path = folder.join(format!("{:016x}.json", hasher.finish()));
    let written = std::fs::write(&path, format!("{small:#}\n"));
    let place = written.map_or_else(|error| error.to_string(), |()| path.display().to_string());
    format!("{family}, seed {seed}, {complaint}: {place}")
}

fn regressions() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/regressions")
}

/// How long to look for failures, where that was asked for.
fn asked_for() -> Option<Duration> {
    let seconds = std::env::var("RAYWALK_FUZZ").ok()?;
    Some(Duration::from_secs_f64(seconds.parse().expect("RAYWALK_FUZZ is a number of seconds")))
}

#[test]
fn no_scene_shows_another_picture_than_brute_force() {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let fuzz = asked_for();
    let fresh = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_nanos() as u64);
    let worker = |first: usize| {
        let mut all = Vec::new();
        for (number, family) in FAMILIES.iter().enumerate().skip(first).step_by(threads) {
            let found = match fuzz {
                None => attack(family, seeds(number).take(family.scenes as usize)),
                Some(time) => {
                    let end = Instant::now() + time / FAMILIES.len().div_ceil(threads) as u32;
                    println!("{}: from seed {fresh}", family.name);
                    attack(family, (fresh..).take_while(|_| Instant::now() < end))
                }
            };
            println!("{}: {} scenes, {} refused", family.name, found.tried, found.refused);
            assert!(found.refused <= found.tried, "{}: most scenes do not load", family.name);
            all.extend(found.failures);
        }
        all
    };
    let failures: Vec<String> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|first| scope.spawn(move || worker(first))).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn scenes_that_failed_once_do_not_again() {
    let mut failures = Vec::new();
    for entry in std::fs::read_dir(regressions()).unwrap() {
        let path = entry.unwrap().path();
        let scene = load(&path, &LoadOptions::default()).unwrap();
        for (_, complaint) in Judge::new(1.0).complaints(&scene, &judge::all_candidates()) {
            failures.push(format!("{}: {complaint}", path.display()));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// A kind of margin, and which scenes depend on it.
struct Margin {
    family: &'static str,
    /// The types of objects that stay in a scene; all where there are none.
    types: &'static [&'static str],
    /// Only what shadows change counts.
    of_shadows: bool,
}

const MARGINS: [Margin; 8] = [
    Margin { family: "spheres", types: &["sphere"], of_shadows: false },
    Margin { family: "triangles", types: &["triangle", "rectangle", "mesh"], of_shadows: false },
    Margin { family: "boxes", types: &["box"], of_shadows: false },
    Margin { family: "disks", types: &["disk"], of_shadows: false },
    Margin { family: "cones", types: &["cone", "cylinder"], of_shadows: false },
    Margin { family: "planes", types: &["plane"], of_shadows: false },
    Margin { family: "rivals", types: &[], of_shadows: false },
    Margin { family: "shadows", types: &[], of_shadows: true },
];

impl Margin {
    /// Whether a scene shows its lack.
    fn is_missed(&self, judge: &mut Judge, mut scene: Value) -> bool {
        if let (Some(objects), false) = (scene["objects"].as_array_mut(), self.types.is_empty()) {
            objects.retain(|object| self.types.iter().any(|kind| object["type"] == *kind));
        }
        let mut is_wrong = |shadows: bool| {
            let settings = Settings { threads: 1, shadows, ..Settings::exact() };
            judge.complaint(&scene, &(String::new(), settings)).is_some()
        };
        is_wrong(true) && !(self.of_shadows && is_wrong(false))
    }
}

#[test]
fn margins_that_are_missing_are_noticed() {
    let mut judge = Judge::new(0.0);
    for margin in MARGINS {
        let (number, family) = FAMILIES.iter().enumerate().find(|(_, family)| family.name == margin.family).unwrap();
        let noticed = seeds(number).take(family.scenes as usize).any(|seed| {
            let scene = families::compose(family, &mut Random::new(seed));
            margin.is_missed(&mut judge, scene)
        });
        assert!(noticed, "{}: nothing is wrong without margins", margin.family);
    }
}

#[test]
fn shrinking_leaves_what_fails() {
    let mut random = Random::new(1);
    let mut file = families::compose(&FAMILIES[2], &mut random);
    file["objects"] = json!([{ "type": "sphere", "center": [1.25, 2.5, 3.5], "radius": 7 }, { "type": "plane" }, 3, 4]);
    let small = shrink::shrink(file, SHRINKING, &mut |file| {
        file["objects"].as_array().is_some_and(|all| all.iter().any(|object| object["center"][0].as_f64() >= Some(1.2)))
    });
    assert_eq!(small["objects"], json!([{ "center": [1.2, 0.0, 0.0] }]));
    assert!(small.get("lights").is_none() && small.get("materials").is_none());
}
