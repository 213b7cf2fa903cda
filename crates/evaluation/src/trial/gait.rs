//! The gaits that a pad can ask for, and how the pad is held for each.

use policy_core::bindings::{Bindings, Control};
use policy_core::{Buttons, CharacterPack, GamepadState, NodeId};

use crate::chosen::{Chosen, Named};

/// A way to hold the pad.
#[derive(Clone, Debug, PartialEq)]
pub struct Gait {
    /// Name in reports.
    pub name: &'static str,
    /// The pad: straight ahead, where the gait moves.
    pub pad: GamepadState,
    /// How far the stick is pushed in [0, 1] when the gait is asked to turn; a gait that stands sets off.
    pub push: f32,
    /// The node to set off from: the one of a full stick and free triggers.
    pub start: NodeId,
    /// True for a way to set off from another gait, which is of use for turns alone.
    pub is_start: bool,
}

/// From standing with the stick pushed a little.
const LIGHT_STICK: &str = "idle_light_stick";

/// Name, node, and how far the stick is pushed while it settles and while it turns.
type Entry = (&'static str, &'static str, f32, f32);

const GAITS: [Entry; 10] = [
    ("idle", "idle", 0.0, 1.0),
    (LIGHT_STICK, "idle", 0.0, 0.3),
    ("half_stick", "walk", 0.5, 0.5),
    ("walk", "walk", 1.0, 1.0),
    ("jog", "jog", 1.0, 1.0),
    ("run", "run", 1.0, 1.0),
    ("crouch", "crouch", 1.0, 1.0),
    ("crawl", "crawl", 1.0, 1.0),
    ("zombie_walk", "zombie_walk", 1.0, 1.0),
    ("strafe", "strafe", 1.0, 1.0),
];

/// The gaits that can be measured, whether a pack has them or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GaitList;

impl Named for GaitList {
    fn names() -> Vec<&'static str> {
        GAITS.map(|(name, ..)| name).into()
    }
}

/// Some of the gaits.
pub type Gaits = Chosen<GaitList>;

impl Gaits {
    /// Those of them that a pack has.
    #[must_use]
    pub fn of(self, pack: &CharacterPack) -> Vec<Gait> {
        Gait::all(pack).into_iter().filter(|gait| self.contains(gait.name)).collect()
    }
}

impl Gait {
    /// The gaits that a pack has, all reached from the second node of the stick's path. Empty for a pack without one.
    #[must_use]
    pub fn all(pack: &CharacterPack) -> Vec<Gait> {
        GAITS.iter().filter_map(|entry| Gait::of(pack, *entry)).collect()
    }

    /// The gait called `name`, if the pack has it.
    #[must_use]
    pub fn named(pack: &CharacterPack, name: &str) -> Option<Gait> {
        Gait::all(pack).into_iter().find(|gait| gait.name == name)
    }

    fn of(pack: &CharacterPack, (name, node, push, turn_push): Entry) -> Option<Gait> {
        let (graph, bindings) = (pack.graph(), Bindings::default());
        let node = graph.node_named(node)?;
        let nodes = |path: &str| Some(graph.path(graph.path_named(path)?).nodes());
        let stick = nodes(&bindings.stick_path)?;
        let mut pad = GamepadState { left_stick: [0.0, push], ..GamepadState::default() };
        if let Some(index) = stick.iter().position(|n| *n == node) {
            // The second node is a full stick's; the rest of the path is the faster control's.
            press(&mut pad, bindings.faster, index as f32 - 1.0, stick.len() as f32 - 2.0);
        } else {
            let at_node = bindings.paths.iter().find_map(|binding| {
                let nodes = nodes(&binding.path)?;
                let index = nodes.iter().position(|n| *n == node)? as f32;
                Some((binding.control, index - binding.first, nodes.len() as f32 - 1.0 - binding.first))
            });
            let (control, way, whole) = at_node?;
            press(&mut pad, control, way, whole);
        }
        let is_start = name == LIGHT_STICK;
        Some(Gait { name, pad, push: turn_push, start: *stick.get(1)?, is_start })
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

/// Presses a control for `way` of the `whole`.
fn press(pad: &mut GamepadState, control: Control, way: f32, whole: f32) {
    let value = if whole > 0.0 { (way / whole).clamp(0.0, 1.0) } else { 0.0 };
    match control {
        Control::LeftTrigger => pad.left_trigger = value,
        Control::RightTrigger => pad.right_trigger = value,
        // A button leads to the end of its path.
        Control::Button(button) if way >= whole => pad.buttons = Buttons::NONE.with(button),
        Control::Button(_) | Control::None => {}
    }
}

#[cfg(test)]
mod tests {
    use policy_core::Button;

    use super::*;

    #[test]
    fn some_gaits_are_those_of_their_names_that_the_pack_has() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");
        let pack = CharacterPack::from_bytes(&std::fs::read(path).unwrap()).unwrap();
        let some = ["strafe", "walk"].iter().filter_map(|name| Gaits::from_name(name));
        let names: Vec<_> =
            some.fold(Gaits::NONE, Gaits::and).of(&pack).iter().map(|gait| gait.name).collect();
        assert_eq!(names, ["walk", "strafe"]);
        assert_eq!(Gaits::ALL.of(&pack), Gait::all(&pack));
        assert_eq!(Gaits::from_name("waddle"), None);
    }

    #[test]
    fn the_pad_of_a_gait_holds_what_leads_to_its_node() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");
        let pack = CharacterPack::from_bytes(&std::fs::read(path).unwrap()).unwrap();
        let pad = |name| Gait::named(&pack, name).unwrap().pad;
        assert_eq!((pad("run").right_trigger, pad("crawl").left_trigger), (1.0, 1.0));
        assert!(pad("zombie_walk").buttons.contains(Button::RightShoulder));
        assert!(pad("strafe").buttons.contains(Button::RightStick));
        assert_eq!(pad("walk"), GamepadState { left_stick: [0.0, 1.0], ..GamepadState::default() });
    }
}
