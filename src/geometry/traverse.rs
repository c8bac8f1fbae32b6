//! The one traversal: closest hits, occluders and transparent crossings all go through it.

use super::bvh::{Bvh, Child, Leaf, WIDTH};
use super::primitive::{Cone, Cutout, Disk, Kernel, Plane, Sphere, Triangle, for_each_primitive};
use super::visitor::Mask;
use super::{Block, Geometry, Packet, PrimitiveIndex, PrimitiveKind, Rays, Slot, Visitor};
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::ops::Range;

/// Sphere terms of one common origin, block by block, where the packets of a search share it.
#[derive(Clone, Copy, Debug)]
pub enum SphereTerms<'a> {
    /// None: each ray computes its own.
    None,
    /// Centre minus origin, and r².
    Exact(&'a [Block<4>]),
    /// Centre minus origin, and |C-O|² - r².
    Difference(&'a [Block<4>]),
}

/// How a search goes about: the same hits whatever is chosen (but for [`SphereTerms::Difference`]).
#[derive(Clone, Copy, Debug)]
pub struct Search<'a> {
    /// What is searched.
    pub geometry: &'a Geometry,
    /// Whether to use the tree.
    pub use_bvh: bool,
    /// Sphere terms at hand.
    pub sphere_terms: SphereTerms<'a>,
}

/// A subtree still to be visited.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pending {
    pub child: Child,
    /// No ray of the packet enters its box before this.
    pub near: f32,
}

impl Pending {
    /// Puts the subtree among those that its node has left waiting, at the places `siblings`, one more afterwards:
    /// sorted so that the nearest is on top.
    #[inline(always)]
    pub fn insert(self, stack: &mut [Self; STACK], siblings: Range<usize>) {
        let mut at = siblings.end;
        while at > siblings.start && stack[at - 1].near < self.near {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = self;
    }
}

/// Subtrees that can wait at once: seven a level of an eight-wide tree, and trees are far less deep than this.
pub(super) const STACK: usize = 512;

/// Room for the subtrees that wait during a traversal. Kept between packets: clearing it would cost more than most
/// traversals do.
#[derive(Debug)]
pub struct Stack(pub(super) [Pending; STACK]);

impl Default for Stack {
    fn default() -> Self {
        Self([Pending { child: Child::None, near: 0.0 }; STACK])
    }
}

impl<'a> Search<'a> {
    /// A search of all of `geometry`.
    pub fn new(geometry: &'a Geometry, use_bvh: bool) -> Self {
        Self { geometry, use_bvh, sphere_terms: SphereTerms::None }
    }

    /// Shows `visitor` every hit that can matter to it.
    #[inline(always)]
    pub fn traverse<S: Simd, V: Visitor<S>>(&self, simd: S, packet: &Packet<S>, stack: &mut Stack, visitor: &mut V) {
        match &self.geometry.bvh {
            Some(bvh) if self.use_bvh => {
                self.visit_all(simd, &[PrimitiveKind::Plane], packet, visitor);
                if packet.is_coherent() {
                    self.visit_tree(simd, bvh, packet, &mut stack.0, visitor);
                } else {
                    self.visit_tree_by_rays(simd, bvh, packet, &mut stack.0, visitor);
                }
            }
            _ => self.visit_everything(simd, packet, visitor),
        }
    }

    /// As [`traverse`](Self::traverse), but every ray finds its way alone: what is looked at does not depend on how many
    /// there are in a packet. Lanes with a limit below 0 are left alone.
    #[inline(always)]
    pub fn traverse_alone<S: Simd, V: Visitor<S>>(
        &self,
        simd: S,
        packet: &Packet<S>,
        stack: &mut Stack,
        visitor: &mut V,
    ) {
        match &self.geometry.bvh {
            Some(bvh) if self.use_bvh => {
                self.visit_all(simd, &[PrimitiveKind::Plane], packet, visitor);
                self.visit_tree_by_rays(simd, bvh, packet, &mut stack.0, visitor);
            }
            _ => self.visit_everything(simd, packet, visitor),
        }
    }

    /// How many primitives are tested for every ray, wherever it flies.
    pub fn always_tested(&self) -> usize {
        match &self.geometry.bvh {
            Some(_) if self.use_bvh => self.geometry.count(PrimitiveKind::Plane),
            _ => self.geometry.len(),
        }
    }

    /// Tests every primitive, those of instances included.
    #[inline(always)]
    fn visit_everything<S: Simd, V: Visitor<S>>(&self, simd: S, packet: &Packet<S>, visitor: &mut V) {
        self.visit_all(simd, PrimitiveKind::ALL, packet, visitor);
        for number in 0..self.geometry.instances.placed.len() as u32 {
            self.visit_instance(simd, number, packet, &mut [], visitor);
        }
    }

    /// Tests every primitive of the given types.
    #[inline(always)]
    fn visit_all<S: Simd, V: Visitor<S>>(&self, simd: S, kinds: &[PrimitiveKind], packet: &Packet<S>, visitor: &mut V) {
        for &kind in kinds {
            for block in 0..self.geometry.blocks_of(kind) as u32 {
                self.visit_leaf(simd, Leaf { kind, block }, packet, visitor);
            }
        }
    }

    #[inline(always)]
    fn visit_tree<S: Simd, V: Visitor<S>>(
        &self,
        simd: S,
        bvh: &Bvh,
        packet: &Packet<S>,
        stack: &mut [Pending; STACK],
        visitor: &mut V,
    ) {
        stack[0] = Pending { child: Child::Node(0), near: 0.0 };
        let mut depth = 1;
        while depth > 0 {
            if visitor.is_finished() {
                return;
            }
            depth -= 1;
            let Pending { child, near } = stack[depth];
            let limit = visitor.limit().reduce_max();
            if near > limit {
                continue;
            }
            let node = match child {
                Child::None => continue,
                Child::Leaf(leaf) => {
                    self.visit_leaf(simd, leaf, packet, visitor);
                    continue;
                }
                Child::Node(number) => &bvh.nodes[number as usize],
                Child::Instance(number) => {
                    self.visit_instance(simd, number, packet, &mut stack[depth..], visitor);
                    continue;
                }
            };
            let mut candidates = packet.may_enter(simd, node, limit);
            let bottom = depth;
            while candidates != 0 {
                let place = candidates.trailing_zeros() as usize;
                candidates &= candidates - 1;
                let (enters, distance) = packet.enter_box(node, place, visitor.limit());
                if !enters.any_true() {
                    continue;
                }
                let outside = S::f32s::splat(simd, f32::MAX);
                let near = enters.select(distance, outside).reduce_min();
                Pending { child: node.children[place], near }.insert(stack, bottom..depth);
                depth += 1;
            }
            if depth + WIDTH > STACK {
                // Deeper than any tree of ours: give up the order, never a hit.
                return self.visit_everything(simd, packet, visitor);
            }
        }
    }

    /// Whether hits depend on the side that `visitor` sees. Asked once a block, so that other scenes do not pay for it.
    #[inline(always)]
    pub(super) fn passes_backs<S: Simd, V: Visitor<S>>(&self, visitor: &V) -> bool {
        visitor.passes_backs() && self.geometry.one_sided
    }

    /// Sphere blocks as this search tests them.
    #[inline(always)]
    pub(super) fn test_sphere<S: Simd>(
        &self,
        simd: S,
        block: usize,
        place: usize,
        rays: &Rays<S::f32s>,
        t_min: S::f32s,
    ) -> (Mask<S>, S::f32s) {
        match self.sphere_terms {
            SphereTerms::None => {
                let fields = self.geometry.spheres[block].splat(simd, place);
                Sphere::intersect(&fields, rays, t_min)
            }
            SphereTerms::Exact(terms) => {
                Sphere::intersect_terms(&terms[block].splat(simd, place), rays.direction, t_min)
            }
            SphereTerms::Difference(terms) => {
                Sphere::intersect_difference(&terms[block].splat(simd, place), rays.direction, t_min)
            }
        }
    }
}

/// Tests one primitive: spheres by the terms at hand, all others by the method `$intersect` of their kernel.
macro_rules! test_place {
    (
        Sphere, $intersect:ident, $blocks:ident, $search:ident, $simd:ident, $block:expr, $place:ident, $rays:expr,
        $t_min:ident
    ) => {
        $search.test_sphere($simd, $block, $place, $rays, $t_min)
    };
    (
        $kernel:ident, $intersect:ident, $blocks:ident, $search:ident, $simd:ident, $block:expr, $place:ident,
        $rays:expr, $t_min:ident
    ) => {{
        let fields = $search.geometry.$blocks[$block].splat($simd, $place);
        let (mut mask, t) = $kernel::$intersect(&fields, $rays, $t_min);
        if $kernel::HAS_HOLES {
            let places = crate::geometry::holes::Places::Same($place);
            mask = $search.geometry.meets_no_hole($simd, &fields, $rays, mask, $block as u32, places);
        }
        (mask, t)
    }};
}
pub(super) use test_place;

/// Tests the primitives at some places of a block.
macro_rules! test_places {
    (
        $kernel:ident, $intersect:ident, $blocks:ident, $search:ident, $simd:ident, $block:ident, $places:ident,
        $rays:ident, $visitor:ident
    ) => {{
        let indices = &$search.geometry.$blocks[$block].indices;
        for place in $places {
            let index = indices[place];
            if $visitor.accepts(index) {
                let t_min = $visitor.t_min(index);
                let (mask, t) = test_place!($kernel, $intersect, $blocks, $search, $simd, $block, place, $rays, t_min);
                $visitor.hit(mask & t.simd_le($visitor.limit()), t, index);
            }
        }
    }};
}

macro_rules! define_leaf_tests {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        impl Search<'_> {
            /// Tests the primitives of a leaf that lie at the given places. Not inlined: the traversals around it are
            /// compiled for every level and visitor, and each would hold every kernel.
            fn visit_places<S: Simd, V: Visitor<S>>(
                &self, simd: S, leaf: Leaf, places: Range<usize>, rays: &Rays<S::f32s>, visitor: &mut V,
            ) {
                simd.vectorize(
                    #[inline(always)]
                    || match leaf.kind {
                        $(PrimitiveKind::$kernel => {
                            let block = leaf.block as usize;
                            if $kernel::HAS_SIDES && self.passes_backs(visitor) {
                                test_places!($kernel, intersect_front, $blocks, self, simd, block, places, rays, visitor);
                            } else {
                                test_places!($kernel, intersect, $blocks, self, simd, block, places, rays, visitor);
                            }
                        })+
                    },
                );
            }

            /// Tests every primitive of a leaf.
            #[inline(always)]
            fn visit_leaf<S: Simd, V: Visitor<S>>(
                &self, simd: S, leaf: Leaf, packet: &Packet<S>, visitor: &mut V,
            ) {
                let len = match leaf.kind {
                    $(PrimitiveKind::$kernel => self.geometry.$blocks[leaf.block as usize].len,)+
                };
                self.visit_places(simd, leaf, 0..len as usize, &packet.rays, visitor);
            }
        }
    };
}
for_each_primitive!(define_leaf_tests);

impl Search<'_> {
    /// Tests one known primitive.
    #[inline(always)]
    pub fn test_one<S: Simd, V: Visitor<S>>(
        &self,
        simd: S,
        primitive: PrimitiveIndex,
        rays: &Rays<S::f32s>,
        visitor: &mut V,
    ) {
        let slot = self.geometry.slot(primitive);
        if slot == Slot::SHARED {
            return self.test_shared(simd, primitive, rays, visitor);
        }
        let place = usize::from(slot.place);
        self.visit_places(simd, Leaf { kind: slot.kind, block: slot.block }, place..place + 1, rays, visitor);
    }
}

impl Geometry {
    /// The sphere terms of one origin, exact or as a difference, written over `terms`.
    pub fn fill_sphere_terms<S: Simd>(&self, simd: S, origin: glam::Vec3, difference: bool, terms: &mut Vec<Block<4>>) {
        terms.clear();
        terms.extend_from_slice(&self.spheres);
        let origin = V3::splat(simd, origin);
        for (block, spheres) in terms.iter_mut().zip(&self.spheres) {
            let fields = spheres.fields.each_ref().map(|f| fearless_simd::f32x8::from_slice(simd, f));
            let cached = if difference {
                Sphere::difference_terms(&fields, origin)
            } else {
                Sphere::origin_terms(&fields, origin)
            };
            for (field, value) in block.fields.iter_mut().zip(cached) {
                value.store_slice(field);
            }
        }
    }
}
