//! Rays in lanes, with what the kernels of all primitives take from a direction: computed once a ray, not once a test.

use crate::math::{Lanes, V3};
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

/// Components of a direction below this are taken for this: its inverse stays finite, so that no box test makes a NaN.
const LEAST_COMPONENT: f32 = 1e-30;

/// One ray a lane.
#[derive(Clone, Copy, Debug)]
pub struct Rays<F> {
    /// Origins.
    pub origin: V3<F>,
    /// Unit directions.
    pub direction: V3<F>,
    /// One over each component of the direction, without infinities.
    pub inverse: V3<F>,
    /// Two unit vectors across the direction and across each other.
    pub across: [V3<F>; 2],
}

impl<F> Rays<F> {
    /// Rays along unit directions.
    #[inline(always)]
    pub fn new<S: Simd>(origin: V3<F>, direction: V3<F>) -> Self
    where
        F: Lanes<S>,
    {
        let inverse = V3::new(invert(direction.x), invert(direction.y), invert(direction.z));
        Self { origin, direction, inverse, across: across(direction) }
    }

    /// Rays for kernels that [need only](super::primitive::Kernel::NEEDS_FRAME) origin and direction.
    #[inline(always)]
    pub fn bare<S: Simd>(origin: V3<F>, direction: V3<F>) -> Self
    where
        F: Lanes<S>,
    {
        let none = V3::all(F::splat(origin.x.token(), 0.0));
        Self { origin, direction, inverse: none, across: [none; 2] }
    }

    /// One ray of `rays` in every lane: the same values as if it had been made on its own.
    #[inline(always)]
    pub fn splat<S: Simd, G: Lanes<S>>(simd: S, rays: &Rays<G>, lane: usize) -> Self
    where
        F: Lanes<S>,
    {
        Self {
            origin: V3::splat(simd, rays.origin.lane(lane)),
            direction: V3::splat(simd, rays.direction.lane(lane)),
            inverse: V3::splat(simd, rays.inverse.lane(lane)),
            across: [V3::splat(simd, rays.across[0].lane(lane)), V3::splat(simd, rays.across[1].lane(lane))],
        }
    }

    /// The inverse direction of one ray.
    #[inline(always)]
    pub fn inverse_of<S: Simd>(&self, lane: usize) -> Vec3
    where
        F: Lanes<S>,
    {
        self.inverse.lane(lane)
    }
}

// Functions, not closures: those would not be inlined into the code of their SIMD level.

/// One over a component of a direction, without infinities.
#[inline(always)]
fn invert<S: Simd, F: Lanes<S>>(component: F) -> F {
    let simd = component.token();
    let least = F::splat(simd, LEAST_COMPONENT);
    F::splat(simd, 1.0) / component.abs().simd_lt(least).select(least.copysign(component), component)
}

/// Two unit vectors across a direction and across each other (Duff et al., JCGT 6(1), 2017).
#[inline(always)]
fn across<S: Simd, F: Lanes<S>>(direction: V3<F>) -> [V3<F>; 2] {
    let V3 { x, y, z } = direction;
    let one = F::splat(x.token(), 1.0);
    let sign = one.copysign(z);
    let a = -one / (sign + z);
    let b = x * y * a;
    [V3::new(one + sign * x * x * a, sign * b, -sign * x), V3::new(b, sign + y * y * a, -y)]
}
