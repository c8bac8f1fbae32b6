//! `--visibility subsample`: the thesis's own method. A coarse grid of pixels is traced; a cell whose corners match is
//! filled in, any other is split, down to single pixels. Things thinner than a cell can be missed: that is its price.

use super::{Pass, Worker, append_pixels, shade_queue, trace_pixels};
use crate::geometry::{NO_PRIMITIVE, PrimitiveIndex};
use crate::render::frame::Frame;
use crate::render::samples::{Colors, SAMPLES, pixel_at, sample_at};
use crate::render::tile::{Seen, milliseconds_since};
use crate::render::trace;
use crate::settings::Fill;
use fearless_simd::Simd;
use glam::Vec3;
use std::ops::{Add, Mul, Sub};
use std::time::Instant;

/// A square of the grid, corners included, in the tile's own coordinates; cut off at the picture's border.
#[derive(Clone, Copy, Debug)]
struct Cell {
    left: u16,
    top: u16,
    right: u16,
    bottom: u16,
}

impl Cell {
    fn corners(&self) -> [[u16; 2]; 4] {
        [[self.left, self.top], [self.right, self.top], [self.left, self.bottom], [self.right, self.bottom]]
    }

    /// Pixels of the cell that belong to it: each pixel of a tile belongs to one cell.
    fn pixels(&self, pass: &Pass) -> impl Iterator<Item = [u16; 2]> + use<> {
        // The last cell of a row or column owns its far border only where the picture ends.
        let end = |far: u16, size: usize| if usize::from(far) + 1 == size { far + 1 } else { far };
        let (right, bottom) = (end(self.right, pass.width), end(self.bottom, pass.height));
        let left = self.left;
        (self.top..bottom).flat_map(move |y| (left..right).map(move |x| [x, y]))
    }

    /// The cell cut in four, or in two where it is too thin for that.
    fn split(&self) -> impl Iterator<Item = Cell> + use<> {
        let halves = |from: u16, to: u16| {
            let middle = from + (to - from) / 2;
            let cuts =
                if to - from > 1 { [Some((from, middle)), Some((middle, to))] } else { [Some((from, to)), None] };
            cuts.into_iter().flatten()
        };
        let Cell { left, top, right, bottom } = *self;
        halves(top, bottom).flat_map(move |(top, bottom)| {
            halves(left, right).map(move |(left, right)| Cell { left, top, right, bottom })
        })
    }

    /// Whether there is nothing between the corners.
    fn is_pixel_sized(&self) -> bool {
        self.right - self.left <= 1 && self.bottom - self.top <= 1
    }
}

/// Buffers of subsampling.
#[derive(Debug, Default)]
pub struct Cells {
    /// Pixels to trace.
    pub pixels: Vec<[u16; 2]>,
    current: Vec<Cell>,
    next: Vec<Cell>,
    matched: Vec<(Cell, PrimitiveIndex)>,
    inside: Vec<[u16; 2]>,
    done: Vec<bool>,
}

pub(super) fn render<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    let mut cells = std::mem::take(&mut worker.cells);
    cells.begin(pass, frame.settings.stride as usize);
    match frame.settings.fill {
        Fill::Color => fill_colors(simd, frame, pass, &mut cells, worker),
        Fill::Hit => fill_hits(simd, frame, pass, &mut cells, worker),
    }
    worker.cells = cells;
}

impl Cells {
    /// The grid's cells. Corners beyond the tile's last pixel but within the picture are those of the next tile.
    fn begin(&mut self, pass: &Pass, stride: usize) {
        self.done.clear();
        self.done.resize(SAMPLES, false);
        self.current.clear();
        let far = |at: usize, size: usize, full: bool| (at + stride).min(if full { size } else { size - 1 }) as u16;
        for top in (0..pass.height).step_by(stride) {
            for left in (0..pass.width).step_by(stride) {
                let right = far(left, pass.width, pass.continues_right).max(left as u16);
                let bottom = far(top, pass.height, pass.continues_down).max(top as u16);
                self.current.push(Cell { left: left as u16, top: top as u16, right, bottom });
            }
        }
    }

    /// The corners of the current cells that were not traced before.
    fn list_new_corners(&mut self) {
        self.pixels.clear();
        for cell in &self.current {
            for [x, y] in cell.corners() {
                let done = &mut self.done[sample_at(x.into(), y.into()) as usize];
                if !std::mem::replace(done, true) {
                    self.pixels.push([x, y]);
                }
            }
        }
    }

    /// Splits a cell into the next level's.
    fn split(next: &mut Vec<Cell>, cell: &Cell) {
        if !cell.is_pixel_sized() {
            next.extend(cell.split());
        }
    }
}

/// How many of the listed pixels lie in the tile itself.
fn own_pixels(pixels: &[[u16; 2]], pass: &Pass) -> u64 {
    pixels.iter().filter(|&&pixel| is_own(pixel, pass)).count() as u64
}

/// Whether a pixel lies in the tile itself.
fn is_own([x, y]: [u16; 2], pass: &Pass) -> bool {
    usize::from(x) < pass.width && usize::from(y) < pass.height
}

/// The primitive that all corners see, if they see the same one (or all see nothing).
fn common_primitive(cell: &Cell, seen: &[Seen]) -> Option<PrimitiveIndex> {
    let [a, b, c, d] = cell.corners().map(|[x, y]| seen[sample_at(x.into(), y.into()) as usize].primitive);
    (a == b && a == c && a == d).then_some(a)
}

/// `--fill color`: corners are shaded at once; where they agree, colours between them are interpolated.
fn fill_colors<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, cells: &mut Cells, worker: &mut Worker) {
    while !cells.current.is_empty() {
        cells.list_new_corners();
        if !cells.pixels.is_empty() {
            trace_pixels(simd, frame, pass, &cells.pixels, worker);
            worker.trails.restart(&worker.rays);
            shade_queue(simd, frame, worker);
            worker.stats.pixels.traced += own_pixels(&cells.pixels, pass);
        }
        let start = Instant::now();
        cells.next.clear();
        for cell in &cells.current {
            if corners_match(cell, worker, frame.settings.match_threshold) {
                worker.stats.pixels.interpolated +=
                    interpolate(cell, pass, &mut cells.done, worker, frame.keeps_planes);
            } else {
                Cells::split(&mut cells.next, cell);
            }
        }
        std::mem::swap(&mut cells.current, &mut cells.next);
        worker.stats.stages_ms.visibility += milliseconds_since(start);
    }
}

/// Corners whose normals are farther apart, as a cosine, are not interpolated between: 5 degrees.
const LEAST_COSINE: f32 = 0.9962;

/// Whether a cell's corners see the same primitive under the same lights, alike turned and coloured, and the same things
/// mirrored and refracted in it.
fn corners_match(cell: &Cell, worker: &Worker, threshold: f32) -> bool {
    let Worker { seen, color, trails, .. } = worker;
    let Some(primitive) = common_primitive(cell, seen) else { return false };
    let corners = cell.corners().map(|[x, y]| sample_at(x.into(), y.into()) as usize);
    let normals = corners.map(|corner| Vec3::from(seen[corner].normal));
    let turned = |normal: &Vec3| normal.dot(normals[0]) < LEAST_COSINE;
    corners.iter().all(|&corner| trails.of(corner) == trails.of(corners[0]))
        && (primitive == NO_PRIMITIVE || !normals.iter().any(turned))
        && colors_match(cell, color, threshold)
}

/// Whether no channel of the corners' colours differs by more than the threshold.
fn colors_match(cell: &Cell, color: &Colors, threshold: f32) -> bool {
    let corners = cell.corners().map(|[x, y]| color.get(sample_at(x.into(), y.into()) as usize));
    (0..3).all(|channel| {
        let values = corners.map(|c| c[channel]);
        let least = values.into_iter().fold(f32::INFINITY, f32::min);
        let greatest = values.into_iter().fold(f32::NEG_INFINITY, f32::max);
        greatest - least <= threshold
    })
}

/// Interpolates between the corners of a cell; returns how many of the tile's pixels it filled.
fn interpolate(cell: &Cell, pass: &Pass, done: &mut [bool], worker: &mut Worker, keeps_planes: bool) -> u64 {
    let Worker { color, seen, trails, .. } = worker;
    let corners = cell.corners().map(|[x, y]| sample_at(x.into(), y.into()) as usize);
    let colors = corners.map(|corner| color.get(corner));
    let views = corners.map(|corner| seen[corner]);
    let step = |from: u16, to: u16| 1.0 / f32::from((to - from).max(1));
    let (across, down) = (step(cell.left, cell.right), step(cell.top, cell.bottom));
    let mut filled = 0;
    for [x, y] in cell.pixels(pass) {
        let sample = sample_at(x.into(), y.into()) as usize;
        if std::mem::replace(&mut done[sample], true) {
            continue;
        }
        let (u, v) = (f32::from(x - cell.left) * across, f32::from(y - cell.top) * down);
        color.set(sample, bilinear(colors, u, v));
        // Corners of finer cells nearby ask what this pixel sees; where, only planes ask.
        seen[sample].primitive = views[0].primitive;
        seen[sample].normal = std::array::from_fn(|c| bilinear(views.map(|view| view.normal[c]), u, v));
        trails.copy(corners[0], sample);
        if keeps_planes {
            seen[sample].t = match views[0].primitive {
                NO_PRIMITIVE => f32::INFINITY,
                _ => bilinear(views.map(|view| view.t), u, v),
            };
        }
        filled += 1;
    }
    filled
}

/// Between the values at the corners left-top, right-top, left-bottom and right-bottom of a unit square.
fn bilinear<T>([a, b, c, d]: [T; 4], u: f32, v: f32) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>,
{
    let (left, right) = (a + (c - a) * v, b + (d - b) * v);
    left + (right - left) * u
}

/// `--fill hit`: where corners see the same primitive, the pixels between them are tested against it alone; all are
/// shaded on their own. A pixel that misses the primitive is traced.
fn fill_hits<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, cells: &mut Cells, worker: &mut Worker) {
    let mut found = std::mem::take(&mut worker.found);
    found.clear();
    cells.matched.clear();
    while !cells.current.is_empty() {
        cells.list_new_corners();
        if !cells.pixels.is_empty() {
            trace_pixels(simd, frame, pass, &cells.pixels, worker);
            for at in 0..worker.rays.len() {
                let (sample, primitive) = (worker.rays.sample[at] as usize, worker.rays.primitive[at]);
                worker.seen[sample] = Seen { primitive, ..Seen::NOTHING };
            }
            found.append(&worker.rays);
            worker.stats.pixels.traced += own_pixels(&cells.pixels, pass);
        }
        cells.next.clear();
        for cell in &cells.current {
            match common_primitive(cell, &worker.seen) {
                Some(primitive) => cells.matched.push((*cell, primitive)),
                None => Cells::split(&mut cells.next, cell),
            }
        }
        std::mem::swap(&mut cells.current, &mut cells.next);
    }
    let start = Instant::now();
    cells.pixels.clear();
    let media = worker.media.restart(frame.around_eye);
    for (cell, primitive) in &cells.matched {
        cells.inside.clear();
        for [x, y] in cell.pixels(pass) {
            if !std::mem::replace(&mut cells.done[sample_at(x.into(), y.into()) as usize], true) {
                cells.inside.push([x, y]);
            }
        }
        let first = found.len();
        append_pixels(simd, frame, pass, &cells.inside, media, &mut found);
        if *primitive == NO_PRIMITIVE {
            found.miss_from(first);
            worker.stats.pixels.resolved += cells.inside.len() as u64;
            continue;
        }
        trace::test_primitive(simd, frame, *primitive, first, &mut found);
        found.retain_from(first, |sample, primitive| {
            let hit = primitive != NO_PRIMITIVE;
            if !hit {
                cells.pixels.push(pixel_at(sample));
            }
            hit
        });
        worker.stats.pixels.resolved += (found.len() - first) as u64;
    }
    worker.stats.stages_ms.visibility += milliseconds_since(start);
    if !cells.pixels.is_empty() {
        trace_pixels(simd, frame, pass, &cells.pixels, worker);
        found.append(&worker.rays);
        worker.stats.pixels.traced += cells.pixels.len() as u64;
    }
    std::mem::swap(&mut worker.rays, &mut found);
    worker.found = found;
    // Corners beyond the tile's border belong to the next tile.
    worker.rays.retain_from(0, |sample, _| is_own(pixel_at(sample), pass));
    worker.rays.clear_padding();
    shade_queue(simd, frame, worker);
}
