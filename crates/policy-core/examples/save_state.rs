//! Step 4: the state of a controller is plain data. Saved as bytes and restored, the next ticks give the same bits: for
//! saved games, rewind, replays and rollback.
//!
//! `cargo run -p policy-core --example save_state`

use std::sync::Arc;

use policy_core::{CharacterPack, CharacterState, Command, Controller, ControllerState, Goal};

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");
const DT_SECS: f32 = 1.0 / 30.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack = Arc::new(CharacterPack::from_bytes(&std::fs::read(PACK)?)?);
    let speed = pack.graph().path_named("speed").ok_or("expected a path speed")?;
    let goal = Goal::Path { path: speed, coordinate: 1.5 };
    let command = Command { goal, ..Command::default() };
    let mut body = CharacterState::new(pack.skeleton());
    body.bodies.iter_mut().for_each(|b| b.position.z = 0.9);

    let mut controller = Controller::new(pack.clone());
    for _ in 0..20 {
        controller.tick(&body, &command, DT_SECS);
    }

    // Made once; saving and restoring allocate nothing.
    let mut state = ControllerState::new(&pack);
    let mut bytes = vec![0; state.byte_len()];
    controller.save_into(&mut state);
    state.write_bytes(&mut bytes);
    println!("a controller is {} bytes", bytes.len());

    let first = controller.tick(&body, &command, DT_SECS).to_vec();
    let mut other = Controller::new(pack.clone());
    state.read_bytes(&pack, &bytes)?;
    other.restore(&state)?;
    let again = other.tick(&body, &command, DT_SECS).to_vec();
    println!("the next tick is the same, bit for bit: {}", first == again);
    Ok(())
}
