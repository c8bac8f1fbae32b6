//! From what a file says to what is traced: names resolved, transforms applied, textures decoded.

mod bounds;
mod framing;
mod image;
mod mapping;
mod object;
mod parts;
mod placement;

pub use bounds::finite_bounds;

use super::desc::map::shortened;
use super::desc::problem::{At, Outcome, Problem, Warnings};
use super::desc::{ColorDesc, MaterialDesc, NameRef, SceneDesc, TextureDesc, TextureKind, hint};
use super::error::Warning;
use super::files::Files;
use super::limits::Limits;
use super::material::ColorSource;
use super::{Light, Material, NamedCamera, Object, RenderDefaults, Scene, Texture};
use crate::geometry::{Geometry, Part};
use glam::Vec3;
use image::ImageStore;
use placement::Placement;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Ambient light of a scene that has no lights.
const HEADLIGHT_AMBIENT: Vec3 = Vec3::splat(0.1);

/// A scene under construction.
pub struct SceneBuilder {
    name: String,
    limits: Limits,
    images: ImageStore,
    parts: Vec<Part>,
    objects: Vec<Object>,
    materials: Vec<Material>,
    /// The material of objects that name none, once there is one.
    default_material: Option<u32>,
    textures: Vec<Texture>,
    lights: Vec<Light>,
    cameras: Vec<NamedCamera>,
    render: RenderDefaults,
    warnings: Vec<Warning>,
}

/// Indices by name.
type Names = HashMap<String, u32>;

impl SceneBuilder {
    /// An empty scene that may read `files`.
    pub fn new(name: &str, files: Files, limits: Limits) -> Self {
        Self {
            name: name.to_owned(),
            images: ImageStore::new(files, &limits),
            limits,
            parts: Vec::new(),
            objects: Vec::new(),
            materials: Vec::new(),
            default_material: None,
            textures: Vec::new(),
            lights: Vec::new(),
            cameras: Vec::new(),
            render: RenderDefaults::default(),
            warnings: Vec::new(),
        }
    }

    /// What the scene may ask of the machine.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Adds warnings that have found their place.
    pub fn warn(&mut self, warnings: Vec<Warning>) {
        self.warnings.extend(warnings);
    }

    /// Adds what a description says.
    ///
    /// # Errors
    /// A name that nothing bears, a file that cannot be read, a transform that does not fit its shape,
    /// or a limit that is exceeded.
    pub fn add(&mut self, scene: SceneDesc, warnings: &mut Warnings) -> Outcome<()> {
        self.render = scene.render;
        self.cameras.extend(scene.cameras);
        self.lights.extend(scene.lights);
        let textures = self.add_textures(scene.textures)?;
        let materials = self.add_materials(scene.materials, &textures)?;
        self.add_objects(&scene.objects, &Placement::WORLD, &materials, warnings)
    }

    fn add_textures(&mut self, textures: Vec<TextureDesc>) -> Outcome<Names> {
        let mut names = Names::new();
        for TextureDesc { name, kind, size } in textures {
            let texture = match kind {
                TextureKind::Checker(colors) => Texture::Checker { colors, size },
                TextureKind::Image(file) => Texture::Image(self.images.load(&file, size)?),
            };
            names.insert(name.name, index(self.textures.len(), name.at, "textures")?);
            self.textures.push(texture);
        }
        Ok(names)
    }

    fn add_materials(&mut self, materials: Vec<MaterialDesc>, textures: &Names) -> Outcome<Names> {
        let mut names = Names::new();
        for MaterialDesc { material, color, emission } in materials {
            names.insert(material.name.clone(), index(self.materials.len(), At(0), "materials")?);
            let color = source(color, textures)?;
            let emission = source(emission, textures)?;
            self.materials.push(Material { color, emission, ..material });
        }
        Ok(names)
    }

    /// The index of the material that an object names, or of the default material.
    fn material(&mut self, name: Option<&NameRef>, materials: &Names) -> Outcome<u32> {
        if let Some(name) = name {
            return resolve(name, materials, "material");
        }
        let default = match self.default_material {
            Some(default) => default,
            None => {
                let default = index(self.materials.len(), At(0), "materials")?;
                self.materials.push(Material::default_phong());
                default
            }
        };
        self.default_material = Some(default);
        Ok(default)
    }

    /// The finished scene.
    pub fn finish(mut self) -> Scene {
        static GENERATION: AtomicU64 = AtomicU64::new(0);
        let headlight = self.lights.is_empty();
        if headlight {
            self.render.ambient = HEADLIGHT_AMBIENT;
        }
        if self.materials.is_empty() {
            self.materials.push(Material::default_phong());
        }
        if self.cameras.is_empty() {
            let camera = framing::frame(finite_bounds(&self.objects), &self.render);
            self.cameras.push(NamedCamera { name: "default".to_owned(), camera });
        }
        let start = Instant::now();
        let geometry = Geometry::build(self.parts);
        let build_ms = start.elapsed().as_secs_f64() * 1e3;
        Scene {
            name: self.name,
            generation: GENERATION.fetch_add(1, Ordering::Relaxed),
            geometry,
            build_ms,
            objects: self.objects,
            materials: self.materials,
            textures: self.textures,
            lights: self.lights,
            headlight,
            cameras: self.cameras,
            render: self.render,
            warnings: self.warnings,
        }
    }
}

fn source(color: ColorDesc, textures: &Names) -> Outcome<ColorSource> {
    match color {
        ColorDesc::Constant(color) => Ok(ColorSource::Constant(color)),
        ColorDesc::Texture(name) => resolve(&name, textures, "texture").map(ColorSource::Texture),
    }
}

fn resolve(name: &NameRef, names: &Names, what: &str) -> Outcome<u32> {
    names.get(&name.name).copied().ok_or_else(|| {
        let mut known: Vec<&str> = names.keys().map(String::as_str).collect();
        known.sort_unstable();
        let hint = hint(&name.name, known);
        Problem::new(name.at, format!("no {what} is called \"{}\"; {hint}", shortened(&name.name)))
    })
}

/// An index that fits its 32 bits.
fn index(index: usize, at: At, what: &str) -> Outcome<u32> {
    u32::try_from(index).map_err(|_| Problem::new(at, format!("more than 2^32 {what}")))
}
