//! The colours a terminal has: any, or the 256 of the palette that all agree on.

use std::fmt;

/// What a terminal can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Palette {
    /// 24 bits a colour.
    TrueColor,
    /// The 6 x 6 x 6 cube and the 24 greys of xterm; the 16 colours before them are the user's own.
    Colors256,
}

/// A colour as it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Color {
    /// Red, green, blue in sRGB.
    Rgb([u8; 3]),
    /// One of the 256.
    Indexed(u8),
}

/// The steps of the cube's edges.
const CUBE: [u8; 6] = [0, 95, 135, 175, 215, 255];
/// The first of the cube, and the first grey.
const FIRST_OF_CUBE: u8 = 16;
const FIRST_GREY: u8 = 232;

impl Palette {
    /// What the variables of the environment say; `None` where they say nothing, as over SSH.
    pub fn of_environment(variable: impl Fn(&str) -> Option<String>) -> Option<Self> {
        let colors = variable("COLORTERM").unwrap_or_default();
        let direct = variable("TERM").is_some_and(|name| name.ends_with("-direct"));
        match colors.as_str() {
            "truecolor" | "24bit" => Some(Self::TrueColor),
            _ if direct => Some(Self::TrueColor),
            "" => None,
            _ => Some(Self::Colors256),
        }
    }

    /// The colour nearest to sRGB `rgb`.
    pub fn color(self, rgb: [u8; 3]) -> Color {
        match self {
            Self::TrueColor => Color::Rgb(rgb),
            Self::Colors256 => Color::Indexed(nearest(rgb)),
        }
    }
}

fn nearest(rgb: [u8; 3]) -> u8 {
    let steps = rgb.map(|value| match value {
        0..48 => 0,
        48..115 => 1,
        _ => (value - 35) / 40,
    });
    let [red, green, blue] = steps;
    let cube = steps.map(|step| CUBE[usize::from(step)]);
    // Greys are 8, 18, .. 238.
    let mean = rgb.iter().map(|&value| u32::from(value)).sum::<u32>() / 3;
    let grey = (mean.saturating_sub(3) / 10).min(23) as u8;
    let distance =
        |other: [u8; 3]| -> i32 { rgb.iter().zip(other).map(|(&a, b)| (i32::from(a) - i32::from(b)).pow(2)).sum() };
    if distance([8 + 10 * grey; 3]) < distance(cube) {
        FIRST_GREY + grey
    } else {
        FIRST_OF_CUBE + 36 * red + 6 * green + blue
    }
}

impl fmt::Display for Color {
    /// As in an SGR sequence, behind 38 for the foreground or 48 for the background.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rgb([red, green, blue]) => write!(f, "2;{red};{green};{blue}"),
            Self::Indexed(index) => write!(f, "5;{index}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_environment_is_believed() {
        let palette = |colors: Option<&str>, term: &str| {
            Palette::of_environment(|name| match name {
                "COLORTERM" => colors.map(str::to_owned),
                _ => Some(term.to_owned()),
            })
        };
        assert_eq!(palette(Some("truecolor"), "xterm-256color"), Some(Palette::TrueColor));
        assert_eq!(palette(Some("24bit"), "xterm"), Some(Palette::TrueColor));
        assert_eq!(palette(None, "xterm-direct"), Some(Palette::TrueColor));
        assert_eq!(palette(Some("yes"), "xterm-256color"), Some(Palette::Colors256));
        assert_eq!(palette(None, "xterm-256color"), None);
        assert_eq!(palette(Some(""), "xterm-256color"), None);
    }

    #[test]
    fn the_nearest_of_256_is_the_nearest() {
        let rgb = |index: u8| match index {
            232.. => [8 + 10 * (index - 232); 3],
            _ => [(index - 16) / 36, (index - 16) / 6 % 6, (index - 16) % 6].map(|step| CUBE[usize::from(step)]),
        };
        let distance = |a: [u8; 3], b: [u8; 3]| -> i32 {
            a.iter().zip(b).map(|(&a, b)| (i32::from(a) - i32::from(b)).pow(2)).sum()
        };
        for red in (0..=255).step_by(15) {
            for green in (0..=255).step_by(17) {
                for blue in (0..=255).step_by(5) {
                    let wanted = [red, green, blue];
                    let found = distance(rgb(nearest(wanted)), wanted);
                    let best = (16..=255).map(|index| distance(rgb(index), wanted)).min();
                    assert_eq!(Some(found), best, "{wanted:?}");
                }
            }
        }
    }
}
