//! Where on its textures a surface is hit, and how large a part of them a ray stands for.
//!
//! A ray is a thin cone (Amanatides, SIGGRAPH 1984; Akenine-Möller et al., "Texture level of detail strategies for
//! real-time ray tracing", Ray Tracing Gems, 2019): its width grows with the way from the eye alone, and curved mirrors
//! do not widen it. So a lookup depends on nothing but the ray.

use super::frame::Frame;
use super::gather::{Hits, Surfaces};
use super::tables::Maps;
use crate::math::V3;
use crate::scene::Object;
use crate::scene::material::Lookup;
use crate::scene::object::{Mapping, Reading};
use crate::scene::texels::Texel;
use crate::scene::texture::{Coordinates, Texture};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::{Affine2, Vec2};

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// How rays see what they hit.
#[derive(Clone, Copy)]
pub(super) struct Sight<S: Simd> {
    /// Unit directions of the rays.
    pub direction: V3<S::f32s>,
    /// Square of how wide a ray is on the surface; `None` where textures are looked up in full size.
    pub width2: Option<S::f32s>,
}

impl<S: Simd> Sight<S> {
    /// Rays that came a long `way` from the eye.
    #[inline(always)]
    pub fn new(frame: &Frame<'_>, surfaces: &Surfaces<S>, direction: V3<S::f32s>, way: S::f32s) -> Self {
        if !frame.plan.gradients {
            return Self::sharp(direction);
        }
        // On a slant, a ray is wider one way than the other: neither is right for both, the mean is wrong by least.
        let cosine = direction.dot(surfaces.point.normal).abs().max(FLATTEST);
        let width = way * frame.pixel_spread;
        Self { direction, width2: Some(width * width / cosine) }
    }

    /// Rays that look textures up in full size.
    #[inline(always)]
    pub fn sharp(direction: V3<S::f32s>) -> Self {
        Self { direction, width2: None }
    }
}

/// Flatter rays (cosine) are taken for so flat.
const FLATTEST: f32 = 1e-3;

/// Where surfaces lie on their textures.
#[derive(Clone, Copy)]
pub(super) struct Place<S: Simd> {
    /// Texture coordinates.
    pub uv: [S::f32s; 2],
    /// How they grow along the surface, per unit of length in the world; 0 unless the plan asks.
    pub gradients: [V3<S::f32s>; 2],
}

/// Where an object lies on the textures of its material.
pub(super) struct Places<S: Simd> {
    /// By the first and second coordinates that corners carry; else those of images and those of checkers.
    places: [Place<S>; 2],
    /// Corners carry them.
    carried: bool,
}

impl<S: Simd> Places<S> {
    /// Where object `number` was hit, as far as `maps` asks. `sides` are the lanes that hit its first primitive.
    #[inline(always)]
    pub fn of(
        simd: S,
        frame: &Frame<'_>,
        hits: &Hits<'_>,
        surfaces: &Surfaces<S>,
        number: u32,
        sides: Mask<S>,
        maps: &Maps,
    ) -> Self {
        let object = &frame.scene.objects[number as usize];
        if object.mapping == Mapping::Vertex {
            let mut places = [Place::of_corners(simd, frame, hits, surfaces, 0); 2];
            if maps.uses_second_set {
                places[1] = Place::of_corners(simd, frame, hits, surfaces, 1);
            }
            return Self { places, carried: true };
        }
        let first = if maps.uses_images { Reading::Image } else { Reading::Checker };
        let mut places = [Place::of_shape(simd, frame, surfaces, object, sides, first); 2];
        if maps.uses_images && maps.uses_checkers {
            places[1] = Place::of_shape(simd, frame, surfaces, object, sides, Reading::Checker);
        }
        Self { places, carried: false }
    }

    /// The index of the place where a texture is looked up.
    #[inline(always)]
    fn index(&self, frame: &Frame<'_>, lookup: &Lookup) -> usize {
        match self.carried {
            true => usize::from(lookup.set != 0),
            false => usize::from(matches!(frame.scene.textures[lookup.texture as usize], Texture::Checker { .. })),
        }
    }

    /// The place where a texture is looked up.
    #[inline(always)]
    pub fn get(&self, frame: &Frame<'_>, lookup: &Lookup) -> &Place<S> {
        &self.places[self.index(frame, lookup)]
    }

    /// The same, to be moved.
    #[inline(always)]
    pub fn get_mut(&mut self, frame: &Frame<'_>, lookup: &Lookup) -> &mut Place<S> {
        let index = self.index(frame, lookup);
        &mut self.places[index]
    }
}

impl<S: Simd> Place<S> {
    /// By the shape of an object.
    #[inline(always)]
    fn of_shape(
        simd: S,
        frame: &Frame<'_>,
        surfaces: &Surfaces<S>,
        object: &Object,
        sides: Mask<S>,
        reading: Reading,
    ) -> Self {
        let point = &surfaces.point;
        let uv = object.texture_coordinates(simd, point.position, point.normal, sides, reading);
        let mut gradients = [V3::zero(simd); 2];
        if frame.plan.gradients {
            gradients = object.texture_gradients(simd, point.position, point.normal, sides, reading);
        }
        Self { uv, gradients }
    }

    /// By the coordinates that the corners of triangles carry; 0 where they carry none.
    #[inline(always)]
    fn of_corners(simd: S, frame: &Frame<'_>, hits: &Hits<'_>, surfaces: &Surfaces<S>, set: u8) -> Self {
        let (tables, geometry) = (&frame.tables, &frame.scene.geometry);
        let corners = hits.gather::<S, 6>(
            simd,
            #[inline(always)]
            |primitive| {
                let coordinates = match set {
                    0 => tables
                        .attributes(
                            geometry,
                            primitive,
                            #[inline(always)]
                            |attributes| attributes.uvs,
                        )
                        .flatten(),
                    _ => tables.extras(
                        geometry,
                        primitive,
                        #[inline(always)]
                        |extras| extras.uvs1,
                    ),
                };
                let [a, b, c] = coordinates.unwrap_or([Vec2::ZERO; 3]);
                [a.x, a.y, b.x, b.y, c.x, c.y]
            },
        );
        let uv = [
            surfaces.blend([corners[0], corners[2], corners[4]]),
            surfaces.blend([corners[1], corners[3], corners[5]]),
        ];
        let mut gradients = [V3::zero(simd); 2];
        if frame.plan.gradients {
            // What is linear on a triangle grows along the altitudes of its corners.
            let [to_b, to_c] = edges(simd, frame, hits);
            let normal = to_b.cross(to_c);
            let inverse = S::f32s::splat(simd, 1.0) / normal.dot(normal);
            let (of_b, of_c) = (to_c.cross(normal).scale(inverse), normal.cross(to_b).scale(inverse));
            gradients = [
                of_b.scale(corners[2] - corners[0]) + of_c.scale(corners[4] - corners[0]),
                of_b.scale(corners[3] - corners[1]) + of_c.scale(corners[5] - corners[1]),
            ];
        }
        Self { uv, gradients }
    }

    /// After a transform of the coordinates.
    #[inline(always)]
    fn transformed(&self, transform: &Affine2) -> Self {
        if *transform == Affine2::IDENTITY {
            return *self;
        }
        let ([u, v], [gu, gv]) = (self.uv, self.gradients);
        let (x, y, move_by) = (transform.matrix2.x_axis, transform.matrix2.y_axis, transform.translation);
        Self {
            uv: [u * x.x + v * y.x + move_by.x, u * x.y + v * y.y + move_by.y],
            gradients: [along::<S>(gu, gv, x.x, y.x), along::<S>(gu, gv, x.y, y.y)],
        }
    }

    /// What a texture holds here (opacities only if `OPACITY`), for the lanes in the bit set `members`.
    #[inline(always)]
    pub fn look<const OPACITY: bool>(
        &self,
        simd: S,
        frame: &Frame<'_>,
        lookup: &Lookup,
        sight: &Sight<S>,
        members: u64,
    ) -> Texel<S> {
        let Self { uv, gradients: [gu, gv] } = self.transformed(&lookup.transform);
        let spread2 = sight.width2.map(
            #[inline(always)]
            |width2| [gu.dot(gu) * width2, gv.dot(gv) * width2],
        );
        frame.scene.textures[lookup.texture as usize].sample::<S, OPACITY>(simd, &Coordinates { uv, spread2 }, members)
    }

    /// How the coordinates of a lookup grow along the surface.
    #[inline(always)]
    pub fn gradients_of(&self, lookup: &Lookup) -> [V3<S::f32s>; 2] {
        self.transformed(&lookup.transform).gradients
    }
}

/// From the first corner of each lane's triangle, in the kernel's order, to the second and third; 0 for other shapes.
#[inline(always)]
fn edges<S: Simd>(simd: S, frame: &Frame<'_>, hits: &Hits<'_>) -> [V3<S::f32s>; 2] {
    let geometry = &frame.scene.geometry;
    let [ax, ay, az, bx, by, bz, cx, cy, cz] = hits.gather::<S, 9>(
        simd,
        #[inline(always)]
        |primitive| geometry.corners_of(primitive),
    );
    let corner = V3::new(ax, ay, az);
    [V3::new(bx, by, bz) - corner, V3::new(cx, cy, cz) - corner]
}

/// a x + b y.
#[inline(always)]
fn along<S: Simd>(a: V3<S::f32s>, b: V3<S::f32s>, x: f32, y: f32) -> V3<S::f32s> {
    V3::new(a.x * x + b.x * y, a.y * x + b.y * y, a.z * x + b.z * y)
}
