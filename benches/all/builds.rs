//! Building blocks and tree from shapes.

use crate::shapes::{coincident, terrain};
use divan::{Bencher, counter::ItemsCount};
use raywalk::geometry::{Geometry, Part};

fn bench(bencher: Bencher, make: impl Fn() -> Vec<Part> + Sync) {
    let input = || make();
    bencher.with_inputs(input).input_counter(|parts| ItemsCount::new(parts.len())).bench_values(Geometry::build);
}

#[divan::bench(sample_count = 10)]
fn terrain_of_a_million_triangles(bencher: Bencher) {
    bench(bencher, || terrain(720));
}

/// All the same triangle: nothing tells where to split.
#[divan::bench(args = [20_000, 200_000], sample_count = 10)]
fn coincident_triangles(bencher: Bencher, count: usize) {
    bench(bencher, || coincident(count));
}
