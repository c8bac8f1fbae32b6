//! `--supersample adaptive`: a grid of samples where neighbours differ, one ray through the centre elsewhere.
//!
//! The thesis's rule begins: a pixel is refined where it and one of its four neighbours see different objects, or where
//! their colours, as they are shown, differ by more than a threshold. Then what the grids find leads on, as in Whitted's
//! subdivision (CACM 1980): where samples along a side of a refined pixel differ from the neighbour there, that one is
//! refined, too. So a thin thing that is met anywhere is followed, and where a distant pattern's aliasing leaves a few
//! pixels alike by chance, they are not taken for flat; the thesis's rule alone is ten times as wrong there.
//!
//! Which pixels are refined is the least set that both rules agree to: it depends on what samples see, and not on tiles
//! or threads. A refined pixel is that of `--supersample 16`, any other that of `--supersample off`, bit for bit.

use super::film::{Film, FilmTile, TILE};
use super::frame::{Frame, Pool};
use super::samples::{Colors, PACKET, SAMPLES, pixel_at, sample_at};
use super::tile::{Seen, Worker, milliseconds_since};
use super::visibility::{self, GRID, GRID_SIDE};
use crate::geometry::NO_PRIMITIVE;
use crate::math::{SimdToken, dispatch};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use std::time::Instant;

/// Colours differ if any channel differs by more than this, of 255.
///
/// In the gallery 8 refines a third more pixels for half of the error, 24 a fifth fewer for half as much error again.
const THRESHOLD: u8 = 16;

/// Grids that are shaded together: as many samples as a tile has pixels.
const BATCH: usize = TILE * TILE / GRID;

const _: () = assert!(BATCH * GRID <= SAMPLES, "a batch's samples fit where a tile's do");

/// What a tile's pixels have to do with refinement; a row of pixels is a bit set.
#[derive(Debug)]
pub struct Refinement {
    /// The objects that the pixels' centres see, row by row.
    objects: Vec<u32>,
    /// To be refined.
    wanted: [u64; TILE],
    /// Refined, or being so.
    refined: [u64; TILE],
    /// To be refined beyond the tile's borders, in the order of [`SIDES`].
    beyond: [u64; 4],
}

impl Default for Refinement {
    fn default() -> Self {
        Self { objects: Vec::new(), wanted: [0; TILE], refined: [0; TILE], beyond: [0; 4] }
    }
}

/// A side of a pixel or tile: where the neighbour lies, and which samples of a grid lie along it.
struct Side {
    step: [isize; 2],
    samples: [usize; GRID_SIDE],
}

/// Left, right, above, below.
const SIDES: [Side; 4] = [
    Side { step: [-1, 0], samples: [0, 4, 8, 12] },
    Side { step: [1, 0], samples: [3, 7, 11, 15] },
    Side { step: [0, -1], samples: [0, 1, 2, 3] },
    Side { step: [0, 1], samples: [12, 13, 14, 15] },
];

/// The picture of the pixels' centres, row by row.
pub(super) struct Centres<'a> {
    pub width: usize,
    pub height: usize,
    /// Colours as they are shown.
    pub rgba: &'a [[u8; 4]],
    /// The objects seen.
    pub objects: &'a [u32],
}

/// Refines a picture of centres. `objects` is room for what they see.
pub(super) fn refine(token: SimdToken, frame: &Frame<'_>, pool: &Pool, film: &mut Film, objects: &mut Vec<u32>) {
    film.assemble_objects(objects, pool.threads.as_ref());
    let (centres, tiles) = film.centres_and_tiles(objects);
    let tiles_across = centres.width.div_ceil(TILE);
    let mut first = true;
    loop {
        pool.for_each_tile(frame.cancel, tiles, |tile, worker| {
            dispatch!(token, simd => refine_tile(simd, frame, &centres, first, tile, worker));
            if first {
                frame.tiles.add();
            }
        });
        if frame.cancel.is_cancelled() || !cross_borders(tiles, tiles_across) {
            break;
        }
        first = false;
    }
    film.assemble(pool.threads.as_ref());
}

/// Tells each tile which of its pixels others want refined. False if there are none.
fn cross_borders(tiles: &mut [FilmTile], tiles_across: usize) -> bool {
    let mut any = false;
    for at in 0..tiles.len() {
        let [left, right, above, below] = std::mem::take(&mut tiles[at].refinement.beyond);
        // Only the last tile of a row or column is smaller than others: none lies to the left of or above another.
        for (column, pixels, neighbour) in [(TILE - 1, left, at.wrapping_sub(1)), (0, right, at + 1)] {
            if pixels != 0 {
                any |= tiles[neighbour].refinement.want_column(column, pixels);
            }
        }
        for (row, pixels, neighbour) in
            [(TILE - 1, above, at.wrapping_sub(tiles_across)), (0, below, at + tiles_across)]
        {
            if pixels != 0 {
                any |= tiles[neighbour].refinement.want_row(row, pixels);
            }
        }
    }
    any
}

/// Refines what is wanted of a tile, and what follows from that within it.
fn refine_tile<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    centres: &Centres<'_>,
    first: bool,
    tile: &mut FilmTile,
    worker: &mut Worker,
) {
    // Perhaps the worker's first tile of the frame.
    worker.begin_tile(frame);
    let start = Instant::now();
    if first {
        tile.refinement.begin(simd, centres, [tile.x, tile.y], [tile.width, tile.height]);
    }
    worker.stats.stages_ms.resolve += milliseconds_since(start);
    let (pixels, certificates) = (worker.stats.pixels, worker.stats.certificates);
    let mut wanted = std::mem::take(&mut worker.refined);
    let mut refined = 0;
    while !frame.cancel.is_cancelled() && tile.refinement.take_wanted(&mut wanted) {
        for batch in wanted.chunks(BATCH) {
            visibility::render_grids(simd, frame, [tile.x, tile.y], batch, worker);
            tile.note_grids(batch, &mut worker.ledger);
            let start = Instant::now();
            store_means(simd, frame, centres, batch, &worker.color, tile);
            worker.stats.stages_ms.resolve += milliseconds_since(start);
        }
        refined += wanted.len();
    }
    worker.refined = wanted;
    // Pixels were counted by their centres.
    (worker.stats.pixels, worker.stats.certificates) = (pixels, certificates);
    worker.stats.supersampled += refined as u64;
    if refined > 0 {
        let start = Instant::now();
        tile.encode(simd, &frame.encoder);
        worker.stats.stages_ms.resolve += milliseconds_since(start);
    }
}

/// Stores the means of a batch's grids, in the order of sums of `--supersample 16`, and lets their samples lead on.
fn store_means<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    centres: &Centres<'_>,
    batch: &[u32],
    colors: &Colors,
    tile: &mut FilmTile,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            for (grid, &pixel) in batch.iter().enumerate() {
                let samples = grid * GRID..(grid + 1) * GRID;
                let mut sum = Vec3::ZERO;
                let mut shown = [[0; 4]; GRID];
                for (at, sample) in samples.clone().enumerate() {
                    sum += colors.get(sample);
                    if at % S::f32s::LEN == 0 {
                        let encoded = frame.encoder.encode(simd, colors.load(simd, sample));
                        shown[at..at + S::f32s::LEN].copy_from_slice(&encoded[..S::f32s::LEN]);
                    }
                }
                tile.color.set(pixel as usize, sum * (1.0 / GRID as f32));
                let corner = [tile.x, tile.y];
                tile.refinement.lead_on(centres, corner, pixel_at(pixel).map(usize::from), &shown);
            }
        },
    );
}

impl Refinement {
    /// The objects that the pixels' centres see, row by row.
    pub fn objects(&self) -> &[u32] {
        &self.objects
    }

    /// Begins anew: wants the pixels that differ from a neighbour.
    fn begin<S: Simd>(&mut self, simd: S, centres: &Centres<'_>, [left, top]: [usize; 2], [width, height]: [usize; 2]) {
        (self.wanted, self.refined, self.beyond) = ([0; TILE], [0; TILE], [0; 4]);
        let inside = u64::MAX >> (TILE - width);
        simd.vectorize(
            #[inline(always)]
            || {
                let mut row = Strip::load(centres, left, top);
                let mut differs_above = row.differs(simd, 1, &Strip::load(centres, left, top.saturating_sub(1)), 1);
                for y in 0..height {
                    let below = Strip::load(centres, left, (top + y + 1).min(centres.height - 1));
                    let differs_below = row.differs(simd, 1, &below, 1);
                    let differs_beside = row.differs(simd, 1, &row, 0) | row.differs(simd, 1, &row, 2);
                    self.wanted[y] = inside & (differs_above | differs_below | differs_beside);
                    (row, differs_above) = (below, differs_below);
                }
            },
        );
    }

    /// Lists the pixels that are wanted, in order, and takes them for refined. False if there are none.
    fn take_wanted(&mut self, list: &mut Vec<u32>) -> bool {
        list.clear();
        for (y, (wanted, refined)) in self.wanted.iter_mut().zip(&mut self.refined).enumerate() {
            let mut left = std::mem::take(wanted) & !*refined;
            *refined |= left;
            while left != 0 {
                list.push(sample_at(left.trailing_zeros() as usize, y));
                left &= left - 1;
            }
        }
        list.sort_unstable();
        !list.is_empty()
    }

    /// Wants the neighbours of a refined pixel that differ from its samples next to them.
    #[inline(always)]
    fn lead_on(&mut self, centres: &Centres<'_>, corner: [usize; 2], pixel: [usize; 2], shown: &[[u8; 4]; GRID]) {
        for (at, side) in SIDES.iter().enumerate() {
            // What lies beyond the picture becomes a large number.
            let [x, y] = [0, 1].map(|axis| (corner[axis] + pixel[axis]).wrapping_add_signed(side.step[axis]));
            if x >= centres.width || y >= centres.height {
                continue;
            }
            let neighbour = centres.rgba[y * centres.width + x];
            let mut differs = false;
            for &sample in &side.samples {
                differs |= colors_differ(shown[sample], neighbour);
            }
            if !differs {
                continue;
            }
            let [x, y] = [x.wrapping_sub(corner[0]), y.wrapping_sub(corner[1])];
            if x < TILE && y < TILE {
                self.wanted[y] |= 1 << x;
            } else {
                self.beyond[at] |= 1 << if side.step[0] == 0 { x } else { y };
            }
        }
    }

    /// Wants pixels of a row. False if all of them are refined.
    fn want_row(&mut self, row: usize, pixels: u64) -> bool {
        let new = pixels & !self.refined[row];
        self.wanted[row] |= new;
        new != 0
    }

    /// Wants pixels of a column. False if all of them are refined.
    fn want_column(&mut self, column: usize, pixels: u64) -> bool {
        let mut any = false;
        for row in 0..TILE {
            any |= self.want_row(row, (pixels >> row & 1) << column);
        }
        any
    }
}

#[inline(always)]
fn colors_differ(a: [u8; 4], b: [u8; 4]) -> bool {
    let mut differs = false;
    for (a, b) in a.into_iter().zip(b) {
        differs |= a.abs_diff(b) > THRESHOLD;
    }
    differs
}

/// A row of a tile's pixels and one more on either side; beyond the picture its last pixel is repeated.
struct Strip {
    rgba: [[u8; 4]; TILE + 2],
    objects: [u32; TILE + 2],
}

impl Strip {
    #[inline(always)]
    fn load(centres: &Centres<'_>, left: usize, y: usize) -> Self {
        let mut strip = Self { rgba: [[0; 4]; TILE + 2], objects: [0; TILE + 2] };
        let row = y * centres.width..(y + 1) * centres.width;
        fill(&mut strip.rgba, &centres.rgba[row.clone()], left);
        fill(&mut strip.objects, &centres.objects[row], left);
        strip
    }

    /// Which of a tile's width of pixels from `at` on differ from those of another strip from `other_at` on.
    #[inline(always)]
    fn differs<S: Simd>(&self, simd: S, at: usize, other: &Self, other_at: usize) -> u64 {
        let (rgba, other_rgba) = (self.rgba[at..].as_flattened(), other.rgba[other_at..].as_flattened());
        let threshold = S::u8s::splat(simd, THRESHOLD);
        let (all, none) = (S::u8s::splat(simd, u8::MAX), S::u8s::splat(simd, 0));
        let mut bits = 0;
        for first in (0..TILE).step_by(S::u32s::LEN) {
            let a = S::u8s::from_slice(simd, &rgba[4 * first..4 * first + S::u8s::LEN]);
            let b = S::u8s::from_slice(simd, &other_rgba[4 * first..4 * first + S::u8s::LEN]);
            let far = (a.max(b) - a.min(b)).simd_gt(threshold).select(all, none);
            let far: S::u32s = far.bitcast();
            let a = S::u32s::from_slice(simd, &self.objects[at + first..at + first + S::u32s::LEN]);
            let b = S::u32s::from_slice(simd, &other.objects[other_at + first..other_at + first + S::u32s::LEN]);
            bits |= (!(far | (a ^ b)).simd_eq(0)).to_bitmask() << first;
        }
        bits
    }
}

/// Fills a strip that begins one pixel to the left of `left`.
#[inline(always)]
fn fill<T: Copy>(strip: &mut [T; TILE + 2], row: &[T], left: usize) {
    let right = row.len().min(left + TILE + 1);
    strip[1..=right - left].copy_from_slice(&row[left..right]);
    strip[0] = row[left.saturating_sub(1)];
    strip[right - left + 1..].fill(row[right - 1]);
}

impl FilmTile {
    /// Keeps the objects that samples see.
    pub(super) fn store_objects(&mut self, frame: &Frame<'_>, seen: &[Seen]) {
        let object_of = |primitive: u32| frame.scene.geometry.id(primitive).map_or(u32::MAX, |id| id.object);
        self.refinement.objects.resize(self.width * self.height, u32::MAX);
        let (mut primitive, mut object) = (NO_PRIMITIVE, u32::MAX);
        for first in (0..TILE * TILE).step_by(PACKET) {
            let [x, y] = pixel_at(first as u32).map(usize::from);
            if x >= self.width || y >= self.height {
                continue;
            }
            let start = y * self.width + x;
            let places = &mut self.refinement.objects[start..start + PACKET.min(self.width - x)];
            for (place, seen) in places.iter_mut().zip(&seen[first..]) {
                // Nearly always the primitive is that of the pixel before.
                if seen.primitive != primitive {
                    (primitive, object) = (seen.primitive, object_of(seen.primitive));
                }
                *place = object;
            }
        }
    }
}
