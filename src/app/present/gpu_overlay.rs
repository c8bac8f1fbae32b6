//! The overlay on a GPU: egui painted into a texture of its own, which the blit lays over every frame.

use super::blit::{BYTES, Blit};
use super::{PaintJob, PixelRect};
use crate::app::gpu::Gpu;
use egui::TexturesDelta;
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

/// egui's painter and the texture it paints.
pub struct GpuOverlay {
    renderer: Renderer,
    canvas: Option<Canvas>,
    used: Option<PixelRect>,
}

struct Canvas {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    bind_group: wgpu::BindGroup,
}

impl GpuOverlay {
    /// Nothing painted yet.
    pub fn new(gpu: &Gpu) -> Self {
        // Flat colours do not band, and undithered the picture is the same whichever way it is shown.
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        Self { renderer: Renderer::new(&gpu.device, BYTES, options), canvas: None, used: None }
    }

    /// Paints `job` over nothing.
    pub fn paint(&mut self, gpu: &Gpu, blit: &Blit, job: &PaintJob, textures: &mut TexturesDelta) {
        for (id, deltas) in textures.set.drain() {
            for delta in deltas {
                self.renderer.update_texture(&gpu.device, &gpu.queue, id, &delta);
            }
        }
        self.used = job.used_pixels();
        if self.used.is_some() {
            self.paint_canvas(gpu, blit, job);
        }
        for id in textures.free.drain() {
            self.renderer.free_texture(&id);
        }
    }

    fn paint_canvas(&mut self, gpu: &Gpu, blit: &Blit, job: &PaintJob) {
        let fits = |canvas: &Canvas| [canvas.texture.width(), canvas.texture.height()] == job.size;
        let canvas = match self.canvas.take().filter(fits) {
            Some(canvas) => canvas,
            None => Canvas::new(gpu, blit, job.size),
        };
        let screen = ScreenDescriptor { size_in_pixels: job.size, pixels_per_point: job.pixels_per_point };
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let callbacks = self.renderer.update_buffers(&gpu.device, &gpu.queue, &mut encoder, &job.primitives, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("overlay"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &canvas.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        self.renderer.render(&mut pass.forget_lifetime(), &job.primitives, &screen);
        gpu.queue.submit(callbacks.into_iter().chain([encoder.finish()]));
        self.canvas = Some(canvas);
    }

    /// What to lay over a target of `size`, if anything: between a change of size and the next painting, the old
    /// overlay would lie at the wrong place.
    pub fn picture(&self, size: (u32, u32)) -> Option<(&wgpu::BindGroup, PixelRect)> {
        let canvas = self.canvas.as_ref()?;
        let fits = (canvas.texture.width(), canvas.texture.height()) == size;
        fits.then_some((&canvas.bind_group, self.used?))
    }
}

impl Canvas {
    fn new(gpu: &Gpu, blit: &Blit, [width, height]: [u32; 2]) -> Self {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("overlay"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: BYTES,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let bind_group = blit.bind(&gpu.device, &view);
        Self { texture, view, bind_group }
    }
}
