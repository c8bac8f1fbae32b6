//! Materials and textures, with the extensions that are read.

use super::file::{CORNERS, File, triangle, warnings};
use crate::temporary::Folder;
use glam::{Affine2, Vec2, Vec3};
use raywalk::scene::material::{Alpha, Material, Model};
use raywalk::scene::texture::{Blending, Sampler, Wrap};
use raywalk::scene::{LoadOptions, Scene, Texture, load};

/// The scene of one triangle of a material.
fn scene(material: &str, rest: &str) -> Scene {
    triangle(&format!(r#""nodes": [{{ "mesh": 0 }}], "materials": [{material}] {rest}"#))
}

fn material(text: &str) -> Material {
    scene(text, "").materials.swap_remove(0)
}

#[test]
fn factors_become_the_materials_own() {
    let m = material(
        r#"{ "name": "brass", "pbrMetallicRoughness":
        { "baseColorFactor": [0.5, 0.25, 0.125, 0.75], "metallicFactor": 0.5, "roughnessFactor": 0.25 }, "alphaMode": "BLEND" }"#,
    );
    assert_eq!((m.name.as_str(), m.color.factor, m.opacity), ("brass", Vec3::new(0.5, 0.25, 0.125), 0.75));
    let Model::MetallicRoughness { metallic, roughness, .. } = m.model else { panic!("{:?}", m.model) };
    assert_eq!((metallic, roughness, m.alpha), (0.5, 0.25, Alpha::Blend));
    assert_eq!(material(r#"{ "alphaMode": "MASK", "alphaCutoff": 0.25 }"#).alpha, Alpha::Mask(0.25));
    assert_eq!(material(r#"{ "alphaMode": "MASK" }"#).alpha, Alpha::Mask(0.5));
    let plain = material("{}");
    let Model::MetallicRoughness { metallic, roughness, .. } = plain.model else { panic!("{:?}", plain.model) };
    assert_eq!((metallic, roughness, plain.alpha, plain.thin), (1.0, 1.0, Alpha::Opaque, true));
}

#[test]
fn a_surface_without_a_material_is_metal_where_there_is_light_to_show_its_shape() {
    let metal = |rest: &str| {
        let mut file = File::default();
        let positions = file.vectors(&CORNERS);
        let mesh = format!(r#""meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {positions} }} }}] }}]"#);
        let scene = file.load(&format!("{mesh}, {rest}"));
        let object = &scene.objects[0];
        let Model::MetallicRoughness { metallic, roughness, .. } = scene.materials[object.material as usize].model
        else {
            panic!("{:?}", scene.materials)
        };
        assert_eq!(roughness, 1.0);
        (scene.headlight, metallic)
    };
    assert_eq!(metal(r#""nodes": [{ "mesh": 0 }]"#), (true, 0.0));
    let lit = r#""extensions": { "KHR_lights_punctual": { "lights": [{ "type": "directional" }] } },
        "nodes": [{ "mesh": 0 }, { "extensions": { "KHR_lights_punctual": { "light": 0 } } }]"#;
    assert_eq!(metal(lit), (false, 1.0));
}

#[test]
fn extensions_change_what_they_name() {
    let m = material(
        r#"{ "extensions": { "KHR_materials_transmission": { "transmissionFactor": 0.5 }, "KHR_materials_ior": { "ior": 1.25 },
        "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 1] } } }"#,
    );
    assert_eq!((m.transparency, m.ior, m.fresnel, m.thin), (Vec3::splat(0.5), 1.25, true, false));
    assert!(m.absorption.abs_diff_eq(Vec3::new(0.0, 0.5_f32.sqrt().ln().abs(), 0.0), 1e-5), "{}", m.absorption);
    assert!(material(r#"{ "extensions": { "KHR_materials_unlit": {} } }"#).unlit);
    let ior =
        |ior: &str| material(&format!(r#"{{ "extensions": {{ "KHR_materials_ior": {{ "ior": {ior} }} }} }}"#)).ior;
    assert_eq!([ior("2.5"), ior("0.5"), ior("-1")], [2.5, 1.0, 1.0]);
    assert!([ior("0"), ior("1e38")].iter().all(|&ior| ior > 1e9 && ior.powi(2).is_finite()));
    let glossy = material(
        r#"{ "extensions": { "KHR_materials_pbrSpecularGlossiness":
        { "diffuseFactor": [0.25, 0.5, 0.75, 1], "glossinessFactor": 0.75 } } }"#,
    );
    let Model::MetallicRoughness { metallic, roughness, .. } = glossy.model else { panic!("{:?}", glossy.model) };
    assert_eq!((glossy.color.factor, metallic, roughness), (Vec3::new(0.25, 0.5, 0.75), 0.0, 0.25));
}

#[test]
fn emission_has_its_strength() {
    let strength = r#""extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 8 } }"#;
    let [weak, strong] = ["", ","].map(|comma| {
        let strength = if comma.is_empty() { "" } else { strength };
        material(&format!(r#"{{ "emissiveFactor": [0.5, 0.25, 0] {comma} {strength} }}"#)).emission.factor
    });
    assert!(strong.abs_diff_eq(weak * 8.0, 1e-4) && weak.x >= 0.5, "{weak} {strong}");
}

/// A folder with a picture of 2 x 2 texels in it.
fn folder() -> Folder {
    let folder = Folder::new();
    let texels: Vec<u8> = (0..16).map(|i| i * 16).collect();
    image::save_buffer(folder.write("a b.png", ""), &texels, 2, 2, image::ExtendedColorType::Rgba8).unwrap();
    folder
}

fn load_in(folder: &Folder, file: &File, rest: &str) -> Scene {
    load(&folder.write("s.gltf", file.text(rest)), &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A textured triangle, given the textures' part of the file and the material.
fn textured(folder: &Folder, material: &str, rest: &str) -> Scene {
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let uvs = file.vectors(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    load_in(
        folder,
        &file,
        &format!(
            r#""meshes": [{{ "primitives": [{{ "material": 0,
            "attributes": {{ "POSITION": {positions}, "TEXCOORD_0": {uvs}, "TEXCOORD_1": {uvs} }} }}] }}],
            "nodes": [{{ "mesh": 0 }}], "materials": [{material}], {rest}"#
        ),
    )
}

const TEXTURES: &str = r#""textures": [{ "source": 0, "sampler": 0 }, { "source": 0 }], "images": [{ "uri": "a%20b.png" }],
    "samplers": [{ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9985 }]"#;

#[test]
fn every_property_looks_up_its_texture() {
    let folder = folder();
    let scene = textured(
        &folder,
        r#"{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 } },
        "normalTexture": { "index": 1, "scale": 0.5 }, "occlusionTexture": { "index": 1, "strength": 0.25, "texCoord": 1 },
        "emissiveTexture": { "index": 0 }, "emissiveFactor": [1, 1, 1],
        "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1, "transmissionTexture": { "index": 1 } } } }"#,
        TEXTURES,
    );
    let m = &scene.materials[0];
    let lookups = [&m.color.texture, &m.metallic_roughness, &m.emission.texture, &m.transmission];
    assert!(lookups.iter().all(|lookup| lookup.is_some_and(|lookup| lookup.set == 0)));
    let (normal, occlusion) = (m.relief.normal.expect("a normal map"), m.occlusion.expect("occlusion"));
    assert_eq!((normal.scale, occlusion.scale, occlusion.lookup.set), (0.5, 0.25, 1));
    let Texture::Image(image) = &scene.textures[m.color.texture.expect("a texture").texture as usize] else {
        panic!("an image")
    };
    let expected = Sampler {
        wrap: [Wrap::Clamp, Wrap::Mirror],
        magnification: Blending::Nearest,
        minification: Blending::Linear,
        between_levels: Some(Blending::Nearest),
    };
    assert_eq!((image.sampler, image.texels.width()), (expected, 2));
    assert!(scene.warnings.is_empty(), "{:?}", warnings(&scene));
}

#[test]
fn texture_transforms_choose_coordinates_and_move_them() {
    let folder = folder();
    for property in ["emissiveTexture", "occlusionTexture", "normalTexture"] {
        let scene = textured(
            &folder,
            &format!(
                r#"{{ "{property}": {{ "index": 0, "extensions": {{ "KHR_texture_transform":
                {{ "offset": [0.5, 0.25], "scale": [2, 3], "texCoord": 1 }} }} }} }}"#
            ),
            TEXTURES,
        );
        let m = &scene.materials[0];
        let other = m.occlusion.or(m.relief.normal).map(|map| map.lookup);
        let lookup = m.emission.texture.or(other).expect(property);
        // The only coordinates that are looked up are the mesh's first ones.
        assert_eq!(lookup.set, 0, "{property}");
        // 1 - (3 (1 - v) + 0.25)
        let expected = Affine2::from_scale_angle_translation(Vec2::new(2.0, 3.0), 0.0, Vec2::new(0.5, -2.25));
        assert!(lookup.transform.abs_diff_eq(expected, 1e-6), "{property}: {:?}", lookup.transform);
    }
}

#[test]
fn images_that_cannot_be_had_are_told_and_the_rest_is_shown() {
    let folder = folder();
    folder.write("broken.png", "no picture");
    let material = r#"{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }"#;
    for (image, says) in [
        (r#"{ "uri": "missing.png" }"#, "a placeholder is shown"),
        (r#"{ "uri": "broken.png" }"#, "a placeholder is shown"),
        (r#"{ "uri": "../a.png" }"#, "a placeholder is shown"),
        (r#"{ "uri": "http://a/b.png" }"#, "addresses are not followed"),
        (r#"{ "uri": "a.ktx2" }"#, "KTX2"),
        (r#"{ "bufferView": 0, "mimeType": "image/png" }"#, "a placeholder is shown"),
        ("{}", "neither uri nor bufferView"),
    ] {
        let scene = textured(&folder, material, &format!(r#""textures": [{{ "source": 0 }}], "images": [{image}]"#));
        assert_eq!(scene.objects.len(), 1);
        assert!(
            warnings(&scene)[0].starts_with("/images/0") && warnings(&scene)[0].contains(says),
            "{image}: {:?}",
            warnings(&scene)
        );
    }
}

#[test]
fn only_normal_maps_get_tangents() {
    let folder = folder();
    let normal = r#"{ "normalTexture": { "index": 1 } }"#;
    for (material, expected) in [(normal, true), (r#"{ "occlusionTexture": { "index": 1 } }"#, false)] {
        let scene = textured(&folder, material, TEXTURES);
        assert_eq!(scene.materials[0].relief.normal.is_some(), expected);
        assert!(scene.warnings.is_empty(), "{:?}", warnings(&scene));
    }
    // Without texture coordinates there is nothing to follow.
    let mut file = File::default();
    let positions = file.vectors(&CORNERS);
    let scene = load_in(
        &folder,
        &file,
        &format!(
            r#""meshes": [{{ "primitives": [{{ "material": 0, "attributes": {{ "POSITION": {positions} }} }}] }}],
            "nodes": [{{ "mesh": 0 }}], "materials": [{normal}], {TEXTURES}"#
        ),
    );
    assert!(warnings(&scene)[0].contains("no texture coordinates"));
}

#[test]
fn unknown_extensions_are_told_and_required_ones_refused() {
    let scene = scene("{}", r#", "extensionsUsed": ["KHR_materials_sheen", "KHR_materials_ior"]"#);
    let told = ["/extensionsUsed/0: KHR_materials_sheen is not supported; what it says is left out"];
    assert_eq!(warnings(&scene), told);
    let text = r#"{ "asset": { "version": "2.0" }, "extensionsRequired": ["KHR_texture_transform", "KHR_draco_mesh_compression"] }"#;
    let error = super::file::try_load(text).unwrap_err().to_string();
    assert!(error.contains("(/extensionsRequired/1)") && error.contains("KHR_draco_mesh_compression"), "{error}");
}
