//! Keys: what is held down and what was asked for, by physical position on the keyboard.
//!
//! The bindings are two lists; the overlay's help is the third and a test keeps them together.

use std::collections::HashSet;
use winit::keyboard::{KeyCode, PhysicalKey};

/// What a key does for as long as it is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// Along the view.
    Forward,
    /// Against the view.
    Back,
    /// To the left.
    Left,
    /// To the right.
    Right,
    /// Along the scene's up.
    Up,
    /// Against the scene's up.
    Down,
    /// Faster.
    Fast,
    /// Slower.
    Slow,
    /// The exact picture.
    Exact,
}

/// What a key does once, when it goes down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Close the window.
    Quit,
    /// Release the pointer, or else give up what is being loaded.
    ReleasePointer,
    /// Open or close the help.
    ToggleHelp,
    /// Open or close the panel.
    TogglePanel,
    /// Show or hide everything that lies over the picture.
    ToggleOverlay,
    /// Back to where the walk started.
    Home,
    /// Choose a scene to open.
    Open,
    /// List the scene's warnings, or no longer.
    ToggleWarnings,
    /// Load the scene once more.
    Reload,
    /// Inspect the object under the pointer.
    Inspect,
    /// Walk instead of flying, or the reverse.
    ToggleWalking,
    /// Keep the picture as a file.
    Screenshot,
    /// Fill the screen, or return to a window.
    ToggleFullscreen,
    /// A larger panel and text.
    EnlargeUi,
    /// A smaller panel and text.
    ReduceUi,
    /// Panel and text of the usual size.
    ResetUi,
    /// Keep the view under a number.
    StoreBookmark(u8),
    /// Go to the view of a number.
    GoToBookmark(u8),
    /// Put the camera on the clipboard.
    CopyCamera,
    /// Go to the camera on the clipboard.
    PasteCamera,
    /// Start or stop recording a camera path.
    ToggleRecording,
    /// Start or stop replaying the last one.
    ToggleReplay,
    /// The next debug view.
    NextMap,
    /// Show two settings side by side, or no longer.
    ToggleSplit,
}

/// Keys that act while held. Codes name positions, so that WASD is the same block of keys on every layout.
pub const HOLD_KEYS: &[(KeyCode, Hold)] = &[
    (KeyCode::KeyW, Hold::Forward),
    (KeyCode::KeyS, Hold::Back),
    (KeyCode::KeyA, Hold::Left),
    (KeyCode::KeyD, Hold::Right),
    (KeyCode::ArrowUp, Hold::Forward),
    (KeyCode::ArrowDown, Hold::Back),
    (KeyCode::ArrowLeft, Hold::Left),
    (KeyCode::ArrowRight, Hold::Right),
    (KeyCode::Space, Hold::Up),
    (KeyCode::KeyE, Hold::Up),
    (KeyCode::KeyC, Hold::Down),
    (KeyCode::KeyQ, Hold::Down),
    (KeyCode::ShiftLeft, Hold::Fast),
    (KeyCode::ShiftRight, Hold::Fast),
    (KeyCode::AltLeft, Hold::Slow),
    (KeyCode::AltRight, Hold::Slow),
    (KeyCode::KeyX, Hold::Exact),
];

/// Keys that act once; `true` where Ctrl must be held.
pub const COMMAND_KEYS: &[(KeyCode, bool, Command)] = &[
    (KeyCode::KeyQ, true, Command::Quit),
    (KeyCode::Escape, false, Command::ReleasePointer),
    (KeyCode::F1, false, Command::ToggleHelp),
    (KeyCode::Tab, false, Command::TogglePanel),
    (KeyCode::KeyH, false, Command::ToggleOverlay),
    (KeyCode::Home, false, Command::Home),
    (KeyCode::KeyO, true, Command::Open),
    (KeyCode::F2, false, Command::ToggleWarnings),
    (KeyCode::F5, false, Command::Reload),
    (KeyCode::KeyI, false, Command::Inspect),
    (KeyCode::KeyG, false, Command::ToggleWalking),
    (KeyCode::F12, false, Command::Screenshot),
    (KeyCode::F11, false, Command::ToggleFullscreen),
    (KeyCode::Equal, true, Command::EnlargeUi),
    (KeyCode::NumpadAdd, true, Command::EnlargeUi),
    (KeyCode::Minus, true, Command::ReduceUi),
    (KeyCode::NumpadSubtract, true, Command::ReduceUi),
    (KeyCode::Digit0, true, Command::ResetUi),
    (KeyCode::Numpad0, true, Command::ResetUi),
    (KeyCode::KeyC, true, Command::CopyCamera),
    (KeyCode::KeyV, true, Command::PasteCamera),
    (KeyCode::KeyR, false, Command::ToggleRecording),
    (KeyCode::KeyP, false, Command::ToggleReplay),
    (KeyCode::Digit1, false, Command::GoToBookmark(1)),
    (KeyCode::Digit1, true, Command::StoreBookmark(1)),
    (KeyCode::Digit2, false, Command::GoToBookmark(2)),
    (KeyCode::Digit2, true, Command::StoreBookmark(2)),
    (KeyCode::Digit3, false, Command::GoToBookmark(3)),
    (KeyCode::Digit3, true, Command::StoreBookmark(3)),
    (KeyCode::Digit4, false, Command::GoToBookmark(4)),
    (KeyCode::Digit4, true, Command::StoreBookmark(4)),
    (KeyCode::Digit5, false, Command::GoToBookmark(5)),
    (KeyCode::Digit5, true, Command::StoreBookmark(5)),
    (KeyCode::Digit6, false, Command::GoToBookmark(6)),
    (KeyCode::Digit6, true, Command::StoreBookmark(6)),
    (KeyCode::Digit7, false, Command::GoToBookmark(7)),
    (KeyCode::Digit7, true, Command::StoreBookmark(7)),
    (KeyCode::Digit8, false, Command::GoToBookmark(8)),
    (KeyCode::Digit8, true, Command::StoreBookmark(8)),
    (KeyCode::Digit9, false, Command::GoToBookmark(9)),
    (KeyCode::Digit9, true, Command::StoreBookmark(9)),
    (KeyCode::KeyV, false, Command::NextMap),
    (KeyCode::KeyB, false, Command::ToggleSplit),
];

/// The help shown in the overlay: keys and what they do.
pub const HELP: &[(&str, &str)] = &[
    ("W A S D, arrows", "move"),
    ("E, Space", "up; walking, jump"),
    ("Q, C", "down"),
    ("Shift, Alt", "faster, slower"),
    ("Wheel", "change the speed"),
    ("Click, right drag", "look with the mouse"),
    ("Esc", "release the mouse; close the help; stop loading"),
    ("G", "walk or fly"),
    ("Home", "back to the start, at the usual speed"),
    ("F1", "help"),
    ("F2", "list the warnings of the scene"),
    ("Tab", "open or close the panel"),
    ("1 to 9", "go to a bookmark; with Ctrl, set it"),
    ("Ctrl+C, Ctrl+V", "copy, paste the camera"),
    ("R, P", "record a camera path, replay it"),
    ("V", "next debug view"),
    ("X, held", "the exact picture"),
    ("B", "two settings side by side"),
    ("H", "hide everything"),
    ("I, right click", "inspect the object under the pointer"),
    ("Ctrl+O", "open a scene; or drop one on the window"),
    ("F5", "load the scene again"),
    ("F11", "full screen"),
    ("F12", "screenshot"),
    ("Ctrl and +, -, 0", "panel larger, smaller, as usual"),
    ("Ctrl+Q", "quit"),
];

/// How the walker is asked to move, each axis -1, 0 or 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// To the right.
    pub right: f64,
    /// Along the scene's up.
    pub up: f64,
    /// Along the view.
    pub forward: f64,
    /// Faster.
    pub fast: bool,
    /// Slower.
    pub slow: bool,
}

impl Motion {
    /// Whether it leads anywhere.
    pub fn is_moving(&self) -> bool {
        self.right != 0.0 || self.up != 0.0 || self.forward != 0.0
    }
}

/// The keys that are down. Held keys arrive as repeats, hence a set.
#[derive(Debug, Default)]
pub struct Keys {
    down: HashSet<KeyCode>,
    ctrl: bool,
}

impl Keys {
    /// Takes note of the Ctrl key, which makes a chord of what is pressed next.
    pub fn set_ctrl(&mut self, ctrl: bool) {
        self.ctrl = ctrl;
    }

    /// A key went down; returns what it asks for. A repeat asks for nothing.
    pub fn press(&mut self, key: PhysicalKey, repeat: bool) -> Option<Command> {
        let PhysicalKey::Code(code) = key else { return None };
        let command =
            COMMAND_KEYS.iter().find(|&&(c, ctrl, _)| c == code && ctrl == self.ctrl).map(|&(_, _, command)| command);
        // The repeats of a chord go on after Ctrl was let go, and are no step.
        if command.is_none() && !self.ctrl && !repeat && HOLD_KEYS.iter().any(|&(c, _)| c == code) {
            self.down.insert(code);
        }
        command.filter(|_| !repeat)
    }

    /// A key went up.
    pub fn release(&mut self, key: PhysicalKey) {
        if let PhysicalKey::Code(code) = key {
            self.down.remove(&code);
        }
    }

    /// Forgets the held keys: what is typed is not for us.
    pub fn forget_holds(&mut self) {
        self.down.clear();
    }

    /// Forgets all keys. Whoever loses the focus is not told of releases.
    pub fn clear(&mut self) {
        self.down.clear();
        self.ctrl = false;
    }

    /// Whether a key is down that does this.
    pub fn is_held(&self, what: Hold) -> bool {
        HOLD_KEYS.iter().any(|(code, hold)| *hold == what && self.down.contains(code))
    }

    /// What the held keys ask for. Opposite keys cancel.
    pub fn motion(&self) -> Motion {
        let held = |what: Hold| self.is_held(what);
        let axis = |plus: Hold, minus: Hold| f64::from(i8::from(held(plus)) - i8::from(held(minus)));
        Motion {
            right: axis(Hold::Right, Hold::Left),
            up: axis(Hold::Up, Hold::Down),
            forward: axis(Hold::Forward, Hold::Back),
            fast: held(Hold::Fast),
            slow: held(Hold::Slow),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use winit::keyboard::NativeKeyCode;

    fn code(code: KeyCode) -> PhysicalKey {
        PhysicalKey::Code(code)
    }

    #[test]
    fn keys_are_positions_not_characters() {
        // On a French keyboard the key at the position of W types a "z": only the position is looked at.
        let mut keys = Keys::default();
        keys.press(code(KeyCode::KeyW), false);
        assert_eq!(keys.motion().forward, 1.0);
        assert_eq!(keys.press(PhysicalKey::Unidentified(NativeKeyCode::Xkb(25)), false), None);
    }

    #[test]
    fn held_keys_add_up_and_opposite_ones_cancel() {
        let mut keys = Keys::default();
        keys.press(code(KeyCode::KeyW), false);
        keys.press(code(KeyCode::KeyW), true);
        keys.press(code(KeyCode::KeyD), false);
        keys.press(code(KeyCode::ShiftLeft), false);
        assert_eq!(keys.motion(), Motion { right: 1.0, forward: 1.0, fast: true, ..Motion::default() });
        keys.press(code(KeyCode::KeyS), false);
        assert_eq!(keys.motion().forward, 0.0);
        keys.release(code(KeyCode::KeyW));
        assert_eq!(keys.motion().forward, -1.0);
    }

    #[test]
    fn arrows_move_as_letters_do_and_two_pairs_of_keys_go_up_and_down() {
        for (arrow, letter) in [
            (KeyCode::ArrowUp, KeyCode::KeyW),
            (KeyCode::ArrowDown, KeyCode::KeyS),
            (KeyCode::ArrowLeft, KeyCode::KeyA),
            (KeyCode::ArrowRight, KeyCode::KeyD),
            (KeyCode::KeyE, KeyCode::Space),
            (KeyCode::KeyQ, KeyCode::KeyC),
        ] {
            let [one, other] = [arrow, letter].map(|key| {
                let mut keys = Keys::default();
                assert_eq!(keys.press(code(key), false), None);
                keys.motion()
            });
            assert!(one.is_moving() && one == other, "{arrow:?} {letter:?}");
        }
        let mut keys = Keys::default();
        keys.press(code(KeyCode::KeyE), false);
        assert_eq!(keys.motion().up, 1.0);
    }

    #[test]
    fn losing_the_focus_stops_the_walk() {
        let mut keys = Keys::default();
        keys.press(code(KeyCode::KeyW), false);
        keys.set_ctrl(true);
        keys.clear();
        assert!(!keys.motion().is_moving());
        assert_eq!(keys.press(code(KeyCode::KeyQ), false), None, "Ctrl is forgotten too");
    }

    #[test]
    fn commands_come_once_and_need_their_chord() {
        let mut keys = Keys::default();
        assert_eq!(keys.press(code(KeyCode::Tab), false), Some(Command::TogglePanel));
        assert_eq!(keys.press(code(KeyCode::Tab), true), None);
        assert_eq!(keys.press(code(KeyCode::KeyQ), false), None);
        keys.release(code(KeyCode::KeyQ));
        keys.set_ctrl(true);
        assert_eq!(keys.press(code(KeyCode::KeyQ), false), Some(Command::Quit));
        keys.press(code(KeyCode::KeyC), false);
        assert!(!keys.motion().is_moving(), "Ctrl+C is no step down");
        keys.set_ctrl(false);
        keys.press(code(KeyCode::KeyC), true);
        assert!(!keys.motion().is_moving(), "nor is the C that is still down once Ctrl is not");
    }

    #[test]
    fn no_key_is_bound_twice() {
        for (i, (code, ctrl, _)) in COMMAND_KEYS.iter().enumerate() {
            assert!(COMMAND_KEYS[..i].iter().all(|(c, k, _)| c != code || k != ctrl), "{code:?}");
            assert!(*ctrl || HOLD_KEYS.iter().all(|(c, _)| c != code), "{code:?}");
        }
    }
}
