//! What keys, mouse and pad do, in words for the help overlay.

use super::{KeyAction, KeyMap};

/// What the keys of play do, and keys and mouse besides, for the help overlay.
#[must_use]
pub fn key_help(map: &KeyMap) -> Vec<(String, &'static str)> {
    let key = |action| map.key(action).name().to_owned();
    let mut rows = vec![
        (format!("{}, arrows", map.walk()), "walk where the camera looks; with Shift half as fast"),
        (key(KeyAction::Faster), "hold to speed up; release to slow down gradually"),
        (key(KeyAction::Lower), "hold: lower, from a walk to a crawl"),
        (key(KeyAction::Style), "hold: the other style, where the character has one"),
        (
            key(KeyAction::Strafe),
            "hold: face where the camera looks and walk any way, where the character can",
        ),
        (key(KeyAction::GetUp), "get up"),
        (key(KeyAction::Roll), "roll"),
        (
            format!("{}, {}", key(KeyAction::Jump), key(KeyAction::Punch)),
            "jump, punch, where the character can",
        ),
        (key(KeyAction::Shove), "knock the character over"),
    ];
    rows.extend(OTHER_KEYS.map(|(key, does)| (key.to_owned(), does)));
    rows
}

/// What keys do that can't be changed.
const OTHER_KEYS: [(&str, &str); 14] = [
    ("right mouse, I O U L", "turn the camera; wheel: closer or away"),
    ("Home", "camera behind the character"),
    ("left mouse on a body", "pull it; in the playground also a prop"),
    ("T, Y", "in the playground: throw a ball at the mouse, put a prop there"),
    ("C", "camera: orbit, follow, first person, fixed, free"),
    ("P, N, B", "pause, one tick, one tick back"),
    ("minus, plus", "slower, faster"),
    ("Backspace", "back to the start"),
    ("M", "blend mode: parameters, actions, switch"),
    ("G", "ghost under another mode"),
    ("X", "collision shapes"),
    ("F2, F3", "screenshot, film"),
    ("F1, F4", "this help, settings"),
    ("Tab, Esc", "hide panels, leave (it asks first)"),
];

/// What pad controls do, for the help overlay.
pub const PAD: [(&str, &str); 12] = [
    ("left stick", "direction and speed"),
    ("right stick", "camera"),
    ("right stick, held down", "hold: face where the camera looks and walk any way"),
    ("right trigger", "faster: walk, jog, run"),
    ("left trigger", "lower: walk, crouch, crawl"),
    ("A or cross", "get up"),
    ("B or circle", "roll"),
    ("Y or triangle, X or square", "jump, punch, where the character can"),
    ("right shoulder", "hold: the other style, where the character has one"),
    ("left shoulder", "knock the character over"),
    ("d-pad up, down", "in the playground: throw a ball, put a prop down"),
    ("start", "in the playground: join or leave as a second player; elsewhere: pause"),
];
