//! A traced picture as cells of the terminal.

use super::palette::{Color, Palette};

/// Two pixels, one above the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The upper pixel.
    pub top: Color,
    /// The lower pixel.
    pub bottom: Color,
}

/// A rectangle of cells, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cells {
    columns: usize,
    cells: Vec<Cell>,
}

impl Cells {
    /// The cells of a picture of `width` pixels a row, four bytes of sRGB each. The lower half of a last row of odd number
    /// is left out with its row.
    pub fn of_picture(rgba: &[u8], width: usize, palette: Palette) -> Self {
        let color = |pixel: &[u8]| palette.color([pixel[0], pixel[1], pixel[2]]);
        let cells = rgba
            .chunks_exact((8 * width).max(8))
            .flat_map(|rows| {
                let (upper, lower) = rows.split_at(4 * width);
                upper.chunks_exact(4).zip(lower.chunks_exact(4))
            })
            .map(|(upper, lower)| Cell { top: color(upper), bottom: color(lower) })
            .collect();
        Self { columns: width, cells }
    }

    /// Cells a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The rows from the top.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[Cell]> {
        self.cells.chunks_exact(self.columns.max(1))
    }

    /// Whether both cover the same part of the terminal.
    pub fn fits(&self, other: &Self) -> bool {
        self.columns == other.columns && self.cells.len() == other.cells.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_two_pixels() {
        let pixel = |value: u8| [value, 0, 0, 255];
        let rgba: Vec<u8> = [1, 2, 3, 4, 5, 6].into_iter().flat_map(pixel).collect();
        let cells = Cells::of_picture(&rgba, 2, Palette::TrueColor);
        let color = |value: u8| Color::Rgb([value, 0, 0]);
        let rows: Vec<_> = cells.rows().collect();
        let expected = [Cell { top: color(1), bottom: color(3) }, Cell { top: color(2), bottom: color(4) }];
        assert_eq!(rows, [&expected[..]], "the fifth and sixth pixel have nothing below them");
        assert_eq!(Cells::of_picture(&[], 0, Palette::TrueColor).rows().len(), 0);
    }
}
