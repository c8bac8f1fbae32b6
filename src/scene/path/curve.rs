//! The smooth curve between two keys.

use super::Key;
use crate::scene::Camera;
use glam::DVec3;

/// The way from one key to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    begin: f64,
    duration: f64,
    eye: Curve,
    target: Curve,
    fov: Curve,
}

/// Both ends of a cubic Hermite spline, and its change per second there.
#[derive(Clone, Copy, Debug)]
struct Curve {
    from: DVec3,
    leaving: DVec3,
    to: DVec3,
    arriving: DVec3,
}

impl Stretch {
    /// From the second of `keys` to the third; the outer two are its neighbours, where there are any. A key without a
    /// field of view has `fov`.
    pub(super) fn between(keys: [Option<&Key>; 2], a: &Key, b: &Key, fov: f64) -> Self {
        let [before, after] = keys;
        let curve = |value: &dyn Fn(&Key) -> DVec3| Curve {
            from: value(a),
            leaving: tangent(before, a, Some(b), value),
            to: value(b),
            arriving: tangent(Some(a), b, after, value),
        };
        Self {
            begin: a.t,
            duration: b.t - a.t,
            eye: curve(&|key| key.position.into()),
            target: curve(&|key| key.look_at.into()),
            fov: curve(&|key| DVec3::splat(key.fov.unwrap_or(fov))),
        }
    }

    /// The camera at time `t`; what the curve does not say is as in `base`.
    pub(super) fn camera(&self, t: f64, base: &Camera, origin: DVec3) -> Camera {
        let s = (t - self.begin) / self.duration;
        let (s2, s3) = (s * s, s * s * s);
        let at = |curve: &Curve| {
            curve.from * (2.0 * s3 - 3.0 * s2 + 1.0)
                + curve.leaving * (self.duration * (s3 - 2.0 * s2 + s))
                + curve.to * (3.0 * s2 - 2.0 * s3)
                + curve.arriving * (self.duration * (s3 - s2))
        };
        Camera {
            eye: (at(&self.eye) - origin).as_vec3(),
            look_at: (at(&self.target) - origin).as_vec3(),
            // A spline may swing beyond its keys; a field of view may not leave its range.
            fov: (at(&self.fov).x as f32).clamp(0.01, 179.99),
            ..*base
        }
    }
}

/// Change per second at key `at`: the slope of the parabola through it and its neighbours, at the ends the slope of the
/// only stretch.
fn tangent(before: Option<&Key>, at: &Key, after: Option<&Key>, value: &dyn Fn(&Key) -> DVec3) -> DVec3 {
    let slope = |a: &Key, b: &Key| (value(b) - value(a)) / (b.t - a.t);
    match (before, after) {
        (Some(before), Some(after)) => {
            let (earlier, later) = (at.t - before.t, after.t - at.t);
            (slope(before, at) * later + slope(at, after) * earlier) / (earlier + later)
        }
        (Some(before), None) => slope(before, at),
        (None, Some(after)) => slope(at, after),
        (None, None) => DVec3::ZERO,
    }
}
