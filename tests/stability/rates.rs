//! How often each method is wrong on each scene, and the comparison with what it was when the table was written.

use raywalk::settings::{Fill, Settings, SphereCache, Visibility};

/// The columns: what is rendered and compared with `full`.
pub const METHODS: [(&str, fn() -> Settings); 8] = [
    ("hit 2", || subsample(Fill::Hit, 2)),
    ("hit 8", || subsample(Fill::Hit, 8)),
    ("hit 16", || subsample(Fill::Hit, 16)),
    ("color 2", || subsample(Fill::Color, 2)),
    ("color 8", || subsample(Fill::Color, 8)),
    ("balanced", Settings::balanced),
    ("fast", Settings::fast),
    ("thesis", || Settings { sphere_cache: SphereCache::Thesis, ..Settings::exact() }),
];

/// Subsampling with a fill and a stride.
pub fn subsample(fill: Fill, stride: u32) -> Settings {
    Settings { visibility: Visibility::Subsample, fill, stride, ..Settings::exact() }
}

/// Visibly wrong pixels in per cent: any channel of the 8-bit picture off by more than 2, over all cameras at 160x90.
/// The last column is `full` against double precision: values off by more than a thousandth, over the file's cameras.
/// A failing test prints the table as it is now.
#[rustfmt::skip]
pub const RATES: &[(&str, [f64; METHODS.len() + 1])] = &[
];

/// Whether a rate is still what it was: neither much worse nor gone.
pub fn is_still(expected: f64, measured: f64) -> bool {
    (measured - expected).abs() <= 0.02 + 0.25 * expected
}
