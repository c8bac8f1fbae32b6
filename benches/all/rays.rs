//! Rays to trace.

use crate::shapes::random_point;
use glam::Vec3;

/// Rays, coordinate by coordinate, a multiple of every packet's size.
pub struct Rays {
    pub origin: [Vec<f32>; 3],
    pub direction: [Vec<f32>; 3],
}

/// How many rays there are.
pub const COUNT: usize = 4096;

impl Rays {
    fn new(ray: impl Fn(usize) -> (Vec3, Vec3)) -> Self {
        let (origins, directions): (Vec<Vec3>, Vec<Vec3>) = (0..COUNT).map(ray).unzip();
        let columns = |of: &[Vec3]| std::array::from_fn(|axis| of.iter().map(|v| v[axis]).collect());
        Self { origin: columns(&origins), direction: columns(&directions) }
    }

    /// From one eye through neighbouring pixels of a square, towards the origin.
    pub fn coherent(eye: Vec3) -> Self {
        let side = COUNT.isqrt();
        let (forward, right) = (-eye.normalize(), Vec3::Y.cross(eye).normalize());
        let up = right.cross(forward);
        Self::new(|i| {
            let [x, y] = [i % side, i / side].map(|at| at as f32 / side as f32 - 0.5);
            (eye, (forward + (right * x + up * y) * 0.8).normalize())
        })
    }

    /// From anywhere to anywhere.
    pub fn incoherent() -> Self {
        let state = std::cell::Cell::new(3);
        let point = || {
            let mut now = state.get();
            let point = random_point(&mut now);
            state.set(now);
            point
        };
        Self::new(|_| {
            let (from, to) = (point(), point());
            (from * 2.0, (to - from * 2.0).normalize_or(Vec3::X))
        })
    }
}
