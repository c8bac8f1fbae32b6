//! Skins: the mesh as its joints hold it at rest.

use super::accessor::{Accessor, Which};
use super::document::{Document, get};
use super::fault::{Notes, Read};
use super::mesh::LOST;
use super::nodes::Nodes;
use crate::scene::desc::MeshDesc;
use glam::{DAffine3, DVec3};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, Node, Skin};

/// Moves a mesh to where joints hold it. `which` of the primitive's vertices the mesh has. What no joint holds is left where
/// it is.
#[allow(clippy::too_many_arguments, reason = "parts of a file, borrowed apart")]
pub fn hold(
    document: &Document,
    primitive: &Primitive,
    pointer: &str,
    which: Which,
    holder: Holder,
    nodes: &Nodes,
    mesh: &mut MeshDesc,
    notes: &mut Notes,
) -> Read<()> {
    let joints = joint_matrices(document, nodes, holder, notes)?;
    let mut sums = vec![DAffine3::ZERO; mesh.vertices.len()];
    let mut totals = vec![0.0; mesh.vertices.len()];
    for set in 0.. {
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let (Some(held_by), Some(weights)) = (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set)))
        else {
            break;
        };
        let mut open = |index, name: &str| {
            Accessor::open(document, index, format_args!("{pointer}/attributes/{name}_{set}"), notes)
        };
        let held_by = open(held_by, "JOINTS").and_then(|held_by| held_by.integers::<4>(which));
        let weights = open(weights, "WEIGHTS").and_then(|weights| weights.shares::<4>(which));
        let (Some(held_by), Some(weights)) = (notes.attempt(held_by, LOST)?, notes.attempt(weights, LOST)?) else {
            continue;
        };
        for (((held_by, weights), sum), total) in held_by.iter().zip(&weights).zip(&mut sums).zip(&mut totals) {
            for (&joint, &weight) in held_by.iter().zip(weights) {
                let weight = f64::from(weight);
                if let Some(joint) = joints.get(joint as usize).filter(|_| weight > 0.0 && weight.is_finite()) {
                    sum.matrix3 += joint.matrix3 * weight;
                    sum.translation += joint.translation * weight;
                    *total += weight;
                }
            }
        }
    }
    for (i, (sum, total)) in sums.iter().zip(totals).enumerate() {
        if total <= 0.0 {
            continue;
        }
        let (linear, translation) = (sum.matrix3 * (1.0 / total), sum.translation / total);
        mesh.vertices[i] = linear * mesh.vertices[i] + translation;
        if let Some(normal) = mesh.normals.get_mut(i) {
            *normal = linear.inverse().transpose() * *normal;
        }
        if let Some(tangent) = mesh.tangents.get_mut(i) {
            *tangent = (linear * tangent.truncate().as_dvec3()).normalize_or_zero().as_vec3().extend(tangent.w);
        }
    }
    Ok(())
}

/// What holds the mesh of a node.
#[derive(Clone, Copy)]
pub struct Holder {
    /// The skin.
    pub skin: Index<Skin>,
    /// The node that names it.
    pub node: usize,
}

/// Where each joint of a skin takes the mesh at rest: from the mesh's own space to the world. The place of the mesh's own
/// node does not count.
fn joint_matrices(
    document: &Document,
    nodes: &Nodes,
    Holder { skin, node }: Holder,
    notes: &mut Notes,
) -> Read<Vec<DAffine3>> {
    let i = skin.value();
    let skin = get(&document.root.skins, skin, "skin", format_args!("/nodes/{node}/skin"))?;
    document.take_elements(skin.joints.len() as u64, format_args!("/skins/{i}/joints"))?;
    let mut binds = Vec::new();
    if let Some(index) = skin.inverse_bind_matrices {
        let accessor = Accessor::open(document, index, format_args!("/skins/{i}/inverseBindMatrices"), notes);
        let matrices = accessor.and_then(|accessor| accessor.vectors::<16>(Which::All));
        binds = notes.attempt(matrices, "matrices of skins left out")?.unwrap_or_default();
    }
    let joint = |(place, &joint): (usize, &Index<Node>)| {
        // A joint that is not in the scene has no place in the world: it leaves the mesh as it was bound.
        let Some(world) = nodes.worlds.get(joint.value()).copied().flatten() else { return DAffine3::IDENTITY };
        match binds.get(place).filter(|m| m.iter().all(|v| v.is_finite())) {
            None => world,
            Some(m) => {
                let column = |at: usize| DVec3::new(m[at].into(), m[at + 1].into(), m[at + 2].into());
                world * DAffine3::from_cols(column(0), column(4), column(8), column(12))
            }
        }
    };
    let missing = |joint: &Index<Node>| joint.value() >= nodes.worlds.len();
    if skin.joints.iter().any(missing) {
        notes.add(format!("/skins/{i}/joints"), "joints that are not there; what they hold stays as it was bound");
    }
    if binds.iter().flatten().any(|v| !v.is_finite()) {
        let message = "matrices that are not finite; they are left out";
        notes.add(format!("/skins/{i}/inverseBindMatrices"), message);
    }
    Ok(skin.joints.iter().enumerate().map(joint).collect())
}
