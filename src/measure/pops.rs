//! Pixels that are visibly wrong, and those that pop: that came to be wrong from one frame to the next, or ceased to.

use super::metric::SEEN_STEPS;

/// Follows which pixels are visibly wrong from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Pops {
    /// Which pixels of the last frame were wrong; `None` before the first.
    wrong: Option<Vec<bool>>,
}

/// What there was to see in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// Pixels that are visibly wrong.
    pub pixels_off: u64,
    /// Pixels that were right in the frame before and are wrong now, or the other way round; 0 for the first frame.
    pub pops: u64,
}

impl Pops {
    /// Takes the next frame: whether each of its pixels is visibly wrong. All frames have the same pixels.
    pub fn add(&mut self, wrong: impl Iterator<Item = bool>) -> Seen {
        let mut seen = Seen::default();
        match &mut self.wrong {
            None => {
                let first: Vec<bool> = wrong.collect();
                seen.pixels_off = first.iter().filter(|wrong| **wrong).count() as u64;
                self.wrong = Some(first);
            }
            Some(last) => {
                for (last, now) in last.iter_mut().zip(wrong) {
                    seen.pixels_off += u64::from(now);
                    seen.pops += u64::from(now != *last);
                    *last = now;
                }
            }
        }
        seen
    }
}

/// Whether a pixel is visibly wrong: 8-bit sRGB, red, green and blue first; what follows, such as alpha, is left out.
pub fn is_visibly_wrong(picture: &[u8], reference: &[u8]) -> bool {
    picture.iter().zip(reference).take(3).any(|(a, b)| a.abs_diff(*b) > SEEN_STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pops_are_pixels_that_come_to_be_wrong_or_cease_to() {
        let mut pops = Pops::default();
        let mut add = |wrong: [bool; 4]| pops.add(wrong.into_iter());
        assert_eq!(add([true, false, false, false]), Seen { pixels_off: 1, pops: 0 });
        assert_eq!(add([false, true, true, false]), Seen { pixels_off: 2, pops: 3 });
        assert_eq!(add([false, true, true, false]), Seen { pixels_off: 2, pops: 0 });
    }

    #[test]
    fn more_than_two_steps_are_seen_in_any_channel_but_alpha() {
        assert!(!is_visibly_wrong(&[10, 20, 30, 255], &[12, 18, 30, 0]));
        assert!(is_visibly_wrong(&[10, 20, 30], &[10, 20, 33]));
    }
}
