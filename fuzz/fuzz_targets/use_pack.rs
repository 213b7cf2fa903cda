//! What must hold for every pack that is read: whatever the character senses and the game asks, a tick gives finite
//! joint targets.

use std::sync::Arc;

use policy_core::glam::{Quat, Vec2, Vec3};
use policy_core::{CharacterPack, CharacterState, Command, Controller, Goal, NodeId, PathId, SkillId};

/// Steers a character by a pack for some ticks.
#[allow(dead_code, reason = "the target of states uses only one tick")]
pub fn steer(pack: CharacterPack) {
    let pack = Arc::new(pack);
    let mut controller = Controller::new(Arc::clone(&pack));
    let mut state = CharacterState::new(pack.skeleton());
    for tick in 0..8u8 {
        let height = f32::from(tick % 4) * 0.4;
        for body in &mut state.bodies {
            body.position = Vec3::new(0.1, -0.2, height);
            body.rotation = Quat::from_rotation_x(height);
            body.linear_velocity = Vec3::splat(height);
        }
        let command = Command {
            target: Some(Vec2::new(3.0, height)),
            goal: if tick < 4 {
                Goal::Path { path: PathId::new(0), coordinate: height * 3.0 }
            } else {
                Goal::Node(NodeId::new(tick.into()))
            },
            skill: (tick % 3 == 2).then(|| SkillId::new(usize::from(tick / 3))),
            ..Command::default()
        };
        check_tick(&mut controller, &state, &command);
    }
}

/// One tick.
pub fn check_tick(controller: &mut Controller, state: &CharacterState, command: &Command) {
    let targets = controller.tick(state, command, 1.0 / 30.0);
    assert!(targets.iter().all(|target| target.is_finite()), "joint targets {targets:?}");
}
