//! The gaits that a pad can ask for, and how the pad is held for each.

use policy_core::{Bindings, Buttons, CharacterPack, GamepadState};

/// A way to hold the pad.
#[derive(Clone, Debug, PartialEq)]
pub struct Gait {
    /// Name in reports.
    pub name: &'static str,
    /// The pad: straight ahead, where the gait moves.
    pub pad: GamepadState,
    /// How far the stick is pushed in [0, 1] when the gait is asked to turn; a gait that stands sets off.
    pub push: f32,
    /// Index of the node to set off from: the one of a full stick and free triggers.
    pub start: usize,
    /// True for a way to set off from another gait, which is of use for turns alone.
    pub is_start: bool,
}

/// Which trigger or button leads to a gait.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Control {
    Stick,
    Speed,
    Stance,
    Style,
}

/// Name, control, node, and how far the stick is pushed while it settles and while it turns.
type Entry = (&'static str, Control, &'static str, f32, f32);

/// From standing with the stick pushed a little.
const LIGHT_STICK: &str = "idle_light_stick";

const GAITS: [Entry; 9] = [
    ("idle", Control::Stick, "idle", 0.0, 1.0),
    (LIGHT_STICK, Control::Stick, "idle", 0.0, 0.3),
    ("half_stick", Control::Stick, "walk", 0.5, 0.5),
    ("walk", Control::Stick, "walk", 1.0, 1.0),
    ("jog", Control::Speed, "jog", 1.0, 1.0),
    ("run", Control::Speed, "run", 1.0, 1.0),
    ("crouch", Control::Stance, "crouch", 1.0, 1.0),
    ("crawl", Control::Stance, "crawl", 1.0, 1.0),
    ("zombie_walk", Control::Style, "zombie_walk", 1.0, 1.0),
];

impl Gait {
    /// The gaits that a pack has, all reached from the second node of the speed path. Empty for a pack without one.
    #[must_use]
    pub fn all(pack: &CharacterPack) -> Vec<Gait> {
        GAITS.iter().filter_map(|entry| Gait::of(pack, *entry)).collect()
    }

    /// The gait called `name`, if the pack has it.
    #[must_use]
    pub fn named(pack: &CharacterPack, name: &str) -> Option<Gait> {
        Gait::all(pack).into_iter().find(|gait| gait.name == name)
    }

    fn of(pack: &CharacterPack, (name, control, node, push, turn_push): Entry) -> Option<Gait> {
        let graph = pack.graph();
        let bindings = Bindings::default();
        let speed = &graph.paths()[graph.path_named(&bindings.speed_path)?];
        let path = match control {
            Control::Stick | Control::Speed => speed,
            Control::Stance => &graph.paths()[graph.path_named(&bindings.stance_path)?],
            Control::Style => &graph.paths()[graph.path_named(&bindings.style_path)?],
        };
        let node = graph.node_named(node)?;
        let coordinate = path.nodes.iter().position(|n| *n == node)? as f32;
        let trigger = (coordinate - 1.0) / (path.end() - 1.0).max(1.0);
        let mut pad = GamepadState { left_stick: [0.0, push], ..GamepadState::default() };
        match control {
            Control::Stick => {}
            Control::Speed => pad.right_trigger = trigger,
            Control::Stance => pad.left_trigger = trigger,
            Control::Style => pad.buttons = Buttons::NONE.with(bindings.style_button),
        }
        let is_start = name == LIGHT_STICK;
        Some(Gait { name, pad, push: turn_push, start: *speed.nodes.get(1)?, is_start })
    }

    /// How far the stick is pushed while the gait settles, in [0, 1].
    #[must_use]
    pub fn settled_push(&self) -> f32 {
        self.pad.left_stick[1]
    }

    /// True when the gait moves.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.settled_push() > 0.0
    }
}
