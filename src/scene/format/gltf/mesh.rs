//! Primitives of meshes: attributes and indices to triangles over shared vertices.

use super::accessor::{Accessor, Which};
use super::document::{Document, room};
use super::fault::{Fault, Read};
use super::nodes::Nodes;
use super::skin::{self, Holder};
use super::{tangents, topology};
use crate::scene::desc::{MeshDesc, NameRef};
use crate::scene::material::Lookup;
use glam::{DVec2, DVec3, Vec2, Vec4};
use gltf::json::mesh::{MorphTarget, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{self, Index};

/// The extension that hides vertices in a stream of its own.
const DRACO: &str = "KHR_draco_mesh_compression";

/// What is to be read of a primitive, and how.
pub struct Job<'a> {
    /// The primitive.
    pub primitive: &'a Primitive,
    /// Where it stands.
    pub pointer: String,
    /// How far the mesh is morphed towards each of its targets.
    pub weights: &'a [f32],
    /// What holds it, if it has a skin.
    pub held_by: Option<Holder>,
    /// Whether its material looks up second texture coordinates.
    pub second_coordinates: bool,
    /// How its material looks up a normal map, if it has one.
    pub normal_map: Option<&'a Lookup<NameRef>>,
}

/// What was read.
pub struct Drawn {
    /// The triangles.
    pub mesh: MeshDesc,
    /// What was odd.
    pub notes: Vec<String>,
}

impl Job<'_> {
    /// Reads the primitive; the error side of the inner result says why there is nothing to draw.
    pub fn read(&self, document: &Document, nodes: &Nodes) -> Read<Result<Drawn, String>> {
        let mut notes = Vec::new();
        let Checked::Valid(mode) = self.primitive.mode else {
            return Err(Fault::new(format!("{}/mode", self.pointer), "unknown mode; expected 0 to 6"));
        };
        if let Some(why) = self.hidden(document) {
            return Err(Fault::new(&self.pointer, why));
        }
        let Some(positions) = self.open(document, Semantic::Positions)? else {
            return Ok(Err("a primitive without POSITION is not drawn".to_owned()));
        };
        let count = positions.count();
        let Ok(vertex_count) = u32::try_from(count) else {
            return Err(Fault::new(&self.pointer, "more than 2^32 vertices"));
        };
        let indices = self.indices(document, vertex_count)?;
        let Some(triangles) = topology::triangles(mode, indices.as_deref(), vertex_count) else {
            return Ok(Err("points and lines are not drawn".to_owned()));
        };
        if mode == json::mesh::Mode::Triangles && !indices.as_ref().map_or(count, Vec::len).is_multiple_of(3) {
            notes.push("the number of corners is no multiple of 3; those left over are not drawn".to_owned());
        }
        drop(indices);
        let (triangles, used) = only_used(triangles, count);
        let which = used.as_deref().map_or(Which::All, Which::These);

        let mut positions: Vec<[f32; 3]> = positions.vectors(which)?;
        self.morph(document, which, &mut positions, |target| target.positions)?;
        let mut mesh = MeshDesc { triangles, vertices: self.vectors(&positions)?, ..MeshDesc::default() };
        drop(positions);
        if let Some(normals) = self.vertex_attribute(document, Semantic::Normals, count)? {
            let mut normals: Vec<[f32; 3]> = normals.vectors(which)?;
            self.morph(document, which, &mut normals, |target| target.normals)?;
            mesh.normals = self.vectors(&normals)?;
        }
        if let Some(uvs) = self.vertex_attribute(document, Semantic::TexCoords(0), count)? {
            let upwards = |[u, v]: &[f32; 2]| DVec2::new((*u).into(), 1.0 - f64::from(*v));
            mesh.uvs = uvs.vectors(which)?.iter().map(upwards).collect();
        }
        if self.second_coordinates
            && let Some(uvs) = self.vertex_attribute(document, Semantic::TexCoords(1), count)?
        {
            mesh.uvs1 = uvs.vectors(which)?.iter().map(|[u, v]| Vec2::new(*u, 1.0 - v)).collect();
        }
        if let Some(colors) = self.vertex_attribute(document, Semantic::Colors(0), count)? {
            mesh.colors = colors.colors(which)?.into_iter().map(Vec4::from_array).collect();
        }
        if let Some(map) = self.normal_map {
            match self.vertex_attribute(document, Semantic::Tangents, count)?.filter(|_| !mesh.normals.is_empty()) {
                Some(tangents) => mesh.tangents = tangents.vectors(which)?.into_iter().map(Vec4::from_array).collect(),
                None if !tangents::generate(&mut mesh, map.set, map.transform) => {
                    notes.push("the normal map has no texture coordinates to follow; it is not shown".to_owned());
                }
                None => {}
            }
        }
        if let Some(holder) = self.held_by {
            skin::hold(document, self.primitive, &self.pointer, which, holder, nodes, &mut mesh)?;
        }
        notes.extend(replace_odd_normals(&mut mesh));
        Ok(Ok(Drawn { mesh, notes }))
    }

    /// Why the primitive's vertices are out of reach, if they are.
    fn hidden(&self, document: &Document) -> Option<&'static str> {
        let extensions = self.primitive.extensions.as_ref()?;
        extensions.others.contains_key(DRACO).then_some(())?;
        let position = self.primitive.attributes.get(&Checked::Valid(Semantic::Positions))?;
        let accessor = document.root.accessors.get(position.value())?;
        accessor.buffer_view.is_none().then_some(
            "the mesh is compressed by KHR_draco_mesh_compression, which is not supported; export it uncompressed",
        )
    }

    fn open<'d>(&self, document: &'d Document, semantic: Semantic) -> Read<Option<Accessor<'d>>> {
        let name = semantic.to_string();
        let Some(&index) = self.primitive.attributes.get(&Checked::Valid(semantic)) else { return Ok(None) };
        Accessor::open(document, index, format_args!("{}/attributes/{name}", self.pointer)).map(Some)
    }

    /// An attribute with one entry a vertex.
    fn vertex_attribute<'d>(
        &self,
        document: &'d Document,
        semantic: Semantic,
        count: usize,
    ) -> Read<Option<Accessor<'d>>> {
        let name = semantic.to_string();
        let accessor = self.open(document, semantic)?;
        match accessor.as_ref().map(Accessor::count) {
            Some(other) if other != count => {
                let message = format!("expected one entry a vertex ({count}), found {other}");
                Err(Fault::new(format!("{}/attributes/{name}", self.pointer), message))
            }
            _ => Ok(accessor),
        }
    }

    /// In the description's precision.
    fn vectors(&self, read: &[[f32; 3]]) -> Read<Vec<DVec3>> {
        let mut vectors = room(read.len(), format_args!("{}", self.pointer))?;
        vectors.extend(read.iter().map(|&v| DVec3::from_array(v.map(f64::from))));
        Ok(vectors)
    }

    /// Indices of vertices, all of them there.
    fn indices(&self, document: &Document, vertices: u32) -> Read<Option<Vec<[u32; 1]>>> {
        let Some(index) = self.primitive.indices else { return Ok(None) };
        let pointer = format!("{}/indices", self.pointer);
        let indices = Accessor::open(document, index, format_args!("{pointer}"))?.integers::<1>(Which::All)?;
        match indices.iter().position(|[i]| *i >= vertices) {
            None => Ok(Some(indices)),
            Some(at) => {
                let wrong = indices[at][0];
                Err(Fault::new(pointer, format!("index {wrong} at place {at} names none of the {vertices} vertices")))
            }
        }
    }

    /// Moves vectors towards the morph targets.
    fn morph(
        &self,
        document: &Document,
        which: Which,
        vectors: &mut [[f32; 3]],
        accessor: impl Fn(&MorphTarget) -> Option<Index<json::Accessor>>,
    ) -> Read<()> {
        let targets = self.primitive.targets.iter().flatten().zip(self.weights);
        for (place, (target, &weight)) in targets.enumerate() {
            let Some(index) = accessor(target).filter(|_| weight != 0.0) else { continue };
            let pointer = format_args!("{}/targets/{place}", self.pointer);
            let moves = Accessor::open(document, index, pointer)?.vectors::<3>(which)?;
            for (vector, by) in vectors.iter_mut().zip(&moves) {
                for (value, by) in vector.iter_mut().zip(by) {
                    *value += weight * by;
                }
            }
        }
        match vectors.iter().flatten().all(|v| v.is_finite()) {
            true => Ok(()),
            false => Err(Fault::new(format!("{}/targets", self.pointer), "morphed, the mesh is not finite")),
        }
    }
}

/// Triangles over no more vertices than they use, and which those are, where they use few of `count`: some writers have one
/// long list for many primitives.
fn only_used(mut triangles: Vec<[u32; 3]>, count: usize) -> (Vec<[u32; 3]>, Option<Vec<u32>>) {
    if triangles.len() * 6 >= count {
        return (triangles, None);
    }
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    for vertex in triangles.iter_mut().flatten() {
        *vertex = used.partition_point(|other| other < vertex) as u32;
    }
    (triangles, Some(used))
}

/// Gives normals without direction that of the triangles around.
fn replace_odd_normals(mesh: &mut MeshDesc) -> Option<String> {
    let is_odd = |normal: &DVec3| normal.try_normalize().is_none();
    let odd = mesh.normals.iter().filter(|normal| is_odd(normal)).count();
    if odd == 0 {
        return None;
    }
    let mut sums = vec![DVec3::ZERO; mesh.vertices.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.vertices[i as usize]);
        for i in triangle {
            sums[*i as usize] += (b - a).cross(c - a);
        }
    }
    for (normal, sum) in mesh.normals.iter_mut().zip(sums).filter(|(normal, _)| is_odd(normal)) {
        *normal = sum.try_normalize().unwrap_or(DVec3::Y);
    }
    Some(format!("{odd} normals have no direction; they are taken from the triangles around"))
}
