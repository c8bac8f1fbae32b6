//! The mean colour of a picture.

use super::{Texels, decode_table};
use glam::Vec3;

/// Most texels along an edge that are looked at.
const MOST: u32 = 64;

impl Texels {
    /// The mean of its linear colours, or nearly so where it is large and has no smaller sizes.
    pub fn mean_color(&self) -> Vec3 {
        let smallest = self.levels() - 1;
        let [width, height] = self.size(smallest);
        let table = decode_table(self.encoding());
        let [step_x, step_y] = [width, height].map(|edge| edge.div_ceil(MOST) as usize);
        let (mut sum, mut count) = (Vec3::ZERO, 0.0);
        for y in (0..height).step_by(step_y) {
            for x in (0..width).step_by(step_x) {
                let [r, g, b, _] = self.texel(smallest, x, y).map(|byte| table[usize::from(byte)]);
                sum += Vec3::new(r, g, b);
                count += 1.0;
            }
        }
        sum / count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::material::Encoding;

    #[test]
    fn the_mean_is_that_of_all_texels_with_and_without_smaller_sizes() {
        let rows: Vec<[u8; 4]> = (0..256).map(|i| if i % 2 == 0 { [255, 0, 0, 255] } else { [0, 0, 255, 0] }).collect();
        for mips in [false, true] {
            let texels = Texels::new(16, 16, &rows, Encoding::Data, mips).unwrap();
            assert!((texels.mean_color() - Vec3::new(0.5, 0.0, 0.5)).abs().max_element() < 0.01);
        }
    }
}
