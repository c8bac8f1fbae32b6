//! What a scene holds, in numbers.

use crate::geometry::PrimitiveKind;
use crate::scene::texture::Texture;
use crate::scene::{Material, Object, Scene, Sky};
use serde::Serialize;

/// How much of what a scene holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SceneCounts {
    /// Bytes held by geometry, tree, objects, materials, textures and the sky.
    pub scene_bytes: u64,
    /// Triangles.
    pub triangles: u64,
    /// Spheres.
    pub spheres: u64,
    /// Everything a ray can meet, triangles and spheres included.
    pub primitives: u64,
    /// Lights, the headlight of a scene without any included.
    pub lights: u64,
    /// Leaf objects.
    pub objects: u64,
}

impl SceneCounts {
    /// Counts `scene`.
    pub fn of(scene: &Scene) -> Self {
        let texels: usize = scene.textures.iter().map(texture_bytes).sum();
        let tables = scene.objects.len() * size_of::<Object>() + scene.materials.capacity() * size_of::<Material>();
        Self {
            scene_bytes: (scene.geometry.bytes() + texels + tables + sky_bytes(scene)) as u64,
            triangles: (scene.geometry.count(PrimitiveKind::Triangle) + scene.geometry.count(PrimitiveKind::Cutout))
                as u64,
            spheres: scene.geometry.count(PrimitiveKind::Sphere) as u64,
            primitives: scene.geometry.len() as u64,
            lights: (scene.lights.len() + usize::from(scene.headlight)) as u64,
            objects: scene.objects.len() as u64,
        }
    }
}

fn sky_bytes(scene: &Scene) -> usize {
    match scene.environment.as_ref().map(|environment| &environment.sky) {
        Some(Sky::Image(image)) => size_of_val(&*image.texels),
        _ => 0,
    }
}

fn texture_bytes(texture: &Texture) -> usize {
    size_of::<Texture>()
        + match texture {
            Texture::Image(image) => image.texels.bytes(),
            Texture::Checker { .. } => 0,
        }
}
