//! Value noise that repeats: the same on every machine, and without a seam when it is tiled.

/// A number in 0..1 for a point of the integer grid.
pub fn hash(x: i64, y: i64, seed: u32) -> f64 {
    // The finaliser of MurmurHash3 over the coordinates, each spread by an odd constant.
    let mut h =
        (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae3d);
    h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    f64::from(h ^ (h >> 16)) / f64::from(u32::MAX)
}

/// Smooth noise in 0..1 on a grid that repeats every `period_x` by `period_y` cells.
pub fn value(x: f64, y: f64, period_x: i64, period_y: i64, seed: u32) -> f64 {
    let (column, row) = (x.floor(), y.floor());
    let corner = |dx: i64, dy: i64| {
        hash((column as i64 + dx).rem_euclid(period_x), (row as i64 + dy).rem_euclid(period_y), seed)
    };
    let ease = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (s, t) = (ease(x - column), ease(y - row));
    let bottom = corner(0, 0) + (corner(1, 0) - corner(0, 0)) * s;
    let top = corner(0, 1) + (corner(1, 1) - corner(0, 1)) * s;
    bottom + (top - bottom) * t
}

/// Octaves of [`value`] over the unit square, each twice as fine and half as strong, in 0..1. Starts at `cells` cells.
pub fn fractal(u: f64, v: f64, cells: i64, octaves: u32, seed: u32) -> f64 {
    let (mut sum, mut weight, mut total) = (0.0, 1.0, 0.0);
    for octave in 0..octaves {
        let period = cells << octave;
        sum += weight * value(u * period as f64, v * period as f64, period, period, seed + octave);
        total += weight;
        weight *= 0.5;
    }
    sum / total
}
