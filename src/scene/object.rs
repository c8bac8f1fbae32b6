//! Leaf objects: what ties shapes to a material, a name and texture coordinates.

use crate::geometry::Aabb;
use crate::math::V3;
use crate::math::arctangent::atan2;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::{Affine3A, Mat3A, Vec3};
use std::f32::consts::{PI, TAU};

/// Lane mask of native width.
type Mask<S> = <<S as Simd>::f32s as SimdBase<S>>::Mask;

/// Which coordinates a texture is looked up by. Checkers have a defined phase; images must not be mirrored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// Those that checkers are defined in.
    Checker,
    /// Seen from the side that the normal points to, u grows to the right and v upwards.
    Image,
}

/// How a point of an object gets its texture coordinates. All of it in the object's own space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mapping {
    /// u and v along two axes: planes, rectangles, disks, flat triangles without coordinates.
    Planar {
        /// Axes of checkers.
        checker: [Vec3; 2],
        /// Axes of images.
        image: [Vec3; 2],
    },
    /// Each face maps like an axis-aligned plane by its dominant normal axis: boxes.
    BoxFaces,
    /// Longitude / 2π, which grows to the left for checkers and to the right for images; latitude / π from the south pole.
    Sphere {
        /// Centre.
        center: Vec3,
    },
    /// Side: angle / 2π, height from the base; for images the angle grows to the right with the axis up. Caps: planar.
    Axial {
        /// Centre of the base.
        base: Vec3,
        /// Unit axis from base to top.
        axis: Vec3,
    },
    /// Interpolated from the triangles' own coordinates.
    Vertex,
}

/// A leaf object of the scene, as a hit's object index names it.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name, where the file gives one.
    pub name: Option<String>,
    /// The type as the file spells it, such as `sphere`.
    pub kind: &'static str,
    /// Index into the scene's materials.
    pub material: u32,
    /// Whether it bounds a body, in which light bends; otherwise it is thin.
    pub body: bool,
    /// How texture coordinates are found.
    pub mapping: Mapping,
    /// From the world to the object's own space; `None` where they are the same.
    pub world_to_object: Option<Affine3A>,
    /// Bounds in the world; infinite for planes.
    pub bounds: Aabb,
}

impl Object {
    /// Texture coordinates of points in the world with their geometric normals. `sides` are the lanes that lie on the
    /// object's first primitive: the side of a cylinder or cone. 0 where triangles carry their own.
    #[inline(always)]
    pub fn texture_coordinates<S: Simd>(
        &self,
        simd: S,
        position: V3<S::f32s>,
        normal: V3<S::f32s>,
        sides: Mask<S>,
        reading: Reading,
    ) -> [S::f32s; 2] {
        let p = self.to_object(simd, position);
        match self.mapping {
            Mapping::Planar { checker, image } => {
                planar(simd, p, if reading == Reading::Image { image } else { checker })
            }
            Mapping::BoxFaces => {
                let own = self.to_object_normals(simd, normal);
                let [along_x, along_z] = faces(simd, own);
                if reading == Reading::Image {
                    let [behind_x, behind_y, behind_z] = [own.x, own.y, own.z].map(|n| n.simd_lt(0.0));
                    let on_x = behind_x.select(p.z, -p.z);
                    let on_z = behind_z.select(-p.x, p.x);
                    let on_y = behind_y.select(p.z, -p.z);
                    [along_x.select(on_x, along_z.select(on_z, p.x)), (along_x | along_z).select(p.y, on_y)]
                } else {
                    [along_x.select(p.y, p.x), along_z.select(p.y, p.z)]
                }
            }
            Mapping::Sphere { center } => {
                let d = p - V3::splat(simd, center);
                let across = (d.x * d.x + d.z * d.z).sqrt();
                let east = atan2::<S, S::f32s>(d.z, d.x) / TAU;
                let u = if reading == Reading::Image { -east } else { east } + 0.5;
                [u, atan2::<S, S::f32s>(d.y, across) / PI + 0.5]
            }
            Mapping::Axial { base, axis } => {
                let axes = plane_axes(axis);
                let from_base = p - V3::splat(simd, base);
                let [a, b] = planar(simd, from_base, axes);
                let mut turned = atan2::<S, S::f32s>(b, a) / TAU;
                let mut caps = planar(simd, p, axes);
                if reading == Reading::Image {
                    if is_left_handed(axes, axis) {
                        turned = -turned;
                    }
                    let [top, base] = [axis, -axis].map(|n| planar(simd, p, image_axes(n)));
                    let tops = normal_along(simd, self.to_object_normals(simd, normal), axis);
                    caps = [tops.select(top[0], base[0]), tops.select(top[1], base[1])];
                }
                let around = [turned + 0.5, from_base.dot(V3::splat(simd, axis))];
                [sides.select(around[0], caps[0]), sides.select(around[1], caps[1])]
            }
            Mapping::Vertex => [S::f32s::splat(simd, 0.0); 2],
        }
    }

    /// How [`texture_coordinates`](Self::texture_coordinates) grow from point to point, per unit of length in the world.
    #[inline(always)]
    pub fn texture_gradients<S: Simd>(
        &self,
        simd: S,
        position: V3<S::f32s>,
        normal: V3<S::f32s>,
        sides: Mask<S>,
        reading: Reading,
    ) -> [V3<S::f32s>; 2] {
        let p = self.to_object(simd, position);
        let zero = S::f32s::splat(simd, 0.0);
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| V3::splat(simd, axis));
        let own = match self.mapping {
            Mapping::Planar { checker, image } => {
                let [u, v] = if reading == Reading::Image { image } else { checker };
                [V3::splat(simd, u), V3::splat(simd, v)]
            }
            Mapping::BoxFaces => {
                let own = self.to_object_normals(simd, normal);
                let [along_x, along_z] = faces(simd, own);
                if reading == Reading::Image {
                    let [behind_x, behind_y, behind_z] = [own.x, own.y, own.z].map(|n| n.simd_lt(zero));
                    let on_x = V3::select(behind_x, z, -z);
                    let on_z = V3::select(behind_z, -x, x);
                    let on_y = V3::select(behind_y, z, -z);
                    let across = V3::select(along_x, on_x, V3::select(along_z, on_z, x));
                    [across, V3::select(along_x | along_z, y, on_y)]
                } else {
                    [V3::select(along_x, y, x), V3::select(along_z, y, z)]
                }
            }
            Mapping::Sphere { center } => {
                let d = p - V3::splat(simd, center);
                let across2 = (d.x * d.x + d.z * d.z).max(f32::MIN_POSITIVE);
                let across = across2.sqrt();
                let east = V3::new(-d.z, zero, d.x).scale(S::f32s::splat(simd, 1.0 / TAU) / across2);
                let around = if reading == Reading::Image { -east } else { east };
                let level = V3::new(d.x, zero, d.z).scale(d.y / across);
                let up = (V3::new(zero, across, zero) - level).scale(S::f32s::splat(simd, 1.0 / PI) / d.dot(d));
                [around, up]
            }
            Mapping::Axial { base, axis } => {
                let axes = plane_axes(axis);
                let [a, b] = planar(simd, p - V3::splat(simd, base), axes);
                let [along_a, along_b] = axes.map(|axis| V3::splat(simd, axis));
                let inverse = S::f32s::splat(simd, 1.0 / TAU) / (a * a + b * b).max(f32::MIN_POSITIVE);
                let mut around = (along_b.scale(a) - along_a.scale(b)).scale(inverse);
                let mut caps = [along_a, along_b];
                if reading == Reading::Image {
                    if is_left_handed(axes, axis) {
                        around = -around;
                    }
                    let [top, base] = [axis, -axis].map(|n| image_axes(n).map(|axis| V3::splat(simd, axis)));
                    let tops = normal_along(simd, self.to_object_normals(simd, normal), axis);
                    caps = [V3::select(tops, top[0], base[0]), V3::select(tops, top[1], base[1])];
                }
                [V3::select(sides, around, caps[0]), V3::select(sides, V3::splat(simd, axis), caps[1])]
            }
            Mapping::Vertex => [V3::all(zero); 2],
        };
        match &self.world_to_object {
            None => own,
            Some(m) => {
                let transposed = m.matrix3.transpose();
                let [u, v] = own;
                [linear(simd, &transposed, u), linear(simd, &transposed, v)]
            }
        }
    }

    /// Points of the world in the object's own space.
    #[inline(always)]
    fn to_object<S: Simd>(&self, simd: S, position: V3<S::f32s>) -> V3<S::f32s> {
        match &self.world_to_object {
            None => position,
            Some(m) => linear(simd, &m.matrix3, position) + V3::splat(simd, m.translation.into()),
        }
    }

    /// Normals of the world in the object's own space; their lengths may change.
    #[inline(always)]
    fn to_object_normals<S: Simd>(&self, simd: S, normal: V3<S::f32s>) -> V3<S::f32s> {
        match &self.world_to_object {
            None => normal,
            Some(m) => linear(simd, &m.matrix3.inverse().transpose(), normal),
        }
    }
}

/// The lanes whose normals in the object's own space face along x, and those that face along z; the others face along y.
#[inline(always)]
fn faces<S: Simd>(_: S, normal: V3<S::f32s>) -> [Mask<S>; 2] {
    let (x, y, z) = (normal.x.abs(), normal.y.abs(), normal.z.abs());
    let along_z = z.simd_gt(x.max(y));
    [!along_z & !y.simd_gt(x), along_z]
}

/// The lanes whose normals lie on the side that `axis` points to.
#[inline(always)]
fn normal_along<S: Simd>(simd: S, normal: V3<S::f32s>, axis: Vec3) -> Mask<S> {
    normal.dot(V3::splat(simd, axis)).simd_gt(0.0)
}

/// Whether the angle from the first of two axes across `axis` to the second falls to the right, with `axis` up.
fn is_left_handed([a, b]: [Vec3; 2], axis: Vec3) -> bool {
    a.cross(b).dot(axis) < 0.0
}

/// The same linear map of every lane.
#[inline(always)]
fn linear<S: Simd>(simd: S, m: &Mat3A, v: V3<S::f32s>) -> V3<S::f32s> {
    let (x, y, z): (Vec3, Vec3, Vec3) = (m.x_axis.into(), m.y_axis.into(), m.z_axis.into());
    V3::splat(simd, x).scale(v.x) + V3::splat(simd, y).scale(v.y) + V3::splat(simd, z).scale(v.z)
}

/// Coordinates along two axes.
#[inline(always)]
fn planar<S: Simd>(simd: S, p: V3<S::f32s>, [u, v]: [Vec3; 2]) -> [S::f32s; 2] {
    [p.dot(V3::splat(simd, u)), p.dot(V3::splat(simd, v))]
}

/// The axes along which a plane of unit normal `n` is textured: on an axis-aligned one the two other coordinates in
/// x, y, z order, on a tilted one a = norm(Y x n) and n x a.
pub fn plane_axes(n: Vec3) -> [Vec3; 2] {
    if n.abs().max_element() == 1.0 {
        return other_axes(n);
    }
    let a = Vec3::Y.cross(n).normalize();
    [a, n.cross(a)]
}

/// The axes along which an image lies on a plane of unit normal `n`, seen from the side that it points to: to the right
/// and up. On what lies flat, x is to the right.
pub fn image_axes(n: Vec3) -> [Vec3; 2] {
    if n.x == 0.0 && n.z == 0.0 {
        return [Vec3::X, if n.y > 0.0 { Vec3::NEG_Z } else { Vec3::Z }];
    }
    let right = Vec3::Y.cross(n).normalize();
    [right, n.cross(right)]
}

/// The two coordinate axes other than the one that `n` lies nearest to, in x, y, z order.
fn other_axes(n: Vec3) -> [Vec3; 2] {
    match n.abs().max_position() {
        0 => [Vec3::Y, Vec3::Z],
        1 => [Vec3::X, Vec3::Z],
        _ => [Vec3::X, Vec3::Y],
    }
}
