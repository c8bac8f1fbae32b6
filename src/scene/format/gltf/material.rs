//! Materials: metallic-roughness with all its textures, and the extensions that change what a ray sees.

use super::document::Document;
use super::fault::{Read, Report};
use super::texture::{Reference, Textures};
use crate::scene::desc::{MaterialDesc, NameRef};
use crate::scene::material::{Alpha, ColorSource, Lookup, Model, Scaled};
use glam::Vec3;
use gltf::json::extensions::material::PbrSpecularGlossiness;
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::AlphaMode;
use gltf::json::validation::Checked;
use gltf::json::{self, Index};
use serde_json::{Map, Value};
use std::collections::HashSet;
use std::f32::consts::FRAC_1_PI;

/// The name of the material of primitives that name none.
const DEFAULT: &str = "default";
/// How many sets of texture coordinates a vertex has room for.
const SETS: usize = 2;
/// Roughness of a surface whose glossiness lies in a texture of a kind that is not looked up.
const UNKNOWN_ROUGHNESS: f32 = 0.5;
/// An index of refraction at which all light is reflected, to the last bit, and whose square is still a number.
const REFLECTS_ALL: f32 = 1e10;
/// Least share of light that a medium passes over its attenuation distance: black would absorb without end.
const LEAST_PASSED: f32 = 1e-6;

/// The materials of a file.
pub struct Materials {
    /// In the file's order, the default one last.
    pub descs: Vec<MaterialDesc>,
    /// Which texture coordinates of the file each looks up as the first and as the second.
    sets: Vec<Vec<u32>>,
}

impl Materials {
    /// Reads those of a file.
    pub fn read(document: &Document, textures: &mut Textures, report: &mut Report) -> Read<Self> {
        let mut names = HashSet::new();
        let count = document.root.materials.len() + 1;
        let (mut descs, mut sets) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (i, material) in document.root.materials.iter().enumerate() {
            let pointer = format!("/materials/{i}");
            let mut reader =
                Reader { textures: &mut *textures, report: &mut *report, pointer: &pointer, sets: Vec::new() };
            let (name, mut described) = match material {
                Some(material) => (material.name.as_deref(), reader.material(material)?),
                None => (None, default()),
            };
            sets.push(reader.sets);
            described.name = unique(name, i, &mut names);
            descs.push(described);
        }
        descs.push(MaterialDesc { name: unique(Some(DEFAULT), descs.len(), &mut names), ..default() });
        sets.push(Vec::new());
        Ok(Self { descs, sets })
    }

    /// The material of a primitive: the one it names, else the default one.
    pub fn of(&self, named: Option<Index<json::Material>>, pointer: &str, report: &mut Report) -> usize {
        let default = self.descs.len() - 1;
        let named = named.map_or(default, |index| index.value());
        if named > default {
            let message = format!("material {named} does not exist; the file has {default}; the default one is shown");
            report.warn(format!("{pointer}/material"), message);
        }
        named.min(default)
    }

    /// Which texture coordinates of the file a material looks up as the first and as the second, if any.
    pub fn sets_of(&self, material: usize) -> &[u32] {
        &self.sets[material]
    }

    /// How a material looks up a normal map, if it has one.
    pub fn normal_map_of(&self, material: usize) -> Option<&Lookup<NameRef>> {
        self.descs[material].relief.normal.as_ref().map(|map| &map.lookup)
    }
}

/// The material of primitives that name none.
fn default() -> MaterialDesc {
    MaterialDesc {
        model: model(1.0, 1.0),
        thin: true,
        one_sided: true,
        is_stand_in: true,
        ..MaterialDesc::default_phong()
    }
}

/// The file's name of material `i`, unless there is none or another has it.
fn unique(name: Option<&str>, i: usize, names: &mut HashSet<String>) -> String {
    let name = name.filter(|name| !name.is_empty()).map_or_else(|| format!("material {i}"), str::to_owned);
    let mut own = name.clone();
    let mut number = i;
    while !names.insert(own.clone()) {
        own = format!("{name} ({number})");
        number += 1;
    }
    own
}

/// Reads one material.
struct Reader<'a, 'd> {
    textures: &'a mut Textures<'d>,
    report: &'a mut Report,
    pointer: &'a str,
    /// The sets of texture coordinates looked up so far.
    sets: Vec<u32>,
}

impl Reader<'_, '_> {
    fn material(&mut self, material: &json::Material) -> Read<MaterialDesc> {
        let extensions = material.extensions.clone().unwrap_or_default();
        let mut described = match &extensions.pbr_specular_glossiness {
            Some(other) => self.specular_glossiness(other)?,
            None => self.metallic_roughness(&material.pbr_metallic_roughness)?,
        };
        if let Some(normal) = &material.normal_texture {
            let transform = normal.extensions.as_ref().and_then(|extensions| transform(&extensions.others));
            let reference = Reference { index: normal.index, set: normal.tex_coord, transform: transform.as_ref() };
            let lookup = self.lookup(Some(reference), "normalTexture")?;
            described.relief.normal = lookup.map(|lookup| Scaled { lookup, scale: finite(normal.scale, 1.0) });
        }
        if let Some(occlusion) = &material.occlusion_texture {
            let transform = occlusion.extensions.as_ref().and_then(|extensions| transform(&extensions.others));
            let reference =
                Reference { index: occlusion.index, set: occlusion.tex_coord, transform: transform.as_ref() };
            let lookup = self.lookup(Some(reference), "occlusionTexture")?;
            described.occlusion = lookup.map(|lookup| Scaled { lookup, scale: share(occlusion.strength.0) });
        }
        let strength = extensions.emissive_strength.map_or(1.0, |emissive| emissive.emissive_strength.0);
        let emission = Vec3::from_array(material.emissive_factor.0).map(|factor| factor.max(0.0)) * strength.max(0.0);
        described.emission = ColorSource {
            factor: emission.map(|factor| finite(factor, f32::MAX)),
            texture: self.lookup(material.emissive_texture.as_ref().map(Reference::of), "emissiveTexture")?,
        };
        described.alpha = match material.alpha_mode {
            Checked::Valid(AlphaMode::Mask) => Alpha::Mask(finite(material.alpha_cutoff.unwrap_or_default().0, 0.5)),
            Checked::Valid(AlphaMode::Blend) => Alpha::Blend,
            Checked::Valid(AlphaMode::Opaque) | Checked::Invalid => Alpha::Opaque,
        };
        described.one_sided = !material.double_sided;
        described.unlit = extensions.unlit.is_some();
        if let Some(ior) = &extensions.ior {
            // 0 stands for a surface that reflects everything; below 1 nothing is dense.
            described.ior = match ior.ior.0 {
                0.0 => REFLECTS_ALL,
                index => finite(index, described.ior).clamp(1.0, REFLECTS_ALL),
            };
        }
        if let Some(transmission) = &extensions.transmission {
            described.transparency = Vec3::splat(share(transmission.transmission_factor.0));
            described.fresnel = described.is_transparent();
            let texture = transmission.transmission_texture.as_ref().map(Reference::of);
            described.transmission =
                self.lookup(texture, "extensions/KHR_materials_transmission/transmissionTexture")?;
        }
        // Without a volume the surface is a thin wall.
        described.thin = true;
        if let Some(volume) = extensions.volume.filter(|volume| volume.thickness_factor.0 > 0.0) {
            described.thin = false;
            described.absorption = absorption(volume.attenuation_color.0, volume.attenuation_distance.0);
        }
        Ok(described)
    }

    fn metallic_roughness(&mut self, pbr: &json::material::PbrMetallicRoughness) -> Read<MaterialDesc> {
        let [r, g, b, opacity] = pbr.base_color_factor.0.map(share);
        let model = model(share(pbr.metallic_factor.0), share(pbr.roughness_factor.0));
        let color = pbr.base_color_texture.as_ref().map(Reference::of);
        let color = self.lookup(color, "pbrMetallicRoughness/baseColorTexture")?;
        let surface = pbr.metallic_roughness_texture.as_ref().map(Reference::of);
        let surface = self.lookup(surface, "pbrMetallicRoughness/metallicRoughnessTexture")?;
        Ok(MaterialDesc {
            color: ColorSource { factor: Vec3::new(r, g, b), texture: color },
            model,
            metallic_roughness: surface,
            opacity,
            ..MaterialDesc::default_phong()
        })
    }

    /// The older model, as a surface that is no metal and has the same diffuse colour.
    fn specular_glossiness(&mut self, pbr: &PbrSpecularGlossiness) -> Read<MaterialDesc> {
        let [r, g, b, opacity] = pbr.diffuse_factor.0.map(share);
        let color = pbr.diffuse_texture.as_ref().map(Reference::of);
        let color = self.lookup(color, "extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture")?;
        let roughness = match pbr.specular_glossiness_texture {
            Some(_) => UNKNOWN_ROUGHNESS,
            None => 1.0 - share(pbr.glossiness_factor.0),
        };
        Ok(MaterialDesc {
            color: ColorSource { factor: Vec3::new(r, g, b), texture: color },
            model: model(0.0, roughness),
            opacity,
            ..MaterialDesc::default_phong()
        })
    }

    fn lookup(&mut self, reference: Option<Reference>, key: &str) -> Read<Option<Lookup<NameRef>>> {
        let Some(reference) = reference else { return Ok(None) };
        let pointer = format!("{}/{key}", self.pointer);
        let Some(texture) = self.textures.name(reference.index, &pointer, self.report)? else { return Ok(None) };
        let set = reference.set();
        let place = self.sets.iter().position(|known| *known == set).unwrap_or_else(|| {
            self.sets.push(set);
            self.sets.len() - 1
        });
        if place >= SETS {
            self.sets.truncate(SETS);
            let message = "the material looks up more than two sets of texture coordinates; this texture is not shown";
            self.report.warn(pointer, message);
            return Ok(None);
        }
        Ok(Some(Lookup { texture, set: place as u8, transform: reference.upwards() }))
    }
}

/// Ambient light, like that of lights, goes off in all directions.
fn model(metallic: f32, roughness: f32) -> Model {
    Model::MetallicRoughness { ambient: Vec3::splat(FRAC_1_PI), metallic, roughness }
}

/// Beer's law, from the colour that white light has after a distance.
fn absorption(color: [f32; 3], distance: f32) -> Vec3 {
    let rate = |passed: f32| {
        let rate = -libm::log(f64::from(passed.clamp(LEAST_PASSED, 1.0))) / f64::from(distance);
        finite(rate as f32, 0.0).max(0.0)
    };
    if distance > 0.0 { Vec3::from_array(color.map(rate)) } else { Vec3::ZERO }
}

/// A texture transform of a property for which the crate has no typed one.
fn transform(extensions: &Map<String, Value>) -> Option<TextureTransform> {
    serde_json::from_value(extensions.get("KHR_texture_transform")?.clone()).ok()
}

fn share(value: f32) -> f32 {
    value.clamp(0.0, 1.0)
}

fn finite(value: f32, default: f32) -> f32 {
    if value.is_finite() { value } else { default }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_medium_passes_its_color_at_its_distance() {
        let rates = absorption([0.5, 1.0, 0.0], 2.0);
        let passed = rates.map(|rate| libm::exp(-2.0 * f64::from(rate)) as f32);
        assert!(passed.abs_diff_eq(Vec3::new(0.5, 1.0, LEAST_PASSED), 1e-6), "{passed}");
        for distance in [0.0, -1.0, f32::INFINITY] {
            assert_eq!(absorption([0.5; 3], distance), Vec3::ZERO);
        }
    }

    #[test]
    fn names_stay_the_files_own_where_they_can() {
        let mut names = HashSet::new();
        let mut name = |name, i| unique(name, i, &mut names);
        assert_eq!([name(Some("a"), 0), name(Some("a"), 1), name(None, 2)], ["a", "a (1)", "material 2"]);
        assert_eq!([name(Some("a (1)"), 3), name(Some(""), 2)], ["a (1) (3)", "material 2 (2)"]);
    }
}
