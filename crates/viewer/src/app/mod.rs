//! The demo's state between screen and world: clock, camera, pad, panels. No window and no device in here, so
//! that tests and pictures run the very same thing.
//!
//! Panels read an [`App`] and push [`ViewerCommand`]s; [`App::apply`] alone acts on them.

mod apply;
mod best;
mod clock;
mod command;
mod comparison;
mod first_steps;
mod key_help;
mod key_map;
mod keys;
mod latch;
mod layers;
mod layout;
mod panel_kind;
mod passing;
mod pick;
mod place;
mod plots;
mod preferences;
mod replay;
mod requests;
mod toasts;
mod tour;
mod user;

use std::sync::mpsc::Receiver;

use egui::Ui;
use glam::Vec3;
use policy_core::GamepadState;

use crate::analysis::Analysis;
use crate::camera::Camera;
use crate::panels;
use crate::replays::{Replaying, ReplayingError};
use crate::scene_setup::Trail;
use crate::sim::{Held, Simulation};
use crate::sound::{Ear, SpeakerState};
pub use best::Best;
pub use clock::Clock;
pub use command::{Record, ViewerCommand};
pub use comparison::Comparison;
pub use first_steps::{Doing, FirstStep, FirstSteps};
pub use key_help::{PAD, key_help};
pub use key_map::{KeyAction, KeyMap};
pub use keys::Keys;
use latch::Latch;
pub use layers::{Layers, Preset};
pub use layout::{KeptLayout, LAYOUT_VERSION, LayoutError, PanelLayout};
pub use panel_kind::{PanelKind, Side};
pub use pick::Grab;
pub use place::place;
pub use plots::{Plots, Series};
pub use preferences::{Preferences, Quality};
pub use replay::ReplayLine;
pub use toasts::{Toast, ToastKind, Toasts};
pub use tour::{IDLE_SECS, Tour};

/// What is known of pads, filled in by the reader of the pads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PadView {
    /// Name of the active pad and its back end.
    pub name: Option<String>,
    /// As reported.
    pub raw: GamepadState,
    /// After dead zones; neutral without a pad.
    pub state: GamepadState,
    /// Of a second player, once one has joined.
    pub second: Option<GamepadState>,
    /// What could not be read or understood, and what to do.
    pub problems: Vec<String>,
}

/// Something went wrong; the demo waits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What happened.
    pub what: String,
    /// The replay file: the state before it.
    pub replay: Option<String>,
    /// Indices of the characters that it happened to.
    pub characters: Vec<usize>,
}

/// The demo.
#[derive(Debug)]
pub struct App {
    /// Characters and ground.
    pub sim: Simulation,
    /// Pause and speed.
    pub clock: Clock,
    /// The eye.
    pub camera: Camera,
    /// The way walked.
    pub trail: Trail,
    /// Open panels, toggles, presets: what is remembered.
    pub layout: PanelLayout,
    /// Sliders of the layers.
    pub layers: Layers,
    /// Pads.
    pub pad: PadView,
    /// Keyboard as a pad.
    pub keys: Keys,
    /// Curves of the profiler and the gauges.
    pub plots: Plots,
    /// Principal components, once they are there.
    pub analysis: Option<Analysis>,
    /// What stops the demo.
    pub failure: Option<Failure>,
    /// Messages to the user.
    pub toasts: Toasts,
    /// What a newcomer has tried.
    pub first_steps: FirstSteps,
    /// Plays when there is no input.
    pub tour: Tour,
    /// The body under the mouse that is being pulled.
    pub grab: Option<Grab>,
    /// True while the help overlay is open.
    pub help: bool,
    /// True while the window of the preferences is open.
    pub choosing: bool,
    /// The action that the next key is for.
    pub rebinding: Option<KeyAction>,
    /// What the recorder is to do at the next frame; the frame composer takes it.
    pub record: Option<Record>,
    /// What is being recorded.
    pub recording: Option<String>,
    /// Name of the adapter, for the profiler.
    pub adapter: String,
    /// True while it asks whether to leave.
    pub leaving: bool,
    /// True when it is time to leave.
    pub quit: bool,
    /// False when there is no mesh to draw: then collision shapes are drawn.
    pub has_mesh: bool,
    /// The part of the window that no panel covered in the last frame, points.
    pub free: egui::Rect,
    /// A text field or drop-down was open in the last frame: the Escape key closes that.
    escape_taken: bool,
    /// What was refused a moment ago, and for how many seconds it is still said.
    refused: Option<(String, f32)>,
    /// Buttons of the pads that went down since the last tick.
    pad_taps: Latch,
    second_taps: Latch,
    /// Where the mouse was when it last moved by more than it jitters.
    mouse_at: Option<egui::Pos2>,
    /// True while what was used last is a pad: hints then name its buttons.
    uses_pad: bool,
    /// A script or a recording steers instead of the player.
    pub is_scripted: bool,
    /// A second player's pad was refused, which is said once.
    second_refused: bool,
    /// The triggers when a panel took over from them.
    overridden_at: GamepadState,
    /// The ground has changed: the frame composer uploads it and clears this.
    pub ground_changed: bool,
    /// The best time over the course of this scene.
    pub best: Best,
    /// What diverged in a shared world and was put right, so far.
    pub put_right: usize,
    /// What a comparison of blend modes needs besides the world.
    pub comparison: Comparison,
    /// Hears the world; the window plays what it heard.
    pub ear: Ear,
    /// Whether there is something to play it on.
    pub speaker: SpeakerState,
    /// Files that were dropped on the window; the frame composer opens them in turn.
    pub dropped: Vec<std::path::PathBuf>,
    /// Records the pad, or plays a replay.
    pub replaying: Replaying,
    /// The file of that, and how it ended.
    pub replay_line: ReplayLine,
    /// Why recording or playing ended before its time.
    pub replay_stopped: Option<ReplayingError>,
    analysis_soon: Option<Receiver<Analysis>>,
}

impl App {
    /// The demo of a world.
    #[must_use]
    pub fn new(sim: Simulation, layout: PanelLayout) -> Self {
        let mut camera = Camera::default();
        camera.mode = layout.camera;
        let player = sim.player();
        camera.set_size(player.state.root_height());
        camera.settle(player.state.root().position, player.state.ground_height);
        Self {
            layers: Layers::new(sim.pack()),
            clock: Clock::new(sim.tick_secs()),
            sim,
            camera,
            trail: Trail::default(),
            layout,
            pad: PadView::default(),
            keys: Keys::default(),
            plots: Plots::default(),
            analysis: None,
            failure: None,
            toasts: Toasts::default(),
            first_steps: FirstSteps::default(),
            tour: Tour::default(),
            grab: None,
            help: false,
            choosing: false,
            rebinding: None,
            record: None,
            recording: None,
            adapter: String::new(),
            leaving: false,
            quit: false,
            has_mesh: true,
            free: egui::Rect::ZERO,
            escape_taken: false,
            refused: None,
            pad_taps: Latch::default(),
            second_taps: Latch::default(),
            mouse_at: None,
            uses_pad: false,
            is_scripted: false,
            second_refused: false,
            overridden_at: GamepadState::default(),
            ground_changed: true,
            best: Best::default(),
            put_right: 0,
            comparison: Comparison::default(),
            ear: Ear::default(),
            speaker: SpeakerState::default(),
            dropped: Vec::new(),
            replaying: Replaying::Off,
            replay_line: ReplayLine::default(),
            replay_stopped: None,
            analysis_soon: None,
        }
    }

    /// Starts to work out the principal components on a thread of its own.
    pub fn start_analysis(&mut self) {
        self.analysis_soon = Some(Analysis::start(self.sim.pack().clone()));
    }

    /// What steers: the tour while it plays, else the pad, or the keyboard when the pad is at rest.
    #[must_use]
    pub fn input(&self) -> GamepadState {
        let pad = GamepadState { buttons: self.pad_taps.state(self.pad.state.buttons), ..self.pad.state };
        match self.tour.pad() {
            Some(pad) => pad,
            None if pad == GamepadState::default() => self.keys.state(),
            None => pad,
        }
    }

    /// True where hints name buttons of the pad instead of keys.
    #[must_use]
    pub fn uses_pad(&self) -> bool {
        self.uses_pad && self.pad.name.is_some()
    }

    /// All panels, keys and the mouse: one frame of the user's doing.
    pub fn ui(&mut self, ui: &mut Ui) {
        let mut commands = Vec::new();
        self.see_user(ui.ctx());
        ui.ctx().set_zoom_factor(self.layout.preferences.ui_scale);
        keys::read(ui, self, &mut commands);
        let free = panels::show(ui, self, &mut commands);
        self.free = free;
        pick::read(ui, self, free, &mut commands);
        for command in commands {
            self.apply(command);
        }
        keys::release(ui.ctx(), self);
    }

    /// Where the origin of what is held is in the picture, metres; `None` when it is gone.
    pub(crate) fn origin_of(&self, held: Held) -> Option<Vec3> {
        match held {
            Held::Body(index, _) if index >= self.sim.characters().len() => None,
            Held::Body(index, body) => {
                self.sim.poses(index, self.alpha()).positions.get(body.index()).copied()
            }
            Held::Prop(prop) => {
                let piece = self.sim.shared()?.pieces().iter().find(|piece| piece.handle == prop)?;
                Some(piece.pose(self.alpha()).0)
            }
        }
    }
}
