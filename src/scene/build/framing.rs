//! The camera of a scene that gives none: one inside of it where it is an interior, else one that sees everything finite.

use super::probe::Probe;
use super::{brightness, interior};
use crate::geometry::Aabb;
use crate::scene::{Camera, RenderDefaults};
use glam::{DVec3, Vec3};

/// Where the eye stands as seen from the middle: a little to the right, above, in front.
const VIEW_FROM: DVec3 = DVec3::new(0.45, 0.35, 1.0);
/// Things thinner than this share of their greatest length are seen face on.
const THIN: f64 = 0.1;
/// How much of the usual view is left in that of thin things. What lies has things on it that stand.
const SLANT: f64 = 0.3;
const SLANT_OF_GROUND: f64 = 0.9;
/// Room left around what is framed.
const MARGIN: f64 = 1.05;
/// Width by height of a picture whose scene gives none: a wide one is safe in both of the usual ones.
const ASPECT: f64 = 4.0 / 3.0;

/// The camera of a scene whose finite objects lie in `bounds`, and whether it stands on a floor.
pub fn start(probe: &mut Probe, bounds: Aabb, render: &RenderDefaults) -> (Camera, bool) {
    match interior::stand(probe, bounds) {
        Some(camera) => (camera, true),
        None => (outside(probe, bounds, render), false),
    }
}

/// A camera that sees everything finite, from the side where fronts are seen.
fn outside(probe: &mut Probe, bounds: Aabb, render: &RenderDefaults) -> Camera {
    let camera = frame(bounds, render, false);
    let shows = |probe: &mut Probe, camera: &Camera| {
        probe.see(camera.eye, &brightness::view(camera), camera.near).iter().any(Option::is_some)
    };
    if !probe.knows_backs() || shows(probe, &camera) {
        return camera;
    }
    // It shows nothing but backs, which are not seen.
    let other = frame(bounds, render, true);
    if shows(probe, &other) { other } else { camera }
}

/// A camera whose picture holds `bounds`, from the other side if `from_behind`; without any, one at eye height that looks
/// at the origin.
fn frame(bounds: Aabb, render: &RenderDefaults, from_behind: bool) -> Camera {
    let defaults = Camera::default();
    if bounds.is_empty() {
        return Camera { eye: Vec3::new(0.0, 1.6, 5.0), ..defaults };
    }
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let (center, half) = ((min + max) / 2.0, (max - min) / 2.0);
    let aspect = match (render.width, render.height) {
        (Some(width), Some(height)) => f64::from(width) / f64::from(height),
        _ => ASPECT,
    };
    let from = if from_behind { -view_from(half) } else { view_from(half) };
    let right = DVec3::Y.cross(from).normalize();
    let up = from.cross(right);
    let half_height = libm::tan(f64::from(defaults.fov).to_radians() / 2.0);
    let mut distance = 0.0_f64;
    for corner in 0..8 {
        let sign = |axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
        let corner = DVec3::new(sign(0), sign(1), sign(2)) * half;
        let across = (corner.dot(right).abs() / aspect).max(corner.dot(up).abs());
        distance = distance.max(corner.dot(from) + MARGIN * across / half_height);
    }
    // Far from the origin the eye must stay a few roundings away from what it looks at.
    let eye = center + from * distance.max(center.abs().max_element() * 1e-5).max(1e-30);
    let camera = Camera { eye: eye.as_vec3(), look_at: center.as_vec3(), ..defaults };
    if camera.is_valid() { camera } else { defaults }
}

/// The direction from the middle of a box, given its half size, to the eye.
fn view_from(half: DVec3) -> DVec3 {
    let thinnest = half.min_position();
    if half[thinnest] > THIN * half.max_element() {
        return VIEW_FROM.normalize();
    }
    let slant = if thinnest == 1 { SLANT_OF_GROUND } else { SLANT };
    (DVec3::AXES[thinnest] + VIEW_FROM * slant).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sees(camera: &Camera, point: Vec3, aspect: f32) -> bool {
        let frame = camera.frame((1000.0 * aspect) as u32, 1000);
        let to = (point - camera.eye).as_dvec3();
        let depth = to.dot(frame.forward.as_dvec3());
        let across = to.dot(frame.right.as_dvec3()) / frame.right.as_dvec3().length_squared();
        let above = to.dot(frame.up.as_dvec3()) / frame.up.as_dvec3().length_squared();
        depth > 0.0 && across.abs() <= depth && above.abs() <= depth
    }

    #[test]
    fn every_corner_is_in_the_picture_whatever_its_shape() {
        let boxes = [
            (Vec3::splat(-1.0), Vec3::splat(1.0)),
            (Vec3::new(100.0, 0.0, -5.0), Vec3::new(101.0, 200.0, -4.0)),
            (Vec3::splat(-1e20), Vec3::splat(1e20)),
            (Vec3::splat(1e-9), Vec3::splat(2e-9)),
            (Vec3::new(-3.0, 0.0, -2.0), Vec3::new(3.0, 0.0, 2.0)),
        ];
        for (min, max) in boxes {
            for (width, height) in [(1280, 720), (300, 1200), (500, 500)] {
                let render = RenderDefaults { width: Some(width), height: Some(height), ..RenderDefaults::default() };
                let camera = frame(Aabb { min, max }, &render, false);
                assert!(camera.is_valid());
                for corner in 0..8 {
                    let pick = |axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
                    let point = Vec3::new(pick(0), pick(1), pick(2));
                    assert!(sees(&camera, point, width as f32 / height as f32), "{point} {width}x{height}");
                }
            }
        }
    }

    #[test]
    fn nothing_finite_still_gives_a_camera() {
        assert!(frame(Aabb::EMPTY, &RenderDefaults::default(), false).is_valid());
        let far = Aabb { min: Vec3::splat(1e6), max: Vec3::splat(1e6) };
        assert!(frame(far, &RenderDefaults::default(), false).is_valid());
    }

    #[test]
    fn thin_things_are_seen_face_on_and_ground_from_above() {
        assert!(view_from(DVec3::new(3.0, 2.0, 0.0)).z > 0.9 && view_from(DVec3::new(0.1, 2.0, 3.0)).x > 0.9);
        let above = view_from(DVec3::new(3.0, 0.1, 2.0)).y;
        assert!((0.7..0.9).contains(&above), "{above}");
    }
}
