//! What the place looks like, and how it is read from disk.
//!
//! [`load`] turns a file into a [`Scene`]: `format` reads bytes into a typed description
//! (`desc`), `build` flattens it into geometry, objects, materials and lights.
//! Architecture invariant: a scene never changes after it was built; a reload makes a new one.

pub mod black_body;
pub mod build;
mod builtin;
pub mod camera;
pub mod desc;
pub mod environment;
pub mod error;
pub mod files;
pub mod format;
pub mod guard;
pub mod light;
pub mod limits;
pub mod material;
mod names;
pub mod object;
pub mod path;
pub mod pick;
pub mod progress;
pub mod sky;
pub mod start;
pub mod texels;
pub mod texture;

pub use build::{Instancing, read_sky};
pub use builtin::{builtin, nothing};
pub use camera::{Camera, FileCamera};

pub use environment::{Environment, EnvironmentChoice, Sky};
pub use error::{SceneError, Warning};
pub use format::{FORMATS, Format, LoadOptions, load, load_embedded, load_text, read_camera};
pub use light::Light;
pub use limits::Limits;
pub use material::Material;
pub use object::Object;
pub use path::CameraPath;
pub use progress::Progress;
pub use start::Start;
pub use texture::Texture;

use crate::geometry::{Aabb, Contacts, Geometry};
use crate::settings::{Exposure, Settings, ToneMap};
use glam::{DVec3, Vec3};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A camera that the scene file names.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedCamera {
    /// Its name in the file; the file's unnamed `camera` is called `default`.
    pub name: String,
    /// The camera.
    pub camera: Camera,
}

/// What the scene file asks of the picture.
#[derive(Clone, Debug)]
pub struct RenderDefaults {
    /// Picture width in pixels, where the file gives one.
    pub width: Option<u32>,
    /// Picture height in pixels, where the file gives one.
    pub height: Option<u32>,
    /// Most rays on a path, the primary included.
    pub max_depth: u32,
    /// Linear colour of a ray that hits nothing.
    pub background: Vec3,
    /// Linear ambient light, multiplied by each material's `ambient`.
    pub ambient: Vec3,
    /// Whether the file gives the ambient light.
    pub ambient_is_given: bool,
    /// How its light is exposed.
    pub exposure: Exposure,
    /// Tone curve of its 8-bit pictures.
    pub tone_map: ToneMap,
}

impl Default for RenderDefaults {
    fn default() -> Self {
        Self {
            width: None,
            height: None,
            max_depth: 5,
            background: Vec3::ZERO,
            ambient: Vec3::ONE,
            ambient_is_given: false,
            exposure: Exposure::Stops(0.0),
            tone_map: ToneMap::None,
        }
    }
}

/// A scene, ready to be traced.
#[derive(Debug)]
pub struct Scene {
    /// File name or another short title.
    pub name: String,
    /// What the format of its file is called, such as `JSON`.
    pub format: &'static str,
    /// Unique per built scene: caches keyed by it never outlive it.
    pub generation: u64,
    /// Milliseconds that sorting its shapes and building the tree took.
    pub build_ms: f64,
    /// Shapes and the tree over them. Shared, as are the objects, by scenes that differ in their lights alone.
    pub geometry: Arc<Geometry>,
    /// Where something touches a transparent surface.
    pub contacts: Arc<Contacts>,
    /// The place of the file that is at the origin of the scene; what is far from its own origin is moved in double precision
    /// when it is built. 0 in all other scenes.
    pub origin: DVec3,
    /// Leaf objects, depth first in file order; a hit's object index points here.
    pub objects: Arc<[Object]>,
    /// Materials; objects point here. Never empty.
    pub materials: Vec<Material>,
    /// Textures; materials point here.
    pub textures: Vec<Texture>,
    /// Lights. As it is loaded, a scene without any has `headlight`.
    pub lights: Vec<Light>,
    /// The file has no light: one at the eye is added to every frame (irradiance factor 1, no falloff).
    pub headlight: bool,
    /// Cameras of the file; the first is where a walk starts. Never empty: without one in the file, a view of the bounds.
    pub cameras: Vec<NamedCamera>,
    /// How the first camera was found.
    pub start: Start,
    /// The sky around it, if it has one.
    pub environment: Option<Environment>,
    /// What the file asks of the picture.
    pub render: RenderDefaults,
    /// Stops of automatic exposure.
    pub auto_exposure: f32,
    /// What was odd about the file, already worded for people.
    pub warnings: Vec<Warning>,
}

impl Scene {
    /// The bounds of all finite objects; empty when there is none. Planes are not finite.
    pub fn bounds(&self) -> Aabb {
        build::finite_bounds(&self.objects)
    }

    /// Whether the first camera is that of somebody who stands on a floor: a walk starts on foot.
    pub fn on_foot(&self) -> bool {
        self.start.eye_height.is_some()
    }

    /// The same place in the light of `lights`, exposed as before: they may be none, and then there is none at the eye
    /// either.
    pub fn with_lights(&self, lights: Vec<Light>) -> Self {
        Self {
            name: self.name.clone(),
            generation: next_generation(),
            geometry: Arc::clone(&self.geometry),
            contacts: Arc::clone(&self.contacts),
            objects: Arc::clone(&self.objects),
            materials: self.materials.clone(),
            textures: self.textures.clone(),
            lights,
            headlight: false,
            cameras: self.cameras.clone(),
            start: self.start.clone(),
            environment: self.environment.clone(),
            render: self.render.clone(),
            warnings: self.warnings.clone(),
            ..*self
        }
    }

    /// The same place with another environment around it, or none; lights and exposure stay.
    pub fn with_environment(&self, environment: Option<Environment>) -> Self {
        Self { environment, headlight: self.headlight, ..self.with_lights(self.lights.clone()) }
    }

    /// What the colour of unlit surfaces is to be multiplied by, so that under `exposure` they are seen as the file has
    /// them.
    ///
    /// That is so where the file leaves exposure to the viewer: its lights may then be in any unit, and what is as bright
    /// whatever the lights is in none.
    pub fn unlit_gain(&self, exposure: Exposure) -> f32 {
        match self.render.exposure {
            Exposure::Stops(_) => 1.0,
            Exposure::Auto | Exposure::Scene => libm::exp2f(-self.stops(exposure)),
        }
    }

    /// Whether it has objects and all of them show their colour whatever the light.
    pub fn is_all_unlit(&self) -> bool {
        !self.objects.is_empty() && self.objects.iter().all(|object| self.materials[object.material as usize].unlit)
    }

    /// The material of an object.
    pub fn material_of(&self, object: u32) -> &Material {
        &self.materials[self.objects[object as usize].material as usize]
    }

    /// A point of the scene in the coordinates of its file.
    pub fn in_file(&self, point: Vec3) -> DVec3 {
        camera::in_file(point, self.origin)
    }

    /// A camera in the coordinates of the file.
    pub fn file_camera(&self, camera: &Camera) -> FileCamera {
        FileCamera::of(camera, self.origin)
    }

    /// `settings` with what they leave to the scene filled in.
    pub fn resolved(&self, settings: &Settings) -> Settings {
        Settings { depth: settings.depth.or(Some(self.render.max_depth)), ..settings.clone() }
    }

    /// The stops that `exposure` means for this scene.
    pub fn stops(&self, exposure: Exposure) -> f32 {
        match exposure {
            Exposure::Stops(stops) => stops,
            Exposure::Auto => self.auto_exposure,
            Exposure::Scene => match self.render.exposure {
                Exposure::Stops(stops) => stops,
                Exposure::Auto | Exposure::Scene => self.auto_exposure,
            },
        }
    }
}

/// A scene is equal to itself only.
impl PartialEq for Scene {
    fn eq(&self, other: &Self) -> bool {
        self.generation == other.generation
    }
}

/// A number that no scene had before.
fn next_generation() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}
