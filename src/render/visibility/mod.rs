//! What each sample of a tile sees: one file for each way of finding out.

mod certified;
mod full;
mod grids;
mod order;
mod smooth;
mod subsample;

pub use certified::Levels;
pub(super) use grids::render_grids;
pub use grids::{GRID, GRID_SIDE};
pub use order::Order;
pub(super) use smooth::POINTS;
pub use smooth::Smooth;
pub use subsample::Cells;

use super::frame::Frame;
use super::tile::{Pass, Seen, Worker, milliseconds_since};
use super::trace;
use crate::settings::{Fill, Visibility};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use std::time::Instant;

/// Fills in the colours and what is seen, for all samples of a pass.
pub(super) fn render_pass<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    match frame.settings.visibility {
        Visibility::Certified if frame.settings.fill == Fill::Color => smooth::render(simd, frame, pass, worker),
        Visibility::Certified => certified::render(simd, frame, pass, worker),
        Visibility::Full => full::render(simd, frame, pass, worker),
        Visibility::Subsample => subsample::render(simd, frame, pass, worker),
    }
}

/// Fills in what is seen, not the colours, for planes alone: the pixels are counted by the passes that make the picture.
pub(super) fn find_all<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    let (pixels, certificates) = (worker.stats.pixels, worker.stats.certificates);
    match frame.settings.visibility {
        Visibility::Certified => certified::find(simd, frame, pass, worker),
        Visibility::Full | Visibility::Subsample => full::find(simd, frame, pass, worker),
    }
    (worker.stats.pixels, worker.stats.certificates) = (pixels, certificates);
    super::shade::store_seen(simd, frame, worker);
}

/// Traces the given pixels (in the tile's own coordinates) and leaves their hits in `worker.rays`.
fn trace_pixels<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, pixels: &[[u16; 2]], worker: &mut Worker) {
    let start = Instant::now();
    queue_pixels(simd, frame, pass, pixels, worker);
    trace::primary_hits(simd, frame, worker);
    worker.stats.stages_ms.visibility += milliseconds_since(start);
}

/// Shades the hits in `worker.rays`, whose samples start from black.
fn shade_queue<S: Simd>(simd: S, frame: &Frame<'_>, worker: &mut Worker) {
    note_seen(frame, worker);
    worker.shade_paths(simd, frame);
}

/// Notes what the rays in `worker.rays` see, if anybody asks for it; normals follow when they are shaded.
fn note_seen(frame: &Frame<'_>, worker: &mut Worker) {
    if frame.keeps_seen {
        for at in 0..worker.rays.len() {
            let sample = worker.rays.sample[at] as usize;
            worker.seen[sample] = Seen { primitive: worker.rays.primitive[at], t: worker.rays.t[at], normal: [0.0; 3] };
        }
    }
}

/// Replaces `worker.rays` by rays from the eye through the given pixels.
fn queue_pixels<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, pixels: &[[u16; 2]], worker: &mut Worker) {
    let media = worker.media.restart(frame.around_eye);
    let rays = &mut worker.rays;
    rays.clear();
    append_pixels(simd, frame, pass, pixels, media, rays);
}

/// Replaces `worker.rays` by rays from the eye through all pixels of the tile, in order.
fn queue_tile<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    let media = worker.media.restart(frame.around_eye);
    let Worker { rays, order, .. } = worker;
    order.prepare(pass.width, pass.height);
    rays.clear();
    let first = rays.extend_from_eye(frame.camera.eye, media, order.samples.len());
    rays.sample[..order.samples.len()].copy_from_slice(&order.samples);
    for (column, places, corner) in
        [(&mut rays.direction.x, &order.x, pass.x), (&mut rays.direction.y, &order.y, pass.y)]
    {
        for (at, place) in column.iter_mut().zip(places) {
            *at = corner as f32 + place;
        }
    }
    aim(simd, frame, pass.offset, first, rays);
}

/// Appends rays from the eye through the given pixels.
fn append_pixels<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    pass: &Pass,
    pixels: &[[u16; 2]],
    media: u32,
    rays: &mut super::queue::RayQueue,
) {
    let first = rays.extend_from_eye(frame.camera.eye, media, pixels.len());
    for (at, &[x, y]) in (first..).zip(pixels) {
        rays.sample[at] = super::samples::sample_at(x.into(), y.into());
        // The direction's columns hold the picture coordinates until `aim` turns them into directions.
        rays.direction.x[at] = (pass.x + usize::from(x)) as f32;
        rays.direction.y[at] = (pass.y + usize::from(y)) as f32;
    }
    aim(simd, frame, pass.offset, first, rays);
}

/// Turns picture coordinates into unit directions:
/// f + (2(x + ox)/W - 1) right + (1 - 2(y + oy)/H) up, normalised.
fn aim<S: Simd>(simd: S, frame: &Frame<'_>, offset: [f32; 2], first: usize, rays: &mut super::queue::RayQueue) {
    simd.vectorize(
        #[inline(always)]
        || {
            let camera = &frame.camera;
            let forward = crate::math::V3::<S::f32s>::splat(simd, camera.forward);
            let right = crate::math::V3::splat(simd, camera.right);
            let up = crate::math::V3::splat(simd, camera.up);
            let one = S::f32s::splat(simd, 1.0);
            let (width, height) = (camera.width as f32, camera.height as f32);
            for at in (first..rays.len()).step_by(S::f32s::LEN) {
                let pixel = rays.direction.load(simd, at);
                let across = (pixel.x + offset[0]) * 2.0 / width - one;
                let down = one - (pixel.y + offset[1]) * 2.0 / height;
                let direction = (forward + right.scale(across) + up.scale(down)).normalize();
                rays.direction.store::<S>(at, direction);
            }
        },
    );
}
