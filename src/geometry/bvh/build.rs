//! Building the tree: a binary tree by PLOC (crate `obvhs`), subtrees merged into blocks of one type where that is
//! cheaper, then collapsed to eight children a node.

use super::{Bvh, Child, Leaf, Node, WIDTH};
use crate::geometry::{Aabb, BLOCK, PrimitiveKind};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use std::time::Duration;

/// Cost of testing one primitive, in units of testing one box.
const PRIMITIVE_COST: f32 = 1.5;
/// Cost of visiting a leaf, whatever it holds.
const LEAF_COST: f32 = 1.0;
/// Cost of one level of the binary tree: about a third of a wide node's eight boxes.
const NODE_COST: f32 = 2.0;

/// What is known of a subtree of the binary tree.
#[derive(Clone, Copy)]
struct Subtree {
    /// Expected cost of a ray that hits its box, times the box's area.
    cost: f32,
    primitives: u32,
    /// The one type of its primitives, if they are of one type.
    kind: Option<PrimitiveKind>,
    /// Whether it becomes one leaf.
    leaf: bool,
}

/// Builds a tree over boxes, `None` if there are none. `make_leaf` is called once for each leaf with its type and
/// the indices of its members, at most [`BLOCK`].
pub fn build(
    boxes: &[Aabb],
    kinds: &[PrimitiveKind],
    make_leaf: &mut dyn FnMut(PrimitiveKind, &[u32]) -> Leaf,
) -> Option<Bvh> {
    if boxes.is_empty() {
        return None;
    }
    let bounds: Vec<obvhs::aabb::Aabb> =
        boxes.iter().map(|b| obvhs::aabb::Aabb::new(b.min.into(), b.max.into())).collect();
    let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
    let binary = obvhs::bvh2::builder::build_bvh2(&bounds, params, &mut Duration::default());
    let subtrees = evaluate(&binary, kinds);

    let mut bvh = Bvh { nodes: vec![Node::EMPTY], leaves: 0 };
    let mut members = Vec::with_capacity(BLOCK);
    // Pairs of a wide node and the subtree that it stands for; no recursion, however deep the tree.
    let mut pending = vec![(0, 0)];
    while let Some((wide, root)) = pending.pop() {
        for (place, subtree) in widen(&binary, &subtrees, root).into_iter().enumerate() {
            let child = if subtrees[subtree as usize].leaf {
                bvh.leaves += 1;
                gather(&binary, subtree, &mut members);
                Child::Leaf(make_leaf(kinds[members[0] as usize], &members))
            } else {
                bvh.nodes.push(Node::EMPTY);
                let number = bvh.nodes.len() as u32 - 1;
                pending.push((number, subtree));
                Child::Node(number)
            };
            let aabb = &binary.nodes[subtree as usize].aabb;
            bvh.nodes[wide as usize].set(place, Aabb { min: aabb.min.into(), max: aabb.max.into() }, child);
        }
    }
    bvh.nodes.shrink_to_fit();
    Some(bvh)
}

/// Cost and contents of every subtree, leaves first.
fn evaluate(binary: &Bvh2, kinds: &[PrimitiveKind]) -> Vec<Subtree> {
    let unknown = Subtree { cost: 0.0, primitives: 0, kind: None, leaf: true };
    let mut subtrees = vec![unknown; binary.nodes.len()];
    let mut order = Vec::with_capacity(binary.nodes.len());
    let mut pending = vec![0_u32];
    while let Some(index) = pending.pop() {
        order.push(index);
        let node = &binary.nodes[index as usize];
        if !node.is_leaf() {
            pending.extend([node.first_index, node.first_index + 1]);
        }
    }
    for &index in order.iter().rev() {
        let node = &binary.nodes[index as usize];
        let area = node.aabb.half_area();
        subtrees[index as usize] = if node.is_leaf() {
            let primitive = binary.primitive_indices[node.first_index as usize];
            let cost = area * (LEAF_COST + PRIMITIVE_COST);
            Subtree { cost, primitives: 1, kind: Some(kinds[primitive as usize]), leaf: true }
        } else {
            let [left, right] = [0, 1].map(|side| subtrees[(node.first_index + side) as usize]);
            let primitives = left.primitives + right.primitives;
            let kind = left.kind.filter(|_| left.kind == right.kind);
            let split = area * NODE_COST + left.cost + right.cost;
            let merged = area * (LEAF_COST + PRIMITIVE_COST * primitives as f32);
            let fits = kind.is_some() && primitives as usize <= BLOCK && left.leaf && right.leaf;
            let leaf = fits && merged <= split;
            Subtree { cost: if leaf { merged } else { split }, primitives, kind, leaf }
        };
    }
    subtrees
}

/// The up to eight subtrees that become the children of the wide node for `root`: the largest is opened first.
fn widen(binary: &Bvh2, subtrees: &[Subtree], root: u32) -> Vec<u32> {
    let mut children = vec![root];
    while children.len() < WIDTH {
        let area = |&place: &usize| binary.nodes[children[place] as usize].aabb.half_area();
        let widest = (0..children.len())
            .filter(|&place| !subtrees[children[place] as usize].leaf)
            .max_by(|a, b| area(a).total_cmp(&area(b)));
        let Some(place) = widest else { break };
        let first = binary.nodes[children[place] as usize].first_index;
        children[place] = first;
        children.push(first + 1);
    }
    children
}

/// The primitives below a subtree.
fn gather(binary: &Bvh2, subtree: u32, members: &mut Vec<u32>) {
    members.clear();
    let mut pending = vec![subtree];
    while let Some(index) = pending.pop() {
        let node = &binary.nodes[index as usize];
        if node.is_leaf() {
            members.push(binary.primitive_indices[node.first_index as usize]);
        } else {
            pending.extend([node.first_index, node.first_index + 1]);
        }
    }
}
