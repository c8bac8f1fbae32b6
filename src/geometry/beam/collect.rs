//! The walk through the tree that lists what a beam can meet.

use super::list::{Candidates, Member};
use super::outline::Outline;
use super::projection::{Beam, Cover};
use crate::geometry::bvh::{Bvh, Child, Leaf, WIDTH};
use crate::geometry::primitive::{Cone, Cutout, Disk, Plane, Sphere, Triangle, for_each_primitive};
use crate::geometry::traverse::{Pending, STACK, Stack};
use crate::geometry::{BLOCK, PrimitiveKind, Search};
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, u32x8};

impl Search<'_> {
    /// Lists everything that a ray of the beam can hit in front of `cover`. False if that is too much to list. Stops at
    /// something that blocks all rays, if the beam asks for that.
    pub fn collect<S: Simd>(
        &self,
        simd: S,
        beam: &Beam<'_>,
        cover: Cover,
        candidates: &mut Candidates,
        stack: &mut Stack,
    ) -> bool {
        candidates.restart(cover);
        // Light is stopped from either side; all other beams are of rays that look for what is seen.
        let beam = &Beam { passes_backs: self.geometry.one_sided && beam.blocking.is_none(), ..*beam };
        match &self.geometry.bvh {
            Some(bvh) if self.use_bvh => {
                self.list_all(simd, &[PrimitiveKind::Plane], beam, candidates)
                    && (candidates.blocked || self.list_tree(simd, bvh, beam, candidates, &mut stack.0))
            }
            _ => self.geometry.instances.is_empty() && self.list_all(simd, PrimitiveKind::ALL, beam, candidates),
        }
    }

    fn list_all<S: Simd>(
        &self,
        simd: S,
        kinds: &[PrimitiveKind],
        beam: &Beam<'_>,
        candidates: &mut Candidates,
    ) -> bool {
        for &kind in kinds {
            for block in 0..self.geometry.blocks_of(kind) as u32 {
                if !candidates.has_room() {
                    return false;
                }
                self.list_block(simd, Leaf { kind, block }, beam, candidates);
                if candidates.blocked {
                    return true;
                }
                if candidates.len() > beam.most {
                    return false;
                }
            }
        }
        true
    }

    fn list_tree<S: Simd>(
        &self,
        simd: S,
        bvh: &Bvh,
        beam: &Beam<'_>,
        candidates: &mut Candidates,
        stack: &mut [Pending; STACK],
    ) -> bool {
        simd.vectorize(
            #[inline(always)]
            || {
                let walls = beam.walls();
                stack[0] = Pending { child: Child::Node(0), near: 0.0 };
                let mut depth = 1;
                while depth > 0 {
                    depth -= 1;
                    let node = match stack[depth].child {
                        Child::None => continue,
                        Child::Leaf(leaf) => {
                            if !candidates.has_room() {
                                return false;
                            }
                            self.list_block(simd, leaf, beam, candidates);
                            if candidates.blocked {
                                return true;
                            }
                            if candidates.len() > beam.most {
                                return false;
                            }
                            continue;
                        }
                        Child::Node(number) => &bvh.nodes[number as usize],
                        // What is in it has no place in a list: its rays are to find their own way.
                        Child::Instance(_) => return false,
                    };
                    let mut outside = candidates.cover.not_behind.excludes(simd, node);
                    for wall in &walls {
                        outside |= wall.excludes(simd, node);
                    }
                    if let Some(front) = &beam.front {
                        outside |= front.excludes(simd, node);
                    }
                    let mut met = !outside & ((1 << WIDTH) - 1);
                    let depths = beam.depths(simd, node);
                    let bottom = depth;
                    if bottom + WIDTH > STACK {
                        return false;
                    }
                    while met != 0 {
                        let place = met.trailing_zeros() as usize;
                        met &= met - 1;
                        let near = depths[place];
                        Pending { child: node.children[place], near }.insert(stack, bottom..depth);
                        depth += 1;
                    }
                }
                true
            },
        )
    }
}

macro_rules! define_list_block {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        impl Search<'_> {
            /// Lists what of a leaf the beam can meet.
            fn list_block<S: Simd>(&self, simd: S, leaf: Leaf, beam: &Beam<'_>, candidates: &mut Candidates) {
                simd.vectorize(
                    #[inline(always)]
                    || match leaf.kind {
                        $(PrimitiveKind::$kernel => {
                            let block = &self.geometry.$blocks[leaf.block as usize];
                            let fields = block.load(simd);
                            let outlines = $kernel::outline(&fields, beam);
                            let mut members = [Member::default(); BLOCK];
                            for (place, (member, &index)) in members.iter_mut().zip(&block.indices).enumerate() {
                                *member = Member { index, block: leaf.block, place: place as u8 };
                            }
                            let ignored = u32x8::from_slice(simd, &block.indices).simd_eq(beam.ignored).to_bitmask();
                            let used = ((1 << block.len) - 1) & !ignored;
                            let Candidates { $blocks, cover, blocked, .. } = candidates;
                            *blocked |= $blocks.sift::<$kernel, S, f32x8<S>, $fields>(
                                &outlines, &members, used, beam, cover,
                            );
                        })+
                    },
                );
            }
        }
    };
}
for_each_primitive!(define_list_block);
