//! From what a file says to what is traced: names resolved, transforms applied, textures decoded.

mod allowance;
mod bounds;
mod brightness;
mod dds;
mod floors;
mod footprint;
mod framing;
mod holes;
mod image;
mod interior;
mod level;
mod lighting;
mod mapping;
mod model;
mod object;
mod origin;
mod parts;
mod placeholder;
mod placement;
pub mod probe;
mod refused;
mod sharing;
mod sky;
mod spawn;
mod stand;
mod subject;
mod surface_samples;
mod surroundings;

pub use bounds::finite_bounds;
pub use sharing::Instancing;
pub use spawn::is_spawn_name;
pub use surroundings::read_sky;

use super::desc::map::shortened;
use super::desc::problem::{At, Outcome, Problem, Warnings};
use super::desc::{
    CameraDesc, ImageSource, MaterialDesc, NameRef, ObjectDesc, SceneDesc, TextureDesc, TextureKind, hint,
};
use super::environment::{Environment, EnvironmentChoice, Sky};
use super::error::Warning;
use super::files::{FileError, Files};
use super::format::{Format, LoadOptions};
use super::limits::{Limits, exceeded};
use super::material::{Alpha, Encoding};
use super::start::{Entry, Start};
use super::texture::ImageTexture;
use super::{Light, Material, NamedCamera, Object, Progress, RenderDefaults, Scene, Texture, next_generation};
use crate::geometry::{Aabb, Contacts, Geometry, Part};
use crate::settings::Exposure;
use allowance::Allowance;
use glam::{DAffine3, DVec3, Vec3};
use holes::HoleMaps;
use image::{ImageStore, Wanted};
use lighting::{Lighting, Lit};
use model::{Contents, Models};
use origin::far_origin;
use parts::TOO_MANY_INDICES;
use placeholder::Placeholders;
use placement::Placement;
pub(super) use probe::Probe;
use sharing::{Census, Sharing};
use spawn::Spawn;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Ambient light of a scene that has no lights: a share of the headlight's. Also that of a scene that is exposed
/// automatically, as a share of what its lights usually give.
const AMBIENT_SHARE: f32 = 0.1;
/// How bright white is by automatic exposure in usual light, before the tone curve.
const WHITE: f64 = 0.5;
/// Greatest exposure in either direction, as the setting allows it.
const MOST_STOPS: f64 = 20.0;

/// Steps that looking around may take: some hundred times what scenes of 100,000 triangles ask for. Where more would be needed, as
/// where very many things lie in one another, the camera is the plain one and the exposure that of no lights.
const STEPS_AROUND: u64 = 1 << 25;

/// Warnings kept of all files together, each of which has a limit of its own.
const MOST_WARNINGS: usize = 1000;

/// A scene under construction.
pub struct SceneBuilder {
    name: String,
    format: &'static str,
    limits: Limits,
    progress: Progress,
    images: ImageStore,
    holes: HoleMaps,
    placeholders: Placeholders,
    models: Models,
    parts: Vec<Part>,
    sharing: Sharing,
    objects: Vec<Object>,
    /// The place of the file that is at the origin of the scene.
    origin: DVec3,
    /// Bounds of what is too small to be seen where it lies.
    lost: Aabb,
    materials: Vec<Material>,
    /// The material of objects that name none, once there is one.
    default_material: Option<u32>,
    textures: Vec<Texture>,
    lights: Vec<Light>,
    cameras: Vec<NamedCamera>,
    /// Where players start, if the file says so.
    spawn: Option<Spawn>,
    render: RenderDefaults,
    /// What surrounds the scene, by its file or by what was asked for.
    environment: Option<Environment>,
    environment_choice: EnvironmentChoice,
    /// Whether a studio lights it.
    studio: bool,
    warnings: Vec<Warning>,
}

/// Indices by name.
type Names = HashMap<String, u32>;

impl SceneBuilder {
    /// An empty scene of the file `scene`, which is in `format`; it may read `files`.
    pub fn new(scene: &Path, format: &'static Format, files: Files, options: &LoadOptions) -> Self {
        let name = scene.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let path = files.locate(&name).unwrap_or_else(|_| scene.to_owned());
        Self {
            name,
            format: format.name,
            models: Models::of(path, scene),
            progress: files.progress().clone(),
            images: ImageStore::new(files, &options.limits),
            limits: options.limits.clone(),
            sharing: Sharing::new(options.instancing),
            holes: HoleMaps::default(),
            placeholders: Placeholders::default(),
            parts: Vec::new(),
            objects: Vec::new(),
            origin: DVec3::ZERO,
            lost: Aabb::EMPTY,
            materials: Vec::new(),
            default_material: None,
            textures: Vec::new(),
            lights: Vec::new(),
            cameras: Vec::new(),
            spawn: None,
            render: RenderDefaults::default(),
            environment: None,
            studio: !format.says_how_it_is_lit,
            environment_choice: EnvironmentChoice::Scene,
            warnings: Vec::new(),
        }
    }

    /// What the scene may ask of the machine.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Who is told how far this has come.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// The contents of a file that a model's file names, in whatever spelling.
    ///
    /// # Errors
    /// As for [`Files::find`] and [`Files::read`].
    pub fn read_file(&mut self, name: &str) -> Result<Cow<'static, [u8]>, FileError> {
        let files = self.images.files();
        let path = files.find(name)?;
        files.read(&path)
    }

    /// Whether there is a file of that name, in whatever spelling, that the scene may read.
    pub fn has_file(&mut self, name: &str) -> bool {
        self.images.files().find(name).is_ok()
    }

    /// Adds warnings that have found their place, as long as there are not too many.
    pub fn warn(&mut self, warnings: Vec<Warning>) {
        let room = MOST_WARNINGS.saturating_sub(self.warnings.len());
        self.warnings.extend(warnings.into_iter().take(room));
    }

    /// Adds what a description says: of the scene, or of the model that is being read.
    ///
    /// # Errors
    /// A name that nothing bears, a file that cannot be read, a transform that does not fit its shape,
    /// or a limit that is exceeded.
    pub fn add(&mut self, scene: SceneDesc, warnings: &mut Warnings) -> Outcome<()> {
        let SceneDesc { render, environment, cameras, spawn, textures, materials, lights, objects } = scene;
        let materials = self.add_materials(materials, &textures, warnings)?;
        let contents = Contents { objects, lights, materials };
        if self.models.is_reading() {
            return self.place_model(contents, warnings);
        }
        self.render = render;
        self.surround_as_described(environment, warnings)?;
        self.progress.begin("placing objects", 0);
        let before = (self.materials.len(), self.textures.len(), self.warnings.len());
        let mut odd = Warnings::default();
        let mut placed = self.place(&contents, &Placement::WORLD, &mut odd);
        // What does not work so far out, or is odd there, may be as it should be elsewhere.
        if let Some(origin) = far_origin(finite_bounds(&self.objects).union(self.lost)) {
            self.start_over(before);
            self.origin = origin;
            odd = Warnings::default();
            let moved = Placement::WORLD.within(&DAffine3::from_translation(-origin), At(0))?;
            placed = self.place(&contents, &moved, &mut odd);
        }
        warnings.append(odd);
        placed?;
        for camera in cameras {
            let CameraDesc { ref name, .. } = camera;
            self.cameras.push(NamedCamera { name: name.clone(), camera: camera.place(self.origin)? });
        }
        self.spawn = spawn.map(|spawn| Spawn {
            position: (spawn.position - self.origin).as_vec3(),
            forward: spawn.forward.map(|forward| forward.as_vec3()),
            name: spawn.name,
        });
        Ok(())
    }

    /// Adds the lights and objects of the scene, `world` being its place.
    fn place(&mut self, contents: &Contents, world: &Placement, warnings: &mut Warnings) -> Outcome<()> {
        self.survey(contents)?;
        self.take_lights(contents.lights.len(), At(0))?;
        let origin = self.origin;
        let moved = |light: &Light<DVec3>| light.moved(|position| (position - origin).as_vec3(), |along| along);
        self.lights.extend(contents.lights.iter().map(moved));
        self.add_objects(&contents.objects, world, &contents.materials, warnings)
    }

    /// Forgets all that was placed, and all but the first so many materials, textures and warnings: those of models.
    fn start_over(&mut self, (materials, textures, warnings): (usize, usize, usize)) {
        self.materials.truncate(materials);
        self.textures.truncate(textures);
        self.warnings.truncate(warnings);
        (self.default_material, self.lost) = (None, Aabb::EMPTY);
        self.objects.clear();
        self.parts.clear();
        self.lights.clear();
        self.sharing.start_over();
        self.models.start_over();
        self.placeholders.start_over(textures as u32);
        self.holes = HoleMaps::default();
    }

    /// Whether there may be `count` lights more.
    fn take_lights(&self, count: usize, at: At) -> Outcome<()> {
        if (self.lights.len() + count) as u64 <= self.limits.lights {
            return Ok(());
        }
        Err(Problem::new(at, format!("lights: {}", exceeded("lights", self.limits.lights))))
    }

    /// Looks how often the file that is open places what, and decides which meshes are stored once.
    fn survey(&mut self, contents: &Contents) -> Outcome<()> {
        let may_have_holes = |object: &ObjectDesc| {
            let named = object.material.as_ref().and_then(|name| contents.materials.get(&name.name));
            named.is_some_and(|&material| matches!(self.materials[material as usize].alpha, Alpha::Mask(_)))
        };
        let census = Census::of(&contents.objects, may_have_holes);
        self.sharing.decide(&census, self.models.times());
        self.models.note(census);
        if let Some(at) = self.sharing.first_without_index(&contents.objects, self.models.times(), may_have_holes) {
            return Err(Problem::new(at, TOO_MANY_INDICES));
        }
        match self.sharing.first_beyond(&contents.objects, self.limits.primitives, may_have_holes) {
            None => Ok(()),
            Some(at) => {
                Err(Problem::new(at, format!("primitives: {}", exceeded("primitives", self.limits.primitives))))
            }
        }
    }

    /// Adds materials and the textures that they name; an image is read as colours or as data, as they use it. What is
    /// missing is left out, but for colours, for which placeholders are shown.
    fn add_materials(
        &mut self,
        materials: Vec<MaterialDesc>,
        textures: &[TextureDesc],
        warnings: &mut Warnings,
    ) -> Outcome<Names> {
        let mut uses = TextureUses::new(textures, self.textures.len());
        let mut names = Names::new();
        let first = self.materials.len();
        for material in materials {
            names.insert(material.name.clone(), index(self.materials.len(), At(0), "materials")?);
            self.materials.push(material.try_map(|name, encoding| uses.index(&name, encoding))?);
        }
        uses.add_unused()?;
        let added = &mut self.materials[first..];
        let bases: HashSet<u32> = added.iter().filter_map(|material| Some(material.color.texture?.texture)).collect();
        let images: Vec<Wanted> = uses.images(&bases).collect();
        let mut texels = self.images.load(&images, warnings)?.into_iter();
        let (mut missing, mut partial) = (HashSet::new(), HashSet::new());
        for (number, &(place, _)) in (uses.before as u32..).zip(&uses.used) {
            let TextureDesc { kind, size, .. } = &textures[place];
            let texture = match kind {
                TextureKind::Checker(colors) => Texture::Checker { colors: *colors, size: *size },
                TextureKind::Image(image) => match texels.next().flatten() {
                    Some(texels) => {
                        let is_opacity = matches!(image.source, ImageSource::Masked { .. } | ImageSource::Opacity(_));
                        if is_opacity && texels.has_partial_opacity() {
                            partial.insert(number);
                        }
                        Texture::Image(ImageTexture { texels, sampler: image.sampler, size: *size })
                    }
                    None => {
                        missing.insert(number);
                        self.placeholders.add(number)
                    }
                },
            };
            self.textures.push(texture);
        }
        for material in added {
            material.leave_out(|texture| missing.contains(texture));
            let is_partial = material.color.texture.is_some_and(|lookup| partial.contains(&lookup.texture));
            if is_partial && matches!(material.alpha, Alpha::Mask(_)) {
                material.alpha = Alpha::Blend;
            }
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

    /// The finished scene; `None` where it was cancelled.
    pub fn finish(mut self) -> Option<Scene> {
        if self.materials.is_empty() {
            self.materials.push(Material::default_phong());
        }
        self.models.forget();
        std::mem::take(&mut self.placeholders).finish(&mut self.textures);
        let start = Instant::now();
        let shapes = self.parts.len() + self.sharing.count();
        self.progress.begin(format!("building the tree over {shapes} shapes"), 0);
        let (parts, instances) = (std::mem::take(&mut self.parts), std::mem::take(&mut self.sharing).finish());
        let mut geometry = Geometry::build_while(parts, instances, &|| !self.progress.is_cancelled())?;
        geometry.hole_maps = std::mem::take(&mut self.holes.maps);
        let is_transparent =
            |object: u32| self.materials[self.objects[object as usize].material as usize].is_transparent();
        let is_wanted = || !self.progress.is_cancelled();
        let contacts = Contacts::new(&geometry, self.objects.len() as u32, is_transparent, &is_wanted)?;
        let build_ms = start.elapsed().as_secs_f64() * 1e3;
        self.progress.begin("looking around", 0);
        let progress = self.progress.clone();
        let wanted = || !progress.is_cancelled();
        let mut probe = Probe::within(&geometry, Allowance::new(STEPS_AROUND, &wanted));
        let (mut start, mut subject) = (Start::AT_CAMERA, Aabb::EMPTY);
        if self.cameras.is_empty() {
            let spawn = self.spawn.take().or_else(|| self.marked_spawn());
            let (camera, found, bounds) = framing::start(&mut probe, self.objects.len(), &self.render, spawn.as_ref());
            (start, subject) = (found, bounds);
            self.cameras.push(NamedCamera { name: "default".to_owned(), camera });
        }
        if self.lights.is_empty() && self.environment.as_ref().is_none_or(|environment| environment.sky == Sky::Studio)
        {
            self.materials.iter_mut().filter(|material| material.is_stand_in).for_each(Material::take_metal);
        }
        let mut lit = Lit {
            probe,
            camera: self.cameras[0].camera,
            objects: &self.objects,
            materials: &self.materials,
            textures: &self.textures,
            framed: (start.entry == Entry::Framed && !subject.is_empty()).then_some(subject),
            is_exposed: self.render.exposure == Exposure::Auto,
        };
        let lights = std::mem::take(&mut self.lights);
        let (lighting, is_exposed) = match (self.environment, self.environment_choice) {
            (None, EnvironmentChoice::Scene) if self.studio => (lit.in_studio(lights), true),
            (Some(Environment { sky: Sky::Studio, .. }), EnvironmentChoice::Studio) => {
                (lit.in_studio(lights), self.studio)
            }
            (Some(environment), _) => (lit.by_sky(lights, environment), self.studio),
            (None, _) => (lit.as_it_is(lights), false),
        };
        let Lighting { lights, headlight, ambient, environment, stops } = lighting;
        // The sky takes the place of light from everywhere, unless the file asks for both.
        let own = environment.is_none() || self.render.ambient_is_given;
        self.render.ambient = ambient.unwrap_or(if own { self.render.ambient } else { Vec3::ZERO });
        if is_exposed {
            self.render.exposure = Exposure::Auto;
        }
        Some(Scene {
            name: self.name,
            format: self.format,
            generation: next_generation(),
            geometry: Arc::new(geometry),
            contacts: Arc::new(contacts),
            build_ms,
            objects: self.objects.into(),
            origin: self.origin,
            materials: self.materials,
            textures: self.textures,
            lights,
            headlight,
            cameras: self.cameras,
            start,
            environment,
            render: self.render,
            auto_exposure: stops,
            warnings: self.warnings,
        })
    }

    /// The middle of the first object that is named as a spawn point, in a format that has no other way to mark one.
    fn marked_spawn(&self) -> Option<Spawn> {
        let is_marked =
            |object: &&Object| object.name.as_deref().is_some_and(is_spawn_name) && object.bounds.is_finite();
        let marked = self.objects.iter().find(is_marked).filter(|_| self.format == "OBJ")?;
        let name = shortened(marked.name.as_deref().unwrap_or_default());
        Some(Spawn { name, position: marked.bounds.center(), forward: None })
    }
}

/// Which textures of a description are used, and how.
struct TextureUses<'a> {
    textures: &'a [TextureDesc],
    names: Names,
    /// Place among the textures, and what its numbers are.
    used: Vec<(usize, Encoding)>,
    /// Index in the scene of each of these.
    indices: HashMap<(usize, Encoding), u32>,
    /// Textures that the scene has from elsewhere.
    before: usize,
}

impl<'a> TextureUses<'a> {
    fn new(textures: &'a [TextureDesc], before: usize) -> Self {
        let names = (0..).zip(textures).map(|(place, texture)| (texture.name.name.clone(), place)).collect();
        Self { textures, names, used: Vec::new(), indices: HashMap::new(), before }
    }

    /// The index in the scene of a texture that is used so.
    fn index(&mut self, name: &NameRef, encoding: Encoding) -> Outcome<u32> {
        let place = resolve(name, &self.names, "texture")? as usize;
        self.add(place, encoding)
    }

    fn add(&mut self, place: usize, encoding: Encoding) -> Outcome<u32> {
        if let Some(&index) = self.indices.get(&(place, encoding)) {
            return Ok(index);
        }
        let at = self.textures[place].name.at;
        let index = index(self.before + self.used.len(), at, "textures")?;
        self.used.push((place, encoding));
        self.indices.insert((place, encoding), index);
        Ok(index)
    }

    /// Adds those that nothing names: their files are to be there, too.
    fn add_unused(&mut self) -> Outcome<()> {
        for place in 0..self.textures.len() {
            if !self.indices.contains_key(&(place, Encoding::Data)) {
                self.add(place, Encoding::Color)?;
            }
        }
        Ok(())
    }

    /// The images among those used, in their order; `bases` are the indices of the textures that are colours of surfaces.
    fn images(&self, bases: &HashSet<u32>) -> impl Iterator<Item = Wanted<'a>> {
        (self.before as u32..).zip(&self.used).filter_map(|(number, &(place, encoding))| {
            match &self.textures[place].kind {
                TextureKind::Image(image) => Some(Wanted { image, encoding, is_base: bases.contains(&number) }),
                TextureKind::Checker(_) => None,
            }
        })
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
