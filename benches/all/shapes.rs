//! Shapes to build and to trace, made from numbers that are the same on every run.

use glam::Vec3;
use raywalk::geometry::{Part, PrimitiveId, Shape};

/// A random number in [0, 1): splitmix64.
pub fn random(state: &mut u64) -> f32 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut bits = *state;
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ bits >> 31) >> 40) as f32 / (1 << 24) as f32
}

/// A random point of the cube from -1 to 1.
pub fn random_point(state: &mut u64) -> Vec3 {
    Vec3::from([(); 3].map(|()| random(state) * 2.0 - 1.0))
}

fn parts(shapes: impl Iterator<Item = Shape>) -> Vec<Part> {
    let part = |(shape, primitive)| Part::new(shape, PrimitiveId { object: 0, primitive });
    shapes.zip(0..).map(part).collect()
}

/// Hills of 2 · `side`² triangles in the square from -5 to 5.
pub fn terrain(side: u32) -> Vec<Part> {
    let step = 10.0 / side as f32;
    let point = |i: u32, j: u32| {
        let (x, z) = (i as f32 * step - 5.0, j as f32 * step - 5.0);
        Vec3::new(x, 0.4 * (1.7 * x).sin() * (1.3 * z).cos(), z)
    };
    let cells = (0..side).flat_map(|j| (0..side).map(move |i| (i, j)));
    parts(cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i, j + 1), point(i + 1, j + 1)];
        [[a, c, b], [b, c, d]].map(|vertices| Shape::Triangle { vertices })
    }))
}

/// The same triangle, `count` times.
pub fn coincident(count: usize) -> Vec<Part> {
    parts(std::iter::repeat_n(Shape::Triangle { vertices: [Vec3::ZERO, Vec3::X, Vec3::Y] }, count))
}

/// Blades of grass 3 mm wide and up to 20 cm high on a lawn of 4 m x 4 m, three triangles each.
pub fn grass(blades: usize) -> impl Iterator<Item = [Vec3; 3]> {
    let mut state = 7;
    (0..blades).flat_map(move |_| {
        let root = random_point(&mut state) * Vec3::new(2.0, 0.0, 2.0);
        let angle = random(&mut state) * std::f32::consts::PI;
        let half = Vec3::new(angle.cos(), 0.0, angle.sin()) * 0.0015;
        let tip =
            root + random_point(&mut state) * Vec3::new(0.05, 0.0, 0.05) + Vec3::Y * (0.05 + 0.15 * random(&mut state));
        let bend = root.lerp(tip, 0.5) + Vec3::Y * 0.01;
        let [a, b, c, d] = [root - half, root + half, bend - half, bend + half];
        [[a, b, c], [b, d, c], [c, d, tip]]
    })
}

/// One shape of each type that a tree holds, and a plane, `count` of each in the cube from -1 to 1.
pub fn mixture(count: usize) -> Vec<Part> {
    let mut state = 1;
    let mut shapes = Vec::new();
    for _ in 0..count {
        let mut near = |center: Vec3, size: f32| center + random_point(&mut state) * size;
        let center = near(Vec3::ZERO, 1.0);
        let normal = near(Vec3::ZERO, 1.0).normalize();
        shapes.extend([
            Shape::Sphere { center, radius: 0.1 },
            Shape::Triangle { vertices: [near(center, 0.2), near(center, 0.2), near(center, 0.2)] },
            Shape::Disk { center, normal, radius: 0.1 },
            Shape::Cone { base: center, top: near(center, 0.2), radius_base: 0.1, radius_top: 0.05 },
            Shape::Plane { point: center, normal },
        ]);
    }
    parts(shapes.into_iter())
}
