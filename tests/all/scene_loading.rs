//! Valid scene files: what they become.

use crate::temporary::{Folder, load_objects, load_text};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use raywalk::geometry::Aabb;
use raywalk::math::{SimdToken, dispatch};
use raywalk::scene::light::{Falloff, LightKind};
use raywalk::scene::material::{ColorSource, Model};
use raywalk::scene::object::Mapping;
use raywalk::scene::texture::Coordinates;
use raywalk::scene::{LoadOptions, Material, Texture};

fn close(a: Vec3, b: Vec3) -> bool {
    a.abs_diff_eq(b, 1e-5)
}

#[test]
fn only_the_version_is_required() {
    let scene = load_text(r#"{ "version": 1 }"#).unwrap();
    assert!(scene.objects.is_empty() && scene.lights.is_empty());
    assert_eq!(scene.materials, [Material::default_phong()]);
    assert_eq!((scene.render.width, scene.render.height, scene.render.max_depth), (None, None, 5));
    assert_eq!(scene.render.background, Vec3::ZERO);
    assert!(scene.headlight);
    assert_eq!(scene.render.ambient, Vec3::splat(0.1));
    assert!(scene.cameras.len() == 1 && scene.cameras[0].camera.is_valid());
    assert!(scene.bounds().is_empty());
}

#[test]
fn every_type_and_key_is_accepted_without_warnings() {
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    let scene = Folder::new().load(include_str!("every_type.json"), &strict).unwrap();
    assert_eq!(scene.name, "s.json");
    let kinds: Vec<&str> = scene.objects.iter().map(|o| o.kind).collect();
    let expected = [
        "sphere",
        "plane",
        "cylinder",
        "cone",
        "box",
        "disk",
        "rectangle",
        "triangle",
        "mesh",
        "sphere",
        "mesh",
        "cone",
    ];
    assert_eq!(kinds, expected);
    let bodies: Vec<bool> = scene.objects.iter().map(|o| o.body).collect();
    let open_or_flat = ["disk", "rectangle", "triangle"];
    for (i, (kind, body)) in kinds.iter().zip(bodies).enumerate() {
        assert_eq!(body, i != 3 && !open_or_flat.contains(kind), "object {i}, a {kind}");
    }
    assert_eq!(scene.objects[0].name.as_deref(), Some("ball"));
    let names: Vec<&str> = scene.cameras.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["default", "door"]);
    assert_eq!(scene.cameras[1].camera.fov, 60.0);
    assert!(close(scene.cameras[1].camera.frame(2, 2).forward.with_y(0.0).normalize(), Vec3::NEG_X));
    assert!(!scene.headlight);
    assert_eq!(scene.render.ambient, Vec3::splat(0.5));
    assert_eq!(scene.textures.len(), 2);
    assert!(matches!(scene.textures[0], Texture::Checker { size: 2.0, .. }));
}

#[test]
fn materials_get_the_documented_defaults() {
    let text = r#"{ "version": 1, "materials": { "plain": {}, "glass": { "transparency": [0, 0.5, 0] },
        "pane": { "transparency": 1, "fresnel": false }, "metal": { "metallic": 1 }, "rough": { "roughness": 0.5 } } }"#;
    let scene = load_text(text).unwrap();
    let [plain, glass, pane, metal, rough] = &scene.materials[..] else { panic!("five materials") };
    assert_eq!(plain, &Material { name: "plain".to_owned(), ..Material::default_phong() });
    assert!(glass.fresnel && !pane.fresnel && !plain.fresnel);
    assert_eq!(glass.ior, 1.5);
    assert!(matches!(metal.model, Model::MetallicRoughness { metallic: 1.0, roughness: 1.0, .. }));
    assert!(matches!(rough.model, Model::MetallicRoughness { metallic: 1.0, roughness: 0.5, .. }));
    assert_eq!(rough.color, ColorSource::constant(Vec3::ONE));
}

#[test]
fn objects_without_a_material_share_the_default_one() {
    let text = r#"{ "version": 1, "materials": { "red": {} }, "objects": [
        { "type": "sphere", "center": [0, 0, 0], "radius": 1 },
        { "type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "red" },
        { "type": "sphere", "center": [0, 0, 0], "radius": 1 } ] }"#;
    let scene = load_text(text).unwrap();
    assert_eq!(scene.objects.iter().map(|o| o.material).collect::<Vec<_>>(), [1, 0, 1]);
    assert_eq!(scene.materials[1], Material::default_phong());
}

#[test]
fn colours_are_linear_numbers_or_decoded_srgb() {
    let text = r##"{ "version": 1, "materials": { "a": { "color": 0.5 }, "b": { "color": "#FF8000" }, "c": { "color": [2, 0, 1] } } }"##;
    let scene = load_text(text).unwrap();
    let colors: Vec<Vec3> = scene
        .materials
        .iter()
        .map(|m| {
            assert_eq!(m.color.texture, None);
            m.color.factor
        })
        .collect();
    assert_eq!(colors[0], Vec3::splat(0.5));
    assert!(close(colors[1], Vec3::new(1.0, 0.215_861, 0.0)), "{}", colors[1]);
    assert_eq!(colors[2], Vec3::new(2.0, 0.0, 1.0));
}

#[test]
fn lights_multiply_colour_intensity_and_temperature() {
    let text = r#"{ "version": 1, "lights": [
        { "type": "point", "position": [1, 2, 3], "color": [1, 0.5, 0.25], "intensity": 4, "temperature": 6500 },
        { "type": "spot", "position": [0, 0, 0], "direction": [0, -3, 0], "falloff": "inverse_square" } ] }"#;
    let scene = load_text(text).unwrap();
    assert!(close(scene.lights[0].color, Vec3::new(4.0, 2.0, 1.0)));
    assert_eq!(scene.lights[0].falloff, Falloff::None);
    let LightKind::Spot { direction, cos_inner, cos_outer, .. } = scene.lights[1].kind else { panic!("a spot") };
    assert_eq!(direction, Vec3::NEG_Y);
    assert!(cos_inner == 1.0 && (cos_outer - 0.5_f32.sqrt()).abs() < 1e-6);
    assert_eq!(scene.lights[1].falloff, Falloff::InverseSquare);
}

#[test]
fn nested_transforms_apply_from_the_inside_out() {
    // Inside: moved by 1 along x, then doubled, turned by 90 degrees about y (x goes to -z), moved up by 10.
    let scene = load_objects(
        r#"{ "type": "group", "transform": { "translate": [0, 10, 0], "rotate": [0, 90, 0], "scale": 2 }, "children": [
            { "type": "group", "transform": { "translate": [1, 0, 0] }, "children": [
                { "type": "sphere", "center": [0, 0, 0], "radius": 0.5 } ] },
            { "type": "sphere", "center": [0, 0, 0], "radius": 1, "transform": { "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1] } } ] }"#,
    );
    assert_eq!(scene.objects[0].bounds, Aabb { min: Vec3::new(-1.0, 9.0, -3.0), max: Vec3::new(1.0, 11.0, -1.0) });
    assert_eq!(scene.objects[1].bounds.center(), Vec3::new(0.0, 10.0, -10.0));
    let back = scene.objects[0].world_to_object.unwrap();
    assert!(close(back.transform_point3(Vec3::new(0.0, 10.0, -2.0)), Vec3::ZERO));
    assert!(close(back.transform_point3(Vec3::new(0.0, 10.0, 0.0)), Vec3::new(-1.0, 0.0, 0.0)));
}

#[test]
fn objects_that_are_not_transformed_say_so() {
    let scene = load_objects(r#"{ "type": "box", "min": [0, 0, 0], "max": [1, 2, 3] }"#);
    assert!(scene.objects[0].world_to_object.is_none());
    assert_eq!(scene.objects[0].bounds, Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 3.0) });
}

#[test]
fn a_box_may_be_stretched_and_a_sphere_may_be_mirrored() {
    let scene = load_objects(
        r#"{ "type": "group", "transform": { "scale": [1, 2, -3] }, "children": [ { "type": "box", "min": [0, 0, 0], "max": [1, 1, 1] } ] },
           { "type": "group", "transform": { "scale": [-2, 2, 2] }, "children": [ { "type": "sphere", "center": [1, 0, 0], "radius": 1 } ] }"#,
    );
    assert_eq!(scene.objects[0].bounds, Aabb { min: Vec3::new(0.0, 0.0, -3.0), max: Vec3::new(1.0, 2.0, 0.0) });
    assert_eq!(scene.objects[1].bounds.center(), Vec3::new(-2.0, 0.0, 0.0));
}

#[test]
fn texture_coordinates_follow_the_shape() {
    let scene = load_objects(
        r#"{ "type": "plane", "point": [0, 0, 0], "normal": [0, -1, 0] },
           { "type": "rectangle", "corner": [0, 0, 0], "edge_u": [0.3, 0.1, 0], "edge_v": [0.1, 0.7, 0] },
           { "type": "triangle", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "uvs": [[0, 0], [1, 0], [0, 1]] },
           { "type": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 2, 1]] },
           { "type": "cylinder", "base": [0, 1, 0], "top": [0, 3, 0], "radius": 1 }"#,
    );
    let mappings: Vec<Mapping> = scene.objects.iter().map(|o| o.mapping).collect();
    let expected = [
        Mapping::Planar { checker: [Vec3::X, Vec3::Z], image: [Vec3::X, Vec3::Z] },
        Mapping::Planar { checker: [Vec3::X, Vec3::Y], image: [Vec3::X, Vec3::Y] },
        Mapping::Vertex,
        Mapping::BoxFaces,
        Mapping::Axial { base: Vec3::Y, axis: Vec3::Y },
    ];
    assert_eq!(mappings, expected);
}

#[test]
fn triangles_without_area_are_left_out_with_one_warning() {
    let scene = load_objects(
        r#"{ "type": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]], "triangles": [[0, 1, 2], [0, 1, 3], [1, 1, 2], [0, 2, 1]] }"#,
    );
    let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
    assert!(warning.message.contains("2 left out") && warning.message.contains("triangle 1"), "{warning}");
    assert_eq!(warning.place.pointer, "/objects/0");
}

#[test]
fn every_load_is_a_generation_of_its_own() {
    let [a, b] = [(); 2].map(|()| load_text(r#"{ "version": 1 }"#).unwrap().generation);
    assert_ne!(a, b);
}

#[test]
fn a_checker_starts_with_its_first_colour() {
    let scene = load_text(r#"{ "version": 1, "textures": { "t": { "checker": [1, 0], "size": 2 } } }"#).unwrap();
    let at = |u, v| dispatch!(SimdToken::best(), simd => red_at(simd, &scene.textures[0], u, v));
    assert_eq!([at(0.5, 0.5), at(2.5, 0.5), at(2.5, 2.5), at(-0.5, 0.5)], [1.0, 0.0, 1.0, 0.0]);
}

/// The red that a texture holds at (u, v).
fn red_at<S: Simd>(simd: S, texture: &Texture, u: f32, v: f32) -> f32 {
    let uv = [S::f32s::splat(simd, u), S::f32s::splat(simd, v)];
    texture.sample::<S, false>(simd, &Coordinates { uv, spread2: None }, 1).color.x[0]
}

#[test]
fn nothing_solid_is_entered() {
    let solids = [
        r#"{ "type": "sphere", "center": [5, 1, 0], "radius": 1 }"#,
        r#"{ "type": "cylinder", "base": [5, 0, 0], "top": [5, 4, 0], "radius": 1 }"#,
        r#"{ "type": "cone", "base": [5, 0, 0], "top": [5, 4, 0], "radius": 2 }"#,
        r#"{ "type": "box", "min": [4, 0, -1], "max": [6, 3, 1] }"#,
    ];
    for objects in solids.into_iter().chain([&*solids.join(",")]) {
        let scene = load_objects(objects);
        let Aabb { min, max } = scene.bounds();
        let eye = scene.cameras[0].camera.eye;
        assert!(eye.cmplt(min).any() || eye.cmpgt(max).any(), "{eye} is in {min} to {max} of {objects}");
    }
}
