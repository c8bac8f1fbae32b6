//! egui and its window: events in, triangles out.

use super::gpu::Gpu;
use super::present::PaintJob;
use std::time::Duration;
use winit::event::WindowEvent;
use winit::window::Window;

/// Windows smaller than this, in points, get no overlay: egui would squeeze its own windows for good.
const LEAST_SIZE: f32 = 48.0;

/// What a run of the overlay gave.
pub struct Painting {
    /// What to paint.
    pub job: PaintJob,
    /// Textures to set before painting and to free after it.
    pub textures: egui::TexturesDelta,
    /// When it wants to be run again by itself, if ever.
    pub again: Option<Duration>,
}

/// egui and what it knows of the window.
pub struct Layer {
    context: egui::Context,
    state: egui_winit::State,
    /// The pointer was over the overlay at its last movement.
    pointed_at: bool,
}

impl Layer {
    /// An empty layer for `window`, everything `ui_scale` times as large as usual.
    pub fn new(gpu: &Gpu, window: &Window, ui_scale: f32) -> Self {
        let context = egui::Context::default();
        // The keys for it are ours, so that they are told of and kept.
        context.options_mut(|options| options.zoom_with_keyboard = false);
        context.set_zoom_factor(ui_scale);
        super::overlay::theme::apply(&context);
        if gpu.is_software {
            // Every step of an animation would be paid for by the tracer.
            context.all_styles_mut(|style| style.animation_time = 0.0);
        }
        let max_side = usize::try_from(gpu.max_side()).ok();
        let scale = Some(window.scale_factor() as f32);
        let state =
            egui_winit::State::new(context.clone(), egui::ViewportId::ROOT, window, scale, window.theme(), max_side);
        Self { context, state, pointed_at: false }
    }

    /// Everything `ui_scale` times as large as usual, on top of what the display asks for.
    pub fn set_scale(&self, ui_scale: f32) {
        self.context.set_zoom_factor(ui_scale);
    }

    /// Tells egui of a window event; true when the overlay must be drawn anew.
    pub fn on_event(&mut self, window: &Window, event: &WindowEvent) -> bool {
        let repaint = self.state.on_window_event(window, event).repaint;
        match event {
            // Over the bare picture nothing lights up: drawing for every movement there would be for nothing.
            WindowEvent::CursorMoved { .. } => {
                let over = self.is_under_pointer();
                let changed = over || self.pointed_at || self.context.egui_is_using_pointer();
                self.pointed_at = over;
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
        self.pointed_at = false;
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

    /// Puts a text on the clipboard.
    pub fn copy(&mut self, text: String) {
        self.state.set_clipboard_text(text);
    }

    /// The text on the clipboard, if there is one.
    pub fn pasted(&mut self) -> Option<String> {
        self.state.clipboard_text()
    }

    /// Whether the overlay is being used with the pointer.
    pub fn is_pointed_at(&self) -> bool {
        self.pointed_at
    }

    /// Whether a click now is the overlay's: on it, or anywhere while a menu waits to be closed.
    pub fn takes_click(&self) -> bool {
        self.is_under_pointer() || egui::Popup::is_any_open(&self.context)
    }

    /// Whether keys are the overlay's: text is being typed, or a menu is open.
    pub fn takes_keys(&self) -> bool {
        self.context.text_edit_focused() || egui::Popup::is_any_open(&self.context)
    }

    /// Runs the overlay at the surface's `size`. `None` where the window is too small for one.
    pub fn run(
        &mut self,
        size: (u32, u32),
        window: &Window,
        pointer_is_free: bool,
        add_contents: impl FnMut(&mut egui::Ui),
    ) -> Option<Painting> {
        let least = LEAST_SIZE * window.scale_factor() as f32 * self.context.zoom_factor();
        if (size.0 as f32) < least || (size.1 as f32) < least {
            return None;
        }
        let input = self.state.take_egui_input(window);
        let output = self.context.run_ui(input, add_contents);
        if pointer_is_free {
            // While the pointer is captured its looks are not egui's to decide.
            self.state.handle_platform_output(window, output.platform_output);
        }
        let pixels_per_point = output.pixels_per_point;
        let primitives = self.context.tessellate(output.shapes, pixels_per_point);
        let delay = output.viewport_output.get(&egui::ViewportId::ROOT).map(|viewport| viewport.repaint_delay);
        Some(Painting {
            job: PaintJob { primitives, size: size.into(), pixels_per_point },
            textures: output.textures_delta,
            again: delay.filter(|&delay| delay < Duration::from_secs(3600)),
        })
    }
}
