//! The blit: the traced frame and the overlay, through `shaders/blit.wgsl` onto a target, in one render pass.

use super::PixelRect;

/// What both textures hold: sRGB-encoded bytes, passed on as they are.
pub const BYTES: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Pipelines and textures of the blit.
#[derive(Debug)]
pub struct Blit {
    exact: wgpu::RenderPipeline,
    scaled: wgpu::RenderPipeline,
    overlay: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    frame: Option<(wgpu::Texture, wgpu::BindGroup)>,
}

impl Blit {
    /// Pipelines for targets of `format`; sRGB formats are served too.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let shader = device.create_shader_module(wgpu::include_wgsl!("../../../shaders/blit.wgsl"));
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("picture"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 1,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
            ],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("blit"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = |entry_point: &str, blend: Option<wgpu::BlendState>| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some("cover"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: None,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(entry_point),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &[("target_encodes", f64::from(u8::from(format.is_srgb())))],
                        ..Default::default()
                    },
                    targets: &[Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self {
            exact: pipeline("frame_exact", None),
            scaled: pipeline("frame_scaled", None),
            overlay: pipeline("overlay", Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING)),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("picture"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            layout,
            frame: None,
        }
    }

    /// Uploads a frame of `width` x `height` sRGB-encoded RGBA pixels, row by row from the top.
    pub fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, width: u32, height: u32, rgba: &[u8]) {
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        if self.frame.as_ref().is_none_or(|(texture, _)| texture.size() != size) {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("frame"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: BYTES,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            });
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            self.frame = Some((texture, self.bind(device, &view)));
        }
        if let Some((texture, _)) = &self.frame {
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
            queue.write_texture(texture.as_image_copy(), rgba, layout, size);
        }
    }

    /// Makes a texture ready to be drawn as the overlay: of the target's size, colours premultiplied.
    pub fn bind(&self, device: &wgpu::Device, view: &wgpu::TextureView) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("picture"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
            ],
        })
    }

    /// Records the pass: the frame over its `place` on the `target`, which is black elsewhere, and the overlay over its own
    /// part only.
    pub fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::Texture,
        place: PixelRect,
        overlay: Option<(&wgpu::BindGroup, PixelRect)>,
    ) {
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("blit"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        if let Some((texture, bind_group)) = &self.frame {
            let [left, top, width, height] = place;
            let fits = (texture.width(), texture.height()) == (width, height);
            pass.set_viewport(left as f32, top as f32, width as f32, height as f32, 0.0, 1.0);
            pass.set_scissor_rect(left, top, width, height);
            pass.set_pipeline(if fits { &self.exact } else { &self.scaled });
            pass.set_bind_group(0, bind_group, &[]);
            pass.draw(0..3, 0..1);
        }
        if let Some((bind_group, [left, top, width, height])) = overlay {
            pass.set_viewport(0.0, 0.0, target.width() as f32, target.height() as f32, 0.0, 1.0);
            pass.set_pipeline(&self.overlay);
            pass.set_bind_group(0, bind_group, &[]);
            pass.set_scissor_rect(left, top, width, height);
            pass.draw(0..3, 0..1);
        }
    }
}
