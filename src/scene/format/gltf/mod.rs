//! glTF 2.0 (Khronos, 2021), as text (`.gltf`) or binary (`.glb`).
//!
//! The `gltf` crate gives the JSON its types; the rest is our own, since nothing a file says may be trusted:
//!
//! | file | what it reads |
//! |---|---|
//! | [`container`] | the chunks of a binary file |
//! | [`root`] | the JSON |
//! | [`document`] | buffers and buffer views; [`uri`] for where buffers are |
//! | [`extensions`] | which extensions the file needs |
//! | [`accessor`] | elements of buffer views |
//! | [`nodes`] | the tree of nodes; [`instancing`] for those that draw a mesh many times |
//! | [`objects`] | what nodes draw: each primitive read once, and placed wherever it stands |
//! | [`mesh`] | primitives; [`topology`], [`tangents`] and [`skin`] for their triangles, normal maps and joints |
//! | [`material`] | materials; [`texture`] for their textures, images and samplers |
//! | [`light`], [`camera`] | what stands at nodes besides meshes |
//!
//! Each primitive of each node is an object, depth first in file order. All is shown at rest: animations are not played,
//! skins are held by their joints as the nodes place them, and morph targets weigh what the file says.

mod accessor;
mod camera;
mod container;
mod document;
mod extensions;
mod fault;
mod instancing;
mod light;
mod material;
mod mesh;
mod nodes;
mod objects;
mod root;
mod skin;
mod tangents;
mod texture;
mod topology;
mod uri;

use super::Input;
use super::json::parse_as;
use crate::scene::build::SceneBuilder;
use crate::scene::desc::SceneDesc;
use crate::scene::error::SceneError;
use crate::scene::limits::Limits;
use crate::scene::material::Alpha;
use crate::scene::{Progress, RenderDefaults};
use crate::settings::{Exposure, ToneMap};
use container::Container;
use document::Document;
use fault::{Fault, Read, Report};
use nodes::Nodes;
use root::Root;
use texture::Textures;

/// Rays on a path where something can be seen through: leaves and panes lie many deep.
const DEPTH_WITH_BLENDING: u32 = 12;

/// Reads a glTF file into `builder`.
pub fn read(input: &Input, builder: &mut SceneBuilder) -> Result<(), SceneError> {
    let in_file = |fault: Fault| fault.in_file(input.path);
    let Container { json, bin } = container::open(input.bytes).map_err(in_file)?;
    let root: Root = parse_as("glTF", input.path, json, builder.limits().nesting)?;
    let mut report = Report::default();
    check_version(&root).and_then(|()| extensions::check(&root, &mut report)).map_err(in_file)?;
    let limits = builder.limits().clone();
    let document = Document::new(root, bin, &limits, |name| builder.read_file(name));
    let scene = describe(&document, &limits, builder.progress(), &mut report).map_err(in_file)?;
    drop(document);
    let mut warnings = std::mem::take(&mut report.warnings);
    builder.add(scene, &mut warnings).map_err(|problem| in_file(report.fault(problem)))?;
    report.warnings = warnings;
    builder.warn(report.into_warnings(input.path));
    Ok(())
}

fn check_version(root: &Root) -> Read<()> {
    let fault = |key: &str, version: &str| {
        Err(Fault::new(format!("/asset/{key}"), format!("glTF version {version} is not known; expected 2.0")))
    };
    match (&root.asset.version, &root.asset.min_version) {
        (_, Some(least)) if least != "2.0" => fault("minVersion", least),
        (version, _) if !version.starts_with("2.") => fault("version", version),
        _ => Ok(()),
    }
}

/// The description of the default scene.
fn describe(document: &Document, limits: &Limits, progress: &Progress, report: &mut Report) -> Read<SceneDesc> {
    let nodes = Nodes::walk(document, limits, report)?;
    let mut textures = Textures::new(document);
    let materials = material::materials(document, &mut textures, report)?;
    let objects = objects::objects(document, &nodes, &materials, limits, progress, report)?;
    let see_through = materials.iter().any(|m| m.alpha == Alpha::Blend || m.is_transparent());
    let render = RenderDefaults::default();
    Ok(SceneDesc {
        render: RenderDefaults {
            max_depth: if see_through { DEPTH_WITH_BLENDING } else { render.max_depth },
            // Lights are in candela and lux.
            exposure: Exposure::Auto,
            tone_map: ToneMap::Neutral,
            ..render
        },
        cameras: camera::cameras(document, &nodes, || objects::bounds(&objects), report)?,
        textures: textures.descs,
        materials,
        lights: light::lights(document, &nodes, report)?,
        objects,
    })
}
