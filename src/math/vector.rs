//! Vectors whose components are lanes: one vector per lane.

use super::Lanes;
use fearless_simd::Simd;
use glam::Vec3;
use std::ops::{Add, Mul, Neg, Sub};

/// Three components, each a vector of lanes (or a plain number).
#[derive(Clone, Copy, Debug, Default)]
pub struct V3<F> {
    /// First component.
    pub x: F,
    /// Second component.
    pub y: F,
    /// Third component.
    pub z: F,
}

impl<F> V3<F> {
    /// From components.
    #[inline(always)]
    pub fn new(x: F, y: F, z: F) -> Self {
        Self { x, y, z }
    }
}

impl<F: Copy> V3<F> {
    /// The same value in every component.
    #[inline(always)]
    pub fn all(value: F) -> Self {
        Self { x: value, y: value, z: value }
    }
}

impl<F: Copy + Add<Output = F> + Sub<Output = F> + Mul<Output = F>> V3<F> {
    /// x·x' + y·y' + z·z', summed in that order.
    #[inline(always)]
    pub fn dot(self, other: Self) -> F {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Cross product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// Every component times `factor`.
    #[inline(always)]
    pub fn scale(self, factor: F) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<F> V3<F> {
    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat<S: Simd>(simd: S, v: Vec3) -> Self
    where
        F: Lanes<S>,
    {
        Self { x: F::splat(simd, v.x), y: F::splat(simd, v.y), z: F::splat(simd, v.z) }
    }

    /// Loads one lane vector per component.
    #[inline(always)]
    pub fn load<S: Simd>(simd: S, x: &[f32], y: &[f32], z: &[f32]) -> Self
    where
        F: Lanes<S>,
    {
        Self { x: F::from_slice(simd, x), y: F::from_slice(simd, y), z: F::from_slice(simd, z) }
    }

    /// Zero in every lane.
    #[inline(always)]
    pub fn zero<S: Simd>(simd: S) -> Self
    where
        F: Lanes<S>,
    {
        Self::all(F::splat(simd, 0.0))
    }

    /// The vector of one lane.
    #[inline(always)]
    pub fn lane<S: Simd>(&self, lane: usize) -> Vec3
    where
        F: Lanes<S>,
    {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    /// Per lane, `a` where the mask is set, else `b`.
    #[inline(always)]
    pub fn select<S: Simd>(mask: F::Mask, a: Self, b: Self) -> Self
    where
        F: Lanes<S>,
    {
        use fearless_simd::Select;
        Self { x: mask.select(a.x, b.x), y: mask.select(a.y, b.y), z: mask.select(a.z, b.z) }
    }

    /// Divided by its length: one sqrt, one division. Its length is then 1 within 2 units in the last place.
    #[inline(always)]
    pub fn normalize<S: Simd>(self) -> Self
    where
        F: Lanes<S>,
    {
        let inverse = F::splat(self.x.token(), 1.0) / self.dot(self).sqrt();
        self.scale(inverse)
    }

    /// [`normalize`](Self::normalize), but `other` where the squared length is 0 or too small to be accurate.
    #[inline(always)]
    pub fn normalize_or<S: Simd>(self, other: Self) -> Self
    where
        F: Lanes<S>,
    {
        let squared = self.dot(self);
        let usable = squared.simd_ge(F::splat(squared.token(), f32::MIN_POSITIVE));
        Self::select(usable, self.normalize(), other)
    }
}

impl<F: Add<Output = F>> Add for V3<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}

impl<F: Sub<Output = F>> Sub for V3<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}

/// Component by component, as colours multiply.
impl<F: Mul<Output = F>> Mul for V3<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self { x: self.x * o.x, y: self.y * o.y, z: self.z * o.z }
    }
}

impl<F: Neg<Output = F>> Neg for V3<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}
