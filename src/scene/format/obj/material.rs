//! Material libraries (MTL): Phong's materials with textures.
//!
//! A statement that makes no sense is a warning and is left out. `Ka` is read and left: many programs write 1 for every
//! material, which would drown all shading where a scene has ambient light.

use super::map::{self, Map, Textures};
use super::statement::{Statement, statements};
use crate::scene::desc::MaterialDesc;
use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::{Outcome, Problem, Warnings};
use crate::scene::material::{Alpha, ColorSource, Model, Relief, Scaled};
use glam::Vec3;
use std::collections::HashSet;

/// Height of a bump map of `-bm 1`, in texture coordinates: what JSON's `bump` has where it gives none.
const BUMP_HEIGHT: f32 = 0.01;
/// Opacity below which `map_d` leaves a hole.
const HOLE: f32 = 0.5;
/// Models of illumination from this one on have mirrors.
const FIRST_MIRROR: f64 = 3.0;

/// Statements that many programs write and that are left without a word: how a material looks elsewhere.
const WITHOUT_EFFECT: [&str; 5] = ["Ka", "map_Ka", "sharpness", "map_aat", "Km"];

/// Reads the materials of a library, and what is odd about its text. Images that its maps name are sought with
/// `has_file` and become `textures`; `folder` is the library's.
pub fn read(
    text: &[u8],
    folder: &str,
    textures: &mut Textures,
    mut has_file: impl FnMut(&str) -> bool,
) -> (Vec<MaterialDesc>, Warnings) {
    let (mut materials, mut warnings) = (Vec::new(), Warnings::default());
    let mut draft: Option<Draft> = None;
    let mut unknown = HashSet::new();
    for statement in statements(text) {
        if statement.keyword == b"newmtl" {
            let done = draft.replace(Draft::new(statement.name()));
            materials.extend(done.map(|draft| draft.finish(textures)));
            continue;
        }
        let Some(draft) = &mut draft else {
            warnings.push(statement.at, format!("{} stands before the first newmtl", statement.shown()));
            continue;
        };
        match draft.statement(&statement, folder, &mut has_file) {
            Ok(true) => {}
            Ok(false) => {
                if unknown.len() < Warnings::KEPT && unknown.insert(statement.keyword.to_vec()) {
                    warnings.push(statement.at, format!("{} is not drawn", statement.shown()));
                }
            }
            Err(problem) => warnings.push(problem.at, format!("{}; it is left out", problem.message)),
        }
    }
    materials.extend(draft.map(|draft| draft.finish(textures)));
    (materials, warnings)
}

/// A material being read.
#[derive(Debug, Default)]
struct Draft {
    name: String,
    diffuse: Option<Vec3>,
    specular: Option<Vec3>,
    emission: Option<Vec3>,
    filter: Option<Vec3>,
    shininess: Option<f32>,
    ior: Option<f32>,
    /// `d`, and what `Tr` says in its place.
    opacity: Option<f32>,
    opacity_by_tr: Option<f32>,
    illumination: f64,
    diffuse_map: Option<Map>,
    emission_map: Option<Map>,
    opacity_map: Option<Map>,
    bump_map: Option<Map>,
    normal_map: Option<Map>,
}

impl Draft {
    fn new(name: String) -> Self {
        Self { name, ..Self::default() }
    }

    /// Takes a statement in; false if it is unknown.
    fn statement(
        &mut self,
        statement: &Statement,
        folder: &str,
        has_file: &mut impl FnMut(&str) -> bool,
    ) -> Outcome<bool> {
        let mut map = || map::read(statement).map(|map| found(map, folder, &mut *has_file));
        // Programs do not agree on capitals.
        match &*statement.keyword.to_ascii_lowercase() {
            b"kd" => self.diffuse = Some(color(statement)?),
            b"ks" => self.specular = Some(color(statement)?),
            b"ke" => self.emission = Some(color(statement)?),
            b"tf" => self.filter = Some(color(statement)?),
            b"ns" => self.shininess = Some(number(statement)?.max(0.0)),
            b"ni" => self.ior = Some(number(statement)?),
            b"d" => self.opacity = Some(number(statement)?),
            // Some programs write an opacity here; 1 can only be one, since nothing would be seen.
            b"tr" => self.opacity_by_tr = Some(1.0 - number(statement)?).filter(|opacity| *opacity > 0.0),
            b"illum" => self.illumination = f64::from(number(statement)?),
            b"map_kd" => self.diffuse_map = Some(map()?),
            b"map_ke" => self.emission_map = Some(map()?),
            b"map_d" => {
                let map = map()?;
                if !has_file(&map.file) {
                    return Err(Problem::new(statement.at, format!("cannot read image \"{}\"", shortened(&map.file))));
                }
                self.opacity_map = Some(map);
            }
            b"map_bump" | b"bump" => {
                let map = map()?;
                let relief = if is_normal_map(&map.file) { &mut self.normal_map } else { &mut self.bump_map };
                *relief = Some(map);
            }
            b"norm" | b"map_norm" | b"map_kn" => self.normal_map = Some(map()?),
            _ => return Ok(WITHOUT_EFFECT.iter().any(|known| known.as_bytes() == statement.keyword)),
        }
        Ok(true)
    }

    fn finish(self, textures: &mut Textures) -> MaterialDesc {
        let opacity = self.opacity.or(self.opacity_by_tr).unwrap_or(1.0).clamp(0.0, 1.0);
        let transparency = Vec3::splat(1.0 - opacity);
        let is_transparent = transparency != Vec3::ZERO;
        let specular = self.specular.unwrap_or(Vec3::ZERO);
        let (alpha, color_map) = match (self.diffuse_map, self.opacity_map) {
            (map, None) => (Alpha::Opaque, map.map(|map| textures.lookup(map))),
            // One image for both has an opacity of its own.
            (Some(map), Some(holes)) if map.file == holes.file => (Alpha::Mask(HOLE), Some(textures.lookup(map))),
            (Some(map), Some(holes)) => (Alpha::Mask(HOLE), Some(textures.masked(map, holes.file))),
            (None, Some(holes)) => (Alpha::Mask(HOLE), Some(textures.opacity(holes))),
        };
        let mut scaled = |map: Map, scale: f32| Scaled { scale: map.bump * scale, lookup: textures.lookup(map) };
        let relief = Relief {
            normal: self.normal_map.map(|map| scaled(map, 1.0)),
            bump: self.bump_map.map(|map| scaled(map, BUMP_HEIGHT)),
            parallax: None,
        };
        let factor = match (self.filter, self.diffuse) {
            (Some(filter), _) if is_transparent => filter,
            (_, diffuse) => diffuse.unwrap_or(Vec3::ONE),
        };
        // Who gives an image of what glows, and black or nothing beside it, means the image.
        let glow = self.emission.filter(|glow| *glow != Vec3::ZERO);
        let no_glow = if self.emission_map.is_some() { Vec3::ONE } else { Vec3::ZERO };
        MaterialDesc {
            name: self.name,
            color: ColorSource { factor, texture: color_map },
            model: Model::Phong {
                ambient: MaterialDesc::AMBIENT,
                diffuse: MaterialDesc::DIFFUSE,
                specular,
                shininess: self.shininess.unwrap_or(MaterialDesc::SHININESS),
            },
            emission: ColorSource {
                factor: glow.unwrap_or(no_glow),
                texture: self.emission_map.map(|map| textures.lookup(map)),
            },
            reflectivity: if self.illumination >= FIRST_MIRROR { specular.min(Vec3::ONE) } else { Vec3::ZERO },
            transparency,
            ior: self.ior.filter(|ior| *ior > 0.0).unwrap_or(1.0),
            fresnel: is_transparent,
            alpha,
            relief,
            ..MaterialDesc::default_phong()
        }
    }
}

/// `Kd r g b`, or one number for all.
fn color(statement: &Statement) -> Outcome<Vec3> {
    let mut words = statement.words.clone();
    let red = words.number("red")?;
    let (green, blue) = match words.peek() {
        None => (red, red),
        Some(_) => (words.number("green")?, words.number("blue")?),
    };
    let color = Vec3::new(red as f32, green as f32, blue as f32);
    match color.min_element() >= 0.0 {
        true => Ok(color),
        false => Err(Problem::new(statement.at, format!("{} is below 0", statement.shown()))),
    }
}

/// `Ns 50`, or `d -halo 0.5`.
fn number(statement: &Statement) -> Outcome<f32> {
    let mut words = statement.words.clone();
    if words.peek().is_some_and(|word| word.bytes == b"-halo") {
        words.next();
    }
    Ok(words.number(&statement.shown())? as f32)
}

/// Many programs write normal maps as bump maps; their names tell.
fn is_normal_map(file: &str) -> bool {
    let name = file.rsplit('/').next().unwrap_or(file).to_lowercase();
    let stem = name.rsplit_once('.').map_or(&*name, |(stem, _)| stem);
    ["norm", "nrm", "ddn"].iter().any(|part| stem.contains(part)) || stem.ends_with("_n")
}

/// Programs write paths of the machine they ran on, or from the library's folder; an image of that name there or beside
/// the scene will do.
fn found(mut map: Map, folder: &str, mut has_file: impl FnMut(&str) -> bool) -> Map {
    let alone = map.file.rsplit('/').next().unwrap_or_default();
    let within = |name: &str| if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") };
    let mut places = [map.file.clone(), within(&map.file), alone.to_owned(), within(alone)];
    if let Some(place) = places.iter_mut().find(|place| has_file(place)) {
        map.file = std::mem::take(place);
    }
    map
}
