//! Wrong glTF files: what is damaged costs the smallest part that holds it and one warning that names its place; only what
//! is no glTF at all, or asks for too much, is refused. None panics.

use super::file::{CORNERS, File, try_load, warnings};
use crate::temporary::Folder;
use raywalk::scene::{LoadOptions, Scene, load};

/// A file with a mesh of one primitive over its accessors, and a good mesh beside it.
fn beside_a_good_one(file: &mut File, primitive: &str) -> String {
    let good = file.vectors(&CORNERS);
    file.text(&format!(
        r#""nodes": [{{ "mesh": 0 }}, {{ "mesh": 1 }}], "meshes": [{{ "primitives": [{{ {primitive} }}] }},
        {{ "primitives": [{{ "attributes": {{ "POSITION": {good} }} }}] }}]"#
    ))
}

/// Checks that a primitive costs no more than itself, if `costs_all`, or than a part of it, and what is told of it. Alone
/// it is refused if nothing is left of it.
fn damaged(file: &mut File, primitive: &str, costs_all: bool, says: &str) -> Scene {
    let alone = format!(r#""nodes": [{{ "mesh": 0 }}], "meshes": [{{ "primitives": [{{ {primitive} }}] }}]"#);
    let alone = try_load(file.text(&alone));
    let text = beside_a_good_one(file, primitive);
    let scene = try_load(&text).unwrap_or_else(|error| panic!("{primitive}: {error}"));
    assert_eq!(scene.objects.len(), 2 - usize::from(costs_all), "{primitive}: {:?}", warnings(&scene));
    let told = warnings(&scene);
    // What follows from a fault is told, too.
    let follows = |told: &str| ["at rest", "without area", "not finite"].iter().any(|words| told.contains(words));
    let faults: Vec<&String> = told.iter().filter(|told| told.contains(says) || !follows(told)).collect();
    // A value of another type is told of by itself, and once more what goes without it.
    let is_mistyped = told.iter().any(|told| told.contains(": expected "));
    assert!(faults.iter().any(|told| told.contains(says)), "{primitive}: {told:?}");
    let place = |told: &str| told.split_once(": ").map(|(place, _)| place.to_owned());
    let in_one_place = faults.iter().all(|told| place(told) == place(faults[0]));
    assert!(in_one_place || is_mistyped, "{primitive}: {told:?}");
    assert!(
        faults[0].starts_with("/meshes/0")
            || faults[0].starts_with("/accessors/")
            || faults[0].starts_with("/bufferViews/")
    );
    match alone {
        Ok(_) => assert!(!costs_all, "{primitive}"),
        Err(error) => {
            let error = error.to_string();
            assert!(costs_all && error.contains(says) && error.contains("nothing is left to draw"), "{error}");
        }
    }
    let folder = Folder::new();
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    assert!(load(&folder.write("s.gltf", text), &strict).unwrap_err().to_string().contains("--strict"));
    scene
}

/// Damages the POSITION accessor, written `accessor`, over a view of 36 bytes.
fn position(accessor: &str, costs_all: bool, says: &str) {
    let mut file = File::default();
    file.vectors(&CORNERS);
    file.view(&[0; 40], r#", "byteStride": 4"#);
    let number = file.accessor(accessor.to_owned());
    damaged(&mut file, &format!(r#""attributes": {{ "POSITION": {number} }}"#), costs_all, says);
}

#[test]
fn accessors_that_do_not_fit_their_bytes_are_cut_off() {
    let plain = r#""componentType": 5126, "type": "VEC3""#;
    position(&format!(r#"{{ "bufferView": 0, "count": 0, {plain} }}"#), true, "count is 0");
    for count in ["4", "1000000000000", "4611686018427387904"] {
        let says = format!("count is {count}, but there are bytes for 3 elements");
        position(&format!(r#"{{ "bufferView": 0, "count": {count}, {plain} }}"#), false, &says);
    }
    let offset = |offset: &str| format!(r#"{{ "bufferView": 0, "byteOffset": {offset}, "count": 3, {plain} }}"#);
    position(&offset("18446744073709551608"), true, "beyond the bytes of its buffer view");
    position(&offset("36"), true, "beyond the bytes of its buffer view");
    position(&format!(r#"{{ "bufferView": 7, "count": 3, {plain} }}"#), true, "buffer view 7 does not exist");
    position(&format!(r#"{{ "bufferView": "x", "count": 3, {plain} }}"#), true, "does not exist");
    let scalar = r#"{ "bufferView": 0, "count": 3, "componentType": 5126, "type": "SCALAR" }"#;
    position(scalar, true, "expected 3 numbers an element, found 1");
    let unknown = r#"{ "bufferView": 0, "count": 3, "componentType": 5124, "type": "VEC3" }"#;
    position(unknown, true, "unknown componentType");
    let sparse = |sparse: &str| format!(r#"{{ "bufferView": 0, "count": 3, {plain}, "sparse": {{ {sparse} }} }}"#);
    for (text, says) in [
        (
            r#""count": 1, "values": { "bufferView": 0 },
            "indices": { "bufferView": 0, "byteOffset": 14, "componentType": 5121 }"#,
            "indices of elements that are not there",
        ),
        (
            r#""count": 900719925474099, "values": { "bufferView": 0 },
            "indices": { "bufferView": 1, "componentType": 5121 }"#,
            "but there are bytes for 3",
        ),
        (
            r#""count": 1, "values": { "bufferView": 9 }, "indices": { "bufferView": 0, "componentType": 5121 }"#,
            "buffer view 9",
        ),
        (
            r#""count": 1, "values": { "bufferView": 0 }, "indices": { "bufferView": 0, "componentType": 7 }"#,
            "unsigned type",
        ),
        (r#""count": 1, "values": {}"#, "expected an object with"),
    ] {
        position(&sparse(text), false, says);
    }
}

#[test]
fn strides_of_nothing_are_those_of_packed_elements() {
    for (stride, says) in [("0", None), ("4", Some("the elements are taken as packed"))] {
        let mut file = File::default();
        let bytes: Vec<u8> = CORNERS.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = file.view(&bytes, &format!(r#", "byteStride": {stride}"#));
        let accessor = format!(r#"{{ "bufferView": {view}, "count": 3, "componentType": 5126, "type": "VEC3" }}"#);
        let number = file.accessor(accessor);
        let scene = file.load(&format!(
            r#""meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {number} }} }}] }}], "nodes": [{{ "mesh": 0 }}]"#
        ));
        assert_eq!(scene.objects[0].bounds.max.to_array(), [1.0, 1.0, 0.0], "{stride}");
        assert_eq!(scene.warnings.first().map(|told| told.message.contains(says.unwrap_or("?"))), says.map(|_| true));
    }
}

#[test]
fn what_has_no_bytes_is_limited() {
    let zeros = |count: &str| format!(r#"{{ "count": {count}, "componentType": 5126, "type": "VEC3" }}"#);
    for (count, attributes) in [("50000000", r#""POSITION": 0"#), ("3000000", r#""POSITION": 0, "NORMAL": 0"#)] {
        let mut file = File::default();
        file.accessor(zeros(count));
        let rest = format!(
            r#""nodes": [{{ "mesh": 0 }}], "meshes": [{{ "primitives": [{{ "attributes": {{ {attributes} }} }}] }}]"#
        );
        let error = try_load(file.text(&rest)).unwrap_err().to_string();
        assert!(error.contains("(/accessors/0/count)") && error.contains("in the whole file"), "{error}");
    }
}

#[test]
fn attributes_that_do_not_fit_cost_themselves() {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let two = file.vectors(&[[0.0, 0.0, 1.0]; 2]);
    let four = file.vectors(&[[0.0, 0.0, 1.0]; 4]);
    let wide = file.vectors(&[[0.0, 0.0, 1.0, 7.0], [1.0, 0.0, 1.0, 7.0], [0.0, 1.0, 1.0, 7.0]]);
    let nan = file.vectors(&[[f32::NAN, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, f32::INFINITY]]);
    let shorts = file.view(&[0; 12], "");
    let shorts = format!(r#"{{ "bufferView": {shorts}, "count": 3, "componentType": 5122, "type": "SCALAR" }}"#);
    let shorts = file.accessor(shorts);
    let empty = file.indices(&[]);
    for (rest, costs_all, says) in [
        (format!(r#", "NORMAL": {two} }}"#), false, "one entry a vertex (3), found 2; left out"),
        (format!(r#", "NORMAL": {four} }}"#), false, "4 entries for 3 vertices"),
        (format!(r#", "NORMAL": {nan} }}"#), false, "2 normals have no direction"),
        (format!(r#", "TEXCOORD_0": {nan} }}"#), false, "texture coordinates are not finite; taken as 0"),
        (format!(r#", "TEXCOORD_0": {four} }}"#), false, "4 entries for 3 vertices"),
        (format!(r#", "TEXCOORD_0": {shorts} }}"#), false, "expected 2 numbers an element, found 1; left out"),
        (format!(r#", "COLOR_0": {nan} }}"#), false, "2 colours are not finite; taken as white"),
        (format!(r#", "COLOR_0": {shorts} }}"#), false, "expected 3 numbers an element"),
        (r#", "COLOR_0": 99 }"#.to_owned(), false, "accessor 99 does not exist; expected a number from"),
        (r#", "COLOR_0": "x" }"#.to_owned(), false, "/meshes/0/primitives/0/attributes/COLOR_0: expected the number"),
        (format!(r#" }}, "indices": {positions}"#), false, "indices of a type that is not unsigned"),
        (r#" }, "indices": 99"#.to_owned(), true, "accessor 99 does not exist"),
        (r#" }, "indices": {}"#.to_owned(), true, "does not exist"),
        (format!(r#" }}, "indices": {empty}"#), true, "count is 0"),
        (r#" }, "mode": 99"#.to_owned(), true, "unknown mode"),
        (r#" }, "material": 5"#.to_owned(), false, "material 5 does not exist"),
        (r#" }, "targets": 1"#.to_owned(), false, "expected a list; left out"),
    ] {
        let primitive = format!(r#""attributes": {{ "POSITION": {positions}{rest}"#);
        if rest.contains(&format!("\"indices\": {positions}")) || rest.contains(&format!("\"indices\": {empty}")) {
            // More than one thing is odd about these.
            let scene = try_load(beside_a_good_one(&mut file, &primitive)).unwrap();
            assert!(warnings(&scene).iter().any(|told| told.contains(says)) || costs_all, "{:?}", warnings(&scene));
            continue;
        }
        damaged(&mut file, &primitive, costs_all, says);
    }
    damaged(&mut file, &format!(r#""attributes": {{ "POSITION": {wide} }}"#), false, "the first 3 are taken");
    for missing in [r#""attributes": { "POSITION": 99 }"#, r#""attributes": { "POSITION": 0.5 }"#] {
        let scene = try_load(beside_a_good_one(&mut file, missing)).unwrap();
        assert_eq!(scene.objects.len(), 1, "{missing}");
    }
    for nothing in [r#""attributes": {}"#, "", r#""attributes": { "POSITION": -1 }"#, r#""attributes": []"#] {
        let scene = try_load(beside_a_good_one(&mut file, nothing)).unwrap();
        assert_eq!(scene.objects.len(), 1, "{nothing}");
        assert!(warnings(&scene).iter().any(|told| told.contains("without POSITION")), "{nothing}");
    }
}

#[test]
fn vertices_that_are_not_there_cost_the_faces_that_name_them() {
    let mut file = File::default();
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let positions = file.vectors(&square);
    let mut damaged_square = square;
    damaged_square[3][1] = f32::NAN;
    let nan = file.vectors(&damaged_square);
    let (bad, good) = (file.indices(&[0, 1, 2, 0, 2, 4]), file.indices(&[0, 1, 2, 0, 2, 3]));
    let strip = file.indices(&[0, 1, 2, 65535]);
    for (primitive, says) in [
        (
            format!(r#""attributes": {{ "POSITION": {positions} }}, "indices": {bad}"#),
            "1 of 2 triangles have vertices that are not there",
        ),
        (
            format!(r#""attributes": {{ "POSITION": {nan} }}, "indices": {good}"#),
            "1 of 2 triangles have vertices that are not finite",
        ),
        (
            format!(r#""attributes": {{ "POSITION": {positions} }}, "indices": {strip}, "mode": 5"#),
            "1 of 2 triangles have",
        ),
    ] {
        let scene = damaged(&mut file, &primitive, false, says);
        assert_eq!(scene.geometry.indices(), 2, "{primitive}");
    }
}

#[test]
fn equal_faults_are_counted() {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let primitive = format!(r#"{{ "attributes": {{ "POSITION": {positions}, "NORMAL": 99 }} }}"#);
    let scene = file.load(&format!(
        r#""meshes": [{{ "primitives": [{primitive}, {primitive}, {primitive}] }}], "nodes": [{{ "mesh": 0 }}, {{ "mesh": 0 }}]"#
    ));
    let told = [
        "/meshes/0/primitives/0/attributes/NORMAL: 3 attributes left out: first accessor 99 does not exist; expected a number from 0 to 0",
    ];
    assert_eq!(warnings(&scene), told, "once for each primitive, however often it is drawn");
}

#[test]
fn what_is_no_gltf_is_refused() {
    for (text, says) in [
        ("{", "s.gltf:1:1: not valid JSON"),
        ("{}", "missing key \"asset\""),
        ("[]", "expected an object"),
        (r#"{ "asset": { "version": "1.0" } }"#, "(/asset/version): glTF version 1.0"),
        (r#"{ "asset": { "version": "2.0", "minVersion": "2.1" } }"#, "(/asset/minVersion): glTF version 2.1"),
        ("glTF", "not valid binary glTF"),
        ("{ \"asset\": { \"version\": \"2.0\" },\n \"nodes\": [,] }", "s.gltf:2:12: not valid JSON"),
    ] {
        let error = try_load(text).unwrap_err().to_string();
        assert!(error.contains(says), "{text}: {error}");
        assert!(!error.contains('\n'), "{error}");
    }
    let nested =
        format!(r#"{{ "asset": {{ "version": "2.0" }}, "extras": {}{} }}"#, "[".repeat(5000), "]".repeat(5000));
    assert!(try_load(nested).unwrap_err().to_string().contains("nesting"));
    let many = format!(r#"{{ "asset": {{}}, "skins": [0{}] }}"#, ",0".repeat(1 << 16));
    assert!(try_load(many).unwrap_err().to_string().contains("at most 65536 entries"));
    for extras in ["1", "\"x\"", "[[]]", "null"] {
        let text = format!(
            r#"{{ "asset": {{ "version": "2.0", "extras": {extras} }}, "nodes": [{{ "extras": {extras} }}] }}"#
        );
        assert!(try_load(text).is_ok(), "{extras}");
    }
}

#[test]
fn odd_json_is_read() {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let rest = format!(
        r#""meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions}.0 }}, "mode": 4.0, "indices": null }}] }}],
        "nodes": [{{ "mesh": 0e0, "scale": [1, "1", 1.0], "extras": NaN }}], "scene": -1, "cameras": 7, "images": null"#
    );
    let text = file.text(&rest);
    let utf16 = |unit: fn(u16) -> [u8; 2]| -> Vec<u8> {
        "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(unit).collect()
    };
    for bytes in [
        text.clone().into_bytes(),
        format!("\u{feff}{text}").into_bytes(),
        utf16(u16::to_le_bytes),
        utf16(u16::to_be_bytes),
        format!("{text}\0\0").into_bytes(),
    ] {
        let scene = try_load(&bytes).unwrap_or_else(|error| panic!("{error}"));
        let told = warnings(&scene);
        assert_eq!(scene.objects.len(), 1);
        for says in ["not JSON", "/scene: a number below 0", "/cameras: expected a list"] {
            assert!(told.iter().any(|told| told.contains(says)), "{told:?}");
        }
    }
    let named = text.replace(r#""extras": NaN"#, r#""name": "?""#);
    let latin: Vec<u8> = named.bytes().map(|byte| if byte == b'?' { 0xE9 } else { byte }).collect();
    let scene = try_load(latin).unwrap();
    assert_eq!(scene.objects[0].name.as_deref(), Some("\u{fffd}"));
    assert!(warnings(&scene)[0].contains("not UTF-8"));
}

#[test]
fn buffers_that_end_early_cost_what_lies_beyond() {
    let mut file = File::default();
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let indices = file.indices(&[0, 1, 2, 0, 2, 3]);
    let positions = file.vectors(&square);
    let rest = format!(
        r#""meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions} }}, "indices": {indices} }}] }}],
        "nodes": [{{ "mesh": 0 }}]"#
    );
    file.bytes.truncate(file.bytes.len() - 4);
    let scene = file.load(&rest);
    assert_eq!(scene.geometry.indices(), 1);
    for says in ["/bufferViews/1: 48 bytes", "/accessors/1/count: count is 4", "1 of 2 triangles have vertices"] {
        assert!(warnings(&scene).iter().any(|told| told.contains(says)), "{says}: {:?}", warnings(&scene));
    }
}

/// A file with a little of everything.
pub fn rich() -> (File, String) {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let uvs = file.vectors(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let normals = file.vectors(&[[0.0, 0.0, 1.0]; 3]);
    let indices = file.indices(&[0, 1, 2]);
    let places = file.view(&[1, 2], "");
    let values = file.view(&[0; 24], "");
    let sparse = file.accessor(format!(
        r#"{{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "sparse": {{ "count": 2,
        "indices": {{ "bufferView": {places}, "componentType": 5121 }}, "values": {{ "bufferView": {values} }} }} }}"#
    ));
    let weights = file.vectors(&[[1.0, 0.0, 0.0, 0.0]; 3]);
    let view = file.view(&[0; 12], "");
    let joints =
        file.accessor(format!(r#"{{ "bufferView": {view}, "componentType": 5121, "count": 3, "type": "VEC4" }}"#));
    let rest = format!(
        r#""scene": 0, "scenes": [{{ "nodes": [0, 1, 3, 4] }}],
        "nodes": [{{ "mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], "children": [2] }},
            {{ "mesh": 1, "skin": 0, "rotation": [0, 0, 0, 1], "scale": [1, 2, 1] }},
            {{ "camera": 0, "translation": [0, 0, 3] }},
            {{ "extensions": {{ "KHR_lights_punctual": {{ "light": 0 }} }} }},
            {{ "mesh": 0, "extensions": {{ "EXT_mesh_gpu_instancing": {{ "attributes": {{ "TRANSLATION": {positions} }} }} }} }}],
        "meshes": [{{ "weights": [0.5], "primitives": [{{ "attributes": {{ "POSITION": {positions}, "NORMAL": {normals},
                "TEXCOORD_0": {uvs} }}, "indices": {indices}, "material": 0, "targets": [{{ "POSITION": {sparse} }}] }}] }},
            {{ "primitives": [{{ "mode": 5, "attributes": {{ "POSITION": {sparse}, "JOINTS_0": {joints}, "WEIGHTS_0": {weights} }} }}] }}],
        "skins": [{{ "joints": [2] }}],
        "cameras": [{{ "type": "perspective", "perspective": {{ "yfov": 1, "znear": 0.1 }} }}],
        "extensions": {{ "KHR_lights_punctual": {{ "lights": [{{ "type": "spot", "spot": {{ "outerConeAngle": 1 }} }}] }} }},
        "materials": [{{ "alphaMode": "MASK", "normalTexture": {{ "index": 0 }}, "pbrMetallicRoughness": {{ "baseColorTexture":
            {{ "index": 0, "extensions": {{ "KHR_texture_transform": {{ "scale": [2, 2] }} }} }} }} }}],
        "textures": [{{ "source": 0, "sampler": 0 }}], "samplers": [{{ "wrapS": 33071 }}],
        "images": [{{ "uri": "data:image/png;base64,iVBORw0KGgo=" }}]"#
    );
    (file, rest)
}

#[test]
fn shortened_files_never_panic() {
    let folder = Folder::new();
    let (file, rest) = rich();
    let bytes = file.binary(&rest);
    for length in (0..bytes.len()).step_by(7) {
        assert!(load(&folder.write("s.glb", &bytes[..length]), &LoadOptions::default()).is_err(), "{length} bytes");
    }
}
