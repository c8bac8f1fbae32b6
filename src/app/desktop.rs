//! The window's place on the desktop: as it was left, where that can still be seen.

use super::config::WindowState;
use winit::dpi::{LogicalSize, PhysicalPosition};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Fullscreen, Window, WindowAttributes};

/// Least part of a window that is to be on a screen, in pixels from its upper left corner.
const GRIP: i64 = 64;

/// `attributes` for a window that opens as `state` says.
pub fn placed(attributes: WindowAttributes, state: WindowState, event_loop: &ActiveEventLoop) -> WindowAttributes {
    let scales = event_loop.available_monitors().map(|monitor| monitor.scale_factor());
    let (width, height) = possible_size(state.size, scales.fold(1.0, f64::max));
    let attributes = attributes
        .with_inner_size(LogicalSize::new(width, height))
        .with_maximized(state.maximized)
        .with_fullscreen(state.fullscreen.then(|| Fullscreen::Borderless(None)));
    let mut screens = event_loop.available_monitors().map(|monitor| {
        let (position, size) = (monitor.position(), monitor.size());
        ((position.x, position.y), (size.width, size.height))
    });
    match state.position.filter(|&position| screens.any(|screen| is_on(position, screen))) {
        Some((x, y)) => attributes.with_position(PhysicalPosition::new(x, y)),
        None => attributes,
    }
}

/// The nearest size in logical pixels that a window can have on a display of this scale.
pub fn possible_size(size: (u32, u32), scale: f64) -> (u32, u32) {
    let along = |by: f64| move |side: u32| (f64::from(side) * by).round().clamp(1.0, f64::from(u32::MAX)) as u32;
    let (physical, logical) = (along(scale), along(scale.recip()));
    let wanted = (physical(size.0), physical(size.1));
    let nearest = WindowState::nearest_size(wanted);
    if nearest == wanted { size } else { (logical(nearest.0), logical(nearest.1)) }
}

/// Whether a window at `position` can be got hold of on a screen, which may have been taken away since.
fn is_on(position: (i32, i32), (corner, size): ((i32, i32), (u32, u32))) -> bool {
    let is_within = |at: i32, from: i32, length: u32| {
        let (at, from) = (i64::from(at), i64::from(from));
        at >= from - GRIP / 2 && at + GRIP <= from + i64::from(length)
    };
    is_within(position.0, corner.0, size.0) && is_within(position.1, corner.1, size.1)
}

/// Where `window` is now; `None` while it has no size.
pub fn state_of(window: &Window) -> Option<WindowState> {
    let size: LogicalSize<u32> = window.inner_size().to_logical(window.scale_factor());
    (size.width > 0 && size.height > 0).then(|| WindowState {
        position: window.outer_position().ok().map(|position| (position.x, position.y)),
        size: (size.width, size.height),
        maximized: window.is_maximized(),
        fullscreen: window.fullscreen().is_some(),
    })
}

/// Fills the screen with `window`, or undoes that.
pub fn toggle_fullscreen(window: &Window) {
    let wanted = window.fullscreen().is_none().then(|| Fullscreen::Borderless(None));
    window.set_fullscreen(wanted);
}

#[cfg(test)]
mod tests {
    use super::{is_on, possible_size};

    #[test]
    fn sizes_are_logical_and_no_larger_than_a_window_can_be() {
        for scale in [1.0, 1.25, 1.5, 2.0, 3.0] {
            assert_eq!(possible_size((1280, 720), scale), (1280, 720), "{scale}");
        }
        assert_eq!(possible_size((16384, 16384), 1.0), (8192, 8192));
        assert_eq!(possible_size((8192, 8192), 2.0), (4096, 4096));
        assert_eq!(possible_size((0, u32::MAX), 2.0).1, 8192);
    }

    #[test]
    fn windows_are_put_only_where_they_can_be_seen() {
        let screen = ((100, 0), (1920, 1080));
        for position in [(100, 0), (80, -10), (1900, 900)] {
            assert!(is_on(position, screen), "{position:?}");
        }
        for position in [(0, 0), (2000, 10), (200, 1050), (200, -500), (i32::MAX, i32::MIN)] {
            assert!(!is_on(position, screen), "{position:?}");
        }
    }
}
