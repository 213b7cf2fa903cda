//! What a player presses reaches the character.

mod common;

use bevy::prelude::*;
use bevy_policy_space::prelude::*;
use common::{game, heard, pack_bytes, run, spawn};
use policy_core::CharacterPack;

#[test]
fn a_key_that_is_released_within_a_frame_starts_its_skill() {
    let mut app = game(64.0);
    app.init_resource::<ButtonInput<KeyCode>>();
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(PlayerInput::default());
    run(&mut app, 2.0);
    let mut keys = app.world_mut().resource_mut::<ButtonInput<KeyCode>>();
    keys.press(KeyCode::KeyG);
    keys.release(KeyCode::KeyG);
    app.update();
    // As Bevy's input plugin does at the beginning of a frame.
    app.world_mut().resource_mut::<ButtonInput<KeyCode>>().clear();
    run(&mut app, 1.0);
    assert_eq!(heard(&app).started, ["punch"]);
}

/// Holds a key from now on, as Bevy's input plugin tells it.
fn hold(app: &mut App, key: KeyCode) {
    let mut keys = app.world_mut().resource_mut::<ButtonInput<KeyCode>>();
    keys.clear();
    keys.press(key);
}

#[test]
fn a_button_names_the_same_skill_after_a_reload_with_other_skills() {
    let mut app = game(64.0);
    app.init_resource::<ButtonInput<KeyCode>>();
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(PlayerInput::default());
    run(&mut app, 1.0);
    // A pack without its first skill: every other one has another id, and the last id names none.
    let sound = PackAsset::from_bytes(&pack_bytes()).expect("a pack").pack;
    let mut manifest = sound.manifest().clone();
    let punch = manifest.skills.iter().position(|skill| skill.name == "punch").expect("a punch");
    let punch = manifest.skills.remove(punch);
    manifest.skills.push(punch);
    let first = manifest.skills.iter().position(|skill| Some(&skill.name) != manifest.recovery.as_ref());
    manifest.skills.remove(first.expect("another skill"));
    let changed = CharacterPack::from_parts(manifest, sound.tensors().clone()).expect("a pack");
    let handle = app.world().get::<PolicyCharacter>(character).expect("a character").pack.clone();
    let asset = PackAsset { pack: std::sync::Arc::new(changed) };
    app.world_mut().resource_mut::<Assets<PackAsset>>().insert(&handle, asset).expect("the handle's place");
    run(&mut app, 1.0);
    hold(&mut app, KeyCode::KeyG);
    run(&mut app, 1.0);
    assert_eq!(heard(&app).started, ["punch"], "{:?}", heard(&app));
}

#[test]
fn a_player_input_that_is_touched_does_not_press_held_buttons_again() {
    let mut app = game(64.0);
    app.init_resource::<ButtonInput<KeyCode>>();
    let character = spawn(&mut app, Vec3::ZERO);
    app.world_mut().entity_mut(character).insert(PlayerInput::default());
    run(&mut app, 1.0);
    hold(&mut app, KeyCode::KeyG);
    for frame in 0..400 {
        let mut input = app.world_mut().get_mut::<PlayerInput>(character).expect("an input");
        input.set_changed();
        if frame == 200 {
            // Other bindings, for another button.
            input.bindings.skills.retain(|(_, name)| name != "roll");
        }
        app.update();
    }
    assert_eq!(heard(&app).started, ["punch"], "{:?}", heard(&app));
}

#[test]
fn ahead_is_where_a_camera_on_a_turned_arm_looks() {
    let mut app = game(64.0);
    app.init_resource::<ButtonInput<KeyCode>>();
    let turned = Quat::from_rotation_y(-core::f32::consts::FRAC_PI_2);
    let arm = app.world_mut().spawn(Transform::from_rotation(turned)).id();
    let camera = app.world_mut().spawn((Transform::default(), ChildOf(arm))).id();
    let character = spawn(&mut app, Vec3::ZERO);
    let input = PlayerInput { camera: Some(camera), ..default() };
    app.world_mut().entity_mut(character).insert(input);
    run(&mut app, 1.0);
    hold(&mut app, KeyCode::KeyW);
    run(&mut app, 0.1);
    let command = app.world().get::<CharacterCommand>(character).expect("a command");
    let target = command.target.expect("a target");
    assert!(target.x > 3.0 && target.z.abs() < 0.5, "along x, {target}");
}
