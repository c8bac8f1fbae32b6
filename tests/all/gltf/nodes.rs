//! The tree of nodes: transforms, instances, odd trees.

use super::file::{CORNERS, File, triangle, try_load, warnings};
use glam::Vec3;
use raywalk::scene::start::Entry;
use raywalk::scene::{LoadOptions, Scene, load};

const PLAIN: &str = r#""materials": [{}]"#;

fn max(scene: &Scene) -> Vec3 {
    scene.bounds().max
}

#[test]
fn matrices_and_trs_place_alike() {
    // Twice as large, turned by a quarter about z, moved by (1, 2, 3).
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let trs = format!(r#""translation": [1, 2, 3], "rotation": [0, 0, {half}, {half}], "scale": [2, 2, 2]"#);
    let matrix = r#""matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1]"#;
    for keys in [&trs, matrix] {
        let scene = triangle(&format!(r#"{PLAIN}, "nodes": [{{ "mesh": 0, {keys} }}]"#));
        let bounds = scene.bounds();
        assert!(bounds.min.abs_diff_eq(Vec3::new(-1.0, 2.0, 3.0), 1e-6), "{bounds:?}");
        assert!(bounds.max.abs_diff_eq(Vec3::new(1.0, 4.0, 3.0), 1e-6), "{bounds:?}");
    }
}

#[test]
fn children_stand_within_their_parents_and_objects_follow_the_file() {
    let scene = triangle(&format!(
        r#"{PLAIN}, "scene": 1, "scenes": [{{}}, {{ "nodes": [2, 0] }}], "nodes": [
        {{ "name": "a", "mesh": 0, "children": [1], "translation": [10, 0, 0] }},
        {{ "name": "b", "mesh": 0, "scale": [2, 1, 1] }}, {{ "name": "c", "mesh": 0 }}, {{ "name": "unused", "mesh": 0 }}]"#
    ));
    let names: Vec<_> = scene.objects.iter().map(|object| object.name.as_deref().unwrap_or("")).collect();
    assert_eq!(names, ["c", "a", "b"]);
    assert_eq!(scene.objects.iter().map(|object| object.bounds.max.x).collect::<Vec<_>>(), [1.0, 11.0, 12.0]);
}

#[test]
fn a_scale_of_zero_draws_flat() {
    for (scale, plane) in [([1, 1, 0], 2), ([1, 0, 1], 1), ([0, 1, 1], 0)] {
        let mut file = File::default();
        let positions = file.vectors(&[[0.0; 3], [1.0, 0.0, 0.5], [0.0, 1.0, 0.25]]);
        let normals = file.vectors(&[[0.0, 0.6, 0.8]; 3]);
        let scene = file.load(&format!(
            r#""meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions}, "NORMAL": {normals} }} }}] }}],
            "nodes": [{{ "mesh": 0, "scale": {scale:?}, "translation": [2, 2, 2] }}, {{ "mesh": 0 }}]"#
        ));
        assert_eq!(warnings(&scene), ["/nodes/0: the node's scale is 0 along an axis; it is drawn flat"]);
        let [flat, whole] = &*scene.objects else { panic!("two objects") };
        assert_eq!((flat.bounds.min[plane], flat.bounds.max[plane]), (2.0, 2.0));
        assert!(flat.bounds.max.max_element() == 3.0 && whole.bounds.max == Vec3::new(1.0, 1.0, 0.5));
        assert_eq!(scene.geometry.indices(), 2);
    }
    let nothing = triangle(&format!(r#"{PLAIN}, "nodes": [{{ "mesh": 0, "scale": [1, 0, 0] }}, {{ "mesh": 0 }}]"#));
    assert!(warnings(&nothing).iter().any(|warning| warning.contains("triangles without area")));
}

#[test]
fn what_is_odd_about_a_node_costs_no_other() {
    for (node, says) in [
        (r#"{ "mesh": 0, "translation": [1e39, 0, 0] }"#, "/nodes/0/translation: a transform that is not finite"),
        (r#"{ "mesh": 0, "matrix": [1, 0] }"#, "/nodes/0/matrix: expected a list of 16 numbers; left out"),
        (r#"{ "mesh": 0, "scale": [1, 1, 1, 1] }"#, "/nodes/0/scale: more than 3 numbers"),
        (r#"{ "mesh": 0, "rotation": null }"#, ""),
        (r#"{ "mesh": 0.0, "camera": -1 }"#, "/nodes/0/camera: a number below 0 is taken as none"),
        (r#"{ "mesh": "0", "skin": 7 }"#, "/nodes/0/skin: skin 7 does not exist"),
        (r#"{ "mesh": 0, "children": [7, "x"] }"#, "/nodes/0/children/0: node 7 does not exist"),
        (r#"{ "mesh": 0, "children": [1, "x"] }"#, "/nodes/0/children/1: expected the number of an entry; left out"),
        (r#"{ "mesh": 0, "name": 7, "children": 1 }"#, "/nodes/0/children: expected a list; left out"),
        (r#"{ "mesh": 0, "extensions": { "KHR_lights_punctual": {} } }"#, "expected an object with light"),
    ] {
        let scene = triangle(&format!(r#"{PLAIN}, "nodes": [{node}, {{}}]"#));
        assert_eq!(scene.objects.len(), 1, "{node}");
        let told = warnings(&scene);
        let is_told = if says.is_empty() { told.is_empty() } else { told.iter().any(|told| told.contains(says)) };
        assert!(is_told, "{node}: {told:?}");
    }
    let far = r#"{ "mesh": 0, "scale": [1e30, 1, 1], "children": [1] }, { "mesh": 0, "scale": [1e30, 1, 1] }"#;
    let scene = triangle(&format!(r#"{PLAIN}, "nodes": [{far}]"#));
    assert_eq!(
        (scene.objects.len(), &*warnings(&scene)[0]),
        (1, "/nodes/1: in the world, the mesh of the node reaches beyond 3.4e38; left out")
    );
    let none = triangle(&format!(r#"{PLAIN}, "nodes": [7, null, {{ "mesh": 0 }}, {{ "mesh": 9 }}], "scene": 3"#));
    assert_eq!(none.objects.len(), 1);
    for pointer in
        ["/scene: scene 3", "/nodes/0: damaged: expected an object", "/nodes/1: null", "/nodes/3/mesh: mesh 9"]
    {
        assert!(warnings(&none).iter().any(|told| told.starts_with(pointer)), "{pointer}: {:?}", warnings(&none));
    }
}

#[test]
fn nodes_in_circles_and_with_two_parents_are_entered_once() {
    for (nodes, objects, pointer) in [
        (r#"[{ "mesh": 0, "children": [0] }]"#, 1, "/nodes/0/children/0"),
        (r#"[{ "mesh": 0, "children": [1] }, { "children": [0] }]"#, 1, "/nodes/1/children/0"),
        (r#"[{ "children": [1, 1] }, { "mesh": 0 }]"#, 1, "/nodes/0/children/1"),
        (r#"[{ "children": [2] }, { "children": [2] }, { "mesh": 0 }]"#, 1, "/nodes/1/children/0"),
    ] {
        let scene = triangle(&format!(r#"{PLAIN}, "nodes": {nodes}"#));
        assert_eq!(scene.objects.len(), objects, "{nodes}");
        if !pointer.is_empty() {
            assert!(warnings(&scene)[0].starts_with(pointer), "{nodes}");
        }
        let scene = triangle(&format!(r#"{PLAIN}, "nodes": {nodes}, "scenes": [{{ "nodes": [0] }}]"#));
        assert!(scene.objects.len() <= 1, "{nodes}");
    }
}

#[test]
fn a_chain_of_a_hundred_thousand_nodes_needs_no_stack() {
    let count = 100_000;
    let links = (1..count).map(|next| format!(r#"{{ "children": [{next}] }}"#)).collect::<Vec<_>>().join(", ");
    let nodes = format!(r#"{PLAIN}, "nodes": [{links}, {{ "mesh": 0 }}]"#);
    assert_eq!(triangle(&nodes).objects.len(), 1);
}

#[test]
fn a_node_draws_as_many_instances_as_it_says() {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let moves = file.vectors(&[[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, 9.0]]);
    let scales = file.vectors(&[[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [1.0, 1.0, 1.0]]);
    let rest = format!(
        r#""extensionsUsed": ["EXT_mesh_gpu_instancing"], "extensionsRequired": ["EXT_mesh_gpu_instancing"],
        "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions} }} }}] }}],
        "nodes": [{{ "mesh": 0, "translation": [100, 0, 0], "extensions": {{ "EXT_mesh_gpu_instancing":
            {{ "attributes": {{ "TRANSLATION": {moves}, "SCALE": {scales} }} }} }} }}]"#
    );
    let scene = file.load(&rest);
    assert!(scene.warnings.is_empty());
    assert_eq!(scene.objects.len(), 3);
    assert_eq!(max(&scene), Vec3::new(107.0, 1.0, 9.0));
}

#[test]
fn limits_hold_and_are_named() {
    let folder = crate::temporary::Folder::new();
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let rest = format!(
        r#""meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions} }} }}] }}],
        "nodes": [{{ "mesh": 0 }}, {{ "mesh": 0 }}, {{ "mesh": 0 }}]"#
    );
    let path = folder.write("s.glb", file.binary(&rest));
    assert_eq!(load(&path, &LoadOptions::default()).unwrap().objects.len(), 3);
    for (limit, value) in [("nodes", 2), ("objects", 2), ("primitives", 2), ("vertices", 2), ("file-bytes", 100)] {
        let mut options = LoadOptions::default();
        options.limits.set(limit, &value.to_string()).unwrap();
        let error = load(&path, &options).unwrap_err().to_string();
        assert!(error.contains(&format!("limit {limit} of {value}")), "{error}");
    }
}

#[test]
fn text_and_binary_say_the_same() {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let rest = format!(
        r#""meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions} }} }}] }}], "nodes": [{{ "mesh": 0 }}]"#
    );
    let bounds = [file.text(&rest).into_bytes(), file.binary(&rest)].map(|bytes| try_load(bytes).unwrap().bounds());
    assert_eq!(bounds[0], bounds[1]);
}

#[test]
fn buffers_lie_in_files_beside_and_nowhere_else() {
    let folder = crate::temporary::Folder::new();
    let bytes: Vec<u8> = CORNERS.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    folder.write("in/data dir/a.bin", &bytes);
    folder.write("out.bin", &bytes);
    let text = |uri: &str| {
        format!(
            r#"{{ "asset": {{ "version": "2.0" }}, "buffers": [{{ "byteLength": 36, "uri": "{uri}" }}],
            "bufferViews": [{{ "buffer": 0, "byteLength": 36 }}],
            "accessors": [{{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }}],
            "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0 }} }}] }}], "nodes": [{{ "mesh": 0 }}] }}"#
        )
    };
    let read = |uri: &str| load(&folder.write("in/s.gltf", text(uri)), &LoadOptions::default());
    assert!(read("data%20dir/a.bin").is_ok() && read("data dir/../data dir/a.bin").is_ok());
    for uri in
        ["../out.bin", "%2e%2e%2fout.bin", "/etc/passwd", "file:///etc/passwd", "http://a/b", "none.bin", "%FF", "data"]
    {
        let error = read(uri).unwrap_err().to_string();
        assert!(error.contains("(/buffers/0)"), "{uri}: {error}");
    }
}

/// A floor of 40 m with a wall in front and with the given nodes besides.
fn yard(nodes: &str) -> Scene {
    let mut file = File::default();
    let corners = [
        [-20.0, 0.0, 20.0],
        [20.0, 0.0, 20.0],
        [20.0, 0.0, -20.0],
        [-20.0, 0.0, -20.0],
        [20.0, 4.0, -20.0],
        [-20.0, 4.0, -20.0],
    ];
    let positions = file.vectors(&corners);
    let indices = file.indices(&[0, 1, 2, 0, 2, 3, 3, 2, 4, 3, 4, 5]);
    file.load(&format!(
        r#""extensionsUsed": ["OMI_spawn_point"], "materials": [{{ "doubleSided": true }}],
        "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions} }}, "indices": {indices}, "material": 0 }}] }}],
        "nodes": [{{ "mesh": 0 }}, {nodes}]"#
    ))
}

#[test]
fn spawn_points_are_known_by_extension_and_by_name() {
    let named = r#"{ "name": "Player_Spawn", "translation": [3, 0.2, -8], "rotation": [0, 1, 0, 0] }"#;
    let marked = r#"{ "name": "here", "translation": [-5, 2, 6], "rotation": [0, 0.70710678, 0, 0.70710678],
        "extensions": { "OMI_spawn_point": { "title": "Gate", "team": "Red" } } }"#;
    let others = r#"{ "name": "enemy-spawn", "translation": [9, 0, 9] }, { "name": "spawner" }"#;
    for (nodes, name, eye, forward) in [
        (format!("{others}, {named}"), "Player_Spawn", Vec3::new(3.0, 1.6, -8.0), Vec3::NEG_Z),
        (format!("{named}, {others}, {marked}"), "here", Vec3::new(-5.0, 1.6, 6.0), Vec3::X),
    ] {
        let scene = yard(&nodes);
        let camera = scene.cameras[0].camera;
        assert_eq!(scene.start.entry, Entry::Spawn(name.to_owned()));
        assert!(scene.on_foot() && camera.eye.abs_diff_eq(eye, 1e-3), "{}", camera.eye);
        assert!(camera.frame(4, 4).forward.abs_diff_eq(forward, 1e-3), "{}", camera.frame(4, 4).forward);
        assert!(warnings(&scene).is_empty(), "{:?}", warnings(&scene));
    }
    let beside = yard(others);
    assert!(!matches!(beside.start.entry, Entry::Spawn(_)), "{}", beside.start);
}

#[test]
fn a_camera_wins_over_a_spawn_point_and_odd_spawn_points_do_no_harm() {
    let scene = triangle(&format!(
        r#"{PLAIN}, "cameras": [{{ "type": "perspective", "perspective": {{ "yfov": 1, "znear": 0.1 }} }}],
        "nodes": [{{ "mesh": 0 }}, {{ "name": "spawn" }}, {{ "camera": 0, "translation": [0, 0, 5] }}]"#
    ));
    assert_eq!((scene.cameras[0].camera.eye.z, &scene.start.entry), (5.0, &Entry::Camera));
    for keys in [
        r#""scale": [0, 0, 0], "translation": [0, 3e38, 0]"#,
        r#""extensions": { "OMI_spawn_point": null }"#,
        r#""extensions": { "OMI_spawn_point": { "title": 7 } }, "translation": [1e30, 0, 0]"#,
        r#""rotation": [0.70710678, 0, 0, 0.70710678]"#,
    ] {
        let scene = triangle(&format!(r#"{PLAIN}, "nodes": [{{ "mesh": 0 }}, {{ "name": "spawn", {keys} }}]"#));
        assert!(scene.cameras[0].camera.is_valid(), "{keys}");
    }
}
