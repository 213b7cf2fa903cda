//! What is wrong is said, and nothing is lost.

mod common;

use std::sync::Arc;

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_policy_space::RapierArticulation;
use bevy_policy_space::prelude::*;
use bevy_rapier3d::plugin::context::{DefaultRapierContext, RapierContextSimulation};
use bevy_rapier3d::prelude::{RapierContextJoints, ReadRapierContext, WriteRapierContext};
use policy_core::CharacterPack;

use common::{
    body, game, game_with_assets, heard, pack_bytes, place, report, root_height, run, spawn, walk_to,
};

fn error_with(app: &App, words: &str) -> usize {
    heard(app).errors.iter().filter(|error| error.contains(words)).count()
}

/// Waits, in real time, for what the asset server does.
fn wait_until(app: &mut App, what: &str, done: impl Fn(&App) -> bool) {
    for _ in 0..400 {
        app.update();
        if done(app) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(25));
    }
    panic!("{what} within 10 s: {:?}", heard(app));
}

fn walks(app: &App, character: Entity) -> bool {
    root_height(app, character) > 0.7 && !report(app, character).fallen
}

#[test]
fn a_missing_pack_and_a_wrong_one_are_reported_once_and_a_right_one_then_starts() {
    let folder = std::env::temp_dir().join(format!("bevy_policy_space_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("wrong.pack.safetensors"), b"no pack at all").expect("a file");
    std::fs::write(folder.join("right.pack.safetensors"), pack_bytes()).expect("a file");
    let mut app = game_with_assets(64.0, folder.to_str().expect("a plain path"));
    let load = |app: &App, name: &'static str| app.world().resource::<AssetServer>().load(name);
    let missing = load(&app, "missing.pack.safetensors");
    let wrong = load(&app, "wrong.pack.safetensors");
    let character = app.world_mut().spawn(PolicyCharacter::new(missing)).id();
    app.world_mut().spawn(PolicyCharacter::new(wrong));
    wait_until(&mut app, "two reports", |app| heard(app).errors.len() == 2);
    assert_eq!(error_with(&app, "missing.pack.safetensors"), 1, "{:?}", heard(&app).errors);
    assert_eq!(error_with(&app, "wrong.pack.safetensors"), 1, "{:?}", heard(&app).errors);
    run(&mut app, 0.5);
    assert_eq!(heard(&app).errors.len(), 2, "not again in each frame");

    let right = load(&app, "right.pack.safetensors");
    app.world_mut().entity_mut(character).insert(PolicyCharacter::new(right));
    wait_until(&mut app, "a controller", |app| app.world().get::<RapierArticulation>(character).is_some());
    run(&mut app, 1.0);
    assert!(walks(&app, character));
    std::fs::remove_dir_all(&folder).expect("the folder is ours");
}

#[test]
fn a_new_pack_takes_over_in_mid_walk() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -100.0)));
    run(&mut app, 3.0);
    let before =
        app.world().get::<PolicyController>(character).expect("a controller").controller.pack().clone();
    let (z, ticks) = (place(&app, character).z, report(&app, character).ticks);
    let handle = app.world().get::<PolicyCharacter>(character).expect("a character").pack.clone();
    let new = PackAsset::from_bytes(&pack_bytes()).expect("a pack");
    app.world_mut().resource_mut::<Assets<PackAsset>>().insert(&handle, new).expect("the handle's place");
    run(&mut app, 3.0);
    let controller = app.world().get::<PolicyController>(character).expect("a controller");
    assert!(!Arc::ptr_eq(&before, controller.controller.pack()), "it has the new pack");
    assert_eq!(report(&app, character).node, "walk");
    assert!(place(&app, character).z < z - 1.5 && report(&app, character).ticks > ticks + 80);
    assert_eq!((heard(&app).fell, heard(&app).errors.len()), (0, 0), "{:?}", heard(&app));
}

#[test]
fn a_broken_file_under_a_running_character_changes_nothing() {
    let folder = std::env::temp_dir().join(format!("bevy_policy_space_reload_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("hero.pack.safetensors");
    std::fs::write(&file, pack_bytes()).expect("a file");
    let mut app = game_with_assets(64.0, folder.to_str().expect("a plain path"));
    let handle = app.world().resource::<AssetServer>().load("hero.pack.safetensors");
    let character = app.world_mut().spawn(PolicyCharacter::new(handle)).id();
    wait_until(&mut app, "a body", |app| app.world().get::<RapierArticulation>(character).is_some());
    run(&mut app, 1.0);
    std::fs::write(&file, b"half a fi").expect("a file");
    app.world().resource::<AssetServer>().reload("hero.pack.safetensors");
    wait_until(&mut app, "a report", |app| !heard(app).errors.is_empty());
    assert_eq!(error_with(&app, "hero.pack.safetensors"), 1, "{:?}", heard(&app).errors);
    run(&mut app, 1.0);
    assert!(walks(&app, character));

    // The right file again.
    let before =
        app.world().get::<PolicyController>(character).expect("a controller").controller.pack().clone();
    std::fs::write(&file, pack_bytes()).expect("a file");
    app.world().resource::<AssetServer>().reload("hero.pack.safetensors");
    wait_until(&mut app, "the new pack", |app| {
        let controller = app.world().get::<PolicyController>(character).expect("a controller");
        !Arc::ptr_eq(&before, controller.controller.pack())
    });
    assert!(walks(&app, character));
    std::fs::remove_dir_all(&folder).expect("the folder is ours");
}

/// The shipped pack with another manifest.
fn changed_pack(change: impl Fn(&mut policy_core::format::Manifest)) -> PackAsset {
    let sound = PackAsset::from_bytes(&pack_bytes()).expect("a pack").pack;
    let mut manifest = sound.manifest().clone();
    change(&mut manifest);
    let pack = CharacterPack::from_parts(manifest, sound.tensors().clone()).expect("a sound manifest");
    PackAsset { pack: Arc::new(pack) }
}

#[test]
fn a_pack_without_a_body_is_reported_once() {
    let mut app = game(64.0);
    let bodiless = changed_pack(|manifest| manifest.mjcf = None);
    let pack = app.world_mut().resource_mut::<Assets<PackAsset>>().add(bodiless);
    let character = app.world_mut().spawn(PolicyCharacter::new(pack)).id();
    run(&mut app, 0.5);
    assert_eq!(error_with(&app, "expected a pack with the MJCF"), 1, "{:?}", heard(&app).errors);
    assert!(app.world().get::<RapierArticulation>(character).is_none());
}

#[test]
fn a_pack_for_another_body_does_not_take_over() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    run(&mut app, 0.5);
    // A hinge the other way round.
    let other = changed_pack(|manifest| {
        let axis = &mut manifest.skeleton.joints[0].axis;
        *axis = axis.map(|number| -number);
    });
    let handle = app.world().get::<PolicyCharacter>(character).expect("a character").pack.clone();
    app.world_mut().resource_mut::<Assets<PackAsset>>().insert(&handle, other).expect("the handle's place");
    run(&mut app, 1.0);
    assert_eq!(error_with(&app, "same skeleton"), 1, "{:?}", heard(&app).errors);
    assert!(walks(&app, character));
}

#[test]
fn a_transform_that_is_not_finite_is_refused() {
    let mut app = game(64.0);
    let bad = Transform::from_xyz(f32::NAN, 0.0, 0.0);
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(bad);
    run(&mut app, 0.5);
    assert_eq!(error_with(&app, "finite Transform"), 1, "{:?}", heard(&app).errors);
    app.world_mut().entity_mut(character).insert(Transform::from_xyz(1.0, 0.0, 0.0));
    run(&mut app, 1.0);
    assert!(walks(&app, character));

    app.world_mut().entity_mut(character).insert(bad);
    run(&mut app, 1.0);
    assert_eq!(error_with(&app, "finite Transform"), 2, "{:?}", heard(&app).errors);
    assert!(walks(&app, character) && (place(&app, character).x - 1.0).abs() < 0.5);
    assert_eq!(heard(&app).errors.len(), 2, "{:?}", heard(&app).errors);
}

#[test]
fn a_transform_that_is_too_far_away_is_refused() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::X * 20_000.0);
    run(&mut app, 0.5);
    assert_eq!(error_with(&app, "m from the origin, found 20000 m"), 1, "{:?}", heard(&app).errors);
    app.world_mut().entity_mut(character).insert(Transform::from_xyz(1.0, 0.0, 0.0));
    run(&mut app, 1.0);
    assert!(walks(&app, character));
    for far in [Vec3::X * 20_000.0, Vec3::Z * -9_999.0, Vec3::Y * 1e30] {
        app.world_mut().entity_mut(character).insert(Transform::from_translation(far));
        run(&mut app, 0.5);
        assert!(place(&app, character).distance(Vec3::X) < 0.5, "{far}: {}", place(&app, character));
    }
    assert_eq!((heard(&app).errors.len(), error_with(&app, "from the origin")), (4, 4), "{:?}", heard(&app));
    assert!(walks(&app, character));
}

#[test]
fn a_second_problem_of_a_character_that_waits_is_reported_too() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::X * f32::NAN);
    run(&mut app, 0.2);
    app.world_mut().entity_mut(character).insert(Transform::from_xyz(0.0, 0.0, 20_000.0));
    run(&mut app, 0.2);
    assert_eq!(heard(&app).errors.len(), 2, "{:?}", heard(&app).errors);
    assert!(error_with(&app, "finite Transform") == 1 && error_with(&app, "from the origin") == 1);
}

#[test]
fn a_character_despawned_while_it_comes_in_leaves_nothing_behind() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    // All bodies are spawned, and the first gets its pose: in the same flush of commands.
    let mut poses = 0;
    app.add_observer(move |_: On<Insert<bevy_policy_space::BodyPose>>, mut commands: Commands| {
        poses += 1;
        if poses == 16 {
            commands.entity(character).try_despawn();
        }
    });
    run(&mut app, 0.5);
    assert!(app.world().get_entity(character).is_err());
    let left = app.world_mut().run_system_once(|context: ReadRapierContext| {
        let world = context.single().expect("one world");
        (world.rigidbody_set.bodies.len(), world.joints.multibody_joints.multibodies().count())
    });
    assert_eq!(left.expect("a system"), (0, 0));
    let mut names = app.world_mut().query::<&Name>();
    assert_eq!(names.iter(app.world()).filter(|name| name.as_str() == "head").count(), 0);
}

#[test]
fn two_default_contexts_are_reported() {
    let mut app = game(64.0);
    let another = app.world_mut().spawn((RapierContextSimulation::default(), DefaultRapierContext)).id();
    let character = spawn(&mut app, Vec3::ZERO);
    run(&mut app, 0.5);
    assert_eq!(error_with(&app, "one default context of Rapier for the character, found 2"), 1);
    app.world_mut().despawn(another);
    run(&mut app, 1.0);
    assert!(walks(&app, character) && heard(&app).errors.len() == 1, "{:?}", heard(&app).errors);
}

#[test]
fn forces_and_names_that_make_no_sense_are_refused() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    run(&mut app, 0.5);
    let torso = body(&app, character, "torso");
    app.world_mut()
        .entity_mut(torso)
        .insert(ExternalImpulse { impulse: Vec3::new(f32::NAN, 0.0, 0.0), ..default() });
    let command = CharacterCommand { skill: Some("no_such_skill".into()), ..default() };
    let command = CharacterCommand { goal: CharacterGoal::Node("no_such_node".into()), ..command };
    let command = CharacterCommand { target: Some(Vec3::splat(f32::NAN)), ..command };
    app.world_mut().entity_mut(character).insert(command);
    run(&mut app, 1.0);
    for words in ["finite force on \"torso\"", "skill of the pack", "node of the pack", "finite target"] {
        assert_eq!(error_with(&app, words), 1, "{words}: {:?}", heard(&app).errors);
    }
    assert!(walks(&app, character));
}

#[test]
fn physics_that_diverges_is_caught_and_the_character_stands_again() {
    for bad in [f32::NAN, 1e6] {
        let mut app = game(64.0);
        let character = spawn(&mut app, Vec3::new(2.0, 0.0, 0.0));
        run(&mut app, 1.0);
        let own = app.world().get::<RapierArticulation>(character).expect("a body").clone();
        let mut worlds = app.world_mut().query::<&mut RapierContextJoints>();
        let mut joints = worlds.single_mut(app.world_mut()).expect("one world");
        let link = *joints.multibody_joints.rigid_body_link(own.articulation().bodies()[3]).expect("a link");
        let multibody = joints.multibody_joints.get_multibody_mut(link.multibody).expect("a multibody");
        multibody.generalized_velocity_mut()[0] = bad;
        run(&mut app, 2.0);
        assert_eq!(error_with(&app, "diverged"), 1, "{bad}: {:?}", heard(&app).errors);
        assert!(walks(&app, character), "{bad}");
        assert!((place(&app, character) - Vec3::new(2.0, 0.0, 0.0)).length() < 0.5, "{bad}");
        app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(2.0, 0.0, -100.0)));
        run(&mut app, 6.0);
        assert!(place(&app, character).z < -2.0, "{bad}: it walks again");
    }
}

#[test]
fn what_the_game_removes_is_put_back() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    run(&mut app, 1.0);
    app.world_mut().entity_mut(character).remove::<CharacterCommand>();
    app.world_mut().entity_mut(character).remove::<CharacterReport>();
    app.world_mut().entity_mut(character).remove::<RapierCharacter>();
    run(&mut app, 0.5);
    for words in ["CharacterCommand", "CharacterReport", "RapierCharacter"] {
        assert_eq!(error_with(&app, words), 1, "{words}: {:?}", heard(&app).errors);
    }
    app.world_mut().entity_mut(character).remove::<Transform>();
    let head = body(&app, character, "head");
    app.world_mut().entity_mut(head).despawn();
    run(&mut app, 1.0);
    assert_eq!(error_with(&app, "PolicyBody"), 1, "{:?}", heard(&app).errors);
    assert_ne!(body(&app, character, "head"), head);
    let bodies = app.world().get::<PolicyBodies>(character).expect("bodies").entities();
    let index = |&entity: &Entity| app.world().get::<PolicyBody>(entity).expect("a body").index;
    assert_eq!(
        bodies.iter().map(index).collect::<Vec<_>>(),
        (0..15).collect::<Vec<_>>(),
        "in the order of the skeleton"
    );
    assert!(walks(&app, character));
}

/// Components that the plug-in itself added, one after the other, in mid-walk.
#[test]
fn what_the_plug_in_added_is_put_back_too() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -1000.0)));
    run(&mut app, 2.0);
    type Removal = fn(&mut World, Entity);
    let removals: [(&str, Removal); 6] = [
        ("PolicyController", |world, character| {
            world.entity_mut(character).remove::<PolicyController>();
        }),
        ("PolicyBodies", |world, character| {
            world.entity_mut(character).remove::<PolicyBodies>();
        }),
        ("BodyPose", |world, character| {
            world.entity_mut(character).remove::<bevy_policy_space::BodyPose>();
        }),
        ("RapierArticulation", |world, character| {
            world.entity_mut(character).remove::<RapierArticulation>();
        }),
        ("Transform of a body", |world, character| {
            let body = world.get::<PolicyBodies>(character).expect("bodies").entities()[3];
            world.entity_mut(body).remove::<Transform>();
        }),
        ("PolicyBody", |world, character| {
            let body = world.get::<PolicyBodies>(character).expect("bodies").entities()[0];
            world.entity_mut(body).remove::<PolicyBody>();
        }),
    ];
    for (name, remove) in removals {
        let before = place(&app, character);
        remove(app.world_mut(), character);
        run(&mut app, 3.0);
        assert!(walks(&app, character), "after {name} was removed: {:?}", heard(&app));
        let after = place(&app, character);
        assert!(after.distance(before) > 0.8, "it walks on after {name} was removed, {before} {after}");
        let bodies = app.world().get::<PolicyBodies>(character).expect("bodies").entities();
        let index = |&entity: &Entity| app.world().get::<PolicyBody>(entity).expect("a body").index;
        assert!(bodies.iter().map(index).eq(0..15), "{name}: bodies in the order of the skeleton");
        let pelvis = place(&app, body(&app, character, "pelvis"));
        assert!(pelvis.xz().distance(after.xz()) < 0.2, "{name}: {pelvis} {after}");
        let mut all = app.world_mut().query::<&PolicyBody>();
        assert_eq!(all.iter(app.world()).count(), 15, "{name}");
    }
    assert_eq!(heard(&app).fell, 0, "{:?}", heard(&app));
}

#[test]
fn a_body_taken_out_of_rapier_is_built_anew() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    run(&mut app, 1.0);
    let own = app.world().get::<RapierArticulation>(character).expect("a body").clone();
    let shin = own.articulation().bodies()[5];
    let removed = app.world_mut().run_system_once(move |mut context: WriteRapierContext| {
        let mut world = context.single_mut().expect("one world");
        let (simulation, bodies, joints) =
            (&mut *world.simulation, &mut *world.rigidbody_set, &mut *world.joints);
        bodies
            .bodies
            .remove(
                shin,
                &mut simulation.islands,
                &mut world.colliders.colliders,
                &mut joints.impulse_joints,
                &mut joints.multibody_joints,
                &mut bodies.soft_bodies,
                true,
            )
            .is_some()
    });
    assert!(removed.expect("a system"));
    run(&mut app, 2.0);
    assert_eq!(error_with(&app, "removed"), 1, "{:?}", heard(&app).errors);
    assert!(walks(&app, character));
}
