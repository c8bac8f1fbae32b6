//! Frame and overlay joined in memory and copied to the surface: no shader runs.

use super::raster::{Raster, over};
use super::{PaintJob, PixelRect};
use crate::app::gpu::Gpu;
use crate::render::Film;
use egui::{Color32, TexturesDelta};

/// The picture on its way to the surface.
#[derive(Debug)]
pub struct Direct {
    /// The surface stores blue first.
    swaps: bool,
    overlay: Raster,
    cover: Cover,
    /// What was shown last. Pixels that the overlay hides stay from one frame to the next.
    bytes: Vec<u8>,
    /// Whether the overlay's own pixels are there.
    has_overlay: bool,
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
        Self { swaps, overlay: Raster::default(), cover: Cover::default(), bytes: Vec::new(), has_overlay: false }
    }

    /// Paints the overlay to show.
    pub fn set_overlay(&mut self, job: &PaintJob, textures: &mut TexturesDelta) {
        self.overlay.set_textures(textures);
        self.overlay.paint(job);
        self.overlay.free_textures(textures);
        self.cover.see(&self.overlay);
        self.has_overlay = false;
    }

    /// Joins `frame` at its `place` and the overlay at the size of `target` and copies them there.
    pub fn write(&mut self, frame: Option<&Film>, place: PixelRect, queue: &wgpu::Queue, target: &wgpu::Texture) {
        let (width, height) = (target.width(), target.height());
        self.join(frame, place, width, height);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
        queue.write_texture(target.as_image_copy(), &self.bytes, layout, target.size());
    }

    /// Fills `bytes` in the surface's order; black before the first frame and beside its place.
    fn join(&mut self, frame: Option<&Film>, place: PixelRect, width: u32, height: u32) {
        // The order is chosen out here, so that the loops over pixels know it.
        if self.swaps {
            self.join_ordered(frame, place, [width, height], swapped);
        } else {
            self.join_ordered(frame, place, [width, height], |rgba| rgba);
        }
    }

    fn join_ordered(
        &mut self,
        frame: Option<&Film>,
        place: PixelRect,
        [width, height]: [u32; 2],
        order: impl Fn(Pixel) -> Pixel,
    ) {
        let size = width as usize * height as usize * 4;
        // An overlay of another size waits for the one of this.
        let is_of_this_size = self.overlay.size() == [width, height];
        self.has_overlay &= is_of_this_size && self.bytes.len() == size;
        self.bytes.resize(size, 0);
        for (y, row) in (0..height).zip(self.bytes.as_chunks_mut().0.chunks_exact_mut(width as usize)) {
            let source = frame.and_then(|film| FilmRow::new(film, y, place));
            let copy = |pixels: &mut [Pixel], start: usize| match &source {
                Some(source) => source.copy(pixels, start, |[r, g, b, _]| order([r, g, b, 255])),
                None => pixels.fill([0; 4]),
            };
            let mut copied = 0;
            for span in self.cover.row(y).iter().filter(|_| is_of_this_size) {
                let (start, end) = (span.start as usize, span.end as usize);
                let overlay = self.overlay.row(y)[start..end].iter().map(|color| order(color.to_array()));
                if span.is_opaque {
                    copy(&mut row[copied..start], copied);
                    if !self.has_overlay {
                        row[start..end].iter_mut().zip(overlay).for_each(|(pixel, color)| *pixel = color);
                    }
                } else {
                    copy(&mut row[copied..end], copied);
                    row[start..end].iter_mut().zip(overlay).for_each(|(pixel, color)| *pixel = over(color, *pixel));
                }
                copied = end;
            }
            copy(&mut row[copied..], copied);
        }
        self.has_overlay = is_of_this_size;
    }
}

/// One pixel, four channels with alpha last.
type Pixel = [u8; 4];

/// Pixels side by side that the overlay shows something of itself on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Span {
    start: u32,
    end: u32,
    /// Nothing of the frame shows through.
    is_opaque: bool,
}

/// Where the overlay covers the frame, row by row: looked for once an overlay, and not in every frame.
#[derive(Debug, Default)]
struct Cover {
    spans: Vec<Span>,
    /// Where each row's spans end.
    ends: Vec<usize>,
}

impl Cover {
    /// Takes note of what `overlay` covers.
    fn see(&mut self, overlay: &Raster) {
        self.spans.clear();
        self.ends.clear();
        let [left, top, width, height] = overlay.used().unwrap_or_default();
        self.ends.resize(top as usize, 0);
        for y in top..top + height {
            let row = &overlay.row(y)[left as usize..][..width as usize];
            let mut start = left;
            for same in row.chunk_by(|a, b| kind(*a) == kind(*b)) {
                let end = start + same.len() as u32;
                if let Some(is_opaque) = kind(same[0]) {
                    self.spans.push(Span { start, end, is_opaque });
                }
                start = end;
            }
            self.ends.push(self.spans.len());
        }
    }

    /// The spans of a row, from left to right.
    fn row(&self, y: u32) -> &[Span] {
        let end_of = |row: Option<usize>| row.and_then(|row| self.ends.get(row)).copied();
        let end = end_of(Some(y as usize)).unwrap_or(0);
        &self.spans[end_of((y as usize).checked_sub(1)).unwrap_or(0).min(end)..end]
    }
}

/// Whether a pixel of the overlay hides what is below it; `None` where there is nothing of it.
fn kind(color: Color32) -> Option<bool> {
    (color != Color32::TRANSPARENT).then(|| color.a() == 255)
}

/// A row of the picture; of a film of another size, each pixel is the nearest one.
struct FilmRow<'a> {
    pixels: &'a [Pixel],
    /// Where it begins, and how long it is.
    left: usize,
    width: usize,
}

impl<'a> FilmRow<'a> {
    /// Row `y` of a surface on which the picture has this `place`; `None` above and below it.
    fn new(film: &'a Film, y: u32, [left, top, width, height]: PixelRect) -> Option<Self> {
        let y = y.checked_sub(top).filter(|y| *y < height)?;
        let row = scaled(y as usize, film.height(), height as usize);
        let pixels = &film.rgba().as_chunks().0[row * film.width() as usize..][..film.width() as usize];
        Some(Self { pixels, left: left as usize, width: width as usize })
    }

    /// Copies the pixels of the surface from `start` on; those beside the picture are black.
    fn copy(&self, pixels: &mut [Pixel], start: usize, order: impl Fn(Pixel) -> Pixel) {
        let end = start + pixels.len();
        let [from, to] = [self.left, self.left + self.width].map(|edge| edge.clamp(start, end) - start);
        pixels[..from].fill([0; 4]);
        pixels[to..].fill([0; 4]);
        let pixels = &mut pixels[from..to];
        if pixels.is_empty() {
            return;
        }
        let start = start + from - self.left;
        if self.pixels.len() == self.width {
            for (pixel, &source) in pixels.iter_mut().zip(&self.pixels[start..]) {
                *pixel = order(source);
            }
        } else {
            for (x, pixel) in (start..).zip(pixels) {
                *pixel = order(self.pixels[scaled(x, self.pixels.len() as u32, self.width)]);
            }
        }
    }
}

/// The nearest of `from` places to place `at` of `to`.
fn scaled(at: usize, from: u32, to: usize) -> usize {
    at * from as usize / to
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
    use crate::math::random::SplitMix64;
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
            direct.join(Some(&film), [0, 0, 6, 4], 6, 4);
            let pixel = |x: usize, y: usize| &direct.bytes[4 * (6 * y + x)..][..4];
            assert_eq!(pixel(2, 2), if swaps { [10, 20, 200, 255] } else { [200, 20, 10, 255] });
            assert_eq!(pixel(0, 0), [0, 0, 0, 255], "a new film is black");
            assert_eq!(pixel(3, 2), [0, 0, 0, 255]);
            direct.join(Some(&film), [0, 0, 12, 8], 12, 8);
            assert_eq!(direct.bytes.len(), 12 * 8 * 4);
            assert_eq!(&direct.bytes[4 * (12 * 2 + 2)..][..4], [0, 0, 0, 255], "an overlay of the old size waits");
        }
    }
    /// An overlay of some rectangles, some of them see-through.
    fn overlay(random: &mut SplitMix64, size: [u32; 2]) -> PaintJob {
        let mut mesh = Mesh::default();
        for _ in 0..random.within(0.0, 5.0) as usize {
            let mut at = |most: u32| random.within(-2.0, f64::from(most)) as f32;
            let (corner, extent) = (pos2(at(size[0]), at(size[1])), vec2(at(size[0]), at(size[1])));
            let level = random.within(0.0, 200.0) as u8;
            let alpha = if random.within(0.0, 1.0) < 0.5 { 255 } else { level };
            let color = Color32::from_rgba_premultiplied(level, level / 2, level / 3, alpha);
            mesh.add_colored_rect(Rect::from_min_size(corner, extent), color);
        }
        let primitive = ClippedPrimitive { clip_rect: Rect::EVERYTHING, primitive: Primitive::Mesh(mesh) };
        PaintJob { primitives: vec![primitive], size, pixels_per_point: 1.0 }
    }

    fn film(random: &mut SplitMix64, [width, height]: [u32; 2]) -> Film {
        let mut film = Film::new(width, height, Planes::default());
        film.paint(|_, _, _, _| [0; 3].map(|_| random.within(0.0, 256.0) as u8));
        film
    }

    #[test]
    fn any_run_of_frames_overlays_and_sizes_is_joined_as_pixel_by_pixel() {
        let mut random = SplitMix64(11);
        let mut textures = TexturesDelta::default();
        let white = ColorImage::filled([1, 1], Color32::WHITE);
        textures.push(TextureId::default(), ImageDelta::full(white, TextureOptions::LINEAR));
        let mut direct = Direct::with_order(true);
        // Two of them have as many pixels.
        let sizes = [[24, 10], [12, 20], [17, 9]];
        let (mut size, mut frame) = (sizes[0], None);
        for step in 0..400 {
            match random.within(0.0, 5.0) as u32 {
                0 => size = sizes[random.within(0.0, 3.0) as usize],
                1 => direct.set_overlay(&overlay(&mut random, size), &mut textures),
                _ => {
                    let size = sizes[random.within(0.0, 3.0) as usize];
                    frame = Some(film(&mut random, size));
                }
            }
            let [width, height] = size;
            // All of the surface, or what is right of a panel.
            let left = if random.within(0.0, 1.0) < 0.5 { 0 } else { random.within(1.0, f64::from(width)) as u32 };
            direct.join(frame.as_ref(), [left, 0, width - left, height], width, height);
            for (at, pixel) in direct.bytes.as_chunks::<4>().0.iter().enumerate() {
                let (x, y) = (at % width as usize, at / width as usize);
                let film = frame.as_ref().filter(|_| x >= left as usize);
                let mut expected = film.map_or([0; 4], |film| {
                    let place = |at: usize, from: u32, to: u32| at * from as usize / to as usize;
                    let column = place(x - left as usize, film.width(), width - left);
                    let row = place(y, film.height(), height);
                    let [r, g, b, _] = film.rgba().as_chunks().0[row * film.width() as usize + column];
                    swapped([r, g, b, 255])
                });
                if direct.overlay.size() == size {
                    expected = over(swapped(direct.overlay.row(y as u32)[x].to_array()), expected);
                }
                assert_eq!(*pixel, expected, "pixel {x}, {y} of step {step}");
            }
        }
    }
}
