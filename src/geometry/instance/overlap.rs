//! Triangles of an instance whose bounds overlap a box.

use super::{Instances, SLACK};
use crate::geometry::bvh::{Child, Leaf, WIDTH};
use crate::geometry::primitive::{Kernel, Triangle};
use crate::geometry::{Aabb, PrimitiveIndex};
use glam::DVec3;

impl Instances {
    /// Calls `visit` for every triangle of an instance whose bounds overlap `within`.
    pub(in crate::geometry) fn overlapping(&self, number: u32, within: &Aabb, visit: &mut impl FnMut(PrimitiveIndex)) {
        let instance = &self.placed[number as usize];
        if !instance.bounds.overlaps(within) {
            return;
        }
        let shared = &self.meshes[instance.mesh as usize];
        // What of the box is of interest is finite, even if the box is not.
        let min = within.min.max(instance.bounds.min).as_dvec3();
        let max = within.max.min(instance.bounds.max).as_dvec3();
        let middle = instance.to_mesh.transform_point3((min + max) * 0.5);
        let columns = instance.to_mesh.matrix3;
        let half = (max - min) * 0.5;
        let reach = columns.x_axis.abs() * half.x + columns.y_axis.abs() * half.y + columns.z_axis.abs() * half.z;
        let slack =
            (middle.abs().max_element() + shared.reach() + instance.ball.max_element() * instance.reach) * SLACK;
        let (min, max) = (middle - reach - slack, middle + reach + slack);
        let meets = |low: &[[f32; WIDTH]; 3], high: &[[f32; WIDTH]; 3], place: usize| {
            let corner = |side: &[[f32; WIDTH]; 3]| DVec3::from_array([0, 1, 2].map(|axis| side[axis][place].into()));
            corner(low).cmple(max).all() && corner(high).cmpge(min).all()
        };
        let mut waiting = vec![Child::Node(0)];
        while let Some(child) = waiting.pop() {
            match child {
                Child::None | Child::Instance(_) => {}
                Child::Node(node) => {
                    let node = &shared.nodes[node as usize];
                    let children = (0..WIDTH).filter(|&place| meets(&node.min, &node.max, place));
                    waiting.extend(children.map(|place| node.children[place]));
                }
                Child::Leaf(Leaf { block, .. }) => {
                    let triangles = &shared.leaves[block as usize];
                    for place in (0..triangles.len as usize).filter(|&i| meets(&triangles.min, &triangles.max, i)) {
                        let index = instance.first + triangles.numbers[place];
                        let solid = self.fields_of_solid(super::SharedTriangle {
                            instance: number,
                            triangle: triangles.numbers[place],
                        });
                        if solid.is_some_and(|fields| Triangle::bounds(&fields).overlaps(within)) {
                            visit(index);
                        }
                    }
                }
            }
        }
    }
}
