//! Everything a panel, key or mouse can ask for.

use glam::{Vec2, Vec3};
use policy_core::contract::Settings;
use policy_core::{BlendMode, Goal, SkillId};

use super::{Grab, KeyAction, Layers, PanelKind, Preferences, Preset};
use crate::camera::CameraMode;
use crate::scene_setup::Shown;
use crate::sim::{Engine, GhostKind, GroundKind, SceneKind};

/// What to record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Record {
    /// One picture.
    Screenshot,
    /// One picture after another.
    Sequence,
    /// A film: MP4 with ffmpeg, else APNG.
    Video,
    /// No more.
    Stop,
}

/// A wish of the user, as data.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ViewerCommand {
    /// Go somewhere on the graph whatever the triggers say; `None` returns to the triggers.
    Goal(Option<Goal>),
    /// Blend per layer.
    Layers(Layers),
    /// Remember the sliders under a name.
    SavePreset(Preset),
    /// Forget a preset.
    DeletePreset(usize),
    /// How blends become actions.
    Mode(BlendMode),
    /// A second character under another mode or in another engine; `None` ends it.
    Ghost(Option<GhostKind>),
    /// All blend modes in a split screen, or what was before.
    Compare(bool),
    /// Start a skill.
    Skill(SkillId),
    /// Pause or continue.
    Pause(bool),
    /// One tick.
    Step,
    /// So many ticks before the newest state that is kept.
    Scrub(usize),
    /// One tick back.
    StepBack,
    /// Of real time.
    Speed(f32),
    /// Put every character back to the start.
    Reset,
    /// Gravity, friction, strength.
    Settings(Settings),
    /// Another engine.
    Engine(Engine),
    /// Another ground.
    Ground(GroundKind),
    /// What stands on the floor.
    Scene(SceneKind),
    /// So many characters.
    Characters(usize),
    /// Pull a body, or release it.
    Grab(Option<Grab>),
    /// Throw a ball from a point at what a line from there meets, metres, world space.
    Throw {
        /// The point.
        from: Vec3,
        /// Direction of the line.
        along: Vec3,
    },
    /// Put a prop where a line from a point meets something.
    Spawn {
        /// The point.
        from: Vec3,
        /// Direction of the line.
        along: Vec3,
    },
    /// How the camera moves.
    Camera(CameraMode),
    /// The camera behind the character, as at the start.
    ResetCamera,
    /// Turn the camera, radians, before the player's sensitivity.
    Turn(Vec2),
    /// Camera closer (below 1) or away.
    Zoom(f32),
    /// What is shown besides the characters.
    Shown(Shown),
    /// Open or close a panel.
    TogglePanel(PanelKind),
    /// Move a panel to the other side.
    SwapSide(PanelKind),
    /// Hide or show all panels.
    HidePanels(bool),
    /// Help overlay.
    Help(bool),
    /// Screenshot, sequence, film.
    Record(Record),
    /// Continue after a failure, from some ticks before it.
    RewindAfterFailure,
    /// Continue after a failure, from the start.
    ResetAfterFailure,
    /// Tell the user what was refused.
    Complain(String),
    /// A message was read: its place among those that are shown.
    DismissToast(usize),
    /// What the player has chosen once and for all.
    Preferences(Preferences),
    /// Open or close the window of the preferences.
    ChoosePreferences(bool),
    /// Give the next key that is pressed to an action; `None` gives up.
    Rebind(Option<KeyAction>),
    /// All preferences and panels as at the first start; presets stay.
    ResetPreferences,
    /// The first steps once more.
    RepeatFirstSteps,
    /// Ask whether to leave, or no longer.
    AskToQuit(bool),
    /// Leave.
    Quit,
}
