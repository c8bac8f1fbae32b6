//! `--visibility subsample`: a coarse grid of pixels is traced; a cell whose corners match is filled in, any other is
//! split, down to single pixels. Things thinner than a cell can be missed. The thesis skips the search of a pixel between
//! two that hit the same object; the grid, the matching of four corners and the splitting of cells are ours.
//!
//! Cells lie on the grid of the tile's samples: from 4 x 4 on their pixels follow each other, and are filled a packet at
//! a time. Those of a level are kept in that order too, so that the rays through their corners make coherent packets.

use super::{Order, Pass, Worker, queue_tile, shade_queue, trace_pixels};
use crate::geometry::{NO_PRIMITIVE, PrimitiveIndex};
use crate::math::V3;
use crate::render::film::TILE;
use crate::render::frame::Frame;
use crate::render::queue::MOST_LANES;
use crate::render::samples::{Colors, PACKET, QUARTER, SAMPLES, pixel_at, sample_at};
use crate::render::tile::milliseconds_since;
use crate::render::trace;
use crate::settings::{Fill, Supersample};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use std::ops::{Add, Mul, Range, Sub};
use std::time::Instant;

/// A square of pixels, by its corner in the tile; all cells of a level have the same size.
#[derive(Clone, Copy, Debug)]
struct Cell {
    left: u16,
    top: u16,
}

/// The cells of one size that are looked at, in the order of the tile's samples, and where the tile ends.
#[derive(Debug, Default)]
struct Level {
    size: u16,
    cells: Vec<Cell>,
    /// The tile's size.
    width: u16,
    height: u16,
    /// The last column and row that have samples: where the picture goes on, those of the next tile's first pixels.
    last: [u16; 2],
}

impl Level {
    /// Where a cell's corners are: on its own first column and row, and on those of the next cells or where the picture
    /// ends.
    fn far(&self, cell: Cell) -> [u16; 2] {
        [(cell.left + self.size).min(self.last[0]), (cell.top + self.size).min(self.last[1])]
    }

    /// The samples of a cell's corners: left-top, right-top, left-bottom and right-bottom.
    fn corners(&self, cell: Cell) -> [usize; 4] {
        let (Cell { left, top }, [right, bottom]) = (cell, self.far(cell));
        [sample_of([left, top]), sample_of([right, top]), sample_of([left, bottom]), sample_of([right, bottom])]
    }

    /// The columns of the tile's pixels that belong to a cell.
    fn columns(&self, cell: Cell) -> Range<u16> {
        cell.left..(cell.left + self.size).min(self.width)
    }

    /// The rows of the tile's pixels that belong to a cell.
    fn rows(&self, cell: Cell) -> Range<u16> {
        cell.top..(cell.top + self.size).min(self.height)
    }

    /// The samples of a cell of whole packets. Beyond the picture's border they are nobody's.
    fn samples(&self, cell: Cell) -> Range<usize> {
        let first = sample_of([cell.left, cell.top]);
        first..first + usize::from(self.size).pow(2)
    }

    /// Whether a cell's pixels are whole packets.
    fn has_packets(&self) -> bool {
        usize::from(self.size) >= PACKET
    }
}

/// The sample of a pixel of the tile, or of the border.
#[inline(always)]
fn sample_of([x, y]: [u16; 2]) -> usize {
    sample_at(x.into(), y.into()) as usize
}

/// Buffers of subsampling.
#[derive(Debug, Default)]
pub struct Cells {
    level: Level,
    /// Cells that are to be split.
    refused: Vec<Cell>,
    /// Pixels to trace.
    pixels: Vec<[u16; 2]>,
    /// Whether a sample was to be traced.
    listed: Vec<bool>,
    /// What each sample sees, or is taken to see.
    primitive: Vec<PrimitiveIndex>,
    /// How far away that is, or [`trace::PENDING`].
    t: Vec<f32>,
    /// Places of the rays that miss what they were taken to see.
    missing: Vec<u32>,
}

pub(super) fn render<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    let mut cells = std::mem::take(&mut worker.cells);
    cells.begin(pass, frame.settings.stride as u16);
    match frame.settings.fill {
        Fill::Color => fill_colors(simd, frame, pass, &mut cells, worker),
        Fill::Hit => fill_hits(simd, frame, pass, &mut cells, worker),
    }
    worker.cells = cells;
}

impl Cells {
    /// The cells of the coarsest grid.
    fn begin(&mut self, pass: &Pass, stride: u16) {
        self.listed.clear();
        self.listed.resize(SAMPLES, false);
        self.missing.clear();
        let Level { size, cells, width, height, last } = &mut self.level;
        (*width, *height) = (pass.width as u16, pass.height as u16);
        *last = [*width - u16::from(!pass.continues_right), *height - u16::from(!pass.continues_down)];
        *size = QUARTER as u16;
        let quarters = (0..(TILE * TILE) as u32).step_by(QUARTER * QUARTER).map(pixel_at);
        self.refused.clear();
        cells.clear();
        cells.extend(quarters.map(|[left, top]| Cell { left, top }).filter(|c| c.left < *width && c.top < *height));
        while self.level.size > stride {
            self.refused.extend_from_slice(&self.level.cells);
            self.split();
        }
    }

    /// Whether a ray was traced for a sample before anything was filled in.
    pub fn is_listed(&self, sample: usize) -> bool {
        self.listed[sample]
    }

    /// The samples of pixels that a ray was traced for since they miss what they were taken to see.
    pub fn traced_anew<'a>(&'a self, order: &'a Order) -> impl Iterator<Item = u32> + 'a {
        self.missing.iter().map(|&place| order.samples[place as usize])
    }

    /// Goes on to the cells of half the size, which are those that were refused cut in four.
    fn split(&mut self) {
        let Level { size, cells, width, height, .. } = &mut self.level;
        *size /= 2;
        cells.clear();
        for &Cell { left, top } in &self.refused {
            for [across, down] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                let cell = Cell { left: left + across * *size, top: top + down * *size };
                if cell.left < *width && cell.top < *height {
                    cells.push(cell);
                }
            }
        }
        self.refused.clear();
    }

    /// Lists the corners of the level's cells that are to be traced: the pixels that cells begin with, and where no cell
    /// of the tile begins, the far ones. If `far`, the far ones in cells that were filled are traced all the same.
    fn list_corners(&mut self, far: bool) {
        self.pixels.clear();
        let Self { level, pixels, listed, .. } = self;
        let mut list = |pixel: [u16; 2]| {
            if !std::mem::replace(&mut listed[sample_of(pixel)], true) {
                pixels.push(pixel);
            }
        };
        for &cell in &level.cells {
            let (Cell { left, top }, [right, bottom]) = (cell, level.far(cell));
            list([left, top]);
            // Single pixels have nothing between their corners.
            let inside = level.size > 1;
            let rightmost = far || inside && left + level.size >= level.width;
            let lowest = far || inside && top + level.size >= level.height;
            if rightmost {
                list([right, top]);
            }
            if lowest {
                list([left, bottom]);
            }
            if rightmost && lowest {
                list([right, bottom]);
            }
        }
    }
}

/// How many of the listed pixels lie in the tile itself.
fn own_pixels(pixels: &[[u16; 2]], pass: &Pass) -> u64 {
    let is_own = |[x, y]: [u16; 2]| usize::from(x) < pass.width && usize::from(y) < pass.height;
    pixels.iter().filter(|&&pixel| is_own(pixel)).count() as u64
}

/// `--fill color`: corners are shaded at once; where they agree, colours between them are interpolated.
fn fill_colors<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, cells: &mut Cells, worker: &mut Worker) {
    let mut traced = 0;
    while !cells.level.cells.is_empty() {
        let start = Instant::now();
        cells.list_corners(false);
        worker.stats.stages_ms.visibility += milliseconds_since(start);
        trace_pixels(simd, frame, pass, &cells.pixels, worker);
        worker.trails.restart(&worker.rays);
        shade_queue(simd, frame, worker);
        traced += own_pixels(&cells.pixels, pass);
        if cells.level.size == 1 {
            break;
        }
        let start = Instant::now();
        let Cells { level, refused, .. } = cells;
        for &cell in &level.cells {
            let corners = level.corners(cell);
            if corners_match(corners, worker, frame.settings.match_threshold) {
                interpolate(simd, frame, level, cell, corners, worker);
            } else {
                refused.push(cell);
            }
        }
        cells.split();
        worker.stats.stages_ms.visibility += milliseconds_since(start);
    }
    worker.stats.pixels.traced += traced;
    worker.stats.pixels.interpolated += (pass.width * pass.height) as u64 - traced;
}

/// Corners whose normals are farther apart, as a cosine, are not interpolated between: 5 degrees.
const LEAST_COSINE: f32 = 0.9962;

/// Whether a cell's corners see the same primitive under the same lights, alike turned and coloured, and the same things
/// mirrored and refracted in it.
fn corners_match(corners: [usize; 4], worker: &Worker, threshold: f32) -> bool {
    let Worker { seen, color, trails, .. } = worker;
    let [first, others @ ..] = corners;
    let (primitive, trail) = (seen[first].primitive, trails.of(first));
    if others.iter().any(|&corner| seen[corner].primitive != primitive || trails.of(corner) != trail) {
        return false;
    }
    let normal = Vec3::from(seen[first].normal);
    let turned = |&corner: &usize| Vec3::from(seen[corner].normal).dot(normal) < LEAST_COSINE;
    (primitive == NO_PRIMITIVE || !others.iter().any(turned))
        && colors_match(each(corners, |at| color.get(at)), threshold)
}

/// What `at` says of each corner. An array's own `map` is not inlined.
#[inline(always)]
fn each<T>([a, b, c, d]: [usize; 4], at: impl Fn(usize) -> T) -> [T; 4] {
    [at(a), at(b), at(c), at(d)]
}

/// Whether no channel of the corners' colours differs by more than the threshold.
fn colors_match([a, b, c, d]: [Vec3; 4], threshold: f32) -> bool {
    let (least, greatest) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
    (greatest - least).cmple(Vec3::splat(threshold)).all()
}

/// Interpolates between the corners of a cell.
#[inline(always)]
fn interpolate<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    level: &Level,
    cell: Cell,
    corners: [usize; 4],
    worker: &mut Worker,
) {
    let Worker { color, seen, trails, .. } = worker;
    let colors = each(corners, |corner| color.get(corner));
    let views = each(corners, |corner| seen[corner]);
    let normals = each(corners, |corner| Vec3::from(seen[corner].normal));
    let (Cell { left, top }, [right, bottom]) = (cell, level.far(cell));
    let step = |from: u16, to: u16| 1.0 / f32::from((to - from).max(1));
    let steps = [step(left, right), step(top, bottom)];
    let (columns, rows) = (level.columns(cell), level.rows(cell));
    if level.has_packets() {
        fill_packets(simd, level.samples(cell), colors, steps, color);
    }
    // Corners of finer cells on the first row and column ask what is seen there; elsewhere only what shows it does.
    let everywhere = frame.keeps_planes || frame.settings.supersample == Supersample::Adaptive;
    for y in rows {
        let inside = everywhere || y == top || !level.has_packets();
        for x in left..if inside { columns.end } else { left + 1 } {
            let sample = sample_of([x, y]);
            let (u, v) = (f32::from(x - left) * steps[0], f32::from(y - top) * steps[1]);
            if !level.has_packets() {
                color.set(sample, bilinear(colors, u, v));
            }
            let seen = &mut seen[sample];
            seen.primitive = views[0].primitive;
            seen.normal = bilinear(normals, u, v).into();
            trails.copy(corners[0], sample);
            if frame.keeps_planes {
                seen.t = match seen.primitive {
                    NO_PRIMITIVE => f32::INFINITY,
                    _ => bilinear([views[0].t, views[1].t, views[2].t, views[3].t], u, v),
                };
            }
        }
    }
}

/// Where the pixels of a packet lie in it.
const ACROSS: [f32; MOST_LANES] = [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0];
const DOWN: [f32; MOST_LANES] = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0];

/// Interpolates between the colours at the corners of a cell of whole packets, whose pixels are `steps` apart.
fn fill_packets<S: Simd>(simd: S, samples: Range<usize>, corners: [Vec3; 4], steps: [f32; 2], colors: &mut Colors) {
    simd.vectorize(
        #[inline(always)]
        || {
            let [left, top] = pixel_at(samples.start as u32);
            let (across, down) =
                (S::f32s::from_slice(simd, &ACROSS[..S::f32s::LEN]), S::f32s::from_slice(simd, &DOWN[..S::f32s::LEN]));
            let [a, b, c, d] = corners;
            let (a, b) = (V3::<S::f32s>::splat(simd, a), V3::<S::f32s>::splat(simd, b));
            let (c, d) = (V3::<S::f32s>::splat(simd, c) - a, V3::<S::f32s>::splat(simd, d) - b);
            for first in samples.step_by(S::f32s::LEN) {
                let [x, y] = pixel_at(first as u32);
                let u = (across + f32::from(x - left)) * steps[0];
                let v = (down + f32::from(y - top)) * steps[1];
                let (left, right) = (a + c.scale(v), b + d.scale(v));
                colors.store(simd, first, left + (right - left).scale(u));
            }
        },
    );
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
    cells.primitive.resize(SAMPLES, NO_PRIMITIVE);
    cells.t.resize(SAMPLES, 0.0);
    let mut traced = 0;
    while !cells.level.cells.is_empty() {
        let start = Instant::now();
        cells.list_corners(true);
        worker.stats.stages_ms.visibility += milliseconds_since(start);
        trace_pixels(simd, frame, pass, &cells.pixels, worker);
        let start = Instant::now();
        for at in 0..worker.rays.len() {
            let sample = worker.rays.sample[at] as usize;
            (cells.primitive[sample], cells.t[sample]) = (worker.rays.primitive[at], worker.rays.t[at]);
        }
        traced += own_pixels(&cells.pixels, pass);
        if cells.level.size > 1 {
            cells.match_hits();
        }
        cells.split();
        worker.stats.stages_ms.visibility += milliseconds_since(start);
    }
    let start = Instant::now();
    queue_tile(simd, frame, pass, worker);
    for (at, &sample) in worker.order.samples.iter().enumerate() {
        worker.rays.primitive[at] = cells.primitive[sample as usize];
        worker.rays.t[at] = cells.t[sample as usize];
    }
    worker.rays.clear_padding();
    trace::test_pending(simd, frame, &mut worker.rays, &mut cells.missing);
    trace::retrace(simd, frame, &cells.missing, worker);
    traced += cells.missing.len() as u64;
    worker.stats.stages_ms.visibility += milliseconds_since(start);
    worker.stats.pixels.traced += traced;
    worker.stats.pixels.resolved += (pass.width * pass.height) as u64 - traced;
    shade_queue(simd, frame, worker);
}

impl Cells {
    /// Takes all of a cell to see what its corners see, if they see the same primitive (or all see nothing).
    fn match_hits(&mut self) {
        let Self { level, refused, primitive: seen, t, .. } = self;
        for &cell in &level.cells {
            let corners = level.corners(cell);
            let primitive = seen[corners[0]];
            if corners.iter().any(|&corner| seen[corner] != primitive) {
                refused.push(cell);
            } else if level.has_packets() {
                seen[level.samples(cell)].fill(primitive);
                t[level.samples(cell)].fill(trace::PENDING);
            } else {
                for y in level.rows(cell) {
                    for x in level.columns(cell) {
                        let sample = sample_of([x, y]);
                        (seen[sample], t[sample]) = (primitive, trace::PENDING);
                    }
                }
            }
        }
    }
}
