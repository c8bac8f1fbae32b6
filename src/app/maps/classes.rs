//! Maps whose colours name things.

use super::{Class, Key, NOTHING};
use crate::render::{Decision, Film, Obtained};

/// Names and colours of decisions: Okabe and Ito's (2008), which the colour-blind tell apart, the warmer the more was traced.
const DECISIONS: [(&str, [u8; 3]); 5] = [
    ("certified", [0, 114, 178]),
    ("resolved", [86, 180, 233]),
    ("interpolated", [0, 158, 115]),
    ("traced", [230, 159, 0]),
    ("supersampled", [204, 121, 167]),
];

/// The place of a pixel's class in [`DECISIONS`].
fn class_of(obtained: Obtained, shows_grids: bool) -> usize {
    if obtained.supersampled && shows_grids {
        return 4;
    }
    match obtained.decision {
        Decision::Certified => 0,
        Decision::Resolved => 1,
        Decision::Interpolated => 2,
        Decision::Traced => 3,
    }
}

/// Paints how pixels were obtained. Where all of a film are supersampled, that tells nothing: the last of their rays does.
pub fn decisions(films: &mut [&mut Film]) -> Key {
    let mut classes = DECISIONS.map(|(name, color)| Class { name, color, shares: Vec::new() });
    for film in films {
        let pixels = f64::from(film.width()) * f64::from(film.height());
        let shows_grids = !is_everywhere(film, |obtained| obtained.supersampled);
        let mut counts = [0_u64; DECISIONS.len()];
        film.paint(|film, x, y, before| match film.decision(x, y) {
            Some(obtained) => {
                let class = class_of(obtained, shows_grids);
                counts[class] += 1;
                DECISIONS[class].1
            }
            None => before,
        });
        for (class, count) in classes.iter_mut().zip(counts) {
            class.shares.push(count as f64 / pixels);
        }
    }
    Key::Classes(classes.into_iter().filter(|class| class.shares.iter().any(|share| *share > 0.0)).collect())
}

fn is_everywhere(film: &Film, what: impl Fn(Obtained) -> bool) -> bool {
    let mut pixels = (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
    pixels.all(|(x, y)| film.decision(x, y).is_some_and(&what))
}

/// Paints shading normals.
pub fn normals(films: &mut [&mut Film]) -> Key {
    for film in films {
        film.paint(|film, x, y, before| match film.normal(x, y) {
            Some([0.0, 0.0, 0.0]) => NOTHING,
            Some(normal) => normal.map(|along| ((along * 0.5 + 0.5) * 255.0).round() as u8),
            None => before,
        });
    }
    Key::Words("red: +x, green: +y, blue: +z; dark: nothing".to_owned())
}

/// Paints objects.
pub fn objects(films: &mut [&mut Film]) -> Key {
    let mut seen = Vec::new();
    for film in films {
        let mut last = u32::MAX;
        film.paint(|film, x, y, before| match film.object(x, y) {
            Some(u32::MAX) => NOTHING,
            Some(object) => {
                if object != last {
                    seen.push(object);
                    last = object;
                }
                object_color(object)
            }
            None => before,
        });
    }
    seen.sort_unstable();
    seen.dedup();
    let things = if seen.len() == 1 { "object" } else { "objects" };
    Key::Words(format!("{} {things} in view; dark: nothing", seen.len()))
}

/// A colour for an object: hues by the golden ratio, so that neighbours in the file differ, in three lightnesses.
fn object_color(object: u32) -> [u8; 3] {
    let hue = (f64::from(object) * 0.618_033_988_749_895).fract() * 6.0;
    let (value, saturation) = [(0.95, 0.55), (0.75, 0.75), (0.9, 0.35)][object as usize % 3];
    [5.0, 3.0, 1.0].map(|shift: f64| {
        let place = (shift + hue) % 6.0;
        let channel = value - value * saturation * place.min(4.0 - place).clamp(0.0, 1.0);
        (channel * 255.0).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn a_hundred_objects_have_a_hundred_colors_none_of_them_that_of_nothing() {
        let colors: HashSet<[u8; 3]> = (0..100).map(object_color).collect();
        assert_eq!(colors.len(), 100);
        assert!(colors.iter().all(|color| color.iter().any(|channel| *channel > 120)));
    }

    #[test]
    fn classes_differ_by_name_and_color() {
        for (i, (name, color)) in DECISIONS.iter().enumerate() {
            assert!(DECISIONS[..i].iter().all(|(n, c)| n != name && c != color));
        }
        let at = |decision, supersampled| class_of(Obtained { decision, supersampled }, true);
        let places: HashSet<usize> = Decision::ALL.into_iter().map(|decision| at(decision, false)).collect();
        assert_eq!(places.len(), 4);
        assert_eq!(DECISIONS[at(Decision::Traced, true)].0, "supersampled");
    }
}
