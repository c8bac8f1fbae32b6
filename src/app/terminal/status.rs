//! The line below the picture: what it costs, how it is made, and the keys.

use crate::app::at_rest::SAMPLES;
use std::fmt;

/// The keys, as far as there is room for them.
const KEYS: &[&str] = &[
    "Q: quit",
    "W A S D Space C: move",
    "arrows: look",
    "+ -: speed",
    "1 2 3: preset",
    "G: walk or fly",
    "Home: back",
];
/// Between two entries.
const GAP: &str = "   ";

/// What the line tells.
#[derive(Clone, Copy, Debug)]
pub struct Status<'a> {
    /// Frames a second that are shown; `None` at rest.
    pub rate: Option<f64>,
    /// Milliseconds to trace a frame.
    pub frame_ms: f64,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The preset's name, or what stands for it.
    pub preset: &'a str,
    /// Metres a second.
    pub speed: f64,
    /// On foot, not flying.
    pub walks: bool,
    /// Samples a pixel of a view at rest.
    pub samples: Option<u32>,
}

impl Status<'_> {
    /// The line, of at most `columns` characters, ASCII only.
    pub fn line(&self, columns: usize) -> String {
        let mut line = self.to_string();
        for key in KEYS {
            if line.len() + GAP.len() + key.len() <= columns {
                line.push_str(GAP);
                line.push_str(key);
            }
        }
        line.truncate(columns);
        line
    }
}

impl fmt::Display for Status<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.samples, self.rate) {
            (Some(SAMPLES), _) => f.write_str(" at rest")?,
            (Some(samples), _) => write!(f, " refining {samples}/{SAMPLES}")?,
            (None, Some(rate)) => write!(f, " {rate:.0} fps")?,
            (None, None) => f.write_str(" starting")?,
        }
        let (width, height) = self.size;
        write!(f, "{GAP}{:.1} ms{GAP}{width}x{height}{GAP}{}{GAP}", self.frame_ms, self.preset)?;
        match self.speed {
            speed if speed >= 10.0 => write!(f, "{speed:.0} m/s")?,
            speed if speed >= 0.1 => write!(f, "{speed:.1} m/s")?,
            speed => write!(f, "{speed:.1e} m/s")?,
        }
        f.write_str(if self.walks { " on foot" } else { "" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATUS: Status<'_> = Status {
        rate: Some(29.6),
        frame_ms: 4.25,
        size: (80, 46),
        preset: "balanced",
        speed: 3.12,
        walks: false,
        samples: None,
    };

    #[test]
    fn figures_come_first_and_keys_where_there_is_room() {
        assert_eq!(STATUS.line(50), " 30 fps   4.2 ms   80x46   balanced   3.1 m/s");
        assert!(STATUS.line(200).ends_with("Home: back"));
        for columns in 0..150 {
            assert!(STATUS.line(columns).len() <= columns);
        }
        // A key that has no room does not keep out a shorter one.
        assert!(STATUS.line(72).ends_with("Q: quit   arrows: look"), "{}", STATUS.line(72));
    }

    #[test]
    fn a_view_at_rest_says_so() {
        let line = |samples| Status { samples: Some(samples), ..STATUS }.line(20);
        assert!(line(9).starts_with(" refining 9/16"), "{}", line(9));
        assert!(line(16).starts_with(" at rest"), "{}", line(16));
    }
}
