//! Maps whose colours are numbers, in viridis.

use super::{Key, NOTHING, Scale};
use crate::measure::chart::short;
use crate::measure::colormap::viridis;
use crate::render::Film;

/// Share of the pixels whose numbers lie within the scale; the few beyond it would leave the others dark.
const WITHIN: f64 = 0.995;
/// Places of the marks of a scale.
const MARKS: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];

/// The numbers of all pixels of films.
fn numbers(films: &[&mut Film], of: impl Fn(&Film, u32, u32) -> Option<f32>) -> Vec<f32> {
    let mut numbers = Vec::new();
    for film in films {
        for y in 0..film.height() {
            numbers.extend((0..film.width()).filter_map(|x| of(film, x, y)));
        }
    }
    numbers
}

/// The least number, and the one that a share of them does not exceed.
fn range(mut numbers: Vec<f32>) -> Option<(f64, f64)> {
    let least = numbers.iter().copied().reduce(f32::min)?;
    let last = ((numbers.len() - 1) as f64 * WITHIN).round() as usize;
    let (_, most, _) = numbers.select_nth_unstable_by(last, f32::total_cmp);
    Some((f64::from(least), f64::from(*most)))
}

/// Paints the rays of each pixel, from none to what nearly all stay within, on a scale that tells few from fewer.
pub fn cost(films: &mut [&mut Film]) -> Key {
    let (_, most) = range(numbers(films, |film, x, y| film.cost(x, y).map(|rays| rays as f32))).unwrap_or_default();
    let most = most.max(1.0);
    let span = libm::log(1.0 + most);
    let mut sums = Vec::new();
    for film in films {
        let mut sum = 0_u64;
        film.paint(|film, x, y, before| match film.cost(x, y) {
            Some(rays) => {
                sum += u64::from(rays);
                viridis((libm::log(1.0 + f64::from(rays)) / span).min(1.0))
            }
            None => before,
        });
        let pixels = f64::from(film.width()) * f64::from(film.height());
        sums.push(format!("{:.2} a pixel", sum as f64 / pixels));
    }
    let marks = MARKS.map(|place| (place, mark(libm::exp(place * span) - 1.0, place)));
    Key::Scale(Scale { marks: marks.into(), unit: "rays", sums })
}

/// The number at a place of a scale whose end stands for what is beyond it, too.
fn mark(number: f64, place: f64) -> String {
    let more = if place == 1.0 { "+" } else { "" };
    format!("{}{more}", short((number * 10.0).round() / 10.0))
}

/// Paints distances, on a logarithmic scale.
pub fn depth(films: &mut [&mut Film]) -> Key {
    let finite = |film: &Film, x, y| film.depth(x, y).filter(|depth| depth.is_finite());
    let (least, most) = range(numbers(films, finite)).unwrap_or((1.0, 1.0));
    let least = least.max(1e-6);
    let most = most.max(least * 1.01);
    let span = libm::log(most / least);
    for film in films {
        film.paint(|film, x, y, before| match film.depth(x, y) {
            Some(depth) if depth.is_finite() => {
                viridis((libm::log(f64::from(depth).max(least) / least) / span).min(1.0))
            }
            Some(_) => NOTHING,
            None => before,
        });
    }
    let marks = MARKS.map(|place| {
        let number = least * libm::exp(place * span);
        // Three figures: of a room as of a landscape.
        let unit = libm::pow(10.0, libm::floor(libm::log10(number)) - 2.0);
        let more = if place == 1.0 { "+" } else { "" };
        (place, format!("{}{more}", short((number / unit).round() * unit)))
    });
    Key::Scale(Scale { marks: marks.into(), unit: "m from the eye", sums: Vec::new() })
}

/// Where a difference of so many steps of 255 lies on the scale of errors, which is the same for all pictures.
fn place_of_error(steps: f64) -> f64 {
    libm::log2(1.0 + steps) / 8.0
}

/// Paints differences from the exact picture.
pub fn error(films: &mut [&mut Film], exact: &Film) -> Key {
    let mut colors = [[0; 3]; 256];
    for (steps, color) in colors.iter_mut().enumerate() {
        *color = viridis(place_of_error(steps as f64));
    }
    let (exact_pixels, _) = exact.rgba().as_chunks::<4>();
    let mut sums = Vec::new();
    for film in films {
        if (film.width(), film.height()) != (exact.width(), exact.height()) {
            continue;
        }
        let (mut squares, mut most) = (0_u64, 0_u8);
        film.paint(|film, x, y, pixel| {
            let exact = exact_pixels[y as usize * film.width() as usize + x as usize];
            let mut greatest = 0;
            for (a, b) in pixel.into_iter().zip(exact) {
                let difference = a.abs_diff(b);
                squares += u64::from(difference).pow(2);
                greatest = greatest.max(difference);
            }
            most = most.max(greatest);
            colors[usize::from(greatest)]
        });
        let values = 3.0 * f64::from(film.width()) * f64::from(film.height());
        sums.push(format!("max {most}, RMSE {:.2}", (squares as f64 / values).sqrt()));
    }
    let marks = [0, 1, 3, 7, 15, 31, 63, 127, 255].map(|steps| (place_of_error(f64::from(steps)), steps.to_string()));
    Key::Scale(Scale { marks: marks.into(), unit: "steps of 255 from the exact picture", sums })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Planes;

    fn film(color: impl Fn(u32, u32) -> [u8; 3]) -> Film {
        let mut film = Film::new(4, 2, Planes::default());
        film.paint(|_, x, y, _| color(x, y));
        film
    }

    #[test]
    fn errors_are_counted_in_steps_and_drawn_on_one_scale() {
        let exact = film(|_, _| [100; 3]);
        let mut off = film(|x, _| if x == 0 { [100, 107, 97] } else { [100; 3] });
        let Key::Scale(scale) = error(&mut [&mut off], &exact) else { panic!("errors are numbers") };
        // Two of eight pixels, 7 and 3 off in two of three channels.
        assert_eq!(scale.sums, ["max 7, RMSE 2.20"]);
        let (pixels, _) = off.rgba().as_chunks::<4>();
        assert_eq!(pixels[0][..3], viridis(place_of_error(7.0)));
        assert_eq!(pixels[1][..3], viridis(0.0));
        assert_eq!((scale.marks[0].0, scale.marks[8].0), (0.0, 1.0));
    }

    #[test]
    fn few_outliers_do_not_stretch_a_scale() {
        let mut numbers: Vec<f32> = (0..1000).map(|i| 1.0 + i as f32 * 1e-3).collect();
        numbers[17] = 1e6;
        let (least, most) = range(numbers).expect("there are some");
        assert_eq!(least, 1.0);
        assert!(most < 2.0, "{most}");
        assert_eq!(range(Vec::new()), None);
    }
}
