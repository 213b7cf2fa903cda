//! Step 1: a policy is a small network. It maps what the character senses to an action, one number for each joint.
//!
//! `cargo run -p policy-core --example evaluate_policy`

use policy_core::{Arithmetic, CharacterPack, CharacterState, MlpScratch, observe_into};

const PACK: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.pack.safetensors");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pack = CharacterPack::from_bytes(&std::fs::read(PACK)?)?;
    let walk = &pack.policies()[pack.policy_named("walk").ok_or("expected a policy walk")?.index()];

    // What the character senses: here a body at rest, 0.9 m above the ground.
    let skeleton = pack.skeleton();
    let mut state = CharacterState::new(skeleton);
    state.bodies.iter_mut().for_each(|body| body.position.z = 0.9);

    // The input: the normalised observation, then the target, straight ahead and far away.
    let mut input = vec![0.0; skeleton.policy_input_len()];
    let (observation, target) = input.split_at_mut(skeleton.observation_len());
    observe_into(skeleton, &state, observation);
    pack.tensors().observation_normaliser.normalise_in_place(observation);
    target.copy_from_slice(&[2.5, 0.0]);

    // The scratch is made once and used again; evaluating allocates nothing.
    let mut scratch = MlpScratch::for_mlp(walk);
    let mut action = vec![0.0; walk.outputs()];
    walk.evaluate_into(Arithmetic::Reproducible, &input, &mut scratch, &mut action);

    println!("{} parameters turn {} numbers into {}", walk.parameter_count(), walk.inputs(), walk.outputs());
    for (joint, action) in skeleton.joints().iter().zip(&action).take(5) {
        println!("  {:12} {action:+.3}", joint.name);
    }
    Ok(())
}
