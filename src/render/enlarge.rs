//! `--render-scale`: a smaller picture is traced, and enlarged bilinearly in linear light.

use super::film::{FilmTile, TILE};
use super::frame::{Scratch, render_frame};
use super::ledger::Obtained;
use super::resolve::Encoder;
use super::samples::{PACKET, sample_at};
use super::tile::milliseconds_since;
use super::{Film, FrameStats};
use crate::math::{SimdToken, dispatch};
use crate::scene::{Camera, Scene};
use crate::settings::Settings;
use fearless_simd::Simd;
use std::time::Instant;

/// What one tile's part of a smaller picture is enlarged in.
#[derive(Debug, Default)]
pub struct Enlargement {
    /// Columns of the smaller picture between which the tile's columns lie.
    across: Vec<Between>,
    /// The smaller picture's rows at the tile's width, channel by channel.
    rows: Vec<[f32; 3 * TILE]>,
}

/// Two places in a row, and the share of the second.
#[derive(Clone, Copy, Debug)]
struct Between {
    first: usize,
    second: usize,
    share: f32,
}

impl Between {
    /// Where pixel `at` of `size` lies in a row of `small` pixels.
    fn of(at: usize, size: u32, small: u32) -> Self {
        let place = ((at as f32 + 0.5) * small as f32 / size as f32 - 0.5).clamp(0.0, (small - 1) as f32);
        let first = place as usize;
        Self { first, second: (first + 1).min(small as usize - 1), share: place - first as f32 }
    }

    /// The place that is nearer.
    fn nearest(self) -> usize {
        if self.share < 0.5 { self.first } else { self.second }
    }
}

/// The pixel of `small` whose centre lies within pixel `at` of `size`, if any does: no two within one, since none is smaller.
fn own(at: usize, size: u32, small: u32) -> Option<u32> {
    let (at, size, small) = (at as u64, u64::from(size), u64::from(small));
    let first = at * small / size;
    (first..small.min(first + 2)).find(|pixel| (2 * pixel + 1) * size / (2 * small) == at).map(|pixel| pixel as u32)
}

/// One side of the traced picture in pixels.
fn scaled(side: u32, scale: f32) -> u32 {
    ((side as f32 * scale).round() as u32).clamp(1, side)
}

/// The size of the picture that is traced for one of `width` x `height` pixels.
pub(super) fn traced_size(width: u32, height: u32, scale: f32) -> [u32; 2] {
    [width, height].map(|side| scaled(side, scale))
}

/// Renders a frame at the scale that the settings ask for.
pub(super) fn render_scaled(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    scratch: &mut Scratch,
    film: &mut Film,
) -> FrameStats {
    let size = traced_size(film.width(), film.height(), settings.render_scale);
    let is_such = |small: &Film| [small.width(), small.height()] == size && small.planes() == film.planes();
    let small = scratch.small.take().filter(is_such);
    let mut small = small.unwrap_or_else(|| Film::new(size[0], size[1], film.planes()));
    let settings = Settings { render_scale: 1.0, ..settings.clone() };
    let mut stats = render_frame(scene, camera, &settings, scratch, &mut small);
    let traced = u64::from(size[0]) * u64::from(size[1]);
    stats.pixels.interpolated += u64::from(film.width()) * u64::from(film.height()) - traced;

    let start = Instant::now();
    let (token, encoder) =
        (SimdToken::new(settings.simd).unwrap_or_else(SimdToken::best), Encoder::new(scene, &settings));
    let (whole, cancel) = ([film.width(), film.height()], scratch.cancel.clone());
    if let Some(pool) = &mut scratch.pool {
        pool.for_each_tile(&cancel, &mut film.tiles, |tile, worker| {
            let start = Instant::now();
            dispatch!(token, simd => enlarge(simd, &small, whole, tile, &mut worker.enlargement));
            dispatch!(token, simd => tile.encode(simd, &encoder));
            worker.stats.stages_ms.resolve += milliseconds_since(start);
        });
        film.assemble(pool.threads.as_ref());
        pool.collect(&mut stats);
    }
    scratch.small = Some(small);
    stats.frame_ms += milliseconds_since(start);
    stats
}

/// Fills one tile of a picture of the size `whole` from the smaller one.
fn enlarge<S: Simd>(simd: S, small: &Film, whole: [u32; 2], tile: &mut FilmTile, scratch: &mut Enlargement) {
    simd.vectorize(
        #[inline(always)]
        || {
            let Enlargement { across, rows } = scratch;
            across.clear();
            across.extend((tile.x..tile.x + tile.width).map(|x| Between::of(x, whole[0], small.width())));
            let tile_top = tile.y;
            let down = |y: usize| Between::of(tile_top + y, whole[1], small.height());
            let (top, bottom) = (down(0).first, down(tile.height - 1).second);
            rows.clear();
            for y in top..=bottom {
                rows.push(widened(small, y, across));
            }
            for y in 0..tile.height {
                let Between { first, second, share } = down(y);
                let (above, below) = (&rows[first - top], &rows[second - top]);
                let mut row = [0.0; 3 * TILE];
                for (value, (above, below)) in row.iter_mut().zip(above.iter().zip(below)) {
                    *value = above + (below - above) * share;
                }
                for x in (0..tile.width).step_by(PACKET) {
                    let channels = [0, TILE, 2 * TILE].map(|channel| &row[channel + x..channel + x + PACKET]);
                    tile.color.set_side_by_side(sample_at(x, y) as usize, channels);
                }
            }
            store_planes(small, tile, across, down);
            store_ledger(small, whole, tile);
        },
    );
}

/// A row of the smaller picture at the tile's width.
#[inline(always)]
fn widened(small: &Film, y: usize, across: &[Between]) -> [f32; 3 * TILE] {
    let mut row = [0.0; 3 * TILE];
    let color = |x: usize| small.color(x as u32, y as u32);
    // Neighbours share places: each colour is looked up once.
    let (mut places, mut colors) = ([usize::MAX; 2], [[0.0; 3]; 2]);
    for (x, &Between { first, second, share }) in across.iter().enumerate() {
        if [first, second] != places {
            let left = if first == places[1] { colors[1] } else { color(first) };
            (places, colors) = ([first, second], [left, color(second)]);
        }
        for channel in 0..3 {
            let (left, right) = (colors[0][channel], colors[1][channel]);
            row[channel * TILE + x] = left + (right - left) * share;
        }
    }
    row
}

/// The planes that the film keeps: what the nearest pixel of the smaller picture sees.
fn store_planes(small: &Film, tile: &mut FilmTile, across: &[Between], down: impl Fn(usize) -> Between) {
    let planes = small.planes();
    if !planes.any_seen() {
        return;
    }
    for pixel in 0..tile.width * tile.height {
        let (x, y) = (across[pixel % tile.width].nearest() as u32, down(pixel / tile.width).nearest() as u32);
        let (depth, normal) = (tile.depth.get_mut(pixel), tile.normal.get_mut(pixel));
        let (object, primitive) = (tile.object.get_mut(pixel), tile.primitive.get_mut(pixel));
        put(depth, small.depth(x, y));
        put(normal, small.normal(x, y));
        put(object, small.object(x, y));
        put(primitive, small.primitive(x, y));
    }
}

/// How the pixels were obtained, and their rays: those of the smaller picture's pixels are where their centres lie, all
/// between them are interpolated.
fn store_ledger(small: &Film, whole: [u32; 2], tile: &mut FilmTile) {
    if tile.decision.is_empty() && tile.cost.is_empty() {
        return;
    }
    for pixel in 0..tile.width * tile.height {
        let x = own(tile.x + pixel % tile.width, whole[0], small.width());
        let place = x.zip(own(tile.y + pixel / tile.width, whole[1], small.height()));
        put(tile.decision.get_mut(pixel), place.map_or(Some(Obtained::ENLARGED), |(x, y)| small.decision(x, y)));
        put(tile.cost.get_mut(pixel), place.map_or(Some(0), |(x, y)| small.cost(x, y)));
    }
}

fn put<T>(place: Option<&mut T>, value: Option<T>) {
    if let (Some(place), Some(value)) = (place, value) {
        *place = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_lie_where_the_smaller_picture_has_them() {
        // Twice as large: a quarter of a small pixel off its centre, and never beyond the border.
        let places = [0, 1, 2, 7].map(|at| Between::of(at, 8, 4)).map(|b| (b.first, b.second, b.share));
        assert_eq!(places, [(0, 1, 0.0), (0, 1, 0.25), (0, 1, 0.75), (3, 3, 0.0)]);
        assert_eq!(Between::of(5, 8, 8).nearest(), 5);
        for [size, small] in [[8, 4], [7, 5], [5, 5], [9, 1], [640, 449]] {
            let own: Vec<u32> = (0..size).filter_map(|at| own(at as usize, size, small)).collect();
            assert!(own.iter().copied().eq(0..small), "{small} of {size}: {own:?}");
        }
        assert_eq!([scaled(1280, 0.5), scaled(3, 0.1), scaled(7, 1.0)], [640, 1, 7]);
    }
}
