//! What shading reads of a scene, flattened for gathering into lanes. Made once a scene.

use crate::geometry::{Geometry, Opaque, PrimitiveIndex, VertexAttributes};
use crate::scene::material::{ColorSource, Model};
use crate::scene::{Material, Scene};
use glam::Vec3;

/// Numbers of a material, in the order in which shading reads them.
#[derive(Clone, Copy, Debug, Default)]
#[repr(usize)]
pub enum Row {
    /// First of three: surface colour, where it is constant.
    #[default]
    Color = 0,
    /// First of three: ambient factor.
    Ambient = 3,
    /// First of three: diffuse factor.
    Diffuse = 6,
    /// First of three: highlight colour.
    Specular = 9,
    /// First of three: what of the local light is left, 1 - transparency.
    Opacity = 12,
    /// First of three: light given off, where it is constant.
    Emission = 15,
    /// Blinn-Phong exponent.
    Shininess = 18,
    /// 0 to 1, metallic-roughness only.
    Metallic = 19,
    /// 0 to 1, metallic-roughness only; negative marks a Phong-type material.
    Roughness = 20,
    /// First of three: weight of the mirror ray, before Fresnel.
    Reflectivity = 21,
    /// First of three: weight of the refracted ray, before Fresnel.
    Transparency = 24,
    /// Index of refraction.
    Ior = 27,
    /// Square of the n·h up to which nothing is seen of a Blinn-Phong highlight.
    HighlightEdge2 = 28,
}

/// Numbers a material has.
pub const ROWS: usize = 29;

/// One material, flattened.
#[derive(Clone, Debug)]
pub struct FlatMaterial {
    /// The numbers that [`Row`] names.
    pub rows: [f32; ROWS],
    /// Texture of the colour.
    pub color_texture: Option<u32>,
    /// Texture of the emission.
    pub emission_texture: Option<u32>,
    /// Whether it has a highlight.
    pub shiny: bool,
    /// Whether it gives off light.
    pub emissive: bool,
    /// Whether it is metallic-roughness.
    pub metallic_roughness: bool,
    /// Whether light passes through.
    pub transparent: bool,
    /// Whether Fresnel's equations share out what passes.
    pub fresnel: bool,
    /// Whether it reflects or refracts rays.
    pub secondary: bool,
}

/// Metallic-roughness surfaces smoother than this mirror and refract rays.
const MIRROR_ROUGHNESS: f32 = 0.1;

impl FlatMaterial {
    fn new(material: &Material) -> Self {
        let parts = |source: ColorSource| (source.factor, source.texture.map(|lookup| lookup.texture));
        let (color, color_texture) = parts(material.color);
        let (emission, emission_texture) = parts(material.emission);
        let mut rows = [0.0; ROWS];
        let mut put = |row: Row, values: &[f32]| {
            rows[row as usize..row as usize + values.len()].copy_from_slice(values);
        };
        put(Row::Color, &color.to_array());
        put(Row::Opacity, &(Vec3::ONE - material.transparency).to_array());
        put(Row::Emission, &emission.to_array());
        put(Row::Reflectivity, &material.reflectivity.to_array());
        put(Row::Transparency, &material.transparency.to_array());
        put(Row::Ior, &[material.ior]);
        let mut smooth = true;
        match material.model {
            Model::Phong { ambient, diffuse, specular, shininess } => {
                put(Row::Ambient, &ambient.to_array());
                put(Row::Diffuse, &diffuse.to_array());
                put(Row::Specular, &specular.to_array());
                put(Row::Shininess, &[shininess]);
                put(Row::HighlightEdge2, &[highlight_edge2(shininess)]);
                put(Row::Roughness, &[-1.0]);
            }
            Model::MetallicRoughness { ambient, metallic, roughness } => {
                put(Row::Ambient, &ambient.to_array());
                put(Row::Metallic, &[metallic]);
                put(Row::Roughness, &[roughness]);
                smooth = roughness < MIRROR_ROUGHNESS;
            }
        }
        let metallic_roughness = matches!(material.model, Model::MetallicRoughness { .. });
        let mirrors = metallic_roughness || material.reflectivity != Vec3::ZERO;
        Self {
            shiny: rows[Row::Specular as usize..][..3] != [0.0; 3],
            emissive: emission != Vec3::ZERO,
            transparent: material.is_transparent(),
            fresnel: material.fresnel,
            rows,
            color_texture,
            emission_texture,
            metallic_roughness,
            secondary: smooth && (mirrors || material.is_transparent()),
        }
    }
}

/// Square of the n·h at which (n·h)^shininess is 2^-24: less changes no colour of the highlight's order.
fn highlight_edge2(shininess: f32) -> f32 {
    libm::exp2(-48.0 / f64::from(shininess).abs()) as f32
}

impl FlatMaterial {
    /// Whether any of its colours is looked up.
    pub fn is_textured(&self) -> bool {
        self.color_texture.is_some() || self.emission_texture.is_some()
    }
}

/// A primitive that carries nothing.
const NOTHING: u32 = u32::MAX;

/// Flattened materials and what shadow rays need to know of primitives.
#[derive(Debug, Default)]
pub struct Tables {
    /// The scene that they belong to.
    pub generation: Option<u64>,
    /// As the scene's materials.
    pub materials: Vec<FlatMaterial>,
    /// The material of each primitive.
    pub material_of: Vec<u32>,
    /// Where the attributes of each primitive lie, or [`NOTHING`]; empty where none carries any.
    attributes_of: Vec<u32>,
    /// For each primitive whether it blocks all light; empty where every one does.
    pub opaque: Vec<bool>,
    /// Objects that bound a transparent body.
    pub transparent_bodies: Vec<u32>,
    /// Whether anything flat mirrors.
    pub flat_mirrors: bool,
}

impl Tables {
    /// The tables of a scene.
    pub fn new(scene: &Scene) -> Self {
        let material_of = |object: u32| &scene.materials[scene.objects[object as usize].material as usize];
        let transparent = scene.objects.iter().any(|o| scene.materials[o.material as usize].is_transparent());
        let opaque = if transparent {
            scene.geometry.ids.iter().map(|id| !material_of(id.object).is_transparent()).collect()
        } else {
            Vec::new()
        };
        let transparent_bodies = (0..scene.objects.len() as u32)
            .filter(|&o| scene.objects[o as usize].body && material_of(o).is_transparent())
            .collect();
        let materials: Vec<FlatMaterial> = scene.materials.iter().map(FlatMaterial::new).collect();
        let mirrors = |object: u32| materials[scene.objects[object as usize].material as usize].secondary;
        let primitives = scene.geometry.slots.iter().zip(&scene.geometry.ids);
        let flat_mirrors = materials.iter().any(|material| material.secondary)
            && primitives.into_iter().any(|(slot, id)| slot.kind.is_flat() && mirrors(id.object));
        let mut attributes_of = Vec::new();
        if !scene.geometry.attributes.is_empty() {
            attributes_of.resize(scene.geometry.len(), NOTHING);
            for (place, (primitive, _)) in (0..).zip(&scene.geometry.attributes) {
                attributes_of[*primitive as usize] = place;
            }
        }
        Self {
            generation: Some(scene.generation),
            material_of: scene.geometry.ids.iter().map(|id| scene.objects[id.object as usize].material).collect(),
            attributes_of,
            materials,
            opaque,
            transparent_bodies,
            flat_mirrors,
        }
    }

    /// What the corners of a primitive carry, in the kernel's order.
    #[inline]
    pub fn attributes<'a>(&self, geometry: &'a Geometry, primitive: PrimitiveIndex) -> Option<&'a VertexAttributes> {
        let place = *self.attributes_of.get(primitive as usize)?;
        geometry.attributes.get(place as usize).map(|(_, attributes)| attributes)
    }

    /// What blocks all light.
    pub fn opaque(&self) -> Opaque<'_> {
        if self.opaque.is_empty() { Opaque::All } else { Opaque::Listed(&self.opaque) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn highlights_end_where_they_are_too_weak_to_be_seen() {
        for shininess in [1.0_f32, 50.0, 1e4] {
            let edge = f64::from(highlight_edge2(shininess)).sqrt();
            let left = edge.powf(shininess.into()) * f64::from(1 << 24);
            assert!((left - 1.0).abs() < 1e-2, "{shininess}: {left}");
        }
        assert_eq!(highlight_edge2(0.0), 0.0);
    }
}
