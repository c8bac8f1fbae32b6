//! `--visibility certified`: what a block of pixels can see is proven once for all of them.
//!
//! The idea is beam tracing (Heckbert and Hanrahan, SIGGRAPH 1984) turned into a choice of candidates: a block's beam
//! walks the tree once and lists the primitives that it can meet (compare the entry points of multi-level ray tracing,
//! Reshetov, Soupikov and Hurley, SIGGRAPH 2005); smaller blocks sift that list, and rays are tested against the few
//! that are left. What the rays see is then what they would see on their own, bit for bit.

use super::order::Area;
use super::{Pass, Worker, queue_tile, shade_queue};
use crate::geometry::beam::{Beam, Candidates, Cover, Points};
use crate::geometry::{ClosestHit, Search};
use crate::math::V3;
use crate::render::frame::Frame;
use crate::render::queue::RayQueue;
use crate::render::samples::pixel_at;
use crate::render::tile::milliseconds_since;
use crate::render::trace;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::ops::Range;
use std::time::Instant;

/// Candidates of a block, of one of its quarters, and of the cells of that one.
#[derive(Debug, Default)]
pub struct Levels {
    block: Candidates,
    quarter: Candidates,
    cells: [Candidates; 4],
}

/// How far outside of a pixel's centre a beam begins, in pixels.
const WIDENING: f32 = 0.01;

pub(super) fn render<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    find(simd, frame, pass, worker);
    shade_queue(simd, frame, worker);
}

/// Leaves the hits of all samples in `worker.rays`.
pub(super) fn find<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    let start = Instant::now();
    queue_tile(simd, frame, pass, worker);
    worker.rays.pad();
    (worker.certain_cells, worker.traced_cells) = (0, 0);
    worker.stats.stages_ms.visibility += milliseconds_since(start);
    let mut levels = worker.levels.take().unwrap_or_default();
    for block in 0..worker.order.blocks.len() {
        find_block(simd, frame, pass, block, &mut levels, worker);
    }
    worker.levels = Some(levels);
    // The last packet's spare lanes hold what was found for nobody.
    worker.rays.clear_padding();
}

fn find_block<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    pass: &Pass,
    block: usize,
    levels: &mut Levels,
    worker: &mut Worker,
) {
    let search = trace::eye_search(frame);
    let start = Instant::now();
    let nothing = Cover::nothing(&frame.projection);
    let area = worker.order.blocks[block];
    let listed = search.collect(simd, &beam(frame, pass, area), nothing, &mut levels.block, &mut worker.stack);
    worker.stats.stages_ms.certificate += milliseconds_since(start);
    if listed && levels.block.len() <= 1 {
        let start = Instant::now();
        resolve_area(simd, frame, &search, &levels.block, area, 16 * block..16 * block + 16, worker);
        worker.stats.stages_ms.visibility += milliseconds_since(start);
        return;
    }
    for quarter in 4 * block..4 * block + 4 {
        if worker.order.quarters[quarter].pixels() > 0 {
            find_quarter(simd, frame, pass, quarter, listed, levels, worker);
        }
    }
}

/// Finds the hits of a quarter of a block, whose own candidates are known if they are `listed`.
fn find_quarter<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    pass: &Pass,
    quarter: usize,
    listed: bool,
    levels: &mut Levels,
    worker: &mut Worker,
) {
    let search = trace::eye_search(frame);
    let start = Instant::now();
    let Levels { block, quarter: own, cells } = levels;
    let nothing = Cover::nothing(&frame.projection);
    let area = worker.order.quarters[quarter];
    let own_beam = beam(frame, pass, area);
    let complete = if listed {
        own.filter(simd, block, &own_beam);
        true
    } else {
        search.collect(simd, &own_beam, nothing, own, &mut worker.stack)
    };
    if complete && own.len() <= 1 {
        worker.stats.stages_ms.certificate += milliseconds_since(start);
        let start = Instant::now();
        resolve_area(simd, frame, &search, own, area, 4 * quarter..4 * quarter + 4, worker);
        worker.stats.stages_ms.visibility += milliseconds_since(start);
        return;
    }
    let mut known = [true; 4];
    for (at, (cell, known)) in (4 * quarter..).zip(cells.iter_mut().zip(&mut known)) {
        let area = worker.order.cells[at];
        if area.pixels() == 0 {
            continue;
        }
        let beam = beam(frame, pass, area);
        if complete {
            cell.filter(simd, own, &beam);
        } else {
            *known = search.collect(simd, &beam, nothing, cell, &mut worker.stack);
        }
    }
    worker.stats.stages_ms.certificate += milliseconds_since(start);
    let start = Instant::now();
    for (at, (cell, known)) in (4 * quarter..).zip(cells.iter().zip(known)) {
        let area = worker.order.cells[at];
        if area.pixels() == 0 {
            continue;
        }
        if !known {
            trace::primary_range(simd, frame, area.start..area.start + area.pixels(), worker);
            worker.stats.pixels.traced += area.pixels() as u64;
            worker.traced_cells |= 1 << at;
        } else {
            resolve_area(simd, frame, &search, cell, area, at..at + 1, worker);
        }
    }
    worker.stats.stages_ms.visibility += milliseconds_since(start);
}

/// The beam of an area's rays.
fn beam<'a>(frame: &'a Frame<'_>, pass: &Pass, area: Area) -> Beam<'a> {
    let first = [(pass.x + area.x) as f32 + pass.offset[0], (pass.y + area.y) as f32 + pass.offset[1]];
    beam_between(frame, first, [first[0] + (area.width - 1) as f32, first[1] + (area.height - 1) as f32])
}

/// The beam of all rays through some pixels of the tile at `corner`, given by the samples of their centres.
pub(super) fn beam_of_pixels<'a>(frame: &'a Frame<'_>, corner: [usize; 2], pixels: &[u32]) -> Beam<'a> {
    let (mut first, mut last) = ([u16::MAX; 2], [0; 2]);
    for &pixel in pixels {
        for (axis, at) in pixel_at(pixel).into_iter().enumerate() {
            (first[axis], last[axis]) = (at.min(first[axis]), at.max(last[axis]));
        }
    }
    let place = |axis: usize, at: u16| (corner[axis] + usize::from(at)) as f32;
    beam_between(frame, [place(0, first[0]), place(1, first[1])], [place(0, last[0]) + 1.0, place(1, last[1]) + 1.0])
}

/// The beam of the rays through a rectangle of the picture, in pixels.
fn beam_between<'a>(frame: &'a Frame<'_>, first: [f32; 2], last: [f32; 2]) -> Beam<'a> {
    let camera = &frame.camera;
    let across = |at: f32| at * 2.0 / camera.width as f32 - 1.0;
    let down = |at: f32| 1.0 - at * 2.0 / camera.height as f32;
    let widening = WIDENING * frame.beam_margin;
    let [half_width, half_height] = frame.half_picture;
    let x = [across(first[0] - widening) * half_width, across(last[0] + widening) * half_width];
    let y = [down(last[1] + widening) * half_height, down(first[1] - widening) * half_height];
    Beam::new(&frame.projection, x, y).beyond(camera.near)
}

/// Tests the rays of an area, of which `cells` are all, against what they can meet.
fn resolve_area<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    search: &Search<'_>,
    candidates: &Candidates,
    area: Area,
    cells: Range<usize>,
    worker: &mut Worker,
) {
    let Worker { rays, stats, certain_cells, .. } = worker;
    let pixels = area.pixels();
    resolve_range(simd, frame, search, candidates, area.start..area.start + pixels, rays);
    if candidates.is_certain() {
        stats.pixels.certified += pixels as u64;
        for cell in cells {
            *certain_cells |= 1 << cell;
        }
    } else {
        stats.pixels.resolved += pixels as u64;
        let seen = &rays.primitive[area.start..area.start + pixels];
        if seen.iter().all(|&primitive| primitive == seen[0]) {
            stats.certificates.refused += pixels as u64;
        }
    }
}

/// Tests rays from the eye against all that they can meet, and perhaps rays behind them.
pub(super) fn resolve_range<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    search: &Search<'_>,
    candidates: &Candidates,
    range: Range<usize>,
    rays: &mut RayQueue,
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let eye = V3::splat(simd, frame.camera.eye);
            let (near, far) = (S::f32s::splat(simd, frame.camera.near), S::f32s::splat(simd, frame.camera.far));
            for at in range.step_by(S::f32s::LEN) {
                let direction: V3<S::f32s> = rays.direction.load(simd, at);
                let points = Points::along(&frame.projection, direction);
                let mut visitor = ClosestHit::new(simd, near, far);
                search.resolve(simd, candidates, &points, eye, direction, &mut visitor);
                trace::store_hits(simd, &visitor, rays, at);
            }
        },
    );
}
