//! Faces: a mesh for each run of those of one object or group and one material.

use super::smooth::SmoothNormals;
use super::statement::{Statement, statements};
use super::vertices::{self, Budget, Vertices};
use super::weld::{Corner, Weld};
use crate::scene::desc::problem::{At, Outcome, Problem, Warnings};
use crate::scene::desc::{MeshDesc, NameRef, ObjectDesc, ShapeDesc};
use crate::scene::format::faults::Faults;
use crate::scene::format::polygon::{Cutter, area_vector};
use crate::scene::format::words::{Word, Words};
use crate::scene::limits::{Limits, exceeded};
use glam::{DVec3, Vec4};
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
///
/// # Errors
/// A limit that is exceeded, or the first fault of a text that leaves no face.
pub fn read(text: &[u8], limits: &Limits, faults: &mut Faults) -> Outcome<Meshes> {
    let mut budget = Budget::of(limits);
    let vertices = vertices::read(text, &mut budget, faults)?;
    let mut reader = Reader::new(limits, &vertices, budget, faults);
    for statement in statements(text) {
        reader.statement(&statement)?;
    }
    reader.finish_group();
    reader.cutter.warn(&mut reader.faults.warnings);
    if reader.left_out > 0 {
        let message = format!("points, lines and faces of fewer than 3 corners: {} left out", reader.left_out);
        reader.faults.warnings.push(reader.first_left_out, message);
    }
    match reader.faults.first() {
        Some(fault) if reader.triangles == 0 => Err(fault),
        _ => Ok(reader.finish()),
    }
}

/// Statements that say nothing about what a ray tracer sees of polygons: merging groups, levels of detail, hints to
/// renderers, and values that only free-form surfaces use.
const WITHOUT_EFFECT: [&str; 22] = [
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

/// Where the normals of a mesh come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Normals {
    /// From nowhere: it is flat.
    None,
    /// From the file.
    Given,
    /// From its smoothing groups.
    Smooth,
}

/// A mesh under construction.
#[derive(Debug)]
struct Open {
    /// Tells it from all others of the file.
    number: u32,
    at: At,
    name: Option<String>,
    material: Option<NameRef>,
    mesh: MeshDesc,
    /// Where among the smooth normals that of each vertex is.
    smooth: Vec<u32>,
}

/// What faces must have in common to be of one mesh of a group.
type Key = (Option<String>, bool, Normals);

struct Reader<'a> {
    limits: &'a Limits,
    vertices: &'a Vertices,
    budget: Budget,
    faults: &'a mut Faults,
    /// How many positions, texture coordinates and normals stand before the statement at hand.
    before: [usize; 3],
    libraries: Vec<NameRef>,
    /// Of the objects or groups to come.
    name: Option<String>,
    material: Option<NameRef>,
    /// The smoothing group of the faces to come.
    smoothing: Option<i64>,
    smooth_normals: SmoothNormals,
    /// The meshes of the groups that were read.
    whole: Vec<Open>,
    /// The meshes of the group being read, and where each is by what its faces have in common.
    open: Vec<Open>,
    places: HashMap<Key, usize>,
    /// Where the faces of the statements at hand go, as long as neither group nor material changes.
    current: [[Option<usize>; 3]; 2],
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
    named_libraries: HashSet<String>,
}

impl<'a> Reader<'a> {
    fn new(limits: &'a Limits, vertices: &'a Vertices, budget: Budget, faults: &'a mut Faults) -> Self {
        Self {
            limits,
            vertices,
            budget,
            faults,
            before: [0; 3],
            libraries: Vec::new(),
            name: None,
            material: None,
            smoothing: None,
            smooth_normals: SmoothNormals::default(),
            whole: Vec::new(),
            open: Vec::new(),
            places: HashMap::new(),
            current: [[None; 3]; 2],
            weld: Weld::default(),
            meshes_begun: 0,
            triangles: 0,
            cutter: Cutter::new(),
            corners: Vec::new(),
            outline: Vec::new(),
            left_out: 0,
            first_left_out: At(0),
            unknown: HashSet::new(),
            named_libraries: HashSet::new(),
        }
    }

    fn statement(&mut self, statement: &Statement) -> Outcome<()> {
        let Statement { at, keyword, words, .. } = statement.clone();
        match keyword {
            b"v" | b"V" => self.before[0] += 1,
            b"vt" | b"VT" => self.before[1] += 1,
            b"vn" | b"VN" => self.before[2] += 1,
            b"f" | b"F" | b"fo" => self.face(at, words)?,
            b"s" | b"S" => self.smoothing(at, words),
            b"o" | b"g" | b"O" | b"G" => {
                self.finish_group();
                self.name = Some(statement.name()).filter(|name| !name.is_empty());
            }
            b"usemtl" => {
                self.current = [[None; 3]; 2];
                self.material =
                    Some(NameRef { name: statement.name(), at }).filter(|material| !material.name.is_empty());
            }
            b"mtllib" => {
                let name = statement.name();
                if self.named_libraries.insert(name.clone()) {
                    self.libraries.push(NameRef { name, at });
                }
            }
            b"p" | b"l" | b"curv" | b"curv2" | b"surf" => self.leave_out(at),
            _ if WITHOUT_EFFECT.iter().any(|known| known.as_bytes() == keyword) => {}
            _ => {
                if self.unknown.len() < Warnings::KEPT && self.unknown.insert(keyword.to_vec()) {
                    let message = format!("unknown statement \"{}\" is ignored", statement.shown());
                    self.faults.add(Problem::new(at, message.clone()), message);
                }
            }
        }
        Ok(())
    }

    /// `s 1`, `s off` or `s 0`.
    fn smoothing(&mut self, at: At, mut words: Words) {
        let word = words.next().map(|word| word.bytes.to_ascii_lowercase()).unwrap_or_default();
        self.smoothing = match (&*word, str::from_utf8(&word).ok().and_then(|word| word.parse().ok())) {
            (b"off" | b"null", _) | (_, Some(0)) => None,
            (b"on", _) => Some(1),
            (_, Some(group)) => Some(group),
            (_, None) => {
                self.faults.add_plain(at, "a smoothing group that is no number; the faces in it are flat");
                None
            }
        };
    }

    fn face(&mut self, at: At, words: Words) -> Outcome<()> {
        self.corners.clear();
        let read = self.read_corners(words);
        self.budget.take(at, self.corners.len() as u64)?;
        if let Err(problem) = read {
            self.faults.add(problem, "a face with a corner that is none; it is left out");
            return Ok(());
        }
        if self.corners.len() < 3 {
            let message = "a face of fewer than 3 corners";
            self.faults.note(Problem::new(at, message));
            self.leave_out(at);
            return Ok(());
        }
        self.outline.clear();
        self.outline.extend(self.corners.iter().map(|corner| self.vertices.positions[corner.position as usize]));
        if !self.outline.iter().all(|position| position.is_finite()) {
            // Warned of where the position stands.
            return Ok(());
        }
        let has_uvs = self.corners.iter().all(|corner| corner.uv.is_some());
        let is_normal = |index: u32| self.vertices.normals[index as usize].try_normalize().is_some();
        let has_normals = self.corners.iter().all(|corner| corner.normal.is_some_and(is_normal));
        for corner in &mut self.corners {
            corner.uv = corner.uv.filter(|_| has_uvs);
            corner.normal = corner.normal.filter(|_| has_normals);
        }
        let normals = match self.smoothing {
            _ if has_normals => Normals::Given,
            Some(group) => {
                self.smooth(group);
                Normals::Smooth
            }
            None => Normals::None,
        };
        let place = self.mesh(at, has_uvs, normals)?;
        let triangles = self.cutter.cut(&self.outline);
        self.triangles += triangles.len() as u64;
        if self.triangles > self.limits.primitives {
            return Err(Problem::new(at, format!("triangles: {}", exceeded("primitives", self.limits.primitives))));
        }
        let Vertices { positions, colors, uvs, normals: given } = self.vertices;
        let Open { number, mesh, smooth, .. } = &mut self.open[place];
        for triangle in triangles {
            let vertices = triangle.map(|i| {
                let corner = self.corners[i as usize];
                self.weld.vertex(*number, corner, || {
                    if let Some(color) = colors.get(corner.position as usize) {
                        // Vertices after the last colour of the file have none.
                        mesh.colors.resize(mesh.vertices.len(), Vec4::ONE);
                        mesh.colors.push(*color);
                    }
                    mesh.vertices.push(positions[corner.position as usize]);
                    mesh.uvs.extend(corner.uv.map(|uv| uvs[uv as usize]));
                    match normals {
                        Normals::Smooth => smooth.extend(corner.normal),
                        _ => mesh.normals.extend(corner.normal.map(|normal| given[normal as usize])),
                    }
                    mesh.vertices.len() as u32 - 1
                })
            });
            mesh.triangles.push(vertices);
        }
        Ok(())
    }

    /// Adds the face at hand to the normals of a smoothing group, which become those of its corners.
    fn smooth(&mut self, group: i64) {
        let normal = area_vector(&self.outline).normalize_or_zero();
        let count = self.corners.len();
        for (i, corner) in self.corners.iter_mut().enumerate() {
            let place = self.smooth_normals.place(corner.position, group);
            corner.normal = Some(place);
            let [before, own, after] = [i + count - 1, i, i + 1].map(|i| self.outline[i % count]);
            self.smooth_normals.add(place, normal, [before - own, after - own]);
        }
    }

    /// The corners of a face. Some programs write blanks around the slashes: what starts with one belongs to the word before.
    fn read_corners(&mut self, words: Words) -> Outcome<()> {
        let mut words = words.peekable();
        while let Some(word) = words.next() {
            if words.peek().is_none_or(|next| next.bytes[0] != b'/') {
                let corner = self.corner(word)?;
                self.corners.push(corner);
                continue;
            }
            let mut bytes = word.bytes.to_vec();
            while let Some(next) = words.next_if(|next| next.bytes[0] == b'/') {
                bytes.extend_from_slice(next.bytes);
            }
            let corner = self.corner(Word { bytes: &bytes, at: word.at })?;
            self.corners.push(corner);
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
        let Vertices { positions, uvs, normals, .. } = self.vertices;
        let [positions, uvs, normals] = [positions.len(), uvs.len(), normals.len()];
        Ok(Corner {
            position: index(position, self.before[0], positions, "positions", word)?,
            uv: self.optional(uv, self.before[1], uvs, "texture coordinates", word),
            normal: self.optional(normal, self.before[2], normals, "normals", word),
        })
    }

    /// An index that may be left out. Some programs write them though there is nothing that they could name.
    fn optional(&mut self, text: &[u8], before: usize, count: usize, what: &'static str, word: Word) -> Option<u32> {
        if text.is_empty() {
            return None;
        }
        if count == 0 {
            if self.unknown.insert(what.into()) {
                let message = format!("a face names {what}, but the file has none; it is shown without");
                self.faults.warnings.push(word.at, message);
            }
            return None;
        }
        index(text, before, count, what, word)
            .inspect_err(|problem| {
                self.faults.add(problem.clone(), format!("a face names {what} that are not there; it has none"));
            })
            .ok()
    }

    /// Where the mesh is that takes a face of the group and material at hand.
    fn mesh(&mut self, at: At, has_uvs: bool, normals: Normals) -> Outcome<usize> {
        let current = &mut self.current[usize::from(has_uvs)][normals as usize];
        if let Some(place) = *current {
            return Ok(place);
        }
        let key = (self.material.as_ref().map(|material| material.name.clone()), has_uvs, normals);
        let place = *self.places.entry(key).or_insert(self.open.len());
        *current = Some(place);
        if place == self.open.len() {
            if u64::from(self.meshes_begun) >= self.limits.objects {
                return Err(Problem::new(at, format!("objects: {}", exceeded("objects", self.limits.objects))));
            }
            let (name, material, mesh) = (self.name.clone(), self.material.clone(), MeshDesc::default());
            self.open.push(Open { number: self.meshes_begun, at, name, material, mesh, smooth: Vec::new() });
            self.meshes_begun += 1;
        }
        Ok(place)
    }

    /// The group ends; its meshes are whole.
    fn finish_group(&mut self) {
        self.whole.append(&mut self.open);
        self.places.clear();
        self.current = [[None; 3]; 2];
    }

    /// What was read, once all faces of the smoothing groups are known.
    fn finish(self) -> Meshes {
        let object = |Open { at, name, material, mut mesh, smooth, .. }: Open| {
            mesh.normals.extend(smooth.iter().map(|place| self.smooth_normals.normal(*place)));
            let shape = ShapeDesc::Mesh(Arc::new(mesh));
            ObjectDesc { at, kind: "mesh", name, material, transform: None, shape }
        };
        Meshes { objects: self.whole.into_iter().map(object).collect(), libraries: self.libraries }
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

/// An index from 0 up. In the file they count from 1 up, or from -1 back from what stands `before` the face.
fn index(text: &[u8], before: usize, count: usize, what: &str, word: Word) -> Outcome<u32> {
    let number = whole(text).ok_or_else(|| word.mismatch(CORNER))?;
    let from_0 = if number < 0 { number.checked_add(before as i64) } else { number.checked_sub(1) };
    let known = from_0.and_then(|index| u32::try_from(index).ok()).filter(|index| (*index as usize) < count);
    known.ok_or_else(|| {
        let message = match number < 0 {
            true => format!("index {number} names none of the {before} {what} given so far"),
            false => format!("index {number} names none of the {count} {what} of the file"),
        };
        Problem::new(word.at, message)
    })
}

/// A whole number, which some programs write with a point.
fn whole(text: &[u8]) -> Option<i64> {
    let text = str::from_utf8(text).ok()?;
    text.parse().ok().or_else(|| {
        let (number, fraction) = text.split_once('.')?;
        fraction.bytes().all(|digit| digit == b'0').then(|| number.parse().ok())?
    })
}
