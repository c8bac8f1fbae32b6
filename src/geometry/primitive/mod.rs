//! Primitive types: one file each, one line each in [`for_each_primitive!`].
//!
//! A primitive is a fixed number of f32 fields and a [`Kernel`] over them. Kernels are generic over lanes:
//! the same text tests many rays against one primitive (fields splat) or one ray against eight (fields loaded),
//! and gives the same bits either way.

pub mod cone;
pub mod cutout;
pub mod disk;
pub mod plane;
pub mod sphere;
pub mod triangle;

pub use cone::Cone;
pub use cutout::Cutout;
pub use disk::Disk;
pub use plane::Plane;
pub use sphere::Sphere;
pub use triangle::Triangle;

use super::{Aabb, Rays};
use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use glam::DVec3;

/// Calls `$callback!` with every primitive type: its kernel, its field count, the name of its blocks in
/// [`Geometry`](super::Geometry), and how many numbers its [`Outline`](super::beam::Outline) has. To add a primitive,
/// add its file above, its outline, and its line here.
macro_rules! for_each_primitive {
    ($callback:ident) => {
        $callback! {
            Sphere 4 spheres 6,
            Triangle 10 triangles 19,
            Disk 7 disks 11,
            Cone 9 cones 9,
            Cutout 10 cutouts 19,
            Plane 4 planes 9,
        }
    };
}
pub(crate) use for_each_primitive;

/// Hits lie within the bounds of what was hit, widened by this share of the largest coordinate of primitive and ray's
/// origin. Boxes that are searched are widened by more, so that no box hides a hit.
pub(super) const HIT_PADDING: f32 = 2e-6;

/// A point of a surface, in lanes.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<F> {
    /// The hit point, moved onto the surface.
    pub position: V3<F>,
    /// Unit geometric normal: outward for closed shapes, as defined for flat ones.
    pub normal: V3<F>,
    /// Largest coordinate magnitude that went into `position`: its rounding error is a few ulps of this.
    pub scale: F,
}

/// What the tracer needs of a primitive type with `N` fields.
pub trait Kernel<const N: usize> {
    /// Whether [`intersect`](Self::intersect) uses more of the rays than origin and direction.
    const NEEDS_FRAME: bool = false;
    /// Whether hits have to be held against [holes](super::holes).
    const HAS_HOLES: bool = false;
    /// Whether there are primitives of this type that are seen from one side only.
    const HAS_SIDES: bool = false;

    /// The least box around the primitive; infinite for planes.
    fn bounds(fields: &[f32; N]) -> Aabb;

    /// The point of the primitive that is nearest to `point`; any of them where several are.
    fn nearest_to(fields: &[f32; N], point: DVec3) -> DVec3;

    /// Distance to the first hit beyond `t_min` (exclusive), where the mask is set.
    /// Elsewhere the distance is meaningless. Distances may come out infinite: callers compare with a finite limit.
    fn intersect<S: Simd, F: Lanes<S>>(fields: &[F; N], rays: &Rays<F>, t_min: F) -> (F::Mask, F);

    /// [`intersect`](Self::intersect), but without hits on the backs of what is seen from one side only.
    #[inline(always)]
    fn intersect_front<S: Simd, F: Lanes<S>>(fields: &[F; N], rays: &Rays<F>, t_min: F) -> (F::Mask, F) {
        Self::intersect(fields, rays, t_min)
    }

    /// The surface at distance `t`, for a ray that [`intersect`](Self::intersect) found to hit there.
    fn surface<S: Simd, F: Lanes<S>>(fields: &[F; N], origin: V3<F>, direction: V3<F>, t: F) -> SurfacePoint<F>;
}

/// The vector in three fields from `first` on.
pub(super) fn vector(fields: &[f32], first: usize) -> DVec3 {
    DVec3::new(f64::from(fields[first]), f64::from(fields[first + 1]), f64::from(fields[first + 2]))
}

/// The larger magnitude of each pair of components, folded to one number.
#[inline(always)]
pub(super) fn largest<S: Simd, F: Lanes<S>>(v: V3<F>) -> F {
    v.x.abs().max(v.y.abs()).max(v.z.abs())
}
