//! The order in which a tile's pixels follow each other, so that those of a block, of a cell and of a packet lie together.

use crate::render::film::TILE;
use crate::render::samples::{BLOCK, CELL, QUARTER, pixel_at};

/// A rectangle of a tile's pixels that follow each other.
#[derive(Clone, Copy, Debug)]
pub struct Area {
    /// Its corner in the tile.
    pub x: usize,
    pub y: usize,
    /// Its size; 0 where it lies beyond the picture's border.
    pub width: usize,
    pub height: usize,
    /// The first of its pixels in the order.
    pub start: usize,
}

impl Area {
    /// How many pixels it has.
    pub fn pixels(&self) -> usize {
        self.width * self.height
    }
}

/// The order of the pixels of one size of tiles.
#[derive(Debug, Default)]
pub struct Order {
    size: [usize; 2],
    /// Samples of the pixels in order.
    pub samples: Vec<u32>,
    /// Where the pixels lie in the tile.
    pub x: Vec<f32>,
    /// See `x`.
    pub y: Vec<f32>,
    /// Its blocks.
    pub blocks: Vec<Area>,
    /// Four a block, in the blocks' order.
    pub quarters: Vec<Area>,
    /// Four a quarter, in the quarters' order.
    pub cells: Vec<Area>,
}

impl Order {
    /// Makes the order of tiles of the given size, unless it is that already.
    pub fn prepare(&mut self, width: usize, height: usize) {
        if self.size == [width, height] {
            return;
        }
        self.size = [width, height];
        self.samples.clear();
        self.x.clear();
        self.y.clear();
        self.blocks.clear();
        self.quarters.clear();
        self.cells.clear();
        // In the order of their numbers.
        for sample in 0..(TILE * TILE) as u32 {
            let [x, y] = pixel_at(sample);
            let corner = [usize::from(x), usize::from(y)];
            for (areas, edge) in [(&mut self.blocks, BLOCK), (&mut self.quarters, QUARTER), (&mut self.cells, CELL)] {
                if (sample as usize).is_multiple_of(edge * edge) {
                    areas.push(area(corner, edge, [width, height], self.samples.len()));
                }
            }
            if corner[0] < width && corner[1] < height {
                self.samples.push(sample);
                self.x.push(x.into());
                self.y.push(y.into());
            }
        }
    }
}

/// The part of a square that lies within a tile of the given size.
fn area([x, y]: [usize; 2], edge: usize, [width, height]: [usize; 2], start: usize) -> Area {
    let within = |at: usize, size: usize| size.saturating_sub(at).min(edge);
    let (width, height) = (within(x, width), within(y, height));
    let empty = width == 0 || height == 0;
    Area { x, y, width: if empty { 0 } else { width }, height: if empty { 0 } else { height }, start }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_hold_their_pixels_and_all_pixels_are_held_once() {
        for [width, height] in [[64, 64], [1, 1], [64, 16], [33, 7], [5, 50]] {
            let mut order = Order::default();
            order.prepare(width, height);
            assert_eq!(order.quarters.len(), 4 * order.blocks.len());
            assert_eq!(order.cells.len(), 4 * order.quarters.len());
            let mut seen = vec![false; width * height];
            for &sample in &order.samples {
                let [x, y] = pixel_at(sample);
                assert!(!std::mem::replace(&mut seen[usize::from(y) * width + usize::from(x)], true));
            }
            assert!(seen.into_iter().all(|s| s));
            for areas in [&order.blocks, &order.quarters, &order.cells] {
                let mut next = 0;
                for area in areas {
                    assert_eq!(area.start, next);
                    next += area.pixels();
                    for (&x, &y) in order.x[area.start..next].iter().zip(&order.y[area.start..next]) {
                        assert!((area.x..area.x + area.width).contains(&(x as usize)));
                        assert!((area.y..area.y + area.height).contains(&(y as usize)));
                    }
                }
                assert_eq!(next, width * height);
            }
        }
    }
}
