//! What a player presses reaches the character.

mod common;

use bevy::prelude::*;
use bevy_policy_space::prelude::*;
use common::{game, heard, run, spawn};

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
