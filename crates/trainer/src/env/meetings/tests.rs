use std::path::Path;
use std::sync::Arc;

use policy_core::{CharacterPack, ControllerConfig, JointTargets};

use super::*;

/// Ticks of a try: time for a pause and a meeting.
const TICKS: usize = 90;

fn assets() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets")
}

fn controller() -> Controller {
    let pack = std::fs::read(assets().join("humanoid.pack.safetensors")).unwrap();
    let pack = Arc::new(CharacterPack::from_bytes(&pack).unwrap());
    let start = pack.graph().node_named(WALK).unwrap();
    Controller::with_config(pack, ControllerConfig { start, ..ControllerConfig::default() })
}

/// Which of the three touch the own character in a tick: the other one, the ball, the crate.
fn touching(company: &Company) -> [bool; 3] {
    let mut touching = [false; 3];
    for contact in company.world.contacts() {
        for [one, other] in [contact.parts, [contact.parts[1], contact.parts[0]]] {
            if !matches!(one, Part::Body(owner, _) if owner == company.own) {
                continue;
            }
            touching[0] |= matches!(other, Part::Body(owner, _) if owner != company.own);
            touching[1] |= other == Part::Prop(company.ball.prop);
            touching[2] |= other == Part::Prop(company.block.prop);
        }
    }
    touching
}

/// How often each of the three touched a character that holds its pose, and where its root came to, bit for bit.
fn tries(seed: u64) -> ([usize; 3], Vec<u64>) {
    let model = Model::load(assets().join("humanoid.xml")).unwrap();
    let mut rng = Rng::new(seed, 0);
    let mut company = Company::new(&model, &controller(), &mut rng).unwrap();
    let (mut character, mut state) = (Character::new(&model), CharacterState::new(model.skeleton()));
    let targets = JointTargets::new(model.skeleton());
    let (mut counts, mut ends) = ([0; 3], Vec::new());
    for _ in 0..24 {
        character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0).unwrap();
        company.begin(&character, 0.2, &mut rng);
        assert_eq!(touching(&company), [false; 3], "nothing is near at the start");
        let mut touched = [false; 3];
        for _ in 0..TICKS {
            company.sense_into(&mut state);
            assert!(!company.step(&targets, &state, 0.2, &mut rng), "the physics diverged");
            let now = touching(&company);
            touched = [0, 1, 2].map(|kind| touched[kind] || now[kind]);
        }
        company.copy_to(&mut character);
        ends.push(character.pose().qpos[0].to_bits());
        counts = [0, 1, 2].map(|kind| counts[kind] + usize::from(touched[kind]));
    }
    (counts, ends)
}

#[test]
fn a_character_is_met_by_another_by_a_ball_and_by_a_crate() {
    let ([other, ball, block], ends) = tries(3);
    // A crate lies where the character would go; one that stands falls onto it now and then.
    assert!(other >= 6 && ball >= 1 && other + ball + block >= 10, "{other} {ball} {block} of 24");
    assert_eq!(tries(3).1, ends, "equal seeds, equal tries");
}

#[test]
fn contacts_with_the_ground_bear_its_weight() {
    let model = Model::load(assets().join("humanoid.xml")).unwrap();
    let mut rng = Rng::new(1, 0);
    let mut company = Company::new(&model, &controller(), &mut rng).unwrap();
    let mut character = Character::new(&model);
    let (mut state, targets) = (CharacterState::new(model.skeleton()), JointTargets::new(model.skeleton()));
    company.begin(&character, 600.0, &mut rng);
    company.ticks_left = 600;
    for _ in 0..4 {
        company.sense_into(&mut state);
        company.step(&targets, &state, 600.0, &mut rng);
        character.actuate(&targets);
        character.step().unwrap();
    }
    let lift = |contacts: &[Contact]| contacts.iter().map(|c| c.force.z).sum::<f32>();
    let [alone, met] = [character.contacts(), company.contacts()].map(lift);
    assert!(alone > 100.0 && (alone - met).abs() < 0.02 * alone, "{alone} N alone, {met} N in a world");
}

#[test]
fn only_the_own_character_fails_by_a_divergence() {
    let model = Model::load(assets().join("humanoid.xml")).unwrap();
    let targets = JointTargets::new(model.skeleton());
    let mut state = CharacterState::new(model.skeleton());
    for own in [true, false] {
        let mut rng = Rng::new(2, 0);
        let mut company = Company::new(&model, &controller(), &mut rng).unwrap();
        company.begin(&Character::new(&model), 600.0, &mut rng);
        company.ticks_left = 600;
        company.sense_into(&mut state);
        let wild = company.world.characters().find(|handle| (*handle == company.own) == own).unwrap();
        let mut pose = Character::new(&model).pose();
        company.world.pose_into(wild, &mut pose).unwrap();
        pose.qvel[8] = 1e5;
        company.world.set_pose(wild, &pose.qpos, &pose.qvel).unwrap();
        assert_eq!(company.step(&targets, &state, 600.0, &mut rng), own);
        assert!(!company.world.divergences().is_empty(), "nothing diverged");
    }
}

#[test]
fn a_prop_that_was_taken_out_is_met_no_more() {
    let model = Model::load(assets().join("humanoid.xml")).unwrap();
    let mut rng = Rng::new(2, 0);
    let mut company = Company::new(&model, &controller(), &mut rng).unwrap();
    let [ball, block] = [company.ball.prop, company.block.prop];
    company.world.edit(|edit| edit.remove_prop(ball).and_then(|()| edit.remove_prop(block))).unwrap();
    company.begin(&Character::new(&model), 0.2, &mut rng);
    let mut state = CharacterState::new(model.skeleton());
    company.sense_into(&mut state);
    for _ in 0..20 {
        assert!(company.meet(&state, &mut rng) > 0.0);
    }
}
