//! Where a scene lies that is too far from the origin for single precision: map coordinates are millions of metres, where
//! neighbouring numbers are half a metre apart.
//!
//! Such a scene is moved before anything of it narrows to single precision. It is placed as it is first, which tells its
//! bounds, and once more where they are far: scenes near the origin take no step more.

use crate::geometry::Aabb;
use glam::DVec3;

/// A scene is moved where the origin is so many times its size away,
const FAR: f64 = 1000.0;
/// or so many times where that is so many units: neighbouring numbers are a 500th apart there, 2 mm in metres.
const LARGE: f64 = 4.0;
const COARSE: f64 = 16384.0;

/// The place that becomes the origin of a scene whose finite objects lie in `bounds`; `None` where they are near enough.
/// Its coordinates are round: whole numbers for a scene of one unit or more.
pub fn far_origin(bounds: Aabb) -> Option<DVec3> {
    if bounds.is_empty() || !bounds.is_finite() {
        return None;
    }
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let (size, center) = ((max - min).max_element(), (min + max) / 2.0);
    let away = min.max(-max).max_element();
    if away <= 0.0 || away <= size * if away >= COARSE { LARGE } else { FAR } {
        return None;
    }
    // What the bounds leave out may be as large as the raster that they were rounded to.
    let size = size.max(away / f64::from(1 << 24));
    let step = libm::exp2(libm::log2(size).floor());
    // Heights of a level stay as they are where they are small beside it.
    let round = |at: f64| if at.abs() <= LARGE * size { 0.0 } else { (at / step).round() * step };
    Some(DVec3::from(center.to_array().map(round)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn around(center: Vec3, size: f32) -> Aabb {
        Aabb { min: center - size / 2.0, max: center + size / 2.0 }
    }

    #[test]
    fn what_is_far_for_its_size_is_moved_to_round_numbers() {
        let city = far_origin(around(Vec3::new(582_143.0, 100.0, 5_340_122.0), 2000.0)).unwrap();
        assert_eq!(city, DVec3::new(581_632.0, 0.0, 5_340_160.0));
        let thing = far_origin(around(Vec3::new(582_143.2, 312.5, 5_340_122.8), 2.0)).unwrap();
        assert_eq!(thing.fract(), DVec3::ZERO);
        assert!(thing.distance(DVec3::new(582_143.2, 312.5, 5_340_122.8)) < 3.0, "{thing}");
        assert_eq!(far_origin(around(Vec3::X * 1e6, 0.0)).map(|origin| origin.x), Some(1e6));
        assert!(far_origin(around(Vec3::X * -2.0, 1e-3)).is_some());
    }

    #[test]
    fn what_is_near_or_nowhere_stays() {
        for (center, size) in [(0.0, 1.0), (500.0, 1.0), (1e6, 5e5), (1e20, 1e20)] {
            assert_eq!(far_origin(around(Vec3::X * center, size)), None, "{center} {size}");
        }
        assert_eq!(far_origin(Aabb::EMPTY), None);
        assert_eq!(far_origin(Aabb::INFINITE), None);
        let huge = Aabb { min: Vec3::splat(f32::MAX), max: Vec3::splat(f32::MAX) };
        assert!(far_origin(huge).is_none_or(|origin| origin.is_finite()));
    }
}
