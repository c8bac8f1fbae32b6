//! A picture that gathers 16 samples a pixel, one a frame: what a window can show of a view at rest.
//!
//! It ends as that of `--supersample 16`, bit for bit: samples are added up in the order of its rows. On the way there
//! every pass should be worth looking at. So one sample of each row and column of the grid is traced ahead of its turn,
//! and stands for those of its row that are missing: after four passes the picture is that of a rotated grid, and at no
//! time does it lean to the side of the rows that are done. Only these four are kept apart, not all sixteen.

use super::samples::Colors;
use crate::settings::Supersample;

/// Samples along one side of a pixel.
pub const SIDE: u32 = Supersample::REFINED_SIDE;

/// The sample of each row that is traced ahead, by its number in row order: no two in one column.
const AHEAD: [u32; SIDE as usize] = [1, 7, 8, 14];

/// The order of tracing: those ahead, opposite ones first, since two of them already lie about the pixel's centre.
const ORDER: [u32; (SIDE * SIDE) as usize] = [1, 14, 7, 8, 0, 2, 3, 4, 5, 6, 9, 10, 11, 12, 13, 15];

/// How far a film has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    passes: usize,
}

impl Progress {
    /// Samples that each pixel has.
    pub fn samples(self) -> u32 {
        self.passes as u32
    }

    /// What the next pass traces: row and column within each pixel. After the last one it begins anew.
    pub fn place(self) -> [u32; 2] {
        let sample = self.sample();
        [sample / SIDE, sample % SIDE]
    }

    /// With one pass more.
    pub fn next(self) -> Self {
        Self { passes: self.passes % ORDER.len() + 1 }
    }

    fn sample(self) -> u32 {
        ORDER[self.passes % ORDER.len()]
    }

    /// How many samples, in row order, are added up.
    fn added(self) -> u32 {
        if self.passes <= AHEAD.len() {
            return 0;
        }
        let mut added = ORDER[self.passes - 1] + 1;
        while AHEAD.contains(&added) {
            added += 1;
        }
        added
    }

    /// How many samples of each row the one that was traced ahead stands for.
    fn missing(self) -> [u32; SIDE as usize] {
        let (mut missing, added) = ([0; SIDE as usize], self.added());
        for &ahead in &ORDER[..self.passes.min(AHEAD.len())] {
            let row = ahead / SIDE;
            missing[row as usize] = SIDE - added.saturating_sub(row * SIDE).min(SIDE);
        }
        missing
    }
}

/// The samples of one tile so far.
#[derive(Debug, Default)]
pub struct Accumulated {
    /// The sum of those whose turn has come.
    sum: Colors,
    /// Those traced ahead, by row.
    ahead: [Colors; SIDE as usize],
}

impl Accumulated {
    /// Takes the samples of the pass after `before`; what `samples` holds then is anything.
    pub fn take(&mut self, before: Progress, samples: &mut Colors) {
        let sample = before.sample();
        if AHEAD.contains(&sample) {
            std::mem::swap(&mut self.ahead[(sample / SIDE) as usize], samples);
            return;
        }
        if sample == 0 {
            self.sum.clear();
        }
        self.sum.add_all(samples);
        for ahead in sample + 1..before.next().added() {
            self.sum.add_all(&self.ahead[(ahead / SIDE) as usize]);
        }
    }

    /// The mean after the passes so far.
    pub fn mean(&self, progress: Progress, mean: &mut Colors) {
        let mut samples = progress.added();
        if samples > 0 {
            mean.copy_from(&self.sum);
        } else {
            mean.clear();
        }
        for (ahead, missing) in self.ahead.iter().zip(progress.missing()) {
            if missing > 0 {
                mean.add_scaled(ahead, missing as f32);
                samples += missing;
            }
        }
        mean.scale(1.0 / samples as f32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Each state on the way, the first one with one pass.
    fn states() -> impl Iterator<Item = Progress> {
        std::iter::successors(Some(Progress::default().next()), |progress| Some(progress.next())).take(ORDER.len())
    }

    #[test]
    fn every_sample_is_traced_once_and_added_in_row_order() {
        let mut order = ORDER;
        order.sort_unstable();
        assert!(order.into_iter().eq(0..SIDE * SIDE));
        let rows_and_columns = |of: fn(u32) -> u32| AHEAD.iter().fold(0, |set, &sample| set | 1 << of(sample));
        assert_eq!((rows_and_columns(|sample| sample / SIDE), rows_and_columns(|sample| sample % SIDE)), (15, 15));
        assert!(AHEAD.iter().enumerate().all(|(row, sample)| sample / SIDE == row as u32));
        let last = states().last().expect("there are passes");
        assert_eq!((last.samples(), last.added(), last.missing()), (16, 16, [0; 4]));
        assert_eq!(last.next().samples(), 1);
    }

    #[test]
    fn a_pass_weighs_all_rows_alike_once_each_has_a_sample() {
        for progress in states().skip(AHEAD.len() - 1) {
            let (added, missing) = (progress.added(), progress.missing());
            for (row, missing) in (0..SIDE).zip(missing) {
                let traced = added.saturating_sub(row * SIDE).min(SIDE);
                assert_eq!(traced + missing, SIDE, "{} samples", progress.samples());
            }
        }
    }

    #[test]
    fn the_end_has_the_bits_of_a_sum_in_row_order() {
        // Their sum depends on the order.
        let value = |sample: u32| Vec3::new(0.1, 1e7, 1e-3) * (1.0 + sample as f32 * 0.37).powi(sample as i32 % 5 - 2);
        let mut accumulated = Accumulated::default();
        let (mut progress, mut mean) = (Progress::default(), Colors::black());
        // Twice: nothing of a picture reaches the next.
        for _ in 0..2 * ORDER.len() {
            let mut samples = Colors::black();
            samples.set(7, value(progress.sample()));
            accumulated.take(progress, &mut samples);
            progress = progress.next();
            accumulated.mean(progress, &mut mean);
            let place = |sample| value(sample).y;
            let (least, most) = (place(0).min(place(2)).min(place(5)), place(14).max(place(9)).max(place(4)));
            assert!((least..=most).contains(&mean.get(7).y), "{} after {}", mean.get(7), progress.samples());
            if progress.samples() == 16 {
                let sum = (0..16).map(value).fold(Vec3::ZERO, |sum, value| sum + value);
                assert_eq!(mean.get(7), sum * (1.0 / 16.0));
            }
        }
    }

    #[test]
    fn equal_samples_have_themselves_as_the_mean() {
        let mut accumulated = Accumulated::default();
        let (mut progress, mut mean) = (Progress::default(), Colors::black());
        for _ in 0..ORDER.len() {
            let mut samples = Colors::black();
            samples.set(0, Vec3::new(0.5, 3.0, 0.25));
            accumulated.take(progress, &mut samples);
            progress = progress.next();
            accumulated.mean(progress, &mut mean);
            assert!(mean.get(0).abs_diff_eq(Vec3::new(0.5, 3.0, 0.25), 1e-6), "{}", progress.samples());
        }
    }
}
