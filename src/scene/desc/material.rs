//! `{ "color": [0.9, 0.25, 0.2], "ambient": 0.05, "diffuse": 0.5, "specular": 0.5, "shininess": 50, "reflectivity": 0.5 }`,
//! `{ "transparency": 1, "ior": 1.5, "absorption": [0, 0, 0] }`, or
//! `{ "base_color": [0.8, 0.8, 0.8], "metallic": 1, "roughness": 0.05 }`

use super::map::Map;
use super::node::{Kind, Node};
use super::problem::Outcome;
use super::value::{boolean, color, not_negative, number_in, positive, share, text, weight};
use super::{Context, NameRef};
use crate::scene::Material;
use crate::scene::material::{ColorSource, Model};
use glam::Vec3;

/// A colour as the file gives it.
#[derive(Clone, Debug)]
pub enum ColorDesc {
    /// The same everywhere, linear.
    Constant(Vec3),
    /// Looked up in a texture.
    Texture(NameRef),
}

/// A material as the file gives it.
#[derive(Clone, Debug)]
pub struct MaterialDesc {
    /// The material, but for what its colours are looked up in.
    pub material: Material,
    /// Surface colour.
    pub color: ColorDesc,
    /// Light given off.
    pub emission: ColorDesc,
}

/// The keys that make a material metallic-roughness; all others have Phong's reflection.
const METALLIC_ROUGHNESS: [&str; 3] = ["base_color", "metallic", "roughness"];
/// The keys that only Phong's reflection knows.
const PHONG: [&str; 4] = ["color", "diffuse", "specular", "shininess"];

/// Reads a material.
pub fn read<'t, N: Node<'t>>(node: N, name: String, context: &mut Context) -> Outcome<MaterialDesc> {
    let defaults = Material::default_phong();
    let mut map = Map::open(node)?;
    let is_phong = !METALLIC_ROUGHNESS.iter().any(|key| map.has(key));
    let (color, model) = if is_phong { phong(&mut map, context)? } else { metallic_roughness(&mut map, context)? };
    let emission = map.or("emission", ColorDesc::Constant(Vec3::ZERO), |node| color_or_texture(node, context))?;
    let transparency = map.or("transparency", defaults.transparency, share)?;
    let material = Material {
        name,
        color: ColorSource::Constant(Vec3::ONE),
        model,
        emission: ColorSource::Constant(Vec3::ZERO),
        reflectivity: map.or("reflectivity", defaults.reflectivity, share)?,
        transparency,
        ior: map.or("ior", f64::from(defaults.ior), positive)? as f32,
        fresnel: map.or("fresnel", transparency != Vec3::ZERO, boolean)?,
        absorption: map.or("absorption", defaults.absorption, weight)?,
    };
    map.finish(&mut context.warnings);
    Ok(MaterialDesc { material, color, emission })
}

fn phong<'t, N: Node<'t>>(map: &mut Map<'t, N>, context: &mut Context) -> Outcome<(ColorDesc, Model)> {
    let color = map.or("color", ColorDesc::Constant(Vec3::ONE), |node| color_or_texture(node, context))?;
    let model = Model::Phong {
        ambient: map.or("ambient", Material::AMBIENT, weight)?,
        diffuse: map.or("diffuse", Material::DIFFUSE, weight)?,
        specular: map.or("specular", Material::SPECULAR, weight)?,
        shininess: map.or("shininess", Material::SHININESS, not_negative)?,
    };
    Ok((color, model))
}

/// glTF's defaults: white, metal, rough.
fn metallic_roughness<'t, N: Node<'t>>(map: &mut Map<'t, N>, context: &mut Context) -> Outcome<(ColorDesc, Model)> {
    for key in PHONG {
        if let Some(node) = map.take(key) {
            let message = format!("\"{key}\" has no effect on a material with base_color, metallic or roughness");
            context.warnings.push(node.at(), message);
        }
    }
    let color = map.or("base_color", ColorDesc::Constant(Vec3::ONE), |node| color_or_texture(node, context))?;
    let model = Model::MetallicRoughness {
        ambient: map.or("ambient", Material::AMBIENT, weight)?,
        metallic: map.or("metallic", 1.0, number_in(0.0..=1.0))?,
        roughness: map.or("roughness", 1.0, number_in(0.0..=1.0))?,
    };
    Ok((color, model))
}

fn color_or_texture<'t, N: Node<'t>>(node: N, context: &mut Context) -> Outcome<ColorDesc> {
    if node.kind() != Kind::Map {
        return color(node).map(ColorDesc::Constant);
    }
    let mut map = Map::open(node)?;
    let name = map.required("texture", |node| Ok(NameRef { name: text(node)?, at: node.at() }))?;
    map.finish(&mut context.warnings);
    Ok(ColorDesc::Texture(name))
}
