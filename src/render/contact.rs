//! Surfaces that touch the one that a ray hit: glass on a floor, a pane on a wall, two glass boxes side by side.
//!
//! Rays that follow from a hit start a little off its surface, beyond all that touches it. So what lies in the same place
//! as a hit is collected before the hit is shaded, and met in one order:
//!
//! 1. Thin transparent surfaces, such as panes and decals, by (t, object, primitive). The ray that goes on straight
//!    through one meets the next at once; light that falls on what lies behind is filtered by those in front.
//! 2. An opaque surface, which ends the path. The faces of bodies in the same place are void then: the picture is
//!    the limit of a body that is sunk into the opaque one, and does not depend on their order in the file.
//! 3. Otherwise the faces of transparent bodies, as one interface: light bends once, from the body before the first to
//!    the body behind the last. The picture is the limit of bodies that overlap.

use super::frame::Frame;
use super::gather::{Hits, surfaces, transmission};
use super::leave::{self, FLATTEST};
use super::queue::{MOST_LANES, RayQueue};
use super::tile::Worker;
use crate::geometry::{Aabb, BLOCK, NO_PRIMITIVE, Packet, PrimitiveIndex, Search, Stack, Visitor};
use crate::math::V3;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::Vec3;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// Most surfaces in one place; those farthest along the ray are left out.
const MOST: usize = 16;

/// Surfaces touch up to this multiple of the distance by which rays start off a surface.
const REACH: f32 = 1.5;

/// Distances are known to this share of the coordinates that went into them.
const ROUNDING: f32 = 1.0 / (1 << 21) as f32;

/// A place in an arena of [`Contacts`].
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

/// The face of a body.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// The primitive.
    pub primitive: PrimitiveIndex,
    /// Whether the ray leaves the body here.
    pub leaves: bool,
}

/// Where an arena ended.
#[derive(Clone, Copy, Debug)]
pub struct Mark(usize, usize);

/// The places of one tile where surfaces touch.
#[derive(Debug, Default)]
pub struct Contacts {
    entries: Vec<Entry>,
    faces: Vec<Face>,
}

impl Contacts {
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
    pub fn extent(&self, link: Link) -> f32 {
        self.get(link).map_or(0.0, |entry| entry.extent)
    }

    /// The other faces of the interface that was hit.
    pub fn faces(&self, link: Link) -> &[Face] {
        self.get(link).map_or(&[], |entry| &self.faces[entry.faces.0 as usize..entry.faces.1 as usize])
    }

    /// Appends the hits of one place, in the order in which they are met; the last one's interface has more `faces`.
    fn push(&mut self, met: &[PrimitiveIndex], faces: &[Face], extent: f32) -> Link {
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
    pub fn filter<S: Simd>(&self, simd: S, frame: &Frame<'_>, links: S::u32s, place: [V3<S::f32s>; 2]) -> V3<S::f32s> {
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
    }

    /// What the other faces of interfaces leave of the light that passes; 1 where there are none.
    #[inline(never)]
    pub fn tint<S: Simd>(&self, simd: S, frame: &Frame<'_>, links: S::u32s, place: [V3<S::f32s>; 2]) -> V3<S::f32s> {
        let mut tint = V3::splat(simd, Vec3::ONE);
        for number in 0..MOST {
            let faces = S::u32s::from_fn(simd, |lane| {
                self.faces(links.as_slice()[lane]).get(number).map_or(NO_PRIMITIVE, |face| face.primitive)
            });
            if !faces.simd_ne(S::u32s::splat(simd, NO_PRIMITIVE)).any_true() {
                break;
            }
            tint = tint * transmission(simd, frame, &faces, place, S::f32s::splat(simd, 0.0));
        }
        tint
    }
}

/// The links of the packet at `at`, if any of its hits is of a place where surfaces touch.
#[inline(always)]
pub(super) fn links<S: Simd>(simd: S, frame: &Frame<'_>, rays: &RayQueue, at: usize) -> Option<S::u32s> {
    if !frame.plan.contacts {
        return None;
    }
    let links = S::u32s::from_slice(simd, &rays.contact[at..at + S::f32s::LEN]);
    links.simd_ne(S::u32s::splat(simd, NO_CONTACT)).any_true().then_some(links)
}

/// Replaces hits in `worker.rays` by what is met first in their place, and links the rest to them.
pub(super) fn resolve<S: Simd>(simd: S, frame: &Frame<'_>, worker: &mut Worker) {
    // Neighbours hit the same primitive, and most touch nothing.
    let mut untouched = NO_PRIMITIVE;
    for at in (0..worker.rays.len()).step_by(S::f32s::LEN) {
        let lanes = at..at + S::f32s::LEN;
        let primitives = S::u32s::from_slice(simd, &worker.rays.primitive[lanes.clone()]);
        let links = S::u32s::from_slice(simd, &worker.rays.contact[lanes]);
        let known = primitives.simd_eq(S::u32s::splat(simd, untouched))
            | primitives.simd_eq(S::u32s::splat(simd, NO_PRIMITIVE));
        if (known & links.simd_eq(S::u32s::splat(simd, NO_CONTACT))).all_true() {
            continue;
        }
        for at in at..worker.rays.len().min(at + S::f32s::LEN) {
            let primitive = worker.rays.primitive[at];
            if let Some(entry) = worker.contacts.get(worker.rays.contact[at]) {
                (worker.rays.primitive[at], worker.rays.t[at]) = (entry.primitive, 0.0);
            } else if primitive != untouched && primitive != NO_PRIMITIVE {
                let places = frame.tables.contacts.places_of(primitive);
                if places.is_empty() {
                    untouched = primitive;
                } else if lies_in(places, &worker.rays, at) {
                    simd.vectorize(
                        #[inline(always)]
                        || resolve_ray(simd, frame, at, worker),
                    );
                }
            }
        }
    }
}

/// Whether a ray's hit lies in one of some places.
fn lies_in(places: &[Aabb], rays: &RayQueue, at: usize) -> bool {
    let (origin, t) = (rays.origin_of(at), rays.t[at]);
    let (point, rounding) = (origin + rays.direction.get(at) * t, (origin.abs().max_element() + t) * ROUNDING);
    places.iter().any(|place| place.padded(rounding).holds(point))
}

/// A surface in the place of a hit.
#[derive(Clone, Copy, Debug, Default)]
struct Crossing {
    t: f32,
    primitive: PrimitiveIndex,
    object: u32,
    leaves: bool,
}

fn resolve_ray<S: Simd>(simd: S, frame: &Frame<'_>, at: usize, worker: &mut Worker) {
    let Worker { rays, stack, contacts, .. } = worker;
    let (first, t) = (rays.primitive[at], rays.t[at]);
    let ray = [rays.origin_of(at), rays.direction.get(at)];
    let mut found = [Crossing::default(); MOST];
    let count = collect(simd, frame, ray, (t, first), stack, &mut found);
    let found = &found[..count];
    if count < 2 {
        return;
    }
    let opaque = frame.tables.opaque(&frame.scene.geometry);
    let is_body = |crossing: &Crossing| frame.scene.objects[crossing.object as usize].body;
    let mut met = [NO_PRIMITIVE; MOST + 1];
    let mut thin = 0;
    let passes = |crossing: &&Crossing| !opaque.contains(crossing.primitive);
    for crossing in found.iter().filter(passes).filter(|crossing| !is_body(crossing)) {
        met[thin] = crossing.primitive;
        thin += 1;
    }
    let mut faces = [Face { primitive: NO_PRIMITIVE, leaves: false }; MOST];
    let mut others = 0;
    let mut last = found.iter().find(|crossing| !passes(crossing));
    if last.is_none() {
        let mut bodies = found.iter().filter(passes).filter(|crossing| is_body(crossing));
        last = bodies.next();
        for crossing in bodies {
            faces[others] = Face { primitive: crossing.primitive, leaves: crossing.leaves };
            others += 1;
        }
    }
    let total = thin + usize::from(last.is_some());
    if let Some(last) = last {
        met[thin] = last.primitive;
    }
    let hit = found.iter().find(|crossing| crossing.primitive == met[0]);
    rays.t[at] = hit.map_or(t, |crossing| crossing.t);
    rays.primitive[at] = met[0];
    if total > 1 || others > 0 {
        let extent = found[count - 1].t - found[0].t;
        rays.contact[at] = contacts.push(&met[..total], &faces[..others], extent);
    }
}

/// Collects what lies in the place of a hit, by (t, primitive); returns how much.
///
/// A ray through an edge between two faces of an object crosses both: the second does not count.
fn collect<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    [origin, direction]: [Vec3; 2],
    (t, primitive): (f32, PrimitiveIndex),
    stack: &mut Stack,
    found: &mut [Crossing; MOST],
) -> usize {
    let (origin, direction) = (V3::splat(simd, origin), V3::splat(simd, direction));
    let packet = Packet::new(&frame.scene.geometry, origin, direction);
    let search = Search::new(&frame.scene.geometry, frame.plan.tree);
    let mut one = [NO_PRIMITIVE; MOST_LANES];
    one[0] = primitive;
    let (gap, _) = gap_and_sides(simd, frame, &one[..S::f32s::LEN], origin, direction, S::f32s::splat(simd, t));
    let gap = gap[0];
    let after = f32::from_bits(t.to_bits() - 1);
    let mut window = Window { simd, after, limit: t + gap, hits: [(0.0, 0); MOST], len: 0 };
    loop {
        let before = window.limit;
        window.len = 0;
        search.traverse(simd, &packet, stack, &mut window);
        let last = window.hits[..window.len].last().map_or(t, |hit| hit.0);
        window.limit = last + gap;
        // What touches the last one belongs to the place, too.
        if window.limit <= before || window.len == MOST {
            break;
        }
    }
    let mut count = 0;
    for first in (0..window.len).step_by(S::f32s::LEN) {
        let hits = &window.hits[first..window.len.min(first + S::f32s::LEN)];
        let mut primitives = [NO_PRIMITIVE; MOST_LANES];
        let mut distances = [0.0; MOST_LANES];
        for (lane, &(t, primitive)) in hits.iter().enumerate() {
            (distances[lane], primitives[lane]) = (t, primitive);
        }
        let t = S::f32s::from_slice(simd, &distances[..S::f32s::LEN]);
        let (_, leaving) = gap_and_sides(simd, frame, &primitives[..S::f32s::LEN], origin, direction, t);
        for (lane, &(t, primitive)) in hits.iter().enumerate() {
            let object = frame.scene.geometry.object_of(primitive);
            let crossing = Crossing { t, primitive, object, leaves: leaving >> lane & 1 == 1 };
            let is_known = |other: &Crossing| other.object == object && other.leaves == crossing.leaves;
            if !found[..count].iter().any(is_known) {
                found[count] = crossing;
                count += 1;
            }
        }
    }
    count
}

/// How far along the ray from each hit others are in the same place, and the lanes whose surfaces are seen from behind.
fn gap_and_sides<S: Simd>(
    simd: S,
    frame: &Frame<'_>,
    primitives: &[PrimitiveIndex],
    origin: V3<S::f32s>,
    direction: V3<S::f32s>,
    t: S::f32s,
) -> (S::f32s, u64) {
    let hits = Hits::new(simd, primitives);
    let point = surfaces(simd, frame, &hits, origin, direction, t).point;
    let cosine = point.normal.dot(direction);
    let rounding = (origin.x.abs().max(origin.y.abs()).max(origin.z.abs()) + t) * ROUNDING;
    let gap = (leave::margin::<S>(point.scale) * REACH + rounding) / cosine.abs().max(FLATTEST);
    (gap, cosine.simd_gt(S::f32s::splat(simd, 0.0)).to_bitmask())
}

/// Collects the hits of one ray, which all lanes hold, within an interval; the nearest, by (t, primitive).
struct Window<S> {
    simd: S,
    /// Exclusive.
    after: f32,
    /// Inclusive.
    limit: f32,
    hits: [(f32, PrimitiveIndex); MOST],
    len: usize,
}

impl<S> Window<S> {
    fn add(&mut self, t: f32, primitive: PrimitiveIndex) {
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

impl<S: Simd> Visitor<S> for Window<S> {
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
