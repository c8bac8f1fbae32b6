//! What a scene is about: its surfaces without the grounds, backdrops, sky domes and strays that would decide its scale.

use super::surface_samples::{Sample, SurfaceSamples};
use crate::geometry::Aabb;
use glam::Vec3;
use std::collections::BTreeMap;

/// Flat things, and domes that face inwards, are helpers where they are so many times larger than all that is smaller,
const MUCH_LARGER: f32 = 2.5;
/// and so are other domes where they are so many times larger: a lantern is no dome of its candle.
const FAR_LARGER: f32 = 6.0;
/// Most helpers of a scene of few things; of others they are no more than what is left.
const MOST_HELPERS: usize = 3;
/// Least height of a dome in extents of what is in it.
const DOME_HEIGHT: f32 = 1.2;
/// Greatest thickness of a flat thing, as a share of its extent.
const FLAT: f32 = 0.02;
/// Least share of its outline that a ground covers: many labels on a board are none.
const COVERED: f64 = 0.7;
/// How deep what stands on a ground may reach below it, as a share of its own height: wheels, roots, foundations.
const SUNK: f32 = 0.35;
/// How far the surface of a dome stays from the middle of what is in it, in radii of that, and how much of it must.
const DOME_REACH: f64 = 1.5;
const DOME_SHARE: f64 = 0.9;
/// How much of the area, and of the primitives, lies outside of a box that leaves strays out; half of it at either end.
const STRAY: f64 = 0.02;
/// Strays lie farther from the rest than this share of its extent.
const GAP: f32 = 0.5;
/// Layers are found to this share of the extent of everything.
const LAYER: f32 = 1e-3;

/// What a scene is about.
#[derive(Debug, Default)]
pub struct Subject {
    /// Its bounds; empty where nothing is finite.
    pub bounds: Aabb,
    /// Points that hold all of it within them, each with the radius of the ball around it.
    pub points: Vec<(Vec3, f64)>,
}

impl Subject {
    /// The subject of what was sampled.
    pub fn of(samples: &SurfaceSamples) -> Self {
        let mut kept: Vec<&Sample> = samples.samples.iter().collect();
        // Objects as wholes first: a dome of many triangles is one. Then what lies in one plane, and single triangles.
        leave_out_helpers(&mut kept, samples, |sample| Some((sample.object, 0)));
        let extent = extent(bounds_of(&kept));
        leave_out_helpers(&mut kept, samples, |sample| layer(sample, extent * LAYER));
        leave_out_strays(&mut kept);
        let points = |sample: &&Sample| {
            let radius = sample.radius;
            samples.points_of(sample).iter().map(move |point| (*point, radius)).collect::<Vec<_>>()
        };
        Self { bounds: bounds_of(&kept), points: kept.iter().flat_map(points).collect() }
    }
}

/// Primitives that are judged together.
struct Group<'a> {
    bounds: Aabb,
    members: Vec<&'a Sample>,
}

/// Leaves out the largest groups where each of them is a ground, a backdrop or a dome of all that is smaller. What has no
/// `key` is a group by itself.
fn leave_out_helpers<K: Ord>(kept: &mut Vec<&Sample>, samples: &SurfaceSamples, key: impl Fn(&Sample) -> Option<K>) {
    let mut keyed: BTreeMap<K, Group> = BTreeMap::new();
    let mut groups = Vec::new();
    for &sample in &*kept {
        match key(sample) {
            Some(key) => {
                let group = keyed.entry(key).or_insert(Group { bounds: Aabb::EMPTY, members: Vec::new() });
                group.bounds = group.bounds.union(sample.bounds);
                group.members.push(sample);
            }
            None => groups.push(Group { bounds: sample.bounds, members: vec![sample] }),
        }
    }
    groups.extend(keyed.into_values());
    groups.sort_by(|a, b| extent(a.bounds).total_cmp(&extent(b.bounds)));
    let mut cut = groups.len();
    let mut smaller = Aabb::EMPTY;
    for (i, pair) in groups.windows(2).enumerate() {
        smaller = smaller.union(pair[0].bounds);
        let is_gap = extent(pair[1].bounds) >= MUCH_LARGER * extent(smaller);
        let is_much = groups.len() - (i + 1) > (i + 1).max(MOST_HELPERS);
        if is_gap && !is_much && groups[i + 1..].iter().all(|group| is_helper(group, smaller, samples)) {
            cut = i + 1;
        }
    }
    groups.truncate(cut);
    *kept = groups.into_iter().flat_map(|group| group.members).collect();
}

/// Whether a large thing only serves to show off a small one.
fn is_helper(large: &Group, small: Aabb, samples: &SurfaceSamples) -> bool {
    let size = large.bounds.size();
    let thin = size.min_position();
    if size[thin] <= FLAT * size.max_element() {
        // Ground below, a wall behind: not in the middle of it.
        let sunk = SUNK * small.size()[thin];
        let is_beside =
            large.bounds.max[thin] <= small.min[thin] + sunk || large.bounds.min[thin] >= small.max[thin] - sunk;
        let outline = f64::from(size[(thin + 1) % 3]) * f64::from(size[(thin + 2) % 3]);
        let area: f64 = large.members.iter().map(|sample| sample.area).sum();
        // A pole is thin, too.
        let is_wide = [1, 2].iter().all(|i| size[(thin + i) % 3] >= small.size()[(thin + i) % 3]);
        return is_beside && is_wide && is_near(large.bounds, small) && area >= COVERED * outline;
    }
    is_dome(large, small, samples)
}

/// Whether a large thing surrounds a small one from afar, as skies do.
fn is_dome(large: &Group, small: Aabb, samples: &SurfaceSamples) -> bool {
    let (mut size, inner) = (large.bounds.size().to_array(), extent(small));
    size.sort_unstable_by(f32::total_cmp);
    let encloses = large.bounds.min.cmple(small.min).all() && large.bounds.max.cmpge(small.max).all();
    if !encloses || size[0] < DOME_HEIGHT * inner || size[1] < MUCH_LARGER * inner {
        return false;
    }
    let (middle, radius) = (small.center().as_dvec3(), small.size().as_dvec3().length() / 2.0);
    let (mut away, mut inwards, mut points, mut primitives) = (0_u32, 0_u32, 0_u32, 0_u32);
    for sample in &large.members {
        let own = samples.points_of(sample);
        if let [a, b, c] = *own {
            inwards += u32::from((b - a).cross(c - a).dot(middle.as_vec3() - a) > 0.0);
        }
        primitives += 1;
        points += own.len() as u32;
        // The floor of a dome may be the ground: what lies below the rest may be near.
        let is_away = |point: &&Vec3| {
            let distance = (point.as_dvec3().distance(middle) - sample.radius).abs();
            distance >= DOME_REACH * radius || point.y <= small.min.y
        };
        away += own.iter().filter(is_away).count() as u32;
    }
    let mostly = |part: u32, all: u32| f64::from(part) >= DOME_SHARE * f64::from(all);
    let least = if mostly(inwards, primitives) { MUCH_LARGER } else { FAR_LARGER };
    mostly(away, points) && size[2] >= least * inner
}

/// Whether a flat thing lies under or behind a small one, rather than far off.
fn is_near(large: Aabb, small: Aabb) -> bool {
    large.overlaps(&small.padded(extent(small)))
}

/// What lies in one plane across an axis, and to which side: large grounds are made of many small triangles.
fn layer(sample: &Sample, grain: f32) -> Option<(usize, i64)> {
    let size = sample.bounds.size();
    let thin = size.min_position();
    let is_layer = size[thin] <= grain && size[(thin + 1) % 3].max(size[(thin + 2) % 3]) > grain;
    is_layer.then(|| (thin, (sample.bounds.center()[thin] / grain).round() as i64))
}

/// Leaves out what is little and far away from all the rest.
fn leave_out_strays(kept: &mut Vec<&Sample>) {
    let mut core = Aabb::EMPTY;
    for axis in 0..3 {
        let mut order: Vec<(f64, &Sample)> = kept.iter().map(|sample| (sample.middle()[axis], *sample)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        for weight in [|sample: &Sample| sample.area, |sample: &Sample| sample.count] {
            let all: f64 = order.iter().map(|(_, sample)| weight(sample)).sum();
            let mut before = 0.0;
            for (_, sample) in &order {
                let own = weight(sample);
                if before + own > all * STRAY / 2.0 && before < all * (1.0 - STRAY / 2.0) {
                    core.min[axis] = core.min[axis].min(sample.bounds.min[axis]);
                    core.max[axis] = core.max[axis].max(sample.bounds.max[axis]);
                }
                before += own;
            }
        }
    }
    // What touches the core belongs to it, and what touches that.
    let all = bounds_of(kept);
    while !core.is_empty() && extent(all) > (1.0 + GAP) * extent(core) {
        let near = core.padded(GAP * extent(core));
        let touching = kept.iter().filter(|sample| sample.bounds.overlaps(&near));
        let grown = touching.fold(core, |bounds, sample| bounds.union(sample.bounds));
        if grown == core {
            kept.retain(|sample| sample.bounds.overlaps(&near));
            return;
        }
        core = grown;
    }
}

fn bounds_of(samples: &[&Sample]) -> Aabb {
    samples.iter().fold(Aabb::EMPTY, |bounds, sample| bounds.union(sample.bounds))
}

/// The length of the longest edge; 0 of an empty box.
fn extent(bounds: Aabb) -> f32 {
    bounds.size().max_element().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, Part, PrimitiveId, Shape};

    /// Builds objects of shapes.
    fn subject(objects: &[Vec<Shape>]) -> Subject {
        let mut parts = Vec::new();
        for (object, shapes) in (0..).zip(objects) {
            for (primitive, shape) in (0..).zip(shapes) {
                parts.push(Part::new(*shape, PrimitiveId { object, primitive }));
            }
        }
        let geometry = Geometry::build(parts);
        Subject::of(&SurfaceSamples::of(&geometry, objects.len()))
    }

    fn ball(center: Vec3, radius: f32) -> Vec<Shape> {
        vec![Shape::Sphere { center, radius }]
    }

    /// A ground of `cells` by `cells` squares.
    fn ground(y: f32, half: f32, cells: usize) -> Vec<Shape> {
        let at = |i: usize| (i as f32 / cells as f32 * 2.0 - 1.0) * half;
        let corner = |x: usize, z: usize| Vec3::new(at(x), y, at(z));
        let cell = |i: usize| {
            let (x, z) = (i % cells, i / cells);
            let [a, b, c, d] = [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(dx, dz)| corner(x + dx, z + dz));
            [[a, b, c], [a, c, d]].map(|vertices| Shape::Triangle { vertices })
        };
        (0..cells * cells).flat_map(cell).collect()
    }

    fn near(bounds: Aabb, min: Vec3, max: Vec3) -> bool {
        bounds.min.abs_diff_eq(min, 1e-4) && bounds.max.abs_diff_eq(max, 1e-4)
    }

    #[test]
    fn a_ground_a_backdrop_and_a_dome_do_not_decide_the_scale() {
        let helpers = [
            ground(0.0, 50.0, 1),
            ground(0.0, 50.0, 30),
            ball(Vec3::ZERO, 40.0),
            vec![Shape::Disk { center: Vec3::NEG_Z * 2.0, normal: Vec3::Z, radius: 30.0 }],
        ];
        for helper in helpers {
            let found = subject(&[ball(Vec3::Y, 1.0), ball(Vec3::new(1.0, 1.0, 1.0), 1.0), helper.clone()]);
            assert!(near(found.bounds, Vec3::new(-1.0, 0.0, -1.0), Vec3::new(2.0, 2.0, 2.0)), "{:?}", found.bounds);
            // The same in one object.
            let one = [ball(Vec3::Y, 1.0), ball(Vec3::new(1.0, 1.0, 1.0), 1.0), helper].concat();
            let found = subject(&[one]);
            assert!(near(found.bounds, Vec3::new(-1.0, 0.0, -1.0), Vec3::new(2.0, 2.0, 2.0)), "{:?}", found.bounds);
        }
    }

    #[test]
    fn ground_and_dome_at_once() {
        let found = subject(&[ball(Vec3::Y, 1.0), ground(0.0, 50.0, 4), ball(Vec3::ZERO, 300.0)]);
        assert!(near(found.bounds, Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0)), "{:?}", found.bounds);
    }

    #[test]
    fn a_table_keeps_a_ground_of_its_own_size_and_a_thing_its_small_parts() {
        let found = subject(&[ball(Vec3::Y, 1.0), ground(0.0, 2.0, 1)]);
        assert!(near(found.bounds, Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 2.0, 2.0)), "{:?}", found.bounds);
        // A large thing with a small one in or at it is no helper.
        for place in [Vec3::ZERO, Vec3::X * 10.0] {
            let cone = Shape::Cone { base: Vec3::NEG_Y * 9.0, top: Vec3::Y * 9.0, radius_base: 1.0, radius_top: 1.0 };
            let found = subject(&[ball(place, 0.5), vec![cone]]);
            assert!(found.bounds.size().y >= 18.0, "{:?}", found.bounds);
        }
        let flat = subject(&[ground(0.0, 2.0, 1)]);
        assert!(near(flat.bounds, Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 0.0, 2.0)), "{:?}", flat.bounds);
        assert!(subject(&[]).bounds.is_empty());
    }

    #[test]
    fn a_stray_far_away_is_left_out_and_what_reaches_far_is_not() {
        let row = |count: usize| (0..count).map(|i| ball(Vec3::X * (i % 10) as f32, 1.0)).collect::<Vec<_>>();
        let stray = [row(100), vec![ball(Vec3::X * 1000.0, 0.5)]].concat();
        assert!(subject(&stray).bounds.max.x < 11.0, "{:?}", subject(&stray).bounds);
        let pole = Shape::Cone { base: Vec3::ZERO, top: Vec3::Y * 100.0, radius_base: 0.1, radius_top: 0.1 };
        let bounds = subject(&[row(100), vec![vec![pole]]].concat()).bounds;
        assert!(bounds.max.y > 99.0, "{bounds:?}");
    }
}
