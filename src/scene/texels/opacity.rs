//! How opaque the texels of a picture are.

use super::Texels;
use std::sync::Arc;

/// Opacities between which a texel is neither opaque nor a hole.
const MIDDLE: std::ops::RangeInclusive<u8> = 13..=242;

impl Texels {
    /// Whether some texel is not wholly opaque.
    pub fn has_holes(&self) -> bool {
        self.full_size().any(|[.., opacity]| opacity != u8::MAX)
    }

    /// Opacities of the full size, row by row from the top.
    pub fn opacities(&self) -> Arc<[u8]> {
        self.full_size().map(|[.., opacity]| opacity).collect()
    }

    /// The texels of the full size, row by row from the top.
    fn full_size(&self) -> impl Iterator<Item = [u8; 4]> {
        let [width, height] = self.size(0);
        (0..height).flat_map(move |y| (0..width).map(move |x| self.texel(0, x, y)))
    }

    /// Whether there are areas that are neither opaque nor holes. The edges of holes, which are of middle opacity where they
    /// are smooth, are no such areas: these are wider than two texels.
    pub fn has_partial_opacity(&self) -> bool {
        let [width, height] = self.size(0);
        let opacities = self.opacities();
        let is_middle = |x: u32, y: u32| MIDDLE.contains(&opacities[(y * width + x) as usize]);
        // Around each texel, those of the opposite edge included, as the picture is repeated.
        let around = |at: u32, size: u32| [(at + size - 1) % size, at, (at + 1) % size];
        (0..height).any(|y| {
            let rows = around(y, height);
            (0..width)
                .any(|x| is_middle(x, y) && rows.iter().all(|y| around(x, width).iter().all(|x| is_middle(*x, *y))))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::material::Encoding;

    #[test]
    fn smooth_edges_of_holes_are_no_partial_opacity() {
        let picture = |opacity: &dyn Fn(u32) -> u8| {
            let rows: Vec<[u8; 4]> = (0..64).map(|i| [0, 0, 0, opacity(i % 8)]).collect();
            Texels::new(8, 8, &rows, Encoding::Color, false).unwrap()
        };
        let two_values = picture(&|x| if x < 4 { 255 } else { 0 });
        let smooth = picture(&|x| [255, 255, 170, 85, 0, 0, 85, 170][x as usize]);
        assert!(two_values.has_holes() && !two_values.has_partial_opacity());
        assert!(smooth.has_holes() && !smooth.has_partial_opacity());
        let glass = picture(&|x| if x < 5 { 255 } else { 100 });
        let gradient = picture(&|x| (x * 36) as u8);
        assert!(glass.has_partial_opacity() && gradient.has_partial_opacity());
        assert!(Texels::new(1, 1, &[[0, 0, 0, 100]], Encoding::Color, false).unwrap().has_partial_opacity());
    }
}
