//! What the paths of each sample met, as one number: pixels whose numbers differ saw different things (after the trees
//! of objects that Akimoto, Mase and Suenaga compare in "Pixel-selected ray tracing", IEEE CG&A 11(4), 1991).

use super::queue::RayQueue;
use super::samples::SAMPLES;
use crate::geometry::Geometry;

/// A sum over all that a sample's paths met: the order in which they met it does not matter.
#[derive(Debug, Default)]
pub struct Trails(Vec<u32>);

impl Trails {
    /// Forgets what the samples of some rays from the eye met.
    pub fn restart(&mut self, rays: &RayQueue) {
        self.0.resize(SAMPLES, 0);
        for &sample in &rays.sample[..rays.len()] {
            self.0[sample as usize] = 0;
        }
    }

    /// Notes what the rays of a level below the first hit.
    pub fn note_hits(&mut self, level: u32, rays: &RayQueue, geometry: &Geometry) {
        for (&sample, &primitive) in rays.sample.iter().zip(&rays.primitive).take(rays.len()) {
            let object = geometry.id(primitive).map_or(u32::MAX, |id| id.object);
            self.note(sample, [level, object]);
        }
    }

    /// Notes which light reaches the samples of the lanes in the bit set `lit`.
    #[inline(always)]
    pub fn note_light(&mut self, light: usize, samples: &[u32], mut lit: u64) {
        while lit != 0 {
            self.note(samples[lit.trailing_zeros() as usize], [0, light as u32]);
            lit &= lit - 1;
        }
    }

    #[inline(always)]
    fn note(&mut self, sample: u32, [kind, number]: [u32; 2]) {
        // Odd factors with well-mixed bits (Steele and Vigna, "Computationally easy, spectrally good multipliers", 2022).
        let mixed = (number.wrapping_add(1).wrapping_mul(0x9E37_79B1) ^ kind.wrapping_mul(0x915F_77F5)).rotate_left(15);
        let sum = &mut self.0[sample as usize];
        *sum = sum.wrapping_add(mixed.wrapping_mul(0x93D7_65DD));
    }

    /// What a sample's paths met.
    pub fn of(&self, sample: usize) -> u32 {
        self.0[sample]
    }

    /// Makes a sample that was filled in look like another.
    pub fn copy(&mut self, from: usize, to: usize) {
        self.0[to] = self.0[from];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_met_counts_and_its_order_does_not() {
        let mut trails = Trails(vec![0; 4]);
        for (sample, met) in
            [vec![[0, 1], [2, 7]], vec![[2, 7], [0, 1]], vec![[2, 1], [0, 7]], vec![[0, 1]]].iter().enumerate()
        {
            for &thing in met {
                trails.note(sample as u32, thing);
            }
        }
        assert_eq!(trails.of(0), trails.of(1));
        assert!(trails.of(0) != trails.of(2) && trails.of(0) != trails.of(3));
    }
}
