//! What a ray can meet and how to find it. This room knows no colour.
//!
//! [`Geometry`] holds every primitive in [`Block`]s of one type and a tree over them; meshes that are placed often are
//! stored once, as [instances](instance). [`traverse`](Search::traverse) is the one text that finds closest hits and
//! occluders, with what to do about a hit left to a [`Visitor`].

pub mod aabb;
pub mod beam;
pub mod block;
pub mod bvh;
pub mod contact;
pub mod holes;
pub mod instance;
#[cfg(test)]
mod laws;
pub mod mesh;
mod nearest;
pub mod opaque;
mod overlap;
pub mod packet;
pub mod primitive;
pub mod ray;
pub mod shape;
#[cfg(test)]
mod sides;
mod single;
pub mod transform;
pub mod traverse;
pub mod visitor;

pub use aabb::Aabb;
pub use block::{BLOCK, Block, NO_PRIMITIVE, PrimitiveIndex};
pub use contact::{Contacts, Place};
pub use holes::{HoleMap, Holes, Wrap};
pub use instance::{Home, Instance, Instances, SharedMesh};
pub use mesh::Mesh;
pub use opaque::{Opaque, OpaqueList};
pub use packet::Packet;
pub use ray::Rays;
pub use shape::{Part, PrimitiveId, Shape, VertexAttributes, VertexExtras};
pub use transform::Transform;
pub use traverse::{Search, SphereTerms, Stack};
pub use visitor::{AnyHit, ClosestHit, NextCrossing, Visitor};

use bvh::{Bvh, Child, LeafMembers};
use glam::{Vec3, Vec4};
use primitive::{Cone, Cutout, Disk, Kernel, Plane, Sphere, Triangle, for_each_primitive};
use rayon::prelude::*;
use std::ops::Range;

/// Where a primitive lies: its type, its block and its place there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Its type.
    pub kind: PrimitiveKind,
    /// Index among the blocks of its type.
    pub block: u32,
    /// Place within the block.
    pub place: u8,
}

impl Geometry {
    /// What the corners of a triangle multiply its colour and opacity by, where they carry that.
    pub fn corner_colors(&self, primitive: PrimitiveIndex) -> Option<[Vec4; 3]> {
        match self.instances.find(primitive) {
            Home::Own(own) => {
                let place = self.extras.binary_search_by_key(&own, |(place, _)| *place).ok()?;
                Some(self.extras[place].1.colors)
            }
            Home::Shared(triangle) => self.instances.extras(triangle).map(|extras| extras.colors),
        }
    }
}

impl Slot {
    /// Of a triangle that is stored as part of a [`SharedMesh`]: no block has this number.
    const SHARED: Self = Self { kind: PrimitiveKind::Triangle, block: u32::MAX, place: 0 };
}

macro_rules! define_geometry {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        /// The types of primitives.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum PrimitiveKind {
            $(#[doc = concat!("A ", stringify!($kernel), ".")] $kernel,)+
        }

        impl PrimitiveKind {
            /// Every type.
            pub const ALL: &[Self] = &[$(Self::$kernel,)+];
        }

        /// All shapes of a scene, sorted by type, and the tree over them.
        #[derive(Debug, Default)]
        pub struct Geometry {
            $(#[doc = concat!("Blocks of type ", stringify!($kernel), ".")] pub $blocks: Vec<Block<$fields>>,)+
            /// Identity of each primitive that is not part of an instance, ascending.
            ids: Vec<PrimitiveId>,
            /// Where each of those lies.
            slots: Vec<Slot>,
            /// What the corners of triangles carry, in the kernel's order of corners, for those primitives that carry
            /// anything. Sorted by how many primitives with a place of their
            /// own come before.
            pub attributes: Vec<(u32, VertexAttributes)>,
            /// What the corners of few triangles carry besides, in the same order.
            pub extras: Vec<(u32, VertexExtras)>,
            /// Meshes that are placed often, and where.
            pub instances: Instances,
            /// The holes of cut-out triangles, by block and place.
            pub holes: Vec<Holes>,
            /// The maps that holes are found on.
            pub hole_maps: Vec<HoleMap>,
            /// Finite bounds of everything but planes; empty if there is nothing finite.
            pub bounds: Aabb,
            /// The tree, where the scene is worth one.
            pub bvh: Option<Bvh>,
            /// Shapes without extent that were left out.
            pub dropped: usize,
            /// Whether some triangles are seen from one side only.
            pub one_sided: bool,
        }

        impl Geometry {
            /// Bounds of one primitive.
            pub fn bounds_of(&self, primitive: PrimitiveIndex) -> Aabb {
                let slot = self.slot(primitive);
                if slot == Slot::SHARED {
                    return Triangle::bounds(&self.shared_fields(primitive));
                }
                match slot.kind {
                    $(PrimitiveKind::$kernel =>
                        self.$blocks[slot.block as usize].bounds_of::<$kernel>(usize::from(slot.place)),)+
                }
            }

            /// How many primitives of a type there are, those of instances included.
            pub fn count(&self, kind: PrimitiveKind) -> usize {
                let own: usize = match kind {
                    $(PrimitiveKind::$kernel => self.$blocks.iter().map(|b| b.len as usize).sum(),)+
                };
                own + if kind == PrimitiveKind::Triangle { self.instances.triangles() } else { 0 }
            }

            /// How many blocks of a type there are.
            pub fn blocks_of(&self, kind: PrimitiveKind) -> usize {
                match kind {
                    $(PrimitiveKind::$kernel => self.$blocks.len(),)+
                }
            }

            /// Bytes held, by capacity.
            pub fn bytes(&self) -> usize {
                let blocks = 0 $(+ self.$blocks.capacity() * size_of::<Block<$fields>>())+;
                blocks
                    + self.ids.capacity() * size_of::<PrimitiveId>()
                    + self.slots.capacity() * size_of::<Slot>()
                    + self.attributes.capacity() * size_of::<(u32, VertexAttributes)>()
                    + self.extras.capacity() * size_of::<(u32, VertexExtras)>()
                    + self.instances.bytes()
                    + self.holes.capacity() * size_of::<Holes>()
                    + self.bvh.as_ref().map_or(0, Bvh::bytes)
            }

            /// Fills blocks and slots with what the leaves hold. `indices` are those of the primitives, where they are
            /// not just their places.
            fn fill_blocks(&mut self, leaves: &[LeafMembers], packed: &[Packed], indices: &[PrimitiveIndex]) {
                $(
                    let own = leaves.par_iter().filter(|leaf| leaf.kind == PrimitiveKind::$kernel);
                    let own: Vec<&LeafMembers> = own.collect();
                    let fill = |leaf: &&LeafMembers| {
                        let mut block = Block::<$fields>::EMPTY;
                        for &member in leaf.members() {
                            let Packed::$kernel(fields) = &packed[member as usize] else {
                                unreachable!("a leaf holds one type")
                            };
                            block.push(*fields, indices.get(member as usize).copied().unwrap_or(member));
                        }
                        block
                    };
                    self.$blocks = own.par_iter().map(fill).collect();
                    for (leaf, block) in own.iter().zip(0..) {
                        for (&member, place) in leaf.members().iter().zip(0..) {
                            self.slots[member as usize] = Slot { kind: leaf.kind, block, place };
                        }
                    }
                )+
            }
        }

        /// A shape as its kernel's fields.
        #[derive(Clone, Debug)]
        enum Packed {
            $($kernel([f32; $fields]),)+
        }

        impl Packed {
            fn kind(&self) -> PrimitiveKind {
                match self {
                    $(Self::$kernel(_) => PrimitiveKind::$kernel,)+
                }
            }

            fn bounds(&self) -> Aabb {
                match self {
                    $(Self::$kernel(fields) => $kernel::bounds(fields),)+
                }
            }
        }
    };
}
for_each_primitive!(define_geometry);

impl PrimitiveKind {
    /// Whether a primitive of this type lies in a plane.
    #[inline(always)]
    pub fn is_flat(self) -> bool {
        matches!(self, Self::Triangle | Self::Cutout | Self::Plane | Self::Disk)
    }

    /// Whether a primitive of this type has three corners, which may carry something.
    #[inline(always)]
    pub fn is_triangle(self) -> bool {
        matches!(self, Self::Triangle | Self::Cutout)
    }
}

impl Packed {
    /// Packs a shape; `None` where it has no extent.
    fn new(part: &Part) -> Option<Self> {
        Some(match part.shape {
            Shape::Sphere { center, radius } => Self::Sphere(Sphere::fields(center, radius)),
            Shape::Plane { point, normal } => Self::Plane(Plane::fields(point, normal)),
            Shape::Triangle { vertices } if Triangle::is_degenerate(vertices) => return None,
            Shape::Triangle { vertices } if part.holes.is_some() => {
                Self::Cutout(Triangle::fields_of(vertices, part.one_sided))
            }
            Shape::Triangle { vertices } => Self::Triangle(Triangle::fields_of(vertices, part.one_sided)),
            Shape::Disk { center, normal, radius } => Self::Disk(Disk::fields(center, normal, radius)),
            Shape::Cone { base, top, .. } if base == top => return None,
            Shape::Cone { base, top, radius_base, radius_top } => {
                Self::Cone(Cone::fields(base, top, radius_base, radius_top))
            }
        })
    }
}

/// Fewer blocks than this are tested one by one: a tree would not pay.
const MIN_BLOCKS_FOR_TREE: usize = 3;

impl Geometry {
    /// Sorts parts into blocks and builds the tree. Parts come in ascending order of their [`PrimitiveId`];
    /// those without extent are dropped and counted.
    pub fn build(parts: Vec<Part>) -> Self {
        Self::build_with(parts, Instances::default())
    }

    /// [`build`](Self::build) with instances besides. All primitives together must have fewer indices than fit 32 bits.
    pub fn build_with(parts: Vec<Part>, instances: Instances) -> Self {
        Self::build_while(parts, instances, &|| true).unwrap_or_default()
    }

    /// As [`build_with`](Self::build_with), but gives up soon after `wanted` says no.
    pub fn build_while(parts: Vec<Part>, mut instances: Instances, wanted: &dyn Fn() -> bool) -> Option<Self> {
        let mut geometry = Self::default();
        let (packed, holes) = geometry.pack(parts);
        geometry.one_sided |= instances.one_sided() > 0;
        let indices = instances.number(&geometry.ids);
        let unplaced = Slot { kind: PrimitiveKind::Plane, block: u32::MAX, place: 0 };
        geometry.slots = vec![unplaced; packed.len()];

        let (planes, finite): (Vec<u32>, Vec<u32>) =
            (0..packed.len() as u32).partition(|&i| packed[i as usize].kind() == PrimitiveKind::Plane);
        let mut boxes: Vec<Aabb> = finite.par_iter().map(|&i| packed[i as usize].bounds()).collect();
        let mut kinds: Vec<_> = finite.par_iter().map(|&i| Some(packed[i as usize].kind())).collect();
        boxes.extend(instances.placed.iter().map(|instance| instance.bounds));
        kinds.resize(boxes.len(), None);
        geometry.bounds = boxes.iter().fold(Aabb::EMPTY, |a, &b| a.union(b));
        let (mut bvh, mut leaves) = bvh::build(&boxes, &kinds, wanted).unzip();
        if !wanted() {
            return None;
        }
        let leaves = leaves.get_or_insert_default();
        for leaf in &mut *leaves {
            leaf.rename(&finite);
        }
        leaves.extend(planes.chunks(BLOCK).map(|members| LeafMembers::new(PrimitiveKind::Plane, members)));
        geometry.fill_blocks(leaves, &packed, &indices);
        geometry.holes = vec![Holes::default(); geometry.cutouts.len() * BLOCK];
        for (primitive, holes) in holes {
            let slot = geometry.slots[primitive as usize];
            geometry.holes[slot.block as usize * BLOCK + usize::from(slot.place)] = holes;
        }
        for child in bvh.iter_mut().flat_map(|bvh| &mut bvh.nodes).flat_map(|node| &mut node.children) {
            if let Child::Instance(number) = child {
                *number -= finite.len() as u32;
            }
        }
        geometry.bvh = bvh.filter(|bvh| bvh.leaves >= MIN_BLOCKS_FOR_TREE || !instances.is_empty());
        geometry.instances = instances;
        Some(geometry)
    }

    /// Packs parts and keeps what else is to be known of them. The holes wait for their places.
    fn pack(&mut self, parts: Vec<Part>) -> (Vec<Packed>, Vec<(PrimitiveIndex, Holes)>) {
        let packed: Vec<Option<Packed>> = parts.par_iter().map(Packed::new).collect();
        let mut holes = Vec::new();
        let kept = packed.iter().flatten().count();
        self.dropped = parts.len() - kept;
        self.ids.reserve_exact(kept);
        for (part, _) in parts.into_iter().zip(&packed).filter(|(_, packed)| packed.is_some()) {
            if let Shape::Triangle { vertices } = part.shape {
                let (index, order) = (self.ids.len() as u32, Triangle::stored_order(vertices));
                self.attributes.extend(part.attributes.map(|attributes| (index, attributes.reordered(order))));
                self.extras.extend(part.extras.map(|extras| (index, extras.reordered(order))));
                self.one_sided |= part.one_sided;
                holes.extend(part.holes.map(|holes| (index, holes.reordered(order))));
            }
            self.ids.push(part.id);
        }
        self.attributes.shrink_to_fit();
        self.extras.shrink_to_fit();
        (packed.into_iter().flatten().collect(), holes)
    }

    /// How many triangles are seen from one side only.
    pub fn count_one_sided(&self) -> usize {
        if !self.one_sided {
            return 0;
        }
        let blocks = self.triangles.iter().chain(&self.cutouts);
        let own = blocks.flat_map(|block| &block.fields[9][..block.len as usize]);
        own.filter(|&&winding| Triangle::has_one_side(winding)).count() + self.instances.one_sided()
    }

    /// How many primitives there are.
    pub fn len(&self) -> usize {
        self.ids.len() + self.instances.triangles()
    }

    /// Whether there is nothing to hit.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty() && self.instances.is_empty()
    }

    /// How many indices primitives take.
    pub fn indices(&self) -> usize {
        self.ids.len() + self.instances.indices()
    }

    /// The identity of a primitive; `None` for [`NO_PRIMITIVE`].
    #[inline(always)]
    pub fn id(&self, primitive: PrimitiveIndex) -> Option<PrimitiveId> {
        match self.instances.find(primitive) {
            Home::Own(own) => self.ids.get(own as usize).copied(),
            Home::Shared(triangle) => Some(self.instances.id(triangle)),
        }
    }

    /// The object that a primitive belongs to.
    #[inline(always)]
    pub fn object_of(&self, primitive: PrimitiveIndex) -> u32 {
        match self.instances.find(primitive) {
            Home::Own(own) => self.ids[own as usize].object,
            Home::Shared(triangle) => self.instances.id(triangle).object,
        }
    }

    /// Where a primitive lies; those of shared meshes lie in no block.
    #[inline(always)]
    pub fn slot(&self, primitive: PrimitiveIndex) -> Slot {
        match self.instances.find(primitive) {
            Home::Own(own) => self.slots[own as usize],
            Home::Shared(_) => Slot::SHARED,
        }
    }

    /// Whether a primitive lies in a plane; false for [`NO_PRIMITIVE`].
    pub fn is_flat(&self, primitive: PrimitiveIndex) -> bool {
        match self.instances.find(primitive) {
            Home::Own(own) => self.slots.get(own as usize).is_some_and(|slot| slot.kind.is_flat()),
            Home::Shared(_) => true,
        }
    }

    /// What has a place of its own, so everything but instances: where it lies and what it is, in ascending order.
    pub fn own(&self) -> impl ExactSizeIterator<Item = (Slot, PrimitiveId)> {
        self.slots.iter().copied().zip(self.ids.iter().copied())
    }

    /// How many primitives of an object can be hit.
    pub fn count_of(&self, object: u32) -> usize {
        self.instances.solids_of(object).unwrap_or_else(|| self.indices_of(object).len())
    }

    /// The indices of an object's primitives.
    pub fn indices_of(&self, object: u32) -> Range<PrimitiveIndex> {
        self.instances.indices_of(object).unwrap_or_else(|| {
            let first = self.ids.partition_point(|id| id.object < object);
            let count = self.ids[first..].partition_point(|id| id.object == object);
            let shared = self.instances.indices_before(object);
            first as u32 + shared..(first + count) as u32 + shared
        })
    }

    /// The kernel's fields of a triangle that lies in a shared mesh; 0 for others. Not inlined: few scenes have any.
    #[cold]
    #[inline(never)]
    pub fn shared_fields(&self, primitive: PrimitiveIndex) -> [f32; 10] {
        match self.instances.find(primitive) {
            Home::Own(_) => [0.0; 10],
            Home::Shared(triangle) => self.instances.fields(triangle),
        }
    }

    /// The kernel's fields of a triangle, wherever it lies; `None` for other shapes.
    #[inline]
    pub fn triangle(&self, primitive: PrimitiveIndex) -> Option<[f32; 10]> {
        let slot = self.slot(primitive);
        slot.kind.is_triangle().then(|| match self.triangles_of(slot.kind).get(slot.block as usize) {
            Some(block) => block.get(slot.place.into()),
            None => self.shared_fields(primitive),
        })
    }

    /// Unit normal and a point of the plane that a primitive lies in; `None` if it is not flat, or too small or too large
    /// for its normal to be computed so.
    pub fn plane_of(&self, primitive: PrimitiveIndex) -> Option<(Vec3, Vec3)> {
        let slot = self.slot(primitive);
        let (block, place) = (slot.block as usize, usize::from(slot.place));
        match slot.kind {
            PrimitiveKind::Triangle | PrimitiveKind::Cutout => {
                let [ax, ay, az, bx, by, bz, cx, cy, cz, _] = self.triangle(primitive)?;
                let [a, b, c] = [Vec3::new(ax, ay, az), Vec3::new(bx, by, bz), Vec3::new(cx, cy, cz)];
                let normal = (b - a).cross(c - a);
                let usable = f32::MIN_POSITIVE..f32::MAX;
                usable.contains(&normal.length_squared()).then(|| (normal.normalize(), a))
            }
            PrimitiveKind::Disk => {
                let [x, y, z, nx, ny, nz, _] = self.disks[block].get(place);
                Some((Vec3::new(nx, ny, nz), Vec3::new(x, y, z)))
            }
            PrimitiveKind::Plane => {
                let [x, y, z, distance] = self.planes[block].get(place);
                let normal = Vec3::new(x, y, z);
                Some((normal, normal * distance))
            }
            PrimitiveKind::Sphere | PrimitiveKind::Cone => None,
        }
    }

    /// Unit geometric normal of a primitive at `point`, which lies on it: outward for round shapes, as
    /// [`plane_of`](Self::plane_of) has it for flat ones. `None` where it cannot be computed, as at the tip of a cone.
    pub fn normal_at(&self, primitive: PrimitiveIndex, point: Vec3) -> Option<Vec3> {
        let slot = self.slot(primitive);
        let (block, place) = (slot.block as usize, usize::from(slot.place));
        match slot.kind {
            PrimitiveKind::Sphere => {
                let [x, y, z, _] = self.spheres[block].get(place);
                (point - Vec3::new(x, y, z)).try_normalize()
            }
            PrimitiveKind::Cone => {
                let [x, y, z, ax, ay, az, _, _, slope] = self.cones[block].get(place);
                let (from_middle, axis) = (point - Vec3::new(x, y, z), Vec3::new(ax, ay, az));
                let outward = (from_middle - axis * from_middle.dot(axis)).try_normalize()?;
                (outward - axis * slope).try_normalize()
            }
            _ => self.plane_of(primitive).map(|(normal, _)| normal),
        }
    }

    /// The corners of a triangle, in the kernel's order; 0 for other shapes.
    #[inline]
    pub fn corners_of(&self, primitive: PrimitiveIndex) -> [f32; 9] {
        let mut corners = [0.0; 9];
        if let Some(fields) = self.triangle(primitive) {
            corners.copy_from_slice(&fields[..9]);
        }
        corners
    }

    /// Blocks of a type of triangles.
    #[inline(always)]
    pub fn triangles_of(&self, kind: PrimitiveKind) -> &[Block<10>] {
        if kind == PrimitiveKind::Cutout { &self.cutouts } else { &self.triangles }
    }

    /// Largest magnitude of any coordinate of anything finite.
    pub fn reach(&self) -> f32 {
        if self.bounds.is_empty() { 0.0 } else { self.bounds.min.abs().max(self.bounds.max.abs()).max_element() }
    }

    /// What the corners of a triangle carry; `None` for most primitives. Found by halving: for a few look-ups.
    pub fn attributes_of(&self, primitive: PrimitiveIndex) -> Option<VertexAttributes> {
        match self.instances.find(primitive) {
            Home::Own(own) => {
                let found = self.attributes.binary_search_by_key(&own, |(index, _)| *index).ok()?;
                Some(self.attributes[found].1)
            }
            Home::Shared(triangle) => self.instances.attributes(triangle),
        }
    }
}
