//! The overlay's layer: egui drawn into a texture of its own, which the blit lays over every frame.
//!
//! On a software adapter egui costs more than the blit. Cached like this it is drawn when it changes,
//! not whenever a frame is shown.

use super::blit::{BYTES, Blit, PixelRect};
use super::gpu::Gpu;
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
use std::time::Duration;
use winit::event::WindowEvent;
use winit::window::Window;

/// Windows smaller than this, in points, get no overlay: egui would squeeze its own windows for good.
const LEAST_SIZE: f32 = 48.0;

/// egui, its painter and the texture it paints.
pub struct Layer {
    context: egui::Context,
    state: egui_winit::State,
    renderer: Renderer,
    canvas: Option<Canvas>,
    /// The part of the canvas that shows anything.
    used: Option<PixelRect>,
    /// The pointer was over the overlay at its last movement.
    was_over: bool,
}

struct Canvas {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    bind_group: wgpu::BindGroup,
}

impl Layer {
    /// An empty layer for `window`.
    pub fn new(gpu: &Gpu, window: &Window) -> Self {
        let context = egui::Context::default();
        super::overlay::theme::apply(&context);
        if gpu.is_software {
            // Soft edges double the number of triangles.
            context.tessellation_options_mut(|options| options.feathering = false);
            context.all_styles_mut(|style| style.animation_time = 0.0);
        }
        let max_side = usize::try_from(gpu.max_side()).ok();
        let scale = Some(window.scale_factor() as f32);
        let state =
            egui_winit::State::new(context.clone(), egui::ViewportId::ROOT, window, scale, window.theme(), max_side);
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let renderer = Renderer::new(&gpu.device, BYTES, options);
        Self { context, state, renderer, canvas: None, used: None, was_over: false }
    }

    /// Tells egui of a window event; true when the overlay must be drawn anew.
    pub fn on_event(&mut self, window: &Window, event: &WindowEvent) -> bool {
        let repaint = self.state.on_window_event(window, event).repaint;
        match event {
            // Over the bare picture nothing lights up: drawing for every movement there would be for nothing.
            WindowEvent::CursorMoved { .. } => {
                let over = self.is_under_pointer();
                let changed = over || self.was_over || self.context.egui_is_using_pointer();
                self.was_over = over;
                repaint && changed
            }
            WindowEvent::RedrawRequested => false,
            _ => repaint,
        }
    }

    /// Mouse and keys go to the picture: nothing of the overlay is pointed at or typed into any more.
    pub fn let_go(&mut self) {
        self.context.memory_mut(|memory| {
            if let Some(id) = memory.focused() {
                memory.surrender_focus(id);
            }
        });
        self.state.egui_input_mut().events.push(egui::Event::PointerGone);
        self.was_over = false;
    }

    /// Whether the pointer is over the overlay, asked of where it really is: egui's own answer is one pass old.
    pub fn is_under_pointer(&self) -> bool {
        let events = &self.state.egui_input().events;
        let moved = events.iter().rev().find_map(|event| match event {
            egui::Event::PointerMoved(position) => Some(Some(*position)),
            egui::Event::PointerGone => Some(None),
            _ => None,
        });
        let position = moved.unwrap_or_else(|| self.context.input(|input| input.pointer.latest_pos()));
        position
            .and_then(|position| self.context.layer_id_at(position))
            .is_some_and(|layer| layer.order != egui::Order::Background)
    }

    /// Whether a click now is the overlay's: on it, or anywhere while a menu waits to be closed.
    pub fn takes_click(&self) -> bool {
        self.is_under_pointer() || egui::Popup::is_any_open(&self.context)
    }

    /// Whether text is being typed.
    pub fn wants_keyboard(&self) -> bool {
        self.context.egui_wants_keyboard_input()
    }

    /// Runs and paints the overlay. Returns when it wants to be painted again by itself; `None` for not at all.
    pub fn paint(
        &mut self,
        gpu: &Gpu,
        blit: &Blit,
        window: &Window,
        pointer_is_ours: bool,
        add_contents: impl FnMut(&mut egui::Ui),
    ) -> Option<Duration> {
        let (width, height) = gpu.size();
        let least = LEAST_SIZE * window.scale_factor() as f32;
        if (width as f32) < least || (height as f32) < least {
            self.used = None;
            return None;
        }
        let input = self.state.take_egui_input(window);
        let mut output = self.context.run_ui(input, add_contents);
        if pointer_is_ours {
            // While the pointer is captured its looks are not egui's to decide.
            self.state.handle_platform_output(window, output.platform_output);
        }
        let screen = ScreenDescriptor { size_in_pixels: [width, height], pixels_per_point: output.pixels_per_point };
        let jobs = self.context.tessellate(output.shapes, output.pixels_per_point);
        self.used = used_pixels(&jobs, &screen);
        for (id, deltas) in output.textures_delta.set.drain() {
            for delta in deltas {
                self.renderer.update_texture(&gpu.device, &gpu.queue, id, &delta);
            }
        }
        if self.used.is_some() {
            self.paint_jobs(gpu, blit, &jobs, &screen);
        }
        for id in output.textures_delta.free.drain() {
            self.renderer.free_texture(&id);
        }
        let delay = output.viewport_output.get(&egui::ViewportId::ROOT).map(|viewport| viewport.repaint_delay);
        delay.filter(|&delay| delay < Duration::from_secs(3600))
    }

    fn paint_jobs(&mut self, gpu: &Gpu, blit: &Blit, jobs: &[egui::ClippedPrimitive], screen: &ScreenDescriptor) {
        let [width, height] = screen.size_in_pixels;
        let fits = |canvas: &Canvas| (canvas.texture.width(), canvas.texture.height()) == (width, height);
        if !self.canvas.as_ref().is_some_and(fits) {
            self.canvas = Some(Canvas::new(gpu, blit, width, height));
        }
        let Some(canvas) = &self.canvas else { return };
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let callbacks = self.renderer.update_buffers(&gpu.device, &gpu.queue, &mut encoder, jobs, screen);
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
        self.renderer.render(&mut pass.forget_lifetime(), jobs, screen);
        gpu.queue.submit(callbacks.into_iter().chain([encoder.finish()]));
    }

    /// What to lay over the frame, if anything.
    pub fn picture(&self, gpu: &Gpu) -> Option<(&wgpu::BindGroup, PixelRect)> {
        let canvas = self.canvas.as_ref()?;
        // Between a change of size and the next painting, the old overlay would lie at the wrong place.
        ((canvas.texture.width(), canvas.texture.height()) == gpu.size()).then_some((&canvas.bind_group, self.used?))
    }
}

impl Canvas {
    fn new(gpu: &Gpu, blit: &Blit, width: u32, height: u32) -> Self {
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

/// The least rectangle that holds everything painted: the rest of the layer is transparent.
fn used_pixels(jobs: &[egui::ClippedPrimitive], screen: &ScreenDescriptor) -> Option<PixelRect> {
    let mut used = egui::Rect::NOTHING;
    for job in jobs {
        if let egui::epaint::Primitive::Mesh(mesh) = &job.primitive {
            used = used.union(mesh.calc_bounds().intersect(job.clip_rect));
        }
    }
    let [width, height] = screen.size_in_pixels;
    let scale = screen.pixels_per_point;
    let left = (used.min.x * scale).floor().max(0.0) as u32;
    let top = (used.min.y * scale).floor().max(0.0) as u32;
    let right = ((used.max.x * scale).ceil().max(0.0) as u32).min(width);
    let bottom = ((used.max.y * scale).ceil().max(0.0) as u32).min(height);
    (left < right && top < bottom).then(|| [left, top, right - left, bottom - top])
}
