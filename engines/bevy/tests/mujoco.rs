//! The same components in MuJoCo: a character walks, pushes, is pushed, put elsewhere, reloaded, despawned. No window.

mod common;

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_policy_space::physics_bridge::{Prop, Solid, Terrain};
use bevy_policy_space::prelude::*;
use bevy_policy_space::{
    CorePlugin, MujocoBody, MujocoFixture, MujocoProp, MujocoPropBody, MujocoWorld, PolicyMujocoPlugin,
    PolicySpaceMujocoPlugins,
};

use common::{Heard, body, heard, listen, pack, pack_bytes, place, report, root_height, run, spawn, walk_to};

fn bare(hz: f64) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default()))
        .insert_resource(Time::<Fixed>::from_hz(hz))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / hz)))
        .init_resource::<Heard>()
        .add_systems(Last, listen);
    app
}

fn game(hz: f64) -> App {
    let mut app = bare(hz);
    app.add_plugins(PolicySpaceMujocoPlugins);
    app.finish();
    app.cleanup();
    app.update();
    app
}

fn refusals(app: &App) -> usize {
    app.world().resource::<Messages<bevy_policy_space::MujocoRefusal>>().len()
}

#[test]
fn it_walks_ten_metres_at_any_fixed_rate() {
    for hz in [64.0, 20.0, 144.0] {
        let mut app = game(hz);
        let character = spawn(&mut app, Vec3::new(3.0, 0.0, 0.0));
        app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(3.0, 0.0, -100.0)));
        run(&mut app, 20.0);
        assert_eq!((heard(&app).fell, heard(&app).errors.len()), (0, 0), "{hz}: {:?}", heard(&app).errors);
        let metres = -place(&app, character).z;
        println!("{metres} m at {hz} Hz");
        assert!(metres > 10.0, "{metres} m at {hz} Hz");
        // Below 30 Hz a step runs several ticks of physics and one of the controller.
        let expected = 20.0 * hz.min(30.0);
        let ticks = report(&app, character).ticks as f64;
        assert!((ticks - expected).abs() < 6.0, "{ticks} ticks at {hz} Hz");
        let pelvis = place(&app, body(&app, character, "pelvis"));
        assert!((pelvis.y - 0.9).abs() < 0.15 && (pelvis.z + metres).abs() < 0.3, "{pelvis}");
    }
}

#[test]
fn entities_move_smoothly_between_control_ticks() {
    let mut app = game(144.0);
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -100.0)));
    run(&mut app, 4.0);
    let mut last = place(&app, character).z;
    for _ in 0..144 {
        app.update();
        let now = place(&app, character).z;
        // About 1 m/s is 7 mm a frame; a whole control tick at once would be 35 mm.
        assert!((last - now).abs() < 0.02, "{} m in a frame", last - now);
        last = now;
    }
}

#[test]
fn props_and_fixtures_are_pushed_moved_refused_and_removed() {
    let mut app = game(64.0);
    let crate_at = Vec3::new(0.0, 0.2, -2.0);
    let solid = Solid::Cuboid { half_extents: Vec3::new(1.5, 0.2, 0.2) };
    let crate_ = app
        .world_mut()
        .spawn((MujocoProp::new(Prop::new(solid, 3.0)), Transform::from_translation(crate_at)))
        .id();
    let wall = Solid::Cuboid { half_extents: Vec3::new(5.0, 1.0, 0.1) };
    let wall = app.world_mut().spawn((MujocoFixture::new(wall), Transform::from_xyz(0.0, 1.0, 20.0))).id();
    let ball = MujocoProp::thrown(Prop::ball(0.1, 1.0), Vec3::new(0.0, 0.0, 8.0));
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 1.0, 12.0))).id();
    let heavy = MujocoProp::new(Prop::cube(0.4, f32::NAN));
    let refused = app.world_mut().spawn((heavy, Transform::from_xyz(5.0, 0.2, 5.0))).id();
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -100.0)));
    run(&mut app, 1.0);
    assert!(app.world().get::<MujocoPropBody>(refused).is_none());
    // It may fall back once the character has stumbled over it.
    let moved = (0..10).map(|_| {
        run(&mut app, 0.5);
        (place(&app, crate_) - crate_at).xz().length()
    });
    let farthest = moved.fold(0.0, f32::max);
    assert!(farthest > 0.3, "the crate moved {farthest} m");
    let thrown = place(&app, ball);
    assert!(thrown.z > 12.5 && thrown.z < 19.9, "the ball is before the wall, {thrown}");

    app.world_mut().entity_mut(crate_).insert(Transform::from_xyz(6.0, 0.2, 6.0));
    run(&mut app, 0.5);
    assert!(place(&app, crate_).distance(Vec3::new(6.0, 0.2, 6.0)) < 0.05, "{}", place(&app, crate_));
    app.world_mut().entity_mut(crate_).insert(Transform::from_xyz(f32::NAN, 0.2, 6.0));
    app.update();
    assert!(place(&app, crate_).is_finite() && refusals(&app) > 0);

    for entity in [crate_, wall, ball] {
        app.world_mut().despawn(entity);
    }
    run(&mut app, 0.5);
    let world = app.world().resource::<MujocoWorld>().world().expect("a world");
    assert_eq!((world.props().count(), world.fixtures().count(), world.characters().count()), (0, 0, 1));
    assert!(heard(&app).errors.is_empty(), "{:?}", heard(&app).errors);
}

#[test]
fn one_that_mujoco_refuses_keeps_no_other_out() {
    let mut app = game(64.0);
    // More kinds of contact than one world can tell apart.
    let sound = PackAsset::from_bytes(&pack_bytes()).expect("a pack").pack;
    let mut manifest = sound.manifest().clone();
    let bits = r#"contype="1048575" conaffinity="1048574""#;
    manifest.mjcf = manifest.mjcf.map(|mjcf| mjcf.replace(r#"contype="5" conaffinity="2""#, bits));
    let changed = policy_core::CharacterPack::from_parts(manifest, sound.tensors().clone()).expect("a pack");
    let asset = PackAsset { pack: std::sync::Arc::new(changed) };
    let refused = app.world_mut().resource_mut::<Assets<PackAsset>>().add(asset);
    let sound = spawn(&mut app, Vec3::ZERO);
    let refused =
        app.world_mut().spawn((PolicyCharacter::new(refused), Transform::from_xyz(5.0, 0.0, 0.0))).id();
    let late = spawn(&mut app, Vec3::new(-5.0, 0.0, 0.0));
    run(&mut app, 1.0);
    let is_in = |app: &App, entity| app.world().get::<MujocoBody>(entity).is_some();
    assert_eq!([sound, refused, late].map(|entity| is_in(&app, entity)), [true, false, true]);
    assert_eq!(heard(&app).errors.len(), 1, "{:?}", heard(&app).errors);
    assert!(root_height(&app, sound) > 0.7 && root_height(&app, late) > 0.7);
}

#[test]
fn a_fixture_is_where_its_parent_puts_it_and_a_prop_has_none() {
    let mut app = game(64.0);
    let parent = app.world_mut().spawn(Transform::from_xyz(10.0, 0.0, 0.0)).id();
    let wall = MujocoFixture::new(Solid::Cuboid { half_extents: Vec3::new(1.0, 1.0, 0.1) });
    app.world_mut().spawn((wall, Transform::from_xyz(0.0, 1.0, 4.0), ChildOf(parent)));
    let crate_ = MujocoProp::new(Prop::cube(0.4, 3.0));
    let crate_ = app.world_mut().spawn((crate_, Transform::from_xyz(0.0, 0.2, 2.0), ChildOf(parent))).id();
    spawn(&mut app, Vec3::ZERO);
    run(&mut app, 0.5);
    let world = app.world().resource::<MujocoWorld>().world().expect("a world");
    let fixture = world.fixtures().next().expect("a wall");
    let at = world.fixture(fixture).expect("a wall").position;
    assert!(at.distance(Vec3::new(10.0, -4.0, 1.0)) < 1e-4, "{at}");
    assert!(world.props().next().is_none() && app.world().get::<MujocoPropBody>(crate_).is_none());
}

#[test]
fn a_prop_despawned_while_it_comes_in_leaves_nothing_behind() {
    let mut app = game(64.0);
    spawn(&mut app, Vec3::ZERO);
    run(&mut app, 0.5);
    app.add_observer(|added: On<Add<MujocoPropBody>>, mut commands: Commands| {
        commands.entity(added.entity).try_despawn();
    });
    // The second is gone when the first comes in, and both leave the world.
    let at = |x: f32| (MujocoProp::new(Prop::cube(0.4, 3.0)), Transform::from_xyz(x, 0.2, 5.0));
    let first = app.world_mut().spawn((at(0.0).0, Transform::default())).id();
    app.world_mut().spawn((at(4.0), ChildOf(first)));
    run(&mut app, 0.5);
    let world = app.world().resource::<MujocoWorld>().world().expect("a world");
    assert_eq!(world.props().count(), 0);
}

#[test]
fn pushes_despawn_and_a_removed_component() {
    let mut app = game(64.0);
    let [character, other] = [0.0, 4.0].map(|x| spawn(&mut app, Vec3::new(x, 0.0, 0.0)));
    run(&mut app, 1.0);
    let torso = body(&app, character, "torso");
    let impulse = ExternalImpulse { impulse: Vec3::new(0.0, 0.0, 200.0), ..default() };
    app.world_mut().entity_mut(torso).insert(impulse);
    run(&mut app, 6.0);
    assert_eq!((heard(&app).fell, heard(&app).rose), (1, 1), "it fell and rose");
    assert!(place(&app, character).z > 0.3);

    app.world_mut().entity_mut(torso).insert(ExternalForce { force: Vec3::splat(f32::NAN), ..default() });
    run(&mut app, 0.2);
    assert!(heard(&app).errors.iter().any(|error| error.contains("finite force on \"torso\"")));
    app.world_mut().entity_mut(torso).remove::<ExternalForce>();
    let head = body(&app, character, "head");
    app.world_mut().entity_mut(head).despawn();
    run(&mut app, 0.5);
    assert_ne!(body(&app, character, "head"), head);

    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -1000.0)));
    app.world_mut().entity_mut(character).remove::<PolicyController>();
    run(&mut app, 3.0);
    assert!(report(&app, character).velocity.length() > 0.5, "it walks on with a new controller");
    app.world_mut().entity_mut(character).remove::<MujocoBody>();
    run(&mut app, 3.0);
    assert!(report(&app, character).velocity.length() > 0.5, "it walks on with a new body");
    let bodies = app.world().get::<PolicyBodies>(character).expect("bodies").entities();
    assert_eq!(bodies.len(), 15);

    app.world_mut().despawn(other);
    app.world_mut().entity_mut(character).remove::<PolicyCharacter>();
    run(&mut app, 0.2);
    let world = app.world().resource::<MujocoWorld>().world().expect("a world");
    assert_eq!(world.characters().count(), 0);
    let mut bodies = app.world_mut().query::<&PolicyBody>();
    assert_eq!(bodies.iter(app.world()).count(), 0);
    assert!(app.world().get_entity(character).is_ok());
}

#[test]
fn a_bad_transform_is_refused_and_a_good_one_puts_it_there() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    run(&mut app, 0.5);
    for (index, (bad, words)) in [(f32::NAN, "finite Transform"), (1e9, "can stand")].into_iter().enumerate()
    {
        app.world_mut().entity_mut(character).insert(Transform::from_xyz(bad, 0.0, 0.0));
        run(&mut app, 0.5);
        assert_eq!(heard(&app).errors.len(), index + 1, "{:?}", heard(&app).errors);
        assert!(heard(&app).errors[index].contains(words), "{:?}", heard(&app).errors);
        assert!(place(&app, character).length() < 0.5);
    }
    let there = Vec3::new(-7.0, 0.0, 5.0);
    app.world_mut().entity_mut(character).insert(Transform::from_translation(there));
    run(&mut app, 1.0);
    assert!(place(&app, character).distance(there) < 0.5, "{}", place(&app, character));
    assert!(root_height(&app, character) > 0.7);
    // Taken out behind the plug-in's back, it comes in again.
    let handle = app.world().get::<MujocoBody>(character).expect("a body").handle();
    let mut world = app.world_mut().resource_mut::<MujocoWorld>();
    world.world_mut().expect("a world").edit(|edit| edit.remove_character(handle)).expect("it is there");
    run(&mut app, 1.0);
    assert!(
        heard(&app).errors.last().is_some_and(|error| error.contains("removed")),
        "{:?}",
        heard(&app).errors
    );
    assert!(app.world().get::<MujocoBody>(character).is_some_and(|body| body.handle() != handle));
    assert!(place(&app, character).distance(there) < 0.5 && root_height(&app, character) > 0.7);
}

#[test]
fn a_new_pack_takes_over_in_mid_walk() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(walk_to(Vec3::new(0.0, 0.0, -100.0)));
    run(&mut app, 3.0);
    let before = place(&app, character).z;
    // The same policies for a heavier head: another body.
    let sound = PackAsset::from_bytes(&pack_bytes()).expect("a pack").pack;
    let mut manifest = sound.manifest().clone();
    manifest.mjcf = manifest.mjcf.map(|mjcf| mjcf.replace("density=\"1081\"", "density=\"1200\""));
    let changed = policy_core::CharacterPack::from_parts(manifest, sound.tensors().clone()).expect("a pack");
    let handle = app.world().get::<PolicyCharacter>(character).expect("a character").pack.clone();
    let asset = PackAsset { pack: std::sync::Arc::new(changed) };
    app.world_mut().resource_mut::<Assets<PackAsset>>().insert(&handle, asset).expect("the handle's place");
    run(&mut app, 3.0);
    assert_eq!((heard(&app).fell, heard(&app).errors.len()), (0, 0), "{:?}", heard(&app).errors);
    assert!(place(&app, character).z < before - 1.5, "from {before} to {}", place(&app, character).z);
    let world = app.world().resource::<MujocoWorld>().world().expect("a world");
    let own = app.world().get::<MujocoBody>(character).expect("a body").handle();
    assert!(world.model(own).expect("there").mass_kg() > 49.0);
}

#[test]
fn two_runs_are_the_same_and_terrain_is_the_ground() {
    let run_once = || {
        let mut app = bare(64.0);
        let hills = Terrain::Wavy { height_m: 0.35, wavelength_m: 6.0, seed: 7 };
        app.add_plugins((CorePlugin::default(), PolicyMujocoPlugin::default().on(hills)));
        app.finish();
        app.cleanup();
        let pack = pack(&mut app);
        let at = Transform::from_xyz(3.0, 0.0, 0.0);
        let walk = walk_to(Vec3::new(3.0, 0.0, -100.0));
        let character = app.world_mut().spawn((PolicyCharacter::new(pack), at, walk)).id();
        run(&mut app, 4.0);
        let height = place(&app, character).y;
        assert!(height > 0.001, "on a hill, {height} m");
        app.world().resource::<MujocoWorld>().world().expect("a world").save().hash()
    };
    assert_eq!(run_once(), run_once());
}

#[test]
#[should_panic(expected = "one physics")]
fn both_engines_at_once_are_refused() {
    let mut app = bare(64.0);
    app.add_plugins((PolicySpacePlugins, PolicyMujocoPlugin::default()));
    app.finish();
}
