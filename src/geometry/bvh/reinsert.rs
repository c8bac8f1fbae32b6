//! Mending the upper part of a binary tree: a subtree moves to where it makes boxes smaller.
//!
//! D. Meister, J. Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", 2018, with `obvhs` moving
//! the nodes. Its own search for places has a stack of fixed size and no end but the tree's: boxes that are nested
//! hundreds deep would overflow the one, and two hundred thousand of them took 15 s by the other.

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::reinsert_node;
use rayon::prelude::*;

/// Of the nodes, how many are tried in the first pass.
const SHARE: f32 = 0.2;
/// Most nodes that are tried in a pass: the large ones matter, however many small ones there are.
const MOST: usize = 50_000;
/// Pass p tries a (2p - 1)th of what the first does: fewer and fewer, larger and larger nodes.
const PASSES: usize = 24;
/// Nodes that the search for one place looks at, at most. With half or twice as many the trees come out as good.
const STEPS: usize = 512;

/// A move that pays: subtree `from` becomes the sibling of `to`.
#[derive(Clone, Copy, Debug)]
struct Move {
    from: u32,
    to: u32,
    /// By how much the areas of all boxes together shrink.
    gain: f32,
}

/// Moves subtrees of `tree` to better places, as long as that is `wanted`.
pub fn reinsert(tree: &mut Bvh2, wanted: &dyn Fn() -> bool) {
    if tree.nodes.len() < 4 {
        return;
    }
    tree.init_parents_if_uninit();
    let first_pass = ((tree.nodes.len() as f32 * SHARE) as usize).min(MOST);
    let mut candidates = Vec::new();
    let mut moves = Vec::new();
    let mut touched = vec![false; tree.nodes.len()];
    for pass in 1..=PASSES {
        if !wanted() {
            return;
        }
        largest_nodes(tree, (first_pass / (2 * pass - 1)).max(1), &mut candidates);
        moves.clear();
        let search = |stack: &mut Vec<_>, &(_, node): &(f32, u32)| best_move(tree, node, stack);
        moves.par_extend(candidates.par_iter().with_min_len(64).map_init(Vec::new, search).flatten_iter());
        moves.par_sort_unstable_by(|a: &Move, b: &Move| b.gain.total_cmp(&a.gain).then(a.from.cmp(&b.from)));
        touched.fill(false);
        for &Move { from, to, .. } in &moves {
            // A move is computed for the tree as it was: those that change the same nodes wait for the next pass.
            let parents = [from, to].map(|node| tree.parents[node as usize]);
            let changed = [from, to, sibling(from), parents[0], parents[1]].map(|node| node as usize);
            if changed.iter().any(|&node| touched[node]) {
                continue;
            }
            changed.iter().for_each(|&node| touched[node] = true);
            reinsert_node(tree, from as usize, to as usize);
        }
    }
}

fn sibling(node: u32) -> u32 {
    Bvh2Node::get_sibling_id(node as usize) as u32
}

/// The `count` largest of the nodes nearest to the root, of which the tree's construction put twice as many in front.
fn largest_nodes(tree: &Bvh2, count: usize, nodes: &mut Vec<(f32, u32)>) {
    nodes.clear();
    let front = tree.nodes.iter().zip(0..).take(2 * count + 1).skip(1);
    nodes.extend(front.map(|(node, index)| (node.aabb().half_area(), index)));
    let count = count.min(nodes.len());
    if count < nodes.len() {
        nodes.select_nth_unstable_by(count, |a, b| b.0.total_cmp(&a.0));
        nodes.truncate(count);
    }
}

/// The best new place of a node, if any is better than where it is.
///
/// Walks up from the node; from every ancestor it searches down the other side. `gain` is what the boxes above shrink
/// by, less what those between ancestor and place grow by.
fn best_move(tree: &Bvh2, from: u32, stack: &mut Vec<(f32, u32)>) -> Option<Move> {
    let aabb_of = |node: u32| tree.nodes[node as usize].aabb();
    let parent_of = |node: u32| tree.parents[node as usize];
    let own = *aabb_of(from);
    let own_area = own.half_area();
    let parent = parent_of(from);
    let mut best = Move { from, to: 0, gain: 0.0 };
    let (mut pivot, mut side) = (parent, sibling(from));
    let mut pivot_box = *aabb_of(side);
    let mut gain_above = aabb_of(parent).half_area();
    let mut steps = 0;
    loop {
        stack.clear();
        stack.push((gain_above, side));
        while let Some((gain, place)) = stack.pop() {
            if gain - own_area <= best.gain {
                continue;
            }
            steps += 1;
            if steps > STEPS {
                break;
            }
            let node = &tree.nodes[place as usize];
            let gain = gain - node.aabb().union(&own).half_area();
            if gain > best.gain {
                best = Move { from, to: place, gain };
            }
            if !node.is_leaf() {
                let gain = gain + node.aabb().half_area();
                stack.extend([(gain, node.first_index), (gain, node.first_index + 1)]);
            }
        }
        if pivot != parent {
            pivot_box = pivot_box.union(aabb_of(side));
            gain_above += aabb_of(pivot).half_area() - pivot_box.half_area();
        }
        if pivot == 0 || steps > STEPS {
            break;
        }
        side = sibling(pivot);
        pivot = parent_of(pivot);
    }
    let moves = best.gain > 0.0 && best.to != sibling(from) && best.to != parent;
    moves.then_some(best)
}
