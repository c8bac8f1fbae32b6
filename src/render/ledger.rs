//! How each pixel was obtained, and the rays it took: for films that keep such planes.
//!
//! Visibility notes what it decided by cells and by lists, as it needs to anyway; a tile's plane is filled in from these once
//! its last pass is done. Rays are counted queue by queue, for the samples that they belong to.

use super::film::{FilmTile, TILE};
use super::frame::Frame;
use super::samples::{CELL, SAMPLES, pixel_at, sample_at};
use super::tile::Worker;
use super::visibility::GRID;
use crate::settings::{Fill, Supersample, Visibility};

/// How a pixel was obtained. Of a film, as many pixels have each as [`PixelCounts`](super::stats::PixelCounts) counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Decision {
    /// By a ray of its own.
    Traced,
    /// From a candidate list or a known primitive.
    Resolved,
    /// Proven by its block.
    Certified,
    /// Interpolated from neighbours.
    Interpolated,
}

impl Decision {
    /// All of them, in the order in which they are counted.
    pub const ALL: [Self; 4] = [Self::Traced, Self::Resolved, Self::Certified, Self::Interpolated];
}

/// What a film keeps of how a pixel was obtained: the decision for the ray through its centre, of a regular grid of rays the
/// last one, and whether there were more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Obtained {
    /// How one ray of it was.
    pub decision: Decision,
    /// It got more than one ray.
    pub supersampled: bool,
}

impl Obtained {
    /// Before the first frame.
    pub(super) const NOTHING: Self = Self { decision: Decision::Traced, supersampled: false };
    /// Of a pixel between those of a smaller picture.
    pub(super) const ENLARGED: Self = Self { decision: Decision::Interpolated, supersampled: false };
}

/// The rays of a tile's samples.
#[derive(Debug, Default)]
pub struct Ledger {
    rays: Vec<u32>,
}

impl Ledger {
    /// Makes ready for a tile.
    pub fn begin_tile(&mut self) {
        self.rays.clear();
        self.rays.resize(SAMPLES, 0);
    }

    /// Counts a ray for each of the samples.
    pub fn add_all(&mut self, samples: &[u32]) {
        for &sample in samples {
            self.rays[sample as usize] += 1;
        }
    }

    /// Counts a ray for the samples of the lanes in the bit set `lanes`.
    #[cold]
    #[inline(never)]
    pub fn add_lanes(&mut self, samples: &[u32], lanes: u64) {
        for (lane, &sample) in samples.iter().enumerate() {
            self.rays[sample as usize] += (lanes >> lane & 1) as u32;
        }
    }
}

impl FilmTile {
    /// Fills in the planes of how the tile's pixels were obtained, if they are kept.
    pub(super) fn store_ledger(&mut self, frame: &Frame<'_>, worker: &Worker) {
        if !self.decision.is_empty() {
            self.store_decisions(frame, worker);
        }
        if !self.cost.is_empty() {
            self.cost.fill(0);
            for (sample, &rays) in worker.ledger.rays.iter().enumerate().filter(|(_, rays)| **rays > 0) {
                // Rays through the next tile's first pixels count for the last ones of this, which they are for.
                let [x, y] = pixel_at(sample as u32).map(|at| usize::from(at).min(TILE - 1));
                self.cost[y * self.width + x] += rays;
            }
        }
    }

    fn store_decisions(&mut self, frame: &Frame<'_>, worker: &Worker) {
        let supersampled = matches!(frame.settings.supersample, Supersample::Grid { .. });
        for y in 0..self.height {
            for x in 0..self.width {
                let decision = decision(frame, worker, sample_at(x, y) as usize);
                self.decision[y * self.width + x] = Obtained { decision, supersampled };
            }
        }
        if frame.settings.visibility == Visibility::Subsample {
            for [x, y] in worker.cells.traced_anew(&worker.order).map(|sample| pixel_at(sample).map(usize::from)) {
                self.decision[y * self.width + x].decision = Decision::Traced;
            }
        }
    }

    /// Notes the pixels that a batch of grids was traced for, and their rays.
    pub(super) fn note_grids(&mut self, batch: &[u32], ledger: &mut Ledger) {
        if self.decision.is_empty() && self.cost.is_empty() {
            return;
        }
        for (grid, &pixel) in batch.iter().enumerate() {
            let [x, y] = pixel_at(pixel).map(usize::from);
            let place = y * self.width + x;
            if let Some(obtained) = self.decision.get_mut(place) {
                obtained.supersampled = true;
            }
            if let Some(cost) = self.cost.get_mut(place) {
                let rays = &mut ledger.rays[grid * GRID..(grid + 1) * GRID];
                *cost += rays.iter().sum::<u32>();
                rays.fill(0);
            }
        }
    }
}

/// How the last pass over a tile obtained a sample of it.
fn decision(frame: &Frame<'_>, worker: &Worker, sample: usize) -> Decision {
    let settings = frame.settings;
    let in_cells = |cells: u64| cells >> (sample / (CELL * CELL)) & 1 == 1;
    match settings.visibility {
        Visibility::Full => Decision::Traced,
        Visibility::Subsample if worker.cells.is_listed(sample) => Decision::Traced,
        Visibility::Subsample if settings.fill == Fill::Color => Decision::Interpolated,
        Visibility::Certified if in_cells(worker.lit_cells) => Decision::Interpolated,
        Visibility::Certified if in_cells(worker.traced_cells) => Decision::Traced,
        Visibility::Certified if in_cells(worker.certain_cells) => Decision::Certified,
        Visibility::Subsample | Visibility::Certified => Decision::Resolved,
    }
}
