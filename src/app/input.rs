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
}

/// What a key does once, when it goes down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Close the window.
    Quit,
    /// Let the pointer go, or else give up what is being loaded.
    ReleasePointer,
    /// Open or close the panel.
    TogglePanel,
    /// Show or hide everything that lies over the picture.
    ToggleOverlay,
    /// Back to where the walk started.
    Home,
    /// Choose a scene to open.
    Open,
    /// Load the scene once more.
    Reload,
    /// Tell of what is under the pointer.
    Inspect,
    /// Walk instead of flying, or the reverse.
    ToggleWalking,
}

/// Keys that act while held. Codes name positions, so that WASD is the same block of keys on every layout.
pub const HOLD_KEYS: &[(KeyCode, Hold)] = &[
    (KeyCode::KeyW, Hold::Forward),
    (KeyCode::KeyS, Hold::Back),
    (KeyCode::KeyA, Hold::Left),
    (KeyCode::KeyD, Hold::Right),
    (KeyCode::Space, Hold::Up),
    (KeyCode::KeyC, Hold::Down),
    (KeyCode::ShiftLeft, Hold::Fast),
    (KeyCode::ShiftRight, Hold::Fast),
    (KeyCode::AltLeft, Hold::Slow),
    (KeyCode::AltRight, Hold::Slow),
];

/// Keys that act once; `true` where Ctrl must be held.
pub const COMMAND_KEYS: &[(KeyCode, bool, Command)] = &[
    (KeyCode::KeyQ, true, Command::Quit),
    (KeyCode::Escape, false, Command::ReleasePointer),
    (KeyCode::F1, false, Command::TogglePanel),
    (KeyCode::Tab, false, Command::TogglePanel),
    (KeyCode::KeyH, false, Command::ToggleOverlay),
    (KeyCode::Home, false, Command::Home),
    (KeyCode::KeyO, true, Command::Open),
    (KeyCode::F5, false, Command::Reload),
    (KeyCode::KeyI, false, Command::Inspect),
    (KeyCode::KeyG, false, Command::ToggleWalking),
];

/// The help shown in the overlay: keys and what they do.
pub const HELP: &[(&str, &str)] = &[
    ("W A S D", "move"),
    ("Space, C", "up, down; walking, Space jumps"),
    ("Shift, Alt", "faster, slower"),
    ("Wheel", "change the speed"),
    ("Click", "look with the mouse"),
    ("Esc", "let the mouse go; stop loading"),
    ("G", "walk or fly"),
    ("Home", "back to the start"),
    ("F1, Tab", "this panel"),
    ("H", "hide everything"),
    ("I, right click", "tell of the thing under the pointer"),
    ("Ctrl+O", "open a scene; or drop one on the window"),
    ("F5", "load the scene again"),
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
        if command.is_none() && !self.ctrl && HOLD_KEYS.iter().any(|&(c, _)| c == code) {
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

    /// What the held keys ask for. Opposite keys cancel.
    pub fn motion(&self) -> Motion {
        let held = |what: Hold| HOLD_KEYS.iter().any(|(code, hold)| *hold == what && self.down.contains(code));
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
        assert_eq!(keys.press(code(KeyCode::F1), false), Some(Command::TogglePanel));
        assert_eq!(keys.press(code(KeyCode::F1), true), None);
        assert_eq!(keys.press(code(KeyCode::KeyQ), false), None);
        keys.set_ctrl(true);
        assert_eq!(keys.press(code(KeyCode::KeyQ), false), Some(Command::Quit));
        keys.press(code(KeyCode::KeyC), false);
        assert!(!keys.motion().is_moving(), "Ctrl+C is no step down");
    }

    #[test]
    fn no_key_is_bound_twice() {
        for (i, (code, ctrl, _)) in COMMAND_KEYS.iter().enumerate() {
            assert!(COMMAND_KEYS[..i].iter().all(|(c, k, _)| c != code || k != ctrl), "{code:?}");
            assert!(*ctrl || HOLD_KEYS.iter().all(|(c, _)| c != code), "{code:?}");
        }
    }
}
