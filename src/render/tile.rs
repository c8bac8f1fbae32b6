//! One tile: visibility, then queue after queue of its paths, then bytes. No recursion.

use super::accumulate::{self, Progress};
use super::contact::{self, ContactArena};
use super::enlarge::Enlargement;
use super::extent::Lists;
use super::film::FilmTile;
use super::frame::Frame;
use super::ledger::Ledger;
use super::media::{Media, MediaMark};
use super::queue::{RUN, RayQueue, ShadowQueue};
use super::samples::{Colors, SAMPLES, sample_at};
use super::trail::Trails;
use super::{FrameStats, mirror, shade, shadow, trace, visibility};
use crate::geometry::{NO_PRIMITIVE, PrimitiveIndex, Stack};
use crate::settings::Supersample;
use fearless_simd::Simd;
use std::time::Instant;

/// What a thread keeps from tile to tile. Nothing in it carries from one tile's picture to the next's.
#[derive(Debug, Default)]
pub struct Worker {
    /// What this worker did since the frame began.
    pub stats: FrameStats,
    pub(super) stack: Stack,
    pub(super) rays: RayQueue,
    /// Rays that follow from `rays`.
    pub(super) mirrored: RayQueue,
    pub(super) refracted: RayQueue,
    /// Rays from the eye whose hits are known, gathered until all are.
    pub(super) found: RayQueue,
    pub(super) shadows: Vec<ShadowQueue>,
    pub(super) media: Media,
    pub(super) contacts: ContactArena,
    pub(super) shadow_scratch: shadow::ShadowScratch,
    /// Colour of each sample of the tile's grid.
    pub(super) color: Colors,
    /// What each sample sees, and how far away.
    pub(super) seen: Vec<Seen>,
    /// What the samples' paths met, if the plan keeps that.
    pub(super) trails: Trails,
    pub(super) cells: visibility::Cells,
    pub(super) order: visibility::Order,
    pub(super) levels: Option<Box<visibility::Levels>>,
    pub(super) smooth: visibility::Smooth,
    pub(super) enlargement: Enlargement,
    /// In which colour the points of patches are shaded, while they are.
    pub(super) paint: Option<shade::Paint>,
    /// Set of the tile's cells whose pixels have the local light of what their eye rays hit.
    pub(super) lit_cells: u64,
    /// Set of the tile's cells of which one primitive was proven to be all that is seen.
    pub(super) certain_cells: u64,
    /// Set of the tile's cells whose eye rays were traced, since too much was listed for them.
    pub(super) traced_cells: u64,
    /// Rays of the samples, if the film keeps them.
    pub(super) ledger: Ledger,
    pub(super) lists: Option<Box<Lists>>,
    /// Queues whose turn has not come, the next one last.
    waiting: Vec<Waiting>,
    /// Empty queues, for their memory.
    spare: Vec<RayQueue>,
    sums: Colors,
    /// Pixels of a tile that are to have more samples, by the samples of their centres.
    pub(super) refined: Vec<u32>,
    /// What the pixels' centres see, while other samples of a grid are seen.
    seen_at_centres: Vec<Seen>,
}

/// Rays that wait until all that follows from earlier ones is done.
#[derive(Debug)]
struct Waiting {
    /// How many rays their paths have, they included.
    level: u32,
    /// What they know of the bodies around them lies before this.
    media: MediaMark,
    /// What touches the surfaces around them lies before this.
    contacts: contact::Mark,
    rays: RayQueue,
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

impl Pass {
    /// The same through another place of each pixel: the centre of a cell of a grid of `side` x `side`.
    fn through(self, side: u32, [row, column]: [u32; 2]) -> Self {
        let step = 1.0 / side as f32;
        Self { offset: [(column as f32 + 0.5) * step, (row as f32 + 0.5) * step], ..self }
    }
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
        _ if let Some(before) = frame.progress => worker.render_sample(simd, frame, &centre, before, tile),
        Supersample::Off => {
            visibility::render_pass(simd, frame, &centre, worker);
            std::mem::swap(&mut tile.color, &mut worker.color);
        }
        Supersample::Adaptive => {
            visibility::render_pass(simd, frame, &centre, worker);
            std::mem::swap(&mut tile.color, &mut worker.color);
            tile.store_objects(frame, &worker.seen);
        }
        Supersample::Grid { side } => {
            if tile.keeps_planes() {
                // What the grid's samples see is counted, not this.
                let pixels = worker.stats.pixels;
                visibility::find_all(simd, frame, &centre, worker);
                worker.stats.pixels = pixels;
            }
            worker.render_grid(simd, frame, &centre, side);
            std::mem::swap(&mut tile.color, &mut worker.sums);
            worker.stats.supersampled += (tile.width * tile.height) as u64;
        }
    }
    tile.store_planes(frame, &worker.seen);
    tile.store_ledger(frame, worker);
    let start = Instant::now();
    tile.encode(simd, &frame.encoder);
    worker.stats.stages_ms.resolve += milliseconds_since(start);
}

impl Worker {
    /// Makes ready for a tile, and forgets what the last one left.
    pub(super) fn begin_tile(&mut self, frame: &Frame<'_>) {
        self.shadows.resize_with(frame.lights.len(), ShadowQueue::default);
        self.shadow_scratch.begin_tile(frame.lights.len());
        self.color.prepare();
        self.lit_cells = 0;
        self.seen.resize(SAMPLES, Seen::NOTHING);
        if frame.keeps_costs {
            self.ledger.begin_tile();
        }
    }

    /// Rays and bodies that there is memory for, in queues that rays follow each other through.
    #[cfg(test)]
    pub(super) fn room(&self) -> usize {
        let queues = [&self.rays, &self.mirrored, &self.refracted].into_iter().chain(&self.spare);
        queues.map(|queue| queue.t.capacity()).sum::<usize>() + self.media.room()
    }

    /// Averages `side` x `side` passes, in row order. What the planes hold stays that of the pixels' centres.
    fn render_grid<S: Simd>(&mut self, simd: S, frame: &Frame<'_>, centre: &Pass, side: u32) {
        std::mem::swap(&mut self.seen, &mut self.seen_at_centres);
        self.seen.resize(SAMPLES, Seen::NOTHING);
        self.sums.clear();
        let (pixels, certificates) = (self.stats.pixels, self.stats.certificates);
        for row in 0..side {
            for column in 0..side {
                // Each pixel counts once, by its last pass.
                self.stats.pixels = pixels;
                self.stats.certificates = certificates;
                visibility::render_pass(simd, frame, &centre.through(side, [row, column]), self);
                self.sums.add_all(&self.color);
            }
        }
        self.sums.scale(1.0 / (side * side) as f32);
        std::mem::swap(&mut self.seen, &mut self.seen_at_centres);
    }

    /// Adds one sample to those that the tile gathers from frame to frame.
    fn render_sample<S: Simd>(
        &mut self,
        simd: S,
        frame: &Frame<'_>,
        centre: &Pass,
        before: Progress,
        tile: &mut FilmTile,
    ) {
        visibility::render_pass(simd, frame, &centre.through(accumulate::SIDE, before.place()), self);
        if let Some(accumulated) = &mut tile.accumulated {
            accumulated.take(before, &mut self.color);
            accumulated.mean(before.next(), &mut tile.color);
        }
    }

    /// Shades the hits in `rays`, then everything that follows from them, adding to the samples' colours.
    ///
    /// Paths are followed depth first, a queue at a time: all that follows from the mirrored rays of a queue comes
    /// before its refracted rays. So at most one queue of each level waits, whatever the depth; a queue's rays share
    /// their history and stay coherent; and no queue holds two rays of one sample, whose light is summed in an order
    /// that depends on nothing else in the tile.
    pub(super) fn shade_paths<S: Simd>(&mut self, simd: S, frame: &Frame<'_>) {
        let mut level = 1;
        self.contacts.clear();
        loop {
            self.shade_level(simd, frame, level);
            self.queue_followers(frame, level + 1);
            if frame.cancel.is_cancelled() {
                self.spare.extend(self.waiting.drain(..).map(|waiting| waiting.rays));
            }
            let Some(next) = self.waiting.pop() else { break };
            level = next.level;
            self.media.truncate(next.media);
            self.contacts.truncate(next.contacts);
            self.spare.push(std::mem::replace(&mut self.rays, next.rays));
            let start = Instant::now();
            let certificate = self.stats.stages_ms.certificate;
            if level == 2 && frame.plan.flat_mirrors {
                mirror::closest_hits(simd, frame, self);
            } else {
                trace::closest_hits(simd, frame, self);
            }
            let certificate = self.stats.stages_ms.certificate - certificate;
            self.stats.stages_ms.secondary += milliseconds_since(start) - certificate;
            if frame.plan.trails {
                self.trails.note_hits(level, &self.rays, &frame.scene.geometry);
            }
        }
    }

    /// Shades the hits in `rays` run by run, each with its shadow rays: they are few enough to stay in the cache.
    fn shade_level<S: Simd>(&mut self, simd: S, frame: &Frame<'_>, level: u32) {
        let mut last = Instant::now();
        if frame.plan.contacts {
            contact::resolve(simd, frame, level, self);
        }
        shade::begin(simd, frame, self);
        let rays = self.rays.len();
        // Rays without beams gain nothing from being close together, and would leave packets not full.
        let run = if frame.plan.beams || frame.plan.shadow_beams { RUN } else { rays.max(1) };
        for first in (0..rays).step_by(run) {
            shade::shade(simd, frame, level, first..(first + run).min(rays), self);
            if self.shadows.iter().all(|queue| queue.len() == 0) {
                continue;
            }
            let (shaded, certificate) = (Instant::now(), self.stats.stages_ms.certificate);
            shadow::resolve(simd, frame, level, self);
            self.stats.stages_ms.shade += (shaded - last).as_secs_f64() * 1e3;
            last = Instant::now();
            // Without what was spent on beams: that has a place of its own.
            let beams = self.stats.stages_ms.certificate - certificate;
            self.stats.stages_ms.shadow += (last - shaded).as_secs_f64() * 1e3 - beams;
        }
        self.stats.stages_ms.shade += milliseconds_since(last);
    }

    /// Lets the rays that follow wait, mirrored ones next.
    fn queue_followers(&mut self, frame: &Frame<'_>, level: u32) {
        let (media, contacts) = (self.media.mark(), self.contacts.mark());
        for followers in [&mut self.refracted, &mut self.mirrored] {
            if followers.len() > 0 {
                if frame.keeps_costs {
                    self.ledger.add_all(&followers.sample[..followers.len()]);
                }
                let empty = self.spare.pop().unwrap_or_default();
                self.waiting.push(Waiting { level, media, contacts, rays: std::mem::replace(followers, empty) });
            }
        }
    }
}

impl FilmTile {
    fn keeps_planes(&self) -> bool {
        !(self.depth.is_empty() && self.normal.is_empty() && self.object.is_empty() && self.primitive.is_empty())
    }

    fn store_planes(&mut self, frame: &Frame<'_>, seen: &[Seen]) {
        if !self.keeps_planes() {
            return;
        }
        for pixel in 0..self.width * self.height {
            let seen = &seen[sample_at(pixel % self.width, pixel / self.width) as usize];
            let id = frame.scene.geometry.id(seen.primitive);
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
