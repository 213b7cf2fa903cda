//! Step 3: a controller steers one character at the pack's rate, whatever the rate of the game. The physics here is made
//! up; step on with `cargo run -p physics-bridge --example walk` for real one.
//!
//! `cargo run -p policy-core --example steer`

use std::sync::Arc;

use policy_core::glam::Vec2;
use policy_core::{CharacterPack, CharacterState, Command, Controller, FixedRate, Goal};

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");

/// A body that slides along at walking speed, whatever its motors do.
fn made_up_physics(state: &mut CharacterState, _joint_targets: &[f32], seconds: f32) {
    for body in &mut state.bodies {
        body.linear_velocity.x = 1.2;
        body.position.x += 1.2 * seconds;
        body.position.z = 0.9;
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The pack is shared by all characters; the controller is the state of one.
    let pack = Arc::new(CharacterPack::from_bytes(&std::fs::read(PACK)?)?);
    let speed = pack.graph().path_named("speed").ok_or("expected a path speed")?;
    let mut controller = Controller::new(pack.clone());
    let mut state = CharacterState::new(pack.skeleton());

    let mut rate = FixedRate::new(pack.control_hz());
    for frame in 0..144 {
        for _ in 0..rate.advance(1.0 / 144.0) {
            // Ask for a jog, five metres ahead. The controller travels there along the graph.
            let ahead = state.root().position.truncate() + Vec2::new(5.0, 0.0);
            let goal = Goal::Path { path: speed, coordinate: 2.0 };
            let command = Command { target: Some(ahead), goal, ..Command::default() };
            let targets = controller.tick(&state, &command, rate.period_secs());
            made_up_physics(&mut state, targets, rate.period_secs());
        }
        if frame % 36 == 35 {
            let coordinate = pack.graph().path(speed).coordinate(controller.report().position);
            println!("frame {:3}: coordinate {:.2}", frame + 1, coordinate.unwrap_or(f32::NAN));
        }
    }
    Ok(())
}
