//! Wrong glTF files: every one gives an error that names its place; none a panic.

use super::file::{CORNERS, File, try_load};
use crate::temporary::Folder;
use raywalk::scene::{LoadOptions, load};

/// What a mesh of one primitive over the accessors of `file` fails with.
fn error(file: &File, primitive: &str) -> String {
    let rest = format!(r#""nodes": [{{ "mesh": 0 }}], "meshes": [{{ "primitives": [{{ {primitive} }}] }}]"#);
    match try_load(file.text(&rest)) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("{primitive} is accepted"),
    }
}

/// Checks the error of a POSITION accessor that is written `accessor`, over a view of 36 bytes.
fn position(accessor: &str, pointer: &str, says: &str) {
    let mut file = File::default();
    file.vectors(&CORNERS);
    file.view(&[0; 40], r#", "byteStride": 4"#);
    let number = file.accessor(accessor.to_owned());
    let error = error(&file, &format!(r#""attributes": {{ "POSITION": {number} }}"#));
    assert!(error.contains(&format!("({pointer})")) && error.contains(says), "{accessor}: {error}");
}

#[test]
fn accessors_that_do_not_fit_their_bytes_are_refused() {
    let plain = r#""componentType": 5126, "type": "VEC3""#;
    for (count, says) in [
        ("0", "count is 0"),
        ("4", "reach beyond buffer view 0"),
        ("1000000000000", "reach beyond buffer view 0"),
        ("4611686018427387904", "reach beyond buffer view 0"),
    ] {
        let pointer = if says.starts_with("reach") { "/accessors/1/bufferView" } else { "/accessors/1/count" };
        position(&format!(r#"{{ "bufferView": 0, "count": {count}, {plain} }}"#), pointer, says);
    }
    for offset in ["12", "18446744073709551608"] {
        let accessor = format!(r#"{{ "bufferView": 0, "byteOffset": {offset}, "count": 3, {plain} }}"#);
        position(&accessor, "/accessors/1/bufferView", "reach beyond");
    }
    position(&format!(r#"{{ "bufferView": 1, "count": 3, {plain} }}"#), "/bufferViews/1/byteStride", "less than");
    position(&format!(r#"{{ "bufferView": 7, "count": 3, {plain} }}"#), "/accessors/1/bufferView", "does not exist");
    position(&format!(r#"{{ "count": 50000000, {plain} }}"#), "/accessors/1/count", "without a bufferView");
    // Of many that may be read alone, too.
    let mut file = File::default();
    let zeros = file.accessor(format!(r#"{{ "count": 3000000, {plain} }}"#));
    let twice = error(&file, &format!(r#""attributes": {{ "POSITION": {zeros}, "NORMAL": {zeros} }}"#));
    assert!(twice.contains("(/accessors/0/count)") && twice.contains("in the whole file"), "{twice}");
    let scalar = r#"{ "bufferView": 0, "count": 3, "componentType": 5126, "type": "SCALAR" }"#;
    position(scalar, "/accessors/1/type", "expected 3 numbers");
    let unknown = r#"{ "bufferView": 0, "count": 3, "componentType": 5124, "type": "VEC3" }"#;
    position(unknown, "/accessors/1/componentType", "unknown componentType");
    position(
        &format!(
            r#"{{ "count": 3, {plain}, "sparse": {{ "count": 1, "values": {{ "bufferView": 0 }},
            "indices": {{ "bufferView": 0, "byteOffset": 14, "componentType": 5121 }} }} }}"#
        ),
        "/accessors/1/sparse/indices",
        "names none of the 3",
    );
    position(
        &format!(
            r#"{{ "count": 3, {plain}, "sparse": {{ "count": 900719925474099, "values": {{ "bufferView": 0 }},
            "indices": {{ "bufferView": 0, "componentType": 5121 }} }} }}"#
        ),
        "/accessors/1/sparse/indices",
        "reach beyond",
    );
}

#[test]
fn attributes_that_do_not_fit_together_are_refused() {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let two = file.vectors(&[[0.0, 0.0, 1.0]; 2]);
    let odd = file.vectors(&[[f32::NAN, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
    let indices = file.indices(&[0, 1, 3]);
    for (primitive, says) in [
        (format!(r#""attributes": {{ "POSITION": {positions}, "NORMAL": {two} }}"#), "one entry a vertex (3), found 2"),
        (format!(r#""attributes": {{ "POSITION": {odd} }}"#), "must be finite"),
        (format!(r#""attributes": {{ "POSITION": {positions} }}, "indices": {indices}"#), "index 3 at place 2"),
        (
            format!(r#""attributes": {{ "POSITION": {positions} }}, "indices": {positions}"#),
            "expected an unsigned type",
        ),
        (format!(r#""attributes": {{ "POSITION": {positions} }}, "mode": 99"#), "unknown mode"),
        (format!(r#""attributes": {{ "POSITION": {positions} }}, "material": 0"#), "material 0 does not exist"),
        (r#""attributes": { "POSITION": 99 }"#.to_owned(), "accessor 99 does not exist"),
        (r#""attributes": { "POSITION": -1 }"#.to_owned(), "not valid glTF"),
    ] {
        let error = error(&file, &primitive);
        assert!(error.contains("/meshes/0/primitives/0") || error.contains("/accessors/"), "{error}");
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn wrong_json_names_its_line_and_pointer() {
    for (text, says) in [
        ("{", "not valid JSON"),
        ("{}", "missing field `asset`"),
        (r#"{ "asset": { "version": "1.0" } }"#, "(/asset/version): glTF version 1.0"),
        ("{ \"asset\": { \"version\": \"2.0\" },\n \"nodes\": [{ \"mesh\": \"x\" }] }", "s.gltf:2:24 (/nodes/0/mesh)"),
        (r#"{ "asset": { "version": "2.0" }, "scene": 3 }"#, "(/scene): scene 3 does not exist"),
        (r#"{ "asset": { "version": "2.0" }, "nodes": [{ "scale": [1e39, 1, 1] }] }"#, "(/nodes/0)"),
        (r#"{ "asset": { "version": "2.0" }, "nodes": [{ "children": [1] }] }"#, "(/nodes/0/children/0)"),
        ("glTF", "not valid binary glTF"),
    ] {
        let error = try_load(text).unwrap_err().to_string();
        assert!(error.contains(says), "{text}: {error}");
        assert!(!error.contains('\n'), "{error}");
    }
    let nested =
        format!(r#"{{ "asset": {{ "version": "2.0" }}, "extras": {}{} }}"#, "[".repeat(5000), "]".repeat(5000));
    assert!(try_load(nested).unwrap_err().to_string().contains("nesting"));
    for extras in ["1", "\"x\"", "[[]]", "null"] {
        let text = format!(
            r#"{{ "asset": {{ "version": "2.0", "extras": {extras} }}, "nodes": [{{ "extras": {extras} }}] }}"#
        );
        assert!(try_load(text).is_ok(), "{extras}");
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
