//! From hits to lanes: what the surfaces of a packet are made of.

use super::frame::Frame;
use super::gather::{Hits, Surfaces};
use super::queue::MOST_LANES;
use super::tables::{FlatMaterial, Row};
use crate::geometry::PrimitiveIndex;
use crate::math::V3;
use crate::scene::object::Mapping;
use crate::scene::texture::Coordinates;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec2;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// What the surfaces that a packet hit are made of.
pub(super) trait Materials<S: Simd> {
    /// Whether any material passes a test.
    fn any(&self, test: impl Fn(&FlatMaterial) -> bool) -> bool;

    /// The lanes whose material passes a test.
    fn lanes(&self, simd: S, test: impl Fn(&FlatMaterial) -> bool) -> Mask<S>;

    /// One number of every lane's material.
    fn row(&self, simd: S, row: usize) -> S::f32s;

    /// Three numbers in a row.
    #[inline(always)]
    fn triple(&self, simd: S, first: Row) -> V3<S::f32s> {
        let row = first as usize;
        V3::new(self.row(simd, row), self.row(simd, row + 1), self.row(simd, row + 2))
    }

    /// Replaces the colours and emissions of textured lanes by what their textures hold.
    #[inline(always)]
    fn look_up(
        &self,
        simd: S,
        frame: &Frame<'_>,
        hits: &Hits<'_>,
        surfaces: &Surfaces<S>,
        color: &mut V3<S::f32s>,
        emission: &mut V3<S::f32s>,
    ) {
        let textured = self.lanes(simd, FlatMaterial::is_textured).to_bitmask() & hits.active;
        simd.vectorize(
            #[inline(always)]
            || look_up(simd, frame, hits, surfaces, textured, color, emission),
        );
    }
}

/// All lanes' surfaces are of one material.
pub(super) struct OneMaterial<'a>(&'a FlatMaterial);

impl<'a> OneMaterial<'a> {
    /// The material of a primitive.
    #[inline(always)]
    pub fn of(frame: &Frame<'a>, primitive: PrimitiveIndex) -> Self {
        Self(&frame.tables.materials[frame.tables.material_of[primitive as usize] as usize])
    }
}

impl<S: Simd> Materials<S> for OneMaterial<'_> {
    #[inline(always)]
    fn any(&self, test: impl Fn(&FlatMaterial) -> bool) -> bool {
        test(self.0)
    }

    #[inline(always)]
    fn lanes(&self, simd: S, test: impl Fn(&FlatMaterial) -> bool) -> Mask<S> {
        Mask::<S>::splat(simd, test(self.0))
    }

    #[inline(always)]
    fn row(&self, simd: S, row: usize) -> S::f32s {
        S::f32s::splat(simd, self.0.rows[row])
    }
}

/// Materials of a packet's hits, each once.
pub(super) struct MixedMaterials<'a, S: Simd> {
    /// That of the first hit, and of lanes without a hit.
    first: &'a FlatMaterial,
    /// The others, with the lanes that have them.
    others: [(&'a FlatMaterial, Mask<S>); MOST_LANES],
    /// How many others there are.
    count: usize,
}

impl<'a, S: Simd> MixedMaterials<'a, S> {
    /// The materials of what was hit; something was.
    #[inline(always)]
    pub fn new(simd: S, frame: &Frame<'a>, hits: &Hits<'_>) -> Self {
        let (table, material_of) = (&frame.tables.materials, &frame.tables.material_of);
        let material = material_of[hits.primitives[hits.first()] as usize];
        let first = &table[material as usize];
        let mut materials = Self { first, others: [(first, Mask::<S>::splat(simd, false)); MOST_LANES], count: 0 };
        if hits.common.is_none() && table.len() > 1 {
            let mut numbers = [material; MOST_LANES];
            for lane in hits.lanes() {
                numbers[lane] = material_of[hits.primitives[lane] as usize];
            }
            let lanes = S::u32s::from_slice(simd, &numbers[..S::f32s::LEN]);
            let mut left = hits.active & !lanes.simd_eq(material).to_bitmask();
            while left != 0 {
                let number = numbers[left.trailing_zeros() as usize % MOST_LANES];
                let same = lanes.simd_eq(number);
                left &= !same.to_bitmask();
                materials.others[materials.count] = (&table[number as usize], same);
                materials.count += 1;
            }
        }
        materials
    }
}

impl<S: Simd> Materials<S> for MixedMaterials<'_, S> {
    #[inline(always)]
    fn any(&self, test: impl Fn(&FlatMaterial) -> bool) -> bool {
        let mut passes = test(self.first);
        for (material, _) in &self.others[..self.count] {
            passes |= test(material);
        }
        passes
    }

    #[inline(always)]
    fn lanes(&self, simd: S, test: impl Fn(&FlatMaterial) -> bool) -> Mask<S> {
        let mut lanes = Mask::<S>::splat(simd, test(self.first));
        for (material, mask) in &self.others[..self.count] {
            if test(material) {
                lanes |= *mask;
            } else {
                lanes &= !*mask;
            }
        }
        lanes
    }

    #[inline(always)]
    fn row(&self, simd: S, row: usize) -> S::f32s {
        let mut value = S::f32s::splat(simd, self.first.rows[row]);
        for (material, mask) in &self.others[..self.count] {
            value = mask.select(S::f32s::splat(simd, material.rows[row]), value);
        }
        value
    }
}

/// [`Materials::look_up`] for the lanes in the bit set `textured`, object by object.
#[inline(always)]
fn look_up<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    hits: &Hits<'_>,
    surfaces: &Surfaces<S>,
    textured: u64,
    color: &mut V3<S::f32s>,
    emission: &mut V3<S::f32s>,
) {
    let ids = &frame.scene.geometry.ids;
    let id = ids[hits.primitives[hits.first()] as usize];
    if hits.common.is_some() {
        let sides = Mask::<S>::splat(simd, id.primitive == 0);
        let found = look_up_object(simd, frame, hits, surfaces, id.object, sides, textured, [*color, *emission]);
        [*color, *emission] = found;
        return;
    }
    let (mut objects, mut parts) = ([id.object; MOST_LANES], [id.primitive; MOST_LANES]);
    for lane in hits.lanes() {
        let id = ids[hits.primitives[lane] as usize];
        (objects[lane], parts[lane]) = (id.object, id.primitive);
    }
    let lanes = S::u32s::from_slice(simd, &objects[..S::f32s::LEN]);
    let sides = S::u32s::from_slice(simd, &parts[..S::f32s::LEN]).simd_eq(0);
    let mut left = textured;
    while left != 0 {
        let number = objects[left.trailing_zeros() as usize % MOST_LANES];
        let same = lanes.simd_eq(number);
        let members = same.to_bitmask() & left;
        left &= !members;
        let [found, given_off] =
            look_up_object(simd, frame, hits, surfaces, number, sides, members, [*color, *emission]);
        *color = V3::select(same, found, *color);
        *emission = V3::select(same, given_off, *emission);
    }
}

/// Colour and emission as the textures of object `number` have them, otherwise as they were. `sides` are the lanes that
/// hit its first primitive; only the lanes in the bit set `members` matter.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "what is known of one object's lanes")]
fn look_up_object<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    hits: &Hits<'_>,
    surfaces: &Surfaces<S>,
    number: u32,
    sides: Mask<S>,
    members: u64,
    mut found: [V3<S::f32s>; 2],
) -> [V3<S::f32s>; 2] {
    let object = &frame.scene.objects[number as usize];
    let own = if object.mapping == Mapping::Vertex {
        vertex_coordinates(simd, frame, hits, surfaces)
    } else {
        [S::f32s::splat(simd, 0.0); 2]
    };
    let point = &surfaces.point;
    let coordinates = object.texture_coordinates(simd, point.position, point.normal, sides, own);
    let material = &frame.tables.materials[object.material as usize];
    let coordinates = Coordinates::<S> { uv: coordinates, spread2: None };
    for (texture, into) in [material.color_texture, material.emission_texture].into_iter().zip(&mut found) {
        if let Some(texture) = texture {
            *into = *into * frame.scene.textures[texture as usize].sample(simd, &coordinates, members).color;
        }
    }
    found
}

/// Texture coordinates that the corners of triangles carry, interpolated; 0 where they carry none.
#[inline(always)]
fn vertex_coordinates<S: Simd>(simd: S, frame: &Frame<'_>, hits: &Hits<'_>, surfaces: &Surfaces<S>) -> [S::f32s; 2] {
    let corners = hits.gather::<S, 6>(
        simd,
        #[inline(always)]
        |primitive| {
            let coordinates = frame.tables.attributes(&frame.scene.geometry, primitive).and_then(|a| a.uvs);
            let [a, b, c] = coordinates.unwrap_or([Vec2::ZERO; 3]);
            [a.x, a.y, b.x, b.y, c.x, c.y]
        },
    );
    let [u, v, w] = surfaces.weights;
    [corners[0] * u + corners[2] * v + corners[4] * w, corners[1] * u + corners[3] * v + corners[5] * w]
}
