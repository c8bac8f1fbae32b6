//! Wavefront OBJ, with its material libraries (MTL); `.obj.zst` is the same compressed.
//!
//! ```text
//! mtllib room.mtl
//! o table                        an object: one leaf a material
//! v 0 0 0                        position, perhaps with a colour; vt and vn alike
//! usemtl wood
//! f 1/1/1 2/2/1 -1/3/1           corners: position/texture coordinates/normal, from 1 up or from -1 back
//! ```
//!
//! | file | what it reads |
//! |---|---|
//! | [`statement`] | lines, which a backslash continues |
//! | [`vertices`] | what corners of faces name |
//! | [`mesh`] | faces |
//! | [`weld`] | corners that are the same vertex |
//! | [`smooth`] | normals of smoothing groups |
//! | [`material`] | material libraries; [`map`] for the textures in them |
//! | [`compressed`] | Zstandard |
//!
//! Points, lines and free-form surfaces are left out with a warning. So is whatever is damaged or odd, and nothing else
//! with it: a number, a corner's normal, a face. Refused is what breaks a limit, and a text whose faults leave no face. A
//! library or texture that is missing is a warning, too, and a placeholder is shown.

mod compressed;
mod map;
mod material;
mod mesh;
mod smooth;
mod statement;
mod vertices;
mod weld;

use super::encoding::as_utf8;
use super::faults::Faults;
use super::place::by_line;
use super::{Input, placed, settle, whole};
use crate::scene::build::SceneBuilder;
use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::{At, Warnings};
use crate::scene::desc::{MaterialDesc, NameRef, SceneDesc, hint};
use crate::scene::error::SceneError;
use map::{Textures, slashes};
use mesh::Meshes;
use statement::bare;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Reads an OBJ file into `builder`.
pub fn read(input: &Input, builder: &mut SceneBuilder) -> Result<(), SceneError> {
    let limits = builder.limits().clone();
    let text = compressed::expanded(input.bytes, &limits)
        .map_err(|message| SceneError::Invalid { place: whole(input.path), message })?;
    let text = as_utf8(&text);
    let mut faults = Faults::default();
    let meshes = mesh::read(&text, &limits, &mut faults);
    let described = meshes.map(|meshes| describe(meshes, input.path, builder, &mut faults.warnings));
    settle(described, faults.warnings, builder, |positions| by_line(input.path, &text, positions))
}

/// The scene that meshes and their materials make.
fn describe(meshes: Meshes, file: &Path, builder: &mut SceneBuilder, warnings: &mut Warnings) -> SceneDesc {
    let mut materials = Materials::default();
    for library in &meshes.libraries {
        materials.add(library, file, builder, warnings);
    }
    let mut objects = meshes.objects;
    if materials.read == 0 && objects.iter().any(|object| object.material.is_some()) {
        materials.add_beside(file, builder);
    }
    for (library, error) in &materials.missing {
        let name = shortened(&library.name);
        let done = match &materials.beside {
            Some(beside) => format!("\"{}\" is read instead", shortened(beside)),
            None => "plain ones are shown".to_owned(),
        };
        warnings.push(library.at, format!("cannot read the materials of \"{name}\": {error}; {done}"));
    }
    let is_incomplete = !materials.missing.is_empty() && materials.beside.is_none() || materials.cut_off;
    let mut unknown = HashSet::new();
    for object in &mut objects {
        let Some(name) = object.material.take() else { continue };
        if let Some(known) = materials.find(&name.name) {
            object.material = Some(NameRef { name: known.to_owned(), at: name.at });
        } else if !is_incomplete && unknown.len() < Warnings::KEPT && unknown.insert(name.name.clone()) {
            // A library that is missing has been told of already.
            let hint = hint(&name.name, materials.places.keys().map(String::as_str));
            let message = format!("no material is called \"{}\"; a plain one is shown; {hint}", shortened(&name.name));
            warnings.push(name.at, message);
        }
    }
    SceneDesc { objects, materials: materials.materials, textures: materials.textures.descs, ..SceneDesc::default() }
}

/// Most material libraries of a file.
const MOST_LIBRARIES: usize = 1000;

/// The materials of all libraries.
#[derive(Default)]
struct Materials {
    materials: Vec<MaterialDesc>,
    /// Where each name's material is; the last of a name counts.
    places: HashMap<String, usize>,
    /// The same by names without comments and quotes, where one differs; the first of a name counts.
    bare_places: HashMap<String, usize>,
    textures: Textures,
    /// The libraries so far.
    libraries: HashSet<String>,
    /// How many of them could be read.
    read: usize,
    /// Those that could not be read, and why.
    missing: Vec<(NameRef, String)>,
    /// The library beside the file that was read for want of others.
    beside: Option<String>,
    /// Whether there are too many libraries.
    cut_off: bool,
}

impl Materials {
    /// Adds what a statement names: one library, whose name may hold blanks, or several.
    fn add(&mut self, library: &NameRef, file: &Path, builder: &mut SceneBuilder, warnings: &mut Warnings) {
        let whole = slashes(&library.name);
        let one = [&*whole, bare(&whole)].into_iter().find_map(|name| found(name, builder));
        let names = match one {
            Some(name) => vec![name],
            None if whole.starts_with('"') => vec![bare(&whole).to_owned()],
            None => {
                let names = bare(&whole).split_ascii_whitespace();
                names.map(|name| found(name, builder).unwrap_or_else(|| name.to_owned())).collect()
            }
        };
        for name in names {
            if !self.libraries.insert(name.clone()) {
                continue;
            }
            if self.libraries.len() > MOST_LIBRARIES {
                if !self.cut_off {
                    self.cut_off = true;
                    warnings.push(library.at, format!("only the first {MOST_LIBRARIES} material libraries are read"));
                }
                continue;
            }
            match builder.read_file(&name) {
                Ok(bytes) => self.read(&name, &bytes, library.at, file, builder),
                Err(error) => self.missing.push((NameRef { name, at: library.at }, error.to_string())),
            }
        }
    }

    /// Adds the library that is called like the file, if there is one: files are renamed with it, or name none.
    fn add_beside(&mut self, file: &Path, builder: &mut SceneBuilder) {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let stem = name.rsplit_once('.').map_or(&*name, |(stem, _)| stem);
        // Of a compressed file, two endings are to be replaced.
        let stem = match stem.len().checked_sub(4).and_then(|end| stem.split_at_checked(end)) {
            Some((stem, end)) if end.eq_ignore_ascii_case(".obj") => stem,
            _ => stem,
        };
        let name = format!("{stem}.mtl");
        if self.libraries.contains(&name) {
            return;
        }
        if let Ok(bytes) = builder.read_file(&name) {
            self.read(&name, &bytes, At(0), file, builder);
            self.beside = Some(name);
        }
    }

    fn read(&mut self, name: &str, bytes: &[u8], at: At, file: &Path, builder: &mut SceneBuilder) {
        self.read += 1;
        self.textures.at = at;
        let text = as_utf8(bytes);
        let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
        let (materials, warnings) = material::read(&text, folder, &mut self.textures, |file| builder.has_file(file));
        for material in materials {
            match self.places.get(&material.name) {
                Some(&place) => self.materials[place] = material,
                None => {
                    let place = self.materials.len();
                    let bare = bare(&material.name);
                    if bare != material.name {
                        self.bare_places.entry(bare.to_owned()).or_insert(place);
                    }
                    self.places.insert(material.name.clone(), place);
                    self.materials.push(material);
                }
            }
        }
        let path = file.parent().unwrap_or(Path::new("")).join(name);
        builder.warn(placed(warnings, |positions| by_line(&path, &text, positions)));
    }

    /// The name of the material that a statement means, which may differ from it by a comment or quotes.
    fn find(&self, name: &str) -> Option<&str> {
        let place = [name, bare(name)].iter().find_map(|name| self.places.get(*name));
        Some(&self.materials[*place.or_else(|| self.bare_places.get(bare(name)))?].name)
    }
}

/// The name of a library that is there: as it is named, else of that name beside the file.
fn found(name: &str, builder: &mut SceneBuilder) -> Option<String> {
    let alone = name.rsplit('/').next().unwrap_or_default();
    [name, alone].into_iter().find(|name| builder.has_file(name)).map(str::to_owned)
}
