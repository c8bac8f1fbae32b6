//! What is shown for colours that are missing: squares of two greys, a metre wide where the mapping allows it.

use super::placement::Placement;
use crate::scene::Material;
use crate::scene::desc::MeshDesc;
use crate::scene::texture::Texture;
use glam::{DVec2, Vec3};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The greys, linear: 118 and 138 in sRGB.
const GREYS: [Vec3; 2] = [Vec3::splat(0.181), Vec3::splat(0.254)];
/// Edge of a square in the scene's unit of length, which is a metre where the file keeps to it.
const EDGE: f64 = 1.0;
/// Squares along the edge of one as large as all that a placeholder is on: more, as in files in millimetres, would be noise.
const MOST_SQUARES: f64 = 256.0;

/// The placeholders of a scene under construction.
#[derive(Debug, Default)]
pub struct Placeholders {
    /// By texture: areas in the world and in texture coordinates.
    areas: HashMap<u32, [f64; 2]>,
    /// The meshes that were measured for a texture, by their address: descriptions keep them while objects are added.
    measured: HashSet<(u32, *const MeshDesc)>,
}

impl Placeholders {
    /// One for a texture.
    pub fn add(&mut self, texture: u32) -> Texture {
        self.areas.insert(texture, [0.0; 2]);
        Texture::Checker { colors: GREYS, size: EDGE as f32 }
    }

    /// Forgets what was measured, and all but the first so many textures.
    pub fn start_over(&mut self, textures: u32) {
        self.areas.retain(|texture, _| *texture < textures);
        self.areas.values_mut().for_each(|areas| *areas = [0.0; 2]);
        self.measured.clear();
    }

    /// Takes a mesh into account that may show one. What is placed again counts once.
    pub fn measure(&mut self, material: &Material, mesh: &Arc<MeshDesc>, placement: &Placement) {
        let Some(lookup) = material.color.texture else { return };
        let Some(areas) = self.areas.get_mut(&lookup.texture) else { return };
        if !self.measured.insert((lookup.texture, Arc::as_ptr(mesh))) {
            return;
        }
        let scale = f64::from(lookup.transform.matrix2.determinant().abs());
        let coordinates = |corner: u32| match lookup.set {
            0 => mesh.uvs.get(corner as usize).copied().unwrap_or_default(),
            _ => mesh.uvs1.get(corner as usize).map_or(DVec2::ZERO, |uv| uv.as_dvec2()),
        };
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|corner| placement.point(mesh.vertices[corner as usize]));
            let [u, v, w] = triangle.map(coordinates);
            areas[0] += (b - a).cross(c - a).length() / 2.0;
            areas[1] += scale * (v - u).perp_dot(w - u).abs() / 2.0;
        }
    }

    /// Gives the squares of all placeholders their size.
    pub fn finish(self, textures: &mut [Texture]) {
        for (texture, [world, mapped]) in self.areas {
            if let Texture::Checker { size, .. } = &mut textures[texture as usize] {
                let edge = EDGE.max(world.sqrt() / MOST_SQUARES);
                let in_coordinates = (edge * (mapped / world).sqrt()) as f32;
                // Without areas there are no squares to be seen.
                if in_coordinates.is_finite() && in_coordinates > 0.0 && (1.0 / in_coordinates).is_finite() {
                    *size = in_coordinates;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::material::{ColorSource, Lookup};
    use glam::DVec3;

    /// The size of squares on a rectangle of `size` whose coordinates go from 0 to `uv`.
    fn squares(size: f64, uv: f64) -> f32 {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let mesh = Arc::new(MeshDesc {
            vertices: corners.iter().map(|(x, y)| DVec3::new(*x, *y, 0.0) * size).collect(),
            uvs: corners.iter().map(|(x, y)| DVec2::new(*x, *y) * uv).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..MeshDesc::default()
        });
        let color = ColorSource::textured(Lookup::new(0));
        let material = Material { color, ..Material::default_phong() };
        let mut placeholders = Placeholders::default();
        let mut textures = [placeholders.add(0)];
        for _ in 0..2 {
            placeholders.measure(&material, &mesh, &Placement::WORLD);
        }
        placeholders.finish(&mut textures);
        let [Texture::Checker { size, .. }] = textures else { panic!("squares") };
        size
    }

    #[test]
    fn squares_are_a_metre_wide_but_not_too_many() {
        assert_eq!(squares(4.0, 1.0), 0.25);
        assert_eq!(squares(4.0, 8.0), 2.0);
        assert_eq!(squares(0.5, 1.0), 2.0);
        assert_eq!(squares(25_600.0, 1.0), 1.0 / 256.0);
        for odd in [squares(1.0, 0.0), squares(0.0, 1.0), squares(1.0, f64::NAN), squares(1e300, 1.0)] {
            assert_eq!(odd, 1.0);
        }
    }
}
