//! The JSON of a file: the parts that are read, each entry as the `gltf` crate types it.
//!
//! Every entry of a list is read by itself, so that one that is damaged costs no other: what serde refuses goes through
//! [`repair`], guided by [`schema`].

use super::fault::{Fault, Notes, Read};
use super::repair::{self, Kind};
use super::schema;
use crate::scene::desc::map::shortened;
use gltf::json::extensions::scene::khr_lights_punctual::Light;
use gltf::json::{Accessor, Camera, Image, Index, Material, Mesh, Node, Skin, Texture, buffer, texture};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::value::RawValue;
use std::collections::BTreeMap;

/// Most entries of a list, and of one whose entries are large: two characters of text may ask for a thousand bytes.
const MANY: usize = 1 << 20;
const FEW: usize = 1 << 16;
/// Most required extensions: each that is not known is looked for in all meshes.
const MOST_REQUIRED: usize = 64;

/// A list of the file; an entry that is damaged is `None`.
pub type List<T> = Vec<Option<T>>;

/// What a file holds.
#[derive(Debug, Default)]
#[allow(missing_docs, reason = "the fields are the file's own keys")]
pub struct Root {
    pub asset: Option<Asset>,
    pub extensions_used: Vec<String>,
    pub extensions_required: Vec<Required>,
    pub scene: Option<Index<Scene>>,
    pub scenes: List<Scene>,
    pub nodes: List<Node>,
    pub meshes: List<Mesh>,
    pub skins: List<Skin>,
    pub cameras: List<Camera>,
    pub lights: List<Light>,
    pub materials: List<Material>,
    pub textures: List<Texture>,
    pub images: List<Image>,
    pub samplers: List<texture::Sampler>,
    pub accessors: List<Accessor>,
    pub buffer_views: List<buffer::View>,
    pub buffers: List<Buffer>,
}

/// Which glTF a file is in.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Asset {
    /// The version that it was written for.
    pub version: Option<String>,
    /// The least version that can read it.
    pub min_version: Option<String>,
}

/// A scene: the roots of its trees.
#[derive(Debug, Deserialize)]
pub struct Scene {
    /// Nodes that nothing is above of.
    #[serde(default)]
    pub nodes: Vec<Index<Node>>,
}

/// Bytes.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Buffer {
    /// How many there are, if it says so.
    pub byte_length: Option<u64>,
    /// Where they are.
    pub uri: Option<String>,
}

/// An extension that the file is not to be shown without.
#[derive(Debug)]
pub struct Required {
    /// Its name.
    pub name: String,
    /// Whether meshes, or the bytes that they are read from, name it.
    pub is_in_meshes: bool,
}

/// The keys of an object, each with its value as it stands.
type Values<'t> = BTreeMap<String, &'t RawValue>;

/// Reads the outermost value of a file.
///
/// # Errors
/// It is no glTF at all, or has a list that is too long.
pub fn read(text: &RawValue, notes: &mut Notes) -> Read<Root> {
    let not_gltf = |message: &str| Fault::fatal("", format!("not valid glTF: {message}"));
    let top: Values = values(text).ok_or_else(|| not_gltf("expected an object"))?;
    if !["asset", "scenes", "nodes", "meshes", "buffers"].iter().any(|key| top.contains_key(*key)) {
        return Err(not_gltf("missing key \"asset\""));
    }
    let extensions = top.get("extensions").and_then(|extensions| values(extensions)).unwrap_or_default();
    let lights = extensions.get("KHR_lights_punctual").and_then(|lights| values(lights)).unwrap_or_default();
    let asset = top.get("asset").and_then(|asset| repair::read(asset, schema::ASSET, "/asset", notes));
    Ok(Root {
        asset,
        extensions_used: names(&top, "extensionsUsed", notes),
        extensions_required: required(&top, notes)?,
        scene: top.get("scene").and_then(|scene| repair::read(scene, Kind::Index, "/scene", notes)),
        scenes: list(&top, "", "scenes", schema::SCENE, FEW, notes)?,
        nodes: list(&top, "", "nodes", schema::NODE, MANY, notes)?,
        meshes: list(&top, "", "meshes", schema::MESH, MANY, notes)?,
        skins: list(&top, "", "skins", schema::SKIN, FEW, notes)?,
        cameras: list(&top, "", "cameras", schema::CAMERA, FEW, notes)?,
        lights: list(&lights, "/extensions/KHR_lights_punctual", "lights", schema::LIGHT, FEW, notes)?,
        materials: list(&top, "", "materials", schema::MATERIAL, FEW, notes)?,
        textures: list(&top, "", "textures", schema::TEXTURE, FEW, notes)?,
        images: list(&top, "", "images", schema::IMAGE, FEW, notes)?,
        samplers: list(&top, "", "samplers", schema::SAMPLER, FEW, notes)?,
        accessors: list(&top, "", "accessors", schema::ACCESSOR, MANY, notes)?,
        buffer_views: list(&top, "", "bufferViews", schema::VIEW, MANY, notes)?,
        buffers: list(&top, "", "buffers", schema::BUFFER, FEW, notes)?,
    })
}

/// The keys of an object; of a key that stands twice the last value counts.
fn values(raw: &RawValue) -> Option<Values<'_>> {
    serde_json::from_str(raw.get()).ok()
}

/// The entries of the list at `key`.
fn list<T: DeserializeOwned>(
    object: &Values,
    above: &str,
    key: &str,
    kind: Kind,
    most: usize,
    notes: &mut Notes,
) -> Read<List<T>> {
    let Some(raw) = object.get(key) else { return Ok(Vec::new()) };
    let pointer = format!("{above}/{key}");
    let Ok(entries) = serde_json::from_str::<Vec<&RawValue>>(raw.get()) else {
        notes.add(pointer, "expected a list; taken as empty");
        return Ok(Vec::new());
    };
    if entries.len() > most {
        let message = format!("{} entries; expected a list of at most {most} entries", entries.len());
        return Err(Fault::fatal(pointer, message));
    }
    let entries = entries.into_iter().enumerate();
    Ok(entries.map(|(i, entry)| repair::read(entry, kind, &format!("{pointer}/{i}"), notes)).collect())
}

/// A list of names.
fn names(top: &Values, key: &str, notes: &mut Notes) -> Vec<String> {
    let names = top.get(key).and_then(|names| repair::read(names, schema::NAMES, &format!("/{key}"), notes));
    names.unwrap_or_default()
}

fn required(top: &Values, notes: &mut Notes) -> Read<Vec<Required>> {
    let names = names(top, "extensionsRequired", notes);
    if names.len() > MOST_REQUIRED {
        let message = format!("{} required extensions; expected at most {MOST_REQUIRED}", names.len());
        return Err(Fault::fatal("/extensionsRequired", message));
    }
    let of_meshes =
        ["meshes", "accessors", "bufferViews", "buffers"].map(|key| top.get(key).map_or("", |raw| raw.get()));
    let required = |name: String| {
        let quoted = format!("\"{}\"", shortened(&name));
        Required { is_in_meshes: of_meshes.iter().any(|text| text.contains(&quoted)), name }
    };
    Ok(names.into_iter().map(required).collect())
}
