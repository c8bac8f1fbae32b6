//! From hits to lanes: what the surfaces of a packet are made of.

use super::frame::Frame;
use super::gather::Hits;
use super::queue::MOST_LANES;
use super::tables::{FlatMaterial, Row};
use crate::geometry::PrimitiveIndex;
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// What the surfaces that a packet hit are made of.
pub(super) trait Materials<S: Simd> {
    /// Whether the surfaces of the packet may touch others: all packets where any does are taken as mixed.
    const MAY_TOUCH: bool;

    /// Whether any material passes a test.
    fn any(&self, test: impl Fn(&FlatMaterial) -> bool) -> bool;

    /// The lanes whose material passes a test.
    fn lanes(&self, simd: S, test: impl Fn(&FlatMaterial) -> bool) -> Mask<S>;

    /// One number of every lane's material.
    fn row(&self, simd: S, row: usize) -> S::f32s;

    /// Three numbers in a row.
    #[inline(always)]
    fn triple(&self, simd: S, first: Row) -> V3<S::f32s> {
        let row = first as usize;
        V3::new(self.row(simd, row), self.row(simd, row + 1), self.row(simd, row + 2))
    }
}

/// All lanes' surfaces are of one material.
pub(super) struct OneMaterial<'a>(&'a FlatMaterial);

impl<'a> OneMaterial<'a> {
    /// The material of a primitive.
    #[inline(always)]
    pub fn of(frame: &Frame<'a>, primitive: PrimitiveIndex) -> Self {
        Self(&frame.tables.materials[frame.tables.material_of(&frame.scene.geometry, primitive) as usize])
    }
}

impl<S: Simd> Materials<S> for OneMaterial<'_> {
    const MAY_TOUCH: bool = false;

    #[inline(always)]
    fn any(&self, test: impl Fn(&FlatMaterial) -> bool) -> bool {
        test(self.0)
    }

    #[inline(always)]
    fn lanes(&self, simd: S, test: impl Fn(&FlatMaterial) -> bool) -> Mask<S> {
        Mask::<S>::splat(simd, test(self.0))
    }

    #[inline(always)]
    fn row(&self, simd: S, row: usize) -> S::f32s {
        S::f32s::splat(simd, self.0.rows[row])
    }
}

/// Materials of a packet's hits, each once.
pub(super) struct MixedMaterials<'a, S: Simd> {
    /// That of the first hit, and of lanes without a hit.
    first: &'a FlatMaterial,
    /// The others, with the lanes that have them.
    others: [(&'a FlatMaterial, Mask<S>); MOST_LANES],
    /// How many others there are.
    count: usize,
}

impl<'a, S: Simd> MixedMaterials<'a, S> {
    /// The materials of what was hit; something was.
    #[inline(always)]
    pub fn new(simd: S, frame: &Frame<'a>, hits: &Hits<'_>) -> Self {
        let (tables, geometry) = (&frame.tables, &frame.scene.geometry);
        let table = &tables.materials;
        let material = tables.material_of(geometry, hits.primitives[hits.first()]);
        let first = &table[material as usize];
        let mut materials = Self { first, others: [(first, Mask::<S>::splat(simd, false)); MOST_LANES], count: 0 };
        if hits.common.is_none() && table.len() > 1 {
            let mut numbers = [material; MOST_LANES];
            for lane in hits.lanes() {
                numbers[lane] = tables.material_of(geometry, hits.primitives[lane]);
            }
            let lanes = S::u32s::from_slice(simd, &numbers[..S::f32s::LEN]);
            let mut left = hits.active & !lanes.simd_eq(material).to_bitmask();
            while left != 0 {
                let number = numbers[left.trailing_zeros() as usize % MOST_LANES];
                let same = lanes.simd_eq(number);
                left &= !same.to_bitmask();
                materials.others[materials.count] = (&table[number as usize], same);
                materials.count += 1;
            }
        }
        materials
    }
}

impl<S: Simd> Materials<S> for MixedMaterials<'_, S> {
    const MAY_TOUCH: bool = true;

    #[inline(always)]
    fn any(&self, test: impl Fn(&FlatMaterial) -> bool) -> bool {
        let mut passes = test(self.first);
        for (material, _) in &self.others[..self.count] {
            passes |= test(material);
        }
        passes
    }

    #[inline(always)]
    fn lanes(&self, simd: S, test: impl Fn(&FlatMaterial) -> bool) -> Mask<S> {
        let mut lanes = Mask::<S>::splat(simd, test(self.first));
        for (material, mask) in &self.others[..self.count] {
            if test(material) {
                lanes |= *mask;
            } else {
                lanes &= !*mask;
            }
        }
        lanes
    }

    #[inline(always)]
    fn row(&self, simd: S, row: usize) -> S::f32s {
        let mut value = S::f32s::splat(simd, self.first.rows[row]);
        for (material, mask) in &self.others[..self.count] {
            value = mask.select(S::f32s::splat(simd, material.rows[row]), value);
        }
        value
    }
}
