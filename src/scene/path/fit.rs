//! From a camera's places, moment by moment, to the few keys of a path that leads through all of them.

use super::curve::Stretch;
use super::{CameraPath, Key};
use crate::scene::Camera;
use crate::scene::camera::shortest;
use glam::DVec3;

/// Samples from one key that is made in any case to the next: what is tried between them stays short, however the
/// samples are spread.
const CHUNK: usize = 256;

/// Where a camera was at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// In seconds.
    pub t: f64,
    /// The camera.
    pub camera: Camera,
}

/// How far a path may be from what it was made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of the eye, in metres.
    pub distance: f64,
    /// Of the view, and of the field of view, in degrees.
    pub angle: f64,
}

impl CameraPath {
    /// The path through `samples`, in ascending order of time, `None` without any. At none of their moments is it farther
    /// from them than the tolerance, and up is what it was then.
    pub fn fitted(samples: &[Sample], fps: f64, tolerance: Tolerance) -> Option<Self> {
        let last = samples.len().checked_sub(1)?;
        let mut fit = Fit { samples, tolerance, keys: samples.iter().map(Key::of).collect(), kept: Vec::new() };
        let leads_elsewhere = |i: usize| {
            let turns_over = |a: usize, b: usize| samples[a].camera.up != samples[b].camera.up;
            (i > 0 && turns_over(i - 1, i)) || (i < last && turns_over(i, i + 1))
        };
        fit.kept = (0..=last).filter(|&i| i % CHUNK == 0 || i == last || leads_elsewhere(i)).collect();
        fit.refine();
        let Fit { mut keys, kept, .. } = fit;
        let mut kept = kept.into_iter().peekable();
        let mut index = 0..;
        keys.retain(|_| kept.next_if_eq(&index.next().unwrap_or(usize::MAX)).is_some());
        Some(Self { fps, keys })
    }
}

/// A path that is being found.
struct Fit<'a> {
    samples: &'a [Sample],
    tolerance: Tolerance,
    /// One a sample.
    keys: Vec<Key>,
    /// Those that make the path, in ascending order.
    kept: Vec<usize>,
}

impl Fit<'_> {
    /// Keeps more keys until the path is near enough to all samples.
    fn refine(&mut self) {
        // Stretches that are not known to be near enough, by their first key.
        let mut unknown = vec![true; self.kept.len()];
        loop {
            // What is kept next, and which of that is new.
            let (mut kept, mut is_new) = (Vec::new(), Vec::new());
            for (j, &i) in self.kept.iter().enumerate() {
                kept.push(i);
                is_new.push(false);
                if unknown[j]
                    && let Some(worst) = self.worst_after(j)
                {
                    kept.push(worst);
                    is_new.push(true);
                }
            }
            if kept.len() == self.kept.len() {
                return;
            }
            // A stretch depends on the keys at its ends and on their neighbours.
            let around = |j: usize| j.saturating_sub(1)..(j + 3).min(is_new.len());
            unknown = (0..kept.len()).map(|j| is_new[around(j)].contains(&true)).collect();
            self.kept = kept;
        }
    }

    /// Of the samples after the `j`th key that is kept, before the next, the one that the path is farthest from, if that
    /// is beyond the tolerance.
    fn worst_after(&self, j: usize) -> Option<usize> {
        let [first, end] = [*self.kept.get(j)?, *self.kept.get(j + 1)?];
        let key = |j: usize| self.kept.get(j).map(|&i| &self.keys[i]);
        let neighbours = [j.checked_sub(1).and_then(key), key(j + 2)];
        // All of these keys have a field of view.
        let stretch = Stretch::between(neighbours, &self.keys[first], &self.keys[end], 0.0);
        let inner = (first + 1..end).map(|i| (i, self.error(&stretch, &self.samples[i])));
        inner.filter(|(_, error)| *error > 1.0).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
    }

    /// How far a stretch is from a sample, in tolerances.
    fn error(&self, stretch: &Stretch, sample: &Sample) -> f64 {
        let (there, here) = (&sample.camera, stretch.camera(sample.t, &sample.camera, DVec3::ZERO));
        let view = |camera: &Camera| (camera.look_at.as_dvec3() - camera.eye.as_dvec3()).normalize_or_zero();
        let distance = here.eye.as_dvec3().distance(there.eye.as_dvec3());
        // The chord, which is told apart from 0 where the cosine is not.
        let turned = view(&here).distance(view(there)).to_degrees();
        let zoomed = f64::from((here.fov - there.fov).abs());
        (distance / self.tolerance.distance).max(turned.max(zoomed) / self.tolerance.angle)
    }
}

impl Key {
    fn of(sample: &Sample) -> Self {
        let Camera { eye, look_at, fov, up, .. } = sample.camera;
        Self {
            t: sample.t,
            position: eye.to_array().map(shortest),
            look_at: look_at.to_array().map(shortest),
            fov: Some(shortest(fov)),
            up: Some(up.to_array().map(shortest)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::READABLE_KEYS;
    use super::*;
    use crate::math::random::SplitMix64;
    use crate::temporary::Folder;
    use glam::Vec3;
    use std::path::Path;

    const TOLERANCE: Tolerance = Tolerance { distance: 2e-3, angle: 0.05 };

    /// Someone who stands, walks, turns while walking, stops and zooms, at irregular moments.
    fn walk() -> Vec<Sample> {
        let mut samples = Vec::new();
        let (mut t, mut eye, mut yaw, mut fov) = (0.0, Vec3::new(3.0, 1.6, -2.0), 20.0, 60.0);
        for i in 0_u32..1500 {
            let step = 0.006 + 0.004 * f64::from(i * 7 % 5);
            t = f64::round((t + step) * 1e6) / 1e6;
            match i / 300 {
                1 => eye.z -= 2.5 * step as f32,
                2 => {
                    yaw += 90.0 * step as f32;
                    eye += Vec3::new(-yaw.to_radians().sin(), 0.0, -yaw.to_radians().cos()) * 2.5 * step as f32;
                }
                3 => fov = 60.0 - (i - 900) as f32 * 0.05,
                _ => {}
            }
            samples.push(Sample { t, camera: Camera::from_yaw_pitch(eye, yaw, -10.0, fov) });
        }
        samples
    }

    #[test]
    fn what_is_written_and_read_again_goes_where_one_went() {
        let samples = walk();
        let path = CameraPath::fitted(&samples, 60.0, TOLERANCE).expect("there are samples");
        assert!(path.keys.len() < samples.len() / 5, "{} keys", path.keys.len());
        let read = CameraPath::parse(&path.to_json(), Path::new("walk.json")).expect("it is a path");
        assert_eq!(read, path);
        let other = Camera { up: Vec3::X, ..Camera::default() };
        for sample in &samples {
            let camera = read.camera_at(sample.t, &other, DVec3::ZERO);
            assert!(camera.eye.distance(sample.camera.eye) <= 2e-3, "at {}: {camera:?} {sample:?}", sample.t);
            let [a, b] = [&camera, &sample.camera].map(|camera| camera.frame(8, 8).forward);
            assert!(a.distance(b) <= 0.05_f32.to_radians(), "at {}: {a} {b}", sample.t);
            assert!((camera.fov - sample.camera.fov).abs() <= 0.05);
            assert_eq!(camera.up, Vec3::Y, "its own, whatever the scene's camera has");
        }
    }

    #[test]
    fn a_moment_is_a_path_and_nothing_is_none() {
        assert_eq!(CameraPath::fitted(&[], 60.0, TOLERANCE), None);
        let path = CameraPath::fitted(&walk()[..1], 60.0, TOLERANCE).expect("there is one");
        assert_eq!(path.frame_count(), 1);
    }

    #[test]
    fn a_leap_is_kept() {
        let at = |t: f64, x: f32| Sample { t, camera: Camera::from_yaw_pitch(Vec3::X * x, 0.0, 0.0, 60.0) };
        let samples: Vec<Sample> =
            (0..200).map(|i| at(f64::from(i) / 100.0, if i < 100 { 0.0 } else { 50.0 })).collect();
        let path = CameraPath::fitted(&samples, 60.0, TOLERANCE).expect("there are samples");
        for sample in &samples[99..=100] {
            assert_eq!(path.camera_at(sample.t, &Camera::default(), DVec3::ZERO), sample.camera);
        }
        assert!(path.keys.len() < 20, "{}", path.keys.len());
    }
    #[test]
    fn a_leap_to_a_view_with_another_up_is_a_leap_of_up() {
        let tilted = Camera { up: Vec3::new(1.0, 2.0, 0.0), ..Camera::default() };
        let at = |i: u32| Sample {
            t: f64::from(i) / 100.0,
            camera: if (70..130).contains(&i) { tilted } else { Camera::default() },
        };
        let samples: Vec<Sample> = (0..200).map(at).collect();
        let path = CameraPath::fitted(&samples, 60.0, TOLERANCE).expect("there are samples");
        let read = CameraPath::parse(&path.to_json(), Path::new("walk.json")).expect("it is a path");
        for sample in &samples {
            assert_eq!(read.camera_at(sample.t, &Camera::default(), DVec3::ZERO), sample.camera, "at {}", sample.t);
        }
        assert!(path.keys.len() < 10, "{} keys", path.keys.len());
    }

    /// A hand at a mouse that never rests: nearly every sample is a key.
    #[test]
    fn the_longest_walk_is_fitted_and_read_back() {
        let mut random = SplitMix64(1);
        let mut yaw = 0.0_f32;
        let mut sample = |i: usize| {
            yaw += random.within(-0.4, 0.4) as f32;
            let eye = Vec3::new(-123.456_7, 1.6, 0.000_123_4 * i as f32);
            Sample { t: i as f64 * 8_333.0 / 1e6, camera: Camera::from_yaw_pitch(eye, yaw, -10.0, 59.9) }
        };
        let samples: Vec<Sample> = (0..READABLE_KEYS).map(&mut sample).collect();
        let path = CameraPath::fitted(&samples, 60.0, TOLERANCE).expect("there are samples");
        assert!(path.keys.len() > READABLE_KEYS / 2, "{} keys", path.keys.len());
        let folder = Folder::new();
        let file = folder.write("walk.json", path.to_json());
        assert_eq!(CameraPath::load(&file).expect("it can be read"), path);
    }
}
