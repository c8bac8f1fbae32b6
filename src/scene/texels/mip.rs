//! Smaller sizes of a picture (Williams, "Pyramidal parametrics", SIGGRAPH 1983).

/// Texels of the larger size under one of the smaller, along one axis: at most three, with their shares.
struct Taps {
    first: u32,
    shares: [f32; 3],
}

impl Taps {
    /// Those of each texel of a row that goes from `from` texels to `to`, at most half as many, or 1.
    fn row(from: u32, to: u32) -> Vec<Self> {
        let width = f64::from(from) / f64::from(to);
        let taps = |texel: u32| {
            let (start, end) = (f64::from(texel) * width, f64::from(texel + 1) * width);
            let first = start.floor();
            let share = |tap: f64| (end.min(first + tap + 1.0) - start.max(first + tap)).max(0.0) / width;
            Self { first: first as u32, shares: [share(0.0), share(1.0), share(2.0)].map(|share| share as f32) }
        };
        (0..to).map(taps).collect()
    }

    /// The texels that count, with their shares.
    fn places(&self) -> impl Iterator<Item = (usize, f32)> {
        (self.first as usize..).zip(self.shares).filter(|(_, share)| *share > 0.0)
    }
}

/// How a channel of a picture is stored.
pub(super) struct Coding<D, E> {
    /// What a stored colour or datum stands for, from 0 to 1.
    pub decode: D,
    /// The way back.
    pub encode: E,
}

/// A stored channel.
pub(super) trait Channel: Copy + Into<f32> {
    /// The opacity nearest to a mean of some.
    fn opacity(mean: f32) -> Self;
}

impl Channel for u8 {
    fn opacity(mean: f32) -> Self {
        (mean + 0.5) as Self
    }
}

impl Channel for u16 {
    fn opacity(mean: f32) -> Self {
        (mean + 0.5) as Self
    }
}

/// The picture at a smaller size: means of what each texel covers, in linear light. Colours count by how opaque they
/// are, so that what is hidden in holes does not bleed out of them.
pub(super) fn halve<C: Channel>(
    rows: &[[C; 4]],
    [width, height]: [u32; 2],
    [to_width, to_height]: [u32; 2],
    coding: &Coding<impl Fn(C) -> f32, impl Fn(f32) -> C>,
) -> Vec<[C; 4]> {
    let (across, down) = (Taps::row(width, to_width), Taps::row(height, to_height));
    let mut smaller = Vec::with_capacity(across.len() * down.len());
    for down in &down {
        for across in &across {
            let (mut plain, mut weighted, mut opacity) = ([0.0_f32; 3], [0.0_f32; 3], 0.0_f32);
            for (y, share_down) in down.places() {
                for (x, share_across) in across.places() {
                    let [r, g, b, a] = rows[y * width as usize + x];
                    let share = share_down * share_across;
                    let own = share * a.into();
                    opacity += own;
                    for (channel, stored) in [r, g, b].into_iter().enumerate() {
                        let value = (coding.decode)(stored);
                        plain[channel] += share * value;
                        weighted[channel] += own * value;
                    }
                }
            }
            let color = if opacity > 0.0 { weighted.map(|value| value / opacity) } else { plain };
            let [r, g, b] = color.map(&coding.encode);
            smaller.push([r, g, b, C::opacity(opacity)]);
        }
    }
    smaller
}

#[cfg(test)]
mod tests {
    use super::super::{bytes, words};
    use super::*;
    use crate::scene::material::Encoding;

    #[test]
    fn every_texel_counts_for_its_area() {
        for (from, to) in [(2, 1), (3, 1), (5, 2), (7, 3), (8, 4), (1, 1)] {
            let mut total = vec![0.0; from as usize];
            for taps in Taps::row(from, to) {
                assert!((taps.shares.iter().sum::<f32>() - 1.0).abs() < 1e-6);
                for (place, share) in taps.places() {
                    total[place] += share;
                }
            }
            let each = to as f32 / from as f32;
            assert!(total.iter().all(|share| (share - each).abs() < 1e-6), "{from} to {to}: {total:?}");
        }
    }

    #[test]
    fn means_are_taken_in_linear_light_and_of_what_is_seen() {
        let rows = [[0, 0, 0, 255], [255, 255, 255, 255]];
        assert_eq!(halve(&rows, [2, 1], [1, 1], &bytes(Encoding::Color)), [[188, 188, 188, 255]]);
        assert_eq!(halve(&rows, [2, 1], [1, 1], &bytes(Encoding::Data)), [[128, 128, 128, 255]]);
        let words_of = [[0, 1, 65_535, 65_535], [65_535, 2, 65_535, 65_535]];
        assert_eq!(halve(&words_of, [2, 1], [1, 1], &words()), [[32_768, 2, 65_535, 65_535]]);
        let hole = [[10, 20, 30, 255], [255, 255, 255, 0]];
        assert_eq!(halve(&hole, [2, 1], [1, 1], &bytes(Encoding::Color)), [[10, 20, 30, 128]]);
    }
}
