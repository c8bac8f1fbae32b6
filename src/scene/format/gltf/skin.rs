//! Skins: the mesh as its joints hold it at rest.

use super::accessor::{Accessor, Which};
use super::document::{Document, get};
use super::fault::Read;
use super::nodes::Nodes;
use crate::scene::desc::MeshDesc;
use glam::{DAffine3, DVec3};
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, Node, Skin};

/// Moves a mesh to where joints hold it. `which` of the primitive's vertices the mesh has. What no joint holds is left where
/// it is.
pub fn hold(
    document: &Document,
    primitive: &Primitive,
    pointer: &str,
    which: Which,
    holder: Holder,
    nodes: &Nodes,
    mesh: &mut MeshDesc,
) -> Read<()> {
    let joints = joint_matrices(document, nodes, holder)?;
    let mut sums = vec![DAffine3::ZERO; mesh.vertices.len()];
    let mut totals = vec![0.0; mesh.vertices.len()];
    for set in 0.. {
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let (Some(held_by), Some(weights)) = (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set)))
        else {
            break;
        };
        let open =
            |index, name: &str| Accessor::open(document, index, format_args!("{pointer}/attributes/{name}_{set}"));
        let held_by = open(held_by, "JOINTS")?.integers::<4>(which)?;
        let weights = open(weights, "WEIGHTS")?.shares::<4>(which)?;
        for (((held_by, weights), sum), total) in held_by.iter().zip(&weights).zip(&mut sums).zip(&mut totals) {
            for (&joint, &weight) in held_by.iter().zip(weights) {
                let weight = f64::from(weight);
                if let Some(joint) = joints.get(joint as usize).filter(|_| weight > 0.0) {
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
fn joint_matrices(document: &Document, nodes: &Nodes, Holder { skin, node }: Holder) -> Read<Vec<DAffine3>> {
    let i = skin.value();
    let skin = get(&document.root.skins, skin, "skin", format_args!("/nodes/{node}/skin"))?;
    document.take_elements(skin.joints.len() as u64, format_args!("/skins/{i}/joints"))?;
    let mut binds = Vec::new();
    if let Some(index) = skin.inverse_bind_matrices {
        let accessor = Accessor::open(document, index, format_args!("/skins/{i}/inverseBindMatrices"))?;
        binds = accessor.vectors::<16>(Which::All)?;
    }
    let joint = |(place, &joint): (usize, &Index<Node>)| {
        get(&document.root.nodes, joint, "node", format_args!("/skins/{i}/joints/{place}"))?;
        // A joint outside of the scene has no place in the world: it leaves the mesh as it was bound.
        let Some(world) = nodes.worlds[joint.value()] else { return Ok(DAffine3::IDENTITY) };
        Ok(match binds.get(place) {
            None => world,
            Some(m) => {
                let column = |at: usize| DVec3::new(m[at].into(), m[at + 1].into(), m[at + 2].into());
                world * DAffine3::from_cols(column(0), column(4), column(8), column(12))
            }
        })
    };
    skin.joints.iter().enumerate().map(joint).collect()
}
