//! Rays waiting to be traced, column by column, so that packets load and kernels write whole lanes.

use crate::geometry::NO_PRIMITIVE;
use crate::math::V3;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;
use std::ops::Range;

/// The widest packet: queues keep this much room beyond their length, so that every packet is a full load.
pub const MOST_LANES: usize = 16;

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// Stores the masked lanes, side by side, from `at` on; what follows them is overwritten.
#[inline(always)]
fn put<S: Simd>(column: &mut [f32], at: usize, mask: Mask<S>, values: S::f32s) {
    let packed = if mask.all_true() { values } else { values.compress(mask) };
    packed.store_slice(&mut column[at..at + S::f32s::LEN]);
}

/// [`put`] for numbers.
#[inline(always)]
fn put_numbers<S: Simd>(column: &mut [u32], at: usize, mask: Mask<S>, values: S::u32s) {
    let packed = if mask.all_true() { values } else { values.compress(mask) };
    packed.store_slice(&mut column[at..at + S::f32s::LEN]);
}

/// How many lanes are set.
#[inline(always)]
fn count<S: Simd>(mask: Mask<S>) -> usize {
    mask.to_bitmask().count_ones() as usize
}

/// Three columns of a vector.
#[derive(Clone, Debug, Default)]
pub struct Columns {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
}

impl Columns {
    /// Makes each column `len` long; new places hold 0.
    pub fn resize(&mut self, len: usize) {
        for column in self.columns_mut() {
            column.resize(len, 0.0);
        }
    }

    /// Empties each column; its memory stays.
    pub fn clear(&mut self) {
        for column in self.columns_mut() {
            column.clear();
        }
    }

    /// The three columns.
    pub fn columns(&self) -> [&Vec<f32>; 3] {
        [&self.x, &self.y, &self.z]
    }

    /// The three columns.
    pub fn columns_mut(&mut self) -> [&mut Vec<f32>; 3] {
        [&mut self.x, &mut self.y, &mut self.z]
    }

    fn fill(&mut self, places: Range<usize>, v: Vec3) {
        self.x[places.clone()].fill(v.x);
        self.y[places.clone()].fill(v.y);
        self.z[places].fill(v.z);
    }

    #[inline(always)]
    pub fn set(&mut self, at: usize, v: Vec3) {
        (self.x[at], self.y[at], self.z[at]) = (v.x, v.y, v.z);
    }

    #[inline(always)]
    pub fn get(&self, at: usize) -> Vec3 {
        Vec3::new(self.x[at], self.y[at], self.z[at])
    }

    /// Stores lanes starting at `at`.
    #[inline(always)]
    pub fn store<S: Simd>(&mut self, at: usize, v: V3<S::f32s>) {
        let range = at..at + S::f32s::LEN;
        v.x.store_slice(&mut self.x[range.clone()]);
        v.y.store_slice(&mut self.y[range.clone()]);
        v.z.store_slice(&mut self.z[range]);
    }

    /// Stores the masked lanes, side by side, from `at` on; what follows them is overwritten.
    #[inline(always)]
    fn put<S: Simd>(&mut self, at: usize, mask: Mask<S>, v: V3<S::f32s>) {
        put::<S>(&mut self.x, at, mask, v.x);
        put::<S>(&mut self.y, at, mask, v.y);
        put::<S>(&mut self.z, at, mask, v.z);
    }

    /// The lanes starting at `at`.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, at: usize) -> V3<S::f32s> {
        let range = at..at + S::f32s::LEN;
        V3::load(simd, &self.x[range.clone()], &self.y[range.clone()], &self.z[range])
    }
}

/// Rays of one level of the paths of a tile, and what they hit.
#[derive(Clone, Debug, Default)]
pub struct RayQueue {
    /// Where all rays start, if they are rays from the eye: the origins' columns then hold nothing.
    eye: Option<Vec3>,
    pub origin: Columns,
    pub direction: Columns,
    /// All rays have full weight: the weights' columns then hold nothing.
    unweighted: bool,
    /// What the ray's light is multiplied by on its way to the pixel.
    weight: Columns,
    /// Which sample of the tile it belongs to.
    pub sample: Vec<u32>,
    /// The bodies it starts in.
    pub media: Vec<u32>,
    /// What it meets at once, where surfaces touch; of rays from the eye only once that was looked for, and only if the plan
    /// looks at contacts.
    pub contact: Vec<u32>,
    /// The flat primitive that mirrored it, or [`NO_PRIMITIVE`]; only of rays that follow from others.
    pub source: Vec<u32>,
    /// Distance of the hit; its limit on a miss.
    pub t: Vec<f32>,
    /// The primitive hit, or [`NO_PRIMITIVE`].
    pub primitive: Vec<u32>,
    /// How long the way from the eye to its start is; of rays from the eye the column holds nothing.
    way: Vec<f32>,
    len: usize,
}

/// What rays that follow from others belong to, a lane each.
pub struct Lineage<S: Simd> {
    /// Which sample of the tile.
    pub sample: S::u32s,
    /// The bodies they start in.
    pub media: S::u32s,
    /// What they meet at once, if the plan looks at contacts.
    pub contact: Option<S::u32s>,
    /// The flat primitive that mirrored them, or [`NO_PRIMITIVE`].
    pub source: S::u32s,
    /// How long the way from the eye to their start is.
    pub way: S::f32s,
}

impl RayQueue {
    /// How many rays there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Empties the queue; its memory stays.
    pub fn clear(&mut self) {
        (self.len, self.eye, self.unweighted) = (0, None, false);
    }

    /// Where the rays of the packet at `at` start.
    #[inline(always)]
    pub fn origins<S: Simd>(&self, simd: S, at: usize) -> V3<S::f32s> {
        match self.eye {
            Some(eye) => V3::splat(simd, eye),
            None => self.origin.load(simd, at),
        }
    }

    /// Where one ray starts.
    pub fn origin_of(&self, at: usize) -> Vec3 {
        self.eye.unwrap_or_else(|| self.origin.get(at))
    }

    /// What the light of the rays of the packet at `at` is multiplied by on its way to the pixel.
    #[inline(always)]
    pub fn weights<S: Simd>(&self, simd: S, at: usize) -> V3<S::f32s> {
        if self.unweighted { V3::splat(simd, Vec3::ONE) } else { self.weight.load(simd, at) }
    }

    /// How long the ways from the eye to the starts of the packet at `at` are.
    #[inline(always)]
    pub fn ways<S: Simd>(&self, simd: S, at: usize) -> S::f32s {
        match self.eye {
            Some(_) => S::f32s::splat(simd, 0.0),
            None => S::f32s::from_slice(simd, &self.way[at..at + S::f32s::LEN]),
        }
    }

    /// The columns of the weights, all of them filled.
    pub fn weights_mut(&mut self) -> &mut Columns {
        if self.unweighted {
            self.weight.fill(0..self.len + MOST_LANES, Vec3::ONE);
            self.unweighted = false;
        }
        &mut self.weight
    }

    /// Makes room for `rays` in all.
    pub fn reserve(&mut self, rays: usize) {
        // Exactly that much: columns whose size is a power of two would share the same sets of the cache.
        let room = rays + MOST_LANES;
        if self.t.len() < room {
            for columns in [&mut self.origin, &mut self.direction, &mut self.weight] {
                columns.resize(room);
            }
            self.sample.resize(room, 0);
            self.media.resize(room, 0);
            self.contact.resize(room, 0);
            self.source.resize(room, NO_PRIMITIVE);
            self.t.resize(room, 0.0);
            self.way.resize(room, 0.0);
            self.primitive.resize(room, NO_PRIMITIVE);
        }
    }

    /// Appends the masked lanes, in order; there must be room for all lanes.
    #[inline(always)]
    pub fn push_lanes<S: Simd>(
        &mut self,
        mask: Mask<S>,
        origin: V3<S::f32s>,
        direction: V3<S::f32s>,
        weight: V3<S::f32s>,
        lineage: &Lineage<S>,
    ) {
        let at = self.len;
        self.origin.put::<S>(at, mask, origin);
        self.direction.put::<S>(at, mask, direction);
        self.weight.put::<S>(at, mask, weight);
        put_numbers::<S>(&mut self.sample, at, mask, lineage.sample);
        put_numbers::<S>(&mut self.media, at, mask, lineage.media);
        if let Some(contact) = lineage.contact {
            put_numbers::<S>(&mut self.contact, at, mask, contact);
        }
        put_numbers::<S>(&mut self.source, at, mask, lineage.source);
        put::<S>(&mut self.way, at, mask, lineage.way);
        self.len += count::<S>(mask);
    }

    /// Appends `count` rays of full weight from the eye, to be aimed, to a queue of such; returns the first one's place.
    pub fn extend_from_eye(&mut self, eye: Vec3, media: u32, count: usize) -> usize {
        let first = self.len;
        self.reserve(first + count);
        (self.len, self.eye, self.unweighted) = (first + count, Some(eye), true);
        self.media[first..first + count].fill(media);
        first
    }

    /// Repeats the last ray beyond the end, so that a packet that is not full stays as coherent as its rays.
    pub fn pad(&mut self) {
        if self.len == 0 {
            return;
        }
        let last = self.len - 1;
        let (origin, direction) = (self.origin.get(last), self.direction.get(last));
        for at in self.len..self.len + MOST_LANES {
            self.origin.set(at, origin);
            self.direction.set(at, direction);
        }
        self.clear_padding();
    }

    /// Marks the rays beyond the end as hitting nothing: they are nobody's.
    pub fn clear_padding(&mut self) {
        let beyond = self.len..self.len + MOST_LANES;
        self.primitive[beyond.clone()].fill(NO_PRIMITIVE);
        self.t[beyond].fill(0.0);
    }

    /// Marks the rays from `first` on, and what is beyond the end, as meeting nothing at once.
    pub fn clear_contacts(&mut self, first: usize) {
        self.contact[first..self.len + MOST_LANES].fill(0);
    }
}

/// Rays that are shaded, and whose shadow rays are resolved, before the next ones are.
pub const RUN: usize = 256;

/// Shadow rays towards one light.
#[derive(Clone, Debug, Default)]
pub struct ShadowQueue {
    pub origin: Columns,
    /// Unit direction to the light.
    pub direction: Columns,
    /// What the pixel gains if nothing is in the way.
    pub gain: Columns,
    /// Distance of the light.
    pub distance: Vec<f32>,
    pub sample: Vec<u32>,
    /// The primitive that the ray leaves, where it cannot come back to it; else [`NO_PRIMITIVE`].
    pub source: Vec<u32>,
    /// How many shadow rays there were when each [`RUN`] of shaded rays began, and at the end: the rays
    /// `runs[k]..runs[k + 1]` start where the rays of run k hit, close together.
    pub runs: Vec<u32>,
    len: usize,
}

/// One shadow ray a lane, as [`ShadowQueue`] keeps them.
pub struct ShadowPacket<S: Simd> {
    pub origin: V3<S::f32s>,
    pub direction: V3<S::f32s>,
    pub gain: V3<S::f32s>,
    pub distance: S::f32s,
    pub sample: S::u32s,
    pub source: S::u32s,
}

impl ShadowQueue {
    /// How many rays there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Empties the queue; its memory stays.
    pub fn clear(&mut self) {
        self.len = 0;
        self.runs.clear();
    }

    /// Begins the next run, or ends the last.
    pub fn mark_run(&mut self) {
        self.runs.push(self.len as u32);
    }

    /// Makes room for `rays` more, and lanes beyond.
    pub fn reserve(&mut self, rays: usize) {
        let room = self.len + rays + MOST_LANES;
        if self.distance.len() < room {
            for columns in [&mut self.origin, &mut self.direction, &mut self.gain] {
                columns.resize(room);
            }
            self.distance.resize(room, 0.0);
            self.sample.resize(room, 0);
            self.source.resize(room, NO_PRIMITIVE);
        }
    }

    /// Appends the masked lanes, in order; there must be room for all lanes.
    #[inline(always)]
    pub fn push_lanes<S: Simd>(&mut self, mask: Mask<S>, rays: &ShadowPacket<S>) {
        let at = self.len;
        self.origin.put::<S>(at, mask, rays.origin);
        self.direction.put::<S>(at, mask, rays.direction);
        self.gain.put::<S>(at, mask, rays.gain);
        put::<S>(&mut self.distance, at, mask, rays.distance);
        put_numbers::<S>(&mut self.sample, at, mask, rays.sample);
        put_numbers::<S>(&mut self.source, at, mask, rays.source);
        self.len += count::<S>(mask);
    }

    /// Repeats the last ray beyond the end, with no distance to go.
    pub fn pad(&mut self) {
        if self.len == 0 {
            return;
        }
        let last = self.len - 1;
        let (origin, direction) = (self.origin.get(last), self.direction.get(last));
        for at in self.len..self.len + MOST_LANES {
            self.origin.set(at, origin);
            self.direction.set(at, direction);
            self.distance[at] = 0.0;
        }
    }
}
