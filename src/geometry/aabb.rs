//! Axis-aligned boxes.

use glam::Vec3;

/// An axis-aligned box; empty when any `min` exceeds its `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

/// The empty box.
impl Default for Aabb {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// The box that holds nothing: the identity of [`union`](Self::union).
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
    /// The box that holds all of space.
    pub const INFINITE: Self = Self { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };

    /// The least box that holds all of `points`.
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The least box around a disk with a unit normal.
    ///
    /// Along each axis it reaches as far as the sine of the angle between axis and normal. That comes from the two
    /// other components: 1 - cosine² of a disk that is all but aligned with the axis is lost to rounding.
    pub fn of_disk(center: Vec3, normal: Vec3, radius: f32) -> Self {
        let squared = normal * normal;
        let sines = Vec3::new(squared.y + squared.z, squared.x + squared.z, squared.x + squared.y).map(f32::sqrt);
        Self { min: center - sines * radius, max: center + sines * radius }
    }

    /// The least box that holds both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether any point lies in both.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && self.max.cmpge(other.min).all()
    }

    /// Whether a point lies in it.
    pub fn holds(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && self.max.cmpge(point).all()
    }

    /// The box with its faces moved outward by `distance`.
    pub fn padded(self, distance: f32) -> Self {
        Self { min: self.min - distance, max: self.max + distance }
    }

    /// Whether it holds nothing.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Whether every corner is a finite number.
    pub fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// The middle.
    pub fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Edge lengths.
    pub fn size(&self) -> Vec3 {
        self.max - self.min
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_that_is_all_but_aligned_is_not_flat() {
        let normal = Vec3::new(3e-4, 1.0, 0.0).normalize();
        let half = Aabb::of_disk(Vec3::ZERO, normal, 2.0).max;
        assert!(half.abs_diff_eq(Vec3::new(2.0, 6e-4, 2.0), 1e-7), "{half}");
        assert_eq!(Aabb::of_disk(Vec3::ONE, Vec3::Z, 1.0), Aabb { min: Vec3::Z, max: Vec3::new(2.0, 2.0, 1.0) });
    }
}
