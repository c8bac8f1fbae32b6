//! `EXT_mesh_gpu_instancing`: one node that draws its mesh many times.

use super::accessor::{Accessor, Which};
use super::document::Document;
use super::fault::{Fault, Read};
use super::nodes::{trs, unit};
use crate::scene::limits::exceeded;
use glam::{DAffine3, DQuat, DVec3};
use gltf::json::{self, Index, Node};
use serde_json::Value;

/// The name of the extension.
pub const EXTENSION: &str = "EXT_mesh_gpu_instancing";

/// From each instance's space to that of the node, which are the same where it draws its mesh once. `limit` is what the
/// file may ask for.
pub fn instances(document: &Document, node: &Node, i: usize, limit: u64) -> Read<Vec<DAffine3>> {
    let Some(extension) = node.extensions.as_ref().and_then(|extensions| extensions.others.get(EXTENSION)) else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    let open = |name: &str| attribute(document, extension, name, i);
    let [translation, rotation, scale] = [open("TRANSLATION")?, open("ROTATION")?, open("SCALE")?];
    let counts = [&translation, &rotation, &scale].map(|accessor| accessor.as_ref().map(Accessor::count));
    let count = counts.iter().flatten().copied().next().unwrap_or(1);
    if count as u64 > limit {
        return Err(Fault::new(format!("/nodes/{i}"), format!("instances: {}", exceeded("nodes", limit))));
    }
    if counts.iter().flatten().any(|other| *other != count) {
        let pointer = format!("/nodes/{i}/extensions/{EXTENSION}/attributes");
        return Err(Fault::new(pointer, "the attributes have different counts; expected one entry an instance"));
    }
    let translations = translation.map(|accessor| accessor.vectors::<3>(Which::All)).transpose()?;
    let rotations = rotation.map(|accessor| accessor.vectors::<4>(Which::All)).transpose()?;
    let scales = scale.map(|accessor| accessor.vectors::<3>(Which::All)).transpose()?;
    let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let instance = |place: usize| {
        trs(
            translations.as_ref().map_or(DVec3::ZERO, |all| vector(all[place])),
            rotations.as_ref().map_or(DQuat::IDENTITY, |all| unit(all[place])),
            scales.as_ref().map_or(DVec3::ONE, |all| vector(all[place])),
        )
    };
    Ok((0..count).map(instance).collect())
}

fn attribute<'d>(document: &'d Document, extension: &Value, name: &str, i: usize) -> Read<Option<Accessor<'d>>> {
    let Some(value) = extension.get("attributes").and_then(|attributes| attributes.get(name)) else { return Ok(None) };
    let pointer = format_args!("/nodes/{i}/extensions/{EXTENSION}/attributes/{name}");
    let index = value.as_u64().and_then(|index| u32::try_from(index).ok());
    let index = index.ok_or_else(|| Fault::new(pointer.to_string(), "expected the number of an accessor"))?;
    Accessor::open(document, Index::<json::Accessor>::new(index), pointer).map(Some)
}
