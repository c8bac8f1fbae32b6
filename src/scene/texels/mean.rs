//! The mean colour of a picture.

use super::{Texels, decode_table};
use glam::Vec3;

/// Most texels along an edge that are looked at.
const MOST: u32 = 64;

impl Texels {
    /// The linear colour that looks as bright as its texels do on the whole: displays show about the square roots of linear
    /// colours, whose mean this is of.
    pub fn mean_color(&self) -> Vec3 {
        let [width, height] = self.size(0);
        let table = decode_table(self.encoding());
        let [step_x, step_y] = [width, height].map(|edge| edge.div_ceil(MOST) as usize);
        let (mut sum, mut count) = (Vec3::ZERO, 0.0);
        for y in (0..height).step_by(step_y) {
            for x in (0..width).step_by(step_x) {
                let [r, g, b, _] = self.texel(0, x, y).map(|byte| table[usize::from(byte)].sqrt());
                sum += Vec3::new(r, g, b);
                count += 1.0;
            }
        }
        let mean = sum / count;
        mean * mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::material::Encoding;

    #[test]
    fn the_mean_is_of_what_displays_show() {
        let rows: Vec<[u8; 4]> = (0..256).map(|i| if i % 2 == 0 { [255, 0, 0, 255] } else { [0, 0, 255, 0] }).collect();
        for mips in [false, true] {
            let texels = Texels::new(16, 16, &rows, Encoding::Data, mips).unwrap();
            assert!((texels.mean_color() - Vec3::new(0.25, 0.0, 0.25)).abs().max_element() < 0.01);
        }
        let even = Texels::new(1, 1, &[[128, 64, 255, 255]], Encoding::Data, false).unwrap();
        assert!((even.mean_color() - Vec3::new(128.0, 64.0, 255.0) / 255.0).abs().max_element() < 1e-5);
    }
}
