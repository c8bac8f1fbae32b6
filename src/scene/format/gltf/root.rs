//! The JSON of a file: the parts that are read, each as the `gltf` crate types it.
//!
//! The crate's own root demands more than the specification (a scene must have nodes, a channel of an animation a
//! target) and reads what is not shown.

use gltf::json::extensions;
use gltf::json::{
    Accessor, Asset, Buffer, Camera, Image, Index, Material, Mesh, Node, Skin, Texture, buffer, texture,
};
use serde::Deserialize;

/// What a file holds.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
#[allow(missing_docs, reason = "the fields are the file's own keys")]
pub struct Root {
    pub asset: Asset,
    #[serde(default)]
    pub extensions_used: Vec<String>,
    #[serde(default)]
    pub extensions_required: Vec<String>,
    #[serde(default)]
    pub extensions: extensions::root::Root,
    pub scene: Option<Index<Scene>>,
    #[serde(default)]
    pub scenes: Vec<Scene>,
    #[serde(default)]
    pub nodes: Vec<Node>,
    #[serde(default)]
    pub meshes: Vec<Mesh>,
    #[serde(default)]
    pub skins: Vec<Skin>,
    #[serde(default)]
    pub cameras: Vec<Camera>,
    #[serde(default)]
    pub materials: Vec<Material>,
    #[serde(default)]
    pub textures: Vec<Texture>,
    #[serde(default)]
    pub images: Vec<Image>,
    #[serde(default)]
    pub samplers: Vec<texture::Sampler>,
    #[serde(default)]
    pub accessors: Vec<Accessor>,
    #[serde(default)]
    pub buffer_views: Vec<buffer::View>,
    #[serde(default)]
    pub buffers: Vec<Buffer>,
}

/// A scene: the roots of its trees.
#[derive(Debug, Deserialize)]
pub struct Scene {
    /// Nodes that nothing is above of.
    #[serde(default)]
    pub nodes: Vec<Index<Node>>,
}
