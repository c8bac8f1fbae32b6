//! `EXT_mesh_gpu_instancing`: one node that draws its mesh many times.

use super::accessor::{Accessor, Which};
use super::document::Document;
use super::fault::{Fault, Notes, Read};
use super::mesh::LOST;
use super::nodes::{trs, unit};
use crate::scene::limits::exceeded;
use glam::{DAffine3, DQuat, DVec3};
use gltf::json::{self, Index, Node};
use serde_json::Value;

/// The name of the extension.
pub const EXTENSION: &str = "EXT_mesh_gpu_instancing";

/// From each instance's space to that of the node, which are the same where it draws its mesh once. `limit` is what the
/// file may ask for. An attribute that cannot be read is left out; instances that are not finite are left out.
pub fn instances(document: &Document, node: &Node, i: usize, limit: u64, notes: &mut Notes) -> Read<Vec<DAffine3>> {
    let Some(extension) = node.extensions.as_ref().and_then(|extensions| extensions.others.get(EXTENSION)) else {
        return Ok(vec![DAffine3::IDENTITY]);
    };
    let pointer = || format!("/nodes/{i}/extensions/{EXTENSION}/attributes");
    let mut open = |name: &str| {
        let opened = attribute(document, extension, name, i, notes);
        notes.attempt(opened, LOST).map(Option::flatten)
    };
    let [translation, rotation, scale] = [open("TRANSLATION")?, open("ROTATION")?, open("SCALE")?];
    let counts = [&translation, &rotation, &scale].map(|accessor| accessor.as_ref().map(Accessor::count));
    let count = counts.iter().flatten().copied().min().unwrap_or(1);
    if count as u64 > limit {
        return Err(Fault::fatal(format!("/nodes/{i}"), format!("instances: {}", exceeded("nodes", limit))));
    }
    if counts.iter().flatten().any(|other| *other != count) {
        let message = format!("the attributes have different counts; the first {count} instances are drawn");
        notes.add(pointer(), message);
    }
    let mut vectors = |accessor: Option<Accessor>| {
        let read = accessor.map(|accessor| accessor.vectors::<3>(Which::All)).transpose();
        notes.attempt(read, LOST).map(Option::flatten)
    };
    let (translations, scales) = (vectors(translation)?, vectors(scale)?);
    let rotations = rotation.map(|accessor| accessor.vectors::<4>(Which::All)).transpose();
    let rotations = notes.attempt(rotations, LOST)?.flatten();
    let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let instance = |place: usize| {
        trs(
            translations.as_ref().map_or(DVec3::ZERO, |all| vector(all[place])),
            rotations.as_ref().map_or(DQuat::IDENTITY, |all| unit(all[place])),
            scales.as_ref().map_or(DVec3::ONE, |all| vector(all[place])),
        )
    };
    let instances: Vec<DAffine3> = (0..count).map(instance).filter(DAffine3::is_finite).collect();
    if instances.len() < count {
        let message = format!("{} of {count} instances are not finite; they are left out", count - instances.len());
        notes.add(pointer(), message);
    }
    Ok(instances)
}

fn attribute<'d>(
    document: &'d Document,
    extension: &Value,
    name: &str,
    i: usize,
    notes: &mut Notes,
) -> Read<Option<Accessor<'d>>> {
    let Some(value) = extension.get("attributes").and_then(|attributes| attributes.get(name)) else { return Ok(None) };
    let pointer = format_args!("/nodes/{i}/extensions/{EXTENSION}/attributes/{name}");
    let whole = value.as_f64().filter(|index| index.fract() == 0.0 && (0.0..4e9).contains(index));
    let index = whole.map(|index| index as u32);
    let index = index.ok_or_else(|| Fault::new(pointer.to_string(), "expected the number of an accessor"))?;
    Accessor::open(document, Index::<json::Accessor>::new(index), pointer, notes).map(Some)
}
