//! `--fill color` with certified visibility: cells that see one surface in one lighting state are shaded at their
//! corners and in their middle, and interpolated between if the middle agrees.
//!
//! What is seen is proven as ever, and so is for flat surfaces that no shadow ends within a cell: one beam from a light
//! to the corners holds the rays to all pixels between them. Only the light that arrives is interpolated (compare
//! Akimoto, Mase and Suenaga, "Pixel-selected ray tracing", IEEE CG&A 11(4), 1991, who interpolate what they did not
//! prove); textures are looked up for every pixel.

use super::order::Area;
use super::{Worker, certified, note_seen};
use crate::geometry::{NO_PRIMITIVE, PrimitiveIndex};
use crate::math::V3;
use crate::render::film::TILE;
use crate::render::frame::Frame;
use crate::render::gather::{Hits, surfaces_of_one};
use crate::render::materials::OneMaterial;
use crate::render::queue::{MOST_LANES, RayQueue};
use crate::render::samples::{BLOCK, CELL, Colors};
use crate::render::shade::{self, Paint};
use crate::render::shadow;
use crate::render::skin::Skin;
use crate::render::tables::FlatMaterial;
use crate::render::texture_place::Sight;
use crate::render::tile::{Pass, milliseconds_since};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use std::ops::Range;
use std::time::Instant;

/// Cells of a block.
const CELLS_PER_BLOCK: usize = (BLOCK / CELL) * (BLOCK / CELL);

/// Pixels of a cell.
const PIXELS: usize = CELL * CELL;

/// The pixels of a cell that are shaded, in the cell's order: its corners, then one in its middle.
const SHADED: [usize; POINTS] = [0, 19, 44, 63, 48];

/// How many those are.
pub(in crate::render) const POINTS: usize = 5;

/// Where the middle one lies between the corners, across and down.
const MIDDLE: f32 = 4.0 / 7.0;

/// Where each pixel of a cell lies between the corners: across, and down.
const ACROSS: [f32; PIXELS] = positions(0);
const DOWN: [f32; PIXELS] = positions(1);

const fn positions(axis: usize) -> [f32; PIXELS] {
    let mut positions = [0.0; PIXELS];
    let mut pixel = 0;
    while pixel < PIXELS {
        let (packet, inside) = (pixel / 16, pixel % 16);
        let at = if axis == 0 { packet % 2 * 4 + inside % 4 } else { packet / 2 * 4 + inside / 4 };
        positions[pixel] = at as f32 / (CELL - 1) as f32;
        pixel += 1;
    }
    positions
}

/// How far the square root of the light in the middle may be off what is interpolated: about so much of sRGB.
const TOLERANCE: f32 = 1.0 / 255.0;

/// Curved surfaces may bulge in a cell by so much of its size: their normals then turn by some 5 degrees.
const MOST_BULGE: f32 = 0.01;

/// A cell that sees one surface, in one paint.
#[derive(Clone, Copy, Debug)]
struct Patch {
    /// Which of the tile's cells.
    cell: u8,
    /// Place of its first ray.
    start: u32,
    primitive: PrimitiveIndex,
}

/// Buffers of cells that are interpolated.
#[derive(Debug, Default)]
pub struct Smooth {
    patches: Vec<Patch>,
    /// Whether each patch may be interpolated, so far.
    holds: Vec<bool>,
    /// Patches of one paint whose rays lie close together.
    groups: Vec<(Paint, Range<usize>)>,
    rays: RayQueue,
    colors: Colors,
}

pub(super) fn render<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    certified::find(simd, frame, pass, worker);
    let mut smooth = std::mem::take(&mut worker.smooth);
    let (start, certificate) = (Instant::now(), worker.stats.stages_ms.certificate);
    if frame.keeps_normals {
        // Cells that get their light here are not shaded again, which is when normals are noted.
        shade::store_seen(simd, frame, worker);
    } else {
        note_seen(frame, worker);
    }
    worker.lit_cells = 0;
    smooth.choose(frame, worker);
    if !smooth.patches.is_empty() {
        smooth.shade(simd, frame, worker);
        worker.lit_cells = smooth.fill(simd, frame, worker);
        count_cells(worker);
    }
    // Without what was spent on beams: that has a place of its own.
    let beams = worker.stats.stages_ms.certificate - certificate;
    worker.stats.stages_ms.shade += milliseconds_since(start) - beams;
    worker.smooth = smooth;
    worker.shade_paths(simd, frame);
}

/// In which paints a material's patches are shaded; none if they are not to be interpolated.
fn paints(material: &FlatMaterial) -> &'static [Paint] {
    let textured = material.maps.color.is_some();
    // Light off a metallic-roughness surface is not a linear function of its colour.
    if material.maps.emission.is_some() || textured && material.metallic_roughness {
        &[]
    } else if !textured {
        &[Paint::Own]
    } else if material.shiny || material.emissive {
        &[Paint::White, Paint::Black]
    } else {
        &[Paint::White]
    }
}

/// The primitive that all pixels of a whole cell see, if there is one.
fn common_primitive(area: &Area, is_certain: bool, seen: &[PrimitiveIndex]) -> Option<PrimitiveIndex> {
    // Packets must not reach into the next cell.
    if area.pixels() < PIXELS || !area.start.is_multiple_of(MOST_LANES) {
        return None;
    }
    let (&first, others) = seen[area.start..area.start + PIXELS].split_first()?;
    let is_common = first != NO_PRIMITIVE && (is_certain || others.iter().all(|&other| other == first));
    is_common.then_some(first)
}

impl Smooth {
    /// Lists the cells whose pixels all see one surface that can be interpolated, block by block and paint by paint.
    fn choose(&mut self, frame: &Frame<'_>, worker: &Worker) {
        self.patches.clear();
        self.groups.clear();
        let tables = &frame.tables;
        for (block, areas) in worker.order.cells.chunks(CELLS_PER_BLOCK).enumerate() {
            let mut found = [None; CELLS_PER_BLOCK];
            for (at, (area, found)) in areas.iter().zip(&mut found).enumerate() {
                let cell = block * CELLS_PER_BLOCK + at;
                let is_certain = worker.certain_cells >> cell & 1 == 1;
                if let Some(primitive) = common_primitive(area, is_certain, &worker.rays.primitive) {
                    let material = &tables.materials[tables.material_of(&frame.scene.geometry, primitive) as usize];
                    // Where it touches something, something else may be seen.
                    let touches = frame.plan.contacts && !frame.scene.contacts.places_of(primitive).is_empty();
                    let carries = tables.extras(&frame.scene.geometry, primitive, |_| ()).is_some();
                    if material.is_uneven() || carries || touches {
                        continue;
                    }
                    let paints = paints(material);
                    *found = Some((Patch { cell: cell as u8, start: area.start as u32, primitive }, paints));
                }
            }
            for paint in Paint::ALL {
                let first = self.patches.len();
                let painted = found.iter().flatten().filter(|(_, paints)| paints.contains(&paint));
                self.patches.extend(painted.map(|(patch, _)| *patch));
                if self.patches.len() > first {
                    self.groups.push((paint, first..self.patches.len()));
                }
            }
        }
    }

    /// Shades the points of all patches; tells which may be interpolated.
    fn shade<S: Simd>(&mut self, simd: S, frame: &Frame<'_>, worker: &mut Worker) {
        self.holds.clear();
        self.holds.extend(self.patches.iter().map(|patch| is_flat_enough(frame, patch, &worker.rays)));
        self.colors.prepare();
        std::mem::swap(&mut worker.rays, &mut self.rays);
        std::mem::swap(&mut worker.color, &mut self.colors);
        for (paint, group) in &self.groups {
            let found = &self.rays;
            let rays = &mut worker.rays;
            rays.clear();
            let first = rays.extend_from_eye(frame.camera.eye, found.media[0], group.len() * POINTS);
            let points = group.clone().flat_map(|patch| SHADED.iter().map(move |shaded| (patch, *shaded)));
            for (at, (patch, shaded)) in (first..).zip(points) {
                let from = self.patches[patch].start as usize + shaded;
                rays.direction.set(at, found.direction.get(from));
                rays.t[at] = found.t[from];
                rays.primitive[at] = found.primitive[from];
            }
            for (at, sample) in (group.start * POINTS..group.end * POINTS).enumerate() {
                rays.sample[at] = sample as u32;
            }
            rays.pad();
            shade::begin(simd, frame, worker);
            worker.paint = Some(*paint);
            shade::shade(simd, frame, 1, 0..group.len() * POINTS, worker);
            worker.paint = None;
            shadow::settle(simd, frame, worker, &mut self.holds);
        }
        std::mem::swap(&mut worker.rays, &mut self.rays);
        std::mem::swap(&mut worker.color, &mut self.colors);
        for (patch, holds) in self.holds.iter_mut().enumerate() {
            *holds = *holds && Blend::new(&self.colors, patch).is_smooth(frame);
        }
    }

    /// Fills the cells all of whose patches hold; returns the set of them.
    fn fill<S: Simd>(&self, simd: S, frame: &Frame<'_>, worker: &mut Worker) -> u64 {
        let mut refused = 0_u64;
        for (patch, holds) in self.patches.iter().zip(&self.holds) {
            refused |= u64::from(!holds) << patch.cell;
        }
        let mut filled = 0;
        for (paint, group) in &self.groups {
            for (patch, blend) in group.clone().map(|at| (&self.patches[at], Blend::new(&self.colors, at))) {
                if refused >> patch.cell & 1 == 0 {
                    filled |= 1 << patch.cell;
                    fill_cell(simd, frame, *paint, patch, &blend, worker);
                }
            }
        }
        filled
    }
}

/// Whether a patch's surface is flat enough for the light in its middle to tell of all of it.
fn is_flat_enough(frame: &Frame<'_>, patch: &Patch, rays: &RayQueue) -> bool {
    if frame.scene.geometry.is_flat(patch.primitive) {
        return true;
    }
    let point = |pixel: usize| {
        let at = patch.start as usize + pixel;
        rays.direction.get(at) * rays.t[at]
    };
    let [a, b, c, d, middle] = SHADED.map(point);
    let (down, up) = (d - a, b - c);
    let normal = down.cross(up).normalize_or_zero();
    let bulge = normal.dot(middle - (a + b + c + d) / 4.0).abs();
    bulge <= MOST_BULGE * down.length().max(up.length())
}

/// Light between the corners of a patch: a + b u + c v + d u v.
struct Blend {
    parts: [Vec3; 4],
    middle: Vec3,
}

impl Blend {
    fn new(colors: &Colors, patch: usize) -> Self {
        let color = |point: usize| colors.get(patch * POINTS + point);
        let [a, b, c, d] = [color(0), color(1), color(2), color(3)];
        Self { parts: [a, b - a, c - a, a - b - c + d], middle: color(4) }
    }

    /// Whether the middle's own light is near enough what is interpolated; light above 1, too, which a texture or a tone
    /// curve may darken.
    fn is_smooth(&self, frame: &Frame<'_>) -> bool {
        let [a, b, c, d] = self.parts;
        let found = a + b * MIDDLE + c * MIDDLE + d * (MIDDLE * MIDDLE);
        let encoded = |light: Vec3| (light * frame.encoder.gain).max(Vec3::ZERO).map(f32::sqrt);
        (encoded(found) - encoded(self.middle)).abs().max_element() <= TOLERANCE
    }

    /// The light of the pixels of a cell that start at `at`.
    #[inline(always)]
    fn light<S: Simd>(&self, simd: S, at: usize) -> V3<S::f32s> {
        let u = S::f32s::from_slice(simd, &ACROSS[at..at + S::f32s::LEN]);
        let v = S::f32s::from_slice(simd, &DOWN[at..at + S::f32s::LEN]);
        let [a, b, c, d] = self.parts.map(|part| V3::splat(simd, part));
        a + b.scale(u) + c.scale(v) + d.scale(u * v)
    }
}

/// Fills a cell in one paint.
fn fill_cell<S: Simd>(simd: S, frame: &Frame<'_>, paint: Paint, patch: &Patch, blend: &Blend, worker: &mut Worker) {
    let Worker { rays, color: colors, .. } = worker;
    simd.vectorize(
        #[inline(always)]
        || {
            for at in (0..PIXELS).step_by(S::f32s::LEN) {
                let light = blend.light(simd, at);
                let from = patch.start as usize + at;
                let sample = rays.sample[from] as usize;
                let color = match paint {
                    Paint::Own => light,
                    Paint::White => light * texture_color(simd, frame, patch.primitive, rays, from),
                    // The highlight stands alone in black, and was counted once in white.
                    Paint::Black => {
                        let texture = texture_color(simd, frame, patch.primitive, rays, from);
                        colors.load(simd, sample) + light * (V3::splat(simd, Vec3::ONE) - texture)
                    }
                };
                colors.store(simd, sample, color);
            }
        },
    );
}

/// What the texture of the surface that the rays at `at` hit holds for them.
#[inline(always)]
fn texture_color<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    primitive: PrimitiveIndex,
    rays: &RayQueue,
    at: usize,
) -> V3<S::f32s> {
    let lanes = at..at + S::f32s::LEN;
    let hits = Hits::new(simd, &rays.primitive[lanes.clone()]);
    let t = S::f32s::from_slice(simd, &rays.t[lanes]);
    let direction = rays.direction.load(simd, at);
    let surfaces = surfaces_of_one(simd, frame, &hits, primitive, rays.origins(simd, at), direction, t);
    let sight = Sight::new(frame, &surfaces, direction, t);
    Skin::of(simd, frame, &hits, &surfaces, &OneMaterial::of(frame, primitive), &sight).color
}

/// Counts the pixels of the cells that were filled as interpolated, and no longer as what they were.
fn count_cells(worker: &mut Worker) {
    let Worker { stats, lit_cells, certain_cells, .. } = worker;
    let pixels = |cells: u64| u64::from(cells.count_ones()) * PIXELS as u64;
    stats.pixels.interpolated += pixels(*lit_cells);
    stats.pixels.certified -= pixels(*lit_cells & *certain_cells);
    stats.pixels.resolved -= pixels(*lit_cells & !*certain_cells);
}

const _: () = assert!((TILE / CELL) * (TILE / CELL) == 64, "a set of a tile's cells is 64 bits");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::samples::pixel_at;

    #[test]
    fn points_and_positions_are_those_of_the_cells_pixels() {
        for pixel in 0..PIXELS {
            let at = pixel_at(pixel as u32).map(|at| f32::from(at) / 7.0);
            assert_eq!([ACROSS[pixel], DOWN[pixel]], at);
        }
        let points = SHADED.map(|pixel| [ACROSS[pixel], DOWN[pixel]]);
        assert_eq!(points, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [MIDDLE, MIDDLE]]);
    }
}
