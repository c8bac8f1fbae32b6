//! Direct light: what each light adds to the surfaces of a packet, if nothing is in its way.

use super::brdf::Reflectance;
use crate::math::V3;
use crate::scene::Light;
use crate::scene::light::{Falloff, LightKind};
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// A packet's surfaces seen from where its rays came.
pub(super) struct Lit<S: Simd> {
    pub active: Mask<S>,
    pub position: V3<S::f32s>,
    /// Geometric normal on the viewer's side.
    pub facing: V3<S::f32s>,
    /// How far off the surface rays start.
    pub margin: S::f32s,
    /// Shading normal on the viewer's side.
    pub normal: V3<S::f32s>,
    pub to_viewer: V3<S::f32s>,
    pub weight: V3<S::f32s>,
}

/// What a light adds if nothing is in its way, for the lanes that it can reach at all, with the direction and distance
/// to it. `None` if it reaches none.
#[inline(always)]
#[allow(clippy::type_complexity, reason = "four lane vectors that are taken apart at once")]
pub(super) fn light_gain<S: Simd>(
    simd: S,
    light: &Light,
    lit: &Lit<S>,
    reflectance: &Reflectance<S>,
) -> Option<(Mask<S>, V3<S::f32s>, S::f32s, V3<S::f32s>)> {
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let mut arriving = V3::splat(simd, light.color);
    let (reaching, to_light, n_dot_l, distance) = match light.kind {
        LightKind::Directional { direction } => {
            let to_light = V3::splat(simd, -direction);
            let n_dot_l = lit.normal.dot(to_light);
            let reaching = lit.active & n_dot_l.simd_gt(zero);
            if !reaching.any_true() {
                return None;
            }
            (reaching, to_light, n_dot_l, S::f32s::splat(simd, f32::INFINITY))
        }
        LightKind::Point { position } | LightKind::Spot { position, .. } => {
            let to = V3::splat(simd, position) - lit.position;
            let above = lit.normal.dot(to);
            let distance2 = to.dot(to);
            let mut reaching = lit.active & above.simd_gt(zero);
            if let LightKind::Spot { direction, cos_outer, .. } = light.kind {
                reaching &= near_cone::<S>(V3::splat(simd, -direction).dot(to), distance2, cos_outer);
            }
            if !reaching.any_true() {
                return None;
            }
            let distance = distance2.sqrt();
            let inverse = one / distance;
            if let LightKind::Spot { direction, cos_inner, cos_outer, .. } = light.kind {
                let cosine = V3::splat(simd, -direction).dot(to) * inverse;
                let share = spot_share::<S>(cosine, cos_inner, cos_outer);
                reaching &= share.simd_gt(zero);
                if !reaching.any_true() {
                    return None;
                }
                arriving = arriving.scale(share);
            }
            if light.falloff == Falloff::InverseSquare {
                arriving = arriving.scale(inverse * inverse);
            }
            (reaching, to.scale(inverse), above * inverse, distance)
        }
    };
    let reflected = reflectance.towards(simd, reaching, lit.normal, lit.to_viewer, to_light, n_dot_l);
    Some((reaching, to_light, distance, lit.weight * arriving * reflected))
}

/// Whether a point may lie inside a spot's cone, `along` its axis at a squared distance from the apex; needs no root.
/// Says so of every point that [`spot_share`] gives any light.
#[inline(always)]
fn near_cone<S: Simd>(along: S::f32s, distance2: S::f32s, cos_outer: f32) -> Mask<S> {
    // Far more than what the share's cosine is rounded by.
    const SLACK: f32 = 1e-4;
    let zero = S::f32s::splat(along.token(), 0.0);
    let edge = cos_outer - SLACK;
    // A cone that is nearly flat or wider: all points may.
    if edge <= SLACK {
        return Mask::<S>::splat(along.token(), true);
    }
    along.simd_gt(zero) & (along * along).simd_ge(distance2 * (edge * edge))
}

/// How much of a spot's light goes along a direction: the square of a linear ramp between the cosines of its two
/// half-angles, as in glTF's KHR_lights_punctual, which keeps the ramp at least 0.001 wide.
///
/// A cone of less than 2.6° is narrower than that, and would be dim even along its axis: there the ramp is as wide as
/// the cone, so that every spot reaches full brightness at its centre.
#[inline(always)]
fn spot_share<S: Simd>(cosine: S::f32s, cos_inner: f32, cos_outer: f32) -> S::f32s {
    const LEAST_WIDTH: f32 = 1e-3;
    let width = (cos_inner - cos_outer).max(LEAST_WIDTH.min(1.0 - cos_outer)).max(f32::EPSILON);
    let ramp = ((cosine - cos_outer) / width).max(0.0).min(1.0);
    ramp * ramp
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{SimdToken, dispatch};

    fn lanes<S: Simd>(simd: S, angle: f32, inner: f32, outer: f32) -> f32 {
        let [cosine, inner, outer] = [angle, inner, outer].map(|degrees| degrees.to_radians().cos());
        spot_share::<S>(S::f32s::splat(simd, cosine), inner, outer)[0]
    }

    fn share(angle: f32, inner: f32, outer: f32) -> f32 {
        dispatch!(SimdToken::best(), simd => lanes(simd, angle, inner, outer))
    }

    #[test]
    fn spots_fall_off_as_in_gltf() {
        assert_eq!([share(0.0, 20.0, 30.0), share(20.0, 20.0, 30.0), share(30.1, 20.0, 30.0)], [1.0, 1.0, 0.0]);
        let [inner, outer, cosine] = [20.0_f32, 30.0, 25.0].map(|degrees| degrees.to_radians().cos());
        let ramp = (cosine - outer) / (inner - outer);
        assert!((share(25.0, 20.0, 30.0) - ramp * ramp).abs() < 1e-4);
        // A sharp edge is 0.001 wide, in cosines.
        let cosine = 30.0_f32.to_radians().cos() + 0.0005;
        assert!((share(cosine.acos().to_degrees(), 30.0, 30.0) - 0.25).abs() < 1e-3);
    }

    fn near_lanes<S: Simd>(simd: S, angle: f32, distance: f32, outer: f32) -> bool {
        let along = S::f32s::splat(simd, angle.to_radians().cos() * distance);
        near_cone::<S>(along, S::f32s::splat(simd, distance * distance), outer.to_radians().cos()).all_true()
    }

    #[test]
    fn what_a_spot_lights_is_near_its_cone() {
        let near =
            |angle, distance, outer| dispatch!(SimdToken::best(), simd => near_lanes(simd, angle, distance, outer));
        for outer in [0.03, 1.0, 30.0, 72.0, 89.99, 90.0, 120.0] {
            for distance in [1e-3, 0.3, 1.0, 77.7, 1e6] {
                for part in [0.0, 0.5, 0.99, 1.0] {
                    assert!(near(part * outer, distance, outer), "{part} of {outer} at {distance}");
                }
                if outer < 80.0 {
                    assert!(!near(outer + 2.0, distance, outer) && !near(179.0, distance, outer), "{outer}");
                }
            }
        }
    }

    #[test]
    fn the_narrowest_spot_is_bright_along_its_axis() {
        for outer in [2.5, 1.0, 0.1, 0.03] {
            assert_eq!(share(0.0, 0.0, outer), 1.0, "{outer}");
            assert_eq!(share(outer + 0.1, 0.0, outer), 0.0, "{outer}");
        }
    }
}
