//! Eric Haines's Neutral File Format: the scenes of the Standard Procedural Databases.
//!
//! ```text
//! b 0.078 0.361 0.753                   background
//! v from 0 -9 3 at 0 0 0 up 0 0 1 angle 45 hither 1 resolution 512 512
//! l 4 3 2 1 1 0.8                       light, its colour last or left out
//! f 1 0.75 0.33 0.8 0.2 30 0 1          colour, Kd, Ks, shine, T, index of refraction
//! s 0 0 0 0.5                           sphere: center, radius
//! c 0 0 0 0.5  0 0 2 0.25               open cylinder or cone: base, radius, apex, radius
//! p 3  0 0 0  1 0 0  0 1 0              polygon: corners
//! pp 3  0 0 0 0 0 1  ..                 patch: corners with normals
//! ```
//!
//! A surface is drawn from both sides. `hither` is read and left: it is meant for hidden-surface algorithms. An entity that
//! is damaged or unknown is left out with a warning, up to the next line that starts with one.

use super::encoding::as_utf8;
use super::faults::Faults;
use super::place::by_line;
use super::polygon::{Cutter, area_vector};
use super::words::Words;
use super::{Input, settle};
use crate::scene::build::SceneBuilder;
use crate::scene::desc::problem::{At, Outcome, Problem};
use crate::scene::desc::{CameraDesc, MaterialDesc, MeshDesc, NameRef, ObjectDesc, SceneDesc, ShapeDesc, hint};
use crate::scene::light::{Falloff, LightKind};
use crate::scene::limits::Limits;
use crate::scene::material::{ColorSource, Model};
use crate::scene::{Camera, Light, SceneError};
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::sync::Arc;

/// What can stand first, and what reads the rest of an entity that stands at a place.
type Entity<'t> = (&'static str, fn(&mut Reader<'t>, At) -> Outcome<()>);

/// Every entity.
fn entities<'t>() -> [Entity<'t>; 8] {
    [
        ("v", Reader::view),
        ("b", Reader::background),
        ("l", Reader::light),
        ("f", Reader::fill),
        ("s", Reader::sphere),
        ("c", Reader::cone),
        ("p", Reader::polygon),
        ("pp", Reader::patch),
    ]
}

/// Reads an NFF scene into `builder`.
pub fn read(input: &Input, builder: &mut SceneBuilder) -> Result<(), SceneError> {
    let text = as_utf8(input.bytes);
    let mut reader = Reader::of(&text, builder.limits());
    let described = reader.read();
    settle(described, reader.faults.warnings, builder, |positions| by_line(input.path, &text, positions))
}

/// A file being read.
struct Reader<'t> {
    words: Words<'t>,
    limits: &'t Limits,
    scene: SceneDesc,
    /// Lights that have no colour.
    plain_lights: Vec<usize>,
    /// The names of fills by their eight numbers.
    fills: HashMap<[u64; 8], String>,
    /// The fill of the objects to come.
    fill: Option<NameRef>,
    cutter: Cutter,
    faults: Faults,
}

impl<'t> Reader<'t> {
    fn of(text: &'t [u8], limits: &'t Limits) -> Self {
        Self {
            words: Words::of(text),
            limits,
            scene: SceneDesc::default(),
            plain_lights: Vec::new(),
            fills: HashMap::new(),
            fill: None,
            cutter: Cutter::new(),
            faults: Faults::default(),
        }
    }

    fn read(&mut self) -> Outcome<SceneDesc> {
        let entities = entities();
        while let Some(word) = self.words.next() {
            let after = self.words.clone();
            let Some((name, read)) = entities.iter().find(|(name, _)| name.as_bytes() == word.bytes) else {
                let hint = hint(&word.shown(), entities.iter().map(|(name, _)| *name));
                let message = format!("unknown entity \"{}\"; {hint}", word.shown());
                self.faults.add(Problem::new(word.at, &*message), format!("{message}; it is left out"));
                self.skip(after);
                continue;
            };
            if let Err(problem) = read(self, word.at) {
                let done = format!("{}; the entity {name} is left out", problem.message);
                self.faults.add(problem, done);
                self.skip(after);
            }
        }
        if let Some(fault) = self.faults.first().filter(|_| self.scene.objects.is_empty()) {
            return Err(fault);
        }
        self.cutter.warn(&mut self.faults.warnings);
        // "A useful intensity as desired": the lights without a colour give 1/√n each, of n lights.
        let intensity = 1.0 / (self.scene.lights.len() as f32).sqrt();
        for light in &self.plain_lights {
            self.scene.lights[*light].color = Vec3::splat(intensity);
        }
        Ok(std::mem::take(&mut self.scene))
    }

    /// Goes on at the next line that starts with an entity.
    fn skip(&mut self, from: Words<'t>) {
        let entities = entities();
        self.words = from;
        while let Some(word) = self.words.peek() {
            if entities.iter().any(|(name, _)| name.as_bytes() == word.bytes) && self.words.starts_line(&word) {
                break;
            }
            self.words.next();
        }
    }

    fn view(&mut self, entity: At) -> Outcome<()> {
        let (mut from, mut at, mut up, mut angle) = (None, None, None, None);
        while let Some(word) = self.words.peek() {
            // What is no part of the view is the next entity.
            match word.bytes {
                b"from" | b"at" | b"up" | b"angle" | b"hither" | b"resolution" => self.words.next(),
                _ => break,
            };
            match word.bytes {
                b"from" => from = Some(self.vector("from")?),
                b"at" => at = Some(self.vector("at")?),
                b"up" => up = Some(self.vector("up")?.as_vec3()),
                b"angle" => angle = Some(self.words.number("angle")? as f32),
                b"hither" => drop(self.words.number("hither")?),
                _ => match [self.picture_edge()?, self.picture_edge()?] {
                    [Ok(width), Ok(height)] => {
                        (self.scene.render.width, self.scene.render.height) = (Some(width), Some(height));
                    }
                    [Err(problem), _] | [_, Err(problem)] => {
                        let done = format!("{}; the resolution is left out", problem.message);
                        self.faults.add(problem, done);
                    }
                },
            }
        }
        let missing = |part: &str| Problem::new(entity, format!("the view lacks \"{part}\""));
        let (eye, look_at) = (from.ok_or_else(|| missing("from"))?, at.ok_or_else(|| missing("at"))?);
        let camera = Camera {
            eye: eye.as_vec3(),
            look_at: look_at.as_vec3(),
            up: up.ok_or_else(|| missing("up"))?,
            fov: angle.ok_or_else(|| missing("angle"))?,
            ..Camera::default()
        };
        let name = match self.scene.cameras.len() {
            0 => "default".to_owned(),
            n => format!("view {}", n + 1),
        };
        let camera = CameraDesc { at: entity, name, eye, look_at, camera };
        if !camera.is_valid() {
            let message = "no view: from and at must be different points, up across the line between them, and angle \
                           between 0 and 180 degrees";
            return Err(Problem::new(entity, message));
        }
        self.scene.cameras.push(camera);
        Ok(())
    }

    /// A number of pixels, or what is wrong with the number that stands there.
    fn picture_edge(&mut self) -> Outcome<Outcome<u32>> {
        let at = self.next_at();
        let pixels = self.words.number("resolution")?;
        let max = self.limits.picture_edge;
        if pixels.fract() != 0.0 || pixels < 1.0 || pixels > max as f64 {
            let message = format!("{pixels} is out of range; expected a whole number from 1 to {max}");
            return Ok(Err(Problem::new(at, message)));
        }
        Ok(Ok(pixels as u32))
    }

    fn background(&mut self, _: At) -> Outcome<()> {
        self.scene.render.background = self.color("background")?;
        Ok(())
    }

    fn light(&mut self, _: At) -> Outcome<()> {
        let position = self.vector("light position")?;
        let color = match self.words.peek().and_then(|word| word.parsed()) {
            Some(_) => self.color("light colour")?,
            None => {
                self.plain_lights.push(self.scene.lights.len());
                Vec3::ONE
            }
        };
        self.scene.lights.push(Light {
            name: None,
            kind: LightKind::Point { position },
            color,
            falloff: Falloff::None,
        });
        Ok(())
    }

    fn fill(&mut self, entity: At) -> Outcome<()> {
        let color = self.color("fill colour")?;
        let diffuse = self.at_least_0("Kd")?;
        let specular = self.at_least_0("Ks")?;
        let shininess = self.at_least_0("shine")?;
        let transparency = self.at_least_0("T")?;
        let ior = self.words.number("index of refraction")? as f32;
        let numbers = [color.x, color.y, color.z, diffuse, specular, shininess, transparency, ior];
        let bits = numbers.map(|number| u64::from(number.to_bits()));
        let name = match self.fills.get(&bits) {
            Some(name) => name.clone(),
            None => {
                let name = format!("f {}", self.fills.len() + 1);
                self.fills.insert(bits, name.clone());
                let [diffuse, specular] = [diffuse, specular].map(Vec3::splat);
                let reflectivity = self.share(specular.x, "Ks", entity);
                let transparency = self.share(transparency, "T", entity);
                let material = MaterialDesc {
                    name: name.clone(),
                    color: ColorSource::constant(color),
                    model: Model::Phong { ambient: Vec3::ZERO, diffuse, specular, shininess },
                    reflectivity,
                    transparency,
                    ior: self.ior(ior, transparency, entity),
                    fresnel: transparency != Vec3::ZERO,
                    ..MaterialDesc::default_phong()
                };
                self.scene.materials.push(material);
                name
            }
        };
        self.fill = Some(NameRef { name, at: entity });
        Ok(())
    }

    /// The part of the light that is mirrored or let through.
    fn share(&mut self, value: f32, what: &str, at: At) -> Vec3 {
        if value > 1.0 {
            self.faults
                .warnings
                .push(at, format!("{what} is {value}; no more than all light is mirrored or let through"));
        }
        Vec3::splat(value.min(1.0))
    }

    /// Many files write 0 where the index does not matter.
    fn ior(&mut self, ior: f32, transparency: Vec3, at: At) -> f32 {
        if ior > 0.0 {
            return ior;
        }
        if transparency != Vec3::ZERO {
            self.faults
                .warnings
                .push(at, format!("index of refraction {ior} is taken as 1; expected one greater than 0"));
        }
        1.0
    }

    fn sphere(&mut self, entity: At) -> Outcome<()> {
        let center = self.vector("center")?;
        let at = self.next_at();
        let radius = self.words.number("radius")?;
        if radius as f32 == 0.0 {
            return Err(Problem::new(at, "the radius is 0; expected a number greater than 0"));
        }
        if radius < 0.0 {
            self.warn_of_inside(entity);
        }
        self.object("sphere", entity, ShapeDesc::Sphere { center, radius: radius.abs() });
        Ok(())
    }

    fn cone(&mut self, entity: At) -> Outcome<()> {
        let base = self.vector("base")?;
        let at = self.next_at();
        let radius = self.words.number("radius of the base")?;
        let top = self.vector("apex")?;
        let radius_top = self.words.number("radius of the apex")?;
        if radius.max(radius_top) > 0.0 && radius.min(radius_top) < 0.0 {
            return Err(Problem::new(at, "one radius is below 0 and the other above; expected the same sign"));
        }
        if radius as f32 == 0.0 && radius_top as f32 == 0.0 {
            return Err(Problem::new(at, "both radii are 0; one of them must be greater"));
        }
        if base == top {
            return Err(Problem::new(entity, "the apex equals the base; they must be different points"));
        }
        if radius + radius_top < 0.0 {
            self.warn_of_inside(entity);
        }
        let (radius, radius_top) = (radius.abs(), radius_top.abs());
        let kind = if radius == radius_top { "cylinder" } else { "cone" };
        self.object(kind, entity, ShapeDesc::Cone { base, top, radius, radius_top, capped: false });
        Ok(())
    }

    fn warn_of_inside(&mut self, at: At) {
        self.faults.warnings.push(at, "a radius below 0 asks for the inside only; both sides are drawn");
    }

    fn polygon(&mut self, entity: At) -> Outcome<()> {
        let vertices = self.corners(entity, |reader| reader.vector("corner"))?;
        let triangles = self.cutter.cut(&vertices).to_vec();
        self.object(
            "polygon",
            entity,
            ShapeDesc::Mesh(Arc::new(MeshDesc { vertices, triangles, ..MeshDesc::default() })),
        );
        Ok(())
    }

    fn patch(&mut self, entity: At) -> Outcome<()> {
        let corners = self.corners(entity, |reader| Ok((reader.vector("corner")?, reader.vector("normal")?)))?;
        let (vertices, mut normals): (Vec<DVec3>, Vec<DVec3>) = corners.into_iter().unzip();
        let flat = area_vector(&vertices);
        if flat.try_normalize().is_none() {
            // It is left out for want of an area; its normals do not matter.
            normals.clear();
        } else if normals.iter().any(|n| n.try_normalize().is_none()) {
            self.faults.warnings.push(entity, "a normal of length 0; the patch's own is taken");
            normals.iter_mut().filter(|n| n.try_normalize().is_none()).for_each(|n| *n = flat);
        }
        let triangles = self.cutter.cut(&vertices).to_vec();
        let mesh = MeshDesc { vertices, triangles, normals, ..MeshDesc::default() };
        self.object("patch", entity, ShapeDesc::Mesh(Arc::new(mesh)));
        Ok(())
    }

    /// As many corners as the next word says.
    fn corners<T>(&mut self, entity: At, read: impl Fn(&mut Self) -> Outcome<T>) -> Outcome<Vec<T>> {
        let count = self.words.number("number of corners")?;
        if count < 3.0 || count.fract() != 0.0 {
            return Err(Problem::new(entity, format!("{count} corners; expected a whole number of at least 3")));
        }
        // Room is made as corners are found: a file can claim more than it holds.
        let mut corners = Vec::new();
        while (corners.len() as f64) < count {
            corners.push(read(self)?);
        }
        Ok(corners)
    }

    fn object(&mut self, kind: &'static str, at: At, shape: ShapeDesc) {
        let material = self.fill.clone();
        self.scene.objects.push(ObjectDesc { at, kind, name: None, material, transform: None, shape });
    }

    fn vector(&mut self, what: &str) -> Outcome<DVec3> {
        self.words.numbers(what).map(DVec3::from_array)
    }

    fn color(&mut self, what: &str) -> Outcome<Vec3> {
        Ok(Vec3::new(self.at_least_0(what)?, self.at_least_0(what)?, self.at_least_0(what)?))
    }

    fn at_least_0(&mut self, what: &str) -> Outcome<f32> {
        let at = self.next_at();
        let value = self.words.number(what)?;
        match value >= 0.0 {
            true => Ok(value as f32),
            false => Err(Problem::new(at, format!("{what} is {value}; expected a number of at least 0"))),
        }
    }

    /// Where the next word stands.
    fn next_at(&self) -> At {
        self.words.peek().map_or(self.words.end(), |word| word.at)
    }
}
