//! From hits to lanes: surfaces, material numbers and colours of a packet whose rays may have hit different things.
//!
//! Where all rays hit the same primitive, its numbers are splat; otherwise they are gathered lane by lane. The kernels
//! that run on them are the same text, so the bits do not depend on who else is in the packet.

use super::frame::Frame;
use super::queue::MOST_LANES;
use super::tables::{ROWS, Row};
use crate::geometry::primitive::{Cone, Disk, Kernel, Plane, Sphere, SurfacePoint, Triangle, for_each_primitive};
use crate::geometry::{BLOCK, Block, Geometry, NO_PRIMITIVE, Packet, PrimitiveKind, Slot};
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::{Vec2, Vec3};

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// What the rays of a packet hit.
pub(super) struct Hits<'a> {
    pub primitives: &'a [u32],
    /// Bit set of the lanes that hit something.
    pub active: u64,
    /// The primitive that all hitting lanes hit, if there is just one.
    common: Option<u32>,
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
}

/// Set bits, lowest first.
pub(super) fn bits(mut set: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (set != 0).then(|| {
            let lane = set.trailing_zeros() as usize;
            set &= set - 1;
            lane
        })
    })
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

/// The surfaces at distances `t`.
#[inline(always)]
pub(super) fn surfaces<S: Simd>(
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
    let slots = slots_of(geometry, hits);
    let mut left = hits.active;
    while left != 0 {
        let first = left.trailing_zeros() as usize;
        let group = Group { geometry, hits, slots: &slots, kind: slots[first].kind, first };
        let lanes = group.lanes(left);
        left &= !lanes;
        if group.kind.is_flat() {
            surfaces.flat |= lanes;
        }
        let part = group.surface(simd, origin, direction, t);
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
        if frame.plan.vertex_attributes && group.kind == PrimitiveKind::Triangle {
            let fields = group.fields(simd, &geometry.triangles);
            surfaces.weights = Triangle::barycentric(&fields, origin, direction);
        }
    }
    surfaces.shading_normal = surfaces.point.normal;
    if frame.plan.vertex_attributes {
        interpolate_normals(geometry, hits, &mut surfaces);
    }
    surfaces
}

/// Replaces the shading normals of triangles whose corners carry their own.
#[inline(always)]
fn interpolate_normals<S: Simd>(geometry: &Geometry, hits: &Hits<'_>, surfaces: &mut Surfaces<S>) {
    for lane in hits.lanes() {
        let Some(normals) = geometry.attributes_of(hits.primitives[lane]).and_then(|a| a.normals) else { continue };
        let [u, v, w] = surfaces.weights.map(|weight| weight[lane]);
        let blend = normals[0] * u + normals[1] * v + normals[2] * w;
        let length = blend.dot(blend).sqrt();
        if length > 0.0 {
            let flat = surfaces.point.normal.lane(lane);
            let unit = blend / length;
            let unit = if unit.dot(flat) < 0.0 { -unit } else { unit };
            surfaces.shading_normal.x[lane] = unit.x;
            surfaces.shading_normal.y[lane] = unit.y;
            surfaces.shading_normal.z[lane] = unit.z;
        }
    }
}

/// Where the primitive of each lane lies; that of a hitting lane where there is no hit.
#[inline(always)]
fn slots_of(geometry: &Geometry, hits: &Hits<'_>) -> [Slot; MOST_LANES] {
    let mut slots = [geometry.slots[hits.primitives[hits.active.trailing_zeros() as usize] as usize]; MOST_LANES];
    if hits.common.is_none() {
        for lane in hits.lanes() {
            slots[lane] = geometry.slots[hits.primitives[lane] as usize];
        }
    }
    slots
}

/// The lanes of a packet that hit one type of primitive.
struct Group<'a> {
    geometry: &'a Geometry,
    hits: &'a Hits<'a>,
    slots: &'a [Slot; MOST_LANES],
    kind: PrimitiveKind,
    /// A lane that hit this type.
    first: usize,
}

impl Group<'_> {
    /// Of the lanes `among`, those that hit this type.
    #[inline(always)]
    fn lanes(&self, among: u64) -> u64 {
        if self.hits.common.is_some() {
            return among;
        }
        let mut lanes = 0;
        for lane in bits(among) {
            lanes |= u64::from(self.slots[lane].kind == self.kind) << lane;
        }
        lanes
    }

    /// The fields of the primitives hit. Lanes that hit another type get those of the first.
    #[inline(always)]
    fn fields<S: Simd, const N: usize>(&self, simd: S, blocks: &[Block<N>]) -> [S::f32s; N] {
        let first = self.slots[self.first];
        if self.hits.common.is_some() {
            return blocks[first.block as usize].splat(simd, first.place.into());
        }
        let lanes = S::f32s::LEN;
        let mut gathered = [[0.0; MOST_LANES]; N];
        for lane in 0..lanes {
            let slot = if self.slots[lane].kind == self.kind { self.slots[lane] } else { first };
            let block = &blocks[slot.block as usize];
            let place = usize::from(slot.place) % BLOCK;
            for (row, field) in gathered.iter_mut().zip(&block.fields) {
                row[lane] = field[place];
            }
        }
        let mut fields = [S::f32s::splat(simd, 0.0); N];
        for (field, row) in fields.iter_mut().zip(&gathered) {
            *field = S::f32s::from_slice(simd, &row[..lanes]);
        }
        fields
    }
}

macro_rules! define_surface {
    ($($kernel:ident $fields:literal $blocks:ident,)+) => {
        impl Group<'_> {
            /// The surfaces of the lanes that hit this type.
            #[inline(always)]
            fn surface<S: Simd>(
                &self, simd: S, origin: V3<S::f32s>, direction: V3<S::f32s>, t: S::f32s,
            ) -> SurfacePoint<S::f32s> {
                match self.kind {
                    $(PrimitiveKind::$kernel => {
                        let fields = self.fields::<S, $fields>(simd, &self.geometry.$blocks);
                        $kernel::surface(&fields, origin, direction, t)
                    })+
                }
            }
        }
    };
}
for_each_primitive!(define_surface);

/// Materials of a packet's hits.
pub(super) struct Materials<S: Simd> {
    /// The material of each lane; that of a hitting lane where there is no hit.
    lanes: [u32; MOST_LANES],
    /// Each material once.
    distinct: [u32; MOST_LANES],
    /// Which lanes have it.
    masks: [Mask<S>; MOST_LANES],
    /// How many there are.
    count: usize,
}

impl<S: Simd> Materials<S> {
    #[inline(always)]
    pub fn new(simd: S, frame: &Frame<'_>, hits: &Hits<'_>) -> Self {
        let ids = &frame.scene.geometry.ids;
        let objects = &frame.scene.objects;
        let first = hits.active.trailing_zeros() as usize;
        let material = objects[ids[hits.primitives[first] as usize].object as usize].material;
        let mut materials = Self {
            lanes: [material; MOST_LANES],
            distinct: [material; MOST_LANES],
            masks: [Mask::<S>::splat(simd, true); MOST_LANES],
            count: 1,
        };
        if hits.common.is_none() {
            for lane in hits.lanes() {
                materials.lanes[lane] = objects[ids[hits.primitives[lane] as usize].object as usize].material;
            }
            materials.sort_out(simd);
        }
        materials
    }

    /// Finds which materials there are, and where.
    #[inline(always)]
    fn sort_out(&mut self, simd: S) {
        let lanes = S::u32s::from_slice(simd, &self.lanes[..S::f32s::LEN]);
        let mut left = (1_u64 << S::f32s::LEN) - 1;
        self.count = 0;
        while left != 0 {
            let material = self.lanes[left.trailing_zeros() as usize];
            let same = lanes.simd_eq(S::u32s::splat(simd, material)).to_bitmask();
            self.distinct[self.count] = material;
            self.masks[self.count] = Mask::<S>::from_bitmask(simd, same);
            self.count += 1;
            left &= !same;
        }
    }

    /// The material of a lane.
    #[inline(always)]
    pub fn of(&self, lane: usize) -> usize {
        self.lanes[lane] as usize
    }

    /// Whether any material passes a test.
    #[inline(always)]
    pub fn any(&self, mut test: impl FnMut(usize) -> bool) -> bool {
        for &material in &self.distinct[..self.count] {
            if test(material as usize) {
                return true;
            }
        }
        false
    }

    /// One number of every lane's material.
    #[inline(always)]
    pub fn row(&self, simd: S, frame: &Frame<'_>, row: usize) -> S::f32s {
        debug_assert!(row < ROWS);
        let table = &frame.tables.materials;
        let mut value = S::f32s::splat(simd, table[self.distinct[0] as usize].rows[row]);
        for other in 1..self.count {
            let number = S::f32s::splat(simd, table[self.distinct[other] as usize].rows[row]);
            value = self.masks[other].select(number, value);
        }
        value
    }

    /// Three numbers in a row.
    #[inline(always)]
    pub fn triple(&self, simd: S, frame: &Frame<'_>, first: Row) -> V3<S::f32s> {
        let row = first as usize;
        V3::new(self.row(simd, frame, row), self.row(simd, frame, row + 1), self.row(simd, frame, row + 2))
    }

    /// Surface colour and emission, textures looked up.
    #[inline(always)]
    pub fn colors(
        &self,
        simd: S,
        frame: &Frame<'_>,
        hits: &Hits<'_>,
        surfaces: &Surfaces<S>,
    ) -> (V3<S::f32s>, V3<S::f32s>) {
        let mut color = self.triple(simd, frame, Row::Color);
        let mut emission = self.triple(simd, frame, Row::Emission);
        if frame.plan.textures {
            for lane in hits.lanes() {
                let material = &frame.tables.materials[self.of(lane)];
                if material.color_texture.is_none() && material.emission_texture.is_none() {
                    continue;
                }
                let uv = texture_coordinates(frame, hits.primitives[lane], surfaces, lane);
                let look_up = |texture: Option<u32>, into: &mut V3<S::f32s>| {
                    if let Some(texture) = texture {
                        let found = frame.scene.textures[texture as usize].sample(uv);
                        (into.x[lane], into.y[lane], into.z[lane]) = found.into();
                    }
                };
                look_up(material.color_texture, &mut color);
                look_up(material.emission_texture, &mut emission);
            }
        }
        (color, emission)
    }
}

/// Texture coordinates of one lane's hit.
fn texture_coordinates<S: Simd>(frame: &Frame<'_>, primitive: u32, surfaces: &Surfaces<S>, lane: usize) -> Vec2 {
    let geometry = &frame.scene.geometry;
    let id = geometry.ids[primitive as usize];
    let own = geometry.attributes_of(primitive).and_then(|a| a.uvs).map(|uvs| {
        let [u, v, w] = surfaces.weights.map(|weight| weight[lane]);
        uvs[0] * u + uvs[1] * v + uvs[2] * w
    });
    let (position, normal) = (surfaces.point.position.lane(lane), surfaces.point.normal.lane(lane));
    frame.scene.objects[id.object as usize].texture_coordinates(id.primitive, position, normal, own)
}

/// What a crossing of each lane's primitive leaves of the light: transparency times colour. 1 where nothing is crossed.
#[inline(always)]
pub(super) fn transmission<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    primitives: &S::u32s,
    packet: &Packet<S>,
    t: S::f32s,
) -> V3<S::f32s> {
    let hits = Hits::new(simd, primitives.as_slice());
    let one = V3::splat(simd, Vec3::ONE);
    if hits.active == 0 {
        return one;
    }
    let materials = Materials::new(simd, frame, &hits);
    let color = if frame.plan.textures {
        let surfaces = surfaces(simd, frame, &hits, packet.origin, packet.direction, t);
        materials.colors(simd, frame, &hits, &surfaces).0
    } else {
        materials.triple(simd, frame, Row::Color)
    };
    let transparency = one - materials.triple(simd, frame, Row::Opacity);
    let crossed = Mask::<S>::from_bitmask(simd, hits.active);
    V3::select(crossed, transparency * color, one)
}
