//! The primitives that a beam can meet.

use super::outline::{Outline, is_behind};
use super::projection::{Beam, Cover};
use crate::geometry::primitive::{Cone, Disk, Plane, Sphere, Triangle, for_each_primitive};
use crate::geometry::{BLOCK, Block, Geometry};
use crate::math::Lanes;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Most candidates of one type: with more, smaller beams are cheaper.
pub(super) const MOST: usize = 240;

/// Room beyond, for whole vectors to be stored at the end.
const ROOM: usize = MOST + 32;

/// Primitives of one type: their outlines, number by number, and where they lie.
#[derive(Clone, Debug)]
pub struct List<const M: usize> {
    outlines: Box<[[f32; ROOM]; M]>,
    places: Box<[u32; ROOM]>,
    len: usize,
}

impl<const M: usize> Default for List<M> {
    fn default() -> Self {
        Self { outlines: Box::new([[0.0; ROOM]; M]), places: Box::new([0; ROOM]), len: 0 }
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

    /// Where they lie.
    fn places(&self) -> &[u32] {
        &self.places[..self.len]
    }

    /// Empties the list.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Whether a block's worth more fits.
    fn has_room(&self) -> bool {
        self.len + BLOCK <= MOST
    }

    /// Appends the masked lanes; `place_of` tells where the primitive of each lane lies.
    #[inline(always)]
    fn append<S: Simd, F: Lanes<S>>(&mut self, mask: F::Mask, outlines: &[F; M], places: &[u32]) {
        let at = self.len;
        for (column, values) in self.outlines.iter_mut().zip(outlines) {
            values.compress(mask).store_slice(&mut column[at..at + F::LEN]);
        }
        let mut lanes = mask.to_bitmask();
        while lanes != 0 {
            self.places[self.len] = places[lanes.trailing_zeros() as usize];
            self.len += 1;
            lanes &= lanes - 1;
        }
    }

    /// Appends where those candidates lie that the beam can meet, moving the cover up as it goes.
    #[inline(always)]
    fn select<K: Outline<N, M>, S: Simd, const N: usize>(
        &self,
        simd: S,
        beam: &Beam<'_>,
        cover: &mut Cover,
        places: &mut Vec<u32>,
    ) {
        for at in (0..self.len).step_by(S::f32s::LEN) {
            let outlines: [S::f32s; M] = self.load(simd, at);
            let missed = K::misses(&outlines, beam) | is_behind(K::nearest(&outlines), beam, cover);
            let present = (1 << (self.len - at).min(S::f32s::LEN)) - 1;
            let kept = !missed.to_bitmask() & present;
            let mut covering = K::covers(&outlines, beam).to_bitmask() & kept;
            while covering != 0 {
                let (nearest, farthest) =
                    bounds_of::<K, S, S::f32s, N, M>(&outlines, covering.trailing_zeros() as usize, beam);
                cover.move_up(nearest, farthest, beam);
                covering &= covering - 1;
            }
            let mut lanes = kept;
            while lanes != 0 {
                places.push(self.places[at + lanes.trailing_zeros() as usize]);
                lanes &= lanes - 1;
            }
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
        places: &[u32],
        used: u64,
        blocks: &[Block<N>],
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
            } else {
                let (block, place) = place_of(places[lane]);
                if beam.is_blocked_by(blocks[block].indices[place], nearest, farthest) {
                    return true;
                }
            }
        }
        let simd = outlines[0].token();
        self.append::<S, F>(F::Mask::from_bitmask(simd, kept), outlines, places);
        false
    }

    /// Replaces the list by what of `larger` the beam can meet.
    #[inline(always)]
    fn refill<K: Outline<N, M>, S: Simd, const N: usize>(
        &mut self,
        simd: S,
        larger: &Self,
        blocks: &[Block<N>],
        beam: &Beam<'_>,
        cover: &mut Cover,
    ) -> bool {
        self.len = 0;
        for at in (0..larger.len).step_by(S::f32s::LEN) {
            let outlines: [S::f32s; M] = larger.load(simd, at);
            let count = (larger.len - at).min(S::f32s::LEN);
            let places = &larger.places[at..at + count];
            if self.sift::<K, S, S::f32s, N>(&outlines, places, (1 << count) - 1, blocks, beam, cover) {
                return true;
            }
        }
        false
    }
}

/// Block and place within it.
#[inline(always)]
fn place_of(place: u32) -> (usize, usize) {
    (place as usize / BLOCK, place as usize % BLOCK)
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
            pub fn filter<S: Simd>(&mut self, simd: S, geometry: &Geometry, larger: &Self, beam: &Beam<'_>) {
                self.cover = larger.cover;
                self.blocked = false;
                simd.vectorize(
                    #[inline(always)]
                    || {
                        $(if larger.$blocks.is_empty() {
                            self.$blocks.clear();
                        } else {
                            let blocks = &geometry.$blocks;
                            self.blocked |= self.$blocks.refill::<$kernel, S, $fields>(
                                simd, &larger.$blocks, blocks, beam, &mut self.cover,
                            );
                        })+
                    },
                );
            }
        }

        /// Where candidates lie: block and place within it, type by type.
        #[derive(Clone, Debug, Default)]
        pub struct Places {
            $($blocks: Vec<u32>,)+
        }

        impl Places {
            $(
                #[doc = concat!("Places of type ", stringify!($kernel), ".")]
                #[inline(always)]
                pub fn $blocks(&self) -> impl Iterator<Item = (usize, usize)> {
                    self.$blocks.iter().map(#[inline(always)] |&place| place_of(place))
                }
            )+

            /// Replaces the places by those of all candidates.
            pub fn take_all(&mut self, candidates: &Candidates) {
                $(
                    self.$blocks.clear();
                    self.$blocks.extend_from_slice(candidates.$blocks.places());
                )+
            }

            /// Replaces the places by those of the candidates that a beam within theirs can meet.
            #[inline(always)]
            pub fn select<S: Simd>(&mut self, simd: S, candidates: &Candidates, beam: &Beam<'_>) {
                let mut cover = candidates.cover;
                $(
                    self.$blocks.clear();
                    candidates.$blocks.select::<$kernel, S, $fields>(simd, beam, &mut cover, &mut self.$blocks);
                )+
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
