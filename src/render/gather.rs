//! From hits to lanes: surfaces, material numbers and colours of a packet whose rays may have hit different things.
//!
//! Where all rays hit the same primitive, its numbers are splat; otherwise they are gathered lane by lane. The kernels
//! that run on them are the same text, so the bits do not depend on who else is in the packet.

use super::frame::Frame;
use super::queue::MOST_LANES;
use super::tables::{ROWS, Row};
use crate::geometry::primitive::{Cone, Disk, Kernel, Plane, Sphere, SurfacePoint, Triangle, for_each_primitive};
use crate::geometry::{Block, Geometry, NO_PRIMITIVE, Packet, PrimitiveKind, Slot};
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
}

impl<'a> Hits<'a> {
    pub fn new(primitives: &'a [u32]) -> Self {
        let hit = |(lane, &p): (usize, &u32)| u64::from(p != NO_PRIMITIVE) << lane;
        Self { primitives, active: primitives.iter().enumerate().map(hit).fold(0, |a, b| a | b) }
    }

    /// Lanes that hit something, in order.
    pub fn lanes(&self) -> impl Iterator<Item = usize> + use<> {
        bits(self.active)
    }

    /// The primitive that all hitting lanes hit, if there is just one.
    fn common(&self) -> Option<u32> {
        let first = self.primitives[self.lanes().next()?];
        self.lanes().all(|lane| self.primitives[lane] == first).then_some(first)
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
    let mut surfaces = Surfaces { point: blank, shading_normal: V3::all(zero), weights: [zero; 3] };
    let common = hits.common();
    let mut left = hits.active;
    while left != 0 {
        let first = left.trailing_zeros() as usize;
        let kind = geometry.slots[hits.primitives[first] as usize].kind;
        let slots = SlotsOf { geometry, hits, kind, common, first };
        let lanes = slots.lanes(left);
        left &= !lanes;
        let part = slots.surface(simd, origin, direction, t);
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
        if frame.plan.vertex_attributes && kind == PrimitiveKind::Triangle {
            let fields = slots.fields(simd, |g| &g.triangles);
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

/// The lanes of a packet that hit one type of primitive.
struct SlotsOf<'a> {
    geometry: &'a Geometry,
    hits: &'a Hits<'a>,
    kind: PrimitiveKind,
    common: Option<u32>,
    /// A lane that hit this type.
    first: usize,
}

impl SlotsOf<'_> {
    fn slot(&self, lane: usize) -> Slot {
        self.geometry.slots[self.hits.primitives[lane] as usize]
    }

    /// Of the lanes `among`, those that hit this type.
    #[inline(always)]
    fn lanes(&self, among: u64) -> u64 {
        if self.common.is_some() {
            return among;
        }
        bits(among).filter(|&lane| self.slot(lane).kind == self.kind).fold(0, |set, lane| set | 1 << lane)
    }

    /// The fields of the primitives hit. Lanes that hit another type get those of the first.
    #[inline(always)]
    fn fields<S: Simd, const N: usize>(&self, simd: S, blocks: impl Fn(&Geometry) -> &Vec<Block<N>>) -> [S::f32s; N] {
        let blocks = blocks(self.geometry);
        let slot = self.slot(self.first);
        if self.common.is_some() {
            return blocks[slot.block as usize].splat(simd, slot.place.into());
        }
        let lanes = S::f32s::LEN;
        let mut gathered = [[0.0; MOST_LANES]; N];
        for lane in 0..lanes {
            let hit = self.hits.active >> lane & 1 != 0;
            let slot = if hit && self.slot(lane).kind == self.kind { self.slot(lane) } else { slot };
            let block = &blocks[slot.block as usize];
            for (row, field) in gathered.iter_mut().zip(&block.fields) {
                row[lane] = field[usize::from(slot.place)];
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
        impl SlotsOf<'_> {
            /// The surfaces of the lanes that hit this type.
            #[inline(always)]
            fn surface<S: Simd>(
                &self, simd: S, origin: V3<S::f32s>, direction: V3<S::f32s>, t: S::f32s,
            ) -> SurfacePoint<S::f32s> {
                match self.kind {
                    $(PrimitiveKind::$kernel => {
                        let fields = self.fields::<S, $fields>(simd, |g| &g.$blocks);
                        $kernel::surface(&fields, origin, direction, t)
                    })+
                }
            }
        }
    };
}
for_each_primitive!(define_surface);

/// Materials of a packet's hits.
pub(super) struct Materials {
    /// Index of each lane's material; that of a hitting lane where there is no hit.
    lanes: [u32; MOST_LANES],
    /// Whether they are all the same.
    uniform: bool,
    /// A lane with a hit.
    first: usize,
}

impl Materials {
    #[inline(always)]
    pub fn new(frame: &Frame<'_>, hits: &Hits<'_>) -> Self {
        let material = |lane: usize| {
            let object = frame.scene.geometry.ids[hits.primitives[lane] as usize].object;
            frame.scene.objects[object as usize].material
        };
        let first = hits.active.trailing_zeros() as usize;
        let mut lanes = [material(first); MOST_LANES];
        if hits.common().is_none() {
            for lane in hits.lanes() {
                lanes[lane] = material(lane);
            }
        }
        Self { uniform: lanes.iter().all(|&m| m == lanes[0]), lanes, first }
    }

    /// The material of a lane.
    #[inline(always)]
    pub fn of(&self, lane: usize) -> usize {
        self.lanes[lane] as usize
    }

    /// Whether any lane's material passes a test.
    #[inline(always)]
    pub fn any(&self, hits: &Hits<'_>, mut test: impl FnMut(usize) -> bool) -> bool {
        if self.uniform { test(self.of(self.first)) } else { hits.lanes().any(|lane| test(self.of(lane))) }
    }

    /// One number of every lane's material.
    #[inline(always)]
    pub fn row<S: Simd>(&self, simd: S, frame: &Frame<'_>, row: usize) -> S::f32s {
        debug_assert!(row < ROWS);
        let materials = &frame.tables.materials;
        if self.uniform {
            return S::f32s::splat(simd, materials[self.of(self.first)].rows[row]);
        }
        let mut gathered = [0.0; MOST_LANES];
        for (value, &material) in gathered.iter_mut().zip(&self.lanes) {
            *value = materials[material as usize].rows[row];
        }
        S::f32s::from_slice(simd, &gathered[..S::f32s::LEN])
    }

    /// Three numbers in a row.
    #[inline(always)]
    pub fn triple<S: Simd>(&self, simd: S, frame: &Frame<'_>, first: Row) -> V3<S::f32s> {
        let row = first as usize;
        V3::new(self.row(simd, frame, row), self.row(simd, frame, row + 1), self.row(simd, frame, row + 2))
    }

    /// Surface colour and emission, textures looked up.
    #[inline(always)]
    pub fn colors<S: Simd>(
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
    let hits = Hits::new(primitives.as_slice());
    let one = V3::splat(simd, Vec3::ONE);
    if hits.active == 0 {
        return one;
    }
    let materials = Materials::new(frame, &hits);
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
