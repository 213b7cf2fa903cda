//! Which key does what while playing. Kept with the preferences, by the names of the keys.

use egui::Key;
use serde::{Deserialize, Serialize};

/// What a key that is held does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum KeyAction {
    Ahead,
    Back,
    Left,
    Right,
    Faster,
    Lower,
    Style,
    GetUp,
    Roll,
    Jump,
    #[serde(alias = "Kick")]
    Punch,
    Shove,
    Strafe,
}

impl KeyAction {
    /// All actions, each with the key that it has at first.
    pub const ALL: [(KeyAction, Key); 13] = [
        (KeyAction::Ahead, Key::W),
        (KeyAction::Back, Key::S),
        (KeyAction::Left, Key::A),
        (KeyAction::Right, Key::D),
        (KeyAction::Faster, Key::E),
        (KeyAction::Lower, Key::Q),
        (KeyAction::Style, Key::Z),
        (KeyAction::GetUp, Key::Space),
        (KeyAction::Roll, Key::R),
        (KeyAction::Jump, Key::J),
        (KeyAction::Punch, Key::K),
        (KeyAction::Shove, Key::V),
        (KeyAction::Strafe, Key::F),
    ];

    /// Name for panels.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            KeyAction::Ahead => "ahead",
            KeyAction::Back => "back",
            KeyAction::Left => "left",
            KeyAction::Right => "right",
            KeyAction::Faster => "faster",
            KeyAction::Lower => "lower",
            KeyAction::Style => "other style",
            KeyAction::GetUp => "get up",
            KeyAction::Roll => "roll",
            KeyAction::Jump => "jump",
            KeyAction::Punch => "punch",
            KeyAction::Shove => "knock over",
            KeyAction::Strafe => "strafe",
        }
    }
}

/// The key of each action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Vec<(KeyAction, String)>", into = "Vec<(KeyAction, String)>")]
pub struct KeyMap([Key; KeyAction::ALL.len()]);

impl Default for KeyMap {
    fn default() -> Self {
        Self(KeyAction::ALL.map(|(_, key)| key))
    }
}

impl KeyMap {
    /// The key of an action.
    #[must_use]
    pub fn key(&self, action: KeyAction) -> Key {
        self.0[action as usize]
    }

    /// The four keys that walk, as they lie on the keyboard.
    #[must_use]
    pub fn walk(&self) -> String {
        let keys = [KeyAction::Ahead, KeyAction::Left, KeyAction::Back, KeyAction::Right];
        keys.map(|action| self.key(action).name()).join(" ")
    }

    /// Gives an action another key. The action that had this key gets the old one.
    pub fn bind(&mut self, action: KeyAction, key: Key) {
        let old = self.key(action);
        if let Some(other) = self.0.iter_mut().find(|other| **other == key) {
            *other = old;
        }
        self.0[action as usize] = key;
    }
}

impl From<Vec<(KeyAction, String)>> for KeyMap {
    /// Actions that are not named, and those whose key has no such name, keep the key that they have at first.
    fn from(named: Vec<(KeyAction, String)>) -> Self {
        let mut map = Self::default();
        for (action, name) in named {
            if let Some(key) = Key::from_name(&name) {
                map.bind(action, key);
            }
        }
        map
    }
}

impl From<KeyMap> for Vec<(KeyAction, String)> {
    fn from(map: KeyMap) -> Self {
        KeyAction::ALL.map(|(action, _)| (action, map.key(action).name().to_owned())).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn actions_are_in_the_order_of_their_keys() {
        for (index, (action, key)) in KeyAction::ALL.into_iter().enumerate() {
            assert_eq!((action as usize, KeyMap::default().key(action)), (index, key));
        }
    }

    #[test]
    fn no_two_actions_have_one_key() {
        let mut map = KeyMap::default();
        map.bind(KeyAction::Roll, Key::W);
        assert_eq!((map.key(KeyAction::Roll), map.key(KeyAction::Ahead)), (Key::W, Key::R));
        map.bind(KeyAction::Roll, Key::W);
        assert_eq!(map.key(KeyAction::Roll), Key::W);
        map.bind(KeyAction::Punch, Key::Num1);
        assert_eq!(map.key(KeyAction::Punch), Key::Num1);
    }

    #[test]
    fn keys_come_back_by_name_and_unknown_names_are_left_out() {
        let mut map = KeyMap::default();
        map.bind(KeyAction::Shove, Key::F7);
        let text = ron::to_string(&map).unwrap();
        assert!(text.contains("(Shove,\"F7\")"), "{text}");
        assert_eq!(ron::from_str::<KeyMap>(&text).unwrap(), map);
        let read: KeyMap = ron::from_str("[(Roll, \"no such key\"), (Jump, \"Y\")]").unwrap();
        assert_eq!((read.key(KeyAction::Roll), read.key(KeyAction::Jump)), (Key::R, Key::Y));
        assert!(ron::from_str::<KeyMap>("[(Fly, \"Y\")]").is_err());
    }
}
