//! Positions, texture coordinates and normals: all of a file, before its faces, which may name what comes later.

use super::statement::statements;
use crate::scene::desc::problem::{At, Outcome, Problem};
use crate::scene::format::faults::Faults;
use crate::scene::format::words::Words;
use crate::scene::limits::{Limits, exceeded};
use crate::scene::texture::srgb_value_to_linear;
use glam::{DVec2, DVec3, Vec3, Vec4};

/// Brightest vertex colour that is one from 0 to 1; where a file has greater ones, they go to 255.
const BRIGHTEST: f32 = 2.0;

/// What the corners of faces may name.
#[derive(Debug, Default)]
pub struct Vertices {
    /// Not a number where the file has none.
    pub positions: Vec<DVec3>,
    /// Linear; one a position from the first of the file up to the last that has one.
    pub colors: Vec<Vec4>,
    pub uvs: Vec<DVec2>,
    /// Not a number where the file has none.
    pub normals: Vec<DVec3>,
}

/// Vertices, corners of faces, and what they carry, that may still be read.
#[derive(Debug)]
pub struct Budget {
    left: u64,
    limit: u64,
}

impl Budget {
    pub fn of(limits: &Limits) -> Self {
        Self { left: limits.vertices, limit: limits.vertices }
    }

    /// Takes `count` vertices or corners from what a file may ask for.
    pub fn take(&mut self, at: At, count: u64) -> Outcome<()> {
        let left = self.left.checked_sub(count);
        let message = || format!("vertices and corners: {}", exceeded("vertices", self.limit));
        self.left = left.ok_or_else(|| Problem::new(at, message()))?;
        Ok(())
    }
}

/// Reads them from the statements of a file.
pub fn read(text: &[u8], budget: &mut Budget, faults: &mut Faults) -> Outcome<Vertices> {
    let mut vertices = Vertices::default();
    let mut brightest: Option<(f32, At)> = None;
    for statement in statements(text) {
        let mut words = statement.words.clone();
        match statement.keyword {
            b"v" | b"V" => {
                budget.take(statement.at, 1)?;
                let position = position(&mut words, faults);
                vertices.positions.push(position);
                if let Some(color) = color(words, faults) {
                    vertices.colors.resize(vertices.positions.len() - 1, Vec4::ONE);
                    vertices.colors.push(color.extend(1.0));
                    if brightest.is_none_or(|(most, _)| color.max_element() > most) {
                        brightest = Some((color.max_element(), statement.at));
                    }
                }
            }
            b"vt" | b"VT" => {
                budget.take(statement.at, 1)?;
                vertices.uvs.push(uv(&mut words).unwrap_or_else(|problem| {
                    faults.add(problem, "a texture coordinate that is no number; it is taken as 0");
                    DVec2::ZERO
                }));
            }
            b"vn" | b"VN" => {
                budget.take(statement.at, 1)?;
                vertices.normals.push(words.numbers("normal").map(DVec3::from_array).unwrap_or_else(|problem| {
                    faults.add(problem, "a normal that is no number; the faces that name it have none");
                    DVec3::NAN
                }));
            }
            _ => {}
        }
    }
    decode(&mut vertices.colors, brightest, faults);
    Ok(vertices)
}

/// `v x y z`.
fn position(words: &mut Words, faults: &mut Faults) -> DVec3 {
    const WHAT: &str = "position";
    let mut read = || -> Outcome<DVec3> {
        let (x, y) = (words.number(WHAT)?, words.number(WHAT)?);
        match words.number(WHAT) {
            // In a plane.
            Err(problem) if words.peek().is_none() && problem.at == words.end() => {
                faults.add(problem, "a position without z; it is taken as 0");
                Ok(DVec3::new(x, y, 0.0))
            }
            z => Ok(DVec3::new(x, y, z?)),
        }
    };
    read().unwrap_or_else(|problem| {
        faults.add(problem, "a position that is no number; the faces that name it are left out");
        DVec3::NAN
    })
}

/// What follows a position: a weight that only free-form surfaces use, or red, green and blue.
fn color(mut words: Words, faults: &mut Faults) -> Option<Vec3> {
    words.clone().nth(2)?;
    let color = words.numbers("vertex colour").map_err(|problem| {
        faults.add(problem, "a vertex colour that is no number; it is left out");
    });
    color.ok().map(|color| DVec3::from_array(color).as_vec3().max(Vec3::ZERO))
}

/// `vt u`, `vt u v` or `vt u v w`.
fn uv(words: &mut Words) -> Outcome<DVec2> {
    let u = words.number("texture coordinate")?;
    let v = words.next().map_or(Ok(0.0), |word| word.number())?;
    Ok(DVec2::new(u, v))
}

/// Colours of a file in sRGB, from 0 to 1 or to 255, become linear.
fn decode(colors: &mut [Vec4], brightest: Option<(f32, At)>, faults: &mut Faults) {
    let mut scale = 1.0;
    if let Some((_, at)) = brightest.filter(|(most, _)| *most > BRIGHTEST) {
        scale = 1.0 / 255.0;
        faults.warnings.push(at, "vertex colours above 1; all are taken as numbers from 0 to 255");
        // Those of vertices that have none stay white.
        colors.iter_mut().filter(|color| **color == Vec4::ONE).for_each(|color| *color = Vec4::splat(255.0));
    }
    for color in colors {
        *color = (color.truncate() * scale).map(|value| srgb_value_to_linear(value.min(1.0))).extend(1.0);
    }
}
