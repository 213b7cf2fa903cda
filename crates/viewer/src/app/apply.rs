//! The one place where commands act.

use std::path::Path;
use std::sync::Arc;

use glam::Vec3;
use policy_core::CharacterPack;

use super::{App, Clock, FirstSteps, Layers, PanelLayout, ViewerCommand};
use crate::appearance;
use crate::dropped::{Dropped, DroppedError};
use crate::render::Appearance;
use crate::sim::{Engine, GroundKind, SceneKind, SimConfig, SimError};

/// How far a failure is rewound, seconds.
const REWIND_SECS: f32 = 2.0;

/// Speed of a ball that is thrown at the mouse, metres per second.
const THROWN_MPS: f32 = 12.0;
/// It starts so far in front of the eye, metres.
const BEFORE_EYE_M: f32 = 0.6;

/// Commands that mean nothing while a clip is shown.
fn needs_a_simulation(command: &ViewerCommand) -> bool {
    use ViewerCommand as C;
    matches!(
        command,
        C::Goal(_)
            | C::Layers(_)
            | C::Mode(_)
            | C::Ghost(_)
            | C::Compare(_)
            | C::Skill(_)
            | C::Scrub(_)
            | C::StepBack
            | C::Settings(_)
            | C::Engine(_)
            | C::Ground(_)
            | C::Scene(_)
            | C::Throw { .. }
            | C::Spawn { .. }
            | C::Characters(_)
    )
}

/// Commands that change what a replay does not keep: the world, time, or what steers besides the pad.
fn spoils_a_replay(command: &ViewerCommand) -> bool {
    use ViewerCommand as C;
    matches!(
        command,
        C::Goal(Some(_))
            | C::Mode(_)
            | C::Compare(_)
            | C::Skill(_)
            | C::Scrub(_)
            | C::StepBack
            | C::Reset
            | C::Settings(_)
            | C::Engine(_)
            | C::Ground(_)
            | C::Scene(_)
            | C::Characters(_)
            | C::Grab(Some(_))
            | C::Throw { .. }
            | C::Spawn { .. }
    ) || matches!(command, C::Layers(layers) if layers.active)
}

impl App {
    /// Does what a command says. What can't be done is said in [`App::toasts`] and changes nothing.
    pub fn apply(&mut self, command: ViewerCommand) {
        if self.sim.playback().is_some() && needs_a_simulation(&command) {
            self.toasts.error("A clip is shown: there is nothing to steer and no physics.");
            return;
        }
        if !self.replaying.is_off() && spoils_a_replay(&command) {
            self.toasts.error(match command {
                ViewerCommand::Compare(_) => "You can't compare while a replay is recorded or played.",
                _ => "Not possible while a replay is recorded or played.",
            });
            return;
        }
        if self.views() > 1 && matches!(command, ViewerCommand::Mode(_) | ViewerCommand::Ghost(Some(_))) {
            self.toasts.error("Every blend mode has a view of its own: end the comparison first.");
            return;
        }
        match command {
            ViewerCommand::Goal(goal) => {
                self.sim.overrides.goal = goal;
                self.overridden_at = self.input();
            }
            ViewerCommand::Layers(layers) => {
                if layers.active && !self.layers.active {
                    self.overridden_at = self.input();
                }
                self.layers = layers;
            }
            ViewerCommand::SavePreset(preset) => {
                self.layout.presets.retain(|p| p.name != preset.name);
                self.layout.presets.push(preset);
            }
            ViewerCommand::DeletePreset(index) if index < self.layout.presets.len() => {
                self.layout.presets.remove(index);
            }
            ViewerCommand::DeletePreset(_) => {}
            ViewerCommand::Mode(mode) => {
                self.sim.set_blend_mode(mode);
                self.toasts.replace("Blend mode: ", mode.name());
            }
            ViewerCommand::Ghost(Some(kind)) => {
                if let Err(error) = self.sim.start_ghost(kind) {
                    self.toasts.error(error.to_string());
                }
            }
            ViewerCommand::Ghost(None) => self.sim.stop_ghost(),
            ViewerCommand::Compare(starts) => self.compare(starts),
            ViewerCommand::Skill(skill) => self.sim.overrides.skill = Some(skill),
            ViewerCommand::Camera(mode) => {
                self.camera.set_mode(mode);
                self.layout.camera = mode;
            }
            ViewerCommand::ResetCamera => {
                self.camera.reset(self.sim.player().heading());
                self.layout.camera = self.camera.mode;
            }
            ViewerCommand::Turn(by) => self.camera.turn(self.layout.preferences.mouse(by)),
            ViewerCommand::Zoom(factor) => self.camera.zoom(factor),
            ViewerCommand::Shown(shown) => self.layout.shown = shown,
            ViewerCommand::TogglePanel(kind) => self.layout.toggle(kind),
            ViewerCommand::SwapSide(kind) => self.layout.swap_side(kind),
            ViewerCommand::HidePanels(hidden) => {
                self.layout.hidden = hidden;
                self.toasts
                    .replace("Panels ", if hidden { "are hidden: Tab shows them" } else { "are shown" });
            }
            ViewerCommand::Help(open) => self.help = open,
            ViewerCommand::Record(what) => self.record = Some(what),
            ViewerCommand::Complain(what) => self.toasts.error(what),
            ViewerCommand::DismissToast(index) => self.toasts.dismiss(index),
            ViewerCommand::Preferences(preferences) => self.layout.preferences = preferences.clamped(),
            ViewerCommand::ChoosePreferences(open) => (self.choosing, self.rebinding) = (open, None),
            ViewerCommand::Rebind(action) => self.rebinding = action,
            ViewerCommand::ResetPreferences => self.reset_preferences(),
            ViewerCommand::RepeatFirstSteps => {
                self.first_steps = FirstSteps::default();
                self.layout.preferences.shows_first_steps = true;
            }
            ViewerCommand::AskToQuit(ask) => self.leaving = ask,
            ViewerCommand::Quit => self.quit = true,
            ViewerCommand::Grab(grab) => self.grab = grab,
            world => self.apply_to_world(world),
        }
    }

    /// Commands that act on time and physics.
    fn apply_to_world(&mut self, command: ViewerCommand) {
        match command {
            ViewerCommand::Pause(paused) => {
                self.clock.paused = paused;
                if !paused {
                    self.replay_line.ended = None;
                }
            }
            // Behind the window of a failure time stands still.
            ViewerCommand::Step if self.failure.is_some() => {}
            ViewerCommand::Step => (self.clock.paused, self.clock.steps) = (true, self.clock.steps + 1),
            ViewerCommand::StepBack => {
                let (kept, age) = self.sim.history();
                self.scrub((age + 1).min(kept));
            }
            ViewerCommand::Scrub(age) => self.scrub(age),
            ViewerCommand::Speed(speed) if speed.is_finite() => {
                let speed = speed.clamp(1.0 / 32.0, 8.0);
                self.clock.speed = speed;
                self.toasts.replace("Speed ", Clock::speed_name(speed));
            }
            ViewerCommand::Reset => self.restart(),
            ViewerCommand::Settings(settings) => {
                if let Err(error) = self.sim.set_settings(settings) {
                    self.toasts.error(error.to_string());
                }
            }
            ViewerCommand::Engine(engine) => self.rebuild(SimConfig { engine, ..*self.sim.config() }),
            ViewerCommand::Ground(ground) => self.rebuild(SimConfig { ground, ..*self.sim.config() }),
            ViewerCommand::Scene(scene) => self.change_scene(scene),
            ViewerCommand::Throw { from, along } => self.throw(from, along),
            ViewerCommand::Spawn { from, along } => self.spawn(from, along),
            ViewerCommand::Characters(characters) => {
                self.rebuild(SimConfig { characters, comparison: false, ..*self.sim.config() });
            }
            ViewerCommand::RewindAfterFailure => {
                let (kept, _) = self.sim.history();
                self.sim.rewind_to(((REWIND_SECS / self.sim.tick_secs()).round() as usize).min(kept));
                // Those that keep no history are still in the state that diverged.
                for index in self.failure.take().map_or_else(Vec::new, |failure| failure.characters) {
                    if index < self.sim.characters().len() && !self.sim.keeps_history(index) {
                        self.sim.stand_up(index);
                    }
                }
            }
            ViewerCommand::ResetAfterFailure => self.restart(),
            _ => {}
        }
    }

    fn reset_preferences(&mut self) {
        let presets = std::mem::take(&mut self.layout.presets);
        self.layout = PanelLayout { presets, ..PanelLayout::default() };
        self.camera.set_mode(self.layout.camera);
        self.first_steps = FirstSteps::default();
        self.toasts.note("All settings are as at the first start.");
    }

    fn scrub(&mut self, age: usize) {
        let engine = self.sim.engine();
        if !engine.keeps_history() {
            self.toasts.error(format!("{} keeps no history to go back to.", engine.title()));
            return;
        }
        self.clock.paused = true;
        self.sim.rewind_to(age);
    }

    /// Begins anew in another scene, with as many characters as it usually has, on ground and in an engine that it
    /// allows.
    fn change_scene(&mut self, scene: SceneKind) {
        let mut config = SimConfig { scene, comparison: false, ..*self.sim.config() };
        if scene != self.sim.config().scene || self.sim.config().comparison {
            config.characters = scene.usual_characters();
        }
        if scene == SceneKind::Playground {
            (config.ground, config.engine) = (GroundKind::Flat, Engine::Mujoco);
        }
        self.rebuild(config);
        let player = &self.sim.player().state;
        self.camera.settle(player.root().position, player.ground_height);
    }

    fn throw(&mut self, from: Vec3, along: Vec3) {
        let Some(shared) = self.sim.shared_mut() else { return self.nothing_to_throw() };
        // From in front of the eye, so that the ball does not fill the picture.
        if let Err(error) = shared.throw_at(from + along * BEFORE_EYE_M, along, THROWN_MPS) {
            self.toasts.error(error.to_string());
        }
    }

    fn spawn(&mut self, from: Vec3, along: Vec3) {
        let Some(shared) = self.sim.shared_mut() else { return self.nothing_to_throw() };
        if let Err(error) = shared.spawn_at(from, along) {
            self.toasts.error(error.to_string());
        }
    }

    fn nothing_to_throw(&mut self) {
        self.toasts.error("Balls and props are in the playground: the empty floor has none.");
    }

    fn restart(&mut self) {
        self.sim.reset();
        self.trail.clear();
        (self.failure, self.grab) = (None, None);
    }

    pub(super) fn rebuild(&mut self, config: SimConfig) {
        if config == *self.sim.config() {
            return;
        }
        match self.sim.rebuild(config) {
            Ok(()) => {
                self.trail.clear();
                (self.ground_changed, self.grab, self.failure) = (true, None, None);
            }
            Err(error) => self.toasts.error(error.to_string()),
        }
    }

    /// Begins anew with the characters of another pack.
    ///
    /// # Errors
    /// When its body can't be simulated; nothing is changed then.
    pub fn set_pack(&mut self, pack: Arc<CharacterPack>) -> Result<(), SimError> {
        self.sim.set_pack(Arc::clone(&pack))?;
        self.layers = Layers::new(&pack);
        self.clock.set_tick_secs(self.sim.tick_secs());
        let state = &self.sim.player().state;
        self.camera.set_size(state.root_height());
        self.camera.settle(state.root().position, state.ground_height);
        self.trail.clear();
        (self.analysis, self.failure, self.grab) = (None, None, None);
        self.start_analysis();
        Ok(())
    }

    /// Opens a file that was dropped on the window: a pack, or a mesh for the present character. Returns what it is and
    /// how characters look from now on.
    ///
    /// # Errors
    /// When it is neither, or does not fit; nothing is changed then.
    pub fn open_dropped(&mut self, path: &Path) -> Result<(&'static str, Appearance), DroppedError> {
        let rig = appearance::rig(self.sim.model());
        match Dropped::load(path, &rig)? {
            Dropped::Mesh(mesh) => Ok(("mesh", Appearance::new(rig.skeleton(), Some(*mesh)))),
            Dropped::Pack(_) if !self.replaying.is_off() => Err(DroppedError::Replaying),
            Dropped::Pack(pack) => {
                self.set_pack(Arc::clone(&pack))
                    .map_err(|source| DroppedError::Body { path: path.to_owned(), source })?;
                let (appearance, _) = appearance::of_pack(&pack, self.sim.model());
                Ok(("character pack", appearance))
            }
        }
    }
}
