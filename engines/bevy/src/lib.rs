//! Physics-based characters in Bevy, steered by blending the parameters of tiny policies.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_policy_space::prelude::*;
//!
//! fn main() {
//!     App::new()
//!         .add_plugins((DefaultPlugins, PolicySpacePlugins))
//!         .add_systems(Startup, setup)
//!         .run();
//! }
//!
//! fn setup(mut commands: Commands, assets: Res<AssetServer>) {
//!     commands.spawn((Collider::cuboid(50.0, 0.5, 50.0), Transform::from_xyz(0.0, -0.5, 0.0)));
//!     commands.spawn((
//!         PolicyCharacter::new(assets.load("humanoid.pack.safetensors")),
//!         CharacterCommand::along("speed", 1.0, Vec3::new(100.0, 0.0, 0.0)),
//!     ));
//! }
//! ```

pub mod axes;
mod body;
mod character;
mod core_plugin;
#[cfg(feature = "debug")]
mod debug;
mod input;
mod messages;
#[cfg(feature = "mujoco")]
mod mujoco;
mod pack_asset;
mod rapier;
#[cfg(feature = "render")]
mod shapes;
mod skin;

pub use body::{BodyPose, PolicyBodies, PolicyBody};
pub use character::{CharacterCommand, CharacterGoal, CharacterReport, PolicyCharacter, PolicyController};
pub use core_plugin::{CorePlugin, PolicySpaceSystems};
#[cfg(feature = "debug")]
pub use debug::{PolicyDebugPlugin, PolicyGizmos};
pub use input::{PlayerInput, PolicyInputPlugin};
pub use messages::{CharacterError, CharacterProblem, Fell, Rose, SkillEnded, SkillStarted};
#[cfg(feature = "mujoco")]
pub use mujoco::{
    MujocoBody, MujocoFixture, MujocoProp, MujocoPropBody, MujocoRefusal, MujocoWorld, PolicyMujocoPlugin,
};
pub use pack_asset::{PackAsset, PackLoadError, PackLoader};
pub use rapier::{PolicyRapierPlugin, RapierArticulation, RapierCharacter};
#[cfg(feature = "render")]
pub use shapes::{BodyMeshes, BodyMeshesPlugin};
pub use skin::{PolicySkin, PolicySkinPlugin};

/// The policies, as this crate uses them.
pub use policy_core;

/// MuJoCo, as this crate uses it: props, fixtures, terrain, worlds.
#[cfg(feature = "mujoco")]
pub use physics_bridge;

/// Everything that a game with characters names.
pub mod prelude {
    pub use crate::{
        CharacterCommand, CharacterError, CharacterGoal, CharacterProblem, CharacterReport, Fell, PackAsset,
        PlayerInput, PolicyBodies, PolicyBody, PolicyCharacter, PolicyController, PolicySkin,
        PolicySpacePlugins, PolicySpaceSystems, RapierCharacter, Rose, SkillEnded, SkillStarted,
    };
    pub use bevy_rapier3d::prelude::{Collider, ExternalForce, ExternalImpulse, Friction, RigidBody};
    pub use physics_rapier::Drive;
}

use bevy::app::{PluginGroup, PluginGroupBuilder};

/// All plug-ins: core, Rapier, input, skin, and those of the features.
#[derive(Clone, Copy, Debug, Default)]
pub struct PolicySpacePlugins;

impl PluginGroup for PolicySpacePlugins {
    fn build(self) -> PluginGroupBuilder {
        shown(
            PluginGroupBuilder::start::<Self>().add(CorePlugin::default()).add(PolicyRapierPlugin::default()),
        )
    }
}

/// The same with MuJoCo in place of Rapier.
#[cfg(feature = "mujoco")]
#[derive(Clone, Copy, Debug, Default)]
pub struct PolicySpaceMujocoPlugins;

#[cfg(feature = "mujoco")]
impl PluginGroup for PolicySpaceMujocoPlugins {
    fn build(self) -> PluginGroupBuilder {
        shown(
            PluginGroupBuilder::start::<Self>().add(CorePlugin::default()).add(PolicyMujocoPlugin::default()),
        )
    }
}

/// With the plug-ins that know no physics.
fn shown(group: PluginGroupBuilder) -> PluginGroupBuilder {
    let group = group.add(PolicyInputPlugin).add(PolicySkinPlugin);
    #[cfg(feature = "debug")]
    let group = group.add(PolicyDebugPlugin);
    #[cfg(feature = "render")]
    let group = group.add(BodyMeshesPlugin);
    group
}
