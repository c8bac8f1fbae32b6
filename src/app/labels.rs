//! What is printed on the keys: positions are named by an American keyboard until a key was pressed.

use std::collections::HashMap;
use winit::keyboard::{Key, KeyCode, PhysicalKey};

/// The letters of an American keyboard, by position.
const LETTERS: &[(char, KeyCode)] = &[
    ('A', KeyCode::KeyA),
    ('B', KeyCode::KeyB),
    ('C', KeyCode::KeyC),
    ('D', KeyCode::KeyD),
    ('E', KeyCode::KeyE),
    ('F', KeyCode::KeyF),
    ('G', KeyCode::KeyG),
    ('H', KeyCode::KeyH),
    ('I', KeyCode::KeyI),
    ('J', KeyCode::KeyJ),
    ('K', KeyCode::KeyK),
    ('L', KeyCode::KeyL),
    ('M', KeyCode::KeyM),
    ('N', KeyCode::KeyN),
    ('O', KeyCode::KeyO),
    ('P', KeyCode::KeyP),
    ('Q', KeyCode::KeyQ),
    ('R', KeyCode::KeyR),
    ('S', KeyCode::KeyS),
    ('T', KeyCode::KeyT),
    ('U', KeyCode::KeyU),
    ('V', KeyCode::KeyV),
    ('W', KeyCode::KeyW),
    ('X', KeyCode::KeyX),
    ('Y', KeyCode::KeyY),
    ('Z', KeyCode::KeyZ),
];

/// The user's own names of letter keys, as far as they are known.
#[derive(Clone, Debug, Default)]
pub struct Labels(HashMap<char, String>);

impl Labels {
    /// A key was pressed, which without modifiers means `key`. True if that is news.
    pub fn learn(&mut self, position: PhysicalKey, key: &Key) -> bool {
        let Key::Character(own) = key else { return false };
        let letter = LETTERS.iter().find(|(_, code)| PhysicalKey::Code(*code) == position);
        let Some(&(letter, _)) = letter else { return false };
        let own = own.to_uppercase();
        let known = self.0.get(&letter).map_or_else(|| own == letter.to_string(), |known| *known == own);
        self.0.insert(letter, own);
        !known
    }

    /// A text in which single capital letters stand for keys, with the user's own in their place.
    pub fn of(&self, text: &str) -> String {
        let words = text.split_inclusive(|c: char| !c.is_alphanumeric());
        words.map(|word| self.of_word(word)).collect()
    }

    fn of_word(&self, word: &str) -> String {
        let mut characters = word.chars();
        let own = characters.next().and_then(|first| self.0.get(&first));
        let rest = characters.as_str();
        match own {
            Some(own) if !rest.starts_with(char::is_alphanumeric) => format!("{own}{rest}"),
            _ => word.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_called_as_on_the_users_keyboard() {
        let mut labels = Labels::default();
        let mut press = |code, own: &str| labels.learn(PhysicalKey::Code(code), &Key::Character(own.into()));
        // A French keyboard.
        assert!(press(KeyCode::KeyW, "z") && press(KeyCode::KeyA, "q") && press(KeyCode::KeyQ, "a"));
        assert!(!press(KeyCode::KeyD, "d") && !press(KeyCode::KeyW, "z") && !press(KeyCode::Digit1, "&"));
        assert_eq!(labels.of("W A S D"), "Z Q S D");
        assert_eq!(labels.of("Ctrl+Q, Wheel, Space, A"), "Ctrl+A, Wheel, Space, Q");
        assert!(labels.learn(PhysicalKey::Code(KeyCode::KeyC), &Key::Character("\u{441}".into())));
        assert_eq!(labels.of("Space, C"), "Space, \u{421}");
    }
}
