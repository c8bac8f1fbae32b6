//! Meshes that are stored once give the very pictures of meshes that are flattened.

use crate::flips::flipped;
use crate::gltf::file::File;
use crate::picture_bits::{PictureBits, render};
use crate::random::Random;
use crate::stress;
use crate::temporary::Folder;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use raywalk::measure::counts::SceneCounts;
use raywalk::scene::{Instancing, LoadOptions, Scene, load};
use raywalk::settings::{ROWS, Settings};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::path::Path;

/// Neither a multiple of a tile nor of a packet.
const SIZE: (u32, u32) = (71, 38);

fn loaded(path: &Path, instancing: Instancing) -> Scene {
    load(path, &LoadOptions { instancing, ..LoadOptions::default() }).unwrap_or_else(|error| panic!("{error}"))
}

/// Modes that approximate have to do so alike.
fn approximate() -> Vec<(String, Settings)> {
    let mut all = Vec::new();
    for (visibility, fill, supersample) in
        [("subsample", "hit", "off"), ("subsample", "color", "off"), ("certified", "hit", "adaptive")]
    {
        let mut settings = Settings::exact();
        for (name, value) in [("visibility", visibility), ("fill", fill), ("supersample", supersample)] {
            let row = ROWS.iter().find(|row| row.name == name).unwrap();
            (row.set)(&mut settings, value).unwrap();
        }
        all.push((format!("{visibility} {fill} {supersample}"), settings));
    }
    all
}

/// What differs between the pictures of a file stored in both ways.
pub fn differences(name: &str, path: &Path, cameras: usize, random: &mut Random) -> Vec<String> {
    let [flat, shared] = [Instancing::Never, Instancing::Always].map(|instancing| loaded(path, instancing));
    assert!(!shared.geometry.instances.is_empty() && flat.geometry.instances.is_empty(), "{name}");
    let counts = [&flat, &shared].map(|scene| {
        let SceneCounts { triangles, spheres, primitives, lights, objects, .. } = SceneCounts::of(scene);
        (triangles, spheres, primitives, lights, objects)
    });
    assert_eq!(counts[0], counts[1], "{name}");
    assert_eq!(flat.warnings.len(), shared.warnings.len(), "{name}");
    assert_eq!(flat.bounds(), shared.bounds(), "{name}");
    assert_eq!(flat.auto_exposure, shared.auto_exposure, "{name}");
    let primitives = [&flat, &shared]
        .map(|scene| (0..scene.objects.len() as u32).map(|object| scene.primitives_of(object)).collect::<Vec<_>>());
    assert_eq!(primitives[0], primitives[1], "{name}");
    let mut found = Vec::new();
    for (number, camera) in stress::cameras(&flat, cameras, random).iter().enumerate() {
        let ahead = (camera.look_at - camera.eye).normalize();
        for _ in 0..50 {
            let direction = (ahead + random.direction().as_vec3() * 0.5).normalize();
            let picks = [&flat, &shared].map(|scene| scene.pick(camera.eye, direction, camera.near));
            if picks[0] != picks[1] {
                found.push(format!("{name}, camera {number}, pick along {direction}: {picks:?}"));
            }
        }
        let expected = PictureBits::of(&render(&flat, camera, &Settings::exact(), SIZE));
        let plain = ("exact".to_owned(), Settings::exact());
        for (flip, settings) in [plain].into_iter().chain(flipped()) {
            let picture = PictureBits::of(&render(&shared, camera, &settings, SIZE));
            if let Some(difference) = expected.difference(&picture) {
                found.push(format!("{name}, camera {number}, {flip}: {difference}"));
            }
        }
        for (mode, settings) in approximate() {
            let [flat, shared] = [&flat, &shared].map(|scene| PictureBits::of(&render(scene, camera, &settings, SIZE)));
            if let Some(difference) = flat.difference(&shared) {
                found.push(format!("{name}, camera {number}, {mode}: {difference}"));
            }
        }
    }
    found
}

fn triple(v: DVec3) -> Value {
    json!(v.to_array())
}

/// A mesh as the file has it.
struct Shape {
    vertices: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
    smooth: bool,
}

impl Shape {
    /// A ball of flat facets.
    fn ball(around: usize, up: usize, smooth: bool) -> Self {
        let point = |i: usize, j: usize| {
            let (longitude, latitude) = (i as f64 / around as f64 * TAU, (j as f64 / up as f64 - 0.5) * TAU / 2.0);
            DVec3::new(longitude.cos() * latitude.cos(), latitude.sin(), longitude.sin() * latitude.cos())
        };
        let vertices = (0..=up).flat_map(|j| (0..around).map(move |i| point(i, j))).collect();
        let at = |i: usize, j: usize| j * around + i % around;
        let quad = |i: usize, j: usize| {
            [[at(i, j), at(i, j + 1), at(i + 1, j)], [at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]]
        };
        let triangles = (0..up).flat_map(|j| (0..around).flat_map(move |i| quad(i, j))).collect();
        Self { vertices, triangles, smooth }
    }

    /// A level floor of many squares.
    fn floor(side: usize) -> Self {
        let point =
            |i: usize, j: usize| DVec3::new(i as f64, 0.0, j as f64) * (2.0 / side as f64) - DVec3::new(1.0, 0.0, 1.0);
        let vertices = (0..=side).flat_map(|j| (0..=side).map(move |i| point(i, j))).collect();
        let at = |i: usize, j: usize| j * (side + 1) + i;
        let quad = |i: usize, j: usize| {
            [[at(i, j), at(i, j + 1), at(i + 1, j)], [at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]]
        };
        let triangles = (0..side).flat_map(|j| (0..side).flat_map(move |i| quad(i, j))).collect();
        Self { vertices, triangles, smooth: false }
    }

    /// Triangles anywhere, some of them needles, some without area.
    fn soup(count: usize, random: &mut Random) -> Self {
        let mut vertices = Vec::new();
        for _ in 0..count {
            let (a, along) = (random.point(1.0), random.direction());
            let width = random.magnitude(-6.0, 0.0);
            let b = if random.chance(0.05) { a + along } else { a + along * 0.5 + random.direction() * width };
            vertices.extend([a, b, a + along * 0.4]);
        }
        let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Self { vertices, triangles, smooth: false }
    }

    fn write(&self, material: &Value) -> Value {
        let normals: Vec<Value> =
            if self.smooth { self.vertices.iter().map(|v| triple(*v)).collect() } else { Vec::new() };
        let uvs: Vec<Value> = if self.smooth {
            self.vertices.iter().map(|v| json!([v.x * 3.0, v.y + v.z])).collect()
        } else {
            Vec::new()
        };
        let vertices: Vec<Value> = self.vertices.iter().map(|v| triple(*v)).collect();
        json!({
            "version": 1,
            "textures": { "squares": { "checker": [[0.9, 0.8, 0.7], [0.2, 0.3, 0.4]], "size": 0.25 } },
            "materials": { "own": material },
            "objects": [{ "type": "mesh", "vertices": vertices, "triangles": self.triangles, "normals": normals,
                "uvs": uvs, "material": "own" }],
        })
    }
}

/// A transform that may mirror, stretch and shear.
fn transform(random: &mut Random, spread: f64, magnitude: f64) -> Value {
    let turn =
        |random: &mut Random| DMat3::from_quat(DQuat::from_axis_angle(random.direction(), random.within(0.0, TAU)));
    let scale = |random: &mut Random, by: f64| {
        let mut along = || random.magnitude(-by, by) * random.sign();
        DMat3::from_diagonal(DVec3::new(along(), along(), along()))
    };
    let size = random.magnitude(-magnitude, magnitude);
    let matrix3 = turn(random) * scale(random, 0.3) * turn(random) * scale(random, 0.3) * size;
    let matrix = DAffine3 { matrix3, translation: random.point(spread) };
    json!({ "matrix": DMat4::from(matrix).to_cols_array() })
}

/// Writes a scene of models in groups, with other things between them. Sizes differ by `magnitude` powers of ten.
fn crowd(folder: &Folder, seed: u64, magnitude: f64, offset: DVec3) -> std::path::PathBuf {
    let mut random = Random::new(seed);
    let materials = [
        json!({ "color": [0.8, 0.4, 0.2], "specular": 0.3 }),
        json!({ "color": { "texture": "squares" }, "reflectivity": 0.3 }),
        json!({ "diffuse": 0.1, "specular": 0, "ambient": 0, "reflectivity": 0.9 }),
        json!({ "transparency": 1, "ior": 1.5, "ambient": 0, "diffuse": 0, "color": [0.9, 1, 0.95], "absorption": [0.1, 0.3, 0.5] }),
        json!({ "transparency": 0.6, "fresnel": false, "color": [0.7, 1, 0.8], "reflectivity": 0.2 }),
    ];
    let shapes = [
        Shape::ball(12, 8, true),
        Shape::ball(7, 5, false),
        Shape::floor(9),
        Shape::soup(120, &mut random),
        Shape::ball(3, 2, false),
    ];
    for (i, shape) in shapes.iter().enumerate() {
        let material = &materials[(i + seed as usize) % materials.len()];
        folder.write(&format!("{i}.json"), shape.write(material).to_string());
    }
    let mut objects = vec![
        json!({ "type": "plane", "point": triple(offset - DVec3::Y * 4.0), "normal": [0, 1, 0] }),
        json!({ "type": "box", "min": triple(offset - 0.5), "max": triple(offset + 0.5), "material": "plain" }),
    ];
    for _ in 0..14 {
        let file = format!("{}.json", random.below(shapes.len()));
        let inner = json!({ "type": "group", "transform": transform(&mut random, 0.5, 0.0),
            "children": [{ "type": "model", "file": file }] });
        objects.push(json!({ "type": "group", "transform": { "translate": triple(offset) }, "children": [
            { "type": "group", "transform": transform(&mut random, 3.0, magnitude), "children": [inner] }] }));
        if random.chance(0.4) {
            let center = triple(offset + random.point(3.0));
            objects.push(
                json!({ "type": "sphere", "center": center, "radius": random.within(0.1, 0.6), "material": "plain" }),
            );
        }
    }
    // Things that coincide: the first one in the file is seen.
    for _ in 0..2 {
        objects.push(json!({ "type": "group", "transform": { "translate": triple(offset), "scale": 2.5 },
            "children": [{ "type": "model", "file": "2.json" }] }));
        objects.push(json!({ "type": "rectangle", "corner": triple(offset - DVec3::new(1.0, 0.0, 1.0)),
            "edge_u": [2, 0, 0], "edge_v": [0, 0, 2], "material": "plain" }));
    }
    let scene = json!({
        "version": 1,
        "camera": { "position": triple(offset + DVec3::new(1.0, 2.0, 7.0)), "look_at": triple(offset), "fov": 55 },
        "materials": { "plain": { "color": [0.3, 0.6, 0.9], "reflectivity": 0.2 } },
        "lights": [
            { "type": "point", "position": triple(offset + DVec3::new(3.0, 6.0, 4.0)), "intensity": 0.7 },
            { "type": "directional", "direction": [-0.3, -1, -0.5], "intensity": 0.5 },
        ],
        "objects": objects,
    });
    folder.write("scene.json", scene.to_string())
}

fn seeds() -> u64 {
    if std::env::var_os("RAYWALK_LONG").is_some() { 40 } else { 1 }
}

#[test]
fn instances_are_seen_as_if_flattened() {
    let mut found = Vec::new();
    let far = DVec3::new(48_376.0, 1234.0, -23_423.0);
    for seed in 0..seeds() {
        let mut random = Random::new(seed);
        for (name, magnitude, offset) in [
            ("crowd", 0.3, DVec3::ZERO),
            ("huge and tiny", 3.0, DVec3::ZERO),
            ("far", 0.3, far),
            ("odd", 12.0, DVec3::ZERO),
        ] {
            let folder = Folder::new();
            let path = crowd(&folder, seed, magnitude, offset);
            found.extend(differences(&format!("{name} {seed}"), &path, 1, &mut random));
        }
    }
    assert!(found.is_empty(), "{} differ:\n{}", found.len(), found.join("\n"));
}

#[test]
fn what_corners_carry_is_moved_with_them() {
    let mut file = File::default();
    let ball = Shape::ball(9, 6, true);
    let positions: Vec<[f32; 3]> = ball.vertices.iter().map(|v| v.as_vec3().to_array()).collect();
    let uvs: Vec<[f32; 2]> = positions.iter().map(|[x, y, z]| [x + z, *y]).collect();
    let colors: Vec<[f32; 3]> = positions.iter().map(|p| p.map(|c| c * 0.5 + 0.5)).collect();
    let tangents: Vec<[f32; 4]> =
        positions.iter().map(|[x, _, z]| [*z, 0.0, -x, if *x > 0.0 { 1.0 } else { -1.0 }]).collect();
    let indices: Vec<u16> = ball.triangles.iter().flatten().map(|&i| i as u16).collect();
    let position = file.vectors(&positions);
    let (uv, color, tangent) = (file.vectors(&uvs), file.vectors(&colors), file.vectors(&tangents));
    let index = file.indices(&indices);
    let places = [[0.0, 0.0, 0.0], [2.5, 0.5, 0.0], [-2.5, -0.5, 1.0]];
    let (translation, scale) =
        (file.vectors(&places), file.vectors(&[[1.0, 1.0, 1.0], [1.0, -0.7, 1.2], [0.5, 1.0, -1.0]]));
    let rest = format!(
        r#""materials": [{{ "normalTexture": {{ "index": 0 }}, "doubleSided": true }},
            {{ "pbrMetallicRoughness": {{ "roughnessFactor": 0.05 }} }}],
        "textures": [{{ "source": 0 }}], "images": [{{ "uri": "bumps.png" }}],
        "meshes": [{{ "primitives": [
            {{ "attributes": {{ "POSITION": {position}, "NORMAL": {position}, "TEXCOORD_0": {uv}, "COLOR_0": {color},
                "TANGENT": {tangent} }}, "indices": {index}, "material": 0 }},
            {{ "attributes": {{ "POSITION": {position} }}, "indices": {index}, "material": 1 }}] }}],
        "extensionsUsed": ["EXT_mesh_gpu_instancing"],
        "nodes": [
            {{ "mesh": 0, "translation": [0, 0, 0], "extensions": {{ "EXT_mesh_gpu_instancing": {{ "attributes":
                {{ "TRANSLATION": {translation}, "SCALE": {scale} }} }} }} }},
            {{ "mesh": 0, "translation": [0, 2.5, 0], "scale": [-1, 0.5, 2] }},
            {{ "mesh": 0, "matrix": [1, 0.4, 0, 0, 0, 1, 0.3, 0, 0.2, 0, 1, 0, 1, -2.5, 0, 1] }}],
        "scenes": [{{ "nodes": [0, 1, 2] }}], "scene": 0"#
    );
    let folder = Folder::new();
    let texels: Vec<u8> = (0..48).map(|i| (i * 37 % 120 + 100) as u8).collect();
    image::save_buffer(folder.write("bumps.png", ""), &texels, 4, 4, image::ExtendedColorType::Rgb8).unwrap();
    let path = folder.write("scene.gltf", file.text(&rest));
    let found = differences("carrying", &path, 4, &mut Random::new(7));
    assert!(found.is_empty(), "{} differ:\n{}", found.len(), found.join("\n"));
}

/// A model of `triangles` triangles at `places` places.
fn forest(folder: &Folder, triangles: usize, places: usize) -> std::path::PathBuf {
    let side = ((triangles / 2) as f64).sqrt() as usize;
    folder.write("tree.json", Shape::ball(side, side, true).write(&json!({ "color": [0.4, 0.7, 0.3] })).to_string());
    let place = |i: usize| {
        let at = json!([(i % 50) as f64 * 3.0, 0, (i / 50) as f64 * 3.0]);
        json!({ "type": "group", "transform": { "translate": at, "rotate": [0, i, 0], "scale": 1.0 + (i % 7) as f64 * 0.05 },
            "children": [{ "type": "model", "file": "tree.json" }] })
    };
    let objects: Vec<Value> = (0..places).map(place).collect();
    folder.write("forest.json", json!({ "version": 1, "objects": objects }).to_string())
}

#[test]
fn meshes_are_stored_once_where_that_saves_memory() {
    let folder = Folder::new();
    let path = forest(&folder, 5000, 600);
    let scene = loaded(&path, Instancing::WhenItPays);
    assert_eq!((scene.geometry.instances.meshes.len(), scene.geometry.instances.placed.len()), (1, 600));
    let counts = SceneCounts::of(&scene);
    assert!(counts.triangles > 2_000_000 && counts.scene_bytes < 10_000_000, "{counts:?}");
    // The limit counts what is stored.
    let mut options = LoadOptions::default();
    options.limits.set("primitives", "6000").unwrap();
    assert!(load(&path, &options).is_ok());
    options.limits.set("primitives", "4000").unwrap();
    let error = load(&path, &options).unwrap_err().to_string();
    assert!(error.contains("limit primitives of 4000"), "{error}");
    let few = forest(&folder, 5000, 100);
    assert!(loaded(&few, Instancing::WhenItPays).geometry.instances.is_empty());
}
