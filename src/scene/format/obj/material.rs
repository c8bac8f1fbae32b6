//! Material libraries (MTL): Phong's materials with textures.
//!
//! A statement that makes no sense is a warning and is left out. `Ka` is read and left: many programs write 1 for every
//! material, which would drown all shading where a scene has ambient light.

use super::map::{self, Map, Textures, left_out, paths};
use super::statement::{Statement, statements};
use crate::scene::desc::MaterialDesc;
use crate::scene::desc::map::shortened;
use crate::scene::desc::problem::{Outcome, Problem, Warnings};
use crate::scene::material::{Alpha, ColorSource, Model, Relief, Scaled};
use glam::Vec3;
use std::collections::HashSet;

/// Height of a bump map of `-bm 1`, in texture coordinates: what JSON's `bump` has where it gives none.
const BUMP_HEIGHT: f32 = 0.01;
/// Opacity below which `map_d` leaves a hole, where it is no more than that.
const HOLE: f32 = 0.5;
/// Models of illumination below this one have no highlight.
const FIRST_HIGHLIGHT: f64 = 2.0;
/// Models of illumination from this one on have mirrors.
const FIRST_MIRROR: f64 = 3.0;
/// Models of illumination that bend light, without and with Fresnel's equations.
const REFRACTING: [f64; 2] = [6.0, 7.0];
/// Shininess below which a highlight fades: at 0, where many programs mean none, it would cover all that light falls on.
const BROADEST: f32 = 10.0;
/// Least share of the light that a filter passes.
const LEAST_PASSED: Vec3 = Vec3::splat(1.0 / 1024.0);
/// Colours from this one on go from 0 to 255.
const BRIGHTEST: f32 = 2.0;

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
        let mut odd = Vec::new();
        let read = draft.statement(&statement, folder, &mut has_file, &mut odd);
        for problem in odd {
            warnings.push(problem.at, problem.message);
        }
        match read {
            Ok(true) => {}
            Ok(false) => {
                if unknown.len() < Warnings::KEPT && unknown.insert(statement.keyword.to_vec()) {
                    warnings.push(statement.at, format!("{} is not drawn", statement.shown()));
                }
            }
            Err(problem) => warnings.push(problem.at, left_out(&problem).message),
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
    illumination: Option<f64>,
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
        odd: &mut Vec<Problem>,
    ) -> Outcome<bool> {
        let find = |name: &str| paths(name, folder).into_iter().find(|path| has_file(path));
        let map = || map::read(statement, find, odd);
        // Programs do not agree on capitals.
        match &*statement.keyword.to_ascii_lowercase() {
            b"kd" => self.diffuse = Some(diffuse(statement, odd)?),
            b"ks" => self.specular = Some(color(statement)?),
            b"ke" => self.emission = Some(color(statement)?),
            b"tf" => self.filter = Some(color(statement)?),
            b"ns" => self.shininess = Some(number(statement)?.max(0.0)),
            b"ni" => self.ior = Some(number(statement)?),
            b"d" => self.opacity = Some(number(statement)?),
            // Some programs write an opacity here; 1 can only be one, since nothing would be seen.
            b"tr" => self.opacity_by_tr = Some(1.0 - number(statement)?).filter(|opacity| *opacity > 0.0),
            b"illum" => self.illumination = Some(f64::from(number(statement)?)),
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
        let specular = self.specular.unwrap_or(Vec3::ZERO);
        let shininess = self.shininess.unwrap_or(MaterialDesc::SHININESS);
        let mirrors = self.illumination.is_some_and(|model| model >= FIRST_MIRROR);
        let has_highlight = self.illumination.is_none_or(|model| model >= FIRST_HIGHLIGHT);
        let highlight = if has_highlight { specular * (shininess / BROADEST).min(1.0) } else { Vec3::ZERO };
        let mut scaled = |map: Map, scale: f32| Scaled { scale: map.bump * scale, lookup: textures.lookup(map) };
        let relief = Relief {
            normal: self.normal_map.map(|map| scaled(map, 1.0)),
            bump: self.bump_map.map(|map| scaled(map, BUMP_HEIGHT)),
            parallax: None,
        };
        // Who gives an image, and black or nothing beside it, means the image.
        let beside = |map: &Option<Map>, factor: Option<Vec3>| match (map, factor.filter(|color| *color != Vec3::ZERO))
        {
            (None, _) => factor,
            (Some(_), factor) => factor.or(Some(Vec3::ONE)),
        };
        let glow = beside(&self.emission_map, self.emission).unwrap_or(Vec3::ZERO);
        let diffuse = beside(&self.diffuse_map, self.diffuse).unwrap_or(Vec3::ONE);
        // Nothing would be seen of a map of opacities.
        let opacity = self.opacity.or(self.opacity_by_tr).unwrap_or(1.0).clamp(0.0, 1.0);
        let opacity = if self.opacity_map.is_some() && opacity == 0.0 { 1.0 } else { opacity };
        let is_plain = self.diffuse_map.is_none() && self.opacity_map.is_none();
        let alpha = match &self.opacity_map {
            _ if opacity < 1.0 => Alpha::Blend,
            Some(_) => Alpha::Mask(HOLE),
            None => Alpha::Opaque,
        };
        let color_map = match (self.diffuse_map, self.opacity_map) {
            (map, None) => map.map(|map| textures.lookup(map)),
            // One image for both has an opacity of its own.
            (Some(map), Some(holes)) => Some(textures.masked(map, holes.file)),
            (None, Some(holes)) => Some(textures.opacity(holes)),
        };
        let material = MaterialDesc {
            name: self.name,
            color: ColorSource { factor: diffuse, texture: color_map },
            model: Model::Phong {
                ambient: MaterialDesc::AMBIENT,
                diffuse: MaterialDesc::DIFFUSE,
                specular: highlight,
                shininess,
            },
            emission: ColorSource { factor: glow, texture: self.emission_map.map(|map| textures.lookup(map)) },
            reflectivity: if mirrors { specular.min(Vec3::ONE) } else { Vec3::ZERO },
            ior: self.ior.filter(|ior| *ior > 0.0).unwrap_or(1.0),
            alpha,
            opacity,
            relief,
            ..MaterialDesc::default_phong()
        };
        // Many programs write a filter of 0 for every material.
        let filter = self.filter.filter(|filter| *filter != Vec3::ZERO).unwrap_or(Vec3::ONE);
        let refracts = material.ior != 1.0 && self.illumination.is_some_and(|model| REFRACTING.contains(&model));
        match alpha == Alpha::Blend && is_plain && (refracts || filter != Vec3::ONE) {
            true => passing(material, filter, refracts),
            false => material,
        }
    }
}

/// A material of one colour that lets `filter` of the light pass, as far as it is not opaque: straight, or bent as in glass.
fn passing(material: MaterialDesc, filter: Vec3, refracts: bool) -> MaterialDesc {
    // Its colour is that of the light that passes; divided by it, the surface's own comes out as it is.
    let filter = filter.clamp(LEAST_PASSED, Vec3::ONE);
    let own = material.color.factor / filter;
    let model = match material.model {
        Model::Phong { ambient, diffuse, specular, shininess } => {
            Model::Phong { ambient: ambient * own, diffuse: diffuse * own, specular, shininess }
        }
        other => other,
    };
    MaterialDesc {
        color: ColorSource::constant(filter),
        model,
        transparency: Vec3::splat(1.0 - material.opacity),
        fresnel: refracts,
        thin: !refracts,
        alpha: Alpha::Opaque,
        opacity: 1.0,
        ..material
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

/// `Kd r g b`, which some programs write from 0 to 255.
fn diffuse(statement: &Statement, odd: &mut Vec<Problem>) -> Outcome<Vec3> {
    let color = color(statement)?;
    if color.max_element() <= BRIGHTEST {
        return Ok(color);
    }
    odd.push(Problem::new(statement.at, "Kd is above 1; it is taken as numbers from 0 to 255"));
    Ok(color / 255.0)
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
