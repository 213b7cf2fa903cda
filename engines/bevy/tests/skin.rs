//! The bones of a skin follow the bodies, also after the skin or the pack was loaded again.

mod common;

use bevy::prelude::*;
use bevy_policy_space::prelude::*;
use common::{body, game, pack_bytes, place, run, spawn};
use policy_core::CharacterPack;

/// Spawns two bones below a skin, as the scene of a glTF would.
fn bones(app: &mut App, skin: Entity) -> [Entity; 2] {
    let pelvis = app.world_mut().spawn((Name::new("pelvis"), Transform::default(), ChildOf(skin))).id();
    let torso = (Name::new("torso"), Transform::from_xyz(0.0, 0.1, 0.0), ChildOf(pelvis));
    [pelvis, app.world_mut().spawn(torso).id()]
}

fn rotation(app: &App, entity: Entity) -> Quat {
    app.world().get::<GlobalTransform>(entity).expect("a place").rotation()
}

/// How far a bone is from its body: in metres, and how its rotation in the body's frame differs from `offset`.
fn off(app: &App, character: Entity, [pelvis, torso]: [Entity; 2], offset: Quat) -> [f32; 2] {
    let bone = app.world().get::<GlobalTransform>(pelvis).expect("a place").translation();
    let own = rotation(app, body(app, character, "torso")).inverse() * rotation(app, torso);
    [bone.distance(place(app, body(app, character, "pelvis"))), own.angle_between(offset)]
}

#[test]
fn new_bones_and_a_new_pack_are_followed_too() {
    let mut app = game(64.0);
    let character = spawn(&mut app, Vec3::ZERO);
    let skin = app.world_mut().spawn(PolicySkin::of(character)).id();
    let old = bones(&mut app, skin);
    run(&mut app, 1.0);
    let offset = rotation(&app, body(&app, character, "torso")).inverse() * rotation(&app, old[1]);
    let impulse = ExternalImpulse { impulse: Vec3::new(0.0, 0.0, 60.0), ..default() };
    let torso = body(&app, character, "torso");
    app.world_mut().entity_mut(torso).insert(impulse);
    run(&mut app, 0.5);
    let [metres, radians] = off(&app, character, old, offset);
    assert!(metres < 0.01 && radians < 0.01, "{metres} m, {radians} rad");

    // The scene is loaded again: other entities, at rest.
    app.world_mut().entity_mut(old[0]).despawn();
    app.update();
    let new = bones(&mut app, skin);
    run(&mut app, 0.5);
    let [metres, radians] = off(&app, character, new, offset);
    assert!(metres < 0.01 && radians < 0.01, "{metres} m, {radians} rad");

    // A pack whose torso is turned at rest, by the same hinges.
    let sound = PackAsset::from_bytes(&pack_bytes()).expect("a pack").pack;
    let mut manifest = sound.manifest().clone();
    let mjcf = manifest.mjcf.take().expect("an MJCF");
    let turned = mjcf.replacen(r#"<body name="torso""#, r#"<body name="torso" euler="0 0 20""#, 1);
    assert_ne!(turned, mjcf);
    manifest.mjcf = Some(turned);
    let changed = CharacterPack::from_parts(manifest, sound.tensors().clone()).expect("a pack");
    let handle = app.world().get::<PolicyCharacter>(character).expect("a character").pack.clone();
    let asset = PackAsset { pack: std::sync::Arc::new(changed) };
    app.world_mut().resource_mut::<Assets<PackAsset>>().insert(&handle, asset).expect("the handle's place");
    let before = app.world().get::<PolicyController>(character).expect("a controller").rest.clone();
    run(&mut app, 0.2);
    let rest = &app.world().get::<PolicyController>(character).expect("a controller").rest;
    assert_ne!(*rest, before, "the rest pose is that of the new pack");
    let torso =
        rest.bodies.iter().zip(&before.bodies).map(|(new, old)| new.rotation.angle_between(old.rotation));
    let turn = torso.fold(0.0, f32::max);
    assert!((turn - 20_f32.to_radians()).abs() < 0.01, "{turn}");
    // At rest the bone is as the glTF has it, so in the turned body it is turned back.
    let [metres, radians] = off(&app, character, new, offset);
    assert!(metres < 0.01 && (radians - turn).abs() < 0.01, "{metres} m, {radians} rad");
}
