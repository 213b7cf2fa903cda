//! The one place where commands act.

use super::{App, Layers, ViewerCommand};
use crate::sim::{SimConfig, TICK_SECS};

/// How far a failure is rewound, seconds.
const REWIND_SECS: f32 = 2.0;

/// Commands that mean nothing while a clip is shown.
fn needs_a_simulation(command: &ViewerCommand) -> bool {
    use ViewerCommand as C;
    matches!(
        command,
        C::Goal(_)
            | C::Layers(_)
            | C::Mode(_)
            | C::Ghost(_)
            | C::Skill(_)
            | C::Scrub(_)
            | C::StepBack
            | C::Settings(_)
            | C::Ground(_)
            | C::Characters(_)
    )
}

impl App {
    /// Does what a command says. What can't be done is said in [`App::notice`] and changes nothing.
    pub fn apply(&mut self, command: ViewerCommand) {
        if self.sim.playback().is_some() && needs_a_simulation(&command) {
            self.notice = Some("A clip is shown: there is nothing to steer and no physics.".into());
            return;
        }
        match command {
            ViewerCommand::Goal(goal) => {
                self.sim.overrides.goal = goal;
                self.overridden_at = self.input();
            }
            ViewerCommand::Layers(layers) => self.layers = layers,
            ViewerCommand::SavePreset(preset) => {
                self.layout.presets.retain(|p| p.name != preset.name);
                self.layout.presets.push(preset);
            }
            ViewerCommand::DeletePreset(index) if index < self.layout.presets.len() => {
                self.layout.presets.remove(index);
            }
            ViewerCommand::DeletePreset(_) => {}
            ViewerCommand::Mode(mode) => self.sim.overrides.mode = mode,
            ViewerCommand::Ghost(Some(mode)) => self.sim.start_ghost(mode),
            ViewerCommand::Ghost(None) => self.sim.stop_ghost(),
            ViewerCommand::Skill(skill) => self.sim.overrides.skill = Some(skill),
            ViewerCommand::Camera(mode) => (self.camera.mode, self.layout.camera) = (mode, mode),
            ViewerCommand::Turn(by) => self.camera.turn(by),
            ViewerCommand::Zoom(factor) => self.camera.zoom(factor),
            ViewerCommand::Shown(shown) => self.layout.shown = shown,
            ViewerCommand::TogglePanel(kind) => self.layout.toggle(kind),
            ViewerCommand::SwapSide(kind) => self.layout.swap_side(kind),
            ViewerCommand::HidePanels(hidden) => self.layout.hidden = hidden,
            ViewerCommand::Help(open) => self.help = open,
            ViewerCommand::Record(what) => self.record = Some(what),
            ViewerCommand::DismissNotice => self.notice = None,
            ViewerCommand::AskToQuit(ask) => self.leaving = ask,
            ViewerCommand::Quit => self.quit = true,
            ViewerCommand::Grab(grab) => self.grab = grab,
            world => self.apply_to_world(world),
        }
    }

    /// Commands that act on time and physics.
    fn apply_to_world(&mut self, command: ViewerCommand) {
        match command {
            ViewerCommand::Pause(paused) => self.clock.paused = paused,
            ViewerCommand::Step => (self.clock.paused, self.clock.steps) = (true, self.clock.steps + 1),
            ViewerCommand::StepBack => {
                let (kept, age) = self.sim.history();
                self.scrub((age + 1).min(kept));
            }
            ViewerCommand::Scrub(age) => self.scrub(age),
            ViewerCommand::Speed(speed) if speed.is_finite() => {
                self.clock.speed = speed.clamp(1.0 / 32.0, 8.0);
            }
            ViewerCommand::Reset => self.restart(),
            ViewerCommand::Settings(settings) => {
                if let Err(error) = self.sim.set_settings(settings) {
                    self.notice = Some(error.to_string());
                }
            }
            ViewerCommand::Ground(ground) => self.rebuild(SimConfig { ground, ..*self.sim.config() }),
            ViewerCommand::Characters(characters) => {
                self.rebuild(SimConfig { characters, ..*self.sim.config() });
            }
            ViewerCommand::RewindAfterFailure => {
                let (kept, _) = self.sim.history();
                self.sim.rewind_to(((REWIND_SECS / TICK_SECS).round() as usize).min(kept));
                self.failure = None;
            }
            ViewerCommand::ResetAfterFailure => {
                self.failure = None;
                self.restart();
            }
            _ => {}
        }
    }

    fn scrub(&mut self, age: usize) {
        self.clock.paused = true;
        self.sim.rewind_to(age);
    }

    fn restart(&mut self) {
        self.sim.reset();
        self.trail.clear();
        self.grab = None;
    }

    fn rebuild(&mut self, config: SimConfig) {
        if config == *self.sim.config() {
            return;
        }
        match self.sim.rebuild(config) {
            Ok(()) => {
                self.trail.clear();
                (self.ground_changed, self.grab) = (true, None);
            }
            Err(error) => self.notice = Some(error.to_string()),
        }
    }

    /// Goes on with another pack.
    pub fn set_pack(&mut self, pack: std::sync::Arc<policy_core::CharacterPack>) {
        self.layers = Layers::new(&pack);
        self.sim.set_pack(pack);
        self.analysis = None;
        self.start_analysis();
    }
}
