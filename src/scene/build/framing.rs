//! The camera of a scene that gives none: one on foot where there is floor to walk on, else one that frames the subject.

use super::floors::{Floors, Scale};
use super::probe::Probe;
use super::spawn::{self, Spawn};
use super::stand::Stand;
use super::subject::Subject;
use super::surface_samples::SurfaceSamples;
use super::{brightness, interior, level};
use crate::geometry::Aabb;
use crate::scene::start::{Entry, Start, Unit};
use crate::scene::{Camera, RenderDefaults};
use glam::{DVec3, Vec3};

/// Where the eye stands as seen from the middle: a little to the right, above, in front.
const VIEW_FROM: DVec3 = DVec3::new(0.45, 0.35, 1.0);
/// Things thinner than this share of their greatest length are seen face on.
const THIN: f64 = 0.1;
/// How much of the usual view is left in that of thin things. What lies has things on it that stand.
const SLANT: f64 = 0.3;
const SLANT_OF_GROUND: f64 = 0.9;
/// Vertical field of view that things are framed by, in degrees: a wider one distorts what is near.
const FOV: f32 = 45.0;
/// Room left around what is framed.
const MARGIN: f64 = 1.08;
/// Width by height of a picture whose scene gives none. What is framed so fits 4:3 and fills two thirds of the width in 16:9.
const ASPECT: f64 = 4.0 / 3.0;
/// Least height of a scene that is not small, and least walkable area of a room in such a scene, in metres.
const SMALL: f32 = 1.9;
const CLOSET: f32 = 3.0;
/// Things lower than this share of their width are seen from so many of their half heights above their top, if need be from a
/// direction that is raised by so much.
const LOW: f64 = 0.7;
const ABOVE_TOP: f64 = 0.4;
const RAISED: [f64; 3] = [0.2, 0.4, 0.7];
/// Least share of the picture's points that show a front.
const SHOWN: f64 = 0.02;

/// The camera of a scene of so many objects that gives none, and how it was found. `spawn` is where the file lets players
/// start. Last, the bounds of what the scene is about.
pub fn start(
    probe: &mut Probe,
    objects: usize,
    render: &RenderDefaults,
    spawn: Option<&Spawn>,
) -> (Camera, Start, Aabb) {
    let subject = Subject::of(&SurfaceSamples::of(probe.geometry(), objects));
    let floors = Floors::of(probe, subject.bounds);
    let scale = floors.as_ref().map_or(Scale::UNKNOWN, |floors| floors.scale(probe, subject.bounds));
    let unit = scale.unit;
    if let Some(spawn) = spawn
        && let Some((camera, eye_height)) = spawn::enter(probe, spawn, subject.bounds, unit)
    {
        return (camera, Start { entry: Entry::Spawn(spawn.name.clone()), eye_height, unit }, subject.bounds);
    }
    let regions = floors.as_ref().map(|floors| level::regions(probe, floors, unit)).unwrap_or_default();
    // What is smaller than a person cannot tell how large floors must be.
    let is_small = subject.bounds.size().y < SMALL * unit.per_metre();
    let is_walkable = is_small || regions.first().is_some_and(|region| region.area >= CLOSET);
    let on_foot = |entry, Stand { camera, eye_height }| {
        (camera, Start { entry, eye_height: Some(eye_height), unit }, subject.bounds)
    };
    if is_walkable && let Some(stand) = interior::stand(probe, subject.bounds, unit) {
        return on_foot(Entry::Interior, stand);
    }
    if let Some(stand) = level::stand(probe, &regions, subject.bounds, scale) {
        return on_foot(Entry::Level, stand);
    }
    let framed = Start { entry: Entry::Framed, eye_height: None, unit: Unit::Metre };
    (outside(probe, &subject, render), framed, subject.bounds)
}

/// A camera that shows all of the subject, from the side where fronts are seen.
fn outside(probe: &mut Probe, subject: &Subject, render: &RenderDefaults) -> Camera {
    let camera = frame(subject, render, false);
    let shown = |probe: &mut Probe, camera: &Camera| {
        let met = probe.see(camera.eye, &brightness::view(camera), camera.near);
        met.iter().flatten().count() as f64 / met.len().max(1) as f64
    };
    if !probe.knows_backs() {
        return camera;
    }
    let before = shown(probe, &camera);
    if before >= SHOWN {
        return camera;
    }
    // It shows little but backs, which are not seen.
    let other = frame(subject, render, true);
    if shown(probe, &other) > before { other } else { camera }
}

/// A camera whose picture the subject fills, from the other side if `from_behind`; without any, one at eye height that
/// looks at the origin.
fn frame(subject: &Subject, render: &RenderDefaults, from_behind: bool) -> Camera {
    let defaults = Camera::default();
    let bounds = subject.bounds;
    if bounds.is_empty() {
        return Camera { eye: Vec3::new(0.0, 1.6, 5.0), ..defaults };
    }
    let half = (bounds.max.as_dvec3() - bounds.min.as_dvec3()) / 2.0;
    let from = if from_behind { -view_from(half) } else { view_from(half) };
    let camera = frame_from(subject, render, from);
    // What is low is seen from above its top: table tops, floors of houses.
    let is_low = half.y < LOW * half.x.max(half.z);
    let top = f64::from(bounds.max.y) + half.y * ABOVE_TOP;
    if !is_low || f64::from(camera.eye.y) >= top {
        return camera;
    }
    let higher = RAISED.iter().map(|raised| frame_from(subject, render, (from + DVec3::Y * *raised).normalize()));
    higher.reduce(|lower, higher| if f64::from(lower.eye.y) >= top { lower } else { higher }).unwrap_or(camera)
}

/// A camera in a unit direction from the subject, whose picture that fills.
fn frame_from(subject: &Subject, render: &RenderDefaults, from: DVec3) -> Camera {
    let defaults = Camera::default();
    let (min, max) = (subject.bounds.min.as_dvec3(), subject.bounds.max.as_dvec3());
    let center = (min + max) / 2.0;
    let aspect = match (render.width, render.height) {
        (Some(width), Some(height)) => f64::from(width) / f64::from(height),
        _ => ASPECT,
    };
    let right = DVec3::Y.cross(from).normalize();
    let up = from.cross(right);
    let tangent = libm::tan(f64::from(FOV).to_radians() / 2.0) / MARGIN;
    let [mut across, mut above] = [Reach::of(tangent * aspect), Reach::of(tangent)];
    for &(point, radius) in &subject.points {
        let point = point.as_dvec3() - center;
        across.hold(point.dot(right), point.dot(from), radius);
        above.hold(point.dot(up), point.dot(from), radius);
    }
    // Far from the origin the eye must stay a few roundings away from what it looks at.
    let distance = across.distance().max(above.distance()).max(center.abs().max_element() * 1e-5).max(1e-30);
    let target = center + right * across.middle() + up * above.middle();
    let camera = Camera { eye: (target + from * distance).as_vec3(), look_at: target.as_vec3(), fov: FOV, ..defaults };
    if camera.is_valid() { camera } else { defaults }
}

/// How far away the eye must be to hold all points within its view along one axis of the picture, and where in the middle
/// of them.
///
/// A point at `x` along the axis and `z` towards the eye is within where |x - eye.x| <= tangent (eye.z - z): so
/// tangent eye.z + eye.x is at least the greatest x + tangent z, and tangent eye.z - eye.x the greatest -x + tangent z.
struct Reach {
    /// Of half the angle of view.
    tangent: f64,
    greatest: [f64; 2],
}

impl Reach {
    fn of(tangent: f64) -> Self {
        Self { tangent, greatest: [f64::NEG_INFINITY; 2] }
    }

    fn hold(&mut self, x: f64, z: f64, radius: f64) {
        // A ball reaches as far along the normal of the side of the view.
        let ball = radius * (1.0 + self.tangent * self.tangent).sqrt();
        for (greatest, x) in self.greatest.iter_mut().zip([x, -x]) {
            *greatest = greatest.max(x + self.tangent * z + ball);
        }
    }

    fn distance(&self) -> f64 {
        (self.greatest[0] + self.greatest[1]) / (2.0 * self.tangent)
    }

    fn middle(&self) -> f64 {
        (self.greatest[0] - self.greatest[1]) / 2.0
    }
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
    use crate::geometry::Aabb;

    fn sees(camera: &Camera, point: Vec3, aspect: f32) -> bool {
        let frame = camera.frame((1000.0 * aspect) as u32, 1000);
        let to = (point - camera.eye).as_dvec3();
        let depth = to.dot(frame.forward.as_dvec3());
        let across = to.dot(frame.right.as_dvec3()) / frame.right.as_dvec3().length_squared();
        let above = to.dot(frame.up.as_dvec3()) / frame.up.as_dvec3().length_squared();
        depth > 0.0 && across.abs() <= depth && above.abs() <= depth
    }

    fn subject(points: &[(Vec3, f64)]) -> Subject {
        let ball = |(center, radius): (Vec3, f64)| Aabb { min: center - radius as f32, max: center + radius as f32 };
        let bounds = points.iter().map(|point| ball(*point)).fold(Aabb::EMPTY, Aabb::union);
        Subject { bounds, points: points.to_vec() }
    }

    fn corners(min: Vec3, max: Vec3) -> Vec<(Vec3, f64)> {
        let pick = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
        (0..8).map(|corner| (Vec3::new(pick(corner, 0), pick(corner, 1), pick(corner, 2)), 0.0)).collect()
    }

    fn sized(width: u32, height: u32) -> RenderDefaults {
        RenderDefaults { width: Some(width), height: Some(height), ..RenderDefaults::default() }
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
                let corners = corners(min, max);
                let camera = frame(&subject(&corners), &sized(width, height), false);
                assert!(camera.is_valid());
                for (point, _) in corners {
                    assert!(sees(&camera, point, width as f32 / height as f32), "{point} {width}x{height}");
                }
            }
        }
    }

    /// How much of the width and of the height of a picture lies between the outermost points.
    fn filled(camera: &Camera, points: &[(Vec3, f64)], aspect: f64) -> [f64; 2] {
        let frame = camera.frame((1000.0 * aspect) as u32, 1000);
        let to = |(point, _): &(Vec3, f64)| (*point - camera.eye).as_dvec3();
        [frame.right, frame.up].map(|axis| {
            let axis = axis.as_dvec3();
            let at = |point| to(point).dot(axis) / axis.length_squared() / to(point).dot(frame.forward.as_dvec3());
            let places = points.iter().map(at);
            (places.clone().fold(f64::MIN, f64::max) - places.fold(f64::MAX, f64::min)) / 2.0
        })
    }

    #[test]
    fn what_is_framed_fills_two_thirds() {
        let shapes = [
            (Vec3::splat(-1.0), Vec3::splat(1.0)),
            (Vec3::new(5.0, 0.0, 0.0), Vec3::new(6.0, 30.0, 1.0)),
            (Vec3::new(0.0, 0.0, -30.0), Vec3::new(1.0, 1.0, 1.0)),
            (Vec3::new(-20.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 1.0)),
            (Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0)),
            (Vec3::splat(2000.0), Vec3::splat(2001.0)),
        ];
        for (min, max) in shapes {
            let corners = corners(min, max);
            for (render, aspect) in [(RenderDefaults::default(), 16.0 / 9.0), (sized(400, 1000), 0.4)] {
                let filled = filled(&frame(&subject(&corners), &render, false), &corners, aspect);
                assert!(filled.into_iter().any(|share| (2.0 / 3.0..0.96).contains(&share)), "{min}: {filled:?}");
                assert!(filled.into_iter().all(|share| share < 0.96), "{min}: {filled:?}");
            }
        }
    }

    #[test]
    fn a_ball_is_held_by_its_outline_and_not_by_its_box() {
        let ball = subject(&[(Vec3::new(3.0, 0.0, 0.0), 2.0)]);
        let camera = frame(&ball, &sized(500, 500), false);
        let distance = f64::from(camera.eye.distance(Vec3::new(3.0, 0.0, 0.0)));
        let share = libm::tan(libm::asin(2.0 / distance)) / libm::tan(f64::from(FOV / 2.0).to_radians());
        assert!((share * MARGIN - 1.0).abs() < 0.01, "{share}");
    }

    #[test]
    fn the_tops_of_low_things_are_seen() {
        for (x, y, z) in [(1.0, 0.6, 1.8), (2.0, 0.5, 2.0), (1.0, 0.5, 15.0), (9.0, 1.0, 2.0)] {
            let corners = corners(Vec3::new(-x, 0.0, -z), Vec3::new(x, 2.0 * y, z));
            for from_behind in [false, true] {
                let camera = frame(&subject(&corners), &RenderDefaults::default(), from_behind);
                assert!(from_behind || camera.eye.y > 2.2 * y, "{x} {y} {z}: {}", camera.eye.y);
                assert!(corners.iter().all(|(point, _)| sees(&camera, *point, 16.0 / 9.0)));
            }
        }
    }

    #[test]
    fn nothing_finite_still_gives_a_camera() {
        assert!(frame(&Subject::default(), &RenderDefaults::default(), false).is_valid());
        let far = subject(&[(Vec3::splat(1e6), 0.0)]);
        assert!(frame(&far, &RenderDefaults::default(), false).is_valid());
    }

    #[test]
    fn thin_things_are_seen_face_on_and_ground_from_above() {
        assert!(view_from(DVec3::new(3.0, 2.0, 0.0)).z > 0.9 && view_from(DVec3::new(0.1, 2.0, 3.0)).x > 0.9);
        let above = view_from(DVec3::new(3.0, 0.1, 2.0)).y;
        assert!((0.7..0.9).contains(&above), "{above}");
    }
}
