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
    frame: Option<Film>,
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
        Self { swaps, frame: None, overlay: Raster::default(), bytes: Vec::new() }
    }

    /// Takes the frame to show and returns the one before.
    pub fn set_frame(&mut self, film: Film) -> Option<Film> {
        self.frame.replace(film)
    }

    /// Paints the overlay to show.
    pub fn set_overlay(&mut self, job: &PaintJob, textures: &mut TexturesDelta) {
        self.overlay.set_textures(textures);
        self.overlay.paint(job);
        self.overlay.free_textures(textures);
    }

    /// Joins both at the size of `target` and copies them there.
    pub fn write(&mut self, queue: &wgpu::Queue, target: &wgpu::Texture) {
        let (width, height) = (target.width(), target.height());
        self.join(width, height);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
        queue.write_texture(target.as_image_copy(), &self.bytes, layout, target.size());
    }

    /// Fills `bytes` in the surface's order; black before the first frame.
    fn join(&mut self, width: u32, height: u32) {
        self.bytes.resize(width as usize * height as usize * 4, 0);
        let overlay = self.overlay.used().filter(|_| self.overlay.size() == [width, height]);
        for (y, row) in (0..height).zip(self.bytes.chunks_exact_mut(4 * width as usize)) {
            match &self.frame {
                Some(film) => copy_row(row, film, y, width, height, self.swaps),
                None => row.fill(0),
            }
            let Some([left, top, covered, rows]) = overlay else { continue };
            if (top..top + rows).contains(&y) {
                let (left, right) = (left as usize, (left + covered) as usize);
                lay_over(&mut row[4 * left..4 * right], &self.overlay.row(y)[left..right], self.swaps);
            }
        }
    }
}

/// One row of the picture; a film of another size is stretched, each pixel from the nearest one.
fn copy_row(row: &mut [u8], film: &Film, y: u32, width: u32, height: u32, swaps: bool) {
    let scaled = |at: u32, from: u32, to: u32| (u64::from(at) * u64::from(from) / u64::from(to)) as usize;
    let stride = 4 * film.width() as usize;
    let source = &film.rgba()[scaled(y, film.height(), height) * stride..][..stride];
    if film.width() == width {
        for (pixel, source) in row.chunks_exact_mut(4).zip(source.chunks_exact(4)) {
            pixel.copy_from_slice(&ordered([source[0], source[1], source[2], 255], swaps));
        }
    } else {
        for (x, pixel) in (0..width).zip(row.chunks_exact_mut(4)) {
            let source = &source[4 * scaled(x, film.width(), width)..][..4];
            pixel.copy_from_slice(&ordered([source[0], source[1], source[2], 255], swaps));
        }
    }
}

fn lay_over(row: &mut [u8], overlay: &[Color32], swaps: bool) {
    for (pixel, &color) in row.chunks_exact_mut(4).zip(overlay) {
        let color = ordered(color.to_array(), swaps);
        let color = Color32::from_rgba_premultiplied(color[0], color[1], color[2], color[3]);
        let below = Color32::from_rgba_premultiplied(pixel[0], pixel[1], pixel[2], pixel[3]);
        pixel.copy_from_slice(&over(color, below).to_array());
    }
}

fn ordered([r, g, b, a]: [u8; 4], swaps: bool) -> [u8; 4] {
    if swaps { [b, g, r, a] } else { [r, g, b, a] }
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
            assert!(direct.set_frame(Film::new(6, 4, Planes::default())).is_none());
            let mut textures = TexturesDelta::default();
            let white = ColorImage::filled([1, 1], Color32::WHITE);
            textures.push(TextureId::default(), ImageDelta::full(white, TextureOptions::LINEAR));
            let mut mesh = Mesh::default();
            let red = Color32::from_rgb(200, 20, 10);
            mesh.add_colored_rect(Rect::from_min_size(pos2(1.0, 1.0), vec2(2.0, 2.0)), red);
            let primitive = ClippedPrimitive { clip_rect: Rect::EVERYTHING, primitive: Primitive::Mesh(mesh) };
            let job = PaintJob { primitives: vec![primitive], size: [6, 4], pixels_per_point: 1.0 };
            direct.set_overlay(&job, &mut textures);
            direct.join(6, 4);
            let pixel = |x: usize, y: usize| &direct.bytes[4 * (6 * y + x)..][..4];
            assert_eq!(pixel(2, 2), ordered([200, 20, 10, 255], swaps));
            assert_eq!(pixel(0, 0), [0, 0, 0, 255], "a new film is black");
            assert_eq!(pixel(3, 2), [0, 0, 0, 255]);
            direct.join(12, 8);
            assert_eq!(direct.bytes.len(), 12 * 8 * 4);
            assert_eq!(&direct.bytes[4 * (12 * 2 + 2)..][..4], [0, 0, 0, 255], "an overlay of the old size waits");
        }
    }
}
