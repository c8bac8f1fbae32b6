//! How a method's picture changes from frame to frame beyond what it should: the flicker of a moving camera.
//!
//! Of frames `I` and references `R` for the same moments the error is `E = I - R`. What the reference changes by itself
//! cancels: (I' - I) - (R' - R) = E' - E. So only errors are kept, in steps of an 8-bit sRGB channel (1/255 of its range).

use super::pops::{Pops, Seen, is_visibly_wrong};
use serde::Serialize;

/// How the errors of a run changed from each frame to the next.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Motion {
    /// Mean over all channels of all pixels of |(I' - I) - (R' - R)|, in 1/255 of a channel's range.
    pub excess_temporal_change: f64,
    /// Pixels a frame whose error came to exceed 2/255 in some channel, or ceased to: the mean of all changes of frame.
    pub pops_mean: f64,
    /// The most pops of any change of frame.
    pub pops_max: u64,
    /// Frames that were compared.
    pub frames: u64,
}

/// How far a run's frames were from their references, in the units of `raywalk compare`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RunError {
    /// Root mean square error of all channels of all frames, 0 to 1.
    pub rmse: f64,
    /// The greatest error of any channel, 0 to 1.
    pub max_abs: f64,
    /// Pixels a frame with any channel off by more than 2/255, in the mean.
    pub pixels_off: f64,
}

/// Takes the frames of a run one after another.
#[derive(Clone, Debug, Default)]
pub struct MotionMeter {
    /// I - R of the last frame, three channels a pixel.
    errors: Vec<i16>,
    frames: u64,
    /// Sums over all frames: of squared errors, and of pixels off.
    squares: u64,
    pixels_off: u64,
    greatest: u8,
    followed: Pops,
    /// Sums over all changes of frame.
    changes: u64,
    pops: u64,
    pops_max: u64,
}

impl MotionMeter {
    /// Takes the next frame and its reference: RGBA, 8-bit sRGB, all of one size. Alpha is left out.
    pub fn add(&mut self, picture: &[u8], reference: &[u8]) {
        assert_eq!(picture.len(), reference.len(), "a frame and its reference have one size");
        let first = self.frames == 0;
        self.errors.resize(picture.len() / 4 * 3, 0);
        let pixels = || picture.as_chunks::<4>().0.iter().zip(reference.as_chunks::<4>().0);
        for ((picture, reference), errors) in pixels().zip(self.errors.as_chunks_mut::<3>().0) {
            for ((&value, &wanted), error) in picture.iter().zip(reference).zip(errors) {
                let last = std::mem::replace(error, i16::from(value) - i16::from(wanted));
                self.greatest = self.greatest.max(value.abs_diff(wanted));
                self.squares += u64::from(error.unsigned_abs()).pow(2);
                if !first {
                    self.changes += u64::from((*error - last).unsigned_abs());
                }
            }
        }
        let Seen { pixels_off, pops } = self.followed.add(pixels().map(|(a, b)| is_visibly_wrong(a, b)));
        self.pixels_off += pixels_off;
        self.pops += pops;
        self.pops_max = self.pops_max.max(pops);
        self.frames += 1;
    }

    /// The changes; `None` where less than two frames were taken.
    pub fn motion(&self) -> Option<Motion> {
        let changes = self.frames.checked_sub(1).filter(|&changes| changes > 0)? as f64;
        Some(Motion {
            excess_temporal_change: self.changes as f64 / (changes * self.errors.len().max(1) as f64),
            pops_mean: self.pops as f64 / changes,
            pops_max: self.pops_max,
            frames: self.frames,
        })
    }

    /// The errors; all zero for no frames.
    pub fn error(&self) -> RunError {
        let frames = self.frames.max(1) as f64;
        RunError {
            rmse: (self.squares as f64 / (frames * self.errors.len().max(1) as f64)).sqrt() / 255.0,
            max_abs: f64::from(self.greatest) / 255.0,
            pixels_off: self.pixels_off as f64 / frames,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grey row of pixels.
    fn row(values: &[u8]) -> Vec<u8> {
        values.iter().flat_map(|&value| [value, value, value, 255]).collect()
    }

    fn meter(frames: &[(&[u8], &[u8])]) -> MotionMeter {
        let mut meter = MotionMeter::default();
        frames.iter().for_each(|(picture, reference)| meter.add(&row(picture), &row(reference)));
        meter
    }

    #[test]
    fn the_references_own_motion_is_no_error() {
        let meter = meter(&[(&[10, 200, 0], &[10, 200, 0]), (&[90, 7, 255], &[90, 7, 255])]);
        let none = Motion { excess_temporal_change: 0.0, pops_mean: 0.0, pops_max: 0, frames: 2 };
        assert_eq!((meter.motion(), meter.error()), (Some(none), RunError::default()));
    }

    #[test]
    fn an_error_that_stays_does_not_flicker() {
        let meter = meter(&[(&[15, 50], &[10, 50]), (&[105, 60], &[100, 60]), (&[205, 70], &[200, 70])]);
        let motion = meter.motion().expect("three frames");
        assert_eq!((motion.excess_temporal_change, motion.pops_max, motion.frames), (0.0, 0, 3));
        let error = meter.error();
        assert_eq!((error.max_abs, error.pixels_off), (5.0 / 255.0, 1.0));
        assert!((error.rmse - 12.5_f64.sqrt() / 255.0).abs() < 1e-12);
    }

    #[test]
    fn an_error_that_comes_and_goes_pops_each_time() {
        // The first pixel is off by 6, then right, then off by 6 to the other side; the second by 2, which is not seen.
        let meter = meter(&[(&[56, 52], &[50, 50]), (&[50, 50], &[50, 50]), (&[44, 52], &[50, 50])]);
        let motion = meter.motion().expect("three frames");
        assert_eq!((motion.pops_mean, motion.pops_max), (1.0, 1));
        assert_eq!(motion.excess_temporal_change, (6.0 + 2.0 + 6.0 + 2.0) / 4.0);
        assert_eq!(meter.error().pixels_off, 2.0 / 3.0);
    }

    #[test]
    fn pops_are_told_in_the_mean_and_at_their_worst() {
        let right: &[u8] = &[100; 4];
        let meter = meter(&[(right, right), (&[103, 97, 110, 100], right), (&[103, 97, 110, 100], right)]);
        let motion = meter.motion().expect("three frames");
        assert_eq!((motion.pops_mean, motion.pops_max), (1.5, 3));
    }

    #[test]
    fn one_channel_is_enough_and_alpha_is_none() {
        let mut meter = MotionMeter::default();
        meter.add(&[10, 20, 30, 255], &[10, 20, 30, 0]);
        meter.add(&[10, 23, 30, 255], &[10, 20, 30, 0]);
        let motion = meter.motion().expect("two frames");
        assert_eq!((motion.excess_temporal_change, motion.pops_max), (1.0, 1));
    }

    #[test]
    fn one_frame_has_an_error_but_no_motion() {
        let meter = meter(&[(&[0], &[255])]);
        assert_eq!(meter.motion(), None);
        assert_eq!(meter.error(), RunError { rmse: 1.0, max_abs: 1.0, pixels_off: 1.0 });
        assert_eq!(MotionMeter::default().motion(), None);
    }
}
