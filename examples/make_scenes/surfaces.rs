//! Floors and walls. All of them repeat without a seam.

use crate::canvas::{ramp, rgb, smoothstep};
use crate::noise::{fractal, hash, value};
use glam::DVec3;

/// Distance from `x` to the nearest whole number.
fn to_joint(x: f64) -> f64 {
    (x - x.round()).abs()
}

/// Two light and two dark marble tiles, chequered, with hairline joints.
pub fn marble_tiles(u: f64, v: f64) -> DVec3 {
    let (column, row) = ((u * 2.0) as i64, (v * 2.0) as i64);
    let light = (column + row) % 2 == 0;
    // Each tile is cut from another place of the block: the warp differs by tile.
    let seed = 10 + (column + 2 * row) as u32 * 20;
    let warp = fractal(u, v, 4, 5, seed) - 0.5;
    let vein = |frequency: f64, thickness: f64, seed: u32| {
        let phase = u * frequency + v * frequency * 0.7 + 5.0 * warp + 1.5 * fractal(u, v, 8, 3, seed);
        1.0 - smoothstep(0.0, thickness, to_joint(phase))
    };
    let veins = (0.8 * vein(3.0, 0.10, seed + 7) + 0.4 * vein(5.0, 0.06, seed + 11)).min(1.0);
    let cloud = fractal(u, v, 6, 3, seed + 13);
    let stone = if light {
        rgb(0xe6dfd0).lerp(rgb(0xd3c9b6), cloud).lerp(rgb(0xa99c88), veins * 0.7)
    } else {
        rgb(0x2f4440).lerp(rgb(0x3d5750), cloud).lerp(rgb(0x9db3a6), veins * 0.55)
    };
    let joint = to_joint(u * 2.0).min(to_joint(v * 2.0));
    stone.lerp(rgb(0x6b6459), 1.0 - smoothstep(0.004, 0.010, joint))
}

/// Oak herringbone: planks five times as long as wide.
pub fn parquet(u: f64, v: f64) -> DVec3 {
    const LENGTH: i64 = 5;
    const CELLS: f64 = 2.0 * LENGTH as f64;
    let (x, y) = (u * CELLS, v * CELLS);
    let (i, j) = (x as i64, y as i64);
    // Along a row: LENGTH cells of one lying plank, then LENGTH cells of as many standing ones; each row is shifted by a cell.
    let k = (i - j).rem_euclid(2 * LENGTH);
    let (along, across, id) = if k < LENGTH {
        (x - (i - k) as f64, y - j as f64, ((i - k).rem_euclid(2 * LENGTH), j))
    } else {
        let start = j - (2 * LENGTH - 1 - k);
        (y - start as f64, x - i as f64, (i + 100, start.rem_euclid(2 * LENGTH)))
    };
    let tone = hash(id.0, id.1, 1);
    let seed = (hash(id.0, id.1, 2) * 1000.0) as u32;
    let grain = value(along * 1.5, across * 14.0, 64, 64, seed) * 0.6
        + value(along * 4.0, across * 30.0, 256, 256, seed + 1) * 0.4;
    let oak = ramp(&[rgb(0x8a5a2e), rgb(0xa9743f), rgb(0xc08c54)], 0.15 + 0.7 * tone + 0.35 * (grain - 0.5));
    let edge = to_joint(across).min(along.min(LENGTH as f64 - along));
    oak.lerp(rgb(0x4f3018), 0.8 * (1.0 - smoothstep(0.015, 0.05, edge)))
}

/// Stone slabs in staggered rows.
pub fn paving(u: f64, v: f64) -> DVec3 {
    let row = (v * 4.0) as i64;
    let x = u * 3.0 + 0.5 * (row % 2) as f64;
    let column = (x.floor() as i64).rem_euclid(3);
    let tone = hash(column, row, 5);
    let slab =
        ramp(&[rgb(0xb7ab95), rgb(0xc9bfa9), rgb(0xd8cfbb)], 0.2 + 0.6 * tone + 0.8 * (fractal(u, v, 8, 4, 30) - 0.5));
    let joint = (to_joint(x) * 4.0 / 3.0).min(to_joint(v * 4.0));
    slab.lerp(rgb(0x847a68), 1.0 - smoothstep(0.015, 0.04, joint))
}

/// Hand-trowelled lime plaster, nearly white: to be looked at closely, not noticed.
pub fn plaster(u: f64, v: f64) -> DVec3 {
    let cloud = fractal(u, v, 4, 4, 50);
    let trowel = fractal(u + 0.04 * cloud, v, 16, 2, 60);
    rgb(0xe4dccd).lerp(rgb(0xf4efe4), smoothstep(0.2, 0.8, 0.65 * cloud + 0.35 * trowel))
}

/// Straight-grained walnut, the grain along v.
pub fn wood(u: f64, v: f64) -> DVec3 {
    let bend = fractal(u, v, 2, 2, 70);
    let rings = value((u + 0.08 * bend) * 24.0, v * 2.0, 24, 2, 80);
    let pores = value(u * 128.0, v * 8.0, 128, 8, 90);
    ramp(&[rgb(0x4a2c1a), rgb(0x6a4329), rgb(0x80553a)], 0.15 + 0.6 * rings + 0.25 * pores)
}

/// A rug: borders, a lattice of diamonds, and a medallion in the middle.
pub fn rug(u: f64, v: f64) -> DVec3 {
    let (red, blue, cream, gold) = (rgb(0x7d1f22), rgb(0x1f2f4d), rgb(0xe2d2ac), rgb(0xb98a3c));
    let (x, y) = ((u - 0.5).abs() * 2.0, (v - 0.5).abs() * 2.0);
    let rim = x.max(y);
    let weave = 0.92 + 0.08 * hash((u * 160.0) as i64, (v * 160.0) as i64, 3);
    let diamond = |scale: f64| to_joint(x * scale) + to_joint(y * scale);
    let color = if rim > 0.96 {
        cream
    } else if rim > 0.93 {
        blue
    } else if rim > 0.74 {
        let along = x.min(y);
        let tooth = to_joint(along * 7.5) * 2.0;
        let height = ((rim - 0.835).abs() / 0.07).min(1.0);
        if tooth + height < 0.42 {
            cream
        } else if tooth + height < 0.95 {
            red
        } else {
            blue
        }
    } else if rim > 0.71 {
        gold
    } else {
        let medallion = (x * x + y * y).sqrt() * (1.0 + 0.10 * (8.0 * libm::atan2(y, x)).cos());
        match medallion {
            m if m < 0.08 => red,
            m if m < 0.15 => cream,
            m if m < 0.27 => blue,
            m if m < 0.30 => gold,
            m if m < 0.44 => cream.lerp(red, 0.12),
            m if m < 0.47 => blue,
            _ if diamond(8.0) < 0.22 => gold,
            _ if diamond(8.0) > 0.82 => blue,
            _ => red,
        }
    };
    color * weave
}
