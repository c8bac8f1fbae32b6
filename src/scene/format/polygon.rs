//! Polygons cut into triangles.

use crate::scene::desc::problem::{At, Warnings};
use earcut::Earcut;
use glam::{DVec2, DVec3};

/// Squares of the corners of all polygons that ears are cut from: the time that takes may grow with the square, and comes
/// to some 13 ns of it where edges cross each other, which is 3 s in all.
const MOST_EARS: u64 = 200_000_000;
/// Polygons of no more corners are cut for nothing.
const FEW_CORNERS: u64 = 64;

/// Cuts polygons, one after the other.
pub struct Cutter {
    ears_left: u64,
    /// Polygons that were cut as fans though they are not convex, once too many ears were cut.
    fans: u64,
    ears: Earcut<f64>,
    /// The corners of a polygon in its plane.
    flat: Vec<[f64; 2]>,
    cut: Vec<u32>,
}

impl Cutter {
    pub fn new() -> Self {
        Self { ears_left: MOST_EARS, fans: 0, ears: Earcut::new(), flat: Vec::new(), cut: Vec::new() }
    }

    /// The triangles of a polygon, as indices into its corners, wound as it is. A convex polygon becomes a fan around
    /// its first corner; from another one, which should lie in a plane, ears are cut (M. Held, FIST: Fast
    /// Industrial-Strength Triangulation of Polygons, 2001).
    pub fn cut(&mut self, corners: &[DVec3]) -> &[[u32; 3]] {
        let normal = area_vector(corners).normalize_or_zero();
        let (u, v) = normal.any_orthonormal_pair();
        self.flat.clear();
        self.flat.extend(corners.iter().map(|p| *p - corners[0]).map(|p| [p.dot(u), p.dot(v)]));
        self.cut.clear();
        if normal != DVec3::ZERO && !is_convex(&self.flat) {
            let count = corners.len() as u64;
            let price = if count > FEW_CORNERS { count.saturating_mul(count) } else { 0 };
            match self.ears_left.checked_sub(price) {
                None => self.fans += 1,
                Some(left) => {
                    self.ears_left = left;
                    self.ears.earcut_slice(&self.flat, &[], &mut self.cut);
                }
            }
        }
        // A polygon without area has no ears; triangles without area are counted when they are left out.
        if self.cut.is_empty() {
            self.cut.extend((2..corners.len() as u32).flat_map(|i| [0, i - 1, i]));
        }
        let (triangles, _) = self.cut.as_chunks_mut();
        triangles.iter_mut().filter(|t| turn(&self.flat, **t) < 0.0).for_each(|t| t.swap(1, 2));
        triangles
    }

    /// Warns of polygons that were cut as fans, if there are any.
    pub fn warn(&self, warnings: &mut Warnings) {
        if self.fans > 0 {
            let message = format!("polygons with too many corners: {} may cover more than they should", self.fans);
            warnings.push(At(0), message);
        }
    }
}

/// The normal of a polygon, as long as twice its area (Newell's method, which bears polygons that are slightly bent).
pub fn area_vector(corners: &[DVec3]) -> DVec3 {
    let Some(first) = corners.first() else { return DVec3::ZERO };
    corners.windows(2).map(|pair| (pair[0] - *first).cross(pair[1] - *first)).sum()
}

/// Twice the area of a triangle, below 0 where it winds clockwise.
fn turn(flat: &[[f64; 2]], corners: [u32; 3]) -> f64 {
    let [a, b, c] = corners.map(|i| DVec2::from_array(flat[i as usize]));
    (b - a).perp_dot(c - a)
}

/// Whether a polygon turns left at every corner and goes around once: then every corner sees the others in order.
fn is_convex(flat: &[[f64; 2]]) -> bool {
    let n = flat.len() as u32;
    (0..n).all(|i| turn(flat, [i, (i + 1) % n, (i + 2) % n]) >= 0.0) && (2..n).all(|i| turn(flat, [0, i - 1, i]) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A polygon in a tilted plane far from the origin.
    fn tilted(flat: impl IntoIterator<Item = (f64, f64)>) -> Vec<DVec3> {
        let (u, v) = (DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, 0.0, 2.0));
        flat.into_iter().map(|(x, y)| DVec3::new(100.0, -50.0, 7.0) + u * x + v * y).collect()
    }

    /// Cuts a polygon whose area is known: all triangles wind as it does, and they have that area together.
    fn check(corners: &[DVec3]) -> Vec<[u32; 3]> {
        let triangles = Cutter::new().cut(corners).to_vec();
        let whole = area_vector(corners);
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            (b - a).cross(c - a).dot(whole.normalize())
        };
        assert!(triangles.iter().all(|t| area(t) >= 0.0), "{triangles:?}");
        let sum: f64 = triangles.iter().map(area).sum();
        assert!((sum - whole.length()).abs() < 1e-6 * whole.length(), "{sum} {whole}");
        triangles
    }

    #[test]
    fn convex_polygons_become_fans() {
        let square = tilted([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
        assert_eq!(check(&square), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(check(&square[..3]), [[0, 1, 2]]);
        let ring = tilted((0..200_000).map(|i| f64::from(i) / 200_000.0 * TAU).map(|a| (a.cos(), a.sin())));
        assert_eq!(check(&ring).len(), 199_998);
    }

    #[test]
    fn concave_polygons_cover_their_own_area_only() {
        let arrow = tilted([(0.0, 0.0), (2.0, -1.0), (0.5, 0.0), (2.0, 1.0)]);
        assert_eq!(check(&arrow).len(), 2);
        let reversed: Vec<DVec3> = arrow.into_iter().rev().collect();
        assert_eq!(check(&reversed).len(), 2);
        let gear = (0..144).map(|i| (f64::from(i) / 144.0 * TAU, if i / 2 % 2 == 0 { 1.0 } else { 0.8 }));
        check(&tilted(gear.map(|(a, r)| (r * a.cos(), r * a.sin()))));
    }

    #[test]
    fn nothing_ends_the_program_or_takes_long() {
        let star = |n: u32| tilted((0..n).map(|i| f64::from(i) * 2.4).map(|a| (a.cos(), a.sin())));
        for corners in [star(4096), star(100_000), vec![DVec3::ZERO; 5], tilted([(1.0, 1.0), (2.0, 2.0), (3.0, 3.0)])] {
            assert!(!Cutter::new().cut(&corners).is_empty());
        }
        let (mut cutter, large) = (Cutter { ears_left: 3_000_000, ..Cutter::new() }, star(1000));
        for fans in [0, 0, 0, 1, 2] {
            assert!(!cutter.cut(&large).is_empty());
            assert_eq!(cutter.fans, fans);
        }
        let huge = [DVec3::ZERO, DVec3::X * 3e38, DVec3::splat(3e38), DVec3::Y * 3e38];
        assert_eq!(Cutter::new().cut(&huge).len(), 2);
        for few in 0..3 {
            assert!(Cutter::new().cut(&huge[..few]).is_empty());
        }
    }
}
