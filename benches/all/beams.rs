//! Beams of blocks of pixels: listing what they can meet, and sifting that list for smaller ones.

use crate::shapes::terrain;
use divan::{Bencher, counter::ItemsCount};
use fearless_simd::Simd;
use glam::Vec3;
use raywalk::geometry::beam::{Beam, Candidates, Cover, Projection};
use raywalk::geometry::{Geometry, Search, Stack};
use raywalk::math::{SimdToken, dispatch};

/// Blocks along one side of the square that is looked at.
const BLOCKS: usize = 16;

/// The eye's view of the terrain.
fn projection(geometry: &Geometry) -> Projection {
    let eye = Vec3::new(0.0, 3.0, 7.0);
    let forward = -eye.normalize();
    let right = forward.cross(Vec3::Y).normalize();
    Projection::new(eye, [right, right.cross(forward), forward], false, geometry.reach(), 1.0)
}

/// The beam of one of `count` x `count` squares.
fn beam(projection: &Projection, [column, row]: [usize; 2], count: usize) -> Beam<'_> {
    let range = |at: usize| [at, at + 1].map(|edge| edge as f32 / count as f32 * 0.8 - 0.4);
    Beam::new(projection, range(column), range(row))
}

/// How many candidates all blocks have.
fn list_all<S: Simd>(
    simd: S,
    geometry: &Geometry,
    projection: &Projection,
    candidates: &mut Candidates,
    stack: &mut Stack,
) -> usize {
    let search = Search::new(geometry, true);
    let mut listed = 0;
    for block in 0..BLOCKS * BLOCKS {
        let beam = beam(projection, [block % BLOCKS, block / BLOCKS], BLOCKS);
        search.collect(simd, &beam, Cover::nothing(projection), candidates, stack);
        listed += candidates.len();
    }
    listed
}

#[divan::bench]
fn list(bencher: Bencher) {
    let geometry = Geometry::build(terrain(240));
    let (projection, mut candidates, mut stack) = (projection(&geometry), Candidates::default(), Stack::default());
    bencher.counter(ItemsCount::new(BLOCKS * BLOCKS)).bench_local(
        || dispatch!(SimdToken::best(), simd => list_all(simd, &geometry, &projection, &mut candidates, &mut stack)),
    );
}

/// How many candidates the sixteen cells of the block in the middle have.
fn sift_middle<S: Simd>(simd: S, projection: &Projection, block: &Candidates, cell: &mut Candidates) -> usize {
    let first = BLOCKS / 2 * 4;
    let mut listed = 0;
    for number in 0..16 {
        let beam = beam(projection, [first + number % 4, first + number / 4], BLOCKS * 4);
        cell.filter(simd, block, &beam);
        listed += cell.len();
    }
    listed
}

#[divan::bench]
fn sift(bencher: Bencher) {
    let geometry = Geometry::build(terrain(240));
    let (projection, mut block, mut cell) = (projection(&geometry), Candidates::default(), Candidates::default());
    let whole = beam(&projection, [BLOCKS / 2, BLOCKS / 2], BLOCKS);
    let nothing = Cover::nothing(&projection);
    let mut stack = Stack::default();
    dispatch!(SimdToken::best(), simd =>
        Search::new(&geometry, true).collect(simd, &whole, nothing, &mut block, &mut stack));
    bencher
        .counter(ItemsCount::new(16_usize))
        .bench_local(|| dispatch!(SimdToken::best(), simd => sift_middle(simd, &projection, &block, &mut cell)));
}
