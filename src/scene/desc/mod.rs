//! The typed description of a scene: what a file says, checked value by value, names not yet resolved.
//!
//! Every tree-like syntax is read through [`Node`] by the same functions, so defaults, checks and
//! messages are the same for all. `build` turns the description into a [`Scene`](super::Scene).

pub mod camera;
pub mod environment;
pub mod light;
pub mod map;
pub mod material;
pub mod node;
pub mod object;
pub mod problem;
pub mod render;
pub mod suggest;
pub mod texture;
pub mod transform;
pub mod value;

pub use crate::geometry::Mesh as MeshDesc;
pub use environment::{EnvironmentDesc, SkyDesc};
pub use material::MaterialDesc;
pub use object::{ObjectDesc, ShapeDesc};
pub use suggest::hint;
pub use texture::{ImageDesc, ImageSource, TextureDesc, TextureKind};

use super::limits::Limits;
use super::{Camera, Light, RenderDefaults};
use glam::{DVec3, Vec3};
use map::Map;
use node::Node;
use problem::{At, Outcome, Problem, Warnings};

/// A name as it stands in the file.
#[derive(Clone, Debug)]
pub struct NameRef {
    /// The name.
    pub name: String,
    /// Where it stands.
    pub at: At,
}

/// A camera of a scene file. The scene may be moved before its places narrow to single precision.
#[derive(Clone, Debug)]
pub struct CameraDesc {
    /// Where it stands in the file.
    pub at: At,
    /// Its name.
    pub name: String,
    /// Position of the eye.
    pub eye: DVec3,
    /// A point on the optical axis.
    pub look_at: DVec3,
    /// The camera where the scene is not moved.
    pub camera: Camera,
}

impl CameraDesc {
    /// The camera in a scene that is moved so that `origin` is at its origin.
    pub fn place(&self, origin: DVec3) -> Outcome<Camera> {
        let camera = match origin == DVec3::ZERO {
            true => self.camera,
            false => {
                let [eye, look_at] = [self.eye, self.look_at].map(|point| (point - origin).as_vec3());
                Camera { eye, look_at, ..self.camera }
            }
        };
        let blind = || Problem::new(self.at, "as far out as the camera is, position and look_at round to one point");
        camera.is_valid().then_some(camera).ok_or_else(blind)
    }

    /// Whether it sees anything, wherever the scene is moved.
    pub fn is_valid(&self) -> bool {
        let is_known = self.camera.eye.is_finite() && self.camera.look_at.is_finite();
        is_known && Camera { eye: Vec3::ZERO, look_at: (self.look_at - self.eye).as_vec3(), ..self.camera }.is_valid()
    }
}

/// Where a scene file lets players start.
#[derive(Clone, Debug)]
pub struct SpawnDesc {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub position: DVec3,
    /// Where players look to, if it says so.
    pub forward: Option<DVec3>,
}

/// What a scene file says.
#[derive(Debug, Default)]
pub struct SceneDesc {
    /// What it asks of the picture.
    pub render: RenderDefaults,
    /// What surrounds the scene.
    pub environment: Option<EnvironmentDesc>,
    /// Cameras; the unnamed one first.
    pub cameras: Vec<CameraDesc>,
    /// Where players start.
    pub spawn: Option<SpawnDesc>,
    /// Textures by name.
    pub textures: Vec<TextureDesc>,
    /// Materials by name.
    pub materials: Vec<MaterialDesc>,
    /// Lights.
    pub lights: Vec<Light<DVec3>>,
    /// The tree of objects.
    pub objects: Vec<ObjectDesc>,
}

/// What readers of values share: the limits to hold, the warnings found.
pub struct Context<'a> {
    /// What a file may ask for.
    pub limits: &'a Limits,
    /// What was odd so far.
    pub warnings: Warnings,
}

/// The version of the scene format that this program reads.
const VERSION: f64 = 1.0;

/// Reads the description from the root of a tree.
pub fn read<'t, N: Node<'t>>(root: N, context: &mut Context) -> Outcome<SceneDesc> {
    let mut map = Map::open(root)?;
    map.required("version", version)?;
    let mut scene = SceneDesc::default();
    if let Some(node) = map.take("render") {
        (scene.render, scene.environment) = render::read(node, context)?;
    }
    if let Some(node) = map.take("camera") {
        scene.cameras.push(camera::read(node, "default".to_owned(), context)?);
    }
    scene.cameras.extend(map.entries("cameras", |name, _, node| camera::read(node, name.into_owned(), context))?);
    scene.textures = map.entries("textures", |name, at, node| texture::read(node, name.into_owned(), at, context))?;
    scene.materials = map.entries("materials", |name, _, node| material::read(node, name.into_owned(), context))?;
    scene.lights = list(&mut map, "lights", |node| light::read(node, context))?;
    scene.objects = list(&mut map, "objects", |node| object::read(node, context))?;
    map.finish(&mut context.warnings);
    Ok(scene)
}

fn version<'t>(node: impl Node<'t>) -> Outcome<()> {
    let version = node.number()?;
    match version == VERSION {
        true => Ok(()),
        false => Err(Problem::new(node.at(), format!("scene version {version} is not known; expected 1"))),
    }
}

/// Reads a list within a map; absent, it is empty.
fn list<'t, N: Node<'t>, T>(
    map: &mut Map<'t, N>,
    key: &'static str,
    read: impl FnMut(N) -> Outcome<T>,
) -> Outcome<Vec<T>> {
    map.take(key).map_or(Ok(Vec::new()), |node| node.items()?.into_iter().map(read).collect())
}
