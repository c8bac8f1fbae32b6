//! Spawn points: nodes with `OMI_spawn_point`, or with such a name.

use super::document::Document;
use super::nodes::Nodes;
use crate::scene::build::is_spawn_name;
use crate::scene::desc::SpawnDesc;
use crate::scene::desc::map::shortened;

/// The name of the extension (Open Metaverse Interoperability Group).
pub const EXTENSION: &str = "OMI_spawn_point";

/// The first node that is marked as a spawn point, else the first that is named like one.
///
/// The extension says that position and rotation of the node are those of the visitor and not which of its axes is
/// forward: it is +z, the front of glTF's models.
pub fn spawn(document: &Document, nodes: &Nodes) -> Option<SpawnDesc> {
    let all = || nodes.order.iter().filter_map(|&i| Some((document.root.nodes[i].as_ref()?, nodes.worlds[i]?)));
    let extension = |node: &gltf::json::Node| node.extensions.as_ref()?.others.get(EXTENSION).cloned();
    let marked = all().find(|(node, _)| extension(node).is_some());
    let (node, world) = marked.or_else(|| all().find(|(node, _)| node.name.as_deref().is_some_and(is_spawn_name)))?;
    if !world.is_finite() {
        return None;
    }
    let told = extension(node);
    let title = told.as_ref().and_then(|told| told.get("title").or(told.get("name"))?.as_str());
    let name = node.name.as_deref().filter(|name| !name.is_empty()).or(title).unwrap_or("spawn point");
    Some(SpawnDesc {
        name: shortened(name),
        position: world.translation,
        forward: world.matrix3.z_axis.try_normalize(),
    })
}
