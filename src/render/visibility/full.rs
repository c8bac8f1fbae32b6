//! `--visibility full`: a ray for every sample. The reference.

use super::{Pass, Worker, shade_queue, trace_pixels};
use crate::render::film::TILE;
use crate::render::frame::Frame;
use crate::render::samples::pixel_at;
use fearless_simd::Simd;

pub(super) fn render<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    find(simd, frame, pass, worker);
    shade_queue(simd, frame, worker);
    worker.stats.pixels.traced += (pass.width * pass.height) as u64;
}

/// Leaves the hits of all samples in `worker.rays`.
pub(super) fn find<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    let mut pixels = std::mem::take(&mut worker.cells.pixels);
    pixels.clear();
    // In the order of their numbers: the rays of a packet stay close together, and their colours side by side.
    for sample in 0..(TILE * TILE) as u32 {
        let [x, y] = pixel_at(sample);
        if usize::from(x) < pass.width && usize::from(y) < pass.height {
            pixels.push([x, y]);
        }
    }
    trace_pixels(simd, frame, pass, &pixels, worker);
    worker.cells.pixels = pixels;
}
