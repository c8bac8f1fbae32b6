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
    ("difference", || Settings { sphere_cache: SphereCache::Difference, ..Settings::exact() }),
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
    //                               hit 2   hit 8  hit 16 color 2 color 8 balanced  fast  differ. double
    ("along_planes",               [  0.09,   0.71,   1.17,   0.48,   1.73,   0.00,  22.59,   0.00,   1.07]),
    ("band_borders",               [  0.74,   3.61,   3.77,   0.82,   3.31,   0.00,  53.48,   0.00,   0.47]),
    ("blocker",                    [  0.43,   0.88,   0.88,   1.13,   2.46,   0.00,  12.21,   0.00,   0.00]),
    ("checker_horizon",            [  0.04,   0.29,   0.29,   1.10,   3.67,   0.00,  34.90,   0.00,   0.00]),
    ("coincident",                 [  0.11,   0.53,   0.53,   0.18,   0.60,   0.00,  16.23,   0.00,   2.39]),
    ("eye_on_face",                [  0.00,   0.03,   0.03,   0.30,   1.24,   0.00,  14.35,   0.00,   0.00]),
    ("eye_on_plane",               [  0.00,   0.00,   0.02,   0.09,   0.20,   0.00,   5.64,   0.00,   0.00]),
    ("far_from_origin",            [  0.15,   0.69,   0.96,   0.62,   1.65,   0.00,  35.06,   0.00,   4.22]),
    ("far_spheres",                [  0.00,   0.00,   0.01,   0.01,   0.02,   0.00,  20.44,  34.59,   2.14]),
    ("funnel",                     [  0.00,   0.00,   0.00,   0.01,   0.03,   0.00,  20.36,   0.00,   0.00]),
    ("gap",                        [  0.00,   0.03,   0.09,   0.00,   0.05,   0.00,  15.81,   0.00,   0.00]),
    ("inside_glass",               [  0.00,   0.00,   0.59,   2.97,   3.42,   0.00,  46.29,   0.02,   0.03]),
    ("nested_glass",               [  0.00,   0.00,   0.00,   0.57,   1.82,   0.00,  49.79,   0.01,   0.14]),
    ("parallel_mirrors",           [  0.12,   0.33,   0.37,   1.14,   3.16,   0.00,  46.62,   0.00,   0.00]),
    ("peak",                       [  0.00,   0.00,   0.00,   0.05,   0.15,   0.01,  15.81,   0.00,   0.00]),
    ("scale_1",                    [  0.07,   0.13,   0.13,   0.12,   0.33,   0.00,  27.50,   0.00,   0.00]),
    ("scale_1e-4",                 [  0.07,   0.13,   0.13,   0.12,   0.33,   0.00,  27.50,   0.00,   0.00]),
    ("scale_1e5",                  [  0.07,   0.13,   0.13,   0.12,   0.33,   0.00,  27.50,   0.00,   0.00]),
    ("slits",                      [  0.00,   0.00,   0.12,   0.22,   0.34,   0.00,  13.20,   0.00,   0.00]),
    ("sliver",                     [  0.79,   1.35,   1.37,   1.84,   3.04,   0.00,  15.84,   0.00,   0.00]),
    ("tiny_spheres",               [  1.79,   3.28,   3.55,   2.96,   5.24,   0.00,  25.25,   0.92,   0.00]),
    ("total_internal_reflection",  [  0.00,   0.06,   0.25,   1.91,   4.45,   0.00,  54.10,   0.00,   0.11]),
    ("wedge",                      [  0.95,   5.81,   6.92,   1.24,   8.06,   0.00,  39.05,   0.00,   0.00]),
    ("wire_shadow",                [  0.00,   0.00,   0.01,   0.54,   0.85,   0.00,   6.65,   0.00,   0.00]),
    ("wires",                      [  0.87,   1.62,   1.70,   2.06,   3.58,   0.00,  16.31,   0.00,   0.00]),
];

/// Whether a rate is still what it was: neither much worse nor gone.
pub fn is_still(expected: f64, measured: f64) -> bool {
    (measured - expected).abs() <= 0.02 + 0.25 * expected
}
