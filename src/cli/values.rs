//! Values as they are typed: sizes, vectors, ranges, limits.

use glam::DVec3;
use raywalk::scene::Limits;
use std::ops::Range;

/// Width and height in pixels, each at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    pub width: u32,
    pub height: u32,
}

/// `1280x720`.
pub fn size(text: &str) -> Result<Size, String> {
    let side = |text: &str| text.parse::<u32>().ok().filter(|&side| side > 0);
    let sides = text.split_once(['x', 'X']).and_then(|(width, height)| side(width).zip(side(height)));
    let (width, height) = sides.ok_or("expected width x height in pixels, each at least 1, such as 1280x720")?;
    Ok(Size { width, height })
}

/// `-7,10,-10`.
pub fn vector(text: &str) -> Result<DVec3, String> {
    let is_known = |value: &f64| (*value as f32).is_finite();
    let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok().filter(is_known)).collect();
    let numbers: Option<[f64; 3]> = numbers.and_then(|n| n.try_into().ok());
    numbers.map(DVec3::from).ok_or_else(|| "expected three numbers x,y,z, such as -7,10,-10".to_owned())
}

/// Degrees between 0 and 180.
pub fn field_of_view(text: &str) -> Result<f32, String> {
    number(text)
        .filter(|fov| *fov > 0.0 && *fov < 180.0)
        .ok_or_else(|| "expected degrees above 0 and below 180".to_owned())
}

fn number(text: &str) -> Option<f32> {
    text.trim().parse().ok().filter(|v: &f32| v.is_finite())
}

/// `0..60`: the frames 0 to 59.
pub fn frames(text: &str) -> Result<Range<u64>, String> {
    let ends = text.split_once("..").and_then(|(a, b)| a.parse().ok().zip(b.parse().ok()));
    ends.map(|(a, b)| a..b)
        .filter(|range: &Range<u64>| !range.is_empty())
        .ok_or_else(|| "expected A..B with A below B: the frames A to B-1".to_owned())
}

/// `NAME=VALUE` of a known limit.
pub fn limit(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    Limits::default().set(name, value)?;
    Ok((name.to_owned(), value.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_two_sides_of_at_least_one() {
        assert_eq!(size("1280x720"), Ok(Size { width: 1280, height: 720 }));
        for bad in ["", "1280", "0x720", "1280x0", "-1x5", "1e3x5", "99999999999x1", "1x2x3", "x"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn vectors_have_three_finite_numbers_of_either_sign() {
        assert_eq!(vector("-7,10,-10.5"), Ok(DVec3::new(-7.0, 10.0, -10.5)));
        for bad in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,inf", "1,2,1e39", "nan,0,0"] {
            assert!(vector(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn ranges_are_not_empty() {
        assert_eq!(frames("3..7"), Ok(3..7));
        for bad in ["", "3", "3..", "..3", "3..3", "4..3", "-1..3", "a..b"] {
            assert!(frames(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn angles_and_limits_within_their_ranges() {
        assert_eq!(field_of_view("45"), Ok(45.0));
        assert!(["0", "180", "-5", "nan", ""].iter().all(|bad| field_of_view(bad).is_err()));
        assert!(["", "objects", "objects=", "objects=-1", "speed=1"].iter().all(|bad| limit(bad).is_err()));
        assert!(limit("objects=5").is_ok());
    }
}
