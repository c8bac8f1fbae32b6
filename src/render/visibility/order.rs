//! The order in which a tile's pixels follow each other, so that those of a block, of a cell and of a packet lie together.

/// Edge of the blocks that are first asked what they can see, in pixels.
pub const BLOCK: usize = 32;
/// Edge of the blocks that a block is split into.
pub const HALF: usize = 16;
/// Edge of the smallest blocks, the cells.
pub const CELL: usize = 8;
/// Edge of a packet's square of pixels.
const PACKET: usize = 4;

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
    /// Pixels in order.
    pub pixels: Vec<[u16; 2]>,
    /// All blocks; each is followed by its halves in `halves`, and each of these by its cells in `cells`.
    pub blocks: Vec<Area>,
    /// Four a block.
    pub halves: Vec<Area>,
    /// Four a half.
    pub cells: Vec<Area>,
}

impl Order {
    /// Makes the order of tiles of the given size, unless it is that already.
    pub fn prepare(&mut self, width: usize, height: usize) {
        if self.size == [width, height] {
            return;
        }
        self.size = [width, height];
        self.pixels.clear();
        self.blocks.clear();
        self.halves.clear();
        self.cells.clear();
        for [x, y] in corners([0, 0], [width, height], BLOCK) {
            let start = self.pixels.len();
            for half in quarters([x, y], BLOCK) {
                let start = self.pixels.len();
                for cell in quarters(half, HALF) {
                    let start = self.pixels.len();
                    for packet in quarters(cell, CELL) {
                        self.append_packet(packet);
                    }
                    self.cells.push(self.area(cell, CELL, start));
                }
                self.halves.push(self.area(half, HALF, start));
            }
            self.blocks.push(self.area([x, y], BLOCK, start));
        }
    }

    fn append_packet(&mut self, [left, top]: [usize; 2]) {
        let [width, height] = self.size;
        for y in top..(top + PACKET).min(height) {
            self.pixels.extend((left..(left + PACKET).min(width)).map(|x| [x as u16, y as u16]));
        }
    }

    fn area(&self, [x, y]: [usize; 2], edge: usize, start: usize) -> Area {
        let [width, height] = self.size;
        let within = |at: usize, size: usize| size.saturating_sub(at).min(edge);
        let (width, height) = (within(x, width), within(y, height));
        let empty = width == 0 || height == 0;
        Area { x, y, width: if empty { 0 } else { width }, height: if empty { 0 } else { height }, start }
    }
}

/// Corners of the squares that fill a rectangle.
fn corners([left, top]: [usize; 2], [right, bottom]: [usize; 2], edge: usize) -> impl Iterator<Item = [usize; 2]> {
    (top..bottom).step_by(edge).flat_map(move |y| (left..right).step_by(edge).map(move |x| [x, y]))
}

/// Corners of a square's quarters.
fn quarters([x, y]: [usize; 2], edge: usize) -> impl Iterator<Item = [usize; 2]> {
    corners([x, y], [x + edge, y + edge], edge / 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_hold_their_pixels_and_all_pixels_are_held_once() {
        for [width, height] in [[64, 64], [1, 1], [64, 16], [33, 7], [5, 50]] {
            let mut order = Order::default();
            order.prepare(width, height);
            assert_eq!(order.halves.len(), 4 * order.blocks.len());
            assert_eq!(order.cells.len(), 4 * order.halves.len());
            let mut seen = vec![false; width * height];
            for &[x, y] in &order.pixels {
                assert!(!std::mem::replace(&mut seen[usize::from(y) * width + usize::from(x)], true));
            }
            assert!(seen.into_iter().all(|s| s));
            for areas in [&order.blocks, &order.halves, &order.cells] {
                let mut next = 0;
                for area in areas {
                    assert_eq!(area.start, next);
                    next += area.pixels();
                    for &[x, y] in &order.pixels[area.start..next] {
                        let (x, y) = (usize::from(x), usize::from(y));
                        assert!((area.x..area.x + area.width).contains(&x));
                        assert!((area.y..area.y + area.height).contains(&y));
                    }
                }
                assert_eq!(next, width * height);
            }
        }
    }
}
