//! Small files that place very much, made to be too much: they are shown, or told of, in time and within memory.

use crate::corpus::PATIENCE;
#[cfg(target_os = "linux")]
use crate::corpus::told_within_a_gibibyte;
use crate::gltf::file::File;
use crate::temporary::Folder;
use raywalk::scene::{LoadOptions, SceneError, load};
use std::path::PathBuf;
use std::time::Instant;

/// A file that places a mesh where `places` says, an accessor of translations; more keys follow, and more nodes from
/// number 1 on.
fn crowd(folder: &Folder, name: &str, mut file: File, side: u16, places: usize, more: &str) -> PathBuf {
    let at = |i: u16| f32::from(i) / f32::from(side) * 2.0 - 1.0;
    let points: Vec<[f32; 3]> =
        (0..=side).flat_map(|y| (0..=side).map(move |x| [at(x), f32::from(x * y % 7) * 0.03, at(y)])).collect();
    let quad = |x: u16, y: u16| {
        let (a, b) = (y * (side + 1) + x, (y + 1) * (side + 1) + x);
        [a, b, a + 1, a + 1, b, b + 1]
    };
    let indices: Vec<u16> = (0..side).flat_map(|y| (0..side).flat_map(move |x| quad(x, y))).collect();
    let (positions, indices) = (file.vectors(&points), file.indices(&indices));
    let text = file.text(&format!(
        r#""extensionsUsed": ["EXT_mesh_gpu_instancing"],
        "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions} }}, "indices": {indices} }}] }},
            {{ "primitives": [{{ "attributes": {{ "POSITION": {positions} }}, "indices": {indices}, "material": 0 }}] }}],
        "nodes": [{{ "mesh": 0, "extensions": {{ "EXT_mesh_gpu_instancing": {{ "attributes":
            {{ "TRANSLATION": {places} }} }} }} }} {more}"#
    ));
    folder.write(name, text)
}

/// All at the origin: zeros that are stored nowhere.
fn zeros(file: &mut File, count: usize) -> usize {
    file.accessor(format!(r#"{{ "componentType": 5126, "count": {count}, "type": "VEC3" }}"#))
}

/// On a lattice.
fn lattice(file: &mut File, count: u32) -> usize {
    let places: Vec<[f32; 3]> = (0..count).map(|i| [(i % 400) as f32 * 2.5, 0.0, (i / 400) as f32 * 2.5]).collect();
    file.vectors(&places)
}

const GLASS: &str = r#", { "mesh": 1, "translation": [0, 5, 0] }, { "camera": 0, "translation": [0, 3, 12] }],
    "materials": [{ "pbrMetallicRoughness": { "roughnessFactor": 0 },
        "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 } } }],
    "cameras": [{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }],
    "scenes": [{ "nodes": [0, 1, 2] }]"#;
const NOTHING: &str = r#"], "scenes": [{ "nodes": [0] }]"#;

#[test]
fn very_many_things_in_one_place_are_loaded_in_time() {
    let folder = Folder::new();
    let mut file = File::default();
    let places = zeros(&mut file, 400_000);
    let path = crowd(&folder, "same.gltf", file, 2, places, NOTHING);
    let start = Instant::now();
    let scene = load(&path, &LoadOptions::default()).unwrap();
    assert!(start.elapsed() < PATIENCE, "it took {:?}", start.elapsed());
    assert_eq!(scene.geometry.instances.placed.len(), 400_000);
}

/// Where it is best to stand is looked for, and every ray there meets the boxes of all of them.
#[test]
fn many_triangles_without_area_are_not_looked_at_for_ever() {
    let folder = Folder::new();
    let mut file = File::default();
    let corners = [[-1.0, -1.0, -1.0], [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]];
    let floor = [[-1.0, -1.0, -1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, 1.0]];
    let positions = file.vectors(&[corners, floor].concat());
    let needles = std::iter::repeat_n([0_u16, 1, 2], 30_000);
    let indices = file.indices(&needles.chain([[3, 4, 5]]).flatten().collect::<Vec<u16>>());
    let places = lattice(&mut file, 120);
    let path = folder.write(
        "needles.gltf",
        file.text(&format!(
            r#""extensionsUsed": ["EXT_mesh_gpu_instancing"],
            "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions} }}, "indices": {indices} }}] }}],
            "nodes": [{{ "mesh": 0, "extensions": {{ "EXT_mesh_gpu_instancing":
                {{ "attributes": {{ "TRANSLATION": {places} }} }} }} }}], "scenes": [{{ "nodes": [0] }}]"#
        )),
    );
    let start = Instant::now();
    let scene = load(&path, &LoadOptions::default()).unwrap();
    assert!(start.elapsed() < PATIENCE, "it took {:?}", start.elapsed());
    assert_eq!(scene.geometry.instances.placed.len(), 120);
}

/// Elements that replace others count as often as they are read.
#[test]
fn few_elements_that_are_replaced_very_often_are_told_of_in_time() {
    let folder = Folder::new();
    let mut file = File::default();
    let indices = file.view(&[1, 0].repeat(60_000), "");
    let values = file.view(&[0; 12].repeat(60_000), "");
    let positions = file.accessor(format!(
        r#"{{ "componentType": 5126, "count": 3, "type": "VEC3", "sparse": {{ "count": 60000,
            "indices": {{ "bufferView": {indices}, "componentType": 5123 }}, "values": {{ "bufferView": {values} }} }} }}"#
    ));
    let primitives = vec![format!(r#"{{ "attributes": {{ "POSITION": {positions} }} }}"#); 5000].join(", ");
    let text = file.text(&format!(
        r#""meshes": [{{ "primitives": [{primitives}] }}], "nodes": [{{ "mesh": 0 }}], "scenes": [{{ "nodes": [0] }}]"#
    ));
    let path = folder.write("sparse.gltf", text);
    let start = Instant::now();
    let error = load(&path, &LoadOptions::default()).unwrap_err();
    assert!(start.elapsed() < PATIENCE, "it took {:?}", start.elapsed());
    assert!(error.to_string().contains("limit vertices"), "{error}");
}

#[test]
fn more_triangles_than_indices_are_told_of_in_time() {
    let folder = Folder::new();
    let mut file = File::default();
    let places = zeros(&mut file, 1_000_000);
    let path = crowd(&folder, "many.gltf", file, 100, places, NOTHING);
    let start = Instant::now();
    let error = load(&path, &LoadOptions::default()).unwrap_err();
    assert!(start.elapsed() < PATIENCE, "it took {:?}", start.elapsed());
    assert!(matches!(&error, SceneError::Invalid { .. }) && error.to_string().contains("2^32 triangles"), "{error}");
}

/// Three thousand million triangles, some of them behind glass.
#[cfg(target_os = "linux")]
#[test]
fn the_program_survives_a_crowd_behind_glass_within_a_gibibyte() {
    let folder = Folder::new();
    let mut file = File::default();
    let places = lattice(&mut file, 150_000);
    let path = crowd(&folder, "glass.gltf", file, 100, places, GLASS);
    let start = Instant::now();
    told_within_a_gibibyte(&path);
    assert!(start.elapsed() < 2 * PATIENCE, "it took {:?}", start.elapsed());
}
