//! How often each method is wrong on each scene, and the comparison with what it was when the table was written.

use raywalk::settings::{Fill, Settings, SphereCache, Visibility};

/// A method by its name.
type Method = (&'static str, fn() -> Settings);

/// The columns: what is rendered and compared with `full`.
pub const METHODS: [Method; 8] = [
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
/// A failing test prints the table as it is now, `cargo test --release --test stability fails -- --nocapture` always.
#[rustfmt::skip]
pub const RATES: &[(&str, [f64; METHODS.len() + 1])] = &[
    //                               hit 2   hit 8  hit 16 color 2 color 8 balanced  fast  thesis  double
    ("along_planes",               [  0.09,   0.71,   1.17,   0.74,   2.44,   2.44,   3.37,   0.00,   1.07]),
    ("band_borders",               [  0.74,   3.61,   3.80,   0.91,   3.60,   3.60,   5.66,   0.00,   0.47]),
    ("blocker",                    [  0.43,   0.88,   0.88,   1.13,   2.46,   2.46,   2.58,   0.00,   0.00]),
    ("checker_horizon",            [  0.04,   0.29,   0.29,   1.13,   3.78,   3.78,   4.50,   0.00,   0.00]),
    ("coincident",                 [  0.11,   0.53,   0.53,   0.39,   1.49,   1.49,   4.00,   0.00,   2.39]),
    ("eye_on_face",                [  0.00,   0.03,   0.03,   0.40,   1.49,   1.49,   2.97,   0.00,   0.00]),
    ("eye_on_plane",               [  0.00,   0.00,   0.02,   0.10,   0.23,   0.23,   2.38,   0.00,   0.00]),
    ("far_from_origin",            [  0.15,   0.69,   0.96,   0.88,   1.92,   1.92,   3.95,   0.00,   3.69]),
    ("far_spheres",                [  0.00,   0.00,   0.01,   0.25,   1.10,   1.10,   4.68,  34.59,   2.13]),
    ("funnel",                     [  0.00,   0.00,   0.00,   0.97,   2.84,   2.84,   4.68,   0.00,   0.00]),
    ("gap",                        [  0.00,   0.03,   0.09,   0.10,   1.62,   1.62,   2.99,   0.00,   0.00]),
    ("inside_glass",               [  0.00,   0.00,   0.59,  12.49,  24.48,  24.51,  30.48,   0.02,   0.03]),
    ("nested_glass",               [  0.00,   0.00,   0.00,   4.15,   7.33,   7.35,  11.20,   0.01,   0.14]),
    ("parallel_mirrors",           [  0.12,   0.33,   0.36,   2.03,   4.58,   4.58,   7.85,   0.00,   0.00]),
    ("peak",                       [  0.00,   0.00,   0.00,   0.28,   1.90,   1.90,   5.62,   0.00,   0.00]),
    ("scale_1",                    [  0.07,   0.13,   0.13,   0.38,   0.62,   0.62,   1.27,   0.00,   0.00]),
    ("scale_1e-4",                 [  0.07,   0.13,   0.13,   0.38,   0.62,   0.62,   1.27,   0.00,   0.00]),
    ("scale_1e5",                  [  0.07,   0.13,   0.13,   0.38,   0.62,   0.62,   1.27,   0.00,   0.00]),
    ("slits",                      [  0.00,   0.00,   0.12,   0.33,   0.73,   0.73,   8.86,   0.00,   0.00]),
    ("sliver",                     [  0.79,   1.35,   1.37,   1.84,   3.04,   3.04,   3.13,   0.00,   0.00]),
    ("tiny_spheres",               [  1.79,   3.28,   3.54,   3.86,   6.30,   6.30,   9.60,   0.92,   0.00]),
    ("total_internal_reflection",  [  0.00,   0.06,   0.26,   2.25,   5.14,   5.14,  12.25,   0.00,   0.19]),
    ("wedge",                      [  0.95,   5.81,   6.93,   1.38,   8.27,   8.27,  11.08,   0.00,   0.00]),
    ("wire_shadow",                [  0.00,   0.00,   0.01,   0.54,   0.85,   0.85,   0.90,   0.00,   0.00]),
    ("wires",                      [  0.87,   1.62,   1.70,   2.11,   3.62,   3.62,   3.91,   0.00,   0.00]),
];

/// Whether a rate is still what it was: neither much worse nor gone.
pub fn is_still(expected: f64, measured: f64) -> bool {
    (measured - expected).abs() <= 0.02 + 0.25 * expected
}
