//! The pictures on the gallery's walls.

use crate::canvas::{ramp, rgb, smoothstep};
use crate::noise::{fractal, hash, value};
use glam::{DVec2, DVec3};

/// A grid of black bars with a few primary fields.
pub fn squares(u: f64, v: f64) -> DVec3 {
    /// Left, bottom, right, top, colour.
    const FIELDS: &[(f64, f64, f64, f64, u32)] = &[
        (0.34, 0.36, 1.00, 1.00, 0xc3241c),
        (0.00, 0.00, 0.34, 0.36, 0x1e4a94),
        (0.86, 0.00, 1.00, 0.16, 0xe3b821),
        (0.00, 0.68, 0.34, 1.00, 0xe9e4d6),
        (0.34, 0.00, 0.86, 0.36, 0xf0ecdf),
    ];
    /// Bars: whether upright, position, from, to, half-width.
    const BARS: &[(bool, f64, f64, f64, f64)] = &[
        (true, 0.34, 0.0, 1.0, 0.014),
        (false, 0.36, 0.0, 1.0, 0.014),
        (false, 0.68, 0.0, 0.34, 0.020),
        (true, 0.86, 0.0, 0.36, 0.014),
        (false, 0.16, 0.86, 1.0, 0.020),
    ];
    let on_bar = BARS.iter().any(|&(upright, position, from, to, half)| {
        let (across, along) = if upright { (u, v) } else { (v, u) };
        (across - position).abs() < half && (from..=to).contains(&along)
    });
    if on_bar {
        return rgb(0x14120f);
    }
    let field = FIELDS.iter().find(|f| (f.0..f.2).contains(&u) && (f.1..f.3).contains(&v));
    field.map_or(rgb(0xe9e4d6), |f| rgb(f.4)) * (0.96 + 0.04 * fractal(u, v, 24, 2, 1))
}

/// The sun going down over the sea.
pub fn sunset(u: f64, v: f64) -> DVec3 {
    const HORIZON: f64 = 0.36;
    let sun = DVec2::new(0.60, 0.47);
    let sky = [rgb(0xf6c15c), rgb(0xf08a4b), rgb(0xc9506a), rgb(0x6d3f7c), rgb(0x2c2a5a)];
    if v > HORIZON {
        let streak =
            smoothstep(0.55, 0.75, value(u * 3.0, v * 26.0, 8, 64, 4) * 0.7 + value(u * 7.0, v * 40.0, 8, 64, 5) * 0.3);
        let air = ramp(&sky, (v - HORIZON) / (1.0 - HORIZON)).lerp(rgb(0xffd9a0), 0.5 * streak * (1.2 - v));
        let distance = DVec2::new(u, v).distance(sun);
        let glow = air.lerp(rgb(0xffe6a8), 0.6 * (1.0 - smoothstep(0.08, 0.38, distance)));
        let lit = glow.lerp(rgb(0xfff4d2), 1.0 - smoothstep(0.085, 0.090, distance));
        let hills = HORIZON + 0.10 * smoothstep(0.45, 0.0, u) * (0.6 + 0.8 * value(u * 6.0, 0.5, 16, 2, 6));
        if v < hills { rgb(0x3a2450) } else { lit }
    } else {
        let depth = (HORIZON - v) / HORIZON;
        let water = ramp(&[rgb(0xc9605c), rgb(0x5c3a70), rgb(0x1d2148)], depth);
        let ripple = value(u * 9.0, v * (90.0 - 50.0 * depth), 16, 128, 7);
        let path = (1.0 - smoothstep(0.02, 0.10 + 0.10 * depth, (u - sun.x).abs())) * smoothstep(0.35, 0.6, ripple);
        water.lerp(rgb(0xffd98e), 0.9 * path).lerp(rgb(0x15183a), 0.25 * smoothstep(0.6, 0.9, ripple) * depth)
    }
}

/// The Julia set of z² - 0.745 + 0.113i, coloured by escape time.
pub fn julia(u: f64, v: f64) -> DVec3 {
    let c = DVec2::new(-0.745, 0.113);
    let mut z = DVec2::new((u - 0.5) * 1.9, (v - 0.5) * 1.9).rotate(DVec2::new(0.8, 0.6));
    for step in 0..160 {
        let length = z.length_squared();
        if length > 64.0 {
            // The fraction of a step by which it got away makes the bands one smooth ramp.
            let escape = f64::from(step) + 1.0 - libm::log2(0.5 * libm::log2(length));
            let palette = [
                rgb(0x0b1030),
                rgb(0x17406d),
                rgb(0x3a86a8),
                rgb(0xf1e4c3),
                rgb(0xe0913a),
                rgb(0x6b1f2a),
                rgb(0x160b1f),
            ];
            return ramp(&palette, libm::sqrt(escape / 110.0));
        }
        z = DVec2::new(z.x * z.x - z.y * z.y, 2.0 * z.x * z.y) + c;
    }
    rgb(0x0a0612)
}

/// Rows of breaking waves under a pale sky.
pub fn waves(u: f64, v: f64) -> DVec3 {
    const ROWS: i64 = 7;
    let mut color = ramp(&[rgb(0xe9d9b5), rgb(0xf0e6cc), rgb(0xcfd3c4)], v);
    let sun = DVec2::new(0.27, 0.80);
    if DVec2::new(u, v).distance(sun) < 0.085 {
        color = rgb(0xcf4a35);
    }
    for row in (0..ROWS).rev() {
        let depth = row as f64 / (ROWS - 1) as f64;
        let scale = 1.0 - 0.65 * depth;
        let x = u / scale * 2.2 + hash(row, 0, 11) * 3.0;
        // A crest that leans over: the phase is pulled forward where the wave is high.
        let lean = x + 0.12 * libm::sin(std::f64::consts::TAU * x);
        let crest = 0.5 - 0.5 * libm::cos(std::f64::consts::TAU * lean);
        let height = 0.05 + 0.60 * depth + 0.17 * scale * crest * crest;
        let below = height - v;
        if below > 0.0 {
            let water = ramp(&[rgb(0x12325c), rgb(0x2c5f8c), rgb(0x8fb3b5)], depth);
            let stripe = libm::sin(below * 90.0 / scale + 6.0 * crest);
            color = water.lerp(rgb(0xe8e6d6), 0.55 * smoothstep(0.75, 0.95, stripe) * (1.0 - 0.6 * depth));
            let foam = 0.022 * scale * (0.4 + crest) * (0.6 + 0.8 * value(x * 14.0, below * 40.0, 64, 64, 12));
            if below < foam {
                color = rgb(0xf6f1e2);
            }
        }
    }
    color
}

/// Mountains behind mountains in moonlight.
pub fn night(u: f64, v: f64) -> DVec3 {
    let moon = DVec2::new(0.68, 0.78);
    let distance = DVec2::new(u, v).distance(moon);
    let mut color = ramp(&[rgb(0x3f6c8f), rgb(0x1f3d66), rgb(0x0f1f40), rgb(0x081028)], v);
    let cell = DVec2::new(u, v) * 26.0;
    let (i, j) = (cell.x as i64, cell.y as i64);
    let star = DVec2::new(i as f64 + 0.2 + 0.6 * hash(i, j, 21), j as f64 + 0.2 + 0.6 * hash(i, j, 22));
    if hash(i, j, 20) > 0.78 && cell.distance(star) < 0.05 + 0.07 * hash(i, j, 23) {
        color = rgb(0xdfe9f2);
    }
    color = color.lerp(rgb(0x9fc0d8), 0.5 * (1.0 - smoothstep(0.08, 0.34, distance)));
    if distance < 0.085 {
        color = rgb(0xf2f1e4) * (0.9 + 0.1 * fractal(u, v, 12, 2, 24));
    }
    for range in 0..5_i64 {
        let nearness = range as f64 / 4.0;
        let ridge = 0.56 - 0.47 * nearness
            + 0.30
                * (1.0 - 0.5 * nearness)
                * (fractal(u * 0.5 + 0.1 * range as f64, 0.3, 6, 5, 25 + 9 * range as u32) - 0.42);
        if v < ridge {
            let mist = smoothstep(ridge - 0.25, ridge, v);
            color = rgb(0x5d88a6)
                .lerp(rgb(0x0a1424), 0.25 + 0.75 * nearness)
                .lerp(rgb(0x7fa5bd), 0.25 * (1.0 - mist) * (1.0 - nearness));
        }
    }
    color
}

/// Discs, rings and beams on a cream ground.
pub fn circles(u: f64, v: f64) -> DVec3 {
    /// Centre, outer and inner radius, colour; later ones lie on top.
    const DISCS: &[(f64, f64, f64, f64, u32)] = &[
        (0.40, 0.56, 0.30, 0.000, 0xd9c9a3),
        (0.40, 0.56, 0.26, 0.000, 0x23395d),
        (0.40, 0.56, 0.18, 0.000, 0xc8452f),
        (0.40, 0.56, 0.10, 0.000, 0xe8b23c),
        (0.78, 0.26, 0.13, 0.095, 0x1b1b1b),
        (0.78, 0.26, 0.06, 0.000, 0x3d7a6e),
        (0.76, 0.80, 0.09, 0.000, 0x9d2f4d),
        (0.18, 0.18, 0.05, 0.000, 0x1b1b1b),
    ];
    /// Beams: both ends, half-width, colour.
    const BEAMS: &[(f64, f64, f64, f64, f64, u32)] = &[
        (0.05, 0.08, 0.95, 0.66, 0.012, 0x1b1b1b),
        (0.10, 0.92, 0.90, 0.10, 0.007, 0x1b1b1b),
        (0.55, 0.94, 0.97, 0.52, 0.024, 0xe0a63a),
        (0.06, 0.30, 0.34, 0.06, 0.018, 0x3d7a6e),
    ];
    let point = DVec2::new(u, v);
    let mut color = rgb(0xefe6d0) * (0.96 + 0.04 * fractal(u, v, 16, 3, 40));
    for &(x, y, outer, inner, hex) in DISCS {
        if (inner..outer).contains(&point.distance(DVec2::new(x, y))) {
            color = rgb(hex);
        }
    }
    for &(x0, y0, x1, y1, half, hex) in BEAMS {
        let (start, end) = (DVec2::new(x0, y0), DVec2::new(x1, y1));
        let along = ((point - start).dot(end - start) / start.distance_squared(end)).clamp(0.0, 1.0);
        if point.distance(start.lerp(end, along)) < half {
            color = rgb(hex);
        }
    }
    color
}

/// Quarter arcs on square tiles, each tile turned by chance (Truchet's tiles, after Smith).
pub fn arcs(u: f64, v: f64) -> DVec3 {
    const TILES: f64 = 7.0;
    let (x, y) = (u * TILES, v * TILES);
    let (i, j) = (x as i64, y as i64);
    let turned = hash(i, j, 51) < 0.5;
    let (s, t) = (if turned { 1.0 - x.fract() } else { x.fract() }, y.fract());
    let near = DVec2::new(s, t).length();
    let far = DVec2::new(1.0 - s, 1.0 - t).length();
    // Which of the two sides of the arcs a corner lies on alternates from tile to tile.
    let inside = near < 0.5 || far < 0.5;
    let dark = inside ^ turned ^ ((i + j) % 2 == 0);
    let ground = if dark { rgb(0x1f5a5e) } else { rgb(0xe9dcc0) };
    let line = (near - 0.5).abs().min((far - 0.5).abs());
    let warmth = fractal(u, v, 3, 2, 52);
    let color = if dark { ground.lerp(rgb(0x173a52), warmth) } else { ground.lerp(rgb(0xe0b877), 0.8 * warmth) };
    if line < 0.045 { rgb(0xc2612c) } else { color }
}

/// Poppies in a field under a summer sky.
pub fn poppies(u: f64, v: f64) -> DVec3 {
    const HORIZON: f64 = 0.60;
    if v > HORIZON {
        let cloud = smoothstep(0.50, 0.72, fractal(u * 0.6 + 0.2, v, 4, 5, 61)) * smoothstep(1.1, 0.75, v);
        let sky = ramp(&[rgb(0xcfe0e6), rgb(0x7fb0d6), rgb(0x4a86c2)], (v - HORIZON) / (1.0 - HORIZON));
        let trees = HORIZON + 0.02 + 0.05 * fractal(u, 0.2, 10, 4, 62);
        return if v < trees { rgb(0x3f5a3a) } else { sky.lerp(rgb(0xfbf6ea), 0.9 * cloud) };
    }
    let depth = v / HORIZON;
    let mut color = ramp(&[rgb(0x4f6f2a), rgb(0x86963f), rgb(0xc9b565)], depth);
    color *= 0.80 + 0.35 * value(u * 60.0, v * 14.0, 64, 64, 63);
    // Rows of flowers from far to near, larger towards the bottom, so that near ones lie on top.
    const ROWS: i64 = 16;
    for row in (0..ROWS).rev() {
        let height = HORIZON * libm::pow((row as f64 + 0.5) / ROWS as f64, 0.75) - 0.01;
        let size = 0.008 + 0.045 * (1.0 - height / HORIZON);
        let x = u / (size * 2.6) + hash(row, 0, 64) * 7.0;
        let column = x.floor() as i64;
        if hash(column, row, 65) < 0.35 {
            continue;
        }
        let center = column as f64 + 0.3 + 0.4 * hash(column, row, 66);
        let offset = DVec2::new((x - center) * 2.6, (v - height) / size * 1.35);
        let petals = offset.length()
            * (1.0 + 0.12 * libm::cos(4.0 * libm::atan2(offset.y, offset.x) + 6.0 * hash(column, row, 67)));
        if petals < 0.22 {
            color = rgb(0x2a1420);
        } else if petals < 0.85 {
            color = rgb(0xb61f1a)
                .lerp(rgb(0xe8512c), smoothstep(-0.6, 0.7, offset.y) * (0.6 + 0.4 * hash(column, row, 68)));
        }
    }
    color
}

/// Birches in blue winter light.
pub fn birches(u: f64, v: f64) -> DVec3 {
    /// Foot, width and lean of the trunks, far ones first; the last number is how much haze is before it.
    const TRUNKS: &[(f64, f64, f64, f64)] = &[
        (0.16, 0.022, 0.02, 0.70),
        (0.44, 0.020, -0.01, 0.70),
        (0.66, 0.024, 0.01, 0.65),
        (0.90, 0.022, -0.02, 0.65),
        (0.30, 0.040, -0.03, 0.35),
        (0.78, 0.044, 0.03, 0.35),
        (0.09, 0.070, 0.02, 0.0),
        (0.55, 0.080, -0.03, 0.0),
    ];
    let haze = ramp(&[rgb(0xdfe8ee), rgb(0xa9c4d8), rgb(0x6f97bb), rgb(0x4b74a0)], v);
    let mut color = haze
        .lerp(rgb(0x3d628c), 0.5 * smoothstep(0.45, 0.75, fractal(u, v * 0.5, 6, 4, 71)) * smoothstep(0.15, 0.5, v));
    if v < 0.17 + 0.03 * fractal(u, 0.1, 3, 3, 72) {
        color = rgb(0xeef3f6).lerp(rgb(0xa9c0d6), smoothstep(0.4, 0.7, fractal(u, v, 5, 3, 73)));
    }
    for (number, &(foot, width, lean, far)) in TRUNKS.iter().enumerate() {
        let ground = 0.03 + 0.14 * far / 0.7;
        let wobble = 0.012 * (fractal(0.37, v, 3, 2, 80 + number as u32) - 0.5);
        let across = (u - foot - lean * v - wobble) / width;
        if v < ground || across.abs() > 0.5 {
            continue;
        }
        let round = 1.0 - 1.6 * (across + 0.12) * (across + 0.12);
        let mark = value(across * 1.6 + 3.0, v * 26.0 * (0.08 / width).min(2.0), 64, 64, 90 + number as u32);
        let bark = rgb(0xf3efe6).lerp(rgb(0x2b2a30), 0.85 * smoothstep(0.66, 0.74, mark)) * round;
        color = bark.lerp(haze, far);
    }
    color
}
