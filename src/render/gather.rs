//! From hits to lanes: the surfaces of a packet whose rays may have hit different things.
//!
//! Where all rays hit the same primitive, its numbers are splat; where they hit few, they are blended by mask; otherwise
//! they are gathered lane by lane. The kernels that run on them are the same text, so the bits do not depend on who
//! else is in the packet.

use super::frame::Frame;
use super::materials::{Materials, MixedMaterials};
use super::queue::MOST_LANES;
use super::skin::Skin;
use super::tables::Row;
use super::texture_place::Sight;
use crate::geometry::primitive::{
    Cone, Cutout, Disk, Kernel, Plane, Sphere, SurfacePoint, Triangle, for_each_primitive,
};
use crate::geometry::{BLOCK, Block, Geometry, NO_PRIMITIVE, PrimitiveIndex, PrimitiveKind, Rays, Slot};
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// What the rays of a packet hit.
pub(super) struct Hits<'a> {
    pub primitives: &'a [u32],
    /// Bit set of the lanes that hit something.
    pub active: u64,
    /// The primitive that all hitting lanes hit, if there is just one.
    pub common: Option<u32>,
}

impl<'a> Hits<'a> {
    /// The hits of one packet's worth of primitives.
    #[inline(always)]
    pub fn new<S: Simd>(simd: S, primitives: &'a [u32]) -> Self {
        let lanes = S::u32s::from_slice(simd, primitives);
        let active = lanes.simd_ne(S::u32s::splat(simd, NO_PRIMITIVE)).to_bitmask();
        let mut common = None;
        if active != 0 {
            let first = primitives[active.trailing_zeros() as usize];
            let same = lanes.simd_eq(S::u32s::splat(simd, first)).to_bitmask();
            common = (same == active).then_some(first);
        }
        Self { primitives, active, common }
    }

    /// Lanes that hit something, in order.
    pub fn lanes(&self) -> impl Iterator<Item = usize> + use<> {
        bits(self.active)
    }

    /// A lane that hit something; there must be one.
    #[inline(always)]
    pub fn first(&self) -> usize {
        self.active.trailing_zeros() as usize
    }

    /// `N` numbers of each hitting lane's primitive; the first one's where there is no hit.
    #[inline(always)]
    pub fn gather<S: Simd, const N: usize>(&self, simd: S, numbers: impl Fn(u32) -> [f32; N]) -> [S::f32s; N] {
        let mut gathered = [S::f32s::splat(simd, 0.0); N];
        let first = numbers(self.primitives[self.first()]);
        for (lanes, number) in gathered.iter_mut().zip(first) {
            *lanes = S::f32s::splat(simd, number);
        }
        if self.common.is_none() {
            for lane in self.lanes() {
                for (lanes, number) in gathered.iter_mut().zip(numbers(self.primitives[lane])) {
                    lanes.as_mut_slice()[lane] = number;
                }
            }
        }
        gathered
    }
}

/// Set bits, lowest first.
pub(super) fn bits(mut set: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(
        #[inline(always)]
        move || {
            (set != 0).then(|| {
                let lane = set.trailing_zeros() as usize;
                set &= set - 1;
                lane
            })
        },
    )
}

/// Surfaces hit by a packet. Lanes without a hit hold anything.
#[derive(Clone, Copy)]
pub(super) struct Surfaces<S: Simd> {
    pub point: SurfacePoint<S::f32s>,
    /// Unit normal for shading, on the side of the geometric one.
    pub shading_normal: V3<S::f32s>,
    /// Weights of a triangle's corners in the kernel's order; only where the plan interpolates.
    pub weights: [S::f32s; 3],
    /// Bit set of the lanes whose primitive is flat.
    pub flat: u64,
}

impl<S: Simd> Surfaces<S> {
    /// A number that corners carry, where the rays hit.
    #[inline(always)]
    pub fn blend(&self, corners: [S::f32s; 3]) -> S::f32s {
        let [u, v, w] = self.weights;
        corners[0] * u + corners[1] * v + corners[2] * w
    }

    /// Four numbers that corners carry, corner by corner.
    #[inline(always)]
    pub fn blend_four(&self, corners: &[S::f32s; 12]) -> [S::f32s; 4] {
        let mut blended = [corners[0]; 4];
        for (channel, blended) in blended.iter_mut().enumerate() {
            *blended = self.blend([corners[channel], corners[channel + 4], corners[channel + 8]]);
        }
        blended
    }

    /// The lanes that hit triangles; only where the plan interpolates.
    #[inline(always)]
    pub fn is_triangle(&self, simd: S) -> Mask<S> {
        let [u, v, w] = self.weights;
        (u + v + w).simd_gt(S::f32s::splat(simd, 0.5))
    }
}

/// The surfaces at distances `t`, of one primitive or of several.
#[inline(always)]
pub(super) fn surfaces<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    hits: &Hits<'_>,
    origin: V3<S::f32s>,
    direction: V3<S::f32s>,
    t: S::f32s,
) -> Surfaces<S> {
    match hits.common {
        Some(primitive) => surfaces_of_one(simd, frame, hits, primitive, origin, direction, t),
        None => surfaces_of_several(simd, frame, hits, origin, direction, t),
    }
}

/// [`surfaces`] where all rays that hit anything hit one `primitive`.
#[inline(always)]
pub(super) fn surfaces_of_one<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    hits: &Hits<'_>,
    primitive: PrimitiveIndex,
    origin: V3<S::f32s>,
    direction: V3<S::f32s>,
    t: S::f32s,
) -> Surfaces<S> {
    let geometry = &frame.scene.geometry;
    let slot = geometry.slot(primitive);
    let point = surface_of_one(simd, geometry, primitive, slot, origin, direction, t);
    let mut surfaces = Surfaces {
        point,
        shading_normal: point.normal,
        weights: [S::f32s::splat(simd, 0.0); 3],
        flat: if slot.kind.is_flat() { hits.active } else { 0 },
    };
    if frame.plan.vertex_attributes && slot.kind.is_triangle() {
        let fields = fields_of_one(simd, geometry, primitive, slot, geometry.triangles_of(slot.kind));
        surfaces.weights = Triangle::barycentric(&fields, &Rays::new(origin, direction));
        interpolate_normals(simd, frame, hits, &mut surfaces);
    }
    surfaces
}

/// [`surfaces`] where rays hit more than one primitive.
#[inline(always)]
pub(super) fn surfaces_of_several<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    hits: &Hits<'_>,
    origin: V3<S::f32s>,
    direction: V3<S::f32s>,
    t: S::f32s,
) -> Surfaces<S> {
    let geometry = &frame.scene.geometry;
    let zero = S::f32s::splat(simd, 0.0);
    let blank = SurfacePoint { position: V3::all(zero), normal: V3::all(zero), scale: zero };
    let mut surfaces = Surfaces { point: blank, shading_normal: V3::all(zero), weights: [zero; 3], flat: 0 };
    let places = Places::new(geometry, hits);
    let mut left = hits.active;
    while left != 0 {
        let first = left.trailing_zeros() as usize;
        let group = Group { geometry, hits, places: &places, first };
        let kind = places.slots[first].kind;
        let lanes = group.lanes(simd, left);
        left &= !lanes;
        if kind.is_flat() {
            surfaces.flat |= lanes;
        }
        let part = group.surface(simd, lanes, origin, direction, t);
        if lanes == hits.active {
            surfaces.point = part;
        } else {
            let mask = Mask::<S>::from_bitmask(simd, lanes);
            surfaces.point = SurfacePoint {
                position: V3::select(mask, part.position, surfaces.point.position),
                normal: V3::select(mask, part.normal, surfaces.point.normal),
                scale: mask.select(part.scale, surfaces.point.scale),
            };
        }
        if frame.plan.vertex_attributes && kind.is_triangle() {
            let fields = group.fields(simd, lanes, geometry.triangles_of(kind));
            let mask = Mask::<S>::from_bitmask(simd, lanes);
            let weights = Triangle::barycentric(&fields, &Rays::new(origin, direction));
            for (known, found) in surfaces.weights.iter_mut().zip(weights) {
                *known = mask.select(found, *known);
            }
        }
    }
    surfaces.shading_normal = surfaces.point.normal;
    if frame.plan.vertex_attributes {
        interpolate_normals(simd, frame, hits, &mut surfaces);
    }
    surfaces
}

/// Replaces the shading normals of triangles whose corners carry their own.
#[inline(always)]
fn interpolate_normals<S: Simd>(simd: S, frame: &Frame<'_>, hits: &Hits<'_>, surfaces: &mut Surfaces<S>) {
    let geometry = &frame.scene.geometry;
    let normals = hits.gather::<S, 9>(
        simd,
        #[inline(always)]
        |primitive| {
            let normals = frame
                .tables
                .attributes(
                    geometry,
                    primitive,
                    #[inline(always)]
                    |a| a.normals,
                )
                .flatten();
            let [a, b, c] = normals.unwrap_or([Vec3::ZERO; 3]);
            [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]
        },
    );
    let [u, v, w] = surfaces.weights;
    let blend = V3::new(normals[0], normals[1], normals[2]).scale(u)
        + V3::new(normals[3], normals[4], normals[5]).scale(v)
        + V3::new(normals[6], normals[7], normals[8]).scale(w);
    let zero = S::f32s::splat(simd, 0.0);
    let unit = blend.normalize();
    let flat = surfaces.point.normal;
    let unit = V3::select(unit.dot(flat).simd_lt(zero), -unit, unit);
    surfaces.shading_normal = V3::select(blend.dot(blend).simd_gt(zero), unit, flat);
}

/// Where the primitives of a packet's hits lie.
struct Places {
    /// For each lane; that of a hitting lane where there is no hit.
    slots: [Slot; MOST_LANES],
    /// The types of those, as numbers.
    kinds: [u32; MOST_LANES],
}

impl Places {
    #[inline(always)]
    fn new(geometry: &Geometry, hits: &Hits<'_>) -> Self {
        let slot = geometry.slot(hits.primitives[hits.first()]);
        let mut places = Self { slots: [slot; MOST_LANES], kinds: [slot.kind as u32; MOST_LANES] };
        for lane in hits.lanes() {
            let slot = geometry.slot(hits.primitives[lane]);
            (places.slots[lane], places.kinds[lane]) = (slot, slot.kind as u32);
        }
        places
    }
}

/// Primitives of one packet up to which blending by mask beats gathering.
const FEW: usize = 4;

/// The lanes of a packet that hit one type of primitive.
struct Group<'a> {
    geometry: &'a Geometry,
    hits: &'a Hits<'a>,
    places: &'a Places,
    /// A lane that hit this type.
    first: usize,
}

impl Group<'_> {
    /// Of the lanes `among`, those that hit this type.
    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, among: u64) -> u64 {
        let kinds = S::u32s::from_slice(simd, &self.places.kinds[..S::f32s::LEN]);
        among & kinds.simd_eq(S::u32s::splat(simd, self.places.kinds[self.first])).to_bitmask()
    }

    /// The fields of the primitives that `lanes` hit, all of this type. Other lanes get those of the first.
    #[inline(always)]
    fn fields<S: Simd, const N: usize>(&self, simd: S, lanes: u64, blocks: &[Block<N>]) -> [S::f32s; N] {
        let slots = &self.places.slots;
        let first = slots[self.first];
        let mut fields = fields_of_one(simd, self.geometry, self.hits.primitives[self.first], first, blocks);
        let primitives = S::u32s::from_slice(simd, self.hits.primitives);
        let mut left = lanes & !primitives.simd_eq(self.hits.primitives[self.first]).to_bitmask();
        for _ in 1..FEW {
            if left == 0 {
                return fields;
            }
            let lane = left.trailing_zeros() as usize;
            let mask = primitives.simd_eq(self.hits.primitives[lane]);
            left &= !mask.to_bitmask();
            let Some(block) = blocks.get(slots[lane].block as usize) else {
                let own: [f32; N] = shared_fields(self.geometry, self.hits.primitives[lane]);
                for (field, own) in fields.iter_mut().zip(own) {
                    *field = mask.select(S::f32s::splat(simd, own), *field);
                }
                continue;
            };
            let place = usize::from(slots[lane].place) % BLOCK;
            for (field, row) in fields.iter_mut().zip(&block.fields) {
                *field = mask.select(S::f32s::splat(simd, row[place]), *field);
            }
        }
        if left == 0 {
            return fields;
        }
        let mut gathered = [[0.0; MOST_LANES]; N];
        let mask = Mask::<S>::from_bitmask(simd, left);
        while left != 0 {
            let lane = left.trailing_zeros() as usize % MOST_LANES;
            left &= left - 1;
            let Some(block) = blocks.get(slots[lane].block as usize) else {
                let own: [f32; N] = shared_fields(self.geometry, self.hits.primitives[lane]);
                for (row, own) in gathered.iter_mut().zip(own) {
                    row[lane] = own;
                }
                continue;
            };
            let place = usize::from(slots[lane].place) % BLOCK;
            for (row, field) in gathered.iter_mut().zip(&block.fields) {
                row[lane] = field[place];
            }
        }
        for (field, row) in fields.iter_mut().zip(&gathered) {
            *field = mask.select(S::f32s::from_slice(simd, &row[..S::f32s::LEN]), *field);
        }
        fields
    }
}

/// The fields of the primitive in a slot, which is in one of the blocks or in none.
#[inline(always)]
fn fields_of_one<S: Simd, const N: usize>(
    simd: S,
    geometry: &Geometry,
    primitive: PrimitiveIndex,
    slot: Slot,
    blocks: &[Block<N>],
) -> [S::f32s; N] {
    if let Some(block) = blocks.get(slot.block as usize) {
        return block.splat(simd, slot.place.into());
    }
    let mut fields = [S::f32s::splat(simd, 0.0); N];
    for (field, own) in fields.iter_mut().zip(shared_fields::<N>(geometry, primitive)) {
        *field = S::f32s::splat(simd, own);
    }
    fields
}

/// The fields of a triangle of a shared mesh.
#[cold]
fn shared_fields<const N: usize>(geometry: &Geometry, primitive: PrimitiveIndex) -> [f32; N] {
    let mut fields = [0.0; N];
    for (field, own) in fields.iter_mut().zip(geometry.shared_fields(primitive)) {
        *field = own;
    }
    fields
}

macro_rules! define_surface {
    ($($kernel:ident $fields:literal $blocks:ident $outline:literal,)+) => {
        impl Group<'_> {
            /// The surfaces of `lanes`, which hit this type.
            #[inline(always)]
            fn surface<S: Simd>(
                &self, simd: S, lanes: u64, origin: V3<S::f32s>, direction: V3<S::f32s>, t: S::f32s,
            ) -> SurfacePoint<S::f32s> {
                match self.places.slots[self.first].kind {
                    $(PrimitiveKind::$kernel => {
                        let fields = self.fields::<S, $fields>(simd, lanes, &self.geometry.$blocks);
                        $kernel::surface(&fields, origin, direction, t)
                    })+
                }
            }
        }

        /// The surfaces of the primitive in a slot.
        #[inline(always)]
        fn surface_of_one<S: Simd>(
            simd: S,
            geometry: &Geometry,
            primitive: PrimitiveIndex,
            slot: Slot,
            origin: V3<S::f32s>,
            direction: V3<S::f32s>,
            t: S::f32s,
        ) -> SurfacePoint<S::f32s> {
            match slot.kind {
                $(PrimitiveKind::$kernel => {
                    let fields = fields_of_one::<S, $fields>(simd, geometry, primitive, slot, &geometry.$blocks);
                    $kernel::surface(&fields, origin, direction, t)
                })+
            }
        }
    };
}
for_each_primitive!(define_surface);

/// What a crossing of each lane's primitive leaves of the light: transparency times colour. 1 where nothing is crossed.
///
/// Blended surfaces take nothing from the headlight: what lies straight behind is seen as far as they are not opaque, and the
/// light at the eye, which is there for the eye's sake, does not count their opacity a second time.
#[inline(always)]
pub(super) fn transmission<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    primitives: &S::u32s,
    [origin, direction]: [V3<S::f32s>; 2],
    t: S::f32s,
) -> V3<S::f32s> {
    let hits = Hits::new(simd, primitives.as_slice());
    let one = V3::splat(simd, Vec3::ONE);
    if hits.active == 0 {
        return one;
    }
    let materials = MixedMaterials::new(simd, frame, &hits);
    let crossed = Mask::<S>::from_bitmask(simd, hits.active);
    let transparency = materials.triple(simd, Row::Transparency);
    let varies = frame.plan.vertex_colors || frame.plan.textures && materials.any(|material| material.textured);
    if !varies && !frame.plan.blending {
        return V3::select(crossed, transparency * materials.triple(simd, Row::Color), one);
    }
    let surfaces = surfaces(simd, frame, &hits, origin, direction, t);
    let skin = Skin::of(simd, frame, &hits, &surfaces, &materials, &Sight::sharp(direction));
    let through = transparency.scale(skin.transmission) * skin.color;
    let blended = materials.lanes(simd, |material| material.blended);
    let past = if frame.scene.headlight { one } else { V3::all(S::f32s::splat(simd, 1.0) - skin.coverage) };
    V3::select(crossed, V3::select(blended, past, through), one)
}
