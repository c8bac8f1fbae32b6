//! A binary tree over boxes, from the leaves up: neighbours along a space-filling curve are merged in rounds.
//!
//! D. Meister, J. Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction", 2018. The
//! text is ours rather than `obvhs`'s because of two additions: where all costs are equal, neighbours pair up, and a
//! round that all but stalls is followed by one that pairs everybody. Coincident or nested boxes would otherwise merge
//! one pair a round, which takes n² time.

use crate::geometry::Aabb;
use glam::Vec3;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

/// How far along the curve a box looks for its best partner. 24 is no better, 6 is 3 % worse.
const REACH: usize = 14;
/// In the first rounds, where most boxes are, only the next neighbours are looked at: it costs nothing in quality.
const NEAR_ROUNDS: usize = 3;
/// A round that merges fewer than one in so many boxes has stalled.
const STALLED: usize = 16;
/// Boxes that one task looks at.
const TASK: usize = 4096;

/// A tree with one box a leaf; a leaf's `first_index` is the box's index.
pub fn cluster(boxes: &[Aabb]) -> Bvh2 {
    let mut tree = Bvh2 { nodes: vec![Bvh2Node::default(); 2 * boxes.len() - 1], ..Bvh2::default() };
    let mut clusters = along_curve(boxes);
    let mut next = Vec::with_capacity(clusters.len());
    let mut partners = vec![0_u32; clusters.len()];
    let (mut rounds, mut stalled) = (0, false);
    let mut free = tree.nodes.len();
    while clusters.len() > 1 {
        let partners = &mut partners[..clusters.len()];
        if stalled {
            pair_all(partners);
        } else {
            choose_partners(&clusters, if rounds < NEAR_ROUNDS { 1 } else { REACH }, partners);
        }
        merge(&clusters, partners, &mut next, &mut tree.nodes, &mut free);
        stalled = (clusters.len() - next.len()) * STALLED < clusters.len();
        std::mem::swap(&mut clusters, &mut next);
        next.clear();
        rounds += 1;
    }
    if let Some(root) = clusters.first() {
        tree.nodes[0] = *root;
    }
    tree
}

/// Leaves for all boxes in the order of a Morton curve through their centres. Boxes around one point come by size.
fn along_curve(boxes: &[Aabb]) -> Vec<Bvh2Node> {
    let point = |b: &Aabb| Aabb { min: b.center(), max: b.center() };
    let bounds = boxes.par_iter().with_min_len(TASK).map(point).reduce(|| Aabb::EMPTY, Aabb::union);
    // A flat side has no order, nor has one that is too long for a number.
    let scale = Vec3::select(bounds.size().cmpgt(Vec3::ZERO), CELLS / bounds.size(), Vec3::ZERO);
    let key = |(aabb, index): (&Aabb, u32)| {
        (morton_code((aabb.center() - bounds.min) * scale), half_area(aabb).to_bits(), index)
    };
    let mut keys: Vec<(u64, u32, u32)> =
        boxes.par_iter().with_min_len(TASK).zip(0..boxes.len() as u32).map(key).collect();
    keys.par_sort_unstable();
    let leaf = |&(_, _, index): &(u64, u32, u32)| {
        let Aabb { min, max } = boxes[index as usize];
        Bvh2Node::new(obvhs::aabb::Aabb::new(min.into(), max.into()), 1, index)
    };
    keys.par_iter().with_min_len(TASK).map(leaf).collect()
}

fn half_area(aabb: &Aabb) -> f32 {
    let size = aabb.size();
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// Cells of the curve along each axis.
const CELLS: Vec3 = Vec3::splat((1 << 21) as f32 - 1.0);

/// Interleaves the bits of a cell's three coordinates.
fn morton_code(cell: Vec3) -> u64 {
    let spread = |coordinate: f32| {
        let mut bits = coordinate as u64 & 0x1f_ffff;
        for (shift, mask) in [
            (32, 0x001f_0000_0000_ffff),
            (16, 0x001f_0000_ff00_00ff),
            (8, 0x100f_00f0_0f00_f00f),
            (4, 0x10c3_0c30_c30c_30c3),
            (2, 0x1249_2492_4924_9249),
        ] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}

/// For each cluster the one within `reach` places with which its box grows least. At equal growth it is the one
/// beside it in pairs of two, so that clusters which are all alike agree.
fn choose_partners(clusters: &[Bvh2Node], reach: usize, partners: &mut [u32]) {
    partners.par_chunks_mut(TASK).enumerate().for_each(|(chunk, partners)| {
        for (i, partner) in (chunk * TASK..).zip(partners) {
            let own = clusters[i].aabb();
            let area = |other: usize| own.union(clusters[other].aabb()).half_area();
            let mut best = beside(i, clusters.len());
            let mut least = if best == i { f32::INFINITY } else { area(best) };
            for other in (i.saturating_sub(reach)..i).chain(i + 1..(i + 1 + reach).min(clusters.len())) {
                let area = area(other);
                if area < least {
                    (best, least) = (other, area);
                }
            }
            *partner = best as u32;
        }
    });
}

/// Lets every cluster merge with the one beside it.
fn pair_all(partners: &mut [u32]) {
    let count = partners.len();
    for (i, partner) in partners.iter_mut().enumerate() {
        *partner = beside(i, count) as u32;
    }
}

/// The other one of a pair; the last of an odd number has none but itself.
fn beside(i: usize, count: usize) -> usize {
    if i ^ 1 < count { i ^ 1 } else { i }
}

/// Merges the clusters that chose each other into `next`; their nodes go to the end of what is `free`.
fn merge(clusters: &[Bvh2Node], partners: &[u32], next: &mut Vec<Bvh2Node>, nodes: &mut [Bvh2Node], free: &mut usize) {
    for (i, cluster) in clusters.iter().enumerate() {
        let partner = partners[i] as usize;
        if partners[partner] as usize != i || partner == i {
            next.push(*cluster);
        } else if i < partner {
            *free -= 2;
            nodes[*free] = *cluster;
            nodes[*free + 1] = clusters[partner];
            let bounds = cluster.aabb().union(clusters[partner].aabb());
            next.push(Bvh2Node::new(bounds, 0, *free as u32));
        }
    }
}
