//! What the player does, seen from outside: whether anybody steers, and which first steps are done.

use glam::Vec3;
use playground::RaceState;
use policy_core::GamepadState;

use super::first_steps::path;
use super::{App, Doing, Keys};
use crate::sim::SECOND_CHARACTER;

/// Height of the eyes above the root of a character without a head, metres.
const EYES_ABOVE_ROOT_M: f32 = 0.4;
/// A stick that is pushed less does not steer.
const STICK_REST: f32 = 0.05;

/// A mouse that moves by less only jitters, points.
const JITTER_POINTS: f32 = 3.0;

impl App {
    /// Notes whether the player touched mouse or keyboard in this frame: the tour waits, or ends.
    pub(super) fn see_user(&mut self, context: &egui::Context) {
        let events = context.input(|input| input.events.clone());
        let mut acts = false;
        for event in &events {
            acts |= self.is_doing(event);
        }
        if acts {
            self.interrupt_tour();
        }
    }

    /// True for what a player does. A mouse that jitters does nothing, and neither does one that is found in a window that opens or gets
    /// the focus.
    fn is_doing(&mut self, event: &egui::Event) -> bool {
        use egui::Event as E;
        match event {
            E::PointerMoved(at) => {
                let from = *self.mouse_at.get_or_insert(*at);
                let moves = from.distance(*at) > JITTER_POINTS;
                if moves {
                    self.mouse_at = Some(*at);
                }
                moves
            }
            E::PointerGone | E::WindowFocused(_) => {
                self.mouse_at = None;
                false
            }
            E::Key { pressed, .. } => *pressed,
            E::Text(_) | E::PointerButton { .. } | E::MouseWheel { .. } | E::Touch { .. } => true,
            _ => false,
        }
    }

    /// The tour ends, or waits anew. A run over the course that it began is not the player's.
    fn interrupt_tour(&mut self) {
        if self.tour.is_playing()
            && let Some(shared) = self.sim.shared_mut()
        {
            shared.restart_race();
        }
        self.tour.interrupt();
    }

    /// True while the tour may begin by itself: the player neither looks into the method nor is in the middle of something.
    fn may_begin_tour(&self) -> bool {
        let races = self.sim.shared().is_some_and(|shared| shared.race().state() == RaceState::Running);
        let overrides = self.sim.overrides.goal.is_some() || self.layers.active;
        let preferences = &self.layout.preferences;
        preferences.plays_tour && !preferences.advanced && !races && !overrides && self.grab.is_none()
    }

    /// Lets `dt` seconds of the clock on the wall pass for what waits for the player.
    pub(super) fn watch_user(&mut self, dt: f32) {
        let at_rest = |pad: &GamepadState| *pad == GamepadState::default();
        let steered = !at_rest(&self.pad.state)
            || self.pad.second.is_some_and(|pad| !at_rest(&pad))
            || self.keys != Keys::default();
        let busy = self.help || self.leaving || self.choosing || self.recording.is_some();
        let is_free = self.replaying.is_off();
        let runs = !self.clock.paused && self.failure.is_none() && self.sim.playback().is_none();
        if !at_rest(&self.pad.state) || self.keys != Keys::default() {
            self.uses_pad = !at_rest(&self.pad.state);
        }
        let wanted = self.tour.is_playing() || self.may_begin_tour();
        if wanted && runs && is_free && !busy && !steered {
            self.tour.advance(dt);
        } else {
            self.interrupt_tour();
        }
        self.toasts.advance(dt);
        if self.first_steps.are_over() {
            self.layout.preferences.shows_first_steps = false;
        }
    }

    /// Ticks off what the player has done in the last tick. The tour does not count.
    pub(super) fn observe_first_steps(&mut self, input: &GamepadState) {
        if self.tour.is_playing() || !self.layout.preferences.shows_first_steps {
            return;
        }
        let (player, pack) = (self.sim.player(), self.sim.pack());
        let share = |name: &str| {
            let path = path(pack, name)?;
            Some(path.coordinate(player.report().position)? / path.end().max(1.0))
        };
        let roll = pack.skill_named("roll");
        let doing = Doing {
            dt_secs: self.sim.tick_secs(),
            steers: input.left_stick.iter().any(|push| push.abs() > STICK_REST),
            speed_mps: player.speed(),
            speed_share: share("speed").unwrap_or(0.0),
            stance_share: share("stance").unwrap_or(0.0),
            rolls: roll.is_some() && player.report().skill.map(|s| s.skill) == roll,
            pull_newtons: self.grab.map_or(0.0, |grab| grab.force().length()),
        };
        self.first_steps.observe(&doing, pack);
    }

    /// Hands the second player's pad on, and says when a second player joins or leaves. Replays and the tour know one player.
    pub(super) fn follow_second(&mut self) {
        let alone = !self.replaying.is_off() || self.tour.is_playing();
        let taps = self.second_taps;
        let latched = |pad: GamepadState| GamepadState { buttons: taps.state(pad.buttons), ..pad };
        let wanted = self.pad.second.filter(|_| !alone).map(latched);
        let was = self.sim.has_second_player();
        let taken = self.sim.set_second_pad(wanted.as_ref());
        match (was, self.sim.has_second_player()) {
            (false, true) if self.pad.name.is_none() => {
                self.toasts
                    .note("A second player has joined. Press Start again to steer your own character.");
            }
            (false, true) => self.toasts.note("A second player has joined. Press Start to leave."),
            (true, false) => self.toasts.note("The second player has left."),
            _ if !taken && !self.second_refused => {
                self.toasts.error("A second player needs the playground and a second character there.");
            }
            _ => {}
        }
        self.second_refused = !taken;
    }

    /// The middle of the players' root bodies, `alpha` of the way into the last tick, and how far they are apart, metres.
    pub(super) fn middle(&self, alpha: f32) -> (Vec3, f32) {
        let root = |index| self.sim.poses(index, alpha).positions[0];
        let first = root(0);
        if !self.sim.has_second_player() {
            return (first, 0.0);
        }
        let second = root(SECOND_CHARACTER);
        (first.midpoint(second), first.distance(second))
    }

    /// Where the player's eyes are, `alpha` of the way into the last tick.
    pub(super) fn head(&self, alpha: f32) -> Vec3 {
        let positions = self.sim.poses(0, alpha).positions;
        match self.sim.pack().skeleton().head() {
            Some(head) => positions[head.index()],
            None => positions[0] + Vec3::Z * EYES_ABOVE_ROOT_M,
        }
    }
}
