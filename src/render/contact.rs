//! Surfaces that touch the one that a ray hit: glass on a floor, a pane on a wall, two glass boxes side by side.
//!
//! Rays that follow from a hit start a little off its surface, and so beyond what touches it. So what lies in the same place
//! as a hit is collected before the hit is shaded, and met in one order:
//!
//! 1. Thin transparent surfaces, such as panes and decals, by (t, object, primitive). The ray that goes on straight
//!    through one meets the next at once; light that falls on what lies behind is filtered by those in front.
//! 2. An opaque surface, which ends the path. The faces of bodies in the same place are not
//!    seen: the picture is the limit of a body that is sunk into the opaque one, whatever their order in the file.
//! 3. Otherwise the faces of transparent bodies, as one interface: light bends once, from the body before the first to
//!    the body behind the last. The picture is the limit of bodies that overlap.

use super::frame::Frame;
use super::gather::{Hits, bits, surfaces, transmission};
use super::queue::{MOST_LANES, RayQueue};
use super::tables::Row;
use super::tile::Worker;
use crate::geometry::{BLOCK, ClosestHit, NO_PRIMITIVE, Opaque, Packet, Place, PrimitiveIndex, Search, Stack, Visitor};
use crate::math::V3;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::Vec3;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// Most transparent surfaces in one place; those farthest along the ray are left out.
const MOST: usize = 32;

/// Distances are known to this share of the coordinates that went into them.
const ROUNDING: f32 = 1.0 / (1 << 21) as f32;

/// Rays flatter than this are taken to be this steep.
const FLATTEST: f32 = 1.0 / 4096.0;

/// Most interfaces between equal media that a ray passes in a row without a level of its path.
const MOST_JOINTS: usize = 64;

/// An index into [`ContactArena`].
pub type Link = u32;

/// No contact.
pub const NO_CONTACT: Link = 0;

/// One hit of a place where surfaces touch.
#[derive(Clone, Copy, Debug)]
struct Entry {
    primitive: PrimitiveIndex,
    /// What the ray that goes on straight meets next.
    next: Link,
    /// The thin surface that the ray came through.
    before: Link,
    /// The other faces of the interface, as a range of the arena's faces.
    faces: (u32, u32),
    /// How far along the ray the last surface of this place lies behind the first.
    extent: f32,
}

/// A surface in the place of a hit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Crossing {
    t: f32,
    primitive: PrimitiveIndex,
    /// The object that the surface belongs to.
    pub object: u32,
    /// Whether the ray leaves the object here.
    pub leaves: bool,
}

/// Where an arena ended.
#[derive(Clone, Copy, Debug)]
pub struct Mark(usize, usize);

/// The arena of the places of one tile where surfaces touch.
#[derive(Debug, Default)]
pub struct ContactArena {
    entries: Vec<Entry>,
    faces: Vec<Crossing>,
}

impl ContactArena {
    /// Where the arena ends now.
    pub fn mark(&self) -> Mark {
        Mark(self.entries.len(), self.faces.len())
    }

    /// Forgets all entries made since `mark`.
    pub fn truncate(&mut self, mark: Mark) {
        self.entries.truncate(mark.0);
        self.faces.truncate(mark.1);
    }

    /// Forgets all entries.
    pub fn clear(&mut self) {
        self.entries.clear();
        self.faces.clear();
    }

    fn get(&self, link: Link) -> Option<&Entry> {
        self.entries.get((link as usize).checked_sub(1)?)
    }

    /// What the ray that goes on from a hit meets at once.
    pub fn next(&self, link: Link) -> Link {
        self.get(link).map_or(NO_CONTACT, |entry| entry.next)
    }

    /// How far along the ray the last surface in the place of a hit lies behind the first.
    fn extent(&self, link: Link) -> f32 {
        self.get(link).map_or(0.0, |entry| entry.extent)
    }

    /// The other faces of the interface that was hit.
    pub fn faces(&self, link: Link) -> &[Crossing] {
        self.get(link).map_or(&[], |entry| &self.faces[entry.faces.0 as usize..entry.faces.1 as usize])
    }

    /// Appends the hits of one place, in the order in which they are met; the last one's interface has more `faces`.
    fn push(&mut self, met: &[PrimitiveIndex], faces: &[Crossing], extent: f32) -> Link {
        let first_face = self.faces.len() as u32;
        self.faces.extend_from_slice(faces);
        let first = self.entries.len() as Link + 1;
        for (&primitive, place) in met.iter().zip(0..) {
            let is_last = place as usize + 1 == met.len();
            self.entries.push(Entry {
                primitive,
                next: if is_last { NO_CONTACT } else { first + place + 1 },
                before: if place == 0 { NO_CONTACT } else { first + place - 1 },
                faces: if is_last { (first_face, self.faces.len() as u32) } else { (first_face, first_face) },
                extent,
            });
        }
        first
    }

    /// What the thin surfaces that rays came through leave of light that comes the same way; 1 where there are none.
    #[inline(never)]
    fn filter<S: Simd>(&self, simd: S, frame: &Frame<'_>, links: S::u32s, place: [V3<S::f32s>; 2]) -> V3<S::f32s> {
        simd.vectorize(
            #[inline(always)]
            || {
                let mut filter = V3::splat(simd, Vec3::ONE);
                let mut links = links;
                loop {
                    let before = S::u32s::from_fn(simd, |lane| {
                        let entry = self.get(links.as_slice()[lane]);
                        entry.map_or(NO_CONTACT, |entry| entry.before)
                    });
                    if !before.simd_ne(S::u32s::splat(simd, NO_CONTACT)).any_true() {
                        return filter;
                    }
                    let thin = S::u32s::from_fn(simd, |lane| {
                        self.get(before.as_slice()[lane]).map_or(NO_PRIMITIVE, |entry| entry.primitive)
                    });
                    filter = filter * transmission(simd, frame, &thin, place, S::f32s::splat(simd, 0.0));
                    links = before;
                }
            },
        )
    }

    /// What the other faces of interfaces leave of the light that passes; 1 where there are none.
    #[inline(never)]
    pub fn tint<S: Simd>(&self, simd: S, frame: &Frame<'_>, links: S::u32s, place: [V3<S::f32s>; 2]) -> V3<S::f32s> {
        simd.vectorize(
            #[inline(always)]
            || {
                let mut tint = V3::splat(simd, Vec3::ONE);
                for number in 0..=MOST {
                    let faces = S::u32s::from_fn(simd, |lane| {
                        self.faces(links.as_slice()[lane]).get(number).map_or(NO_PRIMITIVE, |face| face.primitive)
                    });
                    if !faces.simd_ne(S::u32s::splat(simd, NO_PRIMITIVE)).any_true() {
                        break;
                    }
                    tint = tint * transmission(simd, frame, &faces, place, S::f32s::splat(simd, 0.0));
                }
                tint
            },
        )
    }
}

/// What touches the surfaces that a packet hit.
pub(super) struct Touching<S: Simd> {
    /// The places of the hits.
    pub links: S::u32s,
    /// How far apart the first and the last surface of each place are.
    pub depth: S::f32s,
    /// What light that falls on the surfaces comes through in the same place leaves of it.
    pub filter: V3<S::f32s>,
}

impl<S: Simd> Touching<S> {
    /// What touches the surfaces at `position`, with the normals `facing` on the viewer's side, that the packet at `at` hit.
    /// `None` where nothing does.
    #[inline(always)]
    pub fn of(
        simd: S,
        frame: &Frame<'_>,
        arena: &ContactArena,
        (rays, at): (&RayQueue, usize),
        [position, direction, facing]: [V3<S::f32s>; 3],
    ) -> Option<Self> {
        if !touches(simd, frame, rays, at) {
            return None;
        }
        let links = links(simd, rays, at);
        let along = S::f32s::from_fn(simd, |lane| arena.extent(links.as_slice()[lane]));
        let filter = arena.filter(simd, frame, links, [position, direction]);
        Some(Self { links, depth: along * -direction.dot(facing), filter })
    }
}

/// Whether any hit of the packet at `at` is of a place where surfaces touch.
#[inline(always)]
pub(super) fn touches<S: Simd>(simd: S, frame: &Frame<'_>, rays: &RayQueue, at: usize) -> bool {
    frame.plan.contacts && links(simd, rays, at).simd_ne(S::u32s::splat(simd, NO_CONTACT)).any_true()
}

#[inline(always)]
fn links<S: Simd>(simd: S, rays: &RayQueue, at: usize) -> S::u32s {
    S::u32s::from_slice(simd, &rays.contact[at..at + S::f32s::LEN])
}

/// Replaces hits in `worker.rays` by what is met first in their place, and links the rest to them.
pub(super) fn resolve<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, worker: &mut Worker) {
    // Rays from the eye come from no surface.
    let first = if level == 1 { 0 } else { worker.rays.len() };
    worker.rays.clear_contacts(first);
    let mut known = Known { primitive: NO_PRIMITIVE, places: &[] };
    simd.vectorize(
        #[inline(always)]
        || {
            for at in (0..worker.rays.len()).step_by(S::f32s::LEN) {
                resolve_packet(simd, frame, level, at, &mut known, worker);
            }
        },
    );
}

/// The places of the primitive that was asked for last: neighbours hit the same.
struct Known<'a> {
    primitive: PrimitiveIndex,
    places: &'a [Place],
}

#[inline(always)]
fn resolve_packet<'a, S: Simd>(
    simd: S,
    frame: &Frame<'a>,
    level: u32,
    at: usize,
    known: &mut Known<'a>,
    worker: &mut Worker,
) {
    let Worker { rays, contacts, .. } = worker;
    let linked = links(simd, rays, at).simd_ne(S::u32s::splat(simd, NO_CONTACT)).to_bitmask();
    for lane in bits(linked) {
        if let Some(entry) = contacts.get(rays.contact[at + lane]) {
            (rays.primitive[at + lane], rays.t[at + lane]) = (entry.primitive, 0.0);
        }
    }
    let primitives = S::u32s::from_slice(simd, &rays.primitive[at..at + S::f32s::LEN]);
    let mut left = primitives.simd_ne(S::u32s::splat(simd, NO_PRIMITIVE)).to_bitmask() & !linked;
    let mut touching = 0;
    while left != 0 {
        let primitive = primitives.as_slice()[left.trailing_zeros() as usize];
        let same = primitives.simd_eq(S::u32s::splat(simd, primitive)).to_bitmask() & left;
        left &= !same;
        if known.primitive != primitive {
            *known = Known { primitive, places: frame.scene.contacts.places_of(primitive) };
        }
        if !known.places.is_empty() {
            touching |= same & lanes_within(simd, known.places, rays, at);
        }
    }
    for lane in bits(touching) {
        settle(simd, frame, level, at + lane, worker);
    }
}

/// Bit set of the lanes of the packet at `at` whose hits lie in one of some places, by the arithmetic of [`tolerance_at`].
#[inline(always)]
fn lanes_within<S: Simd>(simd: S, places: &[Place], rays: &RayQueue, at: usize) -> u64 {
    let t = S::f32s::from_slice(simd, &rays.t[at..at + S::f32s::LEN]);
    let origin: V3<S::f32s> = rays.origins(simd, at);
    let direction: V3<S::f32s> = rays.direction.load(simd, at);
    let point = origin + direction.scale(t);
    let rounding = (origin.x.abs().max(origin.y.abs()).max(origin.z.abs()) + t) * ROUNDING;
    let mut within = 0;
    for Place { bounds, .. } in places {
        let holds = |value: S::f32s, min: f32, max: f32| {
            (S::f32s::splat(simd, min) - rounding).simd_le(value)
                & (S::f32s::splat(simd, max) + rounding).simd_ge(value)
        };
        let inside = holds(point.x, bounds.min.x, bounds.max.x)
            & holds(point.y, bounds.min.y, bounds.max.y)
            & holds(point.z, bounds.min.z, bounds.max.z);
        within |= inside.to_bitmask();
    }
    within
}

/// Decides what one ray meets, through all joints on its way.
fn settle<S: Simd>(simd: S, frame: &Frame<'_>, level: u32, at: usize, worker: &mut Worker) {
    for _ in 0..MOST_JOINTS {
        let places = frame.scene.contacts.places_of(worker.rays.primitive[at]);
        let Some(tolerance) = tolerance_at(places, &worker.rays, at) else { return };
        let goes_on = simd.vectorize(
            #[inline(always)]
            || resolve_ray(simd, frame, level, at, tolerance, worker),
        );
        if !goes_on {
            return;
        }
    }
}

/// How far apart surfaces may be in the place of a ray's hit, if it is one where they touch.
fn tolerance_at(places: &[Place], rays: &RayQueue, at: usize) -> Option<f32> {
    let (origin, t) = (rays.origin_of(at), rays.t[at]);
    let (point, rounding) = (origin + rays.direction.get(at) * t, (origin.abs().max_element() + t) * ROUNDING);
    let around = places.iter().filter(|place| place.bounds.padded(rounding).holds(point));
    around.map(|place| place.tolerance + rounding).reduce(f32::max)
}

/// Decides what a ray meets where surfaces touch. Tells whether it went on to another hit.
#[inline(always)]
fn resolve_ray<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    level: u32,
    at: usize,
    tolerance: f32,
    worker: &mut Worker,
) -> bool {
    let Worker { rays, stack, contacts, media, .. } = worker;
    // One ray in all lanes: what is searched by it looks at the first.
    let (origin, direction) = (V3::splat(simd, rays.origin_of(at)), V3::splat(simd, rays.direction.get(at)));
    let packet = Packet::new(&frame.scene.geometry, origin, direction);
    let mut found = [Crossing::default(); MOST + 1];
    let count = collect(simd, frame, &packet, rays.t[at], tolerance, stack, &mut found);
    let found = &found[..count];
    if count < 2 {
        return false;
    }
    let opaque = frame.tables.opaque(&frame.scene.geometry);
    let is_body = |crossing: &Crossing| frame.scene.objects[crossing.object as usize].body;
    let passes = |crossing: &&Crossing| !opaque.contains(crossing.primitive);
    let mut met = [NO_PRIMITIVE; MOST + 2];
    let mut thin = 0;
    for crossing in found.iter().filter(passes).filter(|crossing| !is_body(crossing)) {
        met[thin] = crossing.primitive;
        thin += 1;
    }
    let mut faces = [Crossing::default(); MOST + 1];
    let mut others = 0;
    let mut last = found.iter().find(|crossing| !passes(crossing));
    if last.is_none() {
        let bodies = || found.iter().filter(passes).filter(|crossing| is_body(crossing));
        if thin == 0 && frame.plan.refractions && bodies().all(|crossing| is_clear(frame, crossing)) {
            let list = bodies().fold(rays.media[at], |list, face| media.cross(list, face.object, face.leaves));
            let matter = |list| {
                let material = media.current(list).map(|body| frame.scene.material_of(body));
                material.map_or((1.0, Vec3::ZERO), |material| (material.ior, material.absorption))
            };
            if matter(list) == matter(rays.media[at]) {
                // The same glass goes on: nothing is there to be seen.
                let far = if level == 1 { frame.camera.far } else { f32::INFINITY };
                rays.media[at] = list;
                (rays.primitive[at], rays.t[at]) = next_hit(simd, frame, &packet, found[count - 1].t, far, stack);
                return true;
            }
        }
        let mut bodies = bodies();
        last = bodies.next();
        for crossing in bodies {
            faces[others] = *crossing;
            others += 1;
        }
    }
    let total = thin + usize::from(last.is_some());
    if let Some(last) = last {
        met[thin] = last.primitive;
    }
    if let Some(hit) = found.iter().find(|crossing| crossing.primitive == met[0]) {
        (rays.t[at], rays.primitive[at]) = (hit.t, hit.primitive);
    }
    if total > 1 || others > 0 {
        let extent = found[count - 1].t - found[0].t;
        rays.contact[at] = contacts.push(&met[..total], &faces[..others], extent);
    }
    false
}

/// Whether nothing of a face is seen where the media on both sides are the same.
fn is_clear(frame: &Frame<'_>, crossing: &Crossing) -> bool {
    let geometry = &frame.scene.geometry;
    let material = &frame.tables.materials[frame.tables.material_of(geometry, crossing.primitive) as usize];
    let is = |row: Row, value: f32| material.rows[row as usize..][..3] == [value; 3];
    let untouched = !(material.shiny || material.emissive || material.textured || frame.plan.vertex_colors);
    untouched && is(Row::Transparency, 1.0) && is(Row::Color, 1.0) && is(Row::Reflectivity, 0.0)
}

/// What a ray hits beyond `t`, and how far away.
#[inline(always)]
fn next_hit<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    packet: &Packet<S>,
    t: f32,
    far: f32,
    stack: &mut Stack,
) -> (PrimitiveIndex, f32) {
    // One lane is enough.
    let limit = S::f32s::from_fn(simd, |lane| if lane == 0 { far } else { -1.0 });
    let mut visitor = ClosestHit::new(simd, S::f32s::splat(simd, t), limit);
    Search::new(&frame.scene.geometry, frame.plan.tree).traverse_alone(simd, packet, stack, &mut visitor);
    let primitive = visitor.primitive[0];
    (primitive, if primitive == NO_PRIMITIVE { f32::INFINITY } else { visitor.t[0] })
}

/// Collects what lies in the place of a hit at distance `t`, by (t, primitive); returns how much.
///
/// A ray through an edge between two faces of an object crosses both: the second does not count.
#[inline(always)]
fn collect<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    packet: &Packet<S>,
    t: f32,
    tolerance: f32,
    stack: &mut Stack,
    found: &mut [Crossing; MOST + 1],
) -> usize {
    let mut window = Window {
        simd,
        after: (t - tolerance / FLATTEST).max(0.0),
        limit: t + tolerance / FLATTEST,
        opaque: frame.tables.opaque(&frame.scene.geometry),
        first_opaque: None,
        hits: [(0.0, 0); MOST],
        len: 0,
    };
    Search::new(&frame.scene.geometry, frame.plan.tree).traverse_alone(simd, packet, stack, &mut window);
    let mut hits = [(0.0, 0); MOST + 1];
    let mut len = window.len;
    hits[..len].copy_from_slice(&window.hits[..len]);
    if let Some(opaque) = window.first_opaque {
        let at = hits[..len].partition_point(|hit| *hit < opaque);
        len += 1;
        hits[at..len].rotate_right(1);
        hits[at] = opaque;
    }
    let mut count = 0;
    for first in (0..len).step_by(S::f32s::LEN) {
        let hits = &hits[first..len.min(first + S::f32s::LEN)];
        let mut primitives = [NO_PRIMITIVE; MOST_LANES];
        let mut distances = [0.0; MOST_LANES];
        for (lane, &(t, primitive)) in hits.iter().enumerate() {
            (distances[lane], primitives[lane]) = (t, primitive);
        }
        let cosines = cosines(simd, frame, packet, &primitives[..S::f32s::LEN], &distances[..S::f32s::LEN]);
        for (lane, &(other, primitive)) in hits.iter().enumerate() {
            let cosine = cosines[lane];
            let gap = (other - t).abs() * cosine.abs().max(FLATTEST);
            let is_elsewhere = gap > tolerance || frame.scene.contacts.places_of(primitive).is_empty();
            if is_elsewhere && other > t {
                // What lies behind it cannot be met at once.
                return count;
            }
            let object = frame.scene.geometry.object_of(primitive);
            let crossing = Crossing { t: other, primitive, object, leaves: cosine > 0.0 };
            let is_known = |known: &Crossing| known.object == object && known.leaves == crossing.leaves;
            if !is_elsewhere && !found[..count].iter().any(is_known) {
                found[count] = crossing;
                count += 1;
            }
        }
    }
    count
}

/// The cosines between a ray and the normals of what it hits.
#[inline(always)]
fn cosines<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    packet: &Packet<S>,
    primitives: &[PrimitiveIndex],
    t: &[f32],
) -> S::f32s {
    let hits = Hits::new(simd, primitives);
    let (origin, direction) = (packet.rays.origin, packet.rays.direction);
    let t = S::f32s::from_slice(simd, t);
    surfaces(simd, frame, &hits, origin, direction, t).point.normal.dot(direction)
}

/// Collects the hits of one ray, which all lanes hold, within an interval: the nearest transparent ones by (t, primitive), and
/// the first opaque one.
struct Window<'a, S> {
    simd: S,
    opaque: Opaque<'a>,
    first_opaque: Option<(f32, PrimitiveIndex)>,
    /// Exclusive.
    after: f32,
    /// Inclusive.
    limit: f32,
    hits: [(f32, PrimitiveIndex); MOST],
    len: usize,
}

impl<S> Window<'_, S> {
    fn add(&mut self, t: f32, primitive: PrimitiveIndex) {
        if self.opaque.contains(primitive) {
            if self.first_opaque.is_none_or(|first| (t, primitive) < first) {
                self.first_opaque = Some((t, primitive));
            }
            return;
        }
        let hits = &self.hits[..self.len];
        if hits.iter().any(|hit| hit.1 == primitive) {
            return;
        }
        let at = hits.partition_point(|&(other, index)| (other, index) < (t, primitive));
        if at == MOST {
            return;
        }
        self.len = (self.len + 1).min(MOST);
        self.hits[at..self.len].rotate_right(1);
        self.hits[at] = (t, primitive);
    }
}

impl<S: Simd> Visitor<S> for Window<'_, S> {
    #[inline(always)]
    fn passes_backs(&self) -> bool {
        true
    }

    #[inline(always)]
    fn t_min(&self, _primitive: PrimitiveIndex) -> S::f32s {
        S::f32s::splat(self.simd, self.after)
    }

    #[inline(always)]
    fn limit(&self) -> S::f32s {
        S::f32s::splat(self.simd, self.limit)
    }

    #[inline(always)]
    fn hit(&mut self, mask: Mask<S>, t: S::f32s, primitive: PrimitiveIndex) {
        if mask.to_bitmask() & 1 == 1 {
            self.add(t[0], primitive);
        }
    }

    #[inline(always)]
    fn is_finished(&self) -> bool {
        false
    }

    #[inline(always)]
    fn lane_limit(&self, lane: usize) -> f32 {
        if lane == 0 { self.limit } else { -1.0 }
    }

    #[inline(always)]
    fn lane_t_min(&self, simd: S, _lane: usize, _primitives: &[PrimitiveIndex; BLOCK]) -> f32x8<S> {
        f32x8::splat(simd, self.after)
    }

    #[inline(always)]
    fn lane_hit(&mut self, lane: usize, t: f32, primitive: PrimitiveIndex) {
        if lane == 0 {
            self.add(t, primitive);
        }
    }
}
