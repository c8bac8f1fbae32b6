//! Meshes that are placed often: stored once, in their own space, with a tree of their own.
//!
//! A ray that comes to an [`Instance`] walks the [`SharedMesh`]'s tree ([`walk`]), moved into its space for that alone.
//! What it may meet there is moved to the world, by the very arithmetic that would have stored it there, and the same
//! kernel runs: hits, and all that follows from them, have the bits of a scene without instances.
//!
//! Their triangles have indices like all others, in the order of their [`PrimitiveId`], but nothing is stored by them:
//! [`Instances::find`] tells what an index means.

mod near;
mod search;
mod shared;
mod walk;

pub use shared::SharedMesh;

use super::primitive::Triangle;
use super::{Aabb, PrimitiveId, PrimitiveIndex, Transform, VertexAttributes, VertexExtras};
use glam::{DAffine3, DVec3, Vec3};
use std::ops::Range;

/// A mesh somewhere in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index of the shared mesh.
    pub mesh: u32,
    /// The leaf object that it is.
    pub object: u32,
    /// Bounds of its triangles in the world.
    pub bounds: Aabb,
    /// How many of its triangles have area in the world; the others cannot be hit.
    pub with_area: u32,
    /// Whether its triangles are seen from one side only.
    pub one_sided: bool,
    to_world: Transform,
    to_mesh: DAffine3,
    /// How far a ball of radius 1 in the world reaches along the axes of the mesh's space.
    ball: DVec3,
    /// Largest coordinate that the way to the world goes through.
    reach: f64,
    /// Index of its first triangle, and one beyond its last.
    first: PrimitiveIndex,
    end: PrimitiveIndex,
    /// Triangles of all instances up to and with this one.
    shared_before_end: u32,
}

/// What a triangle takes, about, that is stored in the world: with its share of the tree, and its names.
const BARE_BYTES: usize = 130;
/// If its corners carry normals or texture coordinates.
const CARRYING_BYTES: usize = 210;

/// Transforms that stretch or shrink more than this are left to be flattened: single precision could not follow.
const MOST_SCALE: f64 = 1e9;
/// Coordinates beyond are left to be flattened, too.
const MOST_REACH: f64 = 1e30;

impl Instance {
    /// Mesh number `mesh` as `object`; `None` if the transform is too odd for rays to be taken into its space.
    pub fn new(
        (mesh, shared): (u32, &SharedMesh),
        object: u32,
        to_world: Transform,
        bounds: Aabb,
        with_area: u32,
    ) -> Option<Self> {
        let to_mesh = to_world.matrix().inverse();
        let rows = to_mesh.matrix3.transpose();
        let ball = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
        let columns = to_world.matrix().matrix3;
        let scale = columns.x_axis.abs() + columns.y_axis.abs() + columns.z_axis.abs();
        let usable = to_mesh.is_finite()
            && ball.cmplt(DVec3::splat(MOST_SCALE)).all()
            && scale.cmplt(DVec3::splat(MOST_SCALE)).all()
            && bounds.is_finite();
        let own = scale.max_element() * shared.reach() + to_world.matrix().translation.abs().max_element();
        let reach = own + f64::from(bounds.min.abs().max(bounds.max.abs()).max_element());
        (usable && reach < MOST_REACH).then_some(Self {
            mesh,
            object,
            bounds,
            with_area,
            one_sided: false,
            to_world,
            to_mesh,
            ball,
            reach,
            first: 0,
            end: 0,
            shared_before_end: 0,
        })
    }
}

impl Instance {
    /// The indices of its triangles.
    pub fn indices(&self) -> Range<PrimitiveIndex> {
        self.first..self.end
    }
}

/// What an index of a primitive means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Home {
    /// A primitive with a place of its own: how many such come before it.
    Own(u32),
    /// A triangle of an instance.
    Shared(SharedTriangle),
}

/// A triangle of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SharedTriangle {
    /// Index of the instance.
    pub instance: u32,
    /// Index of the triangle in its mesh.
    pub triangle: u32,
}

/// All instances of a scene, in ascending order of their objects, and what they are instances of.
#[derive(Debug, Default)]
pub struct Instances {
    /// The meshes.
    pub meshes: Vec<SharedMesh>,
    /// The instances.
    pub placed: Vec<Instance>,
}

impl Instances {
    /// Whether there are none.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.placed.is_empty()
    }

    /// Gives all triangles their indices. Returns those of the other primitives, whose identities are given.
    pub(super) fn number(&mut self, own: &[PrimitiveId]) -> Vec<PrimitiveIndex> {
        if self.is_empty() {
            return Vec::new();
        }
        let mut indices = Vec::with_capacity(own.len());
        let mut shared = 0;
        for instance in &mut self.placed {
            while own.get(indices.len()).is_some_and(|id| id.object < instance.object) {
                indices.push(indices.len() as u32 + shared);
            }
            instance.first = indices.len() as u32 + shared;
            shared += self.meshes[instance.mesh as usize].mesh.triangles.len() as u32;
            instance.end = indices.len() as u32 + shared;
            instance.shared_before_end = shared;
        }
        indices.extend((indices.len()..own.len()).map(|i| i as u32 + shared));
        indices
    }

    /// What an index means.
    #[inline(always)]
    pub fn find(&self, primitive: PrimitiveIndex) -> Home {
        if self.is_empty() { Home::Own(primitive) } else { self.find_among(primitive) }
    }

    #[cold]
    #[inline(never)]
    fn find_among(&self, primitive: PrimitiveIndex) -> Home {
        let next = self.placed.partition_point(|instance| instance.first <= primitive);
        let Some(number) = next.checked_sub(1) else { return Home::Own(primitive) };
        let instance = &self.placed[number];
        if primitive < instance.end {
            Home::Shared(SharedTriangle { instance: number as u32, triangle: primitive - instance.first })
        } else {
            Home::Own(primitive - instance.shared_before_end)
        }
    }

    /// The indices of the triangles of an object that is an instance.
    pub fn indices_of(&self, object: u32) -> Option<Range<PrimitiveIndex>> {
        self.of(object).map(Instance::indices)
    }

    /// How many triangles of an object that is an instance can be hit.
    pub(super) fn solids_of(&self, object: u32) -> Option<usize> {
        self.of(object).map(|instance| instance.with_area as usize)
    }

    fn of(&self, object: u32) -> Option<&Instance> {
        let number = self.placed.binary_search_by_key(&object, |instance| instance.object).ok()?;
        Some(&self.placed[number])
    }

    /// How many indices instances take that come before an object.
    pub(super) fn indices_before(&self, object: u32) -> u32 {
        let next = self.placed.partition_point(|instance| instance.object < object);
        next.checked_sub(1).map_or(0, |last| self.placed[last].shared_before_end)
    }

    /// Triangles that can be hit and are seen from one side only.
    pub fn one_sided(&self) -> usize {
        self.placed.iter().filter(|instance| instance.one_sided).map(|instance| instance.with_area as usize).sum()
    }

    /// Triangles that can be hit.
    pub fn triangles(&self) -> usize {
        self.placed.iter().map(|instance| instance.with_area as usize).sum()
    }

    /// Indices that are taken by instances; a few belong to triangles without area.
    pub fn indices(&self) -> usize {
        self.placed.last().map_or(0, |last| last.shared_before_end as usize)
    }

    /// Whether the corners of any triangle carry anything.
    pub fn have_corner_data(&self) -> bool {
        self.meshes.iter().any(|shared| shared.mesh.has_corner_data())
    }

    /// About how many bytes they would take if each were stored where it is placed.
    pub fn flattened_bytes(&self) -> usize {
        let bytes = |instance: &Instance| {
            let shared = &self.meshes[instance.mesh as usize];
            instance.with_area as usize * if shared.mesh.has_corner_data() { CARRYING_BYTES } else { BARE_BYTES }
        };
        self.placed.iter().map(bytes).sum()
    }

    /// Bytes held, by capacity.
    pub fn bytes(&self) -> usize {
        self.meshes.iter().map(SharedMesh::bytes).sum::<usize>() + self.placed.capacity() * size_of::<Instance>()
    }

    /// The identity of a triangle.
    pub fn id(&self, of: SharedTriangle) -> PrimitiveId {
        PrimitiveId { object: self.placed[of.instance as usize].object, primitive: of.triangle }
    }

    /// The kernel's fields of a triangle that can be hit.
    #[inline]
    fn fields_of_solid(&self, of: SharedTriangle) -> Option<[f32; 10]> {
        let vertices = self.vertices(of);
        let one_sided = self.placed[of.instance as usize].one_sided;
        (!Triangle::is_degenerate(vertices)).then(|| Triangle::fields_of(vertices, one_sided))
    }

    /// The kernel's fields of a triangle.
    #[inline(never)]
    pub fn fields(&self, of: SharedTriangle) -> [f32; 10] {
        Triangle::fields_of(self.vertices(of), self.placed[of.instance as usize].one_sided)
    }

    /// What its corners carry, in the kernel's order.
    #[cold]
    #[inline(never)]
    pub fn attributes(&self, of: SharedTriangle) -> Option<VertexAttributes> {
        let (instance, mesh) = self.parts(of);
        let normal = |corner: usize| instance.to_world.normal(mesh.mesh.normals[corner]).as_vec3();
        let attributes = mesh.mesh.attributes(mesh.mesh.corners(of.triangle), normal)?;
        let attributes = if instance.to_world.is_mirrored() { attributes.reordered([0, 2, 1]) } else { attributes };
        Some(attributes.reordered(Triangle::stored_order(self.vertices(of))))
    }

    /// What they carry besides, in the same order.
    #[cold]
    #[inline(never)]
    pub fn extras(&self, of: SharedTriangle) -> Option<VertexExtras> {
        let (instance, mesh) = self.parts(of);
        let tangent = |corner: usize| instance.to_world.tangent(mesh.mesh.tangents[corner]);
        let extras = mesh.mesh.extras(mesh.mesh.corners(of.triangle), tangent)?;
        let extras = if instance.to_world.is_mirrored() { extras.reordered([0, 2, 1]) } else { extras };
        Some(extras.reordered(Triangle::stored_order(self.vertices(of))))
    }

    /// Its corners in the world, counter-clockwise seen from outside.
    #[inline]
    fn vertices(&self, of: SharedTriangle) -> [Vec3; 3] {
        let (instance, mesh) = self.parts(of);
        let corners = mesh.mesh.corners(of.triangle);
        let [a, b, c] = corners.map(|i| instance.to_world.point(mesh.mesh.vertices[i]).as_vec3());
        if instance.to_world.is_mirrored() { [a, c, b] } else { [a, b, c] }
    }

    fn parts(&self, of: SharedTriangle) -> (&Instance, &SharedMesh) {
        let instance = &self.placed[of.instance as usize];
        (instance, &self.meshes[instance.mesh as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, Mesh, Part, Shape};
    use std::sync::Arc;

    fn corners(at: f64) -> [DVec3; 3] {
        [DVec3::new(at, 0.0, 0.0), DVec3::new(at + 1.0, 0.0, 0.0), DVec3::new(at, 1.0, 0.0)]
    }

    /// Spheres as objects 0, 2 and 5, meshes of two triangles as objects 1, 3 and 4.
    fn geometry() -> Geometry {
        let vertices = [corners(0.0), corners(3.0)].concat();
        let mesh = Mesh { vertices, triangles: vec![[0, 1, 2], [3, 4, 5]], ..Mesh::default() };
        let shared = SharedMesh::new(Arc::new(mesh), &|| true).expect("there are triangles");
        let place = |object: u32| {
            let away = Transform::new(DAffine3::from_translation(DVec3::Z * f64::from(object))).expect("it is usable");
            let bounds = Aabb { min: Vec3::new(0.0, 0.0, object as f32), max: Vec3::new(4.0, 1.0, object as f32) };
            Instance::new((0, &shared), object, away, bounds, 2).expect("it is usable")
        };
        let placed = [1, 3, 4].map(place).to_vec();
        let sphere = |object: u32| {
            let center = Vec3::Y * 10.0 * object as f32;
            Part::new(Shape::Sphere { center, radius: 1.0 }, PrimitiveId { object, primitive: 0 })
        };
        Geometry::build_with([0, 2, 5].map(sphere).to_vec(), Instances { meshes: vec![shared], placed })
    }

    #[test]
    fn indices_ascend_with_identities() {
        let geometry = geometry();
        let ids: Vec<_> =
            (0..geometry.indices() as u32).map(|index| geometry.id(index).expect("it is there")).collect();
        let expected = [(0, 0), (1, 0), (1, 1), (2, 0), (3, 0), (3, 1), (4, 0), (4, 1), (5, 0)];
        assert_eq!(ids, expected.map(|(object, primitive)| PrimitiveId { object, primitive }));
        assert!(geometry.id(geometry.indices() as u32).is_none() && geometry.id(u32::MAX).is_none());
        let ranges: Vec<_> = (0..7).map(|object| geometry.indices_of(object)).collect();
        assert_eq!(ranges, [0..1, 1..3, 3..4, 4..6, 6..8, 8..9, 9..9]);
        let mut spheres: Vec<u32> =
            geometry.spheres.iter().flat_map(|block| &block.indices[..block.len as usize]).copied().collect();
        spheres.sort_unstable();
        assert_eq!(spheres, [0, 3, 8]);
    }

    #[test]
    fn the_nearest_point_is_where_it_is_placed() {
        let geometry = geometry();
        for (point, within, found) in [
            (DVec3::new(0.2, 0.2, 1.3), f64::INFINITY, Some(DVec3::new(0.2, 0.2, 1.0))),
            (DVec3::new(3.2, 0.2, 3.8), 0.25, Some(DVec3::new(3.2, 0.2, 4.0))),
            (DVec3::new(0.2, 0.2, 1.3), 0.25, None),
        ] {
            let nearest = geometry.nearest(point, within);
            assert_eq!(nearest.is_some(), found.is_some(), "{point}: {nearest:?}");
            assert!(nearest.is_none_or(|nearest| nearest.distance(found.unwrap_or(nearest)) < 1e-6), "{nearest:?}");
        }
    }

    #[test]
    fn triangles_are_found_where_they_are_placed() {
        let geometry = geometry();
        assert_eq!(geometry.triangle(0), None);
        for (index, at, object) in [(1, 0.0, 1.0), (2, 3.0, 1.0), (7, 3.0, 4.0)] {
            let moved = corners(at).map(|corner| corner.as_vec3() + Vec3::Z * object);
            assert_eq!(geometry.triangle(index), Some(Triangle::fields(moved)));
            assert_eq!(geometry.plane_of(index).map(|(normal, _)| normal.abs()), Some(Vec3::Z));
        }
    }
}
