//! `raywalk tune`: what it finds keeps what was asked for, judged by the other commands.

use super::cli::{Bench, text};
use raywalk::measure::metric::METRICS;
use serde_json::Value;

/// The built-in scene, small.
const SMALL: &str = "--size 192x108";

/// A number of a JSON object.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

fn flags(found: &Value) -> &str {
    found["flags"].as_str().expect("flags")
}

/// What `raywalk compare` says of a view rendered with `flags`, against a ray for every pixel.
fn errors(bench: &Bench, view: &str, flags: &str) -> Value {
    bench.done(&format!("render {view} {flags} -o found.png"));
    bench.done(&format!("render {view} --visibility full -o full.png"));
    bench.json("compare full.png found.png --json")
}

#[test]
fn what_it_finds_keeps_the_bound_by_other_means() {
    let bench = Bench::new();
    let found = bench.json(&format!("tune {SMALL} --max-error flip=0.1 --json"));
    assert_eq!(found["met"], true);
    assert_ne!(flags(&found), "--preset exact", "this bound leaves room");
    let flip = number(&errors(&bench, SMALL, flags(&found))["flip"]);
    assert!(flip <= 0.1, "{flip}");
    assert!((flip - number(&found["error"]["flip"])).abs() < 1e-9, "{flip}");
    assert!(number(&found["cpu_ms"]["min"]) <= number(&found["cpu_ms"]["median"]));
    let front = found["front"].as_array().expect("a front");
    assert!(front.iter().any(|point| point["flags"] == found["flags"]));
    let costs: Vec<f64> = front.iter().map(|point| number(&point["cpu_ms"]["min"])).collect();
    assert!(costs.is_sorted_by(|a, b| a >= b), "{costs:?}");
    assert!(found["tried"].as_array().expect("a list").len() > 8);
    for name in ["shadows", "depth", "tone-map", "supersample"] {
        assert!(found["settings"].get(name).is_some() && !flags(&found).contains(name), "{name}");
    }
}

#[test]
fn a_bound_that_allows_nothing_keeps_every_pixel() {
    let bench = Bench::new();
    for bound in ["psnr=inf", "max_abs=0"] {
        let found = bench.json(&format!("tune {SMALL} --max-error {bound} --json"));
        assert_eq!(found["met"], true, "{bound}");
        assert_eq!(number(&errors(&bench, SMALL, flags(&found))["max_abs"]), 0.0, "{bound}: {}", flags(&found));
    }
}

#[test]
fn several_bounds_hold_together_and_flags_stay() {
    let bench = Bench::new();
    let line = "--supersample 4 --depth 3 --min-weight 0.01 --threads 1";
    let found = bench.json(&format!("tune {SMALL} {line} --max-error psnr=35 --max-error pixels_off=2000 --json"));
    let said = flags(&found);
    for flag in ["--supersample 4", "--depth 3", "--min-weight 0.01", "--threads 1"] {
        assert!(said.contains(flag), "{said}");
    }
    let view = format!("{SMALL} --supersample 4 --depth 3");
    let errors = errors(&bench, &view, &said.replace("--supersample 4", "").replace("--depth 3", ""));
    assert!(errors["psnr"].is_null() || number(&errors["psnr"]) >= 35.0, "{errors}");
    assert!(number(&errors["pixels_off"]) <= 2000.0, "{errors}");
}

#[test]
fn every_frame_of_a_path_keeps_the_bound() {
    let bench = Bench::new();
    let path = r#"{ "version": 1, "fps": 8, "keys": [
        { "t": 0, "position": [0.5, 1.9, 5], "look_at": [0.15, 0.65, 0] }, { "t": 1, "position": [4, 2, 1], "look_at": [0, 1, 0] } ] }"#;
    bench.write("walk.json", path);
    let view = "--size 96x54 --path walk.json";
    let found = bench.json(&format!("tune {view} --max-error rmse=0.03 --json"));
    assert_eq!(found["met"], true);
    bench.done(&format!("render {view} {} -o found-%d.png", flags(&found)));
    bench.done(&format!("render {view} --visibility full -o full-%d.png"));
    let frames = found["frames"].as_u64().expect("a number");
    assert!(frames > 6, "{frames}");
    let rmse = |frame| number(&bench.json(&format!("compare full-{frame}.png found-{frame}.png --json"))["rmse"]);
    let worst = (0..frames).map(rmse).fold(0.0, f64::max);
    assert!(worst <= 0.03 && (worst - number(&found["error"]["rmse"])).abs() < 1e-9, "{worst}: {}", found["error"]);
}

#[test]
fn people_get_a_table_then_the_flags_then_json() {
    let bench = Bench::new();
    let said = bench.done("tune --size 64x36 --max-error ssim=0.9");
    let lines: Vec<&str> = said.lines().collect();
    let found: Value = serde_json::from_str(lines[lines.len() - 1]).expect("JSON at last");
    assert_eq!(lines[lines.len() - 2], flags(&found));
    assert!(lines[0].starts_with("tried ") && said.contains("  visibility: certified, full, subsample"), "{said}");
    assert!(lines.iter().any(|line| line.starts_with('>')), "{said}");
    let head = lines.iter().find(|line| line.contains("CPU ms")).expect("a head");
    assert!(head.contains("ssim") && head.contains("flags"), "{head}");
}

#[test]
fn nothing_within_the_bound_is_exit_1() {
    let bench = Bench::new();
    let line = "tune --size 64x36 --render-scale 0.5 --max-error psnr=99 --json";
    let output = bench.run(line);
    let said = text(&output.stderr);
    assert_eq!((output.status.code(), said.lines().count()), (Some(1), 1), "{said}");
    assert!(said.starts_with("error: ") && said.contains("psnr=99"), "{said}");
    let found: Value = serde_json::from_str(&text(&output.stdout)).expect("JSON");
    assert!(found["met"] == false && found["flags"].is_null(), "{found}");
    assert!(!found["front"].as_array().expect("a front").is_empty(), "what was measured is told");
    for bound in ["flip=-1", "ssim=1.5"] {
        let said = bench.refused(1, &format!("tune --size 64x36 --max-error {bound}"));
        assert!(said.contains(bound), "{said}");
    }
}

#[test]
fn wrong_usage_of_tune_is_exit_2() {
    let bench = Bench::new();
    for line in ["tune", "tune --max-error flip", "tune --max-error flip=x", "tune --max-error psnr=nan"] {
        bench.refused(2, line);
    }
    let said = bench.refused(2, "tune --max-error speed=1");
    assert!(METRICS.iter().all(|metric| said.contains(metric.name)), "{said}");
    assert!(bench.refused(2, "tune --max-error flip=1 --stats -").contains("--json"));
    assert!(bench.refused(2, "tune --max-error flip=1 --preset fast").contains("--preset"));
}
