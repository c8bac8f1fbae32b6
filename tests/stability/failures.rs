//! Methods that approximate fail as often as the table of rates says.

use super::precision;
use super::rates::{METHODS, RATES, is_still};
use super::scenes::{self, Stress};
use crate::picture_bits::render;
use raywalk::render::Film;
use raywalk::settings::Settings;

const SIZE: (u32, u32) = (160, 90);

/// Whether pixels are off by more than 2/255 in any channel, row by row.
pub fn visibly_wrong(expected: &Film, found: &Film) -> Vec<bool> {
    let pixels = expected.rgba().chunks_exact(4).zip(found.rgba().chunks_exact(4));
    pixels.map(|(a, b)| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 2)).collect()
}

/// Per cent of wrong pixels over all cameras, a method each.
fn rates(stress: &Stress) -> [f64; METHODS.len()] {
    let mut wrong = [0; METHODS.len()];
    for camera in &stress.cameras {
        let expected = render(&stress.scene, camera, &Settings::exact(), SIZE);
        for ((_, settings), wrong) in METHODS.iter().zip(&mut wrong) {
            let found = render(&stress.scene, camera, &settings(), SIZE);
            *wrong += visibly_wrong(&expected, &found).into_iter().filter(|wrong| *wrong).count();
        }
    }
    let pixels = SIZE.0 as usize * SIZE.1 as usize * stress.cameras.len();
    wrong.map(|wrong| 100.0 * wrong as f64 / pixels as f64)
}

#[test]
fn every_method_fails_as_often_as_its_rate_says() {
    let (mut table, mut problems) = (String::new(), Vec::new());
    let scenes = scenes::all();
    for stress in &scenes {
        let measured = [&rates(stress)[..], &[precision::differing(stress)]].concat();
        let cells: Vec<String> = measured.iter().map(|rate| format!("{rate:6.2}")).collect();
        let name = format!("{:?},", stress.name);
        table += &format!("    ({name:<29} [{}]),\n", cells.join(", "));
        let Some((_, expected)) = RATES.iter().find(|(name, _)| *name == stress.name) else {
            problems.push(format!("{} has no row", stress.name));
            continue;
        };
        let columns = METHODS.iter().map(|(name, _)| *name).chain(["full against double precision"]);
        for ((column, expected), measured) in columns.zip(expected).zip(measured) {
            if !is_still(*expected, measured) {
                problems.push(format!("{}, {column}: {measured:.2} % wrong, {expected:.2} % before", stress.name));
            }
        }
    }
    for (name, _) in RATES {
        assert!(scenes.iter().any(|stress| stress.name == *name), "{name} has a row and no file");
    }
    println!("{table}");
    assert!(problems.is_empty(), "{}\nThe table as it is now:\n{table}", problems.join("\n"));
}
