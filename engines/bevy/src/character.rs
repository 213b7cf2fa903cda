//! The components of a character: what the game spawns, what it asks, and what it is told.

use std::borrow::Cow;

use bevy::prelude::*;
use policy_core::{Blend, CharacterState, Controller, ControllerConfig, FixedRate, TickReport};

use crate::pack_asset::PackAsset;

/// A character of a pack. Its [`Transform`] is the point on the ground below it and where it faces.
///
/// Once the pack is loaded, the character stands at its `Transform`, facing its forward (-z). From then on the
/// plug-in writes the `Transform`; writing another one puts the character there. It must have no parent.
///
/// ```
/// use bevy::prelude::*;
/// use bevy_policy_space::prelude::*;
///
/// fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
///     commands.spawn((
///         PolicyCharacter::new(assets.load("humanoid.pack.safetensors")),
///         CharacterCommand::along("speed", 1.0, Vec3::new(10.0, 0.0, 0.0)),
///         Transform::from_xyz(0.0, 0.0, 2.0),
///     ));
/// }
/// ```
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(Component, Default)]
#[require(Transform, CharacterCommand, CharacterReport)]
#[cfg_attr(feature = "render", require(Visibility))]
pub struct PolicyCharacter {
    /// The pack.
    pub pack: Handle<PackAsset>,
    /// Choices for its controller, used when it is made.
    #[reflect(ignore)]
    pub config: ControllerConfig,
}

impl PolicyCharacter {
    /// A character of this pack.
    #[must_use]
    pub fn new(pack: Handle<PackAsset>) -> Self {
        Self { pack, config: ControllerConfig::default() }
    }
}

/// Where on the graph of policies a character is to go.
#[derive(Reflect, Clone, Debug, Default, PartialEq)]
pub enum CharacterGoal {
    /// Stay where it is on the graph.
    #[default]
    Stay,
    /// A coordinate on a path: between its nodes `i` and `i + 1` lies `i + t`.
    Path {
        /// Name of the path, such as `speed`.
        path: Cow<'static, str>,
        /// Clamped to the path.
        coordinate: f32,
    },
    /// A node by its name, such as `walk`, on the cheapest way.
    Node(Cow<'static, str>),
    /// By ids, as a [`CommandMapper`](policy_core::CommandMapper) gives them.
    Ids(#[reflect(ignore)] policy_core::Goal),
}

/// What the game asks of a character. It holds until the game changes it.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default)]
pub struct CharacterCommand {
    /// Point to go to, metres, Bevy's world; its height does not matter. `None`: where it stands.
    pub target: Option<Vec3>,
    /// Direction to face, Bevy's world, of any length; its height does not matter. `None`: where it goes. Only a policy that strafes
    /// faces one way and moves another.
    pub facing: Option<Vec3>,
    /// Where on the graph to go.
    pub goal: CharacterGoal,
    /// Name of a skill to start once. It becomes `None` when the controller has taken it.
    pub skill: Option<Cow<'static, str>>,
    /// Blend weights that replace the position on the graph.
    #[reflect(ignore)]
    pub blend: Option<Blend>,
}

impl CharacterCommand {
    /// Goes to `target` at a coordinate of a path.
    #[must_use]
    pub fn along(path: impl Into<Cow<'static, str>>, coordinate: f32, target: Vec3) -> Self {
        Self {
            target: Some(target),
            goal: CharacterGoal::Path { path: path.into(), coordinate },
            ..Self::default()
        }
    }

    /// Goes to a node of the graph and to `target`.
    #[must_use]
    pub fn at_node(node: impl Into<Cow<'static, str>>, target: Vec3) -> Self {
        Self { target: Some(target), goal: CharacterGoal::Node(node.into()), ..Self::default() }
    }
}

/// What a character did in its last control tick.
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(Component, Default)]
pub struct CharacterReport {
    /// Control ticks completed.
    pub ticks: u64,
    /// The nearest node on the graph, by name.
    pub node: String,
    /// The skill that runs.
    pub skill: Option<String>,
    /// It has fallen and is not on its feet again.
    pub fallen: bool,
    /// Velocity of the root, metres per second, Bevy's world.
    pub velocity: Vec3,
    /// All that the controller says.
    #[reflect(ignore)]
    pub tick: TickReport,
}

/// The controller of a character. It is added when the pack is loaded.
#[derive(Component, Clone, Debug)]
pub struct PolicyController {
    /// Turns what is sensed into joint targets. Save and restore its state here.
    pub controller: Controller,
    /// What was sensed last. World space of the policies: z up; see [`axes`](crate::axes).
    pub sensed: CharacterState,
    /// The bodies when every joint is at zero, written by the physics.
    pub rest: CharacterState,
    /// True once the physics has put the body in. Before that it does not tick.
    pub embodied: bool,
    pub(crate) rate: FixedRate,
    /// Control ticks that this fixed step is to run.
    pub(crate) due: u32,
    pub(crate) ticked: bool,
    /// A pack that could not take the place of its own; reported once.
    pub(crate) refused: Option<std::sync::Arc<policy_core::CharacterPack>>,
    /// Names that were reported.
    pub(crate) unknown: Vec<Cow<'static, str>>,
    /// A target that is not finite was reported.
    pub(crate) target_refused: bool,
}

impl PolicyController {
    /// A controller for a pack, that has sensed nothing yet.
    #[must_use]
    pub fn new(asset: &PackAsset, config: ControllerConfig) -> Self {
        let state = CharacterState::new(asset.pack.skeleton());
        Self {
            controller: Controller::with_config(asset.pack.clone(), config),
            sensed: state.clone(),
            rest: state,
            embodied: false,
            rate: FixedRate::new(asset.pack.control_hz()),
            due: 0,
            ticked: false,
            refused: None,
            unknown: Vec::new(),
            target_refused: false,
        }
    }

    /// True in a fixed step that runs a control tick.
    #[must_use]
    pub fn is_due(&self) -> bool {
        self.due > 0
    }

    /// Counts the control ticks of a fixed step. The first step has one.
    pub(crate) fn advance(&mut self, step_secs: f32) {
        self.due = match (self.embodied, self.ticked) {
            (false, _) => 0,
            (true, false) => 1,
            (true, true) => self.rate.advance(step_secs),
        };
        self.ticked = self.embodied;
    }

    /// Starts anew, as after the character was put elsewhere.
    pub(crate) fn restart(&mut self) {
        self.controller.reset();
        self.ticked = false;
    }
}
