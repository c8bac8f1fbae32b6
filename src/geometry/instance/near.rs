//! Triangles of an instance that lie in or near a part of the world: walks of its tree that follow no ray.

use super::{Instance, Instances, SharedMesh, SharedTriangle};
use crate::geometry::bvh::{Child, Leaf, WIDTH};
use crate::geometry::nearest::Nearest;
use crate::geometry::primitive::{Kernel, Triangle};
use crate::geometry::{Aabb, PrimitiveIndex};
use glam::DVec3;

/// Share of all lengths that rounding may take, on the way to the mesh's space and in its boxes; generously.
const SLACK: f64 = 1e-5;

impl Instances {
    /// Offers the nearest points of an instance's triangles, those too far away left out.
    pub(in crate::geometry) fn offer_nearest(&self, number: u32, nearest: &mut Nearest) {
        let (instance, shared) = self.placed_mesh(number);
        let region = |nearest: &Nearest| Region::around(instance, shared, nearest);
        self.visit_triangles(number, nearest, region, |nearest, _, fields| {
            nearest.offer(Triangle::nearest_to(fields, nearest.point));
        });
    }

    /// Calls `visit` for every triangle of an instance whose bounds overlap `within`.
    pub(in crate::geometry) fn overlapping(&self, number: u32, within: &Aabb, visit: &mut impl FnMut(PrimitiveIndex)) {
        let (instance, shared) = self.placed_mesh(number);
        if !instance.bounds.overlaps(within) {
            return;
        }
        let region = Region::of(instance, shared, within);
        self.visit_triangles(
            number,
            visit,
            |_| region,
            |visit, index, fields| {
                if Triangle::bounds(fields).overlaps(within) {
                    visit(index);
                }
            },
        );
    }

    fn placed_mesh(&self, number: u32) -> (&Instance, &SharedMesh) {
        let instance = &self.placed[number as usize];
        (instance, &self.meshes[instance.mesh as usize])
    }

    /// Calls `visit` with the index and the kernel's fields of every triangle of an instance that may lie in a region, which
    /// may shrink with what `state` tells after each visit.
    fn visit_triangles<T: ?Sized>(
        &self,
        number: u32,
        state: &mut T,
        region: impl Fn(&T) -> Region,
        mut visit: impl FnMut(&mut T, PrimitiveIndex, &[f32; 10]),
    ) {
        let (instance, shared) = self.placed_mesh(number);
        let mut waiting = vec![Child::Node(0)];
        while let Some(child) = waiting.pop() {
            let region = region(state);
            match child {
                Child::None | Child::Instance(_) => {}
                Child::Node(node) => {
                    let node = &shared.nodes[node as usize];
                    let children = (0..WIDTH).filter(|&place| region.meets(&node.min, &node.max, place));
                    waiting.extend(children.map(|place| node.children[place]));
                }
                Child::Leaf(Leaf { block, .. }) => {
                    let triangles = &shared.leaves[block as usize];
                    for place in 0..triangles.len as usize {
                        let triangle = SharedTriangle { instance: number, triangle: triangles.numbers[place] };
                        if region.meets(&triangles.min, &triangles.max, place)
                            && let Some(fields) = self.fields_of_solid(triangle)
                        {
                            visit(state, instance.first + triangle.triangle, &fields);
                        }
                    }
                }
            }
        }
    }
}

/// A box in the mesh's space around what is of interest in the world.
#[derive(Clone, Copy)]
struct Region {
    min: DVec3,
    max: DVec3,
}

impl Region {
    /// Around the ball within which surfaces are of interest.
    fn around(instance: &Instance, shared: &SharedMesh, nearest: &Nearest) -> Self {
        Self::new(instance, shared, nearest.point, instance.ball * (nearest.within.sqrt() * (1.0 + SLACK)))
    }

    /// Around what of a box in the world the instance may lie in.
    fn of(instance: &Instance, shared: &SharedMesh, within: &Aabb) -> Self {
        // That is finite, even if the box is not.
        let min = within.min.max(instance.bounds.min).as_dvec3();
        let max = within.max.min(instance.bounds.max).as_dvec3();
        let (columns, half) = (instance.to_mesh.matrix3, (max - min) * 0.5);
        let reach = columns.x_axis.abs() * half.x + columns.y_axis.abs() * half.y + columns.z_axis.abs() * half.z;
        Self::new(instance, shared, (min + max) * 0.5, reach)
    }

    /// Around a point of the world, as far as `reach` along the axes of the mesh's space.
    fn new(instance: &Instance, shared: &SharedMesh, point: DVec3, reach: DVec3) -> Self {
        let middle = instance.to_mesh.transform_point3(point);
        let slack =
            (middle.abs().max_element() + shared.reach() + instance.ball.max_element() * instance.reach) * SLACK;
        Self { min: middle - (reach + slack), max: middle + (reach + slack) }
    }

    fn meets(&self, min: &[[f32; WIDTH]; 3], max: &[[f32; WIDTH]; 3], place: usize) -> bool {
        (0..3)
            .all(|axis| f64::from(min[axis][place]) <= self.max[axis] && f64::from(max[axis][place]) >= self.min[axis])
    }
}
