//! Every switch that promises the same pixels, flipped.

use raywalk::math::simd::is_available;
use raywalk::settings::{Kind, Promise, ROWS, Row, Settings};

/// The values of a row that promise the default's pixels, but for the default itself.
pub fn same_pixels(row: &Row) -> Vec<&'static str> {
    match &row.kind {
        Kind::Choice(choices) => {
            let default = (row.get)(&Settings::exact());
            let same = choices.iter().filter(|c| c.promise == Promise::SamePixels && c.value != default);
            same.map(|c| c.value).collect()
        }
        Kind::Number { promise: Promise::SamePixels, .. } => vec!["1", "2", "5"],
        Kind::Number { .. } => Vec::new(),
    }
}

/// The default with one row flipped, each in turn. What the machine lacks is left out.
pub fn flipped() -> Vec<(String, Settings)> {
    let mut all = Vec::new();
    for row in ROWS {
        for value in same_pixels(row) {
            let mut settings = Settings::exact();
            (row.set)(&mut settings, value).unwrap();
            if is_available(settings.simd) {
                all.push((format!("{} {value}", row.name), settings));
            }
        }
    }
    all
}
