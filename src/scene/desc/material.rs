//! `{ "color": [0.9, 0.25, 0.2], "ambient": 0.05, "diffuse": 0.5, "specular": 0.5, "shininess": 50, "reflectivity": 0.5 }`,
//! `{ "transparency": 1, "ior": 1.5, "absorption": [0, 0, 0] }`, or
//! `{ "base_color": [0.8, 0.8, 0.8], "metallic": 1, "roughness": 0.05 }`

use super::map::Map;
use super::node::{Kind, Node};
use super::problem::Outcome;
use super::value::{boolean, color, not_negative, number, number_in, positive, share, text, weight};
use super::{Context, NameRef};
use crate::scene::Material;
use crate::scene::material::{ColorSource, Lookup, Model, Relief, Scaled};
use glam::Vec3;

/// A material as the file gives it.
pub type MaterialDesc = Material<NameRef>;

/// The keys that make a material metallic-roughness; all others have Phong's reflection.
const METALLIC_ROUGHNESS: [&str; 3] = ["base_color", "metallic", "roughness"];
/// The keys that only Phong's reflection knows.
const PHONG: [&str; 4] = ["color", "diffuse", "specular", "shininess"];

/// Reads a material.
pub fn read<'t, N: Node<'t>>(node: N, name: String, context: &mut Context) -> Outcome<MaterialDesc> {
    let defaults = MaterialDesc::default_phong();
    let mut map = Map::open(node)?;
    let is_phong = !METALLIC_ROUGHNESS.iter().any(|key| map.has(key));
    let (color, model) = if is_phong { phong(&mut map, context)? } else { metallic_roughness(&mut map, context)? };
    let emission = map.or("emission", ColorSource::constant(Vec3::ZERO), |node| color_or_texture(node, context))?;
    let transparency = map.or("transparency", defaults.transparency, share)?;
    let material = Material {
        name,
        color,
        model,
        emission,
        reflectivity: map.or("reflectivity", defaults.reflectivity, share)?,
        transparency,
        ior: map.or("ior", f64::from(defaults.ior), positive)? as f32,
        fresnel: map.or("fresnel", transparency != Vec3::ZERO, boolean)?,
        absorption: map.or("absorption", defaults.absorption, weight)?,
        relief: relief(&mut map, context)?,
        ..defaults
    };
    map.finish(&mut context.warnings);
    Ok(material)
}

fn phong<'t, N: Node<'t>>(map: &mut Map<'t, N>, context: &mut Context) -> Outcome<(ColorSource<NameRef>, Model)> {
    let color = map.or("color", ColorSource::constant(Vec3::ONE), |node| color_or_texture(node, context))?;
    let model = Model::Phong {
        ambient: map.or("ambient", MaterialDesc::AMBIENT, weight)?,
        diffuse: map.or("diffuse", MaterialDesc::DIFFUSE, weight)?,
        specular: map.or("specular", MaterialDesc::SPECULAR, weight)?,
        shininess: map.or("shininess", MaterialDesc::SHININESS, not_negative)?,
    };
    Ok((color, model))
}

/// glTF's defaults: white, metal, rough.
fn metallic_roughness<'t, N: Node<'t>>(
    map: &mut Map<'t, N>,
    context: &mut Context,
) -> Outcome<(ColorSource<NameRef>, Model)> {
    for key in PHONG {
        if let Some(node) = map.take(key) {
            let message = format!("\"{key}\" has no effect on a material with base_color, metallic or roughness");
            context.warnings.push(node.at(), message);
        }
    }
    let color = map.or("base_color", ColorSource::constant(Vec3::ONE), |node| color_or_texture(node, context))?;
    let model = Model::MetallicRoughness {
        ambient: map.or("ambient", MaterialDesc::AMBIENT, weight)?,
        metallic: map.or("metallic", 1.0, number_in(0.0..=1.0))?,
        roughness: map.or("roughness", 1.0, number_in(0.0..=1.0))?,
    };
    Ok((color, model))
}

/// `"normal_map": { "texture": "stones", "scale": 1 }`, `"bump": { "texture": "stones", "height": 0.02 }`,
/// `"parallax": { "texture": "stones", "height": 0.05 }`
fn relief<'t, N: Node<'t>>(map: &mut Map<'t, N>, context: &mut Context) -> Outcome<Relief<NameRef>> {
    Ok(Relief {
        normal: map.optional("normal_map", |node| scaled(node, "scale", 1.0, context))?,
        bump: map.optional("bump", |node| scaled(node, "height", 0.01, context))?,
        parallax: map.optional("parallax", |node| scaled(node, "height", 0.05, context))?,
    })
}

/// A texture and what its values are scaled by.
fn scaled<'t, N: Node<'t>>(
    node: N,
    key: &'static str,
    default: f64,
    context: &mut Context,
) -> Outcome<Scaled<NameRef>> {
    let mut map = Map::open(node)?;
    let lookup = Lookup::new(map.required("texture", texture)?);
    let scale = map.or(key, default, number)? as f32;
    map.finish(&mut context.warnings);
    Ok(Scaled { lookup, scale })
}

fn color_or_texture<'t, N: Node<'t>>(node: N, context: &mut Context) -> Outcome<ColorSource<NameRef>> {
    if node.kind() != Kind::Map {
        return color(node).map(ColorSource::constant);
    }
    let mut map = Map::open(node)?;
    let name = map.required("texture", texture)?;
    map.finish(&mut context.warnings);
    Ok(ColorSource::textured(Lookup::new(name)))
}

fn texture<'t>(node: impl Node<'t>) -> Outcome<NameRef> {
    Ok(NameRef { name: text(node)?, at: node.at() })
}
