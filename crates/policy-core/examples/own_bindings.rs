//! Step 5: own bindings of a gamepad: which control moves along which path, which button requests which skill, and how
//! sticks respond.
//!
//! `cargo run -p policy-core --example own_bindings`

use policy_core::bindings::{Control, Curve, PathBinding};
use policy_core::{Bindings, Button, CharacterPack, CharacterState, CommandMapper, GamepadState, Heading};

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack = CharacterPack::from_bytes(&std::fs::read(PACK)?)?;

    // Crouch while the right shoulder is held, run with the left trigger, roll with north; a finer stick.
    let crouch = PathBinding {
        path: "stance".into(),
        control: Control::Button(Button::RightShoulder),
        first: 1.0,
        needs_stick: false,
    };
    let bindings = Bindings {
        stick_path: "speed".into(),
        faster: Control::LeftTrigger,
        paths: vec![crouch],
        skills: vec![(Button::North, "roll".into())],
        stick: Curve { dead_zone: 0.1, exponent: 1.5 },
        trigger: Curve { dead_zone: 0.02, exponent: 1.0 },
    };
    let mut mapper = CommandMapper::new(&pack, &bindings);

    let state = CharacterState::new(pack.skeleton());
    let pad = GamepadState { left_stick: [0.0, 0.7], left_trigger: 0.5, ..GamepadState::default() };
    let command = mapper.map(&pad, Heading::FORWARD, &state);
    println!("target {:?}, goal {:?}", command.target, command.goal);
    Ok(())
}
