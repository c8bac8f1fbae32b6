//! What the placements of a mesh come to in the world: how far they reach, and how many of their triangles have area.
//!
//! The answers are those of moving every corner to the world and looking at every triangle there, in far fewer steps:
//!
//! - A triangle is wider than nothing in the world if it is wider in the mesh than rounding can make up for, so only the
//!   thin ones are looked at.
//! - Adding a translation and rounding to single precision keep the order of numbers. So the extent of a mesh follows from
//!   that of the same mesh, turned alike, elsewhere.

use crate::geometry::{Aabb, Mesh, Transform};
use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

/// More than this is shared out among threads.
const CHUNK: usize = 1 << 15;
/// How much wider a triangle has to be than the largest coordinate in play, in the world, to keep its area for certain:
/// corners are moved by 2^-24 of that along each axis, twice, and by what f64 rounds; generously.
const LEAST_WIDTH: f64 = 32.0 / (1 << 24) as f64;
/// And wider than this, near the smallest numbers there are.
const LEAST_NUMBER: f64 = 1e-40;
/// Transforms that stretch more in one direction than in another by this, and those whose inverses are off by more than
/// that, prove nothing.
const MOST_CONDITION: f64 = 1e6;
const MOST_RESIDUE: f64 = 1e-3;

/// What is known of a mesh wherever it is placed.
#[derive(Debug)]
pub struct Footprint {
    /// The numbers of triangles, each with its least width in the mesh; the thinnest first.
    triangles: Vec<(f32, u32)>,
    /// The corners of triangles, each with the width of the widest one that it belongs to; those of the widest first.
    corners: Vec<(f32, DVec3)>,
    /// Largest magnitude of any coordinate.
    reach: f64,
    /// What was found out last.
    turned: Option<Turned>,
}

/// The extent of the first corners of a mesh, turned and not moved.
#[derive(Debug)]
struct Turned {
    matrix: DMat3,
    corners: usize,
    extent: [DVec3; 2],
}

/// What one placement of a mesh comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Survey {
    /// Bounds of the triangles that have area.
    pub bounds: Aabb,
    /// How many have none, and the least of their numbers.
    pub dropped: u32,
    pub first_dropped: u32,
}

impl Survey {
    const NOTHING: Self = Self { bounds: Aabb::EMPTY, dropped: 0, first_dropped: u32::MAX };

    fn and(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            dropped: self.dropped + other.dropped,
            first_dropped: self.first_dropped.min(other.first_dropped),
        }
    }
}

impl Footprint {
    /// The footprint of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let width = |number: u32| (width(mesh.corners(number).map(|i| mesh.vertices[i])), number);
        let mut triangles: Vec<(f32, u32)> = (0..mesh.triangles.len() as u32).into_par_iter().map(width).collect();
        let mut widest = vec![None; mesh.vertices.len()];
        for &(width, number) in &triangles {
            for corner in mesh.corners(number) {
                widest[corner] = Some(widest[corner].map_or(width, |other: f32| other.max(width)));
            }
        }
        let with_width = |(point, width): (&DVec3, &Option<f32>)| width.map(|width| (width, *point));
        let mut corners: Vec<(f32, DVec3)> = mesh.vertices.iter().zip(&widest).filter_map(with_width).collect();
        triangles.par_sort_unstable_by(|(a, m), (b, n)| a.total_cmp(b).then(m.cmp(n)));
        corners.par_sort_unstable_by(|(a, _), (b, _)| b.total_cmp(a));
        let reach = corners.iter().fold(0.0_f64, |reach, (_, point)| reach.max(point.abs().max_element()));
        Self { triangles, corners, reach, turned: None }
    }

    /// What `mesh`, of which this is the footprint, comes to where it is placed; `None` if it reaches beyond all numbers.
    pub fn survey(&mut self, mesh: &Mesh, placed: &Transform) -> Option<Survey> {
        let enough = self.width_that_lasts(placed);
        let thin = self.triangles.partition_point(|(width, _)| *width <= enough);
        let wide = self.corners.partition_point(|(width, _)| *width > enough);
        let look = |triangles: &[(f32, u32)]| look_at(mesh, placed, triangles);
        let join = |a: Option<Survey>, b: Option<Survey>| Some(a?.and(b?));
        let looked_at = in_chunks(&self.triangles[..thin], look, join)?;
        if wide == 0 {
            return Some(looked_at);
        }
        let [min, max] = self.extent(placed.matrix().matrix3, wide).map(|end| end + placed.matrix().translation);
        let bounds = Aabb { min: min.as_vec3(), max: max.as_vec3() };
        bounds.is_finite().then(|| looked_at.and(Survey { bounds, ..Survey::NOTHING }))
    }

    /// Triangles that are wider have area in the world, however their corners are rounded there.
    fn width_that_lasts(&self, placed: &Transform) -> f32 {
        let (matrix, translation) = (placed.matrix().matrix3, placed.matrix().translation);
        let inverse = matrix.inverse();
        let size = |m: DMat3| m.to_cols_array().iter().map(|c| c * c).sum::<f64>().sqrt();
        let (greatest, shrinking) = (size(matrix), size(inverse));
        let residue = size(matrix * inverse - DMat3::IDENTITY);
        let reach = greatest * self.reach * 2.0 + translation.abs().max_element();
        let width = (reach * LEAST_WIDTH + LEAST_NUMBER) * shrinking;
        let proves = greatest * shrinking < MOST_CONDITION && residue < MOST_RESIDUE && width < f64::from(f32::MAX);
        if proves { width as f32 } else { f32::INFINITY }
    }

    /// The extent of the first `count` corners under `matrix`.
    fn extent(&mut self, matrix: DMat3, count: usize) -> [DVec3; 2] {
        if let Some(known) = &self.turned
            && known.corners == count
            && known.matrix == matrix
        {
            return known.extent;
        }
        let of = |corners: &[(f32, DVec3)]| {
            corners.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], (_, point)| {
                let turned = matrix * *point;
                [min.min(turned), max.max(turned)]
            })
        };
        let extent = in_chunks(&self.corners[..count], of, |[a, b], [c, d]| [a.min(c), b.max(d)]);
        self.turned = Some(Turned { matrix, corners: count, extent });
        extent
    }
}

/// Moves triangles to the world and looks at them there.
fn look_at(mesh: &Mesh, placed: &Transform, triangles: &[(f32, u32)]) -> Option<Survey> {
    triangles.iter().try_fold(Survey::NOTHING, |so_far, &(_, number)| {
        let corners = mesh.corners(number).map(|i| placed.point(mesh.vertices[i]).as_vec3());
        if !has_area(corners) {
            return Some(so_far.and(Survey { bounds: Aabb::EMPTY, dropped: 1, first_dropped: number }));
        }
        let bounds = Aabb::from_points(corners);
        bounds.is_finite().then(|| so_far.and(Survey { bounds, ..Survey::NOTHING }))
    })
}

/// Whether a triangle spans any area.
pub fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    let a = a.as_dvec3();
    (b.as_dvec3() - a).cross(c.as_dvec3() - a) != DVec3::ZERO
}

/// How wide a triangle is where it is narrowest; 0 where that cannot be told.
fn width([a, b, c]: [DVec3; 3]) -> f32 {
    let longest = (b - a).length().max((c - a).length()).max((c - b).length());
    let width = ((b - a).cross(c - a).length() / longest) as f32;
    if width.is_finite() { width } else { 0.0 }
}

/// Does something for all items, a chunk on each thread where they are many.
fn in_chunks<T: Sync, R: Send>(
    items: &[T],
    of: impl Fn(&[T]) -> R + Sync,
    join: impl Fn(R, R) -> R + Sync + Send,
) -> R {
    if items.len() <= CHUNK { of(items) } else { items.par_chunks(CHUNK).map(&of).reduce(|| of(&[]), join) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::SplitMix64;
    use glam::{DAffine3, DQuat};

    fn within(random: &mut SplitMix64, size: f64) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| random.within(-size, size)))
    }

    /// Triangles of all widths, some of them needles and some without area.
    fn soup(random: &mut SplitMix64, away: DVec3) -> Mesh {
        let mut mesh = Mesh::default();
        for number in 0..60_u32 {
            let (a, along) = (away + within(random, 1.0), within(random, 1.0));
            let width = libm::exp2(random.within(-30.0, 0.0));
            let b = a + along * 0.5 + within(random, width);
            mesh.vertices.extend([a, a + along, if number % 20 == 7 { a } else { b }]);
            mesh.triangles.push([3 * number, 3 * number + 1, 3 * number + 2]);
        }
        // Nothing's corner.
        mesh.vertices.push(DVec3::splat(1e3));
        mesh
    }

    #[test]
    fn it_finds_what_looking_at_every_triangle_finds() {
        let mut random = SplitMix64(3);
        let (mut dropped, mut beyond, mut proven) = (0, 0, 0);
        for round in 0..400_u32 {
            let away = within(&mut random, if round % 3 == 0 { 1e4 } else { 0.0 });
            let mesh = soup(&mut random, away);
            let mut footprint = Footprint::new(&mesh);
            let all: Vec<(f32, u32)> = (0..mesh.triangles.len() as u32).map(|number| (0.0, number)).collect();
            let turn = DQuat::from_axis_angle(within(&mut random, 1.0).normalize(), random.within(0.0, 6.0));
            let scale =
                DVec3::from_array([(); 3].map(|()| libm::exp2(random.within(-0.5, 0.5) * f64::from(round % 40))));
            let size = libm::exp2(random.within(-0.5, 0.5) * if round % 4 == 0 { 300.0 } else { 4.0 });
            let turned = DMat3::from_quat(turn) * DMat3::from_diagonal(scale * DVec3::new(1.0, -1.0, 1.0)) * size;
            for place in 0..6 {
                let far = libm::exp2(random.within(0.0, 20.0));
                let translation = within(&mut random, far);
                let matrix3 = if place == 4 { turned * 2.0 } else { turned };
                let Some(placed) = Transform::new(DAffine3 { matrix3, translation }) else { continue };
                let found = footprint.survey(&mesh, &placed);
                assert_eq!(found, look_at(&mesh, &placed, &all), "round {round}");
                dropped += found.map_or(0, |found| found.dropped);
                beyond += u32::from(found.is_none());
                proven += u32::from(footprint.turned.is_some());
            }
        }
        assert!(dropped > 1000 && beyond > 20 && proven > 1000, "{dropped} {beyond} {proven}");
    }
}
