//! What surfaces reflect of direct light: Lambert (1760), Blinn-Phong (Blinn, SIGGRAPH 1977) and glTF's
//! metallic-roughness (Khronos, glTF 2.0 appendix B).

use super::frame::Frame;
use super::materials::Materials;
use super::skin::Skin;
use super::tables::Row;
use crate::math::V3;
use crate::math::power::pow;
use fearless_simd::Simd;
use fearless_simd::prelude::*;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// The reflection models of a packet's hits, gathered once for all lights.
pub(super) struct Reflectance<S: Simd> {
    phong: Option<Phong<S>>,
    metallic_roughness: Option<MetallicRoughness<S>>,
}

/// (1-t) diffuse color (n·l) + specular (n·h)^shininess.
struct Phong<S: Simd> {
    /// (1-t) diffuse color.
    matte: V3<S::f32s>,
    /// If any lane has one.
    highlight: Option<Highlight<S>>,
}

/// specular (n·h)^shininess.
struct Highlight<S: Simd> {
    specular: V3<S::f32s>,
    shininess: S::f32s,
    /// Square of the n·h up to which nothing is seen of it.
    edge2: S::f32s,
}

/// Lambert under a Trowbridge-Reitz highlight with the height-correlated Smith term and Schlick's Fresnel.
struct MetallicRoughness<S: Simd> {
    /// Lanes of this model.
    own: Mask<S>,
    /// Squared width of the highlight: roughness to the power of four.
    alpha2: S::f32s,
    /// Reflectance straight ahead.
    f0: V3<S::f32s>,
    /// What is scattered of the light that is not reflected.
    diffuse: V3<S::f32s>,
}

impl<S: Simd> Reflectance<S> {
    /// `opacity` is what transparency leaves of the local light.
    #[inline(always)]
    pub fn gather(
        simd: S,
        frame: &Frame<'_>,
        materials: &impl Materials<S>,
        skin: &Skin<S>,
        opacity: V3<S::f32s>,
    ) -> Self {
        let color = skin.color;
        let some_metallic = frame.plan.metallic_roughness && materials.any(|m| m.metallic_roughness);
        let some_phong = !some_metallic || materials.any(|m| !m.metallic_roughness);
        let mut phong = None;
        if some_phong {
            let matte = opacity * materials.triple(simd, Row::Diffuse) * color;
            let mut highlight = None;
            if frame.plan.highlights && materials.any(|m| m.shiny) {
                highlight = Some(Highlight {
                    specular: materials.triple(simd, Row::Specular),
                    shininess: materials.row(simd, Row::Shininess as usize),
                    edge2: materials.row(simd, Row::HighlightEdge2 as usize),
                });
            }
            phong = Some(Phong { matte, highlight });
        }
        let mut metallic_roughness = None;
        if some_metallic {
            metallic_roughness = Some(MetallicRoughness::new(simd, materials, skin, opacity));
        }
        Self { phong, metallic_roughness }
    }

    /// The share of a light's colour that goes to the viewer, for the lanes that the light is `reaching`; others get
    /// anything. All directions are unit vectors away from the surface.
    #[inline(always)]
    pub fn towards(
        &self,
        simd: S,
        reaching: Mask<S>,
        normal: V3<S::f32s>,
        to_viewer: V3<S::f32s>,
        to_light: V3<S::f32s>,
        n_dot_l: S::f32s,
    ) -> V3<S::f32s> {
        let mut reflected = match &self.phong {
            Some(phong) => phong.towards(reaching, normal, to_viewer, to_light, n_dot_l),
            None => V3::all(S::f32s::splat(simd, 0.0)),
        };
        if let Some(model) = &self.metallic_roughness {
            reflected = V3::select(model.own, model.towards(simd, normal, to_viewer, to_light, n_dot_l), reflected);
        }
        reflected
    }
}

impl<S: Simd> Phong<S> {
    #[inline(always)]
    fn towards(
        &self,
        reaching: Mask<S>,
        normal: V3<S::f32s>,
        to_viewer: V3<S::f32s>,
        to_light: V3<S::f32s>,
        n_dot_l: S::f32s,
    ) -> V3<S::f32s> {
        let matte = self.matte.scale(n_dot_l);
        let Some(Highlight { specular, shininess, edge2 }) = self.highlight else { return matte };
        let half = to_light + to_viewer;
        let (along, length2) = (normal.dot(half), half.dot(half));
        let seen = reaching & along.simd_gt(0.0) & (along * along).simd_gt(length2 * edge2);
        // Most packets lie outside of most highlights: the power takes as long as all the rest.
        if !seen.any_true() {
            return matte;
        }
        let n_dot_h = seen.select(along / length2.sqrt(), S::f32s::splat(along.token(), 0.0));
        matte + specular.scale(pow::<S, S::f32s>(n_dot_h, shininess))
    }
}

impl<S: Simd> MetallicRoughness<S> {
    /// All that does not depend on the light. Left to the loop over lights, it would be hoisted out of it, and computed
    /// for every packet of every scene.
    #[inline(always)]
    fn new(simd: S, materials: &impl Materials<S>, skin: &Skin<S>, opacity: V3<S::f32s>) -> Self {
        let Skin { color, metallic, roughness, .. } = *skin;
        let one = S::f32s::splat(simd, 1.0);
        let alpha = roughness * roughness;
        Self {
            own: roughness.simd_ge(S::f32s::splat(simd, 0.0)),
            // A perfect mirror's highlight of a point light has no width: keep it visible and finite.
            alpha2: (alpha * alpha).max(1e-6),
            f0: skin.f0(simd, materials),
            diffuse: opacity * color.scale((one - metallic) * std::f32::consts::FRAC_1_PI),
        }
    }

    #[inline(always)]
    fn towards(
        &self,
        simd: S,
        normal: V3<S::f32s>,
        to_viewer: V3<S::f32s>,
        to_light: V3<S::f32s>,
        n_dot_l: S::f32s,
    ) -> V3<S::f32s> {
        let one = S::f32s::splat(simd, 1.0);
        let half = (to_light + to_viewer).normalize();
        let n_dot_v = positive::<S>(normal.dot(to_viewer));
        let n_dot_h = positive::<S>(normal.dot(half));
        let v_dot_h = positive::<S>(to_viewer.dot(half));

        let Self { alpha2, f0, diffuse, .. } = *self;
        // (n·h)²(α²-1) + 1, but without its cancellation near the peak of a smooth surface's highlight.
        let across = normal.cross(half);
        let sine2 = across.dot(across);
        let sine2 = sine2.simd_ge(0.0).select(sine2, one);
        let d = n_dot_h * n_dot_h * alpha2 + sine2;
        let distribution = alpha2 / (d * d * std::f32::consts::PI);
        let smith_l = n_dot_l * (n_dot_v * n_dot_v * (one - alpha2) + alpha2).sqrt();
        let smith_v = n_dot_v * (n_dot_l * n_dot_l * (one - alpha2) + alpha2).sqrt();
        let visibility = S::f32s::splat(simd, 0.5) / (smith_l + smith_v).max(1e-7);

        let fresnel = schlick(simd, f0, v_dot_h);
        ((V3::all(one) - fresnel) * diffuse + fresnel.scale(distribution * visibility)).scale(n_dot_l)
    }
}

/// Share of light that is reflected where its direction has this `cosine` with the normal, given what is reflected of
/// light from straight ahead (Schlick, Eurographics 1994).
#[inline(always)]
pub(super) fn schlick<S: Simd>(simd: S, f0: V3<S::f32s>, cosine: S::f32s) -> V3<S::f32s> {
    let one = S::f32s::splat(simd, 1.0);
    let x = one - cosine;
    let x2 = x * x;
    f0 + (V3::all(one) - f0).scale(x2 * x2 * x)
}

/// The value where it is above 0, else 0. What is not a number (the half vector of a light straight behind) is 0 too.
#[inline(always)]
fn positive<S: Simd>(value: S::f32s) -> S::f32s {
    let zero = S::f32s::splat(value.token(), 0.0);
    value.simd_gt(zero).select(value, zero)
}
