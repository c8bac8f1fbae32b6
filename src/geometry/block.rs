//! Eight primitives of one type, field by field: what a leaf of the tree holds.

use super::Aabb;
use super::primitive::Kernel;
use crate::math::Lanes;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

/// Primitives in a block.
pub const BLOCK: usize = 8;

/// Index of a primitive in ascending order of its [`PrimitiveId`](super::PrimitiveId): what ties are broken by.
pub type PrimitiveIndex = u32;

/// No primitive: larger than any index, so that it loses every tie.
pub const NO_PRIMITIVE: PrimitiveIndex = u32::MAX;

/// Up to eight primitives of one type with `N` fields each.
#[derive(Clone, Debug)]
pub struct Block<const N: usize> {
    /// `fields[f][i]` is field f of primitive i. Unused places are 0.
    pub fields: [[f32; BLOCK]; N],
    /// Which primitives these are.
    pub indices: [PrimitiveIndex; BLOCK],
    /// How many places are used.
    pub len: u32,
}

impl<const N: usize> Block<N> {
    /// A block with nothing in it.
    pub const EMPTY: Self = Self { fields: [[0.0; BLOCK]; N], indices: [NO_PRIMITIVE; BLOCK], len: 0 };

    /// Appends a primitive; the block must have room.
    pub fn push(&mut self, fields: [f32; N], index: PrimitiveIndex) {
        let place = self.len as usize;
        for (column, value) in self.fields.iter_mut().zip(fields) {
            column[place] = value;
        }
        self.indices[place] = index;
        self.len += 1;
    }

    /// The fields of one primitive.
    #[inline(always)]
    pub fn get(&self, place: usize) -> [f32; N] {
        std::array::from_fn(|f| self.fields[f][place])
    }

    /// The fields of one primitive in every lane.
    #[inline(always)]
    pub fn splat<S: Simd, F: Lanes<S>>(&self, simd: S, place: usize) -> [F; N] {
        // A loop, not `from_fn`: its closure would not be inlined into the code of the SIMD level.
        let mut lanes = [F::splat(simd, 0.0); N];
        for (lane, field) in lanes.iter_mut().zip(&self.fields) {
            *lane = F::splat(simd, field[place]);
        }
        lanes
    }

    /// Each field of all primitives.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S) -> [f32x8<S>; N] {
        let mut lanes = [f32x8::splat(simd, 0.0); N];
        for (lane, field) in lanes.iter_mut().zip(&self.fields) {
            *lane = f32x8::from_slice(simd, field);
        }
        lanes
    }

    /// Bounds of all primitives in it.
    pub fn bounds<K: Kernel<N>>(&self) -> Aabb {
        (0..self.len as usize).fold(Aabb::EMPTY, |b, i| b.union(K::bounds(&self.get(i))))
    }

    /// Bounds of one primitive.
    pub fn bounds_of<K: Kernel<N>>(&self, place: usize) -> Aabb {
        K::bounds(&self.get(place))
    }
}
