//! The overlay on a GPU: egui painted into a texture of its own, which the blit lays over every frame. Where the adapter
//! itself computes on the CPU, egui's shaders would take thirty milliseconds of it: there the texture is filled by
//! [`raster`](super::raster).

use super::blit::{BYTES, Blit};
use super::raster::Raster;
use super::{PaintJob, PixelRect};
use crate::app::gpu::Gpu;
use egui::TexturesDelta;
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

/// A painter of egui's triangles and the texture it paints.
pub struct GpuOverlay {
    painter: Painter,
    canvas: Option<Canvas>,
    used: Option<PixelRect>,
}

enum Painter {
    Shaders(Box<Renderer>),
    /// The bytes are those of the last upload, kept for their memory.
    Memory(Raster, Vec<u8>),
}

struct Canvas {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    bind_group: wgpu::BindGroup,
}

impl GpuOverlay {
    /// Nothing painted yet.
    pub fn new(gpu: &Gpu) -> Self {
        if gpu.is_software {
            return Self { painter: Painter::Memory(Raster::default(), Vec::new()), canvas: None, used: None };
        }
        // Flat colours do not band, and undithered the picture is the same whichever way it is shown.
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let renderer = Box::new(Renderer::new(&gpu.device, BYTES, options));
        Self { painter: Painter::Shaders(renderer), canvas: None, used: None }
    }

    /// Paints `job` over nothing.
    pub fn paint(&mut self, gpu: &Gpu, blit: &Blit, job: &PaintJob, textures: &mut TexturesDelta) {
        self.used = job.used_pixels();
        let fits = |canvas: &Canvas| [canvas.texture.width(), canvas.texture.height()] == job.size;
        let canvas = match self.canvas.take().filter(fits) {
            Some(canvas) => Some(canvas),
            None => self.used.map(|_| Canvas::new(gpu, blit, job.size)),
        };
        match &mut self.painter {
            Painter::Shaders(renderer) => {
                for (id, deltas) in textures.set.drain() {
                    for delta in deltas {
                        renderer.update_texture(&gpu.device, &gpu.queue, id, &delta);
                    }
                }
                if let (Some(canvas), true) = (&canvas, self.used.is_some()) {
                    canvas.paint(gpu, renderer, job);
                }
                for id in textures.free.drain() {
                    renderer.free_texture(&id);
                }
            }
            Painter::Memory(raster, bytes) => {
                raster.set_textures(textures);
                raster.paint(job);
                raster.free_textures(textures);
                if let (Some(canvas), Some(used)) = (&canvas, self.used) {
                    canvas.upload(gpu, raster, used, bytes);
                }
            }
        }
        self.canvas = canvas;
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
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let bind_group = blit.bind(&gpu.device, &view);
        Self { texture, view, bind_group }
    }

    /// Paints `job` over nothing.
    fn paint(&self, gpu: &Gpu, renderer: &mut Renderer, job: &PaintJob) {
        let screen = ScreenDescriptor { size_in_pixels: job.size, pixels_per_point: job.pixels_per_point };
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let callbacks = renderer.update_buffers(&gpu.device, &gpu.queue, &mut encoder, &job.primitives, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("overlay"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        renderer.render(&mut pass.forget_lifetime(), &job.primitives, &screen);
        gpu.queue.submit(callbacks.into_iter().chain([encoder.finish()]));
    }

    /// Fills the part that is `used` with what was painted in memory.
    fn upload(&self, gpu: &Gpu, raster: &Raster, used: PixelRect, bytes: &mut Vec<u8>) {
        let [left, top, width, height] = used;
        bytes.clear();
        for y in top..top + height {
            let row = &raster.row(y)[left as usize..(left + width) as usize];
            bytes.extend(row.iter().flat_map(|color| color.to_array()));
        }
        let origin = wgpu::Origin3d { x: left, y: top, z: 0 };
        let place = wgpu::TexelCopyTextureInfo { origin, ..self.texture.as_image_copy() };
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
        gpu.queue.write_texture(place, bytes, layout, wgpu::Extent3d { width, height, depth_or_array_layers: 1 });
    }
}
