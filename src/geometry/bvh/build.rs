//! Building the tree: a binary tree by clustering and reinsertion, its lowest subtrees merged into blocks of one type
//! where that is cheaper, the rest collapsed to eight children a node.

use super::cluster::cluster;
use super::reinsert::reinsert;
use super::{Bvh, Child, Leaf, Node, WIDTH};
use crate::geometry::{Aabb, BLOCK, PrimitiveKind};
use obvhs::bvh2::Bvh2;
use rayon::prelude::*;

/// Cost of testing one primitive, in units of testing one box. Lower fills blocks better: less memory (at 1.5, 244 bytes
/// a triangle; at 0.6, 115; at 0.5, 101) and cheaper mirrors, but slivers are then tested by packets that pass them by.
const PRIMITIVE_COST: f32 = 0.6;
/// Cost of visiting a leaf, whatever it holds.
const LEAF_COST: f32 = 1.0;
/// Cost of one level of the binary tree: about a third of a wide node's eight boxes.
const NODE_COST: f32 = 2.0;
/// Subtrees that are collapsed side by side.
const TASKS: usize = 64;
/// Deepest tree that traversals are sure to have room for. Trees of a million triangles are a fourth as deep.
const DEEPEST: usize = 64;

/// The primitives of one leaf.
#[derive(Clone, Copy, Debug)]
pub struct LeafMembers {
    /// Their type.
    pub kind: PrimitiveKind,
    len: u8,
    members: [u32; BLOCK],
}

impl LeafMembers {
    /// A leaf of at most [`BLOCK`] primitives of one type.
    pub fn new(kind: PrimitiveKind, members: &[u32]) -> Self {
        let mut leaf = Self { kind, len: members.len() as u8, members: [0; BLOCK] };
        leaf.members[..members.len()].copy_from_slice(members);
        leaf
    }

    /// Says `names[i]` for each of its indices i; `names` are ascending.
    pub fn rename(&mut self, names: &[u32]) {
        for member in &mut self.members[..usize::from(self.len)] {
            *member = names[*member as usize];
        }
    }

    /// Their indices.
    pub fn members(&self) -> &[u32] {
        &self.members[..usize::from(self.len)]
    }
}

/// What is in a box: a primitive of some type, or an instance.
type Kind = Option<PrimitiveKind>;

/// Builds a tree over boxes, `None` if there are none or it is no longer `wanted`. Says also what its leaves hold, as indices
/// of boxes; leaves of a type are numbered in this order. Instances are named by the indices of their boxes.
pub fn build(boxes: &[Aabb], kinds: &[Kind], wanted: &dyn Fn() -> bool) -> Option<(Bvh, Vec<LeafMembers>)> {
    if boxes.is_empty() {
        return None;
    }
    let mut binary = cluster(boxes);
    reinsert(&mut binary, wanted);
    if !wanted() {
        return None;
    }
    let mut wide = collapse(&binary, kinds);
    if wide.depth > DEEPEST {
        // Where boxes are nested by the thousand, reinsertion lines them up one below the other.
        binary = cluster(boxes);
        wide = collapse(&binary, kinds);
    }
    Some((Bvh { leaves: wide.leaves.len(), nodes: wide.nodes }, wide.leaves))
}

/// A wide tree, or a part of one.
#[derive(Default)]
struct Wide {
    nodes: Vec<Node>,
    leaves: Vec<LeafMembers>,
    /// How many of its leaves are of each type.
    leaves_of: [u32; PrimitiveKind::ALL.len()],
    /// Nodes on the longest way from its root.
    depth: usize,
}

/// A subtree of the binary tree that becomes a wide node.
#[derive(Clone, Copy)]
struct Pending {
    subtree: u32,
    /// The wide node, and how many are above it.
    wide: u32,
    depth: usize,
}

/// Collapses a binary tree: its upper part first, then the subtrees below that side by side.
fn collapse(binary: &Bvh2, kinds: &[Kind]) -> Wide {
    let mut top = Wide { nodes: vec![Node::EMPTY], ..Wide::default() };
    let mut pending = std::collections::VecDeque::from([Pending { subtree: 0, wide: 0, depth: 0 }]);
    while pending.len() < TASKS {
        let Some(next) = pending.pop_front() else { return top };
        top.expand(binary, kinds, next, |child| pending.push_back(child));
    }
    let pending = Vec::from(pending);
    let parts: Vec<Wide> =
        pending.par_iter().with_max_len(1).map(|p| collapse_below(binary, kinds, p.subtree)).collect();
    top.nodes.reserve_exact(parts.iter().map(|part| part.nodes.len() - 1).sum());
    top.leaves.reserve_exact(parts.iter().map(|part| part.leaves.len()).sum());
    for (part, place) in parts.into_iter().zip(pending) {
        top.graft(part, place);
    }
    top
}

/// The wide tree of one subtree.
fn collapse_below(binary: &Bvh2, kinds: &[Kind], subtree: u32) -> Wide {
    let mut wide = Wide { nodes: vec![Node::EMPTY], ..Wide::default() };
    // No recursion, however deep the tree.
    let mut pending = vec![Pending { subtree, wide: 0, depth: 0 }];
    while let Some(next) = pending.pop() {
        wide.expand(binary, kinds, next, |child| pending.push(child));
    }
    wide
}

impl Wide {
    /// Fills a node: opens the subtree it stands for, the largest box first, until there are eight.
    fn expand(&mut self, binary: &Bvh2, kinds: &[Kind], of: Pending, mut pend: impl FnMut(Pending)) {
        self.depth = self.depth.max(of.depth + 1);
        let mut children = [Opened::default(); WIDTH];
        children[0] = Opened::new(binary, kinds, of.subtree);
        let mut count = 1;
        while count < WIDTH {
            let largest = (0..count)
                .filter(|&i| !children[i].leaf)
                .max_by(|&a, &b| children[a].area.total_cmp(&children[b].area));
            let Some(opened) = largest else { break };
            let first = binary.nodes[children[opened].subtree as usize].first_index;
            children[opened] = Opened::new(binary, kinds, first);
            children[count] = Opened::new(binary, kinds, first + 1);
            count += 1;
        }
        for (place, &Opened { subtree, leaf, .. }) in children[..count].iter().enumerate() {
            let child = if leaf {
                match members(binary, kinds, subtree) {
                    Members::Primitives(leaf) => Child::Leaf(self.add_leaf(leaf)),
                    Members::Instance(number) => Child::Instance(number),
                }
            } else {
                let wide = self.nodes.len() as u32;
                self.nodes.push(Node::EMPTY);
                pend(Pending { subtree, wide, depth: of.depth + 1 });
                Child::Node(wide)
            };
            let aabb = binary.nodes[subtree as usize].aabb();
            self.nodes[of.wide as usize].set(place, Aabb { min: aabb.min.into(), max: aabb.max.into() }, child);
        }
    }

    fn add_leaf(&mut self, leaf: LeafMembers) -> Leaf {
        self.leaves.push(leaf);
        let block = &mut self.leaves_of[leaf.kind as usize];
        *block += 1;
        Leaf { kind: leaf.kind, block: *block - 1 }
    }

    /// Puts a part in its place. Its root takes the node that was left for it; all else goes behind what is there.
    fn graft(&mut self, part: Self, place: Pending) {
        // The part's node 0 is in its place already.
        let first = self.nodes.len() as u32 - 1;
        let blocks_before = self.leaves_of;
        let mut moved = part.nodes.into_iter().map(|mut node| {
            for child in &mut node.children {
                match child {
                    Child::None | Child::Instance(_) => {}
                    Child::Node(number) => *number += first,
                    Child::Leaf(leaf) => leaf.block += blocks_before[leaf.kind as usize],
                }
            }
            node
        });
        if let Some(root) = moved.next() {
            self.nodes[place.wide as usize] = root;
        }
        self.nodes.extend(moved);
        self.leaves.extend(part.leaves);
        for (count, more) in self.leaves_of.iter_mut().zip(part.leaves_of) {
            *count += more;
        }
        self.depth = self.depth.max(place.depth + part.depth);
    }
}

/// A subtree that may become a child of a wide node.
#[derive(Clone, Copy, Default)]
struct Opened {
    subtree: u32,
    area: f32,
    /// Whether it becomes one leaf.
    leaf: bool,
}

impl Opened {
    fn new(binary: &Bvh2, kinds: &[Kind], subtree: u32) -> Self {
        let area = binary.nodes[subtree as usize].aabb().half_area();
        let leaf = fits_a_block(binary, subtree) && Merged::of(binary, kinds, subtree).leaf;
        Self { subtree, area, leaf }
    }
}

/// Whether there are at most [`BLOCK`] primitives below a subtree.
fn fits_a_block(binary: &Bvh2, subtree: u32) -> bool {
    let mut inner = [0; BLOCK];
    let (mut waiting, mut leaves, mut next) = (0, 0, Some(subtree));
    while let Some(index) = next {
        let node = &binary.nodes[index as usize];
        if node.is_leaf() {
            leaves += 1;
        } else {
            // Each subtree that waits holds a primitive at least.
            if leaves + waiting + 2 > BLOCK {
                return false;
            }
            inner[waiting] = node.first_index;
            inner[waiting + 1] = node.first_index + 1;
            waiting += 2;
        }
        next = (waiting > 0).then(|| inner[waiting - 1]);
        waiting = waiting.saturating_sub(1);
    }
    true
}

/// What becomes of a subtree that fits a block.
#[derive(Clone, Copy)]
struct Merged {
    /// Expected cost of a ray that hits its box, times the box's area.
    cost: f32,
    primitives: u32,
    /// The one type of its primitives, if they are of one type. An instance has none, and is like nothing else.
    kind: Kind,
    /// Whether it is cheapest as one leaf.
    leaf: bool,
}

impl Merged {
    /// Recursion ends within [`BLOCK`] levels: each holds a primitive more.
    fn of(binary: &Bvh2, kinds: &[Kind], subtree: u32) -> Self {
        let node = &binary.nodes[subtree as usize];
        let area = node.aabb().half_area();
        if node.is_leaf() {
            let kind = kinds[node.first_index as usize];
            return Self { cost: area * (LEAF_COST + PRIMITIVE_COST), primitives: 1, kind, leaf: true };
        }
        let [left, right] = [0, 1].map(|side| Self::of(binary, kinds, node.first_index + side));
        let primitives = left.primitives + right.primitives;
        let kind = left.kind.filter(|_| left.kind == right.kind);
        let split = area * NODE_COST + left.cost + right.cost;
        let merged = area * (LEAF_COST + PRIMITIVE_COST * primitives as f32);
        let leaf = kind.is_some() && left.leaf && right.leaf && merged <= split;
        Self { cost: if leaf { merged } else { split }, primitives, kind, leaf }
    }
}

/// What a leaf is made of.
enum Members {
    Primitives(LeafMembers),
    Instance(u32),
}

/// What is below a subtree that becomes a leaf, in ascending order.
fn members(binary: &Bvh2, kinds: &[Kind], subtree: u32) -> Members {
    let (mut found, mut count) = ([0; BLOCK], 0);
    let mut gather = |index| {
        found[count] = index;
        count += 1;
    };
    visit_primitives(binary, subtree, &mut gather);
    found[..count].sort_unstable();
    match kinds[found[0] as usize] {
        Some(kind) => Members::Primitives(LeafMembers::new(kind, &found[..count])),
        None => Members::Instance(found[0]),
    }
}

fn visit_primitives(binary: &Bvh2, subtree: u32, visit: &mut impl FnMut(u32)) {
    let node = &binary.nodes[subtree as usize];
    if node.is_leaf() {
        visit(node.first_index);
    } else {
        visit_primitives(binary, node.first_index, visit);
        visit_primitives(binary, node.first_index + 1, visit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Boxes that tell a builder little or nothing about where to split.
    fn awkward(count: usize) -> [(&'static str, Vec<Aabb>); 5] {
        let cube = |center: Vec3, half: f32| Aabb { min: center - half, max: center + half };
        let boxes = |of: &dyn Fn(f32) -> Aabb| (0..count).map(|i| of(i as f32)).collect();
        [
            ("coincident", boxes(&|_| cube(Vec3::ONE, 1.0))),
            ("concentric", boxes(&|i| cube(Vec3::ZERO, 1.0 + i * 1e-3))),
            ("nested in a corner", boxes(&|i| cube(Vec3::splat(1.0 + i * 1e-3), 1.0 + i * 1e-3))),
            ("points", boxes(&|_| cube(Vec3::ZERO, 0.0))),
            ("larger than numbers", boxes(&|i| cube(Vec3::ZERO, 1e30 + i * 1e26))),
        ]
    }

    /// Every primitive is in one leaf, within all boxes above it; each node and each leaf stands once.
    fn check(bvh: &Bvh, leaves: &[LeafMembers], boxes: &[Aabb], kinds: &[Kind]) {
        let contains = |outer: &Aabb, inner: &Aabb| outer.union(*inner) == *outer;
        let numbered = |leaf: &Leaf| leaves.iter().filter(|l| l.kind == leaf.kind).nth(leaf.block as usize);
        let (mut found, mut nodes) = (vec![0; boxes.len()], 0);
        let mut pending = vec![(0, Aabb::INFINITE)];
        while let Some((number, bounds)) = pending.pop() {
            nodes += 1;
            let node = &bvh.nodes[number as usize];
            for (place, child) in node.children.iter().enumerate() {
                let corner = |corners: &[[f32; WIDTH]; 3]| Vec3::from(corners.map(|axis| axis[place]));
                let own = Aabb { min: corner(&node.min), max: corner(&node.max) };
                match child {
                    Child::None => assert!(own.is_empty()),
                    Child::Node(child) => pending.push((*child, own)),
                    Child::Leaf(leaf) => {
                        for &member in numbered(leaf).expect("its leaf is there").members() {
                            assert!(contains(&own, &boxes[member as usize]));
                            assert_eq!(kinds[member as usize], Some(leaf.kind));
                            found[member as usize] += 1;
                        }
                    }
                    Child::Instance(number) => {
                        assert!(contains(&own, &boxes[*number as usize]));
                        assert_eq!(kinds[*number as usize], None);
                        found[*number as usize] += 1;
                    }
                }
                assert!(matches!(child, Child::None) || contains(&bounds, &own));
            }
        }
        assert!(found.iter().all(|&times| times == 1));
        assert_eq!(nodes, bvh.nodes.len());
        assert_eq!(leaves.len(), bvh.leaves);
    }

    #[test]
    fn every_primitive_is_in_one_leaf_of_its_kind_and_instances_are_alone() {
        for count in [1, 2, 7, 8, 9, 65, 3000] {
            for (_, boxes) in awkward(count) {
                let kind = |i: usize| (i % 5 < 4).then(|| PrimitiveKind::ALL[i % 3 % PrimitiveKind::ALL.len()]);
                let kinds: Vec<_> = (0..count).map(kind).collect();
                let (bvh, leaves) = build(&boxes, &kinds, &|| true).expect("there are boxes");
                check(&bvh, &leaves, &boxes, &kinds);
            }
        }
        assert!(build(&[], &[], &|| true).is_none());
    }

    /// The work of clustering is the boxes times the depth: merging one pair a round makes as many levels as boxes.
    #[test]
    fn awkward_boxes_make_no_deep_tree() {
        for (name, boxes) in awkward(6000) {
            let kinds = vec![Some(PrimitiveKind::Triangle); boxes.len()];
            let clustered = collapse(&cluster(&boxes), &kinds).depth;
            assert!(clustered <= 32, "{name}: {clustered} levels");
            let (bvh, _) = build(&boxes, &kinds, &|| true).expect("there are boxes");
            let built = depth(&bvh);
            assert!(built <= DEEPEST, "{name}: {built} levels");
        }
    }

    fn depth(bvh: &Bvh) -> usize {
        let mut depths = vec![1; bvh.nodes.len()];
        let mut deepest = 0;
        // Parents come before children.
        for (number, node) in bvh.nodes.iter().enumerate() {
            deepest = deepest.max(depths[number]);
            for child in &node.children {
                if let Child::Node(child) = child {
                    depths[*child as usize] = depths[number] + 1;
                }
            }
        }
        deepest
    }

    #[test]
    fn coincident_primitives_fill_their_blocks() {
        let (_, boxes) = &awkward(4096)[0];
        let (bvh, _) =
            build(boxes, &vec![Some(PrimitiveKind::Sphere); boxes.len()], &|| true).expect("there are boxes");
        assert_eq!(bvh.leaves, boxes.len() / BLOCK);
    }
}
