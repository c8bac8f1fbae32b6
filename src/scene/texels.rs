//! The texels of a picture, laid out for bilinear lookups by packets.

use super::texture::srgb_table;
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// A picture that repeats in both directions.
///
/// Texels lie in square tiles of one cache line each, so that the four around a point are mostly in one line, whichever
/// way neighbouring rays run over the picture. They stay as the file has them: decoded to linear light they would take
/// twice to four times the memory, and the cache with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texels {
    /// In texels, at least 1.
    width: u32,
    /// In texels, at least 1.
    height: u32,
    /// Texels from one row of tiles to the next.
    tile_row: u32,
    /// sRGB-encoded red, green and blue, in the low bytes; 0 in what fills up the last tiles.
    texels: Box<[u32]>,
}

/// Base 2 logarithm of a tile's edge: 4 x 4 texels of 4 bytes are a cache line.
const TILE_SHIFT: u32 = 2;
/// Edge of a tile in texels.
const TILE: u32 = 1 << TILE_SHIFT;

impl Texels {
    /// From sRGB-encoded texels, row by row from the top. `None` unless there are `width` x `height` of them, both at
    /// least 1, and few enough to be numbered by a u32.
    pub fn new(width: u32, height: u32, rows: &[[u8; 3]]) -> Option<Self> {
        let tile_row = width.div_ceil(TILE).checked_mul(TILE * TILE)?;
        let len = height.div_ceil(TILE).checked_mul(tile_row)?;
        if rows.is_empty() || rows.len() as u64 != u64::from(width) * u64::from(height) {
            return None;
        }
        let mut texels = Self { width, height, tile_row, texels: vec![0; len as usize].into() };
        for (y, row) in (0..).zip(rows.chunks_exact(width as usize)) {
            for (x, &[r, g, b]) in (0..).zip(row) {
                let place = texels.place(x, y);
                texels.texels[place] = u32::from_le_bytes([r, g, b, 0]);
            }
        }
        Some(texels)
    }

    /// Width in texels, at least 1.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels, at least 1.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Bytes that the texels take.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.texels)
    }

    /// The sRGB-encoded texel in column `x` of row `y`, counted from the top left; both must be inside.
    pub fn texel(&self, x: u32, y: u32) -> [u8; 3] {
        let [r, g, b, _] = self.texels[self.place(x, y)].to_le_bytes();
        [r, g, b]
    }

    fn place(&self, x: u32, y: u32) -> usize {
        let column = ((x >> TILE_SHIFT) << (2 * TILE_SHIFT)) + (x & (TILE - 1));
        let row = (y >> TILE_SHIFT) * self.tile_row + ((y & (TILE - 1)) << TILE_SHIFT);
        (column + row) as usize
    }

    /// Bilinear lookup in linear light, for the lanes in the bit set `lanes`; others get anything. One repetition is 1
    /// wide and 1 high; v = 0 is the bottom of the lowest row.
    #[inline(always)]
    pub(super) fn sample<S: Simd>(&self, simd: S, [u, v]: [S::f32s; 2], lanes: u64) -> V3<S::f32s> {
        let one = S::f32s::splat(simd, 1.0);
        let (left, right, across) = neighbours(simd, u, self.width);
        let (bottom, top, up) = neighbours(simd, v, self.height);
        let [left, right] = [columns::<S>(left), columns::<S>(right)];
        // Rows are counted from the top, v from the bottom.
        let last = S::u32s::splat(simd, self.height - 1);
        let [bottom, top] = [self.rows(simd, last - bottom), self.rows(simd, last - top)];
        let places = [bottom + left, bottom + right, top + left, top + right];
        let [low_left, low_right, high_left, high_right] = self.gather(simd, &places, lanes);
        let low = low_left.scale(one - across) + low_right.scale(across);
        let high = high_left.scale(one - across) + high_right.scale(across);
        low.scale(one - up) + high.scale(up)
    }

    /// Where rows begin.
    #[inline(always)]
    fn rows<S: Simd>(&self, simd: S, y: S::u32s) -> S::u32s {
        (y >> TILE_SHIFT) * S::u32s::splat(simd, self.tile_row) + ((y & (TILE - 1)) << TILE_SHIFT)
    }

    /// The texels at four places a lane, in linear light; black in the lanes that are not in the bit set `lanes`.
    ///
    /// All four of a lane in one round: its waits for memory overlap. Texels of [u16; 4] in linear light were a quarter
    /// faster where they fit the cache, but slower where they do not, and no longer exact. Separate loops that load and
    /// decode become gather instructions, which are slower than this.
    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, places: &[S::u32s; 4], lanes: u64) -> [V3<S::f32s>; 4] {
        let (texels, decode) = (&*self.texels, srgb_table());
        let mut found = [V3::<S::f32s>::zero(simd); 4];
        let mut left = lanes;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % S::u32s::LEN;
            left &= left - 1;
            for (places, found) in places.iter().zip(&mut found) {
                let [r, g, b, _] = texels[places[lane] as usize].to_le_bytes();
                found.x.as_mut_slice()[lane] = decode[usize::from(r)];
                found.y.as_mut_slice()[lane] = decode[usize::from(g)];
                found.z.as_mut_slice()[lane] = decode[usize::from(b)];
            }
        }
        found
    }
}

/// Where columns lie within their rows.
#[inline(always)]
fn columns<S: Simd>(x: S::u32s) -> S::u32s {
    ((x >> TILE_SHIFT) << (2 * TILE_SHIFT)) + (x & (TILE - 1))
}

/// The two texels around coordinate `t` of a repeating row of `size` texels, and the share of the second.
#[inline(always)]
fn neighbours<S: Simd>(simd: S, t: S::f32s, size: u32) -> (S::u32s, S::u32s, S::f32s) {
    let zero = S::f32s::splat(simd, 0.0);
    let finite = t.abs().simd_lt(S::f32s::splat(simd, f32::INFINITY));
    let t = finite.select(t, zero);
    let texels = size as f32;
    let position = (t - t.floor()) * texels - 0.5;
    let before = position.floor();
    let after = before + 1.0;
    let share = position - before;
    let before = before.simd_lt(zero).select(S::f32s::splat(simd, texels - 1.0), before);
    let after = after.simd_ge(S::f32s::splat(simd, texels)).select(zero, after);
    (before.to_int(), after.to_int(), share)
}

#[cfg(test)]
mod tests {
    use super::super::texture::srgb_to_linear;
    use super::*;
    use crate::math::{SimdToken, dispatch};

    /// Texels of sizes that fill no tile, all different.
    fn rows(width: u32, height: u32) -> Vec<[u8; 3]> {
        let texel = |i: u32| [i, i * 7 + 3, 255 - i].map(|value| (value % 256) as u8);
        (0..width * height).map(texel).collect()
    }

    fn lanes<S: Simd>(simd: S, texels: &Texels, [u, v]: [f32; 2]) -> [f32; 3] {
        let coordinates = [S::f32s::splat(simd, u), S::f32s::splat(simd, v)];
        texels.sample(simd, coordinates, (1 << S::f32s::LEN) - 1).lane(S::f32s::LEN - 1).into()
    }

    fn sample(texels: &Texels, coordinates: [f32; 2]) -> [f32; 3] {
        dispatch!(SimdToken::best(), simd => lanes(simd, texels, coordinates))
    }

    #[test]
    fn texels_are_found_again_in_their_tiles() {
        for (width, height) in [(1, 1), (1, 5), (4, 4), (5, 3), (9, 13)] {
            let rows = rows(width, height);
            let texels = Texels::new(width, height, &rows).unwrap();
            for (y, row) in (0..).zip(rows.chunks(width as usize)) {
                for (x, &texel) in (0..).zip(row) {
                    assert_eq!(texels.texel(x, y), texel, "({x}, {y}) of {width} x {height}");
                    let centre = [(x as f32 + 0.5) / width as f32, 1.0 - (y as f32 + 0.5) / height as f32];
                    for (found, expected) in sample(&texels, centre).into_iter().zip(texel.map(srgb_to_linear)) {
                        assert!((found - expected).abs() < 1e-5, "({x}, {y}) of {width} x {height}");
                    }
                }
            }
        }
    }

    #[test]
    fn edges_blend_with_the_opposite_ones() {
        let texels = Texels::new(5, 3, &rows(5, 3)).unwrap();
        let corners = [(0, 0), (4, 0), (0, 2), (4, 2)].map(|(x, y)| texels.texel(x, y).map(srgb_to_linear));
        for corner in [[0.0, 0.0], [1.0, 0.0], [-3.0, 7.0]] {
            for (channel, found) in sample(&texels, corner).into_iter().enumerate() {
                let mean = corners.iter().map(|texel| texel[channel]).sum::<f32>() / 4.0;
                assert!((found - mean).abs() < 1e-6, "{corner:?}");
            }
        }
    }

    #[test]
    fn coordinates_that_are_no_numbers_are_looked_up_at_zero() {
        let texels = Texels::new(5, 3, &rows(5, 3)).unwrap();
        for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(sample(&texels, [odd, odd]), sample(&texels, [0.0, 0.0]));
        }
    }

    #[test]
    fn sizes_that_do_not_fit_are_refused() {
        for (width, height, texels) in [(0, 0, 0), (2, 2, 3), (0, 3, 3), (u32::MAX, u32::MAX, 1)] {
            assert_eq!(Texels::new(width, height, &vec![[0; 3]; texels]), None, "{width} x {height}");
        }
    }
}
