//! A game without a window, and what tests ask of it.
#![allow(dead_code, reason = "each test binary uses a part of it")]

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_policy_space::prelude::*;

pub const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets");

/// The bytes of the shipped pack.
pub fn pack_bytes() -> Vec<u8> {
    std::fs::read(format!("{ASSETS}/humanoid.pack.safetensors")).expect("the shipped pack")
}

/// A game with a floor, at this fixed rate; each update is one fixed step.
pub fn game(hz: f64) -> App {
    game_with_assets(hz, ASSETS)
}

/// The same with another folder of assets.
pub fn game_with_assets(hz: f64, folder: &str) -> App {
    game_of(hz, AssetPlugin { file_path: folder.into(), ..default() })
}

/// The same, and files that change are loaded again.
pub fn game_that_watches(hz: f64, folder: &str) -> App {
    let watch_for_changes_override = Some(true);
    game_of(hz, AssetPlugin { file_path: folder.into(), watch_for_changes_override, ..default() })
}

fn game_of(hz: f64, assets: AssetPlugin) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, assets, PolicySpacePlugins))
        .insert_resource(Time::<Fixed>::from_hz(hz))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / hz)))
        .init_resource::<Heard>()
        .add_systems(Last, listen);
    app.finish();
    app.cleanup();
    app.world_mut().spawn((
        Collider::cuboid(100.0, 0.5, 100.0),
        Friction::coefficient(1.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
    app.update();
    app
}

/// What the game was told so far.
#[derive(Resource, Default, Debug)]
pub struct Heard {
    pub fell: usize,
    pub rose: usize,
    pub started: Vec<String>,
    pub ended: Vec<String>,
    pub errors: Vec<String>,
}

pub fn listen(
    mut heard: ResMut<Heard>,
    mut fell: MessageReader<Fell>,
    mut rose: MessageReader<Rose>,
    mut started: MessageReader<SkillStarted>,
    mut ended: MessageReader<SkillEnded>,
    mut errors: MessageReader<CharacterError>,
) {
    heard.fell += fell.read().count();
    heard.rose += rose.read().count();
    heard.started.extend(started.read().map(|message| message.name.clone()));
    heard.ended.extend(ended.read().map(|message| message.name.clone()));
    heard.errors.extend(errors.read().map(ToString::to_string));
}

pub fn heard(app: &App) -> &Heard {
    app.world().resource::<Heard>()
}

/// Adds the shipped pack to the assets.
pub fn pack(app: &mut App) -> Handle<PackAsset> {
    let asset = PackAsset::from_bytes(&pack_bytes()).expect("a sound pack");
    app.world_mut().resource_mut::<Assets<PackAsset>>().add(asset)
}

/// A character at a place, facing -z, that stands.
pub fn spawn(app: &mut App, at: Vec3) -> Entity {
    let pack = pack(app);
    app.world_mut().spawn((PolicyCharacter::new(pack), Transform::from_translation(at))).id()
}

/// A command to walk towards a far point.
pub fn walk_to(target: Vec3) -> CharacterCommand {
    CharacterCommand::along("speed", 1.0, target)
}

/// Runs so many seconds of updates.
pub fn run(app: &mut App, secs: f64) {
    let step = app.world().resource::<Time<Fixed>>().timestep().as_secs_f64();
    for _ in 0..(secs / step).round() as usize {
        app.update();
    }
}

pub fn place(app: &App, entity: Entity) -> Vec3 {
    app.world().get::<Transform>(entity).expect("a Transform").translation
}

pub fn report(app: &App, entity: Entity) -> &CharacterReport {
    app.world().get::<CharacterReport>(entity).expect("a report")
}

/// Height of the root above the ground, metres.
pub fn root_height(app: &App, entity: Entity) -> f32 {
    app.world().get::<PolicyController>(entity).expect("a controller").sensed.root_height()
}

/// The entity of a body, by name.
pub fn body(app: &App, character: Entity, name: &str) -> Entity {
    let bodies = app.world().get::<PolicyBodies>(character).expect("bodies");
    let named = |&&entity: &&Entity| app.world().get::<Name>(entity).is_some_and(|n| n.as_str() == name);
    *bodies.entities().iter().find(named).expect("a body of that name")
}
