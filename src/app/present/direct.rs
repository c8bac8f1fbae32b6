//! Frame and overlay joined in memory and copied to the surface: no shader runs.

use super::PaintJob;
use super::raster::{Raster, over};
use crate::app::gpu::Gpu;
use crate::render::Film;
use egui::{Color32, TexturesDelta};

/// The picture on its way to the surface.
#[derive(Debug)]
pub struct Direct {
    /// The surface stores blue first.
    swaps: bool,
    overlay: Raster,
    bytes: Vec<u8>,
}

impl Direct {
    /// `None` where the surface cannot be copied to.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        let swaps = match gpu.format() {
            wgpu::TextureFormat::Bgra8Unorm => true,
            wgpu::TextureFormat::Rgba8Unorm => false,
            _ => return None,
        };
        gpu.can_copy_to_surface().then(|| Self::with_order(swaps))
    }

    fn with_order(swaps: bool) -> Self {
        Self { swaps, overlay: Raster::default(), bytes: Vec::new() }
    }

    /// Paints the overlay to show.
    pub fn set_overlay(&mut self, job: &PaintJob, textures: &mut TexturesDelta) {
        self.overlay.set_textures(textures);
        self.overlay.paint(job);
        self.overlay.free_textures(textures);
    }

    /// Joins `frame` and the overlay at the size of `target` and copies them there.
    pub fn write(&mut self, frame: Option<&Film>, queue: &wgpu::Queue, target: &wgpu::Texture) {
        let (width, height) = (target.width(), target.height());
        self.join(frame, width, height);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
        queue.write_texture(target.as_image_copy(), &self.bytes, layout, target.size());
    }

    /// Fills `bytes` in the surface's order; black before the first frame.
    fn join(&mut self, frame: Option<&Film>, width: u32, height: u32) {
        // The order is chosen out here, so that the loops over pixels know it.
        if self.swaps {
            self.join_ordered(frame, width, height, swapped);
        } else {
            self.join_ordered(frame, width, height, |rgba| rgba);
        }
    }

    fn join_ordered(&mut self, frame: Option<&Film>, width: u32, height: u32, order: impl Fn(Pixel) -> Pixel) {
        self.bytes.resize(width as usize * height as usize * 4, 0);
        let overlay = self.overlay.used().filter(|_| self.overlay.size() == [width, height]);
        for (y, row) in (0..height).zip(self.bytes.as_chunks_mut().0.chunks_exact_mut(width as usize)) {
            match frame {
                Some(film) => copy_row(row, film, y, height, |[r, g, b, _]| order([r, g, b, 255])),
                None => row.fill([0; 4]),
            }
            let Some([left, top, covered, rows]) = overlay else { continue };
            if (top..top + rows).contains(&y) {
                let covered = left as usize..(left + covered) as usize;
                lay_row(&mut row[covered.clone()], &self.overlay.row(y)[covered], &order);
            }
        }
    }
}

/// One pixel, four channels with alpha last.
type Pixel = [u8; 4];

/// Pixels that are looked at together: most of a panel hides all of what is below.
const RUN: usize = 16;

/// A row of the overlay over one of the picture.
fn lay_row(row: &mut [Pixel], overlay: &[Color32], order: impl Fn(Pixel) -> Pixel) {
    for (pixels, colors) in row.chunks_mut(RUN).zip(overlay.chunks(RUN)) {
        let pairs = pixels.iter_mut().zip(colors.iter().map(|color| color.to_array()));
        let (all, any) = colors
            .iter()
            .fold((u8::MAX, false), |(all, any), color| (all & color.a(), any | (*color != Color32::TRANSPARENT)));
        match (all, any) {
            (u8::MAX, _) => pairs.for_each(|(pixel, color)| *pixel = order(color)),
            (_, false) => {}
            _ => pairs.for_each(|(pixel, color)| *pixel = over(order(color), *pixel)),
        }
    }
}

/// One row of the picture; a film of another size is stretched, each pixel from the nearest one.
fn copy_row(row: &mut [Pixel], film: &Film, y: u32, height: u32, order: impl Fn(Pixel) -> Pixel) {
    let scaled = |at: usize, from: u32, to: usize| at * from as usize / to;
    let film_row = scaled(y as usize, film.height(), height as usize);
    let source = &film.rgba().as_chunks().0[film_row * film.width() as usize..][..film.width() as usize];
    if source.len() == row.len() {
        for (pixel, &source) in row.iter_mut().zip(source) {
            *pixel = order(source);
        }
    } else {
        let width = row.len();
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = order(source[scaled(x, film.width(), width)]);
        }
    }
}

/// With red and blue exchanged. By shifts of a whole word: of these a compiler without byte shuffles at hand still
/// makes lanes, a quarter of the time of moving single bytes.
fn swapped(rgba: Pixel) -> Pixel {
    let word = u32::from_le_bytes(rgba);
    ((word & 0xff00_ff00) | ((word >> 16) & 0xff) | ((word & 0xff) << 16)).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Planes;
    use egui::epaint::{ClippedPrimitive, ImageDelta, Mesh, Primitive, TextureId, textures::TextureOptions};
    use egui::{ColorImage, Rect, pos2, vec2};

    #[test]
    fn frame_and_overlay_are_joined_in_the_surfaces_order() {
        for swaps in [false, true] {
            let mut direct = Direct::with_order(swaps);
            let film = Film::new(6, 4, Planes::default());
            let mut textures = TexturesDelta::default();
            let white = ColorImage::filled([1, 1], Color32::WHITE);
            textures.push(TextureId::default(), ImageDelta::full(white, TextureOptions::LINEAR));
            let mut mesh = Mesh::default();
            let red = Color32::from_rgb(200, 20, 10);
            mesh.add_colored_rect(Rect::from_min_size(pos2(1.0, 1.0), vec2(2.0, 2.0)), red);
            let primitive = ClippedPrimitive { clip_rect: Rect::EVERYTHING, primitive: Primitive::Mesh(mesh) };
            let job = PaintJob { primitives: vec![primitive], size: [6, 4], pixels_per_point: 1.0 };
            direct.set_overlay(&job, &mut textures);
            direct.join(Some(&film), 6, 4);
            let pixel = |x: usize, y: usize| &direct.bytes[4 * (6 * y + x)..][..4];
            assert_eq!(pixel(2, 2), if swaps { [10, 20, 200, 255] } else { [200, 20, 10, 255] });
            assert_eq!(pixel(0, 0), [0, 0, 0, 255], "a new film is black");
            assert_eq!(pixel(3, 2), [0, 0, 0, 255]);
            direct.join(Some(&film), 12, 8);
            assert_eq!(direct.bytes.len(), 12 * 8 * 4);
            assert_eq!(&direct.bytes[4 * (12 * 2 + 2)..][..4], [0, 0, 0, 255], "an overlay of the old size waits");
        }
    }
}
