//! The primitives that a beam can meet.

use super::outline::{Outline, is_behind};
use super::projection::{Beam, Cover};
use crate::geometry::primitive::{Cone, Cutout, Disk, Plane, Sphere, Triangle, for_each_primitive};
use crate::geometry::{BLOCK, PrimitiveIndex};
use crate::math::Lanes;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Most candidates of one type: with more, smaller beams are cheaper.
pub(super) const MOST: usize = 240;

/// Room beyond, for whole vectors to be stored at the end.
const ROOM: usize = MOST + 32;

/// A candidate: which primitive it is, and where it lies.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Member {
    pub index: PrimitiveIndex,
    pub block: u32,
    pub place: u8,
}

/// Primitives of one type: their outlines, number by number, and where they lie.
#[derive(Clone, Debug)]
pub struct List<const M: usize> {
    outlines: Box<[[f32; ROOM]; M]>,
    members: Box<[Member; ROOM]>,
    len: usize,
}

impl<const M: usize> Default for List<M> {
    fn default() -> Self {
        Self { outlines: Box::new([[0.0; ROOM]; M]), members: Box::new([Member::default(); ROOM]), len: 0 }
    }
}

impl<const M: usize> List<M> {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// One of them.
    #[inline(always)]
    pub(super) fn member(&self, at: usize) -> Member {
        self.members[at]
    }

    /// The outline of one, in every lane.
    #[inline(always)]
    pub(super) fn outline<S: Simd, F: Lanes<S>>(&self, simd: S, at: usize) -> [F; M] {
        let mut outline = [F::splat(simd, 0.0); M];
        for (lanes, column) in outline.iter_mut().zip(self.outlines.iter()) {
            *lanes = F::splat(simd, column[at]);
        }
        outline
    }

    /// Empties the list.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Whether a block's worth more fits.
    fn has_room(&self) -> bool {
        self.len + BLOCK <= MOST
    }

    /// Appends the masked lanes.
    #[inline(always)]
    fn append<S: Simd, F: Lanes<S>>(&mut self, mask: F::Mask, outlines: &[F; M], members: &[Member]) {
        let at = self.len;
        for (column, values) in self.outlines.iter_mut().zip(outlines) {
            values.compress(mask).store_slice(&mut column[at..at + F::LEN]);
        }
        let mut lanes = mask.to_bitmask();
        while lanes != 0 {
            self.members[self.len] = members[lanes.trailing_zeros() as usize];
            self.len += 1;
            lanes &= lanes - 1;
        }
    }

    #[inline(always)]
    fn load<S: Simd, F: Lanes<S>>(&self, simd: S, at: usize) -> [F; M] {
        let mut outlines = [F::splat(simd, 0.0); M];
        for (lanes, column) in outlines.iter_mut().zip(self.outlines.iter()) {
            *lanes = F::from_slice(simd, &column[at..at + F::LEN]);
        }
        outlines
    }

    /// Appends what of the lanes in the bit set `used` the beam can meet in front of the cover, and moves the cover up to
    /// the nearest primitive that covers the beam. If the beam asks what blocks all of its rays, covers are asked that
    /// instead, and the answer is returned.
    #[inline(always)]
    pub(super) fn sift<K: Outline<N, M>, S: Simd, F: Lanes<S>, const N: usize>(
        &mut self,
        outlines: &[F; M],
        members: &[Member],
        used: u64,
        beam: &Beam<'_>,
        cover: &mut Cover,
    ) -> bool {
        let missed = K::misses(outlines, beam) | is_behind(K::nearest(outlines), beam, cover);
        let kept = !missed.to_bitmask() & used;
        if kept == 0 {
            return false;
        }
        let mut covering = K::covers(outlines, beam).to_bitmask() & kept;
        while covering != 0 {
            let lane = covering.trailing_zeros() as usize;
            covering &= covering - 1;
            let (nearest, farthest) = bounds_of::<K, S, F, N, M>(outlines, lane, beam);
            if beam.blocking.is_none() {
                cover.move_up(nearest, farthest, beam);
            } else if beam.is_blocked_by(members[lane].index, nearest, farthest) {
                return true;
            }
        }
        let simd = outlines[0].token();
        self.append::<S, F>(F::Mask::from_bitmask(simd, kept), outlines, members);
        false
    }

    /// Replaces the list by what of `larger` the beam can meet.
    #[inline(always)]
    fn refill<K: Outline<N, M>, S: Simd, const N: usize>(
        &mut self,
        simd: S,
        larger: &Self,
        beam: &Beam<'_>,
        cover: &mut Cover,
    ) -> bool {
        self.len = 0;
        for at in (0..larger.len).step_by(S::f32s::LEN) {
            let outlines: [S::f32s; M] = larger.load(simd, at);
            let count = (larger.len - at).min(S::f32s::LEN);
            let members = &larger.members[at..at + count];
            if self.sift::<K, S, S::f32s, N>(&outlines, members, (1 << count) - 1, beam, cover) {
                return true;
            }
        }
        false
    }
}

/// Upper and lower bound of the nearness of one lane's primitive.
#[inline(always)]
fn bounds_of<K: Outline<N, M>, S: Simd, F: Lanes<S>, const N: usize, const M: usize>(
    outlines: &[F; M],
    lane: usize,
    beam: &Beam<'_>,
) -> ([f32; 3], [f32; 3]) {
    let mut outline = [0.0; M];
    for (number, lanes) in outline.iter_mut().zip(outlines) {
        *number = lanes[lane];
    }
    let [x, y, z] = K::nearest(outlines);
    ([x[lane], y[lane], z[lane]], K::farthest(&outline, beam))
}

macro_rules! define_candidates {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        /// What a beam can meet, type by type, and what covers it.
        #[derive(Clone, Debug, Default)]
        pub struct Candidates {
            $(#[doc = concat!("Candidates of type ", stringify!($kernel), ".")] pub $blocks: List<$outline>,)+
            /// The nearest cover found.
            pub cover: Cover,
            /// Whether something blocks all rays, if the beam asks for that.
            pub blocked: bool,
        }

        impl Candidates {
            /// How many there are.
            pub fn len(&self) -> usize {
                0 $(+ self.$blocks.len())+
            }

            /// Starts over, behind `cover`.
            pub fn restart(&mut self, cover: Cover) {
                $(self.$blocks.clear();)+
                self.cover = cover;
                self.blocked = false;
            }

            /// Whether a block of any type still fits.
            #[inline(always)]
            pub(super) fn has_room(&self) -> bool {
                true $(&& self.$blocks.has_room())+
            }

            /// Replaces the candidates by those of `larger` that a beam within that one's can meet.
            pub fn filter<S: Simd>(&mut self, simd: S, larger: &Self, beam: &Beam<'_>) {
                self.cover = larger.cover;
                self.blocked = false;
                simd.vectorize(
                    #[inline(always)]
                    || {
                        $(if larger.$blocks.is_empty() {
                            self.$blocks.clear();
                        } else {
                            self.blocked |= self.$blocks.refill::<$kernel, S, $fields>(
                                simd, &larger.$blocks, beam, &mut self.cover,
                            );
                        })+
                    },
                );
            }
        }
    };
}
for_each_primitive!(define_candidates);

impl Candidates {
    /// Whether there are none: every ray of the beam misses everything.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether all rays of the beam are known to see one thing, or nothing.
    pub fn is_certain(&self) -> bool {
        self.is_empty() || (self.len() == 1 && self.cover.hides)
    }
}
