//! What surfaces are like where rays hit them: the numbers of their materials, times what textures and corners hold.

use super::frame::Frame;
use super::gather::{Hits, Surfaces};
use super::materials::Materials;
use super::queue::MOST_LANES;
use super::relief;
use super::tables::Row;
use super::texture_place::{Places, Sight};
use crate::math::V3;
use crate::scene::material::Lookup;
use crate::scene::texels::Texel;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec4;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// The surfaces of a packet. Lanes without a hit hold anything.
#[derive(Clone, Copy)]
pub(super) struct Skin<S: Simd> {
    /// Surface colour.
    pub color: V3<S::f32s>,
    /// Light given off.
    pub emission: V3<S::f32s>,
    /// How much of what is seen is the surface's own; less than 1 only where what lies behind shines through.
    pub coverage: S::f32s,
    /// 0 to 1.
    pub metallic: S::f32s,
    /// 0 to 1; negative in lanes of Phong-type materials.
    pub roughness: S::f32s,
    /// How much of the ambient light arrives.
    pub openness: S::f32s,
    /// Multiplies the transparency.
    pub transmission: S::f32s,
    /// Unit normal for shading, where the plan has relief.
    relieved: V3<S::f32s>,
}

impl<S: Simd> Skin<S> {
    /// As materials, corners and textures have it. `sight` tells how it is seen.
    #[inline(always)]
    pub fn of(
        simd: S,
        frame: &Frame<'_>,
        hits: &Hits<'_>,
        surfaces: &Surfaces<S>,
        materials: &impl Materials<S>,
        sight: &Sight<S>,
    ) -> Self {
        let mut skin = Self::plain(simd, frame, surfaces, materials);
        // Both are kept apart from packets that need neither, and take the skin by value: what has an address stays in memory.
        if frame.plan.vertex_colors {
            skin = simd.vectorize(
                #[inline(always)]
                move || skin.tint(simd, frame, hits, surfaces, materials),
            );
        }
        if frame.plan.textures && materials.any(|material| material.textured) {
            let textured = materials.lanes(simd, |material| material.textured).to_bitmask() & hits.active;
            skin = simd.vectorize(
                #[inline(always)]
                move || skin.look_up(simd, frame, hits, surfaces, sight, textured),
            );
        }
        skin
    }

    /// As the materials have it, whatever textures and corners hold.
    #[inline(always)]
    pub fn plain(simd: S, frame: &Frame<'_>, surfaces: &Surfaces<S>, materials: &impl Materials<S>) -> Self {
        let one = S::f32s::splat(simd, 1.0);
        let mut skin = Self {
            color: materials.triple(simd, Row::Color),
            emission: V3::zero(simd),
            coverage: one,
            metallic: one,
            roughness: -one,
            openness: one,
            transmission: one,
            relieved: surfaces.shading_normal,
        };
        if frame.plan.emission {
            skin.emission = materials.triple(simd, Row::Emission);
        }
        if frame.plan.blending {
            skin.coverage = materials.row(simd, Row::Coverage as usize);
        }
        if frame.plan.metallic_roughness {
            skin.metallic = materials.row(simd, Row::Metallic as usize);
            skin.roughness = materials.row(simd, Row::Roughness as usize);
        }
        skin
    }

    /// Unit normal for shading, on the side of the geometric one.
    #[inline(always)]
    pub fn normal(&self, frame: &Frame<'_>, surfaces: &Surfaces<S>) -> V3<S::f32s> {
        if frame.plan.relief { self.relieved } else { surfaces.shading_normal }
    }

    /// Share of light from straight ahead that a metallic-roughness surface reflects.
    #[inline(always)]
    pub fn f0(&self, simd: S, materials: &impl Materials<S>) -> V3<S::f32s> {
        let one = S::f32s::splat(simd, 1.0);
        let dielectric = materials.row(simd, Row::DielectricF0 as usize);
        V3::all((one - self.metallic) * dielectric) + self.color.scale(self.metallic)
    }

    /// In another colour.
    #[inline(always)]
    pub fn painted(self, color: V3<S::f32s>) -> Self {
        Self { color, ..self }
    }

    /// Multiplies the colours that corners carry.
    #[inline(always)]
    fn tint(
        mut self,
        simd: S,
        frame: &Frame<'_>,
        hits: &Hits<'_>,
        surfaces: &Surfaces<S>,
        materials: &impl Materials<S>,
    ) -> Self {
        let corners = hits.gather::<S, 12>(
            simd,
            #[inline(always)]
            |primitive| {
                let colors = frame.tables.extras(
                    &frame.scene.geometry,
                    primitive,
                    #[inline(always)]
                    |extras| extras.colors,
                );
                let [a, b, c] = colors.unwrap_or([Vec4::ONE; 3]);
                [a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y, c.z, c.w]
            },
        );
        let [r, g, b, a] = surfaces.blend_four(&corners);
        // Weights are those of triangles alone: others carry no colours.
        let carried = surfaces.is_triangle(simd);
        self.color = V3::select(carried, self.color * V3::new(r, g, b), self.color);
        if frame.plan.blending {
            let blended = materials.lanes(simd, |material| material.blended) & carried;
            self.coverage = blended.select(self.coverage * a, self.coverage);
        }
        self
    }

    /// Applies textures, to the lanes in the bit set `textured`, object by object.
    #[inline(always)]
    fn look_up(
        mut self,
        simd: S,
        frame: &Frame<'_>,
        hits: &Hits<'_>,
        surfaces: &Surfaces<S>,
        sight: &Sight<S>,
        textured: u64,
    ) -> Self {
        let geometry = &frame.scene.geometry;
        let Some(id) = geometry.id(hits.primitives[hits.first()]) else { return self };
        if hits.common.is_some() {
            let sides = Mask::<S>::splat(simd, id.primitive == 0);
            let object = Object { number: id.object, sides, members: textured };
            return self.looked_up(simd, frame, hits, surfaces, sight, &object);
        }
        let (mut objects, mut parts) = ([id.object; MOST_LANES], [id.primitive; MOST_LANES]);
        for lane in hits.lanes() {
            if let Some(id) = geometry.id(hits.primitives[lane]) {
                (objects[lane], parts[lane]) = (id.object, id.primitive);
            }
        }
        let lanes = S::u32s::from_slice(simd, &objects[..S::f32s::LEN]);
        let sides = S::u32s::from_slice(simd, &parts[..S::f32s::LEN]).simd_eq(0);
        let mut left = textured;
        while left != 0 {
            let number = objects[left.trailing_zeros() as usize % MOST_LANES];
            let same = lanes.simd_eq(number);
            let members = same.to_bitmask() & left;
            left &= !members;
            let found = self.looked_up(simd, frame, hits, surfaces, sight, &Object { number, sides, members });
            self = Self::select(same, &found, &self);
        }
        self
    }

    /// What it is with the textures of one object.
    #[inline(always)]
    fn looked_up(
        &self,
        simd: S,
        frame: &Frame<'_>,
        hits: &Hits<'_>,
        surfaces: &Surfaces<S>,
        sight: &Sight<S>,
        object: &Object<S>,
    ) -> Self {
        let mut skin = *self;
        let material = &frame.tables.materials[frame.scene.objects[object.number as usize].material as usize];
        let maps = &material.maps;
        let mut places = Places::of(simd, frame, hits, surfaces, object.number, object.sides, maps);
        if material.relieved {
            let relief = &maps.relief;
            if let Some(parallax) = &relief.parallax {
                let place = places.get_mut(frame, &parallax.lookup);
                *place = relief::shifted(simd, frame, surfaces, sight, place, parallax, object.members);
            }
            skin.relieved = relief::normal(simd, frame, hits, surfaces, sight, &places, relief, object.members);
        }
        let looks = Looks { frame, sight, places, members: object.members };
        if let Some(color) = &maps.color {
            if material.blended {
                let found = looks.at::<true>(simd, color);
                skin.color = skin.color * found.color;
                skin.coverage *= found.opacity;
            } else {
                skin.color = skin.color * looks.at::<false>(simd, color).color;
            }
        }
        if let Some(emission) = &maps.emission {
            skin.emission = skin.emission * looks.at::<false>(simd, emission).color;
        }
        if let Some(map) = &maps.metallic_roughness {
            let found = looks.at::<false>(simd, map).color;
            skin.metallic *= found.z;
            skin.roughness *= found.y;
        }
        if let Some(occlusion) = &maps.occlusion {
            skin.openness = (looks.at::<false>(simd, &occlusion.lookup).color.x - 1.0) * occlusion.scale + 1.0;
        }
        if let Some(transmission) = &maps.transmission {
            skin.transmission = looks.at::<false>(simd, transmission).color.x;
        }
        skin
    }

    #[inline(always)]
    fn select(mask: Mask<S>, a: &Self, b: &Self) -> Self {
        Self {
            color: V3::select(mask, a.color, b.color),
            emission: V3::select(mask, a.emission, b.emission),
            coverage: mask.select(a.coverage, b.coverage),
            metallic: mask.select(a.metallic, b.metallic),
            roughness: mask.select(a.roughness, b.roughness),
            openness: mask.select(a.openness, b.openness),
            transmission: mask.select(a.transmission, b.transmission),
            relieved: V3::select(mask, a.relieved, b.relieved),
        }
    }
}

/// Lookups for some lanes of a packet.
struct Looks<'a, S: Simd> {
    frame: &'a Frame<'a>,
    sight: &'a Sight<S>,
    places: Places<S>,
    /// Bit set of the lanes that matter.
    members: u64,
}

impl<S: Simd> Looks<'_, S> {
    #[inline(always)]
    fn at<const OPACITY: bool>(&self, simd: S, lookup: &Lookup) -> Texel<S> {
        let place = self.places.get(self.frame, lookup);
        place.look::<OPACITY>(simd, self.frame, lookup, self.sight, self.members)
    }
}

/// The lanes of a packet that hit one object.
struct Object<S: Simd> {
    number: u32,
    /// Lanes that hit an object's first primitive.
    sides: Mask<S>,
    /// Bit set of the lanes that matter.
    members: u64,
}
