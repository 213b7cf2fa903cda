//! Packs, controllers and commands: everything that knows no physics.

use std::borrow::Cow;
use std::sync::Arc;

use bevy::asset::{AssetLoadFailedEvent, LoadState};
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use policy_core::{Command, Goal};

use crate::axes;
use crate::body;
use crate::character::{CharacterCommand, CharacterGoal, CharacterReport, PolicyCharacter, PolicyController};
use crate::messages::{CharacterError, CharacterProblem, Fell, Reported, Rose, SkillEnded, SkillStarted};
use crate::pack_asset::{PackAsset, PackLoader};

/// The three parts of a fixed step before the physics, in this order. A game that changes commands in the fixed
/// schedule does so before `Decide`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PolicySpaceSystems {
    /// Bodies are put into the physics and sensed.
    Sense,
    /// Controllers turn what is sensed and commanded into joint targets.
    Decide,
    /// Joint targets and forces are written to the physics.
    Actuate,
}

/// Packs as assets, controllers, commands, reports, messages. It needs [`AssetPlugin`].
pub struct CorePlugin {
    schedule: InternedScheduleLabel,
}

impl Default for CorePlugin {
    /// In [`FixedUpdate`].
    fn default() -> Self {
        Self::in_schedule(FixedUpdate)
    }
}

impl CorePlugin {
    /// In another fixed schedule.
    #[must_use]
    pub fn in_schedule(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern() }
    }
}

impl Plugin for CorePlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<PackAsset>().register_asset_loader(PackLoader);
        app.register_type::<PolicyCharacter>()
            .register_type::<CharacterCommand>()
            .register_type::<CharacterReport>()
            .register_type::<body::PolicyBody>()
            .register_type::<body::PolicyBodies>()
            .register_type::<body::BodyPose>();
        app.add_message::<SkillStarted>()
            .add_message::<SkillEnded>()
            .add_message::<Fell>()
            .add_message::<Rose>()
            .add_message::<CharacterError>();
        app.configure_sets(
            self.schedule,
            (PolicySpaceSystems::Sense, PolicySpaceSystems::Decide, PolicySpaceSystems::Actuate).chain(),
        );
        app.add_systems(PreUpdate, (put_back_components, start_characters, follow_packs).chain())
            .add_systems(self.schedule, count_ticks.before(PolicySpaceSystems::Sense))
            .add_systems(self.schedule, decide.in_set(PolicySpaceSystems::Decide))
            .add_systems(
                RunFixedMainLoop,
                body::interpolate.in_set(RunFixedMainLoopSystems::AfterFixedMainLoop),
            )
            .add_systems(PostUpdate, log_errors);
    }
}

/// Puts back what a character needs and a game removed.
fn put_back_components(
    mut commands: Commands,
    characters: Query<
        (Entity, Has<Transform>, Has<CharacterCommand>, Has<CharacterReport>),
        (
            With<PolicyCharacter>,
            Or<(Without<Transform>, Without<CharacterCommand>, Without<CharacterReport>)>,
        ),
    >,
    mut errors: MessageWriter<CharacterError>,
) {
    for (character, transform, command, report) in &characters {
        let mut entity = commands.entity(character);
        entity.try_insert_if_new((
            Transform::default(),
            CharacterCommand::default(),
            CharacterReport::default(),
        ));
        let parts = [("Transform", transform), ("CharacterCommand", command), ("CharacterReport", report)];
        for (component, _) in parts.into_iter().filter(|(_, there)| !there) {
            errors.write(CharacterProblem::Component { component }.of(character));
        }
    }
}

/// Gives a controller to each character whose pack is loaded.
fn start_characters(
    mut commands: Commands,
    waiting: Query<(Entity, &PolicyCharacter), Without<PolicyController>>,
    packs: Res<Assets<PackAsset>>,
    server: Res<AssetServer>,
    mut reported: Local<Reported>,
    mut errors: MessageWriter<CharacterError>,
) {
    reported.keep(|entity| waiting.contains(entity));
    for (entity, character) in &waiting {
        if let Some(asset) = packs.get(&character.pack) {
            commands.entity(entity).try_insert(PolicyController::new(asset, character.config));
        } else if let LoadState::Failed(error) = server.load_state(&character.pack) {
            let path = character.pack.path().map(ToString::to_string).unwrap_or_default();
            let problem = CharacterProblem::Load { path, reason: error.to_string() };
            reported.write(problem, entity, &mut errors);
        }
    }
}

/// Gives running controllers the pack of their handle when it changed.
fn follow_packs(
    mut characters: Query<(Entity, &PolicyCharacter, &mut PolicyController)>,
    packs: Res<Assets<PackAsset>>,
    mut failures: MessageReader<AssetLoadFailedEvent<PackAsset>>,
    mut errors: MessageWriter<CharacterError>,
) {
    // The asset server may send the same failure twice.
    let mut last = None;
    for failure in failures.read() {
        let words = (failure.path.to_string(), failure.error.to_string());
        if last.as_ref() == Some(&words) {
            continue;
        }
        for (entity, ..) in characters.iter().filter(|(_, character, _)| character.pack.id() == failure.id) {
            let (path, reason) = words.clone();
            errors.write(CharacterProblem::Load { path, reason }.of(entity));
        }
        last = Some(words);
    }
    for (entity, character, mut controller) in &mut characters {
        let Some(asset) = packs.get(&character.pack) else { continue };
        let known = |pack: &Arc<_>| Arc::ptr_eq(pack, &asset.pack);
        if known(controller.controller.pack()) || controller.refused.as_ref().is_some_and(known) {
            continue;
        }
        let controller = &mut *controller;
        match controller.controller.set_pack(asset.pack.clone()) {
            Ok(()) => {
                controller.rate = policy_core::FixedRate::new(asset.pack.control_hz());
                controller.refused = None;
            }
            Err(source) => {
                controller.refused = Some(asset.pack.clone());
                errors.write(CharacterProblem::Reload { source }.of(entity));
            }
        }
    }
}

fn count_ticks(time: Res<Time>, mut controllers: Query<&mut PolicyController>) {
    for mut controller in &mut controllers {
        controller.advance(time.delta_secs());
    }
}

/// Runs the control ticks that are due.
fn decide(
    mut characters: Query<(Entity, &mut PolicyController, &mut CharacterCommand, &mut CharacterReport)>,
    mut started: MessageWriter<SkillStarted>,
    mut ended: MessageWriter<SkillEnded>,
    mut fell: MessageWriter<Fell>,
    mut rose: MessageWriter<Rose>,
    mut errors: MessageWriter<CharacterError>,
) {
    for (entity, mut controller, mut command, mut report) in &mut characters {
        if controller.due == 0 {
            continue;
        }
        let controller = &mut *controller;
        let mut unknown = |kind, name: &Cow<'static, str>| {
            if !controller.unknown.contains(name) {
                controller.unknown.push(name.clone());
                errors.write(CharacterProblem::Unknown { kind, name: name.to_string() }.of(entity));
            }
        };
        let wanted = resolve(controller.controller.pack(), &command, &mut unknown);
        if command.skill.is_some() {
            command.skill = None;
        }
        let bad_target = command.target.filter(|target| !target.is_finite());
        if let (Some(found), false) = (bad_target, controller.target_refused) {
            errors.write(CharacterProblem::Target { found }.of(entity));
        }
        controller.target_refused = bad_target.is_some();
        let secs = controller.due as f32 * controller.rate.period_secs();
        controller.controller.tick(&controller.sensed, &wanted, secs);

        let tick = *controller.controller.report();
        let pack = controller.controller.pack();
        let name = |skill: policy_core::SkillId| pack.skills()[skill.index()].name.clone();
        if let Some((skill, end)) = tick.skill_ended {
            ended.write(SkillEnded { character: entity, skill, name: name(skill), end });
        }
        if let Some(skill) = tick.skill_started {
            started.write(SkillStarted { character: entity, skill, name: name(skill) });
        }
        let down = controller.controller.is_down();
        if down && !report.fallen {
            fell.write(Fell { character: entity });
        } else if report.fallen && !down {
            rose.write(Rose { character: entity });
        }
        report.ticks += 1;
        report.node.clone_from(&pack.graph().node(tick.position.nearest_node()).name);
        report.skill = tick.skill.map(|progress| name(progress.skill));
        report.fallen = down;
        report.velocity = axes::to_bevy(controller.sensed.root().linear_velocity);
        report.tick = tick;
    }
}

/// The command by ids of the pack. Names that it lacks go to `unknown`.
fn resolve(
    pack: &policy_core::CharacterPack,
    command: &CharacterCommand,
    unknown: &mut impl FnMut(&'static str, &Cow<'static, str>),
) -> Command {
    let goal = match &command.goal {
        CharacterGoal::Stay => Goal::Stay,
        CharacterGoal::Ids(goal) => *goal,
        CharacterGoal::Path { path, coordinate } => match pack.graph().path_named(path) {
            Some(path) => Goal::Path { path, coordinate: *coordinate },
            None => {
                unknown("path", path);
                Goal::Stay
            }
        },
        CharacterGoal::Node(node) => match pack.graph().node_named(node) {
            Some(node) => Goal::Node(node),
            None => {
                unknown("node", node);
                Goal::Stay
            }
        },
    };
    let skill = command.skill.as_ref().and_then(|name| {
        let skill = pack.skill_named(name);
        if skill.is_none() {
            unknown("skill", name);
        }
        skill
    });
    let target = command.target.filter(|target| target.is_finite()).map(axes::ground_from_bevy);
    let facing = command.facing.filter(|facing| facing.is_finite()).map(axes::ground_from_bevy);
    Command { target, facing, goal, skill, blend: command.blend }
}

fn log_errors(mut errors: MessageReader<CharacterError>) {
    for error in errors.read() {
        log::error!("{error}");
    }
}
