//! Surfaces that are seen from their front only: `doubleSided` false.

use super::file::{File, in_its_own_light, triangle};
use crate::exactness::wrong_pixels;
use crate::instancing::differences;
use crate::picture_bits::render;
use crate::random::Random;
use crate::stress;
use crate::temporary::Folder;
use glam::Vec3;
use raywalk::scene::{Camera, Scene, load};
use raywalk::settings::Settings;
use std::f32::consts::TAU;

/// Materials by index, the first six one-sided as glTF has it by default.
const MATERIALS: &str = r#"
    { "name": "ball", "pbrMetallicRoughness": { "baseColorFactor": [0.8, 0.3, 0.2, 1], "metallicFactor": 0 } },
    { "name": "wall", "pbrMetallicRoughness": { "baseColorFactor": [0.6, 0.7, 0.8, 1], "metallicFactor": 0 } },
    { "name": "shell", "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.1, 1], "metallicFactor": 0.5 } },
    { "name": "mirror", "pbrMetallicRoughness": { "baseColorFactor": [0.9, 0.9, 0.9, 1], "roughnessFactor": 0.02 } },
    { "name": "leaf", "alphaMode": "MASK", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0 } },
    { "name": "veil", "alphaMode": "BLEND", "pbrMetallicRoughness": { "baseColorFactor": [0.3, 0.3, 0.9, 0.5], "metallicFactor": 0 } },
    { "name": "glass", "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 },
        "KHR_materials_volume": { "thicknessFactor": 1 } }, "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 } },
    { "name": "sheet", "doubleSided": true, "pbrMetallicRoughness": { "baseColorFactor": [0.7, 0.6, 0.3, 1], "metallicFactor": 0 } }"#;

const BALL: usize = 0;
const WALL: usize = 1;
const SHELL: usize = 2;
const MIRROR: usize = 3;
const LEAF: usize = 4;
const VEIL: usize = 5;
const GLASS: usize = 6;
const SHEET: usize = 7;

/// A file of a ball, the ball turned inside out, a box, the box turned inside out, and a square, each in some materials.
struct Shapes {
    file: File,
    meshes: Vec<String>,
    nodes: Vec<String>,
}

impl Shapes {
    fn new() -> Self {
        Self { file: File::default(), meshes: Vec::new(), nodes: Vec::new() }
    }

    /// Adds a mesh of faces that wind counter-clockwise seen from outside, or from inside if it is turned; gives its number.
    fn mesh(&mut self, positions: &[[f32; 3]], faces: &[[u16; 3]], turned: bool, material: usize) -> usize {
        let faces: Vec<u16> = faces.iter().flat_map(|&[a, b, c]| if turned { [a, c, b] } else { [a, b, c] }).collect();
        let uvs: Vec<[f32; 2]> = positions.iter().map(|[x, y, _]| [x * 0.5 + 0.5, y * 0.5 + 0.5]).collect();
        let (position, uv) = (self.file.vectors(positions), self.file.vectors(&uvs));
        let indices = self.file.indices(&faces);
        self.meshes.push(format!(
            r#"{{ "primitives": [{{ "attributes": {{ "POSITION": {position}, "TEXCOORD_0": {uv} }},
                "indices": {indices}, "material": {material} }}] }}"#
        ));
        self.meshes.len() - 1
    }

    fn ball(&mut self, turned: bool, material: usize) -> usize {
        const AROUND: usize = 11;
        const UP: usize = 6;
        let point = |i: usize, j: usize| {
            let (longitude, latitude) = (i as f32 / AROUND as f32 * TAU, (j as f32 / UP as f32 - 0.5) * TAU / 2.0);
            [longitude.cos() * latitude.cos(), latitude.sin(), longitude.sin() * latitude.cos()]
        };
        let points: Vec<_> = (0..=UP).flat_map(|j| (0..AROUND).map(move |i| point(i, j))).collect();
        let at = |i: usize, j: usize| (j * AROUND + i % AROUND) as u16;
        let quad = |i: usize, j: usize| {
            [[at(i, j), at(i, j + 1), at(i + 1, j)], [at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]]
        };
        let faces: Vec<_> = (0..UP).flat_map(|j| (0..AROUND).flat_map(move |i| quad(i, j))).collect();
        self.mesh(&points, &faces, turned, material)
    }

    fn cube(&mut self, turned: bool, material: usize) -> usize {
        let side = |i: usize, bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let corners: Vec<_> = (0..8).map(|i| [side(i, 0), side(i, 1), side(i, 2)]).collect();
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let faces: Vec<_> = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        self.mesh(&corners, &faces, turned, material)
    }

    /// A square that faces +z.
    fn square(&mut self, material: usize) -> usize {
        let corners = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
        self.mesh(&corners, &[[0, 1, 2], [0, 2, 3]], false, material)
    }

    fn node(&mut self, mesh: usize, place: &str) {
        self.nodes.push(format!(r#"{{ "mesh": {mesh}, {place} }}"#));
    }

    fn camera(&mut self, place: &str) {
        self.nodes.push(format!(r#"{{ "camera": 0, {place} }}"#));
    }

    /// The file's text; a lamp and the sun light it.
    fn text(mut self) -> String {
        let leaf: Vec<u8> = (0..16_u8).flat_map(|i| [40, 160, 60, if i % 3 == 0 { 0 } else { 255 }]).collect();
        let mut png = std::io::Cursor::new(Vec::new());
        image::write_buffer_with_format(
            &mut png,
            &leaf,
            4,
            4,
            image::ExtendedColorType::Rgba8,
            image::ImageFormat::Png,
        )
        .unwrap();
        let view = self.file.view(png.get_ref(), "");
        for (light, place) in [(0, r#""translation": [3, 6, 5]"#), (1, r#""rotation": [-0.6, 0.2, 0, 0.77]"#)] {
            self.nodes
                .push(format!(r#"{{ {place}, "extensions": {{ "KHR_lights_punctual": {{ "light": {light} }} }} }}"#));
        }
        self.file.text(&format!(
            r#""materials": [{MATERIALS}], "textures": [{{ "source": 0 }}],
            "images": [{{ "bufferView": {view}, "mimeType": "image/png" }}],
            "meshes": [{}], "nodes": [{}], "cameras": [{{ "type": "perspective", "perspective": {{ "yfov": 0.9, "znear": 0.01 }} }}],
            "extensionsUsed": ["EXT_mesh_gpu_instancing"],
            "extensions": {{ "KHR_lights_punctual": {{ "lights": [
                {{ "type": "point", "intensity": 60 }}, {{ "type": "directional", "intensity": 1.5 }}] }} }}"#,
            self.meshes.join(", "),
            self.nodes.join(", ")
        ))
    }
}

/// What needs no blending: closed balls, one in an outline shell, a doll's house whose walls face in, one that is mirrored,
/// a mirror that would show backs, glass in front of backs, a sheet.
fn plain_shapes() -> Shapes {
    let mut shapes = Shapes::new();
    let (ball, shell, room, thing) =
        (shapes.ball(false, BALL), shapes.ball(true, SHELL), shapes.cube(true, WALL), shapes.cube(false, BALL));
    shapes.node(ball, r#""translation": [-2.5, 0, 0]"#);
    shapes.node(shell, r#""translation": [-2.5, 0, 0], "scale": [1.1, 1.1, 1.1]"#);
    for (x, mirrored) in [(0.0, 1.0), (3.0, -1.0)] {
        shapes.node(room, &format!(r#""translation": [{x}, 0, 0], "scale": [{mirrored}, 1, 1.2]"#));
        shapes.node(thing, &format!(r#""translation": [{x}, -0.6, 0.1], "scale": [0.4, {mirrored}, 0.4]"#));
    }
    let (mirror, glass, wall, sheet) =
        (shapes.square(MIRROR), shapes.cube(false, GLASS), shapes.square(WALL), shapes.square(SHEET));
    shapes.node(mirror, r#""translation": [0.5, 0, -3], "scale": [4, 2, 1]"#);
    shapes.node(wall, r#""translation": [1.5, 0.3, -2.6]"#);
    shapes.node(wall, r#""translation": [-1.5, 0.3, -2.4], "rotation": [0, 1, 0, 0], "scale": [0.6, 0.8, 1]"#);
    shapes.node(glass, r#""translation": [-2.4, 0, 2.4], "scale": [0.5, 0.9, 0.2]"#);
    shapes
        .node(sheet, r#""translation": [0, -1.4, 0], "rotation": [-0.70710677, 0, 0, 0.70710677], "scale": [6, 4, 1]"#);
    shapes.camera(r#""translation": [0.3, 0.6, 6.5]"#);
    shapes.camera(r#""translation": [0.2, 0.3, 0.9], "rotation": [0, 0.1, 0, 0.995]"#);
    shapes.camera(r#""translation": [-2.4, 0.1, 0.2], "rotation": [0, -0.5, 0, 0.866]"#);
    shapes
}

fn loaded(text: &str) -> Scene {
    let folder = Folder::new();
    let scene = load(&folder.write("s.gltf", text), &in_its_own_light());
    scene.unwrap_or_else(|error| panic!("{error}"))
}

/// One-sided surfaces that neither blend nor have holes.
pub fn matte() -> Scene {
    loaded(&plain_shapes().text())
}

/// The same, with leaves that are cut out, veils, and many of all in other sizes, some mirrored.
fn everything() -> String {
    let mut shapes = plain_shapes();
    let (leaf, veil, ball, shell) =
        (shapes.square(LEAF), shapes.square(VEIL), shapes.ball(false, VEIL), shapes.ball(true, SHELL));
    shapes.node(leaf, r#""translation": [0.2, 0.6, 2.5], "rotation": [0, 0.3, 0, 0.954]"#);
    shapes.node(leaf, r#""translation": [1.6, 0.2, 2], "rotation": [0, 0.95, 0, 0.312]"#);
    shapes.node(veil, r#""translation": [2.6, 0.4, 2.2], "scale": [-0.7, 1, 1]"#);
    shapes.node(veil, r#""translation": [-1, 0.4, 1.6], "rotation": [0, 1, 0, 0.1], "scale": [0.5, 1, 1]"#);
    let mut random = Random::new(5);
    for mesh in [leaf, ball, shell] {
        let places: Vec<[f32; 3]> =
            (0..9).map(|_| (random.point(3.0).as_vec3() * Vec3::new(1.2, 0.5, 1.0)).into()).collect();
        let scales: Vec<[f32; 3]> =
            (0..9).map(|_| [(); 3].map(|()| (random.within(0.15, 0.4) * random.sign()) as f32)).collect();
        let (place, scale) = (shapes.file.vectors(&places), shapes.file.vectors(&scales));
        shapes.node(
            mesh,
            &format!(
                r#""extensions": {{ "EXT_mesh_gpu_instancing": {{ "attributes":
                    {{ "TRANSLATION": {place}, "SCALE": {scale} }} }} }}"#
            ),
        );
    }
    shapes.text()
}

#[test]
fn every_mode_sees_the_same_sides() {
    let scene = loaded(&everything());
    assert!(scene.geometry.count_one_sided() > 1000 && !scene.geometry.cutouts.is_empty());
    let mut random = Random::new(3);
    let cameras = stress::cameras(&scene, if std::env::var_os("RAYWALK_LONG").is_some() { 40 } else { 3 }, &mut random);
    let wrong = wrong_pixels("sides", &scene, &cameras);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn instances_have_the_same_sides_as_flattened_ones() {
    let folder = Folder::new();
    let path = folder.write("scene.gltf", everything());
    let found = differences("sides", &path, 3, &mut Random::new(9));
    assert!(found.is_empty(), "{} differ:\n{}", found.len(), found.join("\n"));
}

/// A triangle in the plane z = 0 that faces +z, in one material, under a node.
fn faced(material: &str, place: &str) -> Scene {
    triangle(&format!(r#""nodes": [{{ "mesh": 0 {place} }}], "materials": [{material}]"#))
}

/// Whether a triangle is seen from +z, and from -z: by a pick and by a picture.
fn seen(scene: &Scene) -> [bool; 2] {
    [1.0, -1.0].map(|side| {
        let middle = scene.bounds().center();
        let toward = Vec3::new(middle.x * 0.8, middle.y * 0.8, middle.z);
        let eye = toward + Vec3::Z * side * 2.0;
        let is_picked = scene.pick(eye, Vec3::Z * -side, 0.0).is_some();
        let camera = Camera { eye, look_at: toward, fov: 5.0, ..Camera::default() };
        let film = render(scene, &camera, &Settings::exact(), (3, 3));
        assert_eq!(film.depth(1, 1).unwrap().is_finite(), is_picked);
        is_picked
    })
}

#[test]
fn backs_are_seen_of_double_sided_and_of_transmitting_materials_only() {
    let transmission = r#""extensions": { "KHR_materials_transmission": { "transmissionFactor": 0.5 } }"#;
    for (material, both) in [
        ("{}".to_owned(), false),
        (r#"{ "doubleSided": false }"#.to_owned(), false),
        (r#"{ "doubleSided": true }"#.to_owned(), true),
        (r#"{ "alphaMode": "MASK" }"#.to_owned(), false),
        (r#"{ "alphaMode": "BLEND" }"#.to_owned(), false),
        (r#"{ "alphaMode": "BLEND", "doubleSided": true }"#.to_owned(), true),
        (format!("{{ {transmission} }}"), true),
    ] {
        assert_eq!(seen(&faced(&material, "")), [true, both], "{material}");
    }
}

#[test]
fn nodes_that_mirror_turn_the_winding() {
    for (place, expected) in [
        ("", [true, false]),
        (r#", "scale": [-1, 1, 1]"#, [true, false]),
        (r#", "scale": [1, -2, 1]"#, [true, false]),
        (r#", "scale": [1, 1, -1]"#, [false, true]),
        (r#", "scale": [-1, -1, 1]"#, [true, false]),
        (r#", "scale": [-1, -1, -1]"#, [false, true]),
        (r#", "rotation": [0, 1, 0, 0]"#, [false, true]),
    ] {
        assert_eq!(seen(&faced("{}", place)), expected, "{place}");
    }
}

#[test]
fn what_is_not_seen_still_casts_a_shadow() {
    // The sun stands above; the roof faces down or up and covers the floor. The eye looks at the floor from above.
    let light = |roof: &str| {
        let mut shapes = Shapes::new();
        let square = shapes.square(WALL);
        let up = r#""rotation": [-0.70710677, 0, 0, 0.70710677]"#;
        shapes.node(square, &format!(r#"{up}, "scale": [4, 4, 1]"#));
        if !roof.is_empty() {
            shapes.node(square, roof);
        }
        let scene = loaded(&shapes.text());
        let camera = Camera { eye: Vec3::new(0.1, 8.0, 0.1), look_at: Vec3::new(0.1, 0.0, 0.0), ..Camera::default() };
        let settings = Settings::exact();
        let film = render(&scene, &camera, &settings, (9, 9));
        let [r, g, b] = film.color(4, 4);
        (film.depth(4, 4).unwrap(), r + g + b)
    };
    let down = r#""rotation": [0.70710677, 0, 0, 0.70710677], "translation": [0, 2, 0], "scale": [3.5, 3.5, 1]"#;
    let (bare, bright) = light("");
    let (under, dark) = light(down);
    assert_eq!(under, bare, "the roof is seen from behind");
    assert!(dark < 0.5 * bright, "the roof casts no shadow: {dark} {bright}");
    let up = down.replacen("0.70710677", "-0.70710677", 1);
    assert!(light(&up).0 < bare - 1.5, "the roof is not seen from its front");
}

#[test]
fn mirrors_and_glass_show_no_backs() {
    // A mirror at the left and glass at the right, and a square behind the eye or behind both.
    let picture = |square: Option<(&str, &str)>| {
        let mut shapes = Shapes::new();
        let (mirror, glass, wall) = (shapes.square(MIRROR), shapes.cube(false, GLASS), shapes.square(SHELL));
        shapes.node(mirror, r#""translation": [-1.5, 0, 0], "scale": [1.4, 3, 1]"#);
        shapes.node(glass, r#""translation": [1.5, 0, 0], "scale": [1.4, 3, 0.2]"#);
        if let Some((z, turn)) = square {
            shapes.node(wall, &format!(r#""translation": [0, 0, {z}], "scale": [5, 5, 1], "rotation": {turn}"#));
        }
        let mut scene = loaded(&shapes.text());
        // It is in proportion to the light that arrives where the first view looks.
        scene.render.ambient = Vec3::ONE;
        let settings = Settings { shadows: false, ..Settings::exact() };
        let camera = Camera { eye: Vec3::new(0.0, 0.0, 3.0), look_at: Vec3::ZERO, fov: 60.0, ..Camera::default() };
        let film = render(&scene, &camera, &settings, (40, 24));
        let colors: Vec<_> =
            (0..24).flat_map(|y| (0..40).map(move |x| (x, y))).map(|(x, y)| film.color(x, y)).collect();
        colors
    };
    let bare = picture(None);
    let differing = |z: &str, turn: &str, columns: std::ops::Range<usize>| {
        let other = picture(Some((z, turn)));
        (0..bare.len()).filter(|i| columns.contains(&(i % 40)) && bare[*i] != other[*i]).count()
    };
    let (along_z, against_z) = ("[0, 0, 0, 1]", "[0, 1, 0, 0]");
    assert!(differing("3.5", against_z, 0..19) > 100, "the mirror shows the front");
    assert_eq!(differing("3.5", along_z, 0..40), 0, "the back behind the eye is nowhere");
    assert!(differing("-3.5", along_z, 21..40) > 100, "the glass shows the front");
    assert_eq!(differing("-3.5", against_z, 0..40), 0, "the back behind the glass is nowhere");
}

#[test]
fn the_first_view_is_from_where_something_is_seen() {
    for turn in ["", r#", "rotation": [0, 1, 0, 0]"#, r#", "rotation": [0.70710677, 0, 0, 0.70710677]"#] {
        let scene = faced("{}", turn);
        let camera = scene.cameras[0].camera;
        assert!(
            scene.pick(camera.eye, (scene.bounds().center() * 0.8 - camera.eye).normalize(), 0.0).is_some(),
            "{turn}"
        );
    }
}

#[test]
fn info_names_one_sided_surfaces() {
    use raywalk::render::Plan;
    for (scene, says) in [
        (faced("{}", ""), "one-sided surfaces: on, 1 triangles"),
        (faced(r#"{ "doubleSided": true }"#, ""), "one-sided surfaces: off"),
    ] {
        let reasons = Plan::new(&scene, &Settings::default()).reasons(&scene);
        assert!(reasons.iter().any(|reason| reason.starts_with(says)), "{reasons:?}");
    }
}
