//! glTF 2.0 (Khronos, 2021), as text (`.gltf`) or binary (`.glb`).
//!
//! The `gltf` crate gives the JSON its types; the rest is our own, since nothing a file says may be trusted:
//!
//! | file | what it reads |
//! |---|---|
//! | [`container`] | the chunks of a binary file |
//! | [`text`] | the text's encoding, and tokens that are not JSON |
//! | [`root`] | the JSON, entry by entry; [`repair`] and [`schema`] for entries that do not fit their types |
//! | [`document`] | buffers and buffer views; [`uri`] for where buffers are |
//! | [`extensions`] | which extensions the file needs |
//! | [`accessor`] | elements of buffer views |
//! | [`nodes`] | the tree of nodes; [`instancing`] for those that draw a mesh many times |
//! | [`objects`] | what nodes draw: each primitive read once, and placed wherever it stands |
//! | [`mesh`] | primitives; [`topology`], [`tangents`] and [`skin`] for their triangles, normal maps and joints |
//! | [`material`] | materials; [`texture`] for their textures, images and samplers |
//! | [`light`], [`camera`], [`spawn`] | what stands at nodes besides meshes |
//!
//! What is damaged or odd costs the smallest part that holds it, and a warning ([`fault`]): an attribute, a triangle, a
//! texture. Refused is what is no glTF at all, asks for more than a limit, or needs an extension for its meshes.
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
mod repair;
mod root;
mod schema;
mod skin;
mod spawn;
mod tangents;
mod text;
mod texture;
mod topology;
mod uri;

use super::Input;
use super::json::outermost;
use crate::scene::build::SceneBuilder;
use crate::scene::desc::SceneDesc;
use crate::scene::desc::map::shortened;
use crate::scene::error::SceneError;
use crate::scene::limits::Limits;
use crate::scene::material::Alpha;
use crate::scene::{Progress, RenderDefaults};
use crate::settings::{Exposure, ToneMap};
use container::Container;
use document::Document;
use fault::{Fault, Notes, Read, Report};
use material::Materials;
use nodes::Nodes;
use root::Root;
use texture::Textures;

/// Rays on a path where something can be seen through: leaves and panes lie many deep.
const DEPTH_WITH_BLENDING: u32 = 12;

/// Reads a glTF file into `builder`.
pub fn read(input: &Input, builder: &mut SceneBuilder) -> Result<(), SceneError> {
    let in_file = |fault: Fault| fault.in_file(input.path);
    let Container { json, bin } = container::open(input.bytes).map_err(in_file)?;
    let mut notes = Notes::default();
    let text = text::read(json, &mut notes);
    let nesting = builder.limits().nesting;
    let root = outermost(input.path, &text, nesting).and_then(|json| root::read(json, &mut notes).map_err(in_file));
    let root = match root {
        // With other words for what is not JSON, if it is that.
        Err(error) => match tamed(&text) {
            Some(text) => {
                let json = outermost(input.path, text.as_bytes(), nesting).map_err(|_| error)?;
                notes.add("", "numbers or characters that are not JSON; they are left out");
                root::read(json, &mut notes).map_err(in_file)?
            }
            None => return Err(error),
        },
        Ok(root) => root,
    };
    drop(text);
    check_version(&root, &mut notes).and_then(|()| extensions::check(&root, &mut notes)).map_err(in_file)?;
    let (limits, progress) = (builder.limits().clone(), builder.progress().clone());
    let document = Document::new(root, bin, &limits, &mut notes, |name| builder.read_file(name));
    let mut report = Report::default();
    report.take(notes);
    let mut has_file = |name: &str| builder.has_file(name);
    let scene = describe(&document, &limits, &progress, &mut has_file, &mut report).map_err(in_file)?;
    drop(document);
    let mut warnings = std::mem::take(&mut report.warnings);
    builder.add(scene, &mut warnings).map_err(|problem| in_file(report.fault(problem)))?;
    report.warnings = warnings;
    builder.warn(report.into_warnings(input.path));
    Ok(())
}

/// The text with other words for what is not JSON, if it has such.
fn tamed(text: &[u8]) -> Option<String> {
    text::tamed(std::str::from_utf8(text).ok()?)
}

fn check_version(root: &Root, notes: &mut Notes) -> Read<()> {
    let fault = |key: &str, version: &str| {
        let message = format!("glTF version {} is not known; expected 2.0", shortened(version));
        Err(Fault::fatal(format!("/asset/{key}"), message))
    };
    let asset = root.asset.as_ref();
    match (asset.and_then(|asset| asset.version.as_deref()), asset.and_then(|asset| asset.min_version.as_deref())) {
        (_, Some(least)) if !matches!(least, "2" | "2.0") => fault("minVersion", least),
        (Some(version), _) if version != "2" && !version.starts_with("2.") => fault("version", version),
        (None, _) => {
            notes.add("/asset/version", "the file has no version; it is read as glTF 2.0");
            Ok(())
        }
        _ => Ok(()),
    }
}

/// The description of the default scene.
fn describe(
    document: &Document,
    limits: &Limits,
    progress: &Progress,
    has_file: &mut dyn FnMut(&str) -> bool,
    report: &mut Report,
) -> Read<SceneDesc> {
    let nodes = Nodes::walk(document, limits, report)?;
    let mut textures = Textures::new(document, has_file);
    let materials = Materials::read(document, &mut textures, report)?;
    let objects = objects::objects(document, &nodes, &materials, limits, progress, report)?;
    let see_through = materials.descs.iter().any(|m| m.alpha == Alpha::Blend || m.is_transparent());
    let render = RenderDefaults::default();
    Ok(SceneDesc {
        render: RenderDefaults {
            max_depth: if see_through { DEPTH_WITH_BLENDING } else { render.max_depth },
            // Lights are in candela and lux.
            exposure: Exposure::Auto,
            tone_map: ToneMap::Neutral,
            ..render
        },
        environment: None,
        cameras: camera::cameras(document, &nodes, || objects::bounds(&objects), report)?,
        spawn: spawn::spawn(document, &nodes),
        textures: textures.descs,
        materials: materials.descs,
        lights: light::lights(document, &nodes, report)?,
        objects,
    })
}
