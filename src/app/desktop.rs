//! The window's place on the desktop: as it was left, where that can still be seen.

use super::config::WindowState;
use winit::dpi::{PhysicalPosition, PhysicalSize};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Fullscreen, Window, WindowAttributes};

/// Least part of a window that is to be on a screen, in pixels from its upper left corner.
const GRIP: i64 = 64;

/// `attributes` for a window that opens as `state` says.
pub fn placed(attributes: WindowAttributes, state: WindowState, event_loop: &ActiveEventLoop) -> WindowAttributes {
    let attributes = attributes
        .with_inner_size(PhysicalSize::new(state.size.0, state.size.1))
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
    let size = window.inner_size();
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
    use super::is_on;

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
