//! Skies in closed form: a gradient from the horizon up and down, and soft lights in it.

use super::super::environment::Gradient;
use super::{BRIGHTEST, bounded, turned};
use glam::{DVec3, Vec3};

/// base + slope y + bend |y|, y being the sine of the elevation, and the light of lobes.
#[derive(Clone, Debug, PartialEq)]
pub struct Smooth {
    /// Radiance at the horizon.
    pub base: Vec3,
    /// How it grows from straight down to straight up.
    pub slope: Vec3,
    /// How it grows from the horizon to both.
    pub bend: Vec3,
    /// Soft lights.
    pub lobes: Vec<Lobe>,
}

/// A soft light: its radiance is peak / (1 + focus (1 - c))², c being the cosine with its axis.
///
/// That shape has a closed integral over all directions, 4π peak / (1 + 2 focus), so that it stays exactly as bright
/// when it is blurred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Unit vector to its middle.
    pub axis: Vec3,
    /// How narrow it is, above 0.
    pub focus: f32,
    /// Radiance of its middle, the same in all channels.
    pub peak: f32,
}

impl Smooth {
    /// Without soft lights.
    pub fn of_gradient(&Gradient { zenith, horizon, ground }: &Gradient) -> Self {
        Self {
            base: horizon,
            slope: (zenith - ground) * 0.5,
            bend: (zenith + ground) * 0.5 - horizon,
            lobes: Vec::new(),
        }
    }

    /// A neutral studio, for somebody who looks along -Z: cool above, a bright horizon, dim and warm below, a large soft light
    /// to the left above, a smaller one to the right behind what is seen.
    pub fn studio() -> Self {
        let gradient = Gradient {
            zenith: Vec3::new(0.34, 0.38, 0.43),
            horizon: Vec3::new(0.66, 0.66, 0.66),
            ground: Vec3::new(0.20, 0.18, 0.16),
        };
        let lobe = |axis: Vec3, focus, peak| Lobe { axis: axis.normalize(), focus, peak };
        let lobes = vec![lobe(Vec3::new(-0.6, 0.7, 0.6), 10.0, 4.5), lobe(Vec3::new(0.85, 0.35, -0.1), 16.0, 3.0)];
        Self { lobes, ..Self::of_gradient(&gradient) }
    }

    /// What is seen behind things in the studio: plainer and darker than what lights them.
    pub fn studio_backdrop() -> Self {
        let (zenith, ground) = (Vec3::new(0.36, 0.40, 0.46), Vec3::new(0.125, 0.125, 0.13));
        // No horizon is seen.
        Self::of_gradient(&Gradient { zenith, horizon: (zenith + ground) * 0.5, ground })
    }

    /// The radiance in a unit direction.
    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        let y = direction.y;
        let gradient = self.base.as_dvec3() + self.slope.as_dvec3() * y + self.bend.as_dvec3() * y.abs();
        gradient + DVec3::splat(self.lobes.iter().map(|lobe| lobe.radiance(direction)).sum())
    }

    /// So many times as bright.
    pub fn scaled(&self, factor: f32) -> Self {
        Self {
            base: bounded(self.base * factor),
            slope: bounded(self.slope * factor),
            bend: bounded(self.bend * factor),
            lobes: self.lobes.iter().map(|lobe| Lobe { peak: (lobe.peak * factor).min(BRIGHTEST), ..*lobe }).collect(),
        }
    }

    /// Turned to the left about +Y by the angle of this cosine and sine.
    pub fn turned(self, turn: [f64; 2]) -> Self {
        let around = |lobe: Lobe| Lobe { axis: turned(lobe.axis.as_dvec3(), turn).as_vec3().normalize(), ..lobe };
        Self { lobes: self.lobes.into_iter().map(around).collect(), ..self }
    }
}

impl Lobe {
    fn radiance(&self, direction: DVec3) -> f64 {
        let off = 1.0 - self.axis.as_dvec3().dot(direction);
        f64::from(self.peak) / (1.0 + f64::from(self.focus) * off).powi(2)
    }
}
