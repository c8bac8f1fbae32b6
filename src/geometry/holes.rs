//! Holes in triangles: leaves and fences that a map of opacities cuts out.
//!
//! A hole is a matter of geometry: what a ray meets behind it is its hit. The map is asked in full size, at the very
//! point of the hit, so that the answer depends on nothing but the ray.

use super::primitive::Triangle;
use super::{BLOCK, Geometry, Rays};
use crate::math::Lanes;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec2;
use std::sync::Arc;

/// What lies beyond the edges of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// The picture mirrored, and again.
    Mirror,
    /// The outermost texels.
    Clamp,
}

/// Where a surface is whole.
#[derive(Clone, Debug, PartialEq)]
pub struct HoleMap {
    /// Opacities, row by row from the top; they are shared by maps that differ in the rest.
    pub opacities: Arc<[u8]>,
    /// Texels in a row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// What lies beyond the edges.
    pub wrap: [Wrap; 2],
    /// Whether opacities are blended between texels.
    pub blended: bool,
    /// Opacity, from 0 to 1, below which there is a hole.
    pub cutoff: f32,
}

/// The holes of one triangle: where it lies on a map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Holes {
    /// Index of the map.
    pub map: u32,
    /// Coordinates of the corners on the map, which is 1 wide and 1 high; v = 0 is its bottom.
    pub uvs: [Vec2; 3],
    /// Opacities of the corners, which multiply the map's.
    pub opacities: [f32; 3],
}

impl Holes {
    /// With the corners taken in another order.
    pub fn reordered(self, order: [usize; 3]) -> Self {
        Self { map: self.map, uvs: order.map(|i| self.uvs[i]), opacities: order.map(|i| self.opacities[i]) }
    }

    /// Whether the surface is whole where the corners have these weights.
    fn is_whole(&self, map: &HoleMap, weights: [f32; 3]) -> bool {
        let blend = |values: [f32; 3]| values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2];
        let (u, v) = (blend(self.uvs.map(|uv| uv.x)), blend(self.uvs.map(|uv| uv.y)));
        map.opacity(u, v) * blend(self.opacities) >= map.cutoff
    }
}

impl HoleMap {
    /// The opacity at a point, from 0 to 1.
    fn opacity(&self, u: f32, v: f32) -> f32 {
        let (left, right, across) = neighbours(u, self.width, self.wrap[0], self.blended);
        let (upper, lower, down) = neighbours(1.0 - v, self.height, self.wrap[1], self.blended);
        let texel = |x: u32, y: u32| f32::from(self.opacities[y as usize * self.width as usize + x as usize]);
        let row = |y: u32| texel(left, y) * (1.0 - across) + texel(right, y) * across;
        (row(upper) * (1.0 - down) + row(lower) * down) * (1.0 / 255.0)
    }
}

/// The two texels around coordinate `t` of a row of `size` texels, and the share of the second.
fn neighbours(t: f32, size: u32, wrap: Wrap, blended: bool) -> (u32, u32, f32) {
    let t = if t.is_finite() { t } else { 0.0 };
    let last = size - 1;
    let t = match wrap {
        Wrap::Repeat => t - t.floor(),
        Wrap::Clamp => t.clamp(0.0, 1.0),
        Wrap::Mirror => {
            let pair = t - (t * 0.5).floor() * 2.0;
            if pair > 1.0 { 2.0 - pair } else { pair }
        }
    };
    let position = t * size as f32 - 0.5;
    let before = position.floor();
    let share = position - before;
    let share = if blended { share } else { f32::from(u8::from(share >= 0.5)) };
    // Below the first texel only by half a texel at most.
    let (first, second) = match wrap {
        _ if before >= 0.0 => (before as u32, before as u32 + 1),
        Wrap::Repeat => (last, 0),
        Wrap::Clamp | Wrap::Mirror => (0, 0),
    };
    let beyond = if wrap == Wrap::Repeat { 0 } else { last };
    (first.min(last), if second > last { beyond } else { second }, share)
}

impl Geometry {
    /// Of the lanes in `hit`, those that meet the surface of cut-out triangles and no hole. Lane i is a ray's hit on the
    /// primitive at `places[i]` of block `block`, whose fields are given. Not inlined: there are few holes, and the
    /// searches around it would hold it again and again.
    pub(super) fn meets_no_hole<S: Simd, F: Lanes<S>>(
        &self,
        simd: S,
        fields: &[F],
        rays: &Rays<F>,
        hit: F::Mask,
        block: u32,
        places: Places,
    ) -> F::Mask {
        let Some(fields) = fields.first_chunk::<10>() else { return hit };
        simd.vectorize(
            #[inline(always)]
            || {
                let mut left = hit.to_bitmask();
                if left == 0 {
                    return hit;
                }
                let weights = Triangle::barycentric(fields, rays);
                let mut whole = left;
                while left != 0 {
                    let lane = left.trailing_zeros() as usize;
                    left &= left - 1;
                    let place = match places {
                        Places::Same(place) => place,
                        Places::OwnLane => lane,
                    };
                    let holes = &self.holes[block as usize * BLOCK + place];
                    let weights = [weights[0][lane], weights[1][lane], weights[2][lane]];
                    if !holes.is_whole(&self.hole_maps[holes.map as usize], weights) {
                        whole &= !(1 << lane);
                    }
                }
                F::Mask::from_bitmask(simd, whole)
            },
        )
    }
}

/// Where in its block the primitive of each lane lies.
#[derive(Clone, Copy, Debug)]
pub(super) enum Places {
    /// All lanes are rays towards one.
    Same(usize),
    /// The lanes are one ray towards all of them.
    OwnLane,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(wrap: Wrap, blended: bool) -> HoleMap {
        HoleMap { opacities: [0, 255, 255, 0, 0, 0].into(), width: 3, height: 2, wrap: [wrap; 2], blended, cutoff: 0.5 }
    }

    #[test]
    fn opacities_are_found_at_and_between_texels() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for blended in [false, true] {
                let map = map(wrap, blended);
                // The centre of each texel of the upper row, and of one of the lower.
                assert_eq!([0.5, 1.5, 2.5].map(|x| map.opacity(x / 3.0, 0.75)), [0.0, 1.0, 1.0]);
                assert_eq!(map.opacity(0.5, 0.25), 0.0);
            }
            assert!((map(wrap, true).opacity(1.0 / 3.0, 0.75) - 0.5).abs() < 1e-6);
        }
    }

    #[test]
    fn edges_wrap_as_asked() {
        let beyond = |wrap| [map(wrap, false).opacity(-0.1, 0.75), map(wrap, false).opacity(1.1, 0.75)];
        assert_eq!(beyond(Wrap::Repeat), [1.0, 0.0]);
        assert_eq!(beyond(Wrap::Mirror), [0.0, 1.0]);
        assert_eq!(beyond(Wrap::Clamp), [0.0, 1.0]);
        for odd in [f32::NAN, f32::INFINITY, 1e30, -1e30] {
            assert!((0.0..=1.0).contains(&map(Wrap::Mirror, true).opacity(odd, odd)));
        }
    }
}
