//! Reads gamepads for the demo: that of each player, and what could not be read, in words.

use gamepad::device::DeviceKey;
use gamepad::{Button, Buttons, Gamepads, Pad};

use crate::app::PadView;

/// All pads and their back ends.
pub struct Pads {
    pads: Gamepads,
    complaints: Vec<String>,
    players: Players,
}

/// Which pad is whose. Start makes a pad the second player's, or gives it back. Where there is no
/// character for a second player it pauses.
#[derive(Clone, Debug, Default, PartialEq)]
struct Players {
    second: Option<DeviceKey>,
    /// The first player's, as long as it does not use another.
    first: Option<DeviceKey>,
    /// Buttons of each pad in the poll before.
    held: Vec<(DeviceKey, Buttons)>,
}

impl Players {
    /// Takes the buttons of every pad, and the pad that was used last. True when Start went down and hands nothing over, as where no
    /// second player `may_join`.
    fn follow(&mut self, pads: Vec<(DeviceKey, Buttons)>, used: Option<DeviceKey>, may_join: bool) -> bool {
        let there = |key: &DeviceKey| pads.iter().any(|(pad, _)| pad == key);
        let before = |key: &DeviceKey| self.held.iter().find(|(pad, _)| pad == key).map(|(_, held)| *held);
        let pressed = pads.iter().find(|(key, now)| {
            now.contains(Button::Start) && before(key).is_some_and(|held| !held.contains(Button::Start))
        });
        let pauses = pressed.is_some() && !may_join;
        if let Some((key, _)) = pressed {
            self.second = if self.second == Some(*key) { None } else { Some(*key) };
        }
        self.second = self.second.filter(there).filter(|_| may_join);
        let mine = |key: &DeviceKey| there(key) && Some(*key) != self.second;
        let any = || pads.iter().map(|(key, _)| *key).find(mine);
        self.first = used.filter(mine).or(self.first.filter(mine)).or_else(any);
        self.held = pads;
        pauses
    }
}

impl std::fmt::Debug for Pads {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pads").field("complaints", &self.complaints).finish_non_exhaustive()
    }
}

impl Pads {
    /// Starts every back end that there is.
    #[must_use]
    pub fn start() -> Self {
        let (pads, errors) = Gamepads::with_all_backends();
        let complaints = errors.iter().map(ToString::to_string).collect();
        Self { pads, complaints, players: Players::default() }
    }

    /// Reads the pads. Without one the state is neutral. True when Start asks to pause or to continue, which it does where no second
    /// player `may_join`.
    pub fn poll(&mut self, view: &mut PadView, may_join: bool) -> bool {
        self.pads.poll();
        let pads = &self.pads;
        let held = pads.pads().map(|pad| (pad.device.key, pads.report_of(pad).state.buttons)).collect();
        let pauses = self.players.follow(held, pads.active().map(|pad| pad.device.key), may_join);
        let pad_of = |key: Option<DeviceKey>| pads.pads().find(|pad| Some(pad.device.key) == key);
        let (active, second) = (pad_of(self.players.first), pad_of(self.players.second));
        let name = |pad: &Pad| format!("{} through {:?}", pad.device.name, pad.device.source);
        view.name = active.map(name);
        let report = active.map(|pad| pads.report_of(pad)).unwrap_or_default();
        (view.raw, view.state) = (report.input.raw, report.state);
        view.second = second.map(|pad| pads.report_of(pad).state);
        view.problems.clear();
        view.problems.extend(self.complaints.iter().cloned());
        let unread = self.pads.problems().iter();
        view.problems.extend(unread.map(|(device, problem)| format!("{}: {problem}", device.name)));
        if let Some(error) = active.and_then(gamepad::Pad::last_error) {
            view.problems.push(format!("not understood: {error}"));
        }
        pauses
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: Buttons = Buttons::NONE;

    fn start() -> Buttons {
        let mut held = Buttons::NONE;
        held.set(Button::Start, true);
        held
    }

    #[test]
    fn start_gives_a_pad_to_the_second_player_and_back() {
        let (a, b) = (DeviceKey(1), DeviceKey(2));
        let mut players = Players::default();
        assert!(!players.follow(vec![(a, REST), (b, REST)], Some(a), true));
        assert_eq!((players.first, players.second), (Some(a), None));
        assert!(!players.follow(vec![(a, REST), (b, start())], Some(b), true));
        assert_eq!((players.first, players.second), (Some(a), Some(b)));
        // Held on, it does nothing more, and the second player's pad is never the first's.
        assert!(!players.follow(vec![(a, REST), (b, start())], Some(b), true));
        assert_eq!((players.first, players.second), (Some(a), Some(b)));
        assert!(!players.follow(vec![(a, REST), (b, REST)], Some(b), true));
        assert!(!players.follow(vec![(a, REST), (b, start())], Some(b), true));
        assert_eq!((players.first, players.second), (Some(b), None));
    }

    #[test]
    fn a_single_pad_can_be_the_second_players_beside_a_keyboard() {
        let a = DeviceKey(1);
        let mut players = Players::default();
        assert!(!players.follow(vec![(a, REST)], None, true));
        assert!(!players.follow(vec![(a, start())], Some(a), true));
        assert_eq!((players.first, players.second), (None, Some(a)));
        // Unplugged, nobody has it.
        assert!(!players.follow(vec![], None, true));
        assert_eq!((players.first, players.second), (None, None));
    }

    #[test]
    fn a_button_that_is_held_while_a_pad_connects_does_nothing() {
        let mut players = Players::default();
        assert!(!players.follow(vec![(DeviceKey(1), start())], Some(DeviceKey(1)), true));
        assert_eq!(players.second, None);
    }

    #[test]
    fn where_nobody_can_join_start_pauses_and_the_pad_stays_the_first_players() {
        let a = DeviceKey(1);
        let mut players = Players::default();
        assert!(!players.follow(vec![(a, REST)], Some(a), false));
        assert!(players.follow(vec![(a, start())], Some(a), false));
        assert!(!players.follow(vec![(a, start())], Some(a), false), "once");
        assert_eq!((players.first, players.second), (Some(a), None));
        // A second player whose character is gone gets its pad back as the first.
        players.second = Some(a);
        assert!(!players.follow(vec![(a, REST)], Some(a), false));
        assert_eq!((players.first, players.second), (Some(a), None));
    }
}
