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
//! | [`mesh`] | vertices and faces |
//! | [`weld`] | corners that are the same vertex |
//! | [`material`] | material libraries; [`map`] for the textures in them |
//! | [`compressed`] | Zstandard |
//!
//! Points, lines and free-form surfaces are left out with a warning. A library or texture that is missing is a warning,
//! too, and a placeholder is shown.

mod compressed;
mod map;
mod material;
mod mesh;
mod statement;
mod weld;

use super::place::by_line;
use super::{Input, placed, settle, whole};
use crate::scene::build::SceneBuilder;
use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::{At, Warnings};
use crate::scene::desc::{MaterialDesc, NameRef, SceneDesc, hint};
use crate::scene::error::SceneError;
use map::Textures;
use mesh::Meshes;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Reads an OBJ file into `builder`.
pub fn read(input: &Input, builder: &mut SceneBuilder) -> Result<(), SceneError> {
    let limits = builder.limits().clone();
    let text = compressed::expanded(input.bytes, &limits)
        .map_err(|message| SceneError::Invalid { place: whole(input.path), message })?;
    let mut warnings = Warnings::default();
    let meshes = mesh::read(&text, &limits, &mut warnings);
    let described = meshes.map(|meshes| describe(meshes, input.path, builder, &mut warnings));
    settle(described, warnings, builder, |positions| by_line(input.path, &text, positions))
}

/// The scene that meshes and their materials make.
fn describe(meshes: Meshes, file: &Path, builder: &mut SceneBuilder, warnings: &mut Warnings) -> SceneDesc {
    let mut materials = Materials::default();
    for library in &meshes.libraries {
        materials.add(library, file, builder, warnings);
    }
    let mut objects = meshes.objects;
    let mut unknown = HashSet::new();
    for object in &mut objects {
        let Some(name) = object.material.take_if(|name| !materials.places.contains_key(&name.name)) else { continue };
        // A library that is missing has been told of already.
        if !materials.incomplete && unknown.len() < Warnings::KEPT && unknown.insert(name.name.clone()) {
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
    textures: Textures,
    /// The libraries so far.
    libraries: HashSet<String>,
    /// Whether a library could not be read.
    incomplete: bool,
}

impl Materials {
    /// Adds what a statement names: one library, whose name may hold blanks, or several.
    fn add(&mut self, library: &NameRef, file: &Path, builder: &mut SceneBuilder, warnings: &mut Warnings) {
        // Some programs write paths as one of the systems they run on has them.
        let whole = library.name.replace('\\', "/");
        let alone = |name: &str| name.rsplit('/').next().unwrap_or_default().to_owned();
        let names: Vec<&str> = match builder.has_file(&whole) || builder.has_file(&alone(&whole)) {
            true => vec![&whole],
            false => whole.split_ascii_whitespace().collect(),
        };
        for name in names {
            if !self.libraries.insert(name.to_owned()) {
                continue;
            }
            if self.libraries.len() > MOST_LIBRARIES {
                if self.libraries.len() == MOST_LIBRARIES + 1 {
                    self.incomplete = true;
                    warnings.push(library.at, format!("only the first {MOST_LIBRARIES} material libraries are read"));
                }
                continue;
            }
            // Where there is none, one of that name beside the file will do.
            let alone = alone(name);
            let name = if !builder.has_file(name) && builder.has_file(&alone) { &alone } else { name };
            match builder.read_file(name) {
                Ok(bytes) => self.read(name, &bytes, library.at, file, builder),
                Err(error) => {
                    self.incomplete = true;
                    let name = shortened(name);
                    let message = format!("cannot read the materials of \"{name}\": {error}; plain ones are shown");
                    warnings.push(library.at, message);
                }
            }
        }
    }

    fn read(&mut self, name: &str, bytes: &[u8], at: At, file: &Path, builder: &mut SceneBuilder) {
        self.textures.at = at;
        let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
        let (materials, warnings) = material::read(bytes, folder, &mut self.textures, |file| builder.has_file(file));
        for material in materials {
            match self.places.get(&material.name) {
                Some(&place) => self.materials[place] = material,
                None => {
                    self.places.insert(material.name.clone(), self.materials.len());
                    self.materials.push(material);
                }
            }
        }
        let path = file.parent().unwrap_or(Path::new("")).join(name);
        builder.warn(placed(warnings, |positions| by_line(&path, bytes, positions)));
    }
}
