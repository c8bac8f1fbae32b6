//! Showing: the newest frame and the overlay over it, on the window's surface.
//!
//! Two ways. With a GPU, both are textures and `shaders/blit.wgsl` joins them ([`blit`], [`gpu_overlay`]). Where the
//! adapter itself computes on the CPU, both are joined in memory and copied to the surface ([`direct`], [`raster`]):
//! the same picture for a fraction of the time, which the tracer gets instead.

pub mod blit;
mod direct;
mod gpu_overlay;
pub mod raster;

use super::gpu::Gpu;
use crate::render::Film;
use crate::settings::Present;
use blit::Blit;
use direct::Direct;
use egui::ClippedPrimitive;
use egui::epaint::Primitive;
use gpu_overlay::GpuOverlay;

/// A part of a picture in pixels: left, top, width, height.
pub type PixelRect = [u32; 4];

/// An overlay that is ready to be painted.
#[derive(Clone, Debug)]
pub struct PaintJob {
    /// Triangles in points, with their clip rectangles.
    pub primitives: Vec<ClippedPrimitive>,
    /// Size of the picture in pixels.
    pub size: [u32; 2],
    /// Pixels in a point.
    pub pixels_per_point: f32,
}

impl PaintJob {
    /// The least rectangle of pixels that holds everything painted.
    pub fn used_pixels(&self) -> Option<PixelRect> {
        let mut used = egui::Rect::NOTHING;
        for job in &self.primitives {
            if let Primitive::Mesh(mesh) = &job.primitive {
                used = used.union(mesh.calc_bounds().intersect(job.clip_rect));
            }
        }
        let rect = self.pixel_rect(used, f32::floor, f32::ceil);
        (rect[2] > 0 && rect[3] > 0).then_some(rect)
    }

    /// A clip rectangle in pixels.
    pub fn clip_pixels(&self, clip: egui::Rect) -> PixelRect {
        self.pixel_rect(clip, f32::round, f32::round)
    }

    fn pixel_rect(&self, rect: egui::Rect, least: fn(f32) -> f32, end: fn(f32) -> f32) -> PixelRect {
        let [width, height] = self.size;
        let scaled = |points: f32| points * self.pixels_per_point;
        let (left, top) = (least(scaled(rect.min.x)).max(0.0) as u32, least(scaled(rect.min.y)).max(0.0) as u32);
        let (right, bottom) = (end(scaled(rect.max.x)).max(0.0) as u32, end(scaled(rect.max.y)).max(0.0) as u32);
        let (left, top) = (left.min(width), top.min(height));
        [left, top, right.clamp(left, width) - left, bottom.clamp(top, height) - top]
    }
}

/// One of the two ways, set up, and the frame it shows.
pub struct Presenter {
    way: Way,
    frame: Option<Film>,
    /// The part of the surface that the frame fills.
    place: PixelRect,
}

enum Way {
    /// Textures joined by a shader.
    Blit(Box<(Blit, GpuOverlay)>),
    /// Memory joined by the CPU.
    Direct(Box<Direct>),
}

impl Presenter {
    /// Sets `present` up; what the surface cannot be copied to is blitted to.
    pub fn new(gpu: &Gpu, present: Present) -> Self {
        let direct = match present {
            Present::Auto => gpu.is_software,
            Present::Blit => false,
            Present::Direct => true,
        };
        if direct && let Some(direct) = Direct::new(gpu) {
            return Self { way: Way::Direct(Box::new(direct)), frame: None, place: whole(gpu.size()) };
        }
        let blit = Blit::new(&gpu.device, gpu.format());
        Self { way: Way::Blit(Box::new((blit, GpuOverlay::new(gpu)))), frame: None, place: whole(gpu.size()) }
    }

    /// The part of the surface that frames fill.
    pub fn place(&self) -> PixelRect {
        self.place
    }

    /// Has frames fill another part of the surface.
    pub fn set_place(&mut self, place: PixelRect) {
        self.place = place;
    }

    /// The frame on display, without the overlay.
    pub fn frame(&self) -> Option<&Film> {
        self.frame.as_ref()
    }

    /// Shows `film` from the next drawing on. Returns the film that was shown before.
    pub fn set_frame(&mut self, gpu: &Gpu, film: Film) -> Option<Film> {
        if let Way::Blit(both) = &mut self.way {
            both.0.upload(&gpu.device, &gpu.queue, film.width(), film.height(), film.rgba());
        }
        self.frame.replace(film)
    }

    /// Shows the overlay `job` from the next drawing on.
    pub fn set_overlay(&mut self, gpu: &Gpu, job: &PaintJob, mut textures: egui::TexturesDelta) {
        match &mut self.way {
            Way::Blit(both) => {
                let (blit, overlay) = both.as_mut();
                overlay.paint(gpu, blit, job, &mut textures);
            }
            Way::Direct(direct) => direct.set_overlay(job, &mut textures),
        }
    }

    /// Draws and presents.
    pub fn show(&mut self, gpu: &Gpu, target: wgpu::SurfaceTexture) {
        let place = within(self.place, (target.texture.width(), target.texture.height()));
        match &mut self.way {
            Way::Blit(both) => {
                let (blit, overlay) = both.as_ref();
                let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                blit.draw(&mut encoder, &target.texture, place, overlay.picture(gpu.size()));
                gpu.present(Some(encoder.finish()), target);
            }
            Way::Direct(direct) => {
                direct.write(self.frame.as_ref(), place, &gpu.queue, &target.texture);
                gpu.present(None, target);
            }
        }
    }
}

fn whole((width, height): (u32, u32)) -> PixelRect {
    [0, 0, width, height]
}

/// `place` where it lies within a surface of `size`, else all of that: the window has just changed its size.
fn within(place: PixelRect, size: (u32, u32)) -> PixelRect {
    let [left, top, width, height] = place.map(u64::from);
    let fits = width > 0 && height > 0 && left + width <= u64::from(size.0) && top + height <= u64::from(size.1);
    if fits { place } else { whole(size) }
}

#[cfg(test)]
mod tests {
    use super::within;

    #[test]
    fn a_place_that_the_surface_has_no_more_is_all_of_it() {
        assert_eq!(within([360, 0, 920, 720], (1280, 720)), [360, 0, 920, 720]);
        assert_eq!(within([360, 0, 920, 720], (1279, 720)), [0, 0, 1279, 720]);
        assert_eq!(within([0, 0, 0, 0], (64, 36)), [0, 0, 64, 36]);
        assert_eq!(within([u32::MAX, 0, u32::MAX, 1], (64, 36)), [0, 0, 64, 36]);
    }
}
