//! The tree of nodes, walked without recursion: each node once, with its place in the world.

use super::document::{Document, get};
use super::fault::{Fault, Read, Report};
use crate::scene::limits::{Limits, exceeded};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf::json::{Index, Node};

/// The nodes of a scene.
pub struct Nodes {
    /// Depth first, in file order.
    pub order: Vec<usize>,
    /// From each node's own space to the world; `None` for nodes that are not in the scene.
    pub worlds: Vec<Option<DAffine3>>,
}

impl Nodes {
    /// Walks the default scene, else the first, else everything, from those on that are nobody's child.
    pub fn walk(document: &Document, limits: &Limits, report: &mut Report) -> Read<Self> {
        let nodes = &document.root.nodes;
        let mut worlds = vec![None; nodes.len()];
        let mut order = Vec::new();
        let mut waiting = roots(document, report)?;
        waiting.reverse();
        while let Some((node, parent, by)) = waiting.pop() {
            let own = get(nodes, node, "node", format_args!("{by}"));
            let Some(own) = report.attempt(own, "nodes left out")? else { continue };
            let i = node.value();
            if worlds[i].is_some() {
                if matches!(by, By::Nobody) {
                    continue;
                }
                // Entering it again would never end in a circle, and double with every level of others.
                report
                    .warn(by.to_string(), format!("node {i} has another parent or lies within itself; left out here"));
                continue;
            }
            if order.len() as u64 >= limits.nodes {
                return Err(Fault::fatal("/nodes", format!("nodes: {}", exceeded("nodes", limits.nodes))));
            }
            let world = parent * local(own, i, report);
            worlds[i] = Some(world);
            order.push(i);
            let children = own.children.iter().flatten().enumerate();
            let children = children.map(|(place, &child)| (child, world, By::Parent { node: i, place }));
            let first = waiting.len();
            waiting.extend(children);
            waiting[first..].reverse();
        }
        Ok(Self { order, worlds })
    }
}

/// Who names a node.
#[derive(Clone, Copy)]
enum By {
    Scene { scene: usize, place: usize },
    Parent { node: usize, place: usize },
    Nobody,
}

impl std::fmt::Display for By {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Scene { scene, place } => write!(f, "/scenes/{scene}/nodes/{place}"),
            Self::Parent { node, place } => write!(f, "/nodes/{node}/children/{place}"),
            Self::Nobody => write!(f, "/nodes"),
        }
    }
}

fn roots(document: &Document, report: &mut Report) -> Read<Vec<(Index<Node>, DAffine3, By)>> {
    let root = &document.root;
    let mut scene = None;
    if let Some(index) = root.scene {
        let named = get(&root.scenes, index, "scene", format_args!("/scene")).map(|scene| (index.value(), scene));
        scene = report.attempt(named, "scenes left out")?;
    }
    if let Some((scene, own)) = scene.or_else(|| Some((0, root.scenes.first()?.as_ref()?))) {
        let nodes = own.nodes.iter().enumerate();
        let by = |place| By::Scene { scene, place };
        return Ok(nodes.map(|(place, &node)| (node, DAffine3::IDENTITY, by(place))).collect());
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flatten().flat_map(|node| node.children.iter().flatten()) {
        if let Some(is_child) = is_child.get_mut(child.value()) {
            *is_child = true;
        }
    }
    let all = || (0..).zip(&is_child);
    // What lies in circles is nobody's child, either: it comes last.
    let nodes = all().filter(|(_, is_child)| !**is_child).chain(all().filter(|(_, is_child)| **is_child));
    Ok(nodes.map(|(node, _)| (Index::new(node), DAffine3::IDENTITY, By::Nobody)).collect())
}

/// From a node's own space to its parent's; what is not finite of it is left out.
fn local(node: &Node, i: usize, report: &mut Report) -> DAffine3 {
    let mut finite = |values: &[f32], key: &str| {
        let is_finite = values.iter().all(|v| v.is_finite());
        if !is_finite {
            report.warn(format!("/nodes/{i}/{key}"), "a transform that is not finite; left out");
        }
        is_finite
    };
    if let Some(m) = node.matrix.filter(|m| finite(m, "matrix")) {
        let m = m.map(f64::from);
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            report.warn(format!("/nodes/{i}/matrix"), "the matrix's last row is not 0, 0, 0, 1; taken as if it were");
        }
        let column = |at: usize| DVec3::new(m[at], m[at + 1], m[at + 2]);
        return DAffine3::from_cols(column(0), column(4), column(8), column(12));
    }
    let rotation = node.rotation.filter(|rotation| finite(&rotation.0, "rotation"));
    let scale = node.scale.filter(|scale| finite(scale, "scale")).unwrap_or([1.0; 3]);
    let translation = node.translation.filter(|moved| finite(moved, "translation")).unwrap_or([0.0; 3]);
    let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    trs(vector(translation), rotation.map_or(DQuat::IDENTITY, |rotation| unit(rotation.0)), vector(scale))
}

/// A rotation; one of length 0 turns nothing.
pub fn unit(rotation: [f32; 4]) -> DQuat {
    let [x, y, z, w] = rotation.map(f64::from);
    let rotation = DQuat::from_xyzw(x, y, z, w);
    match rotation.length() > 0.0 {
        true => rotation.normalize(),
        false => DQuat::IDENTITY,
    }
}

/// Scaled, then turned, then moved.
pub fn trs(translation: DVec3, rotation: DQuat, scale: DVec3) -> DAffine3 {
    DAffine3 { matrix3: DMat3::from_quat(rotation) * DMat3::from_diagonal(scale), translation }
}

/// Whether what is moved by it keeps a volume and stays within reach.
pub fn keeps_volumes(world: &DAffine3) -> bool {
    let determinant = world.matrix3.determinant();
    determinant != 0.0 && determinant.is_finite() && world.is_finite() && world.inverse().is_finite()
}
