//! Vertices and faces: a mesh for each run of faces of one object or group and one material.

use super::statement::{Statement, statements};
use super::weld::{Corner, Weld};
use crate::scene::desc::problem::{At, Outcome, Problem, Warnings};
use crate::scene::desc::{MeshDesc, NameRef, ObjectDesc, ShapeDesc};
use crate::scene::format::polygon::Cutter;
use crate::scene::format::words::{Word, Words};
use crate::scene::limits::{Limits, exceeded};
use glam::{DVec2, DVec3, Vec4};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// What an OBJ file holds, its materials not yet known.
#[derive(Debug, Default)]
pub struct Meshes {
    /// Meshes, in the order in which their first faces stand.
    pub objects: Vec<ObjectDesc>,
    /// Material libraries as they are named.
    pub libraries: Vec<NameRef>,
}

/// Reads the statements of a file.
pub fn read(text: &[u8], limits: &Limits, warnings: &mut Warnings) -> Outcome<Meshes> {
    let mut reader = Reader::new(limits, warnings);
    for statement in statements(text) {
        reader.statement(&statement)?;
    }
    reader.finish_group();
    reader.cutter.warn(reader.warnings);
    if reader.left_out > 0 {
        let message = format!("points, lines and faces of fewer than 3 corners: {} left out", reader.left_out);
        reader.warnings.push(reader.first_left_out, message);
    }
    Ok(reader.meshes)
}

/// Statements that say nothing about what a ray tracer sees of polygons: smoothing groups, levels of detail, hints to
/// renderers, and values that only free-form surfaces use.
const WITHOUT_EFFECT: [&str; 23] = [
    "s",
    "mg",
    "lod",
    "bevel",
    "c_interp",
    "d_interp",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "usemap",
    "maplib",
    "vp",
    "cstype",
    "deg",
    "bmat",
    "step",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
];

/// A mesh under construction.
#[derive(Debug)]
struct Open {
    /// Tells it from all others of the file.
    number: u32,
    at: At,
    name: Option<String>,
    material: Option<NameRef>,
    mesh: MeshDesc,
}

/// What faces must have in common to be of one mesh of a group.
type Key = (Option<String>, bool, bool);

struct Reader<'a> {
    limits: &'a Limits,
    warnings: &'a mut Warnings,
    positions: Vec<DVec3>,
    /// One a position from the first that has a colour on, or none at all.
    colors: Vec<Vec4>,
    uvs: Vec<DVec2>,
    normals: Vec<DVec3>,
    meshes: Meshes,
    /// Of the objects or groups to come.
    name: Option<String>,
    material: Option<NameRef>,
    /// The meshes of the group being read, and where each is by what its faces have in common.
    open: Vec<Open>,
    places: HashMap<Key, usize>,
    /// Where the faces of the statements at hand go, as long as neither group nor material changes.
    current: [[Option<usize>; 2]; 2],
    weld: Weld,
    meshes_begun: u32,
    triangles: u64,
    cutter: Cutter,
    /// The corners of a face, and their positions.
    corners: Vec<Corner>,
    outline: Vec<DVec3>,
    /// Points, lines and faces that are none.
    left_out: u64,
    first_left_out: At,
    unknown: HashSet<Vec<u8>>,
    /// What statements have named as material libraries.
    libraries: HashSet<String>,
    /// Vertices, corners of faces, and what they carry, that may still be read.
    elements_left: u64,
}

impl<'a> Reader<'a> {
    fn new(limits: &'a Limits, warnings: &'a mut Warnings) -> Self {
        Self {
            limits,
            warnings,
            positions: Vec::new(),
            colors: Vec::new(),
            uvs: Vec::new(),
            normals: Vec::new(),
            meshes: Meshes::default(),
            name: None,
            material: None,
            open: Vec::new(),
            places: HashMap::new(),
            current: [[None; 2]; 2],
            weld: Weld::default(),
            meshes_begun: 0,
            triangles: 0,
            cutter: Cutter::new(),
            corners: Vec::new(),
            outline: Vec::new(),
            left_out: 0,
            first_left_out: At(0),
            unknown: HashSet::new(),
            libraries: HashSet::new(),
            elements_left: limits.vertices,
        }
    }

    fn statement(&mut self, statement: &Statement) -> Outcome<()> {
        let Statement { at, keyword, mut words, .. } = statement.clone();
        match keyword {
            b"v" => {
                self.take(at, 1)?;
                self.position(&mut words)?;
            }
            b"vt" => {
                self.take(at, 1)?;
                self.uv(&mut words)?;
            }
            b"vn" => {
                self.take(at, 1)?;
                self.normals.push(DVec3::from_array(words.numbers("normal")?));
            }
            b"f" | b"fo" => self.face(at, words)?,
            b"o" | b"g" => {
                self.finish_group();
                self.name = Some(statement.name()).filter(|name| !name.is_empty());
            }
            b"usemtl" => {
                self.current = [[None; 2]; 2];
                self.material =
                    Some(NameRef { name: statement.name(), at }).filter(|material| !material.name.is_empty());
            }
            b"mtllib" => {
                let name = statement.name();
                if self.libraries.insert(name.clone()) {
                    self.meshes.libraries.push(NameRef { name, at });
                }
            }
            b"p" | b"l" | b"curv" | b"curv2" | b"surf" => self.leave_out(at),
            _ if WITHOUT_EFFECT.iter().any(|known| known.as_bytes() == keyword) => {}
            _ => {
                if self.unknown.len() < Warnings::KEPT && self.unknown.insert(keyword.to_vec()) {
                    self.warnings.push(at, format!("unknown statement \"{}\" is ignored", statement.shown()));
                }
            }
        }
        Ok(())
    }

    /// Takes `count` vertices or corners from what a file may ask for.
    fn take(&mut self, at: At, count: u64) -> Outcome<()> {
        let left = self.elements_left.checked_sub(count);
        let message = || format!("vertices and corners: {}", exceeded("vertices", self.limits.vertices));
        self.elements_left = left.ok_or_else(|| Problem::new(at, message()))?;
        Ok(())
    }

    /// `v x y z`, with a weight that only free-form surfaces use, or with red, green and blue.
    fn position(&mut self, words: &mut Words) -> Outcome<()> {
        self.positions.push(DVec3::from_array(words.numbers("position")?));
        let mut more = words.clone();
        if more.nth(1).is_some() {
            let color = DVec3::from_array(words.numbers("vertex colour")?).as_vec3();
            self.colors.resize(self.positions.len() - 1, Vec4::ONE);
            self.colors.push(color.max(glam::Vec3::ZERO).extend(1.0));
        } else if !self.colors.is_empty() {
            self.colors.push(Vec4::ONE);
        }
        Ok(())
    }

    /// `vt u`, `vt u v` or `vt u v w`.
    fn uv(&mut self, words: &mut Words) -> Outcome<()> {
        let u = words.number("texture coordinate")?;
        let v = words.next().map_or(Ok(0.0), |word| word.number())?;
        self.uvs.push(DVec2::new(u, v));
        Ok(())
    }

    fn face(&mut self, at: At, words: Words) -> Outcome<()> {
        self.corners.clear();
        for word in words {
            let corner = self.corner(word)?;
            self.corners.push(corner);
        }
        self.take(at, self.corners.len() as u64)?;
        if self.corners.len() < 3 {
            self.leave_out(at);
            return Ok(());
        }
        let has_uvs = self.corners.iter().all(|corner| corner.uv.is_some());
        let is_normal = |index: u32| self.normals[index as usize].try_normalize().is_some();
        let has_normals = self.corners.iter().all(|corner| corner.normal.is_some_and(is_normal));
        for corner in &mut self.corners {
            corner.uv = corner.uv.filter(|_| has_uvs);
            corner.normal = corner.normal.filter(|_| has_normals);
        }
        let place = self.mesh(at, has_uvs, has_normals)?;
        self.outline.clear();
        self.outline.extend(self.corners.iter().map(|corner| self.positions[corner.position as usize]));
        let triangles = self.cutter.cut(&self.outline);
        self.triangles += triangles.len() as u64;
        if self.triangles > self.limits.primitives {
            return Err(Problem::new(at, format!("triangles: {}", exceeded("primitives", self.limits.primitives))));
        }
        let Open { number, mesh, .. } = &mut self.open[place];
        for triangle in triangles {
            let vertices = triangle.map(|i| {
                let corner = self.corners[i as usize];
                self.weld.vertex(*number, corner, || {
                    if let Some(color) = self.colors.get(corner.position as usize) {
                        // Vertices from before the first colour of the file have none.
                        mesh.colors.resize(mesh.vertices.len(), Vec4::ONE);
                        mesh.colors.push(*color);
                    }
                    mesh.vertices.push(self.positions[corner.position as usize]);
                    mesh.uvs.extend(corner.uv.map(|uv| self.uvs[uv as usize]));
                    mesh.normals.extend(corner.normal.map(|normal| self.normals[normal as usize]));
                    mesh.vertices.len() as u32 - 1
                })
            });
            mesh.triangles.push(vertices);
        }
        Ok(())
    }

    /// `1`, `1/2`, `1//3` or `1/2/3`.
    fn corner(&mut self, word: Word) -> Outcome<Corner> {
        let mut parts = word.bytes.split(|byte| *byte == b'/');
        let [position, uv, normal] = [0; 3].map(|_| parts.next().unwrap_or_default());
        if position.is_empty() || parts.next().is_some() {
            return Err(word.mismatch(CORNER));
        }
        Ok(Corner {
            position: index(position, self.positions.len(), "positions", word)?,
            uv: self.optional(uv, self.uvs.len(), "texture coordinates", word)?,
            normal: self.optional(normal, self.normals.len(), "normals", word)?,
        })
    }

    /// An index that may be left out. Some programs write them though there is nothing that they could name.
    fn optional(&mut self, text: &[u8], count: usize, what: &'static str, word: Word) -> Outcome<Option<u32>> {
        if text.is_empty() {
            return Ok(None);
        }
        if count > 0 {
            return index(text, count, what, word).map(Some);
        }
        if self.unknown.insert(what.into()) {
            self.warnings.push(word.at, format!("a face names {what}, but none are given before it; it has none"));
        }
        Ok(None)
    }

    /// Where the mesh is that takes a face of the group and material at hand.
    fn mesh(&mut self, at: At, has_uvs: bool, has_normals: bool) -> Outcome<usize> {
        let current = &mut self.current[usize::from(has_uvs)][usize::from(has_normals)];
        if let Some(place) = *current {
            return Ok(place);
        }
        let key = (self.material.as_ref().map(|material| material.name.clone()), has_uvs, has_normals);
        let place = *self.places.entry(key).or_insert(self.open.len());
        *current = Some(place);
        if place == self.open.len() {
            if u64::from(self.meshes_begun) >= self.limits.objects {
                return Err(Problem::new(at, format!("objects: {}", exceeded("objects", self.limits.objects))));
            }
            let (name, material, mesh) = (self.name.clone(), self.material.clone(), MeshDesc::default());
            self.open.push(Open { number: self.meshes_begun, at, name, material, mesh });
            self.meshes_begun += 1;
        }
        Ok(place)
    }

    /// The group ends; its meshes are whole.
    fn finish_group(&mut self) {
        self.meshes.objects.extend(self.open.drain(..).map(|Open { at, name, material, mesh, .. }| ObjectDesc {
            at,
            kind: "mesh",
            name,
            material,
            transform: None,
            shape: ShapeDesc::Mesh(Arc::new(mesh)),
        }));
        self.places.clear();
        self.current = [[None; 2]; 2];
    }

    fn leave_out(&mut self, at: At) {
        if self.left_out == 0 {
            self.first_left_out = at;
        }
        self.left_out += 1;
    }
}

/// What a corner of a face looks like.
const CORNER: &str = "a corner such as 1, 1/2 or 1/2/3";

/// An index from 0 up. In the file they count from 1 up, or from -1 back from what was given last.
fn index(text: &[u8], count: usize, what: &str, word: Word) -> Outcome<u32> {
    let number: i64 =
        str::from_utf8(text).ok().and_then(|text| text.parse().ok()).ok_or_else(|| word.mismatch(CORNER))?;
    let from_0 = if number < 0 { number.checked_add(count as i64) } else { number.checked_sub(1) };
    let known = from_0.and_then(|index| u32::try_from(index).ok()).filter(|index| (*index as usize) < count);
    known.ok_or_else(|| Problem::new(word.at, format!("index {number} names none of the {count} {what} given so far")))
}
