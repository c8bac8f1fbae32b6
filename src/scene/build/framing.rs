//! The camera of a scene that gives none: one that sees everything finite.

use crate::geometry::Aabb;
use crate::scene::{Camera, RenderDefaults};
use glam::{DVec3, Vec3};

/// Where the eye stands as seen from the middle: a little to the right, above, in front.
const VIEW_FROM: DVec3 = DVec3::new(0.45, 0.35, 1.0);
/// Room left around what is framed.
const MARGIN: f64 = 1.05;
/// Width by height of a picture whose scene gives none.
const ASPECT: f64 = 16.0 / 9.0;

/// A camera whose picture holds the sphere around `bounds`; without any, one at eye height that looks at the origin.
pub fn frame(bounds: Aabb, render: &RenderDefaults) -> Camera {
    let defaults = Camera::default();
    if bounds.is_empty() {
        return Camera { eye: Vec3::new(0.0, 1.6, 5.0), ..defaults };
    }
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let center = (min + max) / 2.0;
    // Far from the origin the eye must stay a few roundings away from what it looks at.
    let radius = ((max - min).length() / 2.0).max(center.abs().max_element() * 1e-5).max(1e-30);
    let aspect = match (render.width, render.height) {
        (Some(width), Some(height)) => f64::from(width) / f64::from(height),
        _ => ASPECT,
    };
    let half_height = libm::tan(f64::from(defaults.fov).to_radians() / 2.0);
    let narrow = libm::atan(half_height * aspect.min(1.0));
    let distance = MARGIN * radius / libm::sin(narrow);
    let eye = center + VIEW_FROM.normalize() * distance;
    let camera = Camera { eye: eye.as_vec3(), look_at: center.as_vec3(), ..defaults };
    if camera.is_valid() { camera } else { defaults }
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
        ];
        for (min, max) in boxes {
            for (width, height) in [(1280, 720), (300, 1200), (500, 500)] {
                let render = RenderDefaults { width: Some(width), height: Some(height), ..RenderDefaults::default() };
                let camera = frame(Aabb { min, max }, &render);
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
        assert!(frame(Aabb::EMPTY, &RenderDefaults::default()).is_valid());
        let far = Aabb { min: Vec3::splat(1e6), max: Vec3::splat(1e6) };
        assert!(frame(far, &RenderDefaults::default()).is_valid());
    }
}
