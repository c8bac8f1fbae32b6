//! What shading reads of a scene, flattened for gathering into lanes. Made once a scene.

use crate::geometry::{Geometry, Home, Opaque, OpaqueList, PrimitiveIndex, SharedMesh, VertexAttributes, VertexExtras};
use crate::scene::material::{Lookup, Model, Relief, Scaled};
use crate::scene::sky::{LEAST_ROUGHNESS, SkyLight};
use crate::scene::{Material, Scene, Texture};
use glam::{Vec3, Vec4};

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
    /// How much of what is seen is the surface's own, before textures.
    Coverage = 29,
    /// Share of light from straight ahead that it reflects where it is no metal, metallic-roughness only.
    DielectricF0 = 30,
}

/// Numbers a material has.
pub const ROWS: usize = 31;

/// One material, flattened.
#[derive(Clone, Debug)]
pub struct FlatMaterial {
    /// The numbers that [`Row`] names.
    pub rows: [f32; ROWS],
    /// What is looked up.
    pub maps: Maps,
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
    /// Whether it reflects or refracts rays; metallic-roughness may do so only where it is smooth.
    pub secondary: bool,
    /// Whether what lies straight behind shines through.
    pub blended: bool,
    /// Whether it shows its colour whatever the light.
    pub unlit: bool,
    /// Whether it has relief.
    pub relieved: bool,
    /// Whether anything of it is looked up.
    pub textured: bool,
}

/// Where the numbers of a material vary over its surface.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Surface colour, and opacity.
    pub color: Option<Lookup>,
    /// Light given off.
    pub emission: Option<Lookup>,
    /// Roughness (green) and metallic (blue).
    pub metallic_roughness: Option<Lookup>,
    /// Share of the ambient light that arrives (red).
    pub occlusion: Option<Scaled>,
    /// Share of the transparency (red).
    pub transmission: Option<Lookup>,
    /// Relief.
    pub relief: Relief,
    /// Whether any of them asks for the second texture coordinates.
    pub uses_second_set: bool,
    /// Whether any of them is an image.
    pub uses_images: bool,
    /// Whether any of them is a checker.
    pub uses_checkers: bool,
}

impl Maps {
    fn new(material: &Material, textures: &[Texture]) -> Self {
        let is_checker = |lookup: &Lookup| matches!(textures[lookup.texture as usize], Texture::Checker { .. });
        Self {
            color: material.color.texture,
            emission: material.emission.texture,
            metallic_roughness: material.metallic_roughness,
            occlusion: material.occlusion,
            transmission: material.transmission,
            relief: material.relief,
            uses_second_set: material.lookups().any(|lookup| lookup.set != 0),
            uses_images: material.lookups().any(|lookup| !is_checker(lookup)),
            uses_checkers: material.lookups().any(is_checker),
        }
    }
}

/// Metallic-roughness surfaces smoother than this mirror and refract rays.
pub(super) const MIRROR_ROUGHNESS: f32 = LEAST_ROUGHNESS;

impl FlatMaterial {
    fn new(material: &Material, textures: &[Texture]) -> Self {
        let (color, emission) = (material.color.factor, material.emission.factor);
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
        put(Row::Coverage, &[if material.is_blended() { material.opacity } else { 1.0 }]);
        let mut smooth = true;
        match material.model {
            // Its own colour stands for the light: nothing arrives, nothing is mirrored.
            _ if material.unlit => put(Row::Roughness, &[-1.0]),
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
                put(Row::DielectricF0, &[dielectric_f0(material.ior)]);
                smooth = roughness < MIRROR_ROUGHNESS || material.metallic_roughness.is_some();
            }
        }
        let metallic_roughness = matches!(material.model, Model::MetallicRoughness { .. }) && !material.unlit;
        let maps = Maps::new(material, textures);
        let textured = material.lookups().next().is_some();
        let mirrors = metallic_roughness || material.reflectivity != Vec3::ZERO;
        Self {
            shiny: rows[Row::Specular as usize..][..3] != [0.0; 3],
            emissive: emission != Vec3::ZERO,
            transparent: material.is_transparent(),
            fresnel: material.fresnel,
            rows,
            textured,
            maps,
            metallic_roughness,
            // What is seen straight through is so however rough the surface.
            secondary: material.is_blended() || !material.unlit && smooth && (mirrors || material.is_transparent()),
            blended: material.is_blended(),
            unlit: material.unlit,
            relieved: material.relief != Relief::NONE,
        }
    }
}

/// Share of light from straight ahead that a dielectric of this index of refraction reflects (`KHR_materials_ior`).
fn dielectric_f0(ior: f32) -> f32 {
    let ior = f64::from(ior);
    let amplitude = (ior - 1.0) / (ior + 1.0);
    (amplitude * amplitude) as f32
}

/// Square of the n·h at which (n·h)^shininess is 2^-24: less changes no colour of the highlight's order.
fn highlight_edge2(shininess: f32) -> f32 {
    libm::exp2(-48.0 / f64::from(shininess).abs()) as f32
}

impl FlatMaterial {
    fn put(&mut self, row: Row, values: &[f32]) {
        self.rows[row as usize..row as usize + values.len()].copy_from_slice(values);
    }

    /// Whether what it reflects has a colour.
    pub fn may_be_metal(&self) -> bool {
        self.metallic_roughness && self.rows[Row::Metallic as usize] != 0.0
    }

    /// Whether its light varies by more than its colour: what is interpolated would be missing something.
    pub fn is_uneven(&self) -> bool {
        let Maps { metallic_roughness, occlusion, .. } = &self.maps;
        self.relieved || self.blended || self.unlit || metallic_roughness.is_some() || occlusion.is_some()
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
    /// The material of each primitive that is not part of an instance.
    materials_of: Vec<u32>,
    /// The material of each instance.
    materials_of_instances: Vec<u32>,
    /// Where the attributes of each primitive of the former lie, or [`NOTHING`]; empty where none carries any.
    attributes_of: Vec<u32>,
    /// Where the extras of each primitive lie, in the same way.
    extras_of: Vec<u32>,
    /// Whether any triangle carries tangents.
    pub tangents: bool,
    /// Whether any triangle carries colours.
    pub vertex_colors: bool,
    /// What blocks all light; `None` where everything does.
    pub opaque: Option<OpaqueList>,
    /// Objects that bound a transparent body.
    pub transparent_bodies: Vec<u32>,
    /// Whether anything flat mirrors.
    pub flat_mirrors: bool,
    /// The light of the sky, if there is one.
    pub sky: Option<SkyLight>,
    /// What the colours of unlit materials are multiplied by.
    unlit_gain: f32,
}

impl Tables {
    /// The tables of a scene.
    pub fn new(scene: &Scene) -> Self {
        let transparent = scene.objects.iter().any(|o| scene.materials[o.material as usize].is_transparent());
        let opaque =
            transparent.then(|| OpaqueList::new(&scene.geometry, |object| !scene.material_of(object).is_transparent()));
        let transparent_bodies = (0..scene.objects.len() as u32)
            .filter(|&o| scene.objects[o as usize].body && scene.material_of(o).is_transparent())
            .collect();
        let materials: Vec<FlatMaterial> =
            scene.materials.iter().map(|material| FlatMaterial::new(material, &scene.textures)).collect();
        let mirrors = |object: u32| materials[scene.objects[object as usize].material as usize].secondary;
        let (own, instances) = (|| scene.geometry.own(), &scene.geometry.instances);
        let flat_mirrors = materials.iter().any(|material| material.secondary)
            && (own().any(|(slot, id)| slot.kind.is_flat() && mirrors(id.object))
                || instances.placed.iter().any(|instance| mirrors(instance.object)));
        let material_number = |object: u32| scene.objects[object as usize].material;
        Self {
            generation: Some(scene.generation),
            materials_of: own().map(|(_, id)| material_number(id.object)).collect(),
            materials_of_instances: instances.placed.iter().map(|own| material_number(own.object)).collect(),
            tangents: scene.geometry.extras.iter().any(|(_, extras)| extras.tangents != [Vec4::ZERO; 3])
                || instances.meshes.iter().any(SharedMesh::has_tangents),
            vertex_colors: scene.geometry.extras.iter().any(|(_, extras)| extras.colors != [Vec4::ONE; 3])
                || instances.meshes.iter().any(SharedMesh::has_colors),
            attributes_of: places(own().len(), &scene.geometry.attributes),
            extras_of: places(own().len(), &scene.geometry.extras),
            materials,
            opaque,
            transparent_bodies,
            flat_mirrors,
            sky: scene.environment.as_ref().map(SkyLight::new),
            unlit_gain: 1.0,
        }
    }

    /// Multiplies the colours of the scene's unlit materials. What glows takes part where that makes it brighter: in the
    /// dark it may outshine all else.
    pub fn set_unlit_gain(&mut self, scene: &Scene, gain: f32) {
        if self.unlit_gain == gain {
            return;
        }
        self.unlit_gain = gain;
        for (flat, material) in self.materials.iter_mut().zip(&scene.materials) {
            let emission = (material.emission.factor * gain.max(1.0)).min(Vec3::splat(f32::MAX));
            flat.put(Row::Emission, &emission.to_array());
            if material.unlit {
                flat.put(Row::Color, &(material.color.factor * gain).to_array());
            }
        }
    }

    /// What the colours of unlit materials are multiplied by.
    pub fn unlit_gain(&self) -> f32 {
        self.unlit_gain
    }

    /// The material of a primitive.
    #[inline(always)]
    pub fn material_of(&self, geometry: &Geometry, primitive: PrimitiveIndex) -> u32 {
        match geometry.instances.find(primitive) {
            Home::Own(own) => self.materials_of[own as usize],
            Home::Shared(triangle) => self.materials_of_instances[triangle.instance as usize],
        }
    }

    /// Of what the corners of a primitive carry, in the kernel's order, what is to be picked.
    #[inline(always)]
    pub fn attributes<T>(
        &self,
        geometry: &Geometry,
        primitive: PrimitiveIndex,
        pick: impl Fn(&VertexAttributes) -> T,
    ) -> Option<T> {
        match geometry.instances.find(primitive) {
            Home::Own(own) => {
                let place = *self.attributes_of.get(own as usize)?;
                geometry.attributes.get(place as usize).map(|(_, attributes)| pick(attributes))
            }
            Home::Shared(triangle) => geometry.instances.attributes(triangle).map(|attributes| pick(&attributes)),
        }
    }

    /// Of what they carry besides, in the same order, what is to be picked.
    #[inline(always)]
    pub fn extras<T>(
        &self,
        geometry: &Geometry,
        primitive: PrimitiveIndex,
        pick: impl Fn(&VertexExtras) -> T,
    ) -> Option<T> {
        match geometry.instances.find(primitive) {
            Home::Own(own) => {
                let place = *self.extras_of.get(own as usize)?;
                geometry.extras.get(place as usize).map(|(_, extras)| pick(extras))
            }
            Home::Shared(triangle) => geometry.instances.extras(triangle).map(|extras| pick(&extras)),
        }
    }

    /// What of `geometry`, which they were made of, blocks all light.
    pub fn opaque<'a>(&'a self, geometry: &'a Geometry) -> Opaque<'a> {
        self.opaque.as_ref().map_or(Opaque::All, |list| Opaque::Listed(list.of(&geometry.instances)))
    }
}

/// Where in a list each of `count` primitives has its entry, or [`NOTHING`]; empty if the list is.
fn places<T>(count: usize, list: &[(PrimitiveIndex, T)]) -> Vec<u32> {
    if list.is_empty() {
        return Vec::new();
    }
    let mut places = vec![NOTHING; count];
    for (place, (primitive, _)) in (0..).zip(list) {
        places[*primitive as usize] = place;
    }
    places
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

    #[test]
    fn a_usual_dielectric_reflects_a_twenty_fifth_to_the_last_bit() {
        assert_eq!(dielectric_f0(1.5).to_bits(), 0.04_f32.to_bits());
        assert_eq!((dielectric_f0(1.0), dielectric_f0(3.0)), (0.0, 0.25));
        assert_eq!([1e10, f32::MAX].map(dielectric_f0), [1.0; 2]);
    }
}
