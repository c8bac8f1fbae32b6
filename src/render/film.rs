//! The picture being made: linear colour, the 8-bit picture, and optional planes of what each pixel sees.
//!
//! Pixels are stored tile by tile, so that workers own disjoint tiles without locks or shared mutable memory.

use super::accumulate::{Accumulated, Progress};
use super::adaptive::{Centres, Refinement};
use super::ledger::Obtained;
use super::resolve::Encoder;
use super::samples::{Colors, PACKET, pixel_at, sample_at};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayon::prelude::*;
use std::ops::Range;

/// Edge of a tile in pixels. Tiles are the unit of work and of memory.
pub const TILE: usize = 64;

/// Which planes besides colour a film keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Planes {
    /// Distance from the eye, +inf on a miss.
    pub depth: bool,
    /// Shading normal faced to the viewer, 0 on a miss.
    pub normal: bool,
    /// Object index, `u32::MAX` on a miss.
    pub object: bool,
    /// Primitive index within the object, `u32::MAX` on a miss.
    pub primitive: bool,
    /// How each pixel was obtained.
    pub decision: bool,
    /// Rays that were traced for each pixel.
    pub cost: bool,
}

impl Planes {
    /// Whether any plane of what pixels see is kept.
    pub fn any_seen(self) -> bool {
        self.depth || self.normal || self.object || self.primitive
    }

    /// Whether any plane is kept.
    pub fn any(self) -> bool {
        self.any_seen() || self.decision || self.cost
    }
}

/// One tile's pixels, row by row but for their linear colours; planes that the film does not keep are empty.
#[derive(Debug, Default)]
pub(super) struct FilmTile {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
    /// Linear colours, by sample.
    pub color: Colors,
    pub rgba: Vec<[u8; 4]>,
    pub depth: Vec<f32>,
    pub normal: Vec<[f32; 3]>,
    pub object: Vec<u32>,
    pub primitive: Vec<u32>,
    pub decision: Vec<Obtained>,
    /// Rays that were traced for each pixel.
    pub cost: Vec<u32>,
    pub refinement: Refinement,
    /// The samples of a film that gathers them from frame to frame.
    pub accumulated: Option<Box<Accumulated>>,
}

impl FilmTile {
    fn new(x: usize, y: usize, width: usize, height: usize, planes: Planes) -> Self {
        let pixels = width * height;
        let kept = |keep: bool| if keep { pixels } else { 0 };
        Self {
            x,
            y,
            width,
            height,
            color: Colors::black(),
            rgba: vec![[0, 0, 0, 255]; pixels],
            depth: vec![f32::INFINITY; kept(planes.depth)],
            normal: vec![[0.0; 3]; kept(planes.normal)],
            object: vec![u32::MAX; kept(planes.object)],
            primitive: vec![u32::MAX; kept(planes.primitive)],
            decision: vec![Obtained::NOTHING; kept(planes.decision)],
            cost: vec![0; kept(planes.cost)],
            refinement: Refinement::default(),
            accumulated: None,
        }
    }

    /// Encodes the linear colours.
    pub fn encode<S: Simd>(&mut self, simd: S, encoder: &Encoder) {
        simd.vectorize(
            #[inline(always)]
            || {
                for first in (0..TILE * TILE).step_by(S::f32s::LEN) {
                    let [x, y] = pixel_at(first as u32).map(usize::from);
                    if x < self.width && y < self.height {
                        let pixels = encoder.encode(simd, self.color.load(simd, first));
                        self.store_square(x, y, &pixels[..S::f32s::LEN]);
                    }
                }
            },
        );
    }

    /// Stores pixels that follow each other as samples, of which the first lies at the start of a row of a packet.
    #[inline(always)]
    fn store_square(&mut self, x: usize, y: usize, pixels: &[[u8; 4]]) {
        for (row, pixels) in pixels.chunks_exact(PACKET).enumerate().take(self.height - y) {
            let start = (y + row) * self.width + x;
            if x + PACKET <= self.width {
                self.rgba[start..start + PACKET].copy_from_slice(pixels);
            } else {
                let inside = self.width - x;
                self.rgba[start..start + inside].copy_from_slice(&pixels[..inside]);
            }
        }
    }
}

/// A picture of `width` x `height` pixels. Reused from frame to frame without allocating.
#[derive(Debug)]
pub struct Film {
    width: u32,
    height: u32,
    planes: Planes,
    pub(super) tiles: Vec<FilmTile>,
    rgba: Vec<u8>,
    pub(super) progress: Option<Progress>,
}

impl Film {
    /// A black picture. `width` and `height` must be at least 1.
    pub fn new(width: u32, height: u32, planes: Planes) -> Self {
        assert!(width > 0 && height > 0, "a film has at least one pixel");
        let (w, h) = (width as usize, height as usize);
        let starts = (0..h).step_by(TILE).flat_map(|y| (0..w).step_by(TILE).map(move |x| (x, y)));
        let tiles = starts.map(|(x, y)| FilmTile::new(x, y, TILE.min(w - x), TILE.min(h - y), planes)).collect();
        Self { width, height, planes, tiles, rgba: vec![0; w * h * 4], progress: None }
    }

    /// A picture that gathers samples: each frame rendered into it, all of one view, adds one of the 16 of
    /// `--supersample 16`, whatever the setting says, and shows the mean of those so far. The 16th gives the very bits of
    /// that setting; a frame more, or one that was cancelled, begins anew. It keeps no planes.
    pub fn accumulating(width: u32, height: u32) -> Self {
        let mut film = Self::new(width, height, Planes::default());
        film.tiles.iter_mut().for_each(|tile| tile.accumulated = Some(Box::default()));
        film.start_over();
        film
    }

    /// Forgets the samples of a picture that gathers them: the next frame may show another view.
    pub fn start_over(&mut self) {
        self.progress = self.tiles.iter().any(|tile| tile.accumulated.is_some()).then(Progress::default);
    }

    /// How many samples a pixel of a picture that gathers them has, up to 16; `None` for any other picture.
    pub fn samples(&self) -> Option<u32> {
        self.progress.map(Progress::samples)
    }

    /// Takes over another's 8-bit picture, of the same size, and nothing else of it.
    pub fn copy_rgba(&mut self, other: &Self) {
        self.rgba.copy_from_slice(&other.rgba);
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The planes it keeps.
    pub fn planes(&self) -> Planes {
        self.planes
    }

    /// The 8-bit sRGB picture after exposure and tone map, RGBA, row by row from the top.
    pub fn rgba(&self) -> &[u8] {
        &self.rgba
    }

    /// Paints over the 8-bit picture, pixel by pixel, given what each was; the next frame knows nothing of it.
    pub fn paint(&mut self, mut color: impl FnMut(&Self, u32, u32, [u8; 3]) -> [u8; 3]) {
        let mut rgba = std::mem::take(&mut self.rgba);
        let (pixels, _) = rgba.as_chunks_mut::<4>();
        for (y, row) in (0..self.height).zip(pixels.chunks_exact_mut(self.width as usize)) {
            for (x, pixel) in (0..self.width).zip(row) {
                let [r, g, b, alpha] = *pixel;
                let [r, g, b] = color(self, x, y, [r, g, b]);
                *pixel = [r, g, b, alpha];
            }
        }
        self.rgba = rgba;
    }

    /// Takes over some columns of another's 8-bit picture, of the same size, and nothing else of it.
    pub fn copy_columns(&mut self, other: &Self, columns: Range<u32>) {
        let bytes = 4 * columns.start as usize..4 * columns.end as usize;
        let width = 4 * self.width as usize;
        for (row, other) in self.rgba.chunks_exact_mut(width).zip(other.rgba.chunks_exact(width)) {
            row[bytes.clone()].copy_from_slice(&other[bytes.clone()]);
        }
    }

    /// Linear, unclamped colour of a pixel, before exposure and tone map.
    pub fn color(&self, x: u32, y: u32) -> [f32; 3] {
        let (tile, _) = self.find(x, y);
        tile.color.get(sample_at(x as usize % TILE, y as usize % TILE) as usize).into()
    }

    /// Distance from the eye to what a pixel sees, +inf on a miss; `None` when the film keeps no such plane.
    pub fn depth(&self, x: u32, y: u32) -> Option<f32> {
        let (tile, pixel) = self.find(x, y);
        tile.depth.get(pixel).copied()
    }

    /// Shading normal faced to the viewer, 0 on a miss; `None` when the film keeps no such plane.
    pub fn normal(&self, x: u32, y: u32) -> Option<[f32; 3]> {
        let (tile, pixel) = self.find(x, y);
        tile.normal.get(pixel).copied()
    }

    /// Object index, `u32::MAX` on a miss; `None` when the film keeps no such plane.
    pub fn object(&self, x: u32, y: u32) -> Option<u32> {
        let (tile, pixel) = self.find(x, y);
        tile.object.get(pixel).copied()
    }

    /// Primitive index within the object, `u32::MAX` on a miss; `None` when the film keeps no such plane.
    pub fn primitive(&self, x: u32, y: u32) -> Option<u32> {
        let (tile, pixel) = self.find(x, y);
        tile.primitive.get(pixel).copied()
    }

    /// How a pixel was obtained; `None` when the film keeps no such plane.
    pub fn decision(&self, x: u32, y: u32) -> Option<Obtained> {
        let (tile, pixel) = self.find(x, y);
        tile.decision.get(pixel).copied()
    }

    /// How many rays were traced for a pixel, of all kinds: those that the frame's stats count, each of which is some pixel's.
    /// `None` when the film keeps no such plane.
    pub fn cost(&self, x: u32, y: u32) -> Option<u32> {
        let (tile, pixel) = self.find(x, y);
        tile.cost.get(pixel).copied()
    }

    fn find(&self, x: u32, y: u32) -> (&FilmTile, usize) {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) lies outside of the film");
        let (x, y) = (x as usize, y as usize);
        let tile = &self.tiles[y / TILE * (self.width as usize).div_ceil(TILE) + x / TILE];
        (tile, y % TILE * tile.width + x % TILE)
    }

    /// Copies the tiles' encoded pixels into the row-by-row picture: each row of tiles is a strip of its own.
    pub(super) fn assemble(&mut self, threads: Option<&rayon::ThreadPool>) {
        let (pixels, _) = self.rgba.as_chunks_mut();
        assemble(pixels, self.width as usize, &self.tiles, threads, |tile| &tile.rgba);
    }

    /// Copies the objects that the tiles' pixels see into `objects`, row by row.
    pub(super) fn assemble_objects(&self, objects: &mut Vec<u32>, threads: Option<&rayon::ThreadPool>) {
        objects.resize(self.rgba.len() / 4, u32::MAX);
        assemble(objects, self.width as usize, &self.tiles, threads, |tile| tile.refinement.objects());
    }

    /// The assembled picture with the objects it shows, and the tiles.
    pub(super) fn centres_and_tiles<'a>(&'a mut self, objects: &'a [u32]) -> (Centres<'a>, &'a mut [FilmTile]) {
        let (rgba, _) = self.rgba.as_chunks();
        let (width, height) = (self.width as usize, self.height as usize);
        (Centres { width, height, rgba, objects }, &mut self.tiles)
    }
}

/// Copies what tiles hold row by row into a whole `width` wide.
fn assemble<T: Copy + Send + Sync>(
    whole: &mut [T],
    width: usize,
    tiles: &[FilmTile],
    threads: Option<&rayon::ThreadPool>,
    part_of: impl Fn(&FilmTile) -> &[T] + Sync + Send,
) {
    let copy = |(strip, tiles): (&mut [T], &[FilmTile])| {
        for tile in tiles {
            for (row, pixels) in part_of(tile).chunks_exact(tile.width).enumerate() {
                let start = row * width + tile.x;
                strip[start..start + tile.width].copy_from_slice(pixels);
            }
        }
    };
    let (strip, tiles_across) = (width * TILE, width.div_ceil(TILE));
    match threads {
        Some(threads) => {
            threads.install(|| whole.par_chunks_mut(strip).zip(tiles.par_chunks(tiles_across)).for_each(copy));
        }
        None => whole.chunks_mut(strip).zip(tiles.chunks(tiles_across)).for_each(copy),
    }
}
