//! Events of the window: who gets which.

use super::Session;
use crate::app::capture::{DragEnd, PointerHost};
use crate::app::error::AppError;
use crate::app::input::Command;
use crate::app::walker::speed_in_words;
use glam::DVec2;
use std::time::Instant;
use winit::dpi::PhysicalPosition;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::platform::modifier_supplement::KeyEventExtModifierSupplement;
use winit::window::{CursorGrabMode, Window};

/// Pixels of smooth scrolling that count as one notch of a wheel.
const PIXELS_PER_NOTCH: f64 = 40.0;
/// Logical pixels that the pointer may move during a click.
const SLOP: f64 = 4.0;

impl Session {
    /// Passes an event to whom it concerns; true to close the window.
    pub fn on_window_event(&mut self, event: &WindowEvent) -> Result<bool, AppError> {
        let now = Instant::now();
        match event {
            WindowEvent::RedrawRequested => {
                self.draw(now)?;
                return Ok(false);
            }
            WindowEvent::KeyboardInput { event: key, is_synthetic, .. } => {
                return Ok(self.on_key(now, key, *is_synthetic, event));
            }
            WindowEvent::CursorMoved { position, .. } => {
                self.pointer = DVec2::new(position.x, position.y);
                let host = WindowHost(&self.window);
                self.capture.drag_moved(&host, self.pointer, SLOP * self.window.scale_factor());
                let turn = self.capture.pointer_moved(&host, self.pointer);
                self.look(now, turn);
            }
            WindowEvent::MouseInput { state, button: MouseButton::Left, .. } if self.on_button(*state) => {
                return Ok(false);
            }
            WindowEvent::MouseInput { state, button: MouseButton::Right, .. } if self.on_right_button(*state) => {
                self.repaint(now);
                return Ok(false);
            }
            WindowEvent::MouseWheel { delta, .. } if self.capture.is_active() || !self.layer.is_under_pointer() => {
                self.walker.scroll(notches(*delta));
                self.notices.replace(now, format!("Speed {}", speed_in_words(self.walker.speed())));
                self.repaint(now);
                return Ok(false);
            }
            WindowEvent::ModifiersChanged(modifiers) => self.keys.set_ctrl(modifiers.state().control_key()),
            WindowEvent::Focused(false) => {
                self.step(now);
                self.keys.clear();
                self.capture.release(&WindowHost(&self.window));
            }
            WindowEvent::Resized(size) => {
                self.gpu.resize(*size);
                self.shown = self.shown.resized();
                self.presenter.set_place(self.free_area());
                self.keeper.touch(now);
                self.repaint(now);
            }
            WindowEvent::Moved(position) => self.keeper.window_moved(now, (position.x, position.y)),
            WindowEvent::Occluded(occluded) => self.occluded = *occluded,
            WindowEvent::DroppedFile(path) => self.scenes.drop_in(path.clone()),
            WindowEvent::HoveredFile(_) | WindowEvent::HoveredFileCancelled => {
                self.scenes.hover(matches!(event, WindowEvent::HoveredFile(_)));
                self.repaint(now);
            }
            _ => {}
        }
        let of_the_mouse = matches!(
            event,
            WindowEvent::CursorMoved { .. } | WindowEvent::MouseInput { .. } | WindowEvent::MouseWheel { .. }
        );
        if !(of_the_mouse && self.capture.is_active()) && self.layer.on_event(&self.window, event) {
            self.repaint(now);
        }
        Ok(false)
    }

    /// The mouse moved, in its own counts; concerns us while the pointer is locked.
    pub fn on_device_motion(&mut self, delta: DVec2) {
        let turn = self.capture.device_moved(delta);
        self.look(Instant::now(), turn);
    }

    pub(super) fn look(&mut self, now: Instant, counts: DVec2) {
        if counts != DVec2::ZERO {
            self.journey.stop_replay();
            self.first_move(now);
            self.walker.look(counts);
        }
    }

    /// True to close the window.
    pub(super) fn on_key(&mut self, now: Instant, key: &KeyEvent, is_synthetic: bool, event: &WindowEvent) -> bool {
        self.step(now);
        let of_overlay = self.layer.takes_keys() && !self.capture.is_active();
        let command = match key.state {
            ElementState::Released => {
                self.keys.release(key.physical_key);
                // Whoever saw a key go down should see it come up; that alone changes no looks.
                self.layer.on_event(&self.window, event);
                None
            }
            // A press made up at a change of focus is none.
            ElementState::Pressed if is_synthetic => None,
            ElementState::Pressed => {
                if self.labels.learn(key.physical_key, &key.key_without_modifiers()) {
                    self.repaint(now);
                }
                self.keys.press(key.physical_key, key.repeat)
            }
        };
        if command == Some(Command::Quit) {
            return true;
        }
        if of_overlay && key.state.is_pressed() {
            self.keys.forget_holds();
            if self.layer.on_event(&self.window, event) {
                self.repaint(now);
            }
            return false;
        }
        if let Some(command) = command {
            self.obey(now, command);
        }
        false
    }

    /// The left button; true when the picture took it.
    pub(super) fn on_button(&mut self, state: ElementState) -> bool {
        match state {
            ElementState::Released => self.capture.button_up(),
            ElementState::Pressed if self.capture.is_active() => return true,
            ElementState::Pressed if self.layer.takes_click() => {}
            ElementState::Pressed => {
                self.layer.let_go();
                self.capture.begin(&WindowHost(&self.window), self.pointer);
                return true;
            }
        }
        false
    }

    /// The right button: dragged, it looks around; clicked, it inspects. True when the picture took it.
    fn on_right_button(&mut self, state: ElementState) -> bool {
        let is_captured = self.capture.is_active();
        match state {
            ElementState::Pressed if is_captured => self.inspect(),
            ElementState::Pressed if self.layer.takes_click() => return false,
            ElementState::Pressed => {
                self.layer.let_go();
                self.capture.drag_begin(self.pointer);
            }
            ElementState::Released => match self.capture.drag_end(&WindowHost(&self.window)) {
                DragEnd::Click => self.inspect(),
                DragEnd::Nothing => return is_captured,
            },
        }
        true
    }
}

fn notches(delta: MouseScrollDelta) -> f64 {
    match delta {
        MouseScrollDelta::LineDelta(_, lines) => f64::from(lines),
        MouseScrollDelta::PixelDelta(pixels) => pixels.y / PIXELS_PER_NOTCH,
    }
}

/// The window as capture sees it.
pub(super) struct WindowHost<'a>(pub &'a Window);

impl PointerHost for WindowHost<'_> {
    fn lock(&self) -> bool {
        self.0.set_cursor_grab(CursorGrabMode::Locked).is_ok()
    }

    fn unlock(&self) {
        // Refused, there is nothing more to do: a lost focus frees the pointer anyway.
        let _ = self.0.set_cursor_grab(CursorGrabMode::None);
    }

    fn warp(&self, position: DVec2) -> bool {
        self.0.set_cursor_position(PhysicalPosition::new(position.x, position.y)).is_ok()
    }

    fn show(&self, visible: bool) {
        self.0.set_cursor_visible(visible);
    }

    fn size(&self) -> DVec2 {
        let size = self.0.inner_size();
        DVec2::new(f64::from(size.width), f64::from(size.height))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_scrolling_adds_up_to_notches() {
        assert_eq!(notches(MouseScrollDelta::LineDelta(0.0, -2.0)), -2.0);
        assert_eq!(notches(MouseScrollDelta::PixelDelta(PhysicalPosition::new(0.0, 20.0))), 0.5);
    }
}
