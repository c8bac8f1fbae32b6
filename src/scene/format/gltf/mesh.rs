//! Primitives of meshes: attributes and indices to triangles over shared vertices.
//!
//! An attribute that cannot be read is left out, and so are triangles of vertices that are not there. Only without
//! positions or indices nothing is left of a primitive.

use super::accessor::{Accessor, NO_INDEX, Which};
use super::document::{Document, room};
use super::fault::{Fault, Notes, Read};
use super::nodes::Nodes;
use super::skin::{self, Holder};
use super::{tangents, topology};
use crate::scene::desc::{MeshDesc, NameRef};
use crate::scene::material::Lookup;
use glam::{DVec2, DVec3, Vec2, Vec4};
use gltf::json::mesh::{Mode, MorphTarget, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{self, Index};
use std::ops::RangeInclusive;

/// The extension that hides vertices in a stream of its own.
const DRACO: &str = "KHR_draco_mesh_compression";
/// What attributes are called that cannot be read.
pub const LOST: &str = "attributes left out";

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
    /// Which texture coordinates of the file its material looks up as the first and as the second, if any.
    pub sets: &'a [u32],
    /// How its material looks up a normal map, if it has one.
    pub normal_map: Option<&'a Lookup<NameRef>>,
}

/// What was read.
#[derive(Default)]
pub struct Drawn {
    /// The triangles, if there are any.
    pub mesh: Option<MeshDesc>,
    /// What was odd.
    pub notes: Notes,
    /// What is wrong with a primitive of which nothing is left.
    pub fault: Option<Fault>,
}

impl Job<'_> {
    /// Reads the primitive.
    pub fn read(&self, document: &Document, nodes: &Nodes) -> Read<Drawn> {
        let mut notes = Notes::default();
        let read = self.mesh(document, nodes, &mut notes);
        let fault = read.as_ref().err().cloned();
        let mesh = notes.attempt(read, "primitives left out")?.flatten();
        Ok(Drawn { mesh, notes, fault })
    }

    /// The triangles; `None` where there is nothing to draw, be it whole, which is noted.
    fn mesh(&self, document: &Document, nodes: &Nodes, notes: &mut Notes) -> Read<Option<MeshDesc>> {
        let Checked::Valid(mode) = self.primitive.mode else {
            return Err(Fault::new(format!("{}/mode", self.pointer), "unknown mode; expected 0 to 6"));
        };
        if let Some(why) = self.hidden(document) {
            return Err(Fault::new(&self.pointer, why));
        }
        if matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            notes.add(&self.pointer, "points and lines are not drawn");
            return Ok(None);
        }
        let Some(positions) = self.open(document, Semantic::Positions, notes)? else {
            notes.add(&self.pointer, "a primitive without POSITION is not drawn");
            return Ok(None);
        };
        let count = positions.count();
        let vertices = u32::try_from(count).ok().filter(|count| *count != NO_INDEX);
        let vertices = vertices.ok_or_else(|| Fault::fatal(&self.pointer, "more than 2^32 vertices"))?;
        let indices = self.indices(document, notes)?;
        let mut triangles = topology::triangles(mode, indices.as_deref(), vertices).unwrap_or_default();
        if mode == Mode::Triangles && !indices.as_ref().map_or(count, Vec::len).is_multiple_of(3) {
            notes.add(&*self.pointer, "the number of corners is no multiple of 3; those left over are not drawn");
        }
        drop(indices);
        let kind = "primitives have triangles of vertices that are not there, which are left out";
        self.keep(&mut triangles, kind, "vertices that are not there", notes, |corner| corner < vertices);
        let (triangles, used) = only_used(triangles, count);
        let which = used.as_deref().map_or(Which::All, Which::These);

        self.width_of(&positions, "POSITION", 3..=3, notes)?;
        let mut positions: Vec<[f32; 3]> = positions.vectors(which)?;
        self.morph(document, which, &mut positions, notes, |target| target.positions)?;
        let mut mesh = MeshDesc { triangles, vertices: self.vectors(&positions)?, ..MeshDesc::default() };
        drop(positions);
        self.drop_odd_vertices(&mut mesh, notes);
        self.attributes(document, which, count, &mut mesh, notes)?;
        if let Some(holder) = self.held_by {
            skin::hold(document, self.primitive, &self.pointer, which, holder, nodes, &mut mesh, notes)?;
            self.drop_odd_vertices(&mut mesh, notes);
        }
        self.replace_odd_normals(&mut mesh, notes);
        Ok(Some(mesh))
    }

    /// Reads what vertices have besides positions.
    fn attributes(
        &self,
        document: &Document,
        which: Which,
        count: usize,
        mesh: &mut MeshDesc,
        notes: &mut Notes,
    ) -> Read<()> {
        let vertices = mesh.vertices.len();
        let pick = |accessor: &Accessor| accessor.vectors(which);
        if let Some(mut normals) = self.vectors_of(document, &Semantic::Normals, count, notes, pick)? {
            self.morph(document, which, &mut normals, notes, |target| target.normals)?;
            normals.truncate(vertices);
            mesh.normals = self.vectors(&normals)?;
        }
        let sets = if self.sets.is_empty() { &[0][..] } else { self.sets };
        for (place, &set) in sets.iter().enumerate() {
            let Some(uvs) = self.coordinates(document, set, which, count, notes)? else { continue };
            let uvs = uvs.into_iter().take(vertices);
            match place {
                0 => mesh.uvs = uvs.map(|[u, v]| DVec2::new(u.into(), 1.0 - f64::from(v))).collect(),
                _ => mesh.uvs1 = uvs.map(|[u, v]| Vec2::new(u, 1.0 - v)).collect(),
            }
        }
        let pick = |accessor: &Accessor| accessor.colors(which);
        if let Some(mut colors) = self.vectors_of(document, &Semantic::Colors(0), count, notes, pick)? {
            self.settle(&mut colors, [1.0; 4], "COLOR_0", "colours are not finite; taken as white", notes);
            mesh.colors = colors.into_iter().take(vertices).map(Vec4::from_array).collect();
        }
        let Some(map) = self.normal_map else { return Ok(()) };
        let pick = |accessor: &Accessor| accessor.vectors(which);
        let tangents: Option<Vec<[f32; 4]>> = self.vectors_of(document, &Semantic::Tangents, count, notes, pick)?;
        let are_odd = |tangents: &Vec<[f32; 4]>| tangents.iter().flatten().any(|v| !v.is_finite());
        if tangents.as_ref().is_some_and(are_odd) {
            let pointer = format!("{}/attributes/TANGENT", self.pointer);
            notes.add(pointer, "tangents are not finite; all of the primitive's are computed anew");
        }
        match tangents.filter(|tangents| !mesh.normals.is_empty() && !are_odd(tangents)) {
            Some(tangents) => mesh.tangents = tangents.into_iter().take(vertices).map(Vec4::from_array).collect(),
            None if !tangents::generate(mesh, map.set, map.transform) => {
                notes.add(&*self.pointer, "the normal map has no texture coordinates to follow; it is not shown");
            }
            None => {}
        }
        Ok(())
    }

    /// Texture coordinates of a set; where the mesh has none, those of the first.
    fn coordinates(
        &self,
        document: &Document,
        set: u32,
        which: Which,
        count: usize,
        notes: &mut Notes,
    ) -> Read<Option<Vec<[f32; 2]>>> {
        let pick = |accessor: &Accessor| accessor.vectors(which);
        let mut uvs = self.vectors_of(document, &Semantic::TexCoords(set), count, notes, pick)?;
        if uvs.is_none() && set != 0 {
            uvs = self.vectors_of(document, &Semantic::TexCoords(0), count, notes, pick)?;
            if uvs.is_some() {
                let message = format!("no texture coordinates {set} can be read; the first are used");
                notes.add(&*self.pointer, message);
            }
        }
        if let Some(uvs) = &mut uvs {
            let name = format!("TEXCOORD_{set}");
            self.settle(uvs, [0.0; 2], &name, "texture coordinates are not finite; taken as 0", notes);
        }
        Ok(uvs)
    }

    /// Why the primitive's vertices are out of reach, if they are.
    fn hidden(&self, document: &Document) -> Option<&'static str> {
        let extensions = self.primitive.extensions.as_ref()?;
        extensions.others.contains_key(DRACO).then_some(())?;
        let position = self.primitive.attributes.get(&Checked::Valid(Semantic::Positions))?;
        let accessor = document.root.accessors.get(position.value())?.as_ref()?;
        accessor.buffer_view.is_none().then_some(
            "the mesh is compressed by KHR_draco_mesh_compression, which is not supported; export it uncompressed",
        )
    }

    fn open<'d>(&self, document: &'d Document, semantic: Semantic, notes: &mut Notes) -> Read<Option<Accessor<'d>>> {
        let name = semantic.to_string();
        let Some(&index) = self.primitive.attributes.get(&Checked::Valid(semantic)) else { return Ok(None) };
        Accessor::open(document, index, format_args!("{}/attributes/{name}", self.pointer), notes).map(Some)
    }

    /// The values of an attribute with one entry a vertex, as `pick` reads them; `None` where there is none, or none that
    /// can be used, which is noted.
    fn vectors_of<const N: usize>(
        &self,
        document: &Document,
        semantic: &Semantic,
        count: usize,
        notes: &mut Notes,
        pick: impl Fn(&Accessor) -> Read<Vec<[f32; N]>>,
    ) -> Read<Option<Vec<[f32; N]>>> {
        let (name, is_color) = (semantic.to_string(), *semantic == Semantic::Colors(0));
        let read = |notes: &mut Notes| {
            let Some(accessor) = self.open(document, semantic.clone(), notes)? else { return Ok(None) };
            let (entries, pointer) = (accessor.count(), format!("{}/attributes/{name}", self.pointer));
            if entries < count {
                return Err(Fault::new(pointer, format!("expected one entry a vertex ({count}), found {entries}")));
            }
            if entries > count {
                let message = format!("{entries} entries for {count} vertices; those left over are not used");
                notes.add_kind(pointer, "attributes have more entries than there are vertices", &*message, &*message);
            }
            // Colours may be without opacity.
            self.width_of(&accessor, &name, if is_color { 3..=4 } else { N..=N }, notes)?;
            pick(&accessor).map(Some)
        };
        let read = read(notes);
        Ok(notes.attempt(read, LOST)?.flatten())
    }

    /// Checks how many numbers the elements of an attribute have; more than are used are noted.
    fn width_of(
        &self,
        accessor: &Accessor,
        name: &str,
        expected: RangeInclusive<usize>,
        notes: &mut Notes,
    ) -> Read<()> {
        let (width, pointer) = (accessor.width(), || format!("{}/attributes/{name}", self.pointer));
        let (least, most) = expected.into_inner();
        if width < least {
            return Err(Fault::new(pointer(), format!("expected {least} numbers an element, found {width}")));
        }
        if width > most {
            notes.add(pointer(), format!("{width} numbers an element; the first {most} are taken"));
        }
        Ok(())
    }

    /// In the description's precision.
    fn vectors(&self, read: &[[f32; 3]]) -> Read<Vec<DVec3>> {
        let mut vectors = room(read.len(), format_args!("{}", self.pointer))?;
        vectors.extend(read.iter().map(|&v| DVec3::from_array(v.map(f64::from))));
        Ok(vectors)
    }

    /// Indices of vertices, be they there or not.
    fn indices(&self, document: &Document, notes: &mut Notes) -> Read<Option<Vec<[u32; 1]>>> {
        let Some(index) = self.primitive.indices else { return Ok(None) };
        let pointer = format!("{}/indices", self.pointer);
        let indices = Accessor::open(document, index, format_args!("{pointer}"), notes)?;
        if !indices.is_unsigned() {
            notes.add(pointer, "indices of a type that is not unsigned; those that are whole numbers are taken");
        }
        indices.integers::<1>(Which::All).map(Some)
    }

    /// Moves vectors towards the morph targets.
    fn morph(
        &self,
        document: &Document,
        which: Which,
        vectors: &mut [[f32; 3]],
        notes: &mut Notes,
        accessor: impl Fn(&MorphTarget) -> Option<Index<json::Accessor>>,
    ) -> Read<()> {
        let targets = self.primitive.targets.iter().flatten().zip(self.weights);
        for (place, (target, &weight)) in targets.enumerate() {
            let Some(index) = accessor(target).filter(|_| weight != 0.0) else { continue };
            let pointer = format_args!("{}/targets/{place}", self.pointer);
            let moves = Accessor::open(document, index, pointer, notes).and_then(|moves| moves.vectors::<3>(which));
            let Some(moves) = notes.attempt(moves, "morph targets left out")? else { continue };
            for (vector, by) in vectors.iter_mut().zip(&moves) {
                for (value, by) in vector.iter_mut().zip(by) {
                    *value += weight * by;
                }
            }
        }
        Ok(())
    }

    /// Puts `instead` in the place of values that are not finite.
    fn settle<const N: usize>(
        &self,
        values: &mut [[f32; N]],
        instead: [f32; N],
        name: &str,
        message: &'static str,
        notes: &mut Notes,
    ) {
        let mut odd = 0;
        for value in values.iter_mut().filter(|value| !value.iter().all(|v| v.is_finite())) {
            *value = instead;
            odd += 1;
        }
        if odd > 0 {
            notes.add(format!("{}/attributes/{name}", self.pointer), format!("{odd} {message}"));
        }
    }

    /// Leaves out triangles of vertices that are not finite.
    fn drop_odd_vertices(&self, mesh: &mut MeshDesc, notes: &mut Notes) {
        let is_fine = |p: &DVec3| p.as_vec3().is_finite();
        if mesh.vertices.iter().all(is_fine) {
            return;
        }
        let fine: Vec<bool> = mesh.vertices.iter().map(is_fine).collect();
        let kind = "primitives have triangles of vertices that are not finite, which are left out";
        self.keep(&mut mesh.triangles, kind, "vertices that are not finite", notes, |i| fine[i as usize]);
        for (vertex, fine) in mesh.vertices.iter_mut().zip(fine) {
            if !fine {
                *vertex = DVec3::ZERO;
            }
        }
    }

    /// Keeps the triangles all of whose corners are good.
    fn keep(
        &self,
        triangles: &mut Vec<[u32; 3]>,
        kind: &'static str,
        of: &str,
        notes: &mut Notes,
        is_good: impl Fn(u32) -> bool,
    ) {
        let before = triangles.len();
        triangles.retain(|triangle| triangle.iter().all(|corner| is_good(*corner)));
        let left_out = before - triangles.len();
        if left_out > 0 {
            let message = format!("{left_out} of {before} triangles have {of}; they are left out");
            notes.add_kind(&*self.pointer, kind, format!("{left_out} of {before} triangles"), message);
        }
    }

    /// Gives normals without direction that of the triangles around.
    fn replace_odd_normals(&self, mesh: &mut MeshDesc, notes: &mut Notes) {
        let is_odd = |normal: &DVec3| normal.try_normalize().is_none();
        let odd = mesh.normals.iter().filter(|normal| is_odd(normal)).count();
        if odd == 0 {
            return;
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
        let message = format!("{odd} normals have no direction; they are taken from the triangles around");
        notes.add_kind(&*self.pointer, "primitives have normals without direction", &*message, &*message);
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
