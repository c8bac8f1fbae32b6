//! `--visibility full`: a ray for every sample. The reference.

use super::{Pass, Worker, queue_tile, shade_queue};
use crate::render::frame::Frame;
use crate::render::tile::milliseconds_since;
use crate::render::trace;
use fearless_simd::Simd;
use std::time::Instant;

pub(super) fn render<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    find(simd, frame, pass, worker);
    shade_queue(simd, frame, worker);
    worker.stats.pixels.traced += (pass.width * pass.height) as u64;
}

/// Leaves the hits of all samples in `worker.rays`.
pub(super) fn find<S: Simd>(simd: S, frame: &Frame<'_>, pass: &Pass, worker: &mut Worker) {
    let start = Instant::now();
    queue_tile(simd, frame, pass, worker);
    trace::primary_hits(simd, frame, worker);
    worker.stats.stages_ms.visibility += milliseconds_since(start);
}
