//! Pointer capture: who the mouse belongs to.
//!
//! Platforms differ. Where the pointer can be locked, raw device movement turns the view. Elsewhere (X11, Windows)
//! it is hidden and put back to the middle whenever it strays; confining it there instead makes winit report every
//! movement twice. Where even that is refused, the view turns while the button is held.

use glam::DVec2;

/// What a window lets us do with its pointer. A trait so that refusals can be tested.
pub trait PointerHost {
    /// Locks the pointer in place; false when that is not possible.
    fn lock(&self) -> bool;
    /// Undoes [`lock`](Self::lock).
    fn unlock(&self);
    /// Puts the pointer at a place in the window, in physical pixels; false when that is not possible.
    fn warp(&self, position: DVec2) -> bool;
    /// Shows or hides the pointer.
    fn show(&self, visible: bool);
    /// The window's size in physical pixels.
    fn size(&self) -> DVec2;
}

/// How the pointer is held.
#[derive(Debug, Default)]
enum Hold {
    /// Not at all: it belongs to the desktop and the overlay.
    #[default]
    Free,
    /// In place; movement comes from the device. The first event after capture is no movement of the user's.
    Locked { fresh: bool },
    /// Hidden, and put back to the middle when it strays.
    Warped(Warped),
    /// By the button that is down.
    Dragged { last: DVec2 },
}

/// Pointer positions across warps. Events that were already under way when the pointer was put back
/// still speak of the old place.
#[derive(Debug)]
struct Warped {
    last: DVec2,
    /// Where the pointer was put, until the first event from there.
    landing: Option<DVec2>,
}

impl Warped {
    fn delta(&mut self, position: DVec2) -> DVec2 {
        if let Some(landing) = self.landing
            && position.distance(landing) <= position.distance(self.last)
        {
            self.last = landing;
            self.landing = None;
        }
        let delta = position - self.last;
        self.last = position;
        delta
    }
}

/// A second button that looks around while it is held: from where it went down until the pointer has moved from there.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drag {
    /// It went down here and may be a click.
    Pressed(DVec2),
    /// The pointer is captured until it comes up.
    Looking,
}

/// What the second button did when it came up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DragEnd {
    /// It was clicked without motion.
    Click,
    /// The view was turned, or the button went down elsewhere.
    Nothing,
}

/// The capture state machine.
#[derive(Debug, Default)]
pub struct Capture {
    hold: Hold,
    pressed_at: DVec2,
    drag: Option<Drag>,
}

impl Capture {
    /// Whether the mouse turns the view rather than pointing at things.
    pub fn is_active(&self) -> bool {
        !matches!(self.hold, Hold::Free)
    }

    /// A button went down on the picture, at `position`.
    pub fn begin(&mut self, host: &dyn PointerHost, position: DVec2) {
        if self.is_active() {
            return;
        }
        self.pressed_at = position;
        let middle = (host.size() / 2.0).floor();
        self.hold = if host.lock() {
            Hold::Locked { fresh: true }
        } else if host.warp(middle) {
            Hold::Warped(Warped { last: position, landing: Some(middle) })
        } else {
            Hold::Dragged { last: position }
        };
        if !matches!(self.hold, Hold::Dragged { .. }) {
            host.show(false);
        }
    }

    /// The second button went down on the picture, at `position`: to look around until it comes up, or to click.
    pub fn drag_begin(&mut self, position: DVec2) {
        if !self.is_active() {
            self.drag = Some(Drag::Pressed(position));
        }
    }

    /// The pointer moved to `position`: with the second button down it begins to look around after more than `slop`
    /// pixels.
    pub fn drag_moved(&mut self, host: &dyn PointerHost, position: DVec2, slop: f64) {
        if let Some(Drag::Pressed(pressed_at)) = self.drag
            && position.distance(pressed_at) > slop
        {
            self.drag = Some(Drag::Looking);
            self.begin(host, position);
            self.pressed_at = pressed_at;
        }
    }

    /// The second button came up.
    pub fn drag_end(&mut self, host: &dyn PointerHost) -> DragEnd {
        match self.drag.take() {
            Some(Drag::Pressed(_)) => DragEnd::Click,
            Some(Drag::Looking) => {
                self.release(host);
                DragEnd::Nothing
            }
            None => DragEnd::Nothing,
        }
    }

    /// The button went up: only a drag ends.
    pub fn button_up(&mut self) {
        if matches!(self.hold, Hold::Dragged { .. }) && self.drag.is_none() {
            self.hold = Hold::Free;
        }
    }

    /// Gives the pointer back, where it was taken.
    pub fn release(&mut self, host: &dyn PointerHost) {
        self.drag = None;
        match std::mem::take(&mut self.hold) {
            Hold::Free | Hold::Dragged { .. } => return,
            Hold::Locked { .. } => host.unlock(),
            Hold::Warped(_) => {
                host.warp(self.pressed_at);
            }
        }
        host.show(true);
    }

    /// The device moved by `delta` counts; returns what turns the view.
    pub fn device_moved(&mut self, delta: DVec2) -> DVec2 {
        match &mut self.hold {
            Hold::Locked { fresh } => {
                if std::mem::take(fresh) {
                    DVec2::ZERO
                } else {
                    delta
                }
            }
            _ => DVec2::ZERO,
        }
    }

    /// The pointer moved to `position` in the window, in physical pixels; returns what turns the view.
    pub fn pointer_moved(&mut self, host: &dyn PointerHost, position: DVec2) -> DVec2 {
        match &mut self.hold {
            Hold::Free | Hold::Locked { .. } => DVec2::ZERO,
            Hold::Dragged { last } => position - std::mem::replace(last, position),
            Hold::Warped(warped) => {
                let delta = warped.delta(position);
                let size = host.size();
                let middle = (size / 2.0).floor();
                let strayed = (position - middle).abs().cmpgt(size / 4.0).any();
                if strayed && warped.landing.is_none() && host.warp(middle) {
                    warped.landing = Some(middle);
                }
                delta
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::{Cell, RefCell};

    #[derive(Default)]
    struct Host {
        locks: bool,
        warps: bool,
        visible: Cell<bool>,
        locked: Cell<bool>,
        warped_to: RefCell<Vec<DVec2>>,
    }

    impl PointerHost for Host {
        fn lock(&self) -> bool {
            self.locked.set(self.locks);
            self.locks
        }
        fn unlock(&self) {
            self.locked.set(false);
        }
        fn warp(&self, position: DVec2) -> bool {
            self.warped_to.borrow_mut().push(position);
            self.warps
        }
        fn show(&self, visible: bool) {
            self.visible.set(visible);
        }
        fn size(&self) -> DVec2 {
            DVec2::new(800.0, 600.0)
        }
    }

    const MIDDLE: DVec2 = DVec2::new(400.0, 300.0);

    #[test]
    fn a_locked_pointer_ignores_its_first_event_and_its_positions() {
        let host = Host { locks: true, ..Host::default() };
        let mut capture = Capture::default();
        capture.begin(&host, MIDDLE);
        assert!(capture.is_active() && host.locked.get() && !host.visible.get());
        assert_eq!(capture.device_moved(DVec2::new(250.0, 0.0)), DVec2::ZERO);
        assert_eq!(capture.device_moved(DVec2::new(3.0, -2.0)), DVec2::new(3.0, -2.0));
        assert_eq!(capture.pointer_moved(&host, DVec2::ZERO), DVec2::ZERO);
        capture.release(&host);
        assert!(!capture.is_active() && !host.locked.get() && host.visible.get());
        assert_eq!(capture.device_moved(DVec2::ONE), DVec2::ZERO);
    }

    #[test]
    fn putting_the_pointer_back_moves_nothing() {
        let host = Host { warps: true, ..Host::default() };
        let mut capture = Capture::default();
        capture.begin(&host, DVec2::new(10.0, 10.0));
        let mut turned = DVec2::ZERO;
        // Already under way when the pointer was put to the middle, then two from there.
        for (x, y) in [(12.0, 10.0), (401.0, 300.0), (405.0, 300.0)] {
            turned += capture.pointer_moved(&host, DVec2::new(x, y));
        }
        assert_eq!(turned, DVec2::new(7.0, 0.0));
        // Strays to the right, is put back, and one late event still speaks of the right.
        for (x, y) in [(500.0, 300.0), (610.0, 300.0), (615.0, 300.0), (402.0, 300.0)] {
            turned += capture.pointer_moved(&host, DVec2::new(x, y));
        }
        assert_eq!(turned, DVec2::new(7.0 + 210.0 + 2.0, 0.0));
        assert_eq!(*host.warped_to.borrow(), [MIDDLE, MIDDLE]);
        capture.release(&host);
        assert_eq!(host.warped_to.borrow().last(), Some(&DVec2::new(10.0, 10.0)), "back where it was taken");
    }

    #[test]
    fn the_second_button_clicks_or_looks_around_while_it_is_held() {
        let host = Host { warps: true, ..Host::default() };
        let mut capture = Capture::default();
        let at = DVec2::new(10.0, 10.0);
        capture.drag_begin(at);
        capture.drag_moved(&host, at + DVec2::new(3.0, 0.0), 4.0);
        assert!(!capture.is_active(), "a hand that trembles");
        assert_eq!(capture.drag_end(&host), DragEnd::Click);
        assert_eq!(capture.drag_end(&host), DragEnd::Nothing, "it went down elsewhere");

        capture.drag_begin(at);
        let mut turned = DVec2::ZERO;
        for (x, y) in [(20.0, 10.0), (23.0, 10.0), (401.0, 300.0), (405.0, 300.0)] {
            capture.drag_moved(&host, DVec2::new(x, y), 4.0);
            turned += capture.pointer_moved(&host, DVec2::new(x, y));
        }
        assert!(capture.is_active() && !host.visible.get());
        assert_eq!(turned, DVec2::new(8.0, 0.0));
        assert_eq!(capture.drag_end(&host), DragEnd::Nothing);
        assert!(!capture.is_active() && host.visible.get());
        assert_eq!(host.warped_to.borrow().last(), Some(&at), "back where it was taken");

        // Esc ends it: the button that comes up after that is no click.
        capture.drag_begin(at);
        capture.drag_moved(&host, MIDDLE, 4.0);
        capture.release(&host);
        assert_eq!(capture.drag_end(&host), DragEnd::Nothing);
        capture.begin(&host, MIDDLE);
        capture.drag_begin(MIDDLE);
        assert_eq!(capture.drag_end(&host), DragEnd::Nothing, "the first button holds it");
        assert!(capture.is_active());
    }

    #[test]
    fn a_window_that_refuses_everything_still_looks_by_dragging() {
        let host = Host { visible: Cell::new(true), ..Host::default() };
        let mut capture = Capture::default();
        capture.begin(&host, MIDDLE);
        assert!(capture.is_active() && host.visible.get());
        assert_eq!(capture.pointer_moved(&host, MIDDLE + DVec2::new(5.0, 1.0)), DVec2::new(5.0, 1.0));
        capture.button_up();
        assert!(!capture.is_active());
        assert_eq!(capture.pointer_moved(&host, MIDDLE), DVec2::ZERO);
    }
}
