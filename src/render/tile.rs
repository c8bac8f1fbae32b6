//! One tile: visibility, then level after level of its paths, then bytes. No recursion.

use super::film::{FilmTile, TILE};
use super::frame::Frame;
use super::media::Media;
use super::queue::{RayQueue, ShadowQueue};
use super::{FrameStats, shade, shadow, trace, visibility};
use crate::geometry::{NO_PRIMITIVE, PrimitiveIndex, Stack};
use crate::settings::Supersample;
use fearless_simd::Simd;
use std::time::Instant;

/// Samples along one side of a tile: its pixels, and one row and column more for the corners of cells at its border.
pub const GRID: usize = TILE + 1;

/// What a thread keeps from tile to tile. Nothing in it carries from one tile's picture to the next's.
#[derive(Debug, Default)]
pub struct Worker {
    /// What this worker did since the frame began.
    pub stats: FrameStats,
    pub(super) stack: Stack,
    pub(super) rays: RayQueue,
    pub(super) next_rays: RayQueue,
    /// Rays from the eye whose hits are known, gathered until all are.
    pub(super) found: RayQueue,
    pub(super) shadows: Vec<ShadowQueue>,
    pub(super) media: Media,
    /// For each light the primitive that blocked it last in this tile: the thesis's shadow-object cache.
    pub(super) last_blocker: Vec<PrimitiveIndex>,
    /// Colour of each sample of the tile's grid.
    pub(super) color: Vec<[f32; 3]>,
    /// What each sample sees, and how far away.
    pub(super) seen: Vec<Seen>,
    pub(super) cells: visibility::Cells,
    sums: Vec<[f32; 3]>,
    /// What the pixels' centres see, while other samples of a grid are seen.
    seen_at_centres: Vec<Seen>,
}

/// What a sample's ray from the eye hit.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    pub primitive: PrimitiveIndex,
    pub t: f32,
    pub normal: [f32; 3],
}

impl Seen {
    /// Nothing.
    pub const NOTHING: Self = Self { primitive: NO_PRIMITIVE, t: f32::INFINITY, normal: [0.0; 3] };
}

/// Where the samples of one pass over a tile lie.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// The tile's corner in the picture.
    pub x: usize,
    pub y: usize,
    /// The tile's size.
    pub width: usize,
    pub height: usize,
    /// Whether the picture goes on to the right, and below: the last cells' corners are then the next tile's pixels.
    pub continues_right: bool,
    pub continues_down: bool,
    /// Where in each pixel the ray goes through: (½, ½) is its centre.
    pub offset: [f32; 2],
}

/// Which sample of the grid a pixel of the tile is.
#[inline(always)]
pub fn sample_at(x: usize, y: usize) -> u32 {
    (y * GRID + x) as u32
}

/// The inverse of [`sample_at`].
pub fn pixel_at(sample: u32) -> [u16; 2] {
    [(sample as usize % GRID) as u16, (sample as usize / GRID) as u16]
}

/// Renders one tile of the film.
pub(super) fn render<S: Simd>(simd: S, frame: &Frame<'_>, tile: &mut FilmTile, worker: &mut Worker) {
    worker.begin_tile(frame);
    let centre = Pass {
        x: tile.x,
        y: tile.y,
        width: tile.width,
        height: tile.height,
        continues_right: tile.x + tile.width < frame.camera.width as usize,
        continues_down: tile.y + tile.height < frame.camera.height as usize,
        offset: [0.5, 0.5],
    };
    match frame.settings.supersample {
        Supersample::Off => {
            visibility::render_pass(simd, frame, &centre, worker);
            tile.store_colors(&worker.color);
        }
        Supersample::Grid { side } => {
            if tile.keeps_planes() {
                visibility::find_all(simd, frame, &centre, worker);
            }
            worker.render_grid(simd, frame, &centre, side);
            tile.store_colors(&worker.sums);
            worker.stats.supersampled += (tile.width * tile.height) as u64;
        }
    }
    tile.store_planes(frame, &worker.seen);
    let start = Instant::now();
    tile.encode(&frame.encoder);
    worker.stats.stages_ms.resolve += milliseconds_since(start);
}

impl Worker {
    fn begin_tile(&mut self, frame: &Frame<'_>) {
        self.shadows.resize_with(frame.lights.len(), ShadowQueue::default);
        self.last_blocker.clear();
        self.last_blocker.resize(frame.lights.len(), NO_PRIMITIVE);
        self.color.resize(GRID * GRID, [0.0; 3]);
        self.seen.resize(GRID * GRID, Seen::NOTHING);
    }

    /// Averages `side` x `side` passes, in row order. What the planes hold stays that of the pixels' centres.
    fn render_grid<S: Simd>(&mut self, simd: S, frame: &Frame<'_>, centre: &Pass, side: u32) {
        std::mem::swap(&mut self.seen, &mut self.seen_at_centres);
        self.seen.resize(GRID * GRID, Seen::NOTHING);
        self.sums.clear();
        self.sums.resize(GRID * GRID, [0.0; 3]);
        let pixels_before = self.stats.pixels;
        let step = 1.0 / side as f32;
        for row in 0..side {
            for column in 0..side {
                let offset = [(column as f32 + 0.5) * step, (row as f32 + 0.5) * step];
                self.stats.pixels = pixels_before;
                visibility::render_pass(simd, frame, &Pass { offset, ..*centre }, self);
                for (sum, color) in self.sums.iter_mut().zip(&self.color) {
                    *sum = std::array::from_fn(|c| sum[c] + color[c]);
                }
            }
        }
        let share = 1.0 / (side * side) as f32;
        for sum in &mut self.sums {
            *sum = sum.map(|c| c * share);
        }
        std::mem::swap(&mut self.seen, &mut self.seen_at_centres);
    }

    /// Shades the hits in `rays`, then everything that follows from them, adding to the samples' colours.
    pub(super) fn shade_paths<S: Simd>(&mut self, simd: S, frame: &Frame<'_>) {
        for level in 1..=frame.plan.depth {
            let start = Instant::now();
            shade::shade(simd, frame, level, self);
            self.stats.stages_ms.shade += milliseconds_since(start);

            let start = Instant::now();
            shadow::resolve(simd, frame, level, self);
            self.stats.stages_ms.shadow += milliseconds_since(start);

            if self.next_rays.len() == 0 {
                break;
            }
            std::mem::swap(&mut self.rays, &mut self.next_rays);
            let start = Instant::now();
            trace::closest_hits(simd, frame, self);
            self.stats.stages_ms.secondary += milliseconds_since(start);
        }
    }
}

impl FilmTile {
    fn keeps_planes(&self) -> bool {
        !(self.depth.is_empty() && self.normal.is_empty() && self.object.is_empty() && self.primitive.is_empty())
    }

    fn store_colors(&mut self, samples: &[[f32; 3]]) {
        for (row, pixels) in self.color.chunks_exact_mut(self.width).enumerate() {
            pixels.copy_from_slice(&samples[row * GRID..][..self.width]);
        }
    }

    fn store_planes(&mut self, frame: &Frame<'_>, seen: &[Seen]) {
        if !self.keeps_planes() {
            return;
        }
        for pixel in 0..self.width * self.height {
            let seen = &seen[sample_at(pixel % self.width, pixel / self.width) as usize];
            let id = frame.scene.geometry.ids.get(seen.primitive as usize);
            store(&mut self.depth, pixel, id.map_or(f32::INFINITY, |_| seen.t));
            store(&mut self.normal, pixel, seen.normal);
            store(&mut self.object, pixel, id.map_or(u32::MAX, |id| id.object));
            store(&mut self.primitive, pixel, id.map_or(u32::MAX, |id| id.primitive));
        }
    }
}

/// Writes to a plane that may not be kept.
fn store<T>(plane: &mut [T], pixel: usize, value: T) {
    if let Some(place) = plane.get_mut(pixel) {
        *place = value;
    }
}

/// Milliseconds since `start`.
pub fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
