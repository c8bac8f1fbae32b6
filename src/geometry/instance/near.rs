//! The nearest point of an instance.

use super::{Instance, Instances, SLACK, SharedMesh, SharedTriangle};
use crate::geometry::bvh::{Child, Leaf, WIDTH};
use crate::geometry::nearest::Nearest;
use crate::geometry::primitive::{Kernel, Triangle};
use glam::DVec3;

impl Instances {
    /// Offers the nearest points of an instance's triangles, those too far away left out.
    pub(in crate::geometry) fn offer_nearest(&self, number: u32, nearest: &mut Nearest) {
        let instance = &self.placed[number as usize];
        let shared = &self.meshes[instance.mesh as usize];
        let mut waiting = vec![Child::Node(0)];
        while let Some(child) = waiting.pop() {
            let near = Near::new(instance, shared, nearest);
            match child {
                Child::None | Child::Instance(_) => {}
                Child::Node(node) => {
                    let node = &shared.nodes[node as usize];
                    let children = (0..WIDTH).filter(|&place| near.meets(&node.min, &node.max, place));
                    waiting.extend(children.map(|place| node.children[place]));
                }
                Child::Leaf(Leaf { block, .. }) => {
                    let triangles = &shared.leaves[block as usize];
                    for place in 0..triangles.len as usize {
                        let triangle = SharedTriangle { instance: number, triangle: triangles.numbers[place] };
                        if near.meets(&triangles.min, &triangles.max, place)
                            && let Some(fields) = self.fields_of_solid(triangle)
                        {
                            nearest.offer(Triangle::nearest_to(&fields, nearest.point));
                        }
                    }
                }
            }
        }
    }
}

/// A box in the mesh's space around the ball within which surfaces are of interest.
struct Near {
    min: DVec3,
    max: DVec3,
}

impl Near {
    fn new(instance: &Instance, shared: &SharedMesh, nearest: &Nearest) -> Self {
        let middle = instance.to_mesh.transform_point3(nearest.point);
        let slack =
            (middle.abs().max_element() + shared.reach() + instance.ball.max_element() * instance.reach) * SLACK;
        let reach = instance.ball * (nearest.within.sqrt() * (1.0 + SLACK)) + slack;
        Self { min: middle - reach, max: middle + reach }
    }

    fn meets(&self, min: &[[f32; WIDTH]; 3], max: &[[f32; WIDTH]; 3], place: usize) -> bool {
        (0..3)
            .all(|axis| f64::from(min[axis][place]) <= self.max[axis] && f64::from(max[axis][place]) >= self.min[axis])
    }
}
