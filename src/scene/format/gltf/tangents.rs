//! Tangents for normal maps, where a mesh brings none (Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008): what
//! the specification asks for, and what most maps were baked with.

use crate::scene::desc::MeshDesc;
use crate::scene::guard::guarded;
use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::{Affine2, DVec3, Vec4};
use std::collections::HashMap;

/// Gives a mesh tangents along the texture coordinates of set `set`, seen through `transform` like the map. Vertices at which they break are doubled, so that
/// one vertex has one tangent. `false` where the mesh has no such coordinates, or no tangents can be made.
pub fn generate(mesh: &mut MeshDesc, set: u8, transform: Affine2) -> bool {
    let has_coordinates = if set == 0 { !mesh.uvs.is_empty() } else { !mesh.uvs1.is_empty() };
    if !has_coordinates || mesh.triangles.is_empty() {
        return false;
    }
    let none = Vec4::new(1.0, 0.0, 0.0, 1.0);
    let mut corners = Corners { mesh, set, transform, tangents: vec![[none; 3]; mesh.triangles.len()] };
    // It is not meant to panic on any mesh; should it do so, only the normal map is lost.
    let made = guarded(|| generate_tangents(&mut corners).is_ok()).unwrap_or(false);
    let tangents = corners.tangents;
    if made {
        distribute(mesh, &tangents);
    }
    made
}

/// Tangents of each triangle's corners in the making.
struct Corners<'a> {
    mesh: &'a MeshDesc,
    set: u8,
    transform: Affine2,
    tangents: Vec<[Vec4; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

/// The functions that would differ between machines.
struct Exact;

impl Ops for Exact {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}

impl Geometry<Exact> for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.vertices[self.vertex(face, corner)].as_vec3().to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let normal = match self.mesh.normals.get(self.vertex(face, corner)) {
            Some(normal) => *normal,
            None => {
                let [a, b, c] = self.mesh.triangles[face].map(|i| self.mesh.vertices[i as usize]);
                (b - a).cross(c - a)
            }
        };
        normal.try_normalize().unwrap_or(DVec3::Y).as_vec3().to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let vertex = self.vertex(face, corner);
        let uv = if self.set == 0 { self.mesh.uvs[vertex].as_vec2() } else { self.mesh.uvs1[vertex] };
        self.transform.transform_point2(uv).to_array()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(space) = space {
            self.tangents[face][corner] = Vec4::from_array(space.tangent_encoded());
        }
    }
}

/// Hands each vertex its tangent. A vertex whose corners got different ones is doubled.
fn distribute(mesh: &mut MeshDesc, tangents: &[[Vec4; 3]]) {
    let mut own: Vec<Option<Vec4>> = vec![None; mesh.vertices.len()];
    let mut doubles = HashMap::new();
    for (triangle, tangents) in mesh.triangles.iter_mut().zip(tangents) {
        for (vertex, &tangent) in triangle.iter_mut().zip(tangents) {
            let place = *vertex as usize;
            match own[place] {
                None => own[place] = Some(tangent),
                Some(other) if other == tangent => {}
                Some(_) => {
                    let key = (*vertex, tangent.to_array().map(f32::to_bits));
                    *vertex = *doubles.entry(key).or_insert_with(|| {
                        own.push(Some(tangent));
                        double(&mut mesh.vertices, place);
                        double(&mut mesh.normals, place);
                        double(&mut mesh.uvs, place);
                        double(&mut mesh.uvs1, place);
                        double(&mut mesh.colors, place);
                        own.len() as u32 - 1
                    });
                }
            }
        }
    }
    mesh.tangents = own.into_iter().map(|tangent| tangent.unwrap_or(Vec4::new(1.0, 0.0, 0.0, 1.0))).collect();
}

fn double<T: Copy>(values: &mut Vec<T>, place: usize) {
    if let Some(&value) = values.get(place) {
        values.push(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, Vec2};

    /// Two triangles in the x-y plane that share an edge.
    fn square(uvs: [[f64; 2]; 4]) -> MeshDesc {
        MeshDesc {
            vertices: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            normals: vec![DVec3::Z; 4],
            uvs: uvs.map(DVec2::from_array).to_vec(),
            ..MeshDesc::default()
        }
    }

    #[test]
    fn tangents_follow_u_and_the_sign_follows_v() {
        let mut plain = square([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert!(generate(&mut plain, 0, Affine2::IDENTITY));
        assert_eq!(plain.tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
        let mut mirrored = square([[1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
        assert!(generate(&mut mirrored, 0, Affine2::IDENTITY));
        assert_eq!(mirrored.tangents, [Vec4::new(-1.0, 0.0, 0.0, -1.0); 4]);
        // So it is for coordinates that are mirrored on their way to the map.
        let mut seen_mirrored = square([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert!(generate(&mut seen_mirrored, 0, Affine2::from_scale(Vec2::new(-1.0, 1.0))));
        assert_eq!(seen_mirrored.tangents, mirrored.tangents);
    }

    #[test]
    fn a_seam_doubles_its_vertices() {
        // The second triangle's texture is mirrored at the diagonal.
        let mut mesh = square([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 0.0]]);
        assert!(generate(&mut mesh, 0, Affine2::IDENTITY));
        assert_eq!(mesh.vertices.len(), 6);
        assert_eq!([mesh.normals.len(), mesh.uvs.len(), mesh.tangents.len()], [6; 3]);
        assert!(mesh.triangles[0].iter().all(|i| !mesh.triangles[1].contains(i)));
        assert!(!generate(&mut mesh, 1, Affine2::IDENTITY), "there are no second coordinates");
    }
}
