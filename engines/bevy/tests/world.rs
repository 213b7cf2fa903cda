//! Characters in a shared world: crates, hits, pause, despawn, the same run twice.

mod common;

use std::hash::{DefaultHasher, Hash, Hasher};

use bevy::ecs::system::{RunSystemOnce, SystemParam};
use bevy::prelude::*;
use bevy_policy_space::RapierArticulation;
use bevy_policy_space::prelude::*;
use bevy_rapier3d::plugin::context::RapierContextSimulation;
use bevy_rapier3d::prelude::{
    ActiveEvents, BevyPhysicsHooks, ColliderMassProperties, CollisionEvent, CollisionGroups, Group,
    QueryFilter, RapierConfiguration, RapierContextColliders, RapierPhysicsPlugin, RapierRigidBodySet,
    ReadRapierContext,
};
use common::{body, game, heard, place, report, root_height, run, spawn, walk_to};

/// A long crate of 3 kg: a walk may veer.
fn crate_at(app: &mut App, at: Vec3) -> Entity {
    app.world_mut()
        .spawn((
            RigidBody::Dynamic,
            Collider::cuboid(1.5, 0.2, 0.2),
            ColliderMassProperties::Mass(3.0),
            Transform::from_translation(at),
        ))
        .id()
}

#[test]
fn it_steps_onto_a_board_that_moves_and_no_other_character_is_its_ground() {
    let mut app = game(64.0);
    app.world_mut().spawn((
        RigidBody::Dynamic,
        Collider::cuboid(1.0, 0.05, 1.0),
        ColliderMassProperties::Mass(60.0),
        Transform::from_xyz(0.0, 0.05, 0.0),
    ));
    let characters = [Vec3::Y * 0.1, Vec3::X * 3.0].map(|at| spawn(&mut app, at));
    run(&mut app, 1.0);
    let ground = characters.map(|character| {
        app.world().get::<PolicyController>(character).expect("a controller").sensed.ground_height
    });
    assert!((ground[0] - 0.1).abs() < 0.01 && ground[1].abs() < 0.01, "{ground:?}");
}

#[test]
fn another_scale_puts_it_nowhere() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -100.0)));
    run(&mut app, 3.0);
    let before = place(&app, character).z;
    for frame in 0..128 {
        app.world_mut().get_mut::<Transform>(character).expect("a Transform").scale =
            Vec3::splat(1.0 + 0.01 * frame as f32);
        app.update();
    }
    assert!(
        place(&app, character).z < before - 1.0,
        "it walks on, from {before} to {}",
        place(&app, character)
    );
    assert!(app.world().get::<Transform>(character).expect("a Transform").scale.x > 2.0);
}

fn sensed_ground(app: &App, character: Entity) -> f32 {
    app.world().get::<PolicyController>(character).expect("a controller").sensed.ground_height
}

#[test]
fn what_its_groups_pass_through_is_no_ground() {
    let mut app = game(64.0);
    // It stands waist-deep in what is for others, and beside it a character that touches all.
    let ghost = CollisionGroups::new(Group::GROUP_2, Group::GROUP_2);
    let mist = (Collider::cuboid(1.0, 0.15, 1.0), ghost, Transform::from_xyz(0.0, 0.15, 0.0));
    app.world_mut().spawn(mist);
    let character = spawn(&mut app, Vec3::ZERO);
    let groups = CollisionGroups::new(Group::GROUP_1, Group::GROUP_1);
    app.world_mut().entity_mut(character).insert(RapierCharacter { groups, ..default() });
    run(&mut app, 1.0);
    assert!(sensed_ground(&app, character).abs() < 0.02, "{}", sensed_ground(&app, character));
}

#[test]
fn a_collider_hung_on_its_own_body_is_no_ground() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    run(&mut app, 1.0);
    // Just above the floor below the root.
    let pelvis = body(&app, character, "pelvis");
    let below = Transform::from_xyz(0.0, 0.0, 0.07 - root_height(&app, character));
    let hung = (Collider::ball(0.03), ColliderMassProperties::Mass(0.01), below, ChildOf(pelvis));
    let hung = app.world_mut().spawn(hung).id();
    run(&mut app, 0.5);
    let is_hung = app.world_mut().run_system_once(move |colliders: Query<&RapierContextColliders>| {
        let colliders = colliders.single().expect("one world");
        let handle = colliders.entity2collider().get(&hung).expect("a collider");
        colliders.colliders[*handle].parent().is_some()
    });
    assert!(is_hung.expect("a system"), "it is on the body");
    assert!(sensed_ground(&app, character).abs() < 0.02, "{}", sensed_ground(&app, character));
}

#[derive(SystemParam)]
struct MyHooks;

impl BevyPhysicsHooks for MyHooks {}

#[test]
fn a_game_with_hooks_of_its_own_has_one_rapier() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default()))
        .add_plugins(RapierPhysicsPlugin::<MyHooks>::default().in_fixed_schedule())
        .add_plugins(PolicySpacePlugins)
        .init_resource::<common::Heard>()
        .add_systems(Last, common::listen);
    app.finish();
    app.cleanup();
    app.update();
    let mut worlds = app.world_mut().query::<&RapierContextSimulation>();
    assert_eq!(worlds.iter(app.world()).count(), 1);
}

#[test]
fn it_pushes_a_crate() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    let pushed = crate_at(&mut app, Vec3::new(0.0, 0.2, -2.0));
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -100.0)));
    run(&mut app, 6.0);
    let moved = (place(&app, pushed) - Vec3::new(0.0, 0.2, -2.0)).xz().length();
    assert!(moved > 0.3, "the crate moved {moved} m");
    assert!(heard(&app).errors.is_empty(), "{:?}", heard(&app).errors);
}

#[test]
fn it_gets_up_after_a_hit() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    run(&mut app, 1.0);
    let standing = root_height(&app, character);
    let torso = body(&app, character, "torso");
    app.world_mut()
        .entity_mut(torso)
        .insert(ExternalImpulse { impulse: Vec3::new(150.0, 0.0, 0.0), ..default() });
    run(&mut app, 4.0);
    assert!(heard(&app).fell >= 1, "150 N s on the torso throw it down");
    run(&mut app, 15.0);
    let heard = heard(&app);
    assert!(heard.rose >= 1 && !heard.started.is_empty() && !heard.ended.is_empty(), "{heard:?}");
    assert!(!report(&app, character).fallen);
    assert!(root_height(&app, character) > 0.9 * standing);
    assert!(heard.errors.is_empty(), "{:?}", heard.errors);
}

#[test]
fn queries_and_events_name_the_bodies() {
    let mut app = game(64.0);
    app.init_resource::<Touched>().add_systems(Last, note_touches);
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut()
        .entity_mut(character)
        .insert(RapierCharacter { events: ActiveEvents::COLLISION_EVENTS, ..default() });
    run(&mut app, 1.0);
    let head = body(&app, character, "head");
    let above = app.world().get::<Transform>(head).expect("a Transform").translation.with_y(3.0);
    let hit = app
        .world_mut()
        .run_system_once_with(
            |In(from): In<Vec3>, context: ReadRapierContext| {
                let context = context.single().expect("one world");
                context
                    .cast_ray(from, Vec3::NEG_Y, 10.0, true, QueryFilter::default())
                    .map(|(entity, _)| entity)
            },
            above,
        )
        .expect("a system");
    assert_eq!(hit, Some(head));
    let feet = [body(&app, character, "left_foot"), body(&app, character, "right_foot")];
    let touched = &app.world().resource::<Touched>().0;
    assert!(feet.iter().any(|foot| touched.contains(foot)), "a foot touched the ground: {touched:?}");
}

#[derive(Resource, Default)]
struct Touched(Vec<Entity>);

fn note_touches(mut touched: ResMut<Touched>, mut events: MessageReader<CollisionEvent>) {
    for event in events.read() {
        let (CollisionEvent::Started(a, b, _) | CollisionEvent::Stopped(a, b, _)) = *event;
        touched.0.extend([a, b]);
    }
}

/// Bodies and colliders in Rapier's world.
fn counts(app: &mut App) -> (usize, usize) {
    let mut query = app.world_mut().query::<(&RapierRigidBodySet, &RapierContextColliders)>();
    let (bodies, colliders) = query.single(app.world()).expect("one world");
    (bodies.bodies.len(), colliders.colliders.len())
}

fn entities(app: &App) -> usize {
    app.world().entities().count_spawned() as usize
}

#[test]
fn despawning_leaves_nothing_behind() {
    let mut app = game(64.0);
    run(&mut app, 0.1);
    let (before, entities_before) = (counts(&mut app), entities(&app));
    let character = spawn(&mut app, Vec3::ZERO);
    let other = spawn(&mut app, Vec3::new(3.0, 0.0, 0.0));
    run(&mut app, 0.5);
    assert!(counts(&mut app).0 > before.0 + 30);
    app.world_mut().entity_mut(character).despawn();
    app.world_mut().entity_mut(other).remove::<PolicyCharacter>();
    run(&mut app, 0.5);
    assert_eq!(counts(&mut app), before);
    assert!(app.world().get::<PolicyController>(other).is_none());
    assert!(app.world().get::<RapierArticulation>(other).is_none());
    app.world_mut().entity_mut(other).despawn();
    assert_eq!(entities(&app), entities_before);
    assert!(heard(&app).errors.is_empty(), "{:?}", heard(&app).errors);
}

/// A hash of all that a character is.
fn hash(app: &App, character: Entity) -> u64 {
    let controller = app.world().get::<PolicyController>(character).expect("a controller");
    let mut state = policy_core::ControllerState::new(controller.controller.pack());
    controller.controller.save_into(&mut state);
    let mut bytes = vec![0; state.byte_len()];
    state.write_bytes(&mut bytes);
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    for body in &controller.sensed.bodies {
        body.position.to_array().map(f32::to_bits).hash(&mut hasher);
        body.rotation.to_array().map(f32::to_bits).hash(&mut hasher);
    }
    hasher.finish()
}

#[test]
fn two_runs_are_the_same() {
    let once = || {
        let mut app = game(64.0);
        let character = spawn(&mut app, Vec3::ZERO);
        crate_at(&mut app, Vec3::new(0.0, 0.2, -2.0));
        app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -100.0)));
        run(&mut app, 2.0);
        let middle = hash(&app, character);
        run(&mut app, 3.0);
        (middle, hash(&app, character))
    };
    let (first, second) = (once(), once());
    assert_eq!(first, second);
    assert_ne!(first.0, first.1, "the hash says something");
}

#[test]
fn pause_holds_everything_and_loses_nothing() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -100.0)));
    run(&mut app, 3.0);
    let (before, ticks) = (place(&app, character), report(&app, character).ticks);
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    run(&mut app, 2.0);
    assert_eq!((place(&app, character), report(&app, character).ticks), (before, ticks));
    app.world_mut().resource_mut::<Time<Virtual>>().unpause();

    // Rapier alone is stopped.
    let mut worlds = app.world_mut().query::<&mut RapierConfiguration>();
    worlds.single_mut(app.world_mut()).expect("one world").physics_pipeline_active = false;
    run(&mut app, 2.0);
    assert_eq!(report(&app, character).ticks, ticks);
    let mut worlds = app.world_mut().query::<&mut RapierConfiguration>();
    worlds.single_mut(app.world_mut()).expect("one world").physics_pipeline_active = true;
    run(&mut app, 3.0);
    assert!(place(&app, character).z < before.z - 1.0, "it walks on");
    assert_eq!(heard(&app).fell, 0);
}

#[test]
fn a_new_transform_puts_it_elsewhere() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    run(&mut app, 1.0);
    let there = Transform::from_xyz(5.0, 0.0, 7.0).looking_to(Vec3::X, Vec3::Y);
    app.world_mut().entity_mut(character).insert(there);
    run(&mut app, 1.0);
    let now = app.world().get::<Transform>(character).expect("a Transform");
    assert!((now.translation - there.translation).length() < 0.3, "{now:?}");
    assert!(now.forward().dot(Vec3::X) > 0.9, "{now:?}");
    assert_eq!(heard(&app).fell, 0);
}

#[test]
fn a_character_that_drops_into_a_void_stands_again_where_it_was() {
    let mut app = game(64.0);
    app.world_mut().spawn((Collider::cuboid(1.0, 0.5, 1.0), Transform::from_xyz(300.0, 0.0, 0.0)));
    let character = spawn(&mut app, Vec3::new(300.0, 0.5, 0.0));
    run(&mut app, 1.0);
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(300.0, 0.0, -100.0)));
    run(&mut app, 8.0);
    assert!(heard(&app).errors.iter().any(|error| error.contains("diverged")), "{:?}", heard(&app).errors);
    assert!(place(&app, character).y > -4.0, "{}", place(&app, character));
}

#[test]
fn transforms_are_interpolated_between_fixed_steps() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -100.0)));
    run(&mut app, 3.0);
    let quarter = std::time::Duration::from_secs_f64(1.0 / 256.0);
    app.world_mut().insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(quarter));
    let mut places = Vec::new();
    for _ in 0..16 {
        app.update();
        places.push(place(&app, character).z);
    }
    let steps: Vec<f32> = places.windows(2).map(|pair| pair[0] - pair[1]).collect();
    let most = steps.iter().copied().fold(0.0, f32::max);
    // Without interpolation three of four steps were zero and one was 16 mm.
    assert!(steps.iter().all(|&step| step > 0.0) && most < 0.01, "{steps:?}");
}
