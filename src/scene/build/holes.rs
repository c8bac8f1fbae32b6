//! Maps of holes: the opacities of textures whose materials cut out what is transparent.

use crate::geometry::{HoleMap, Holes};
use crate::scene::desc::MeshDesc;
use crate::scene::material::{Alpha, Lookup, Material};
use crate::scene::texels::Texels;
use crate::scene::texture::{Blending, ImageTexture, Texture, Wrap};
use glam::Vec2;
use std::collections::HashMap;
use std::sync::Arc;

/// The maps of a scene under construction.
#[derive(Default)]
pub struct HoleMaps {
    /// Those that are used.
    pub maps: Vec<HoleMap>,
    /// The map of each material that was asked for one.
    of_material: HashMap<u32, u32>,
    /// The opacities of each picture, by its address: textures keep them all.
    opacities: HashMap<*const Texels, Arc<[u8]>>,
}

/// How meshes of one material are cut.
pub struct Cut {
    map: u32,
    lookup: Option<Lookup>,
    /// Size of the picture in units of u and v.
    size: f32,
    opacity: f32,
}

impl HoleMaps {
    /// How a mesh of a material is cut; `None` where nothing is.
    pub fn cut(&mut self, material: u32, materials: &[Material], textures: &[Texture], mesh: &MeshDesc) -> Option<Cut> {
        let own = &materials[material as usize];
        let Alpha::Mask(cutoff) = own.alpha else { return None };
        let lookup = own.color.texture;
        let image = lookup.and_then(|lookup| match &textures[lookup.texture as usize] {
            Texture::Image(image) => Some(image),
            Texture::Checker { .. } => None,
        });
        let is_whole = own.opacity >= cutoff
            && mesh.colors.iter().all(|color| color.w >= 1.0)
            && image.is_none_or(|image| !image.texels.has_holes());
        if is_whole {
            return None;
        }
        let map = match self.of_material.get(&material) {
            Some(&map) => map,
            None => {
                let map = self.maps.len() as u32;
                let added = self.map(image, cutoff);
                self.maps.push(added);
                self.of_material.insert(material, map);
                map
            }
        };
        let size = image.map_or(1.0, |image| image.size);
        Some(Cut { map, lookup: lookup.filter(|_| image.is_some()), size, opacity: own.opacity })
    }

    fn map(&mut self, image: Option<&ImageTexture>, cutoff: f32) -> HoleMap {
        let Some(ImageTexture { texels, sampler, .. }) = image else {
            let whole = Arc::new([u8::MAX]);
            return HoleMap { opacities: whole, width: 1, height: 1, wrap: [Wrap::Clamp; 2], blended: false, cutoff };
        };
        let opacities = self.opacities.entry(Arc::as_ptr(texels)).or_insert_with(|| texels.opacities());
        HoleMap {
            opacities: Arc::clone(opacities),
            width: texels.width(),
            height: texels.height(),
            wrap: sampler.wrap,
            blended: sampler.magnification == Blending::Linear,
            cutoff,
        }
    }
}

impl Cut {
    /// Where a triangle of a mesh lies on the map.
    pub fn corners(&self, mesh: &MeshDesc, corners: [usize; 3]) -> Holes {
        let on_map = |corner: usize| {
            let Some(lookup) = self.lookup else { return Vec2::ZERO };
            let uv = match lookup.set {
                0 => mesh.uvs.get(corner).map(|uv| uv.as_vec2()),
                _ => mesh.uvs1.get(corner).copied(),
            };
            lookup.transform.transform_point2(uv.unwrap_or_default()) / self.size
        };
        let opacity = |corner: usize| self.opacity * mesh.colors.get(corner).map_or(1.0, |color| color.w);
        Holes { map: self.map, uvs: corners.map(on_map), opacities: corners.map(opacity) }
    }
}
