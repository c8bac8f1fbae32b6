//! Skies that are pictures of all directions.

use super::Irradiance;
use super::irradiance::Moments;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Linear radiance, finite and at least 0, in equirectangular layout, row by row from the top: the middle is seen along -Z, what
/// is right of it along +X.
#[derive(Clone, Copy, Debug)]
pub struct SkyMap<'a> {
    /// In texels, at least 1.
    pub width: u32,
    /// In texels, at least 1.
    pub height: u32,
    /// `width` x `height` of them.
    pub texels: &'a [[f32; 3]],
}

/// A sky as rough and matte surfaces reflect it.
#[derive(Clone, Debug, PartialEq)]
pub struct Blurred {
    /// For rising roughness, from [`LEAST_ROUGHNESS`] to 1.
    pub levels: Box<[GlossyLevel]>,
    /// What it gives matte surfaces.
    pub irradiance: Irradiance,
}

/// A sky as a surface of some roughness reflects it.
#[derive(Clone, Debug, PartialEq)]
pub struct GlossyLevel {
    /// Perceptual roughness, as glTF has it.
    pub roughness: f32,
    /// Of the blurred map.
    width: u32,
    texels: Box<[[f32; 3]]>,
}

impl GlossyLevel {
    /// The blurred sky.
    pub fn map(&self) -> SkyMap<'_> {
        SkyMap { width: self.width, height: self.width / 2, texels: &self.texels }
    }
}

/// Least roughness that the sky is blurred for: what is smoother mirrors rays.
pub const LEAST_ROUGHNESS: f32 = 0.1;
/// Roughness of the blurred maps and their widths in texels: each has a few texels across its kernel.
const LEVELS: [(f32, u32); 6] = [(LEAST_ROUGHNESS, 256), (0.2, 128), (0.3, 96), (0.45, 64), (0.65, 48), (1.0, 32)];
/// From which roughness on all of the sky is summed up, at most how wide: its kernels are far wider than those texels.
const SUMMED: [(f32, u32); 2] = [(0.6, 64), (0.3, 128)];
/// Directions whose mean is one texel of a sky that is blurred less.
const SAMPLES: u32 = 64;

impl Blurred {
    /// Of a picture.
    pub fn of(sharp: SkyMap<'_>) -> Self {
        let irradiance = sharp.irradiance();
        let halved = sharp.halved_again_and_again();
        let sizes: Vec<SkyMap<'_>> = std::iter::once(sharp).chain(halved.iter().map(Halved::map)).collect();
        let blur = |roughness, width| match SUMMED.iter().find(|(least, _)| roughness >= *least) {
            Some((_, widest)) => {
                let fits = sizes.iter().find(|size| size.width <= *widest);
                summed(fits.unwrap_or(&sharp), roughness, width)
            }
            None => sampled(&sizes, roughness, width),
        };
        let level = |(roughness, width)| GlossyLevel { roughness, width, texels: blur(roughness, width) };
        Self { irradiance, levels: LEVELS.map(level).into() }
    }
}

/// A picture at a smaller size.
struct Halved {
    width: u32,
    height: u32,
    texels: Box<[[f32; 3]]>,
}

impl Halved {
    fn map(&self) -> SkyMap<'_> {
        SkyMap { width: self.width, height: self.height, texels: &self.texels }
    }
}

impl SkyMap<'_> {
    /// Half as wide and high, rounded up, by the mean of up to four texels.
    fn halved(&self) -> Halved {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let texel = |x: u32, y: u32| DVec3::from_array(self.texels[(y * self.width + x) as usize].map(f64::from));
        let mean = |x: u32, y: u32| {
            let (right, below) = ((2 * x + 1).min(self.width - 1), (2 * y + 1).min(self.height - 1));
            let sum = texel(2 * x, 2 * y) + texel(right, 2 * y) + texel(2 * x, below) + texel(right, below);
            (sum / 4.0).as_vec3().to_array()
        };
        Halved { width, height, texels: painted(width, height, mean) }
    }

    fn halved_again_and_again(&self) -> Vec<Halved> {
        let mut sizes: Vec<Halved> = Vec::new();
        loop {
            let next = match sizes.last() {
                None => self.halved(),
                Some(last) if last.width.max(last.height) == 1 => return sizes,
                Some(last) => last.map().halved(),
            };
            sizes.push(next);
        }
    }

    fn irradiance(&self) -> Irradiance {
        let moments_of = |row: u32| {
            let mut moments = Moments::default();
            for column in 0..self.width {
                let direction = direction((self.width, self.height), column, row);
                let texel = self.texels[(row * self.width + column) as usize];
                // Towards the poles the same number of texels covers less.
                let across = libm::hypot(direction.x, direction.z);
                moments.add(direction, DVec3::from_array(texel.map(f64::from)), across);
            }
            moments
        };
        let rows: Vec<Moments> = (0..self.height).into_par_iter().map(moments_of).collect();
        rows.iter().fold(Moments::default(), |sum, row| sum.and(row)).irradiance()
    }

    /// A texel, where columns go on around and rows over the poles.
    pub fn texel(&self, column: i64, row: i64) -> [f32; 3] {
        let (width, height) = (i64::from(self.width), i64::from(self.height));
        let (inside, across) =
            if (0..height).contains(&row) { (row, 0) } else { (row.clamp(0, height - 1), width / 2) };
        self.texels[(inside * width + (column + across).rem_euclid(width)) as usize]
    }

    /// The radiance in a direction, interpolated between four texels.
    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        let DVec3 { x, y, z } = direction;
        let u = 0.5 + libm::atan2(x, -z) / TAU;
        let v = 0.5 - libm::atan2(y, libm::hypot(x, z)) / PI;
        let (x, y) = (u * f64::from(self.width) - 0.5, v * f64::from(self.height) - 0.5);
        let (left, above) = (x.floor(), y.floor());
        let (across, down) = (x - left, y - above);
        let texel = |x: f64, y: f64| DVec3::from_array(self.texel(x as i64, y as i64).map(f64::from));
        let row = |y: f64| texel(left, y) * (1.0 - across) + texel(left + 1.0, y) * across;
        row(above) * (1.0 - down) + row(above + 1.0) * down
    }
}

/// The texels of a picture of `width` x `height`, row by row from the top, given by column and row.
fn painted(width: u32, height: u32, texel: impl Fn(u32, u32) -> [f32; 3] + Sync) -> Box<[[f32; 3]]> {
    let texel = &texel;
    let rows = (0..height).into_par_iter();
    let texels: Vec<[f32; 3]> = rows.flat_map_iter(|row| (0..width).map(move |column| texel(column, row))).collect();
    texels.into()
}

/// Where the middle of a texel of a picture of `width` x `height` is seen.
fn direction((width, height): (u32, u32), column: u32, row: u32) -> DVec3 {
    let elevation = PI * (0.5 - (f64::from(row) + 0.5) / f64::from(height));
    let angle = TAU * ((f64::from(column) + 0.5) / f64::from(width) - 0.5);
    let across = libm::cos(elevation);
    DVec3::new(across * libm::sin(angle), libm::sin(elevation), -across * libm::cos(angle))
}

/// A direction of a kernel around +Z.
struct Tap {
    direction: DVec3,
    weight: f64,
    /// Solid angle that it stands for.
    around: f64,
}

/// The directions in which a surface of some roughness sees the sky when it is looked at from straight ahead (Karis, SIGGRAPH
/// 2013 course): half vectors by the Trowbridge-Reitz distribution, weighted by the cosine with the normal.
fn taps(roughness: f32) -> Vec<Tap> {
    let alpha2 = f64::from(roughness).powi(4);
    let tap = |i: u32| {
        // Hammersley's points.
        let share = (f64::from(i) + 0.5) / f64::from(SAMPLES);
        let angle = TAU * f64::from(i.reverse_bits()) / 4_294_967_296.0;
        let cos2 = (1.0 - share) / (1.0 + (alpha2 - 1.0) * share);
        let z = 2.0 * cos2 - 1.0;
        let across = (1.0 - z * z).max(0.0).sqrt();
        let spread = 1.0 + (alpha2 - 1.0) * cos2;
        let density = alpha2 / (PI * spread * spread) / 4.0;
        let direction = DVec3::new(across * libm::cos(angle), across * libm::sin(angle), z);
        Tap { direction, weight: z, around: 1.0 / (f64::from(SAMPLES) * density) }
    };
    (0..SAMPLES).map(tap).filter(|tap| tap.weight > 0.0).collect()
}

/// A sky, given at falling sizes, as a surface of some roughness reflects it: each direction of the kernel looks up the size
/// whose texels cover what it stands for (Křivánek and Colbert, "Real-time shading with filtered importance
/// sampling", EGSR 2008).
fn sampled(sizes: &[SkyMap<'_>], roughness: f32, width: u32) -> Box<[[f32; 3]]> {
    let texels_all_around = f64::from(sizes[0].width) * f64::from(sizes[0].height);
    let size_of = |tap: &Tap| {
        let texels = tap.around / (2.0 * TAU) * texels_all_around;
        let level = (0.5 * libm::log2(texels.max(1.0)) + 0.5).round();
        sizes[(level as usize).min(sizes.len() - 1)]
    };
    let taps = taps(roughness);
    let taps: Vec<(&Tap, SkyMap<'_>)> = taps.iter().map(|tap| (tap, size_of(tap))).collect();
    let weight: f64 = taps.iter().map(|(tap, _)| tap.weight).sum();
    let height = width / 2;
    let mean = |column: u32, row: u32| {
        let z = direction((width, height), column, row);
        let (x, y) = z.any_orthonormal_pair();
        let seen = |(tap, map): &(&Tap, SkyMap<'_>)| {
            let DVec3 { x: across, y: up, z: along } = tap.direction;
            map.radiance(x * across + y * up + z * along) * tap.weight
        };
        (taps.iter().map(seen).sum::<DVec3>() / weight).as_vec3().to_array()
    };
    painted(width, height, mean)
}

/// A sky as a surface of some roughness reflects it, by the sum over all texels.
fn summed(sky: &SkyMap<'_>, roughness: f32, width: u32) -> Box<[[f32; 3]]> {
    let alpha2 = f64::from(roughness).powi(4);
    let size = (sky.width, sky.height);
    let places = (0..sky.height).flat_map(|row| (0..sky.width).map(move |column| direction(size, column, row)));
    // Towards the poles the same number of texels covers less.
    let lights: Vec<(DVec3, f64, DVec3)> = places
        .zip(sky.texels)
        .map(|(place, texel)| (place, libm::hypot(place.x, place.z), DVec3::from_array(texel.map(f64::from))))
        .collect();
    let height = width / 2;
    let mean = |column: u32, row: u32| {
        let ahead = direction((width, height), column, row);
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for &(place, around, radiance) in &lights {
            let cosine = ahead.dot(place);
            if cosine > 0.0 {
                // The half vector's cosine, squared, is the mean of this one and 1.
                let spread = 1.0 + (alpha2 - 1.0) * (cosine + 1.0) / 2.0;
                let weight = around * cosine / (spread * spread);
                sum += radiance * weight;
                weights += weight;
            }
        }
        (sum / weights).as_vec3().to_array()
    };
    painted(width, height, mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::environment::SkyImage;
    use glam::Vec3;

    fn picture(width: u32, sky: impl Fn(DVec3) -> DVec3) -> SkyImage {
        let size = (width, width / 2);
        let places = (0..size.1).flat_map(|row| (0..width).map(move |column| (column, row)));
        let texels = places.map(|(column, row)| sky(direction(size, column, row)).as_vec3().to_array());
        SkyImage::new("test", size, texels.collect()).unwrap()
    }

    #[test]
    fn a_constant_sky_stays_so_however_blurred() {
        let image = picture(64, |_| DVec3::splat(0.7));
        for level in &image.blurred().levels {
            assert!(level.texels.iter().flatten().all(|value| (value - 0.7).abs() < 1e-5), "{}", level.roughness);
        }
        assert!(
            (image.blurred().irradiance.over_pi(Vec3::new(0.6, 0.0, 0.8)) - Vec3::splat(0.7)).abs().max_element()
                < 2e-3
        );
    }

    #[test]
    fn directions_are_where_the_layout_says() {
        let image = picture(256, |d| d.max(DVec3::ZERO));
        for direction in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.64, -0.48)] {
            let difference = image.map().radiance(direction) - direction.max(DVec3::ZERO);
            assert!(difference.abs().max_element() < 0.02, "{direction}: off by {difference}");
        }
        let size = (256, 128);
        assert!(direction(size, 128, 64).y < 0.0 && direction(size, 191, 63).x > 0.99);
        assert!(direction(size, 128, 63).z < -0.99);
    }

    /// A rough surface's reflection by a sum over many half vectors, straight ahead.
    fn reflected(sky: impl Fn(DVec3) -> DVec3, around: DVec3, roughness: f64) -> DVec3 {
        let alpha2 = roughness.powi(4);
        let (x, y) = around.any_orthonormal_pair();
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for i in 0..300 {
            let share = (i as f64 + 0.5) / 300.0;
            let cos2 = (1.0 - share) / (1.0 + (alpha2 - 1.0) * share);
            let along = 2.0 * cos2 - 1.0;
            let across = (1.0 - along * along).max(0.0).sqrt();
            for j in 0..300 {
                let angle = TAU * j as f64 / 300.0;
                let d = x * (across * angle.cos()) + y * (across * angle.sin()) + around * along;
                sum += sky(d) * along.max(0.0);
                weights += along.max(0.0);
            }
        }
        sum / weights
    }

    #[test]
    fn blurred_skies_are_those_of_a_sum_over_half_vectors() {
        let sky = |d: DVec3| DVec3::new((3.0 * d.x).sin().abs(), (2.0 * d.y + d.z).max(0.0), 1.0 + 0.5 * d.z);
        let image = picture(512, sky);
        for level in &image.blurred().levels {
            for direction in [DVec3::X, DVec3::Y, DVec3::new(0.6, -0.48, -0.64)] {
                let difference = level.map().radiance(direction) - reflected(sky, direction, level.roughness.into());
                assert!(difference.abs().max_element() < 0.04, "{} {direction}: {difference}", level.roughness);
            }
        }
    }
}
