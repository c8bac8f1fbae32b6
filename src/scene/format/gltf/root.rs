//! The JSON of a file: the parts that are read, each as the `gltf` crate types it.
//!
//! The crate's own root demands more than the specification (a scene must have nodes, a channel of an animation a
//! target) and reads what is not shown.

use gltf::json::extensions;
use gltf::json::{Accessor, Asset, Buffer, Camera, Image, Index, Material, Mesh, Node, Skin, Texture, buffer, texture};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;
use std::marker::PhantomData;

/// Most entries of a list, and of one whose entries are large: two characters of text may ask for a thousand bytes.
const MANY: usize = 1 << 20;
const FEW: usize = 1 << 16;

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
    #[serde(default, deserialize_with = "list::<FEW, _, _>")]
    pub scenes: Vec<Scene>,
    #[serde(default, deserialize_with = "list::<MANY, _, _>")]
    pub nodes: Vec<Node>,
    #[serde(default, deserialize_with = "list::<MANY, _, _>")]
    pub meshes: Vec<Mesh>,
    #[serde(default, deserialize_with = "list::<FEW, _, _>")]
    pub skins: Vec<Skin>,
    #[serde(default, deserialize_with = "list::<FEW, _, _>")]
    pub cameras: Vec<Camera>,
    #[serde(default, deserialize_with = "list::<FEW, _, _>")]
    pub materials: Vec<Material>,
    #[serde(default, deserialize_with = "list::<FEW, _, _>")]
    pub textures: Vec<Texture>,
    #[serde(default, deserialize_with = "list::<FEW, _, _>")]
    pub images: Vec<Image>,
    #[serde(default, deserialize_with = "list::<FEW, _, _>")]
    pub samplers: Vec<texture::Sampler>,
    #[serde(default, deserialize_with = "list::<MANY, _, _>")]
    pub accessors: Vec<Accessor>,
    #[serde(default, deserialize_with = "list::<MANY, _, _>")]
    pub buffer_views: Vec<buffer::View>,
    #[serde(default, deserialize_with = "list::<FEW, _, _>")]
    pub buffers: Vec<Buffer>,
}

/// A scene: the roots of its trees.
#[derive(Debug, Deserialize)]
pub struct Scene {
    /// Nodes that nothing is above of.
    #[serde(default)]
    pub nodes: Vec<Index<Node>>,
}

/// Reads a list of at most `MOST` entries.
fn list<'de, const MOST: usize, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    struct List<T, const MOST: usize>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>, const MOST: usize> Visitor<'de> for List<T, MOST> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            write!(f, "a list of at most {MOST} entries")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
            let mut entries = Vec::new();
            while let Some(entry) = sequence.next_element()? {
                if entries.len() == MOST {
                    return Err(A::Error::invalid_length(MOST + 1, &self));
                }
                entries.push(entry);
            }
            Ok(entries)
        }
    }
    deserializer.deserialize_seq(List::<T, MOST>(PhantomData))
}
