//! Primitives: modes, indices, accessors of every kind, attributes, skins and morph targets.

use super::file::{CORNERS, File, warnings};
use glam::{Vec2, Vec3};
use raywalk::geometry::PrimitiveId;
use raywalk::scene::Scene;

/// One node with a mesh of one primitive.
fn primitive(file: &File, keys: &str) -> Scene {
    file.load(&format!(r#""nodes": [{{ "mesh": 0 }}], "meshes": [{{ "primitives": [{{ {keys} }}] }}]"#))
}

fn bounds(scene: &Scene) -> [Vec3; 2] {
    [scene.bounds().min, scene.bounds().max]
}

const UNIT: [Vec3; 2] = [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)];

#[test]
fn indices_of_every_type_and_none_give_the_same_triangle() {
    for (component, bytes) in
        [(5121, vec![2, 0, 1]), (5123, vec![2, 0, 0, 0, 1, 0]), (5125, vec![2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0])]
    {
        let mut file = File::default();
        let positions = file.vectors(&CORNERS);
        let view = file.view(&bytes, "");
        let indices = file.accessor(format!(
            r#"{{ "bufferView": {view}, "componentType": {component}, "count": 3, "type": "SCALAR" }}"#
        ));
        let scene = primitive(&file, &format!(r#""attributes": {{ "POSITION": {positions} }}, "indices": {indices}"#));
        assert_eq!((scene.geometry.len(), bounds(&scene)), (1, UNIT), "{component}");
        let scene = primitive(&file, &format!(r#""attributes": {{ "POSITION": {positions} }}"#));
        assert_eq!((scene.geometry.len(), bounds(&scene)), (1, UNIT));
    }
}

#[test]
fn modes_make_triangles_and_keep_their_numbers() {
    let mut file = File::default();
    // The second triangle of the strip has no area.
    let positions =
        file.vectors(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
    let attributes = format!(r#""attributes": {{ "POSITION": {positions} }}"#);
    let numbers = |mode: u32| -> Vec<u32> {
        let scene = primitive(&file, &format!(r#"{attributes}, "mode": {mode}"#));
        scene.geometry.own().map(|(_, PrimitiveId { primitive, .. })| primitive).collect()
    };
    assert_eq!(numbers(4), [0]);
    // Of (1, 3, 2) and (2, 3, 4), corners 2 and 3 are the same point.
    assert_eq!(numbers(5), [0]);
    assert_eq!(numbers(6), [0, 2]);
    for mode in 0..4 {
        let scene = primitive(&file, &format!(r#"{attributes}, "mode": {mode}"#));
        assert!(scene.objects.is_empty());
        assert!(warnings(&scene)[0].starts_with("/meshes/0/primitives/0: points and lines"), "{mode}");
    }
}

#[test]
fn interleaved_normalised_and_sparse_accessors_are_read() {
    let mut file = File::default();
    let mut bytes = Vec::new();
    for (corner, uv) in CORNERS.iter().zip([[0_u16, 0], [65535, 0], [0, 32768]]) {
        bytes.extend(corner.iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(uv.iter().flat_map(|v| v.to_le_bytes()));
    }
    let view = file.view(&bytes, r#", "byteStride": 16"#);
    let positions =
        file.accessor(format!(r#"{{ "bufferView": {view}, "componentType": 5126, "count": 3, "type": "VEC3" }}"#));
    let uvs = file.accessor(format!(
        r#"{{ "bufferView": {view}, "byteOffset": 12, "componentType": 5123, "normalized": true, "count": 3, "type": "VEC2" }}"#
    ));
    let scene = primitive(&file, &format!(r#""attributes": {{ "POSITION": {positions}, "TEXCOORD_0": {uvs} }}"#));
    assert_eq!(bounds(&scene), UNIT);
    let mut found = scene.geometry.attributes_of(0).and_then(|a| a.uvs).expect("texture coordinates");
    // Upwards, and in any order of corners.
    found.sort_by(|a, b| (a.x, a.y).partial_cmp(&(b.x, b.y)).expect("numbers"));
    for (found, expected) in found.iter().zip([Vec2::new(0.0, 0.5), Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0)]) {
        assert!(found.abs_diff_eq(expected, 1e-4), "{found}");
    }

    let places = file.view(&[1, 2], "");
    let values: Vec<u8> = [3.0_f32, 0.0, 0.0, 0.0, 4.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let values = file.view(&values, "");
    for dense in ["", r#""bufferView": 0,"#] {
        let sparse = file.accessor(format!(
            r#"{{ {dense} "componentType": 5126, "count": 3, "type": "VEC3", "sparse": {{ "count": 2,
            "indices": {{ "bufferView": {places}, "componentType": 5121 }}, "values": {{ "bufferView": {values} }} }} }}"#
        ));
        let scene = primitive(&file, &format!(r#""attributes": {{ "POSITION": {sparse} }}"#));
        assert_eq!(bounds(&scene), [Vec3::ZERO, Vec3::new(3.0, 4.0, 0.0)]);
    }
}

#[test]
fn quantised_positions_follow_their_normalisation() {
    let mut file = File::default();
    let view = file.view(&[0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0], r#", "byteStride": 4"#);
    for (normalized, reach) in [(true, 1.0), (false, 127.0)] {
        let positions = file.accessor(format!(
            r#"{{ "bufferView": {view}, "componentType": 5120, "normalized": {normalized}, "count": 3, "type": "VEC3" }}"#
        ));
        let scene = primitive(&file, &format!(r#""attributes": {{ "POSITION": {positions} }}"#));
        assert_eq!(scene.bounds().max, Vec3::new(reach, reach, 0.0));
    }
}

#[test]
fn normals_without_direction_are_replaced() {
    let mut file = File::default();
    let (positions, normals) = (file.vectors(&CORNERS), file.vectors(&[[0.0, 0.0, 0.0]; 3]));
    let scene = primitive(&file, &format!(r#""attributes": {{ "POSITION": {positions}, "NORMAL": {normals} }}"#));
    assert_eq!(scene.geometry.attributes_of(0).and_then(|a| a.normals), Some([Vec3::Z; 3]));
    assert!(warnings(&scene)[0].contains("3 normals have no direction"));
}

#[test]
fn morph_targets_weigh_what_the_file_says() {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let moves = file.vectors(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, 0.0]]);
    let mesh = format!(
        r#""meshes": [{{ "weights": [0.5], "primitives": [{{ "attributes": {{ "POSITION": {positions} }},
        "targets": [{{ "POSITION": {moves} }}] }}] }}]"#
    );
    for (node, reach) in [("", 3.0), (r#", "weights": [0.25]"#, 2.0)] {
        let scene = file.load(&format!(r#"{mesh}, "nodes": [{{ "mesh": 0 {node} }}]"#));
        assert_eq!(scene.bounds().max, Vec3::new(reach, 1.0, 0.0));
        assert!(warnings(&scene)[0].contains("at rest"));
    }
}

#[test]
fn a_skin_follows_its_joints_and_not_its_node() {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let weights = file.vectors(&[[1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]);
    let view = file.view(&[0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0], "");
    let joints =
        file.accessor(format!(r#"{{ "bufferView": {view}, "componentType": 5121, "count": 3, "type": "VEC4" }}"#));
    let scene = file.load(&format!(
        r#""meshes": [{{ "primitives": [{{ "attributes":
            {{ "POSITION": {positions}, "JOINTS_0": {joints}, "WEIGHTS_0": {weights} }} }}] }}],
        "skins": [{{ "joints": [1, 2] }}],
        "nodes": [{{ "mesh": 0, "skin": 0, "translation": [100, 0, 0] }}, {{ "translation": [0, 0, 5] }},
            {{ "translation": [2, 0, 5] }}]"#
    ));
    assert_eq!(bounds(&scene), [Vec3::new(0.0, 0.0, 5.0), Vec3::new(2.0, 1.0, 5.0)]);
    assert_eq!(warnings(&scene), ["/nodes/0/skin: the skin is shown at rest"]);
}

#[test]
fn primitives_that_share_many_vertices_keep_their_own() {
    let mut file = File::default();
    let corner = |i: usize| [i as f32, (i * i) as f32, 0.0];
    let positions = file.vectors(&(0..100).map(corner).collect::<Vec<_>>());
    let indices = file.indices(&[97, 3, 40]);
    let keys = format!(r#""attributes": {{ "POSITION": {positions} }}, "indices": {indices}"#);
    let scene = primitive(&file, &keys);
    assert_eq!(bounds(&scene), [Vec3::new(3.0, 9.0, 0.0), Vec3::new(97.0, 9409.0, 0.0)]);
    // The limit counts the vertices used, not those there are.
    let mut options = raywalk::scene::LoadOptions::default();
    options.limits.set("vertices", "6").expect("a known limit");
    let folder = crate::temporary::Folder::new();
    let text = file.text(&format!(r#""nodes": [{{ "mesh": 0 }}], "meshes": [{{ "primitives": [{{ {keys} }}] }}]"#));
    assert!(raywalk::scene::load(&folder.write("s.gltf", text), &options).is_ok());
}
