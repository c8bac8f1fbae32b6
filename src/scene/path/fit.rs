//! From a camera's places, moment by moment, to the few keys of a path that leads through all of them.

use super::{CameraPath, Key};
use crate::scene::Camera;

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
    /// from them than the tolerance. What a path says once, such as up, is that of the first sample.
    pub fn fitted(samples: &[Sample], fps: f64, tolerance: Tolerance) -> Option<Self> {
        let (first, last) = (samples.first()?, samples.len() - 1);
        let mut kept = vec![0];
        kept.extend((last > 0).then_some(last));
        let up = Some(first.camera.up.to_array().map(short));
        loop {
            let keys = kept.iter().map(|&i| Key::of(&samples[i])).collect();
            let path = Self { fps, up, keys };
            let missing = path.worst_between(samples, &kept, tolerance);
            if missing.is_empty() {
                return Some(path);
            }
            kept.extend(missing);
            kept.sort_unstable();
        }
    }

    /// Of the samples between each two that are kept, the one that is farthest off, if that is beyond the tolerance.
    fn worst_between(&self, samples: &[Sample], kept: &[usize], tolerance: Tolerance) -> Vec<usize> {
        let error = |i: usize| self.error(&samples[i], tolerance);
        let worst = |pair: &[usize]| {
            let inner = (pair[0] + 1..pair[1]).map(|i| (i, error(i)));
            inner.filter(|(_, error)| *error > 1.0).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
        };
        kept.windows(2).filter_map(worst).collect()
    }

    /// How far the path is from a sample, in tolerances.
    fn error(&self, sample: &Sample, tolerance: Tolerance) -> f64 {
        let (there, here) = (&sample.camera, self.camera_at(sample.t, &sample.camera));
        let view = |camera: &Camera| (camera.look_at.as_dvec3() - camera.eye.as_dvec3()).normalize_or_zero();
        let distance = here.eye.as_dvec3().distance(there.eye.as_dvec3());
        // The chord, which is told apart from 0 where the cosine is not.
        let turned = view(&here).distance(view(there)).to_degrees();
        let zoomed = f64::from((here.fov - there.fov).abs());
        (distance / tolerance.distance).max(turned.max(zoomed) / tolerance.angle)
    }
}

impl Key {
    fn of(sample: &Sample) -> Self {
        let Camera { eye, look_at, fov, .. } = sample.camera;
        Self {
            t: sample.t,
            position: eye.to_array().map(short),
            look_at: look_at.to_array().map(short),
            fov: Some(short(fov)),
        }
    }
}

/// The number that is written with the fewest digits of all that round to this one.
fn short(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::from(number))
}

#[cfg(test)]
mod tests {
    use super::*;
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
            let camera = read.camera_at(sample.t, &other);
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
        assert_eq!(path.error(&samples[99], TOLERANCE).max(path.error(&samples[100], TOLERANCE)), 0.0);
        assert!(path.keys.len() < 20, "{}", path.keys.len());
    }
}
