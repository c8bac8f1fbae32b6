//! A picture of the sky under construction.

use crate::scene::environment::SkyImage;
use std::sync::OnceLock;

/// Pictures that are wider or higher are halved until they are not.
const LARGEST_EDGE: u64 = 4096;

/// Values that cannot be radiance, and were replaced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// Set to 0.
    pub not_a_number: u64,
    /// Set to 0.
    pub negative: u64,
    /// Set to the largest finite value of the picture.
    pub infinite: u64,
}

impl Faults {
    /// In words; `None` where there are none.
    pub fn told(&self) -> Option<String> {
        let parts = [
            (self.not_a_number, "not a number", "set to 0"),
            (self.negative, "negative", "set to 0"),
            (self.infinite, "infinite", "set to the largest finite value"),
        ];
        let parts: Vec<String> = parts
            .iter()
            .filter(|(count, ..)| *count > 0)
            .map(|(count, what, done)| format!("{count} {what} ({done})"))
            .collect();
        (!parts.is_empty()).then(|| format!("values that are no radiance: {}", parts.join(", ")))
    }
}

/// A picture that is painted texel by texel, in any order, and may be smaller than its file's.
#[derive(Debug)]
pub struct Canvas {
    source: (u32, u32),
    /// Texels of the file, across and down, in one of the picture: a power of two.
    factor: u32,
    width: u32,
    height: u32,
    /// Sums of shares of the file's texels.
    texels: Vec<[f32; 3]>,
    /// What infinite values become.
    stand_in: f32,
    /// Values that were replaced.
    pub faults: Faults,
    /// The largest finite value so far.
    pub largest: f32,
}

impl Canvas {
    /// A black picture of `width` by `height` texels in the file, each at least 1.
    pub fn new(width: u32, height: u32, stand_in: f32) -> Self {
        let factor = factor(width.into(), height.into());
        let source = (width, height);
        let (width, height) = (width.div_ceil(factor), height.div_ceil(factor));
        let texels = vec![[0.0; 3]; width as usize * height as usize];
        Self { source, factor, width, height, texels, stand_in, faults: Faults::default(), largest: 0.0 }
    }

    /// The bytes that a picture of this size takes.
    pub fn bytes(width: u64, height: u64) -> u64 {
        let factor = u64::from(factor(width, height));
        width.div_ceil(factor).saturating_mul(height.div_ceil(factor)).saturating_mul(size_of::<[f32; 3]>() as u64)
    }

    /// Paints the texel `x`, `y` of the file, which lies in the picture.
    pub fn paint(&mut self, x: u32, y: u32, color: [f32; 3]) {
        let (shift, share) = (self.factor.ilog2(), ((self.factor * self.factor) as f32).recip());
        let color = color.map(|value| self.sound(value) * share);
        let texel = &mut self.texels[(y >> shift) as usize * self.width as usize + (x >> shift) as usize];
        texel.iter_mut().zip(color).for_each(|(sum, value)| *sum += value);
    }

    /// `value` as far as it can be radiance.
    fn sound(&mut self, value: f32) -> f32 {
        if (0.0..f32::INFINITY).contains(&value) {
            self.largest = self.largest.max(value);
            // Not the negative zero.
            return value + 0.0;
        }
        let (count, value) = match () {
            () if value.is_nan() => (&mut self.faults.not_a_number, 0.0),
            () if value < 0.0 => (&mut self.faults.negative, 0.0),
            () => (&mut self.faults.infinite, self.stand_in),
        };
        *count += 1;
        value
    }

    /// The finished picture.
    pub fn finish(mut self, name: &str) -> SkyImage {
        let (across, down) = self.source;
        let whole = self.factor * self.factor;
        // Texels at the right and lower edge may have got fewer shares.
        let within = |at: u32, of: u32| self.factor.min(of - at * self.factor);
        for (y, row) in (0..).zip(self.texels.chunks_mut(self.width as usize)) {
            for (x, texel) in (0..).zip(row) {
                let scale = whole as f32 / (within(x, across) * within(y, down)) as f32;
                // Rounding may have made a sum of the largest values infinite.
                *texel = texel.map(|sum| (sum * scale).min(f32::MAX));
            }
        }
        SkyImage {
            name: name.to_owned(),
            width: self.width,
            height: self.height,
            source: self.source,
            texels: self.texels.into_boxed_slice(),
            blurred: OnceLock::new(),
        }
    }
}

/// How many texels across and down become one.
fn factor(width: u64, height: u64) -> u32 {
    let mut factor = 1;
    while width.max(height).div_ceil(factor.into()) > LARGEST_EDGE && factor < 1 << 15 {
        factor *= 2;
    }
    factor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_pictures_are_averaged_edges_included() {
        let mut canvas = Canvas::new(8193, 3, 0.0);
        for (y, row) in [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]].into_iter().enumerate() {
            (0..8193).for_each(|x| canvas.paint(x, y as u32, [row[x as usize % 2], 1.0, f32::MAX]));
        }
        let image = canvas.finish("wide");
        assert_eq!((image.width, image.height, image.source), (2049, 1, (8193, 3)));
        assert_eq!(image.texels.len(), 2049);
        assert_eq!(image.texels[0], [3.5, 1.0, f32::MAX]);
        assert_eq!(image.texels[2048], [3.0, 1.0, f32::MAX], "one column of three texels");
        let bytes = |width, height| Canvas::bytes(width, height);
        assert_eq!(bytes(8193, 3), 2049 * 12);
        assert_eq!(bytes(4096, 2048), 4096 * 2048 * 12);
        assert!(bytes(u64::MAX, 1) > 1 << 40);
    }

    #[test]
    fn what_is_no_radiance_is_replaced_and_counted() {
        let mut canvas = Canvas::new(2, 1, 7.0);
        canvas.paint(0, 0, [f32::NAN, -1.0, f32::INFINITY]);
        canvas.paint(1, 0, [f32::NEG_INFINITY, -0.0, 7.0]);
        assert_eq!(canvas.faults, Faults { not_a_number: 1, negative: 2, infinite: 1 });
        assert_eq!(canvas.largest, 7.0);
        let told = canvas.faults.told().unwrap();
        assert!(told.contains("1 not a number (set to 0), 2 negative") && !told.contains('\n'), "{told}");
        let texels = canvas.finish("odd").texels;
        assert_eq!(texels[..], [[0.0, 0.0, 7.0], [0.0, 0.0, 7.0]]);
        assert!(texels[1][1].is_sign_positive());
        assert_eq!(Faults::default().told(), None);
    }
}
