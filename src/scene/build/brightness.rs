//! How bright a scene is to somebody who starts his walk: what automatic exposure goes by.

use super::probe::{Probe, around};
use crate::geometry::PrimitiveIndex;
use crate::scene::light::{Falloff, LightKind};
use crate::scene::sky::luminance;
use crate::scene::{Camera, Light};
use glam::Vec3;

/// Columns and rows of the points that are looked at.
const GRID: [usize; 2] = [40, 22];
/// Width by height of the picture that they fill.
const ASPECT: u32 = 16;
const ASPECT_HEIGHT: u32 = 9;
/// Directions all around the eye, where the view shows nothing that is lit.
const AROUND: usize = 256;
/// Most rays towards lights: with many lights fewer points are looked at.
const SHADOW_RAYS: usize = 1 << 16;
/// Share of lit points that may be brighter than what [`HIGHLIGHT`] allows.
const BRIGHTEST: f64 = 0.05;
/// How many times brighter than usual the brightest points may be before they count as usual.
const HIGHLIGHT: f64 = 3.0;

/// The usual irradiance of the surfaces that `camera` sees: the mean of its logarithm over what is lit at all (Reinhard et
/// al., SIGGRAPH 2002), raised where much is far brighter. `None` where nothing is lit, or finding out takes
/// more than the probe may. An empty list of lights is a headlight.
pub fn usual_irradiance(probe: &mut Probe, camera: &Camera, lights: &[Light]) -> Option<f64> {
    let headlight = [at_eye(camera)];
    let lights = if lights.is_empty() { &headlight[..] } else { lights };
    let lit = irradiances(probe, camera, &view(camera), lights);
    let mut lit = if lit.is_empty() { irradiances(probe, camera, &around(AROUND), lights) } else { lit };
    if lit.is_empty() || probe.is_spent() {
        return None;
    }
    let mean = libm::exp(lit.iter().map(|e| libm::log(*e)).sum::<f64>() / lit.len() as f64);
    lit.sort_unstable_by(f64::total_cmp);
    let bright = lit[((1.0 - BRIGHTEST) * (lit.len() - 1) as f64) as usize];
    Some(mean.max(bright / HIGHLIGHT))
}

/// A point of what is seen.
pub struct Point {
    pub primitive: PrimitiveIndex,
    /// Unit geometric normal on the viewer's side.
    pub normal: Vec3,
    /// By all lights that reach it.
    pub irradiance: f64,
}

/// What `camera` sees, lit by `lights` or not.
pub fn points(probe: &mut Probe, camera: &Camera, lights: &[Light]) -> Vec<Point> {
    seen(probe, camera, &view(camera), lights)
}

/// A light at the eye.
pub fn at_eye(camera: &Camera) -> Light {
    let kind = LightKind::Point { position: camera.eye };
    Light { name: None, kind, color: Vec3::ONE, falloff: Falloff::None }
}

/// Directions through the points of a picture.
pub(super) fn view(camera: &Camera) -> Vec<Vec3> {
    let frame = camera.frame(ASPECT, ASPECT_HEIGHT);
    let at = |i: usize, count: usize| (2.0 * i as f32 + 1.0) / count as f32 - 1.0;
    let [columns, rows] = GRID;
    let points = (0..columns * rows).map(|i| (at(i % columns, columns), at(i / columns, rows)));
    points.map(|(x, y)| (frame.forward + frame.right * x + frame.up * y).normalize()).collect()
}

/// The irradiances, all above 0, of what lies in the given directions from the eye.
fn irradiances(probe: &mut Probe, camera: &Camera, directions: &[Vec3], lights: &[Light]) -> Vec<f64> {
    let irradiances = seen(probe, camera, directions, lights).into_iter().map(|point| point.irradiance);
    irradiances.filter(|irradiance| *irradiance > 0.0).collect()
}

/// What lies in the given directions from the eye.
fn seen(probe: &mut Probe, camera: &Camera, directions: &[Vec3], lights: &[Light]) -> Vec<Point> {
    let step = (directions.len() * lights.len()).div_ceil(SHADOW_RAYS).max(1);
    let directions: Vec<Vec3> = directions.iter().step_by(step).copied().collect();
    let met = probe.see(camera.eye, &directions, camera.near);
    let mut points = Vec::with_capacity(directions.len());
    for (met, direction) in met.into_iter().zip(directions) {
        let Some(met) = met else { continue };
        let point = camera.eye + direction * met.distance;
        let normal = if met.normal.dot(direction) > 0.0 { -met.normal } else { met.normal };
        let irradiance = irradiance(probe, point, normal, lights);
        let irradiance = if irradiance.is_finite() { irradiance } else { 0.0 };
        points.push(Point { primitive: met.primitive, normal, irradiance });
    }
    points
}

/// The irradiance of a point by all lights that reach it.
fn irradiance(probe: &mut Probe, point: Vec3, normal: Vec3, lights: &[Light]) -> f64 {
    let mut towards = Vec::with_capacity(lights.len());
    let mut arriving = Vec::with_capacity(lights.len());
    for light in lights {
        let (direction, distance) = match light.kind {
            LightKind::Directional { direction } => (-direction, f32::INFINITY),
            LightKind::Point { position } | LightKind::Spot { position, .. } => {
                ((position - point).normalize_or_zero(), position.distance(point))
            }
        };
        // A spot's smooth edge hardly counts.
        let missed = match light.kind {
            LightKind::Spot { direction: axis, cos_outer, .. } => -axis.dot(direction) < cos_outer,
            _ => false,
        };
        let cosine = f64::from(normal.dot(direction));
        if missed || cosine <= 0.0 {
            continue;
        }
        let weakened = match light.falloff {
            Falloff::InverseSquare if distance.is_finite() => f64::from(distance).powi(2),
            _ => 1.0,
        };
        towards.push(direction);
        arriving.push((distance, cosine * f64::from(luminance(light.color)) / weakened));
    }
    // Far enough from the surface not to meet it again.
    let step = 1e-4 * point.abs().max_element().max(1.0);
    let in_the_way = probe.look(point + normal * step, &towards, 0.0);
    let reaching = in_the_way.iter().zip(arriving);
    reaching
        .filter(|(met, (distance, _))| met.is_none_or(|met| met.distance >= distance * 0.999))
        .map(|(_, (_, e))| e)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, Part, PrimitiveId, Shape};

    fn floor() -> Geometry {
        let id = PrimitiveId { object: 0, primitive: 0 };
        let shape = Shape::Plane { point: Vec3::ZERO, normal: Vec3::Y };
        Geometry::build(vec![Part::new(shape, id)])
    }

    fn light(kind: LightKind, intensity: f32) -> Light {
        Light { name: None, kind, color: Vec3::splat(intensity), falloff: Falloff::InverseSquare }
    }

    #[test]
    fn the_sun_gives_its_lux_and_a_lamp_its_candela_over_the_square() {
        let geometry = floor();
        let mut probe = Probe::new(&geometry);
        let down = Camera { eye: Vec3::Y, look_at: Vec3::ZERO, up: Vec3::Z, fov: 2.0, ..Camera::default() };
        let mut usual = |kind| usual_irradiance(&mut probe, &down, &[light(kind, 100.0)]).unwrap_or(0.0);
        let sun = usual(LightKind::Directional { direction: Vec3::NEG_Y });
        let lamp = usual(LightKind::Point { position: Vec3::Y * 2.0 });
        assert!((sun - 100.0).abs() < 0.01 && (lamp - 25.0).abs() < 0.1, "{sun} {lamp}");
        assert_eq!(usual(LightKind::Directional { direction: Vec3::Y }), 0.0);
    }

    #[test]
    fn without_lights_the_headlight_counts() {
        let geometry = floor();
        let ahead = Camera { eye: Vec3::Y, look_at: Vec3::Z, ..Camera::default() };
        let usual = usual_irradiance(&mut Probe::new(&geometry), &ahead, &[]).unwrap();
        assert!((0.05..1.0).contains(&usual), "{usual}");
        assert_eq!(usual_irradiance(&mut Probe::new(&Geometry::default()), &ahead, &[]), None);
    }
}
