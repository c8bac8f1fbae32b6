//! Grids of samples for single pixels, as `--supersample adaptive` asks for them: 16 coherent rays each.

use super::{Worker, aim, certified};
use crate::geometry::beam::Cover;
use crate::render::extent::{FEW, Lists};
use crate::render::frame::Frame;
use crate::render::samples::{CELL, pixel_at};
use crate::render::tile::milliseconds_since;
use crate::render::trace;
use crate::settings::{Supersample, Visibility};
use fearless_simd::Simd;
use std::ops::Range;
use std::time::Instant;

/// Samples along one side of a pixel, and in all.
pub const GRID_SIDE: usize = Supersample::REFINED_SIDE as usize;
pub const GRID: usize = GRID_SIDE * GRID_SIDE;

/// Colours the samples of the grids of some pixels of the tile at `corner`, which are given in order by the samples of
/// their centres. Grid after grid, row by row, they are left in `worker.color`.
pub(in crate::render) fn render_grids<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    corner: [usize; 2],
    pixels: &[u32],
    worker: &mut Worker,
) {
    let start = Instant::now();
    queue_grids(simd, frame, corner, pixels, worker);
    let certificate = worker.stats.stages_ms.certificate;
    match frame.settings.visibility {
        Visibility::Certified => find_certified(simd, frame, corner, pixels, worker),
        Visibility::Full | Visibility::Subsample => trace::primary_hits(simd, frame, worker),
    }
    let certificate = worker.stats.stages_ms.certificate - certificate;
    worker.stats.stages_ms.visibility += milliseconds_since(start) - certificate;
    worker.shade_paths(simd, frame);
}

/// Replaces `worker.rays` by the rays of the grids.
fn queue_grids<S: Simd>(simd: S, frame: &Frame<'_>, corner: [usize; 2], pixels: &[u32], worker: &mut Worker) {
    const STEP: f32 = 1.0 / GRID_SIDE as f32;
    let media = worker.media.restart(frame.around_eye);
    let rays = &mut worker.rays;
    rays.clear();
    rays.extend_from_eye(frame.camera.eye, media, pixels.len() * GRID);
    for (first, &pixel) in (0..).step_by(GRID).zip(pixels) {
        let [x, y] = pixel_at(pixel).map(usize::from);
        let (x, y) = ((corner[0] + x) as f32, (corner[1] + y) as f32);
        for sample in 0..GRID {
            let at = first + sample;
            rays.sample[at] = at as u32;
            // The numbers that a pass over the whole tile adds up.
            rays.direction.x[at] = x + ((sample % GRID_SIDE) as f32 + 0.5) * STEP;
            rays.direction.y[at] = y + ((sample / GRID_SIDE) as f32 + 0.5) * STEP;
        }
    }
    aim(simd, frame, [0.0; 2], 0, rays);
    if frame.plan.trails {
        worker.trails.restart(&worker.rays);
    }
}

/// Finds what the grids' rays hit: a beam lists it for the pixels of a cell, each pixel's beam sifts that.
fn find_certified<S: Simd>(simd: S, frame: &Frame<'_>, corner: [usize; 2], pixels: &[u32], worker: &mut Worker) {
    let search = trace::eye_search(frame);
    let mut lists = worker.lists.take().unwrap_or_default();
    let Lists { whole, part } = &mut *lists;
    let nothing = Cover::nothing(&frame.projection);
    let mut first = 0;
    for cell in pixels.chunk_by(|a, b| a / (CELL * CELL) as u32 == b / (CELL * CELL) as u32) {
        let rays = first..first + cell.len() * GRID;
        first = rays.end;
        let start = Instant::now();
        let listed =
            search.collect(simd, &certified::beam_of_pixels(frame, corner, cell), nothing, whole, &mut worker.stack);
        worker.stats.stages_ms.certificate += milliseconds_since(start);
        if !listed {
            trace::primary_range(simd, frame, rays, worker);
        } else if whole.len() <= FEW || cell.len() == 1 {
            certified::resolve_range(simd, frame, &search, whole, rays, &mut worker.rays);
        } else {
            for (pixel, rays) in cell.chunks(1).zip(grids(rays)) {
                part.filter(simd, whole, &certified::beam_of_pixels(frame, corner, pixel));
                certified::resolve_range(simd, frame, &search, part, rays, &mut worker.rays);
            }
        }
    }
    worker.lists = Some(lists);
    worker.rays.clear_padding();
}

/// The ranges of single grids' rays.
fn grids(rays: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    rays.step_by(GRID).map(|first| first..first + GRID)
}
