//! Numbers for tests that look random and are the same on every run.

/// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
pub struct SplitMix64(pub u64);

impl SplitMix64 {
    /// Uniform in [min, max).
    pub fn within(&mut self, min: f64, max: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        min + (max - min) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
