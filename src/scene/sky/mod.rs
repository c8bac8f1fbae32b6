//! The light of a sky: its radiance as shading needs it.
//!
//! Three forms of one sky. Misses, mirrors and glass look its radiance up; rough surfaces reflect it blurred (Karis, "Real
//! shading in Unreal Engine 4", SIGGRAPH 2013 course); matte ones are lit by its irradiance, which its moments up to the
//! second order give within about 1 % (Ramamoorthi and Hanrahan, "An efficient representation for irradiance
//! environment maps", SIGGRAPH 2001).

mod irradiance;
mod picture;
mod smooth;

pub use irradiance::Irradiance;
pub use picture::{Blurred, GlossyLevel, LEAST_ROUGHNESS, SkyMap};
pub use smooth::{Lobe, Smooth};

use super::environment::{Environment, Sky, SkyImage};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// A sky made ready for shading.
#[derive(Clone, Debug)]
pub struct SkyLight {
    /// Its radiance.
    pub radiance: Radiance,
    /// What it gives matte surfaces.
    pub irradiance: Irradiance,
    /// Whether rays from the eye that hit nothing show it.
    pub backdrop: bool,
    /// What these see of it is bright as shown, whatever the exposure.
    pub backdrop_as_shown: Option<Smooth>,
}

/// The radiance of a sky in every direction.
#[derive(Clone, Debug)]
pub enum Radiance {
    /// In closed form.
    Smooth(Smooth),
    /// A picture of it.
    Image {
        /// All around.
        image: Arc<SkyImage>,
        /// Cosine and sine of the angle by which it is turned to the left.
        turn: [f32; 2],
        /// Multiplies it.
        intensity: f32,
    },
}

impl SkyLight {
    /// The light of an environment.
    pub fn new(environment: &Environment) -> Self {
        let &Environment { rotation, intensity, backdrop, .. } = environment;
        let angle = f64::from(rotation).to_radians();
        let turn = [libm::cos(angle), libm::sin(angle)];
        let (radiance, irradiance) = match &environment.sky {
            Sky::Gradient(gradient) => of_smooth(Smooth::of_gradient(gradient), turn, intensity),
            Sky::Studio => of_smooth(Smooth::studio(), turn, intensity),
            Sky::Image(image) => {
                let radiance =
                    Radiance::Image { image: Arc::clone(image), turn: turn.map(|value| value as f32), intensity };
                (radiance, image.blurred().irradiance.scaled(intensity).turned(turn))
            }
        };
        let backdrop_as_shown = (environment.sky == Sky::Studio).then(Smooth::studio_backdrop);
        Self { radiance, irradiance, backdrop, backdrop_as_shown }
    }
}

fn of_smooth(smooth: Smooth, turn: [f64; 2], intensity: f32) -> (Radiance, Irradiance) {
    let smooth = smooth.turned(turn).scaled(intensity);
    let irradiance = Irradiance::of(|direction| smooth.radiance(direction));
    (Radiance::Smooth(smooth), irradiance)
}

/// A direction turned to the left about +Y by the angle of this cosine and sine.
fn turned(direction: DVec3, [cos, sin]: [f64; 2]) -> DVec3 {
    let DVec3 { x, y, z } = direction;
    DVec3::new(x * cos + z * sin, y, z * cos - x * sin)
}

/// Radiance beyond which sums in single precision would not stay finite.
pub const BRIGHTEST: f32 = 1e30;

/// A colour, or what makes it up, within what sums stay finite for.
fn bounded(color: Vec3) -> Vec3 {
    color.clamp(Vec3::splat(-BRIGHTEST), Vec3::splat(BRIGHTEST))
}

/// Luminance of linear sRGB.
pub fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
