//! What keys ask for: the bindings, and how long a key counts as held.
//!
//! Few terminals tell when a key is released (those with the keyboard protocol of kitty); others send a held key again
//! and again, after a pause of half a second. There, a press is a step that fades out, and one press after the other is
//! a walk. Only the last key pressed repeats, which is the terminal's doing.

use crate::app::input::Motion;
use glam::DVec2;
use std::time::{Duration, Instant};
use termina::event::{KeyCode, KeyEvent, KeyEventKind, ModifierKeyCode, Modifiers};

/// A press counts in full for this long: longer than the pause between two repeats, line and all.
const FULL: Duration = Duration::from_millis(100);
/// And has faded out after this long.
const FADED: Duration = Duration::from_millis(250);
/// Degrees a second of a turn by keys.
const TURN: f64 = 60.0;

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
    /// Look to the left.
    TurnLeft,
    /// Look to the right.
    TurnRight,
    /// Look up.
    TurnUp,
    /// Look down.
    TurnDown,
}

/// What a key does once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Leave.
    Quit,
    /// Leave as programs are left by Ctrl-C.
    Interrupt,
    /// Hand the terminal to the shell for a while.
    Suspend,
    /// Write the whole screen anew.
    Redraw,
    /// Back to where the walk started.
    Home,
    /// Walk instead of flying, or the reverse.
    ToggleWalking,
    /// So many notches faster.
    Speed(i8),
    /// The preset of this place in the list.
    Preset(usize),
}

/// Keys that act while held, in lower case.
const HOLD_KEYS: &[(KeyCode, Hold)] = &[
    (KeyCode::Char('w'), Hold::Forward),
    (KeyCode::Char('s'), Hold::Back),
    (KeyCode::Char('a'), Hold::Left),
    (KeyCode::Char('d'), Hold::Right),
    (KeyCode::Char(' '), Hold::Up),
    (KeyCode::Char('c'), Hold::Down),
    (KeyCode::Left, Hold::TurnLeft),
    (KeyCode::Right, Hold::TurnRight),
    (KeyCode::Up, Hold::TurnUp),
    (KeyCode::Down, Hold::TurnDown),
];

/// Keys that act once, in lower case; `true` where Ctrl must be held.
const COMMAND_KEYS: &[(KeyCode, bool, Command)] = &[
    (KeyCode::Char('q'), false, Command::Quit),
    (KeyCode::Char('q'), true, Command::Quit),
    (KeyCode::Escape, false, Command::Quit),
    (KeyCode::Char('c'), true, Command::Interrupt),
    (KeyCode::Char('z'), true, Command::Suspend),
    (KeyCode::Char('l'), true, Command::Redraw),
    (KeyCode::Home, false, Command::Home),
    (KeyCode::Char('g'), false, Command::ToggleWalking),
    (KeyCode::Char('+'), false, Command::Speed(2)),
    (KeyCode::Char('='), false, Command::Speed(2)),
    (KeyCode::Char('-'), false, Command::Speed(-2)),
    (KeyCode::Char('_'), false, Command::Speed(-2)),
    (KeyCode::Char('1'), false, Command::Preset(0)),
    (KeyCode::Char('2'), false, Command::Preset(1)),
    (KeyCode::Char('3'), false, Command::Preset(2)),
];

/// A key that counts as held.
#[derive(Clone, Copy, Debug)]
struct Held {
    hold: Hold,
    /// When it last went down; `None` where the terminal tells when it comes up.
    pressed: Option<Instant>,
}

impl Held {
    /// From 1, in full, to 0.
    fn strength(self, now: Instant) -> f64 {
        let Some(pressed) = self.pressed else { return 1.0 };
        let age = now.saturating_duration_since(pressed);
        let left = FADED.saturating_sub(age).as_secs_f64() / (FADED - FULL).as_secs_f64();
        left.min(1.0)
    }
}

/// What the held keys ask for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wish {
    /// Where to.
    pub motion: Motion,
    /// With which part of the speed, 0 to 1.
    pub pace: f64,
    /// Degrees a second to the right and down.
    pub turn: DVec2,
}

/// The keys that are held.
#[derive(Debug)]
pub struct Keys {
    tells_releases: bool,
    held: Vec<Held>,
    fast: bool,
    slow: bool,
}

impl Keys {
    /// No key is held. `tells_releases`: the terminal tells when a key comes up.
    pub fn new(tells_releases: bool) -> Self {
        Self { tells_releases, held: Vec::new(), fast: false, slow: false }
    }

    /// A key went down, was repeated or came up; returns what it asks for once.
    pub fn on_key(&mut self, now: Instant, key: KeyEvent) -> Option<Command> {
        let code = match key.code {
            KeyCode::Char(letter) => KeyCode::Char(letter.to_ascii_lowercase()),
            code => code,
        };
        let ctrl = key.modifiers.contains(Modifiers::CONTROL);
        let hold = HOLD_KEYS.iter().find(|(known, _)| *known == code).map(|(_, hold)| *hold);
        let is_down = key.kind != KeyEventKind::Release;
        match key.code {
            // Told of only where releases are.
            KeyCode::Modifier(ModifierKeyCode::LeftShift | ModifierKeyCode::RightShift) => self.fast = is_down,
            KeyCode::Modifier(ModifierKeyCode::LeftAlt | ModifierKeyCode::RightAlt) => self.slow = is_down,
            _ => {}
        }
        if !is_down {
            self.held.retain(|held| Some(held.hold) != hold);
            return None;
        }
        if let Some(hold) = hold.filter(|_| !ctrl) {
            self.held.retain(|held| held.hold != hold && held.hold != opposite(hold));
            self.held.push(Held { hold, pressed: (!self.tells_releases).then_some(now) });
            let is_capital = key.code != code;
            self.fast = is_capital || key.modifiers.contains(Modifiers::SHIFT);
            self.slow = key.modifiers.contains(Modifiers::ALT);
            return None;
        }
        COMMAND_KEYS.iter().find(|(known, with, _)| *known == code && *with == ctrl).map(|(_, _, command)| *command)
    }

    /// Whoever loses the focus is not told of releases.
    pub fn clear(&mut self) {
        self.held.clear();
    }

    /// What the keys ask for at `now`; `None` once all have faded out.
    pub fn wish(&mut self, now: Instant) -> Option<Wish> {
        self.held.retain(|held| held.strength(now) > 0.0);
        if self.held.is_empty() {
            return None;
        }
        let strength = |hold| self.held.iter().find(|held| held.hold == hold).map_or(0.0, |held| held.strength(now));
        let axis = |plus, minus| strength(plus) - strength(minus);
        let motion = Motion {
            right: axis(Hold::Right, Hold::Left),
            up: axis(Hold::Up, Hold::Down),
            forward: axis(Hold::Forward, Hold::Back),
            fast: self.fast,
            slow: self.slow,
        };
        let pace = motion.right.abs().max(motion.up.abs()).max(motion.forward.abs());
        let turn = DVec2::new(axis(Hold::TurnRight, Hold::TurnLeft), axis(Hold::TurnDown, Hold::TurnUp)) * TURN;
        Some(Wish { motion, pace, turn })
    }
}

/// What a key of these takes back at once.
fn opposite(hold: Hold) -> Hold {
    match hold {
        Hold::Forward => Hold::Back,
        Hold::Back => Hold::Forward,
        Hold::Left => Hold::Right,
        Hold::Right => Hold::Left,
        Hold::Up => Hold::Down,
        Hold::Down => Hold::Up,
        Hold::TurnLeft => Hold::TurnRight,
        Hold::TurnRight => Hold::TurnLeft,
        Hold::TurnUp => Hold::TurnDown,
        Hold::TurnDown => Hold::TurnUp,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn press(code: KeyCode) -> KeyEvent {
        KeyEvent::from(code)
    }

    fn with(code: KeyCode, modifiers: Modifiers) -> KeyEvent {
        KeyEvent::new(code, modifiers)
    }

    const W: KeyCode = KeyCode::Char('w');

    #[test]
    fn a_press_is_a_step_and_repeats_are_a_walk() {
        let start = Instant::now();
        let mut keys = Keys::new(false);
        let pace =
            |keys: &mut Keys, after: u64| keys.wish(start + Duration::from_millis(after)).map_or(0.0, |wish| wish.pace);
        assert_eq!(keys.on_key(start, press(W)), None);
        assert_eq!([pace(&mut keys, 0), pace(&mut keys, 100)], [1.0, 1.0]);
        assert!((pace(&mut keys, 175) - 0.5).abs() < 1e-9);
        assert_eq!(pace(&mut keys, 250), 0.0);
        for repeat in (500..1500).step_by(40) {
            keys.on_key(start + Duration::from_millis(repeat), press(W));
            assert_eq!(pace(&mut keys, repeat + 39), 1.0);
        }
        assert_eq!(pace(&mut keys, 1750), 0.0);
    }

    #[test]
    fn releases_count_where_they_are_told() {
        let start = Instant::now();
        let later = start + Duration::from_secs(9);
        let mut keys = Keys::new(true);
        keys.on_key(start, press(W));
        keys.on_key(start, press(KeyCode::Right));
        let wish = keys.wish(later).expect("held");
        assert_eq!((wish.motion.forward, wish.pace, wish.turn), (1.0, 1.0, DVec2::new(TURN, 0.0)));
        keys.on_key(later, KeyEvent { kind: KeyEventKind::Release, ..press(W) });
        assert_eq!(keys.wish(later).map(|wish| wish.pace), Some(0.0));
        keys.clear();
        assert_eq!(keys.wish(later), None);
    }

    #[test]
    fn the_other_direction_stops_at_once() {
        let now = Instant::now();
        let mut keys = Keys::new(false);
        keys.on_key(now, press(W));
        keys.on_key(now, press(KeyCode::Char('s')));
        assert_eq!(keys.wish(now).map(|wish| wish.motion.forward), Some(-1.0));
    }

    #[test]
    fn shift_is_faster_and_alt_slower() {
        let now = Instant::now();
        let mut keys = Keys::new(false);
        let mut paces = |key: KeyEvent| {
            keys.on_key(now, key);
            keys.wish(now).map(|wish| (wish.motion.fast, wish.motion.slow))
        };
        assert_eq!(paces(press(KeyCode::Char('W'))), Some((true, false)));
        assert_eq!(paces(with(W, Modifiers::SHIFT)), Some((true, false)));
        assert_eq!(paces(with(W, Modifiers::ALT)), Some((false, true)));
        assert_eq!(paces(press(W)), Some((false, false)));
    }

    #[test]
    fn ctrl_makes_another_key() {
        let now = Instant::now();
        let mut keys = Keys::new(false);
        assert_eq!(keys.on_key(now, with(KeyCode::Char('c'), Modifiers::CONTROL)), Some(Command::Interrupt));
        assert_eq!(keys.wish(now), None, "no step down");
        assert_eq!(keys.on_key(now, with(KeyCode::Char('1'), Modifiers::CONTROL)), None);
        assert_eq!(keys.on_key(now, press(KeyCode::Char('Q'))), Some(Command::Quit));
    }

    #[test]
    fn no_key_is_bound_twice() {
        for (i, (code, ctrl, _)) in COMMAND_KEYS.iter().enumerate() {
            assert!(COMMAND_KEYS[..i].iter().all(|(c, k, _)| c != code || k != ctrl), "{code:?}");
            assert!(*ctrl || HOLD_KEYS.iter().all(|(c, _)| c != code), "{code:?}");
        }
    }
}
