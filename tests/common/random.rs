//! Numbers that look random and are the same on every run.

use glam::{DVec3, Vec3};

/// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [min, max).
    pub fn within(&mut self, min: f64, max: f64) -> f64 {
        min + (max - min) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// One of 0..count.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// Log-uniform between two powers of ten.
    pub fn magnitude(&mut self, min: f64, max: f64) -> f64 {
        10_f64.powf(self.within(min, max))
    }

    /// True with a probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.within(0.0, 1.0) < probability
    }

    /// 1 or -1.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// One of some values.
    pub fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())]
    }

    /// A point in the box from -`half` to `half`.
    pub fn point(&mut self, half: f64) -> DVec3 {
        DVec3::new(self.within(-half, half), self.within(-half, half), self.within(-half, half))
    }

    /// A point in a box.
    pub fn inside(&mut self, min: Vec3, max: Vec3) -> Vec3 {
        let mut along = |axis: usize| self.within(min[axis].into(), max[axis].into()) as f32;
        Vec3::new(along(0), along(1), along(2))
    }

    /// A unit vector.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.point(1.0);
            if (1e-3..=1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }
}
