//! The samples of a tile: how they are numbered, and their colours.

use super::film::TILE;
use super::queue::{Columns, MOST_LANES};
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

/// Samples along one side of a tile: its pixels, and one row and column more for the corners of cells at its border.
pub const GRID: usize = TILE + 1;

/// All samples of a tile, those of the border last.
pub const SAMPLES: usize = GRID * GRID;

/// Edge of the squares of pixels that make a packet, a cell, a quarter of a block, and a block.
pub const PACKET: usize = 4;
pub const CELL: usize = 8;
pub const QUARTER: usize = 16;
pub const BLOCK: usize = 32;

/// Which sample of the tile's grid a pixel is.
///
/// Pixels are numbered in the order in which their rays are queued: the four blocks of 32 x 32, in each its four quarters
/// of 16 x 16, in each its cells of 8 x 8, in each its packets of 4 x 4, in each its pixels row by row. So what is
/// proven for a block holds for rays in a row, and what a packet of rays from the eye adds lies side by side.
/// The border's samples follow: first the column on the right, then the row below.
#[inline(always)]
pub fn sample_at(x: usize, y: usize) -> u32 {
    let quarter = |edge: usize| y / edge % 2 * 2 + x / edge % 2;
    let sample = if x == TILE {
        TILE * TILE + y
    } else if y == TILE {
        TILE * TILE + GRID + x
    } else {
        let packet = ((quarter(BLOCK) * 4 + quarter(QUARTER)) * 4 + quarter(CELL)) * 4 + quarter(PACKET);
        packet * PACKET * PACKET + y % PACKET * PACKET + x % PACKET
    };
    sample as u32
}

/// The inverse of [`sample_at`].
#[inline(always)]
pub fn pixel_at(sample: u32) -> [u16; 2] {
    let sample = sample as usize;
    let [x, y] = if sample >= TILE * TILE + GRID {
        [sample - TILE * TILE - GRID, TILE]
    } else if sample >= TILE * TILE {
        [TILE, sample - TILE * TILE]
    } else {
        let (packet, pixel) = (sample / (PACKET * PACKET), sample % (PACKET * PACKET));
        // The quarters' numbers are two bits each: across, then down.
        let along = |quarters: usize, pixel: usize| {
            quarters / 64 % 2 * BLOCK
                + quarters / 16 % 2 * QUARTER
                + quarters / 4 % 2 * CELL
                + quarters % 2 * PACKET
                + pixel
        };
        [along(packet, pixel % PACKET), along(packet / 2, pixel / PACKET)]
    };
    [x as u16, y as u16]
}

const _: () = assert!(TILE == 2 * BLOCK, "a tile has four blocks");

/// The linear colour of each sample of a tile.
#[derive(Clone, Debug, Default)]
pub struct Colors(Columns);

/// The first lanes' numbers.
const COUNT_UP: [u32; MOST_LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

impl Colors {
    /// All black.
    pub fn black() -> Self {
        let mut colors = Self::default();
        colors.prepare();
        colors
    }

    /// Makes room for every sample; what they hold is anything.
    pub fn prepare(&mut self) {
        self.0.resize(SAMPLES + MOST_LANES);
    }

    /// Makes every sample black.
    pub fn clear(&mut self) {
        self.0.clear();
        self.prepare();
    }

    /// The colour of one sample.
    #[inline(always)]
    pub fn get(&self, sample: usize) -> Vec3 {
        self.0.get(sample)
    }

    /// Sets the colour of one sample.
    #[inline(always)]
    pub fn set(&mut self, sample: usize, color: Vec3) {
        self.0.set(sample, color);
    }

    /// The colours of the samples that start at `first`.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, first: usize) -> V3<S::f32s> {
        self.0.load(simd, first)
    }

    /// Sets the colours of samples from `first` on, given channel by channel.
    #[inline(always)]
    pub fn set_side_by_side(&mut self, first: usize, channels: [&[f32]; 3]) {
        for (column, values) in self.0.columns_mut().into_iter().zip(channels) {
            column[first..first + values.len()].copy_from_slice(values);
        }
    }

    /// Sets the colours of the samples that start at `first`.
    #[inline(always)]
    pub fn store<S: Simd>(&mut self, _: S, first: usize, colors: V3<S::f32s>) {
        self.0.store::<S>(first, colors);
    }

    /// Adds light to the samples of the lanes in the bit set `lanes`; no two of them are the same sample.
    #[inline(always)]
    pub fn add<S: Simd>(&mut self, simd: S, samples: &[u32], lanes: u64, light: V3<S::f32s>) {
        self.blend::<S, true>(simd, samples, lanes, light);
    }

    /// As [`add`](Self::add); the first light of a sample replaces whatever it held.
    #[inline(always)]
    pub fn deposit<S: Simd>(&mut self, simd: S, first: bool, samples: &[u32], lanes: u64, light: V3<S::f32s>) {
        if first {
            self.blend::<S, false>(simd, samples, lanes, light);
        } else {
            self.blend::<S, true>(simd, samples, lanes, light);
        }
    }

    #[inline(always)]
    fn blend<S: Simd, const ADD: bool>(&mut self, simd: S, samples: &[u32], lanes: u64, light: V3<S::f32s>) {
        let numbers = S::u32s::from_slice(simd, samples);
        let count_up = S::u32s::from_slice(simd, &COUNT_UP[..S::f32s::LEN]);
        let first = samples[0] as usize;
        if numbers.simd_eq(count_up + samples[0]).all_true() && first < SAMPLES {
            // All new, as nearly all packets of rays from the eye: what the samples held need not even be read.
            if !ADD && lanes.count_ones() as usize == S::f32s::LEN {
                self.0.store::<S>(first, light);
                return;
            }
            let old: V3<S::f32s> = self.0.load(simd, first);
            let new = if ADD { old + light } else { light };
            let mask = <<S::f32s as SimdBase<S>>::Mask>::from_bitmask(simd, lanes);
            self.0.store::<S>(first, V3::select(mask, new, old));
            return;
        }
        let (x, y, z) = (light.x.as_slice(), light.y.as_slice(), light.z.as_slice());
        let mut left = lanes;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let sample = samples[lane] as usize;
            for (column, value) in [(&mut self.0.x, x[lane]), (&mut self.0.y, y[lane]), (&mut self.0.z, z[lane])] {
                column[sample] = if ADD { column[sample] + value } else { value };
            }
        }
    }

    /// Adds other colours, sample by sample.
    pub fn add_all(&mut self, other: &Self) {
        for (sums, colors) in self.0.columns_mut().into_iter().zip(other.0.columns()) {
            for (sum, color) in sums.iter_mut().zip(colors) {
                *sum += color;
            }
        }
    }

    /// Takes over other colours.
    pub fn copy_from(&mut self, other: &Self) {
        for (column, colors) in self.0.columns_mut().into_iter().zip(other.0.columns()) {
            column.clone_from(colors);
        }
    }

    /// Adds other colours, each multiplied by `factor`, sample by sample.
    pub fn add_scaled(&mut self, other: &Self, factor: f32) {
        for (sums, colors) in self.0.columns_mut().into_iter().zip(other.0.columns()) {
            for (sum, color) in sums.iter_mut().zip(colors) {
                *sum += color * factor;
            }
        }
    }

    /// Multiplies every colour.
    pub fn scale(&mut self, factor: f32) {
        for column in self.0.columns_mut() {
            for color in column {
                *color *= factor;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_has_one_place() {
        let mut samples: Vec<u32> = Vec::new();
        for y in 0..GRID {
            for x in 0..GRID {
                let sample = sample_at(x, y);
                assert_eq!(pixel_at(sample), [x as u16, y as u16]);
                samples.push(sample);
            }
        }
        samples.sort_unstable();
        assert!(samples.iter().copied().eq(0..SAMPLES as u32));
    }

    #[test]
    fn packets_are_squares() {
        for first in (0..(TILE * TILE) as u32).step_by(PACKET * PACKET) {
            let [left, top] = pixel_at(first);
            for pixel in 0..16 {
                assert_eq!(pixel_at(first + pixel), [left + pixel as u16 % 4, top + pixel as u16 / 4]);
            }
        }
    }
}
