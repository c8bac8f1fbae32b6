//! `--visibility full`: a ray for every sample. The reference.

use super::{Pass, Worker, shade_queue, trace_pixels};
use crate::render::frame::Frame;
use fearless_simd::Simd;

/// Edge of the blocks in which pixels follow each other, so that the rays of a packet stay close together.
const BLOCK: usize = 4;

pub(super) fn render<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    find(simd, frame, pass, worker);
    shade_queue(simd, frame, worker);
    worker.stats.pixels.traced += (pass.width * pass.height) as u64;
}

/// Leaves the hits of all samples in `worker.rays`.
pub(super) fn find<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    let mut pixels = std::mem::take(&mut worker.cells.pixels);
    pixels.clear();
    for top in (0..pass.height).step_by(BLOCK) {
        for left in (0..pass.width).step_by(BLOCK) {
            for y in top..(top + BLOCK).min(pass.height) {
                pixels.extend((left..(left + BLOCK).min(pass.width)).map(|x| [x as u16, y as u16]));
            }
        }
    }
    trace_pixels(simd, frame, pass, &pixels, worker);
    worker.cells.pixels = pixels;
}
