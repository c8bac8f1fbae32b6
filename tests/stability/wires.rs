//! The sweep over wires: how much of each is lost, against its width.

use super::failures::visibly_wrong;
use super::rates::subsample;
use super::scenes;
use crate::picture_bits::render;
use raywalk::settings::{Fill, Settings, Visibility};

/// The methods that lose wires.
const METHODS: [(Fill, u32); 5] = [(Fill::Hit, 2), (Fill::Hit, 4), (Fill::Hit, 8), (Fill::Hit, 16), (Fill::Color, 8)];

/// A wire's width in pixels, and per cent of its pixels that are wrong in each of [`METHODS`].
#[rustfmt::skip]
const LOST: &[(&str, [f64; METHODS.len()])] = &[
    ("4",    [  0.0,   0.0,  36.3,  78.8,  37.0]),
    ("3",    [  0.0,   8.0,  51.7,  76.4,  52.5]),
    ("2",    [  0.0,  35.9,  69.6,  79.5,  70.1]),
    ("1.5",  [  7.0,  55.1,  77.5,  85.1,  59.6]),
    ("1",    [ 38.6,  67.4,  82.9,  92.9,  61.4]),
    ("0.7",  [ 47.5,  70.0,  85.8,  94.2,  68.8]),
    ("0.5",  [ 50.0,  74.1,  85.3,  97.1,  74.7]),
    ("0.35", [ 48.3,  76.7,  87.5,  91.7,  84.2]),
    ("0.25", [ 52.2,  78.9,  93.3,  96.7,  94.4]),
    ("0.15", [ 48.0,  88.0,  96.0,  96.0,  96.0]),
    ("0.1",  [ 62.5,  90.0, 100.0, 100.0, 100.0]),
    ("0.07", [ 63.3,  83.3,  96.7, 100.0,  96.7]),
    ("0.05", [ 75.0,  95.0, 100.0, 100.0, 100.0]),
];

/// Whether as much of a wire is lost as before.
fn is_still(expected: f64, measured: f64) -> bool {
    (measured - expected).abs() <= 5.0
}

#[test]
fn subsampling_loses_wires_and_certified_none() {
    let stress = scenes::all().into_iter().find(|stress| stress.name == "wires").unwrap();
    let (scene, camera) = (&stress.scene, &stress.cameras[0]);
    let size = (scene.render.width.unwrap(), scene.render.height.unwrap());
    let full = render(scene, camera, &Settings { visibility: Visibility::Full, ..Settings::exact() }, size);
    let certified = render(scene, camera, &Settings::exact(), size);
    assert!(!visibly_wrong(&full, &certified).contains(&true), "certified lost something");
    let balanced = render(scene, camera, &Settings::balanced(), size);
    assert!(!visibly_wrong(&full, &balanced).contains(&true), "interpolated light lost something");

    let wrong =
        METHODS.map(|(fill, stride)| visibly_wrong(&full, &render(scene, camera, &subsample(fill, stride), size)));
    let object_at = |i: usize| full.object(i as u32 % size.0, i as u32 / size.0).unwrap() as usize;
    let objects: Vec<usize> = (0..wrong[0].len()).map(object_at).collect();
    let (mut table, mut problems) = (String::new(), Vec::new());
    for (index, object) in scene.objects.iter().enumerate() {
        let Some(width) = object.name.as_deref().and_then(|name| name.strip_suffix(" px")) else { continue };
        let pixels: Vec<usize> = (0..objects.len()).filter(|&i| objects[i] == index).collect();
        assert!(!pixels.is_empty(), "full has lost the wire of {width} px");
        let share = |wrong: &Vec<bool>| pixels.iter().filter(|&&i| wrong[i]).count() as f64 / pixels.len() as f64;
        let lost = wrong.each_ref().map(|wrong| 100.0 * share(wrong));
        let cells: Vec<String> = lost.iter().map(|rate| format!("{rate:5.1}")).collect();
        let name = format!("{width:?},");
        table += &format!("    ({name:<7} [{}]),\n", cells.join(", "));
        match LOST.iter().find(|(name, _)| *name == width) {
            None => problems.push(format!("{width} px has no row")),
            Some((_, expected)) if expected.iter().zip(lost).any(|(&expected, lost)| !is_still(expected, lost)) => {
                problems.push(format!("{width} px: {lost:.1?} % lost, {expected:.1?} % before"));
            }
            Some(_) => {}
        }
    }
    println!("{table}");
    assert!(problems.is_empty(), "{}\nThe table as it is now:\n{table}", problems.join("\n"));
}
