//! Relief of smooth surfaces: normal maps, bump maps and parallax occlusion mapping.

use super::frame::Frame;
use super::gather::{Hits, Surfaces};
use super::texture_place::{Place, Places, Sight};
use crate::math::V3;
use crate::scene::material::{Relief, Scaled};
use crate::scene::texture::Texture;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec4;

/// Steps of the search for where a ray meets a height field.
const STEPS: u32 = 24;

/// Flatter rays (cosine) meet a height field no farther along than such a one.
const FLATTEST: f32 = 0.1;

/// The place on a texture where rays meet the height field below the surface: by steps of equal depth, and the point
/// where the line between the last two crosses it (parallax occlusion mapping: Tatarchuk, "Dynamic parallax occlusion
/// mapping with approximate soft shadows", I3D 2006). White is the surface itself.
#[inline(always)]
pub(super) fn shifted<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    surfaces: &Surfaces<S>,
    sight: &Sight<S>,
    place: &Place<S>,
    parallax: &Scaled,
    members: u64,
) -> Place<S> {
    let one = S::f32s::splat(simd, 1.0);
    let cosine = sight.direction.dot(surfaces.point.normal).abs().max(FLATTEST);
    // Along the surface while the ray goes from the surface to the bottom.
    let [gu, gv] = place.gradients;
    let along = sight.direction.scale(S::f32s::splat(simd, parallax.scale) / cosine);
    let step = [gu.dot(along) * (1.0 / STEPS as f32), gv.dot(along) * (1.0 / STEPS as f32)];
    // How far the ray is below the height field; less than 0 above it.
    let mut before = place.look::<false>(simd, frame, &parallax.lookup, sight, members).color.x - one;
    let mut found = S::f32s::splat(simd, 0.0);
    let mut searching = before.simd_lt(0.0);
    for number in 1..=STEPS {
        if searching.to_bitmask() & members == 0 {
            break;
        }
        let steps = S::f32s::splat(simd, number as f32);
        let height = moved(place, step, steps).look::<false>(simd, frame, &parallax.lookup, sight, members).color.x;
        let now = steps * (1.0 / STEPS as f32) - (one - height);
        let crossed = searching & now.simd_ge(0.0);
        // Between -before and now, in proportion.
        found = crossed.select(steps - now / (now - before), found);
        searching &= !crossed;
        before = now;
    }
    moved(place, step, searching.select(S::f32s::splat(simd, STEPS as f32), found))
}

/// A place so many steps farther along.
#[inline(always)]
fn moved<S: Simd>(place: &Place<S>, step: [S::f32s; 2], steps: S::f32s) -> Place<S> {
    Place { uv: [place.uv[0] + step[0] * steps, place.uv[1] + step[1] * steps], gradients: place.gradients }
}

/// The normal that a surface's maps give it, on the side of the geometric one.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "what is known of one object's lanes")]
pub(super) fn normal<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    hits: &Hits<'_>,
    surfaces: &Surfaces<S>,
    sight: &Sight<S>,
    places: &Places<S>,
    relief: &Relief,
    members: u64,
) -> V3<S::f32s> {
    let mut normal = surfaces.shading_normal;
    if let Some(Scaled { lookup, scale }) = &relief.normal {
        let place = places.get(frame, lookup);
        let found = place.look::<false>(simd, frame, lookup, sight, members).color;
        let (x, y, z) = ((found.x * 2.0 - 1.0) * *scale, (found.y * 2.0 - 1.0) * *scale, found.z * 2.0 - 1.0);
        let [along_u, along_v] = tangents(simd, frame, hits, surfaces, normal, place.gradients_of(lookup));
        let bent = along_u.scale(x) + along_v.scale(y) + normal.scale(z);
        normal = bent.normalize_or(normal);
    }
    if let Some(bump) = &relief.bump {
        let slope = slope(simd, frame, sight, places.get(frame, &bump.lookup), bump, members);
        // The surface's gradient of the height tilts the normal away from it (Mikkelsen, "Bump mapping unparametrized
        // surfaces on the GPU", 2010).
        let slope = slope - normal.scale(normal.dot(slope));
        normal = (normal - slope).normalize_or(normal);
    }
    normal
}

/// How a bump map's height grows along the surface.
#[inline(always)]
fn slope<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    sight: &Sight<S>,
    place: &Place<S>,
    bump: &Scaled,
    members: u64,
) -> V3<S::f32s> {
    let [gu, gv] = place.gradients;
    let size = match &frame.scene.textures[bump.lookup.texture as usize] {
        Texture::Image(image) => [image.texels.width(), image.texels.height()].map(|texels| image.size / texels as f32),
        Texture::Checker { size, .. } => [size * 0.1; 2],
    };
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    // A texel, or as much as a ray stands for.
    let width2 = sight.width2.unwrap_or(zero);
    let du = (gu.dot(gu) * width2).sqrt().max(size[0]);
    let dv = (gv.dot(gv) * width2).sqrt().max(size[1]);
    let mut heights = [zero; 3];
    for (height, step) in heights.iter_mut().zip([[zero; 2], [du, zero], [zero, dv]]) {
        *height = moved(place, step, one).look::<false>(simd, frame, &bump.lookup, sight, members).color.x;
    }
    let [here, right, above] = heights;
    let (along_u, along_v) = ((right - here) / du, (above - here) / dv);
    gu.scale(along_u * bump.scale) + gv.scale(along_v * bump.scale)
}

/// Unit directions along which u and v grow, across `normal`: as corners carry them, else by the `gradients` of the
/// texture coordinates.
#[inline(always)]
fn tangents<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    hits: &Hits<'_>,
    surfaces: &Surfaces<S>,
    normal: V3<S::f32s>,
    [gu, gv]: [V3<S::f32s>; 2],
) -> [V3<S::f32s>; 2] {
    let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
    let sign = gu.cross(gv).dot(normal).simd_lt(zero).select(-one, one);
    let along_u = gv.cross(normal).scale(sign).normalize_or(V3::all(zero));
    let along_v = normal.cross(along_u).scale(sign);
    if !frame.plan.tangents {
        return [along_u, along_v];
    }
    let corners = hits.gather::<S, 12>(
        simd,
        #[inline(always)]
        |primitive| {
            let tangents = frame.tables.extras(
                &frame.scene.geometry,
                primitive,
                #[inline(always)]
                |extras| extras.tangents,
            );
            let [a, b, c] = tangents.unwrap_or([Vec4::ZERO; 3]);
            [a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y, c.z, c.w]
        },
    );
    let [x, y, z, side] = surfaces.blend_four(&corners);
    let tangent = V3::new(x, y, z);
    // glTF: the bitangent is cross(normal, tangent) times the sign, with none of them made unit again.
    let sign = side.simd_lt(zero).select(-one, one);
    let carried = tangent.dot(tangent).simd_gt(zero);
    let bitangent = normal.cross(tangent).scale(sign);
    [V3::select(carried, tangent, along_u), V3::select(carried, bitangent, along_v)]
}
