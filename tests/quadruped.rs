//! A character that is no humanoid goes all the way: MJCF, pack of version 2, observation, controller, physics, crowd,
//! state as bytes. Its policies are made up, so nothing is said about how well it walks.

use std::num::NonZeroUsize;
use std::sync::Arc;

use glam::Vec2;
use integration_tests::made_up;
use integration_tests::{DT_SECS, QUADRUPED_MJCF};
use physics_bridge::{Character, Crowd, Model, StateHash};
use policy_core::{
    CharacterPack, CharacterState, Command, Controller, ControllerState, Goal, Heading, SkillEnd,
    observe_into,
};

/// The pack, after it was a file.
fn pack() -> Arc<CharacterPack> {
    let model = Model::from_mjcf(QUADRUPED_MJCF).unwrap();
    let bytes = made_up::pack(&model, QUADRUPED_MJCF).to_bytes();
    Arc::new(CharacterPack::from_bytes(&bytes).unwrap())
}

/// What a player might ask in this tick.
fn command(pack: &CharacterPack, tick: u16) -> Command {
    let speed = pack.graph().path_named("speed").unwrap();
    Command {
        target: Some(Vec2::new(3.0, 0.05 * f32::from(tick))),
        goal: Goal::Path { path: speed, coordinate: f32::from(tick % 50) / 50.0 },
        skill: (tick == 20).then(|| pack.skill_named("bow").unwrap()),
        ..Command::default()
    }
}

fn hash(character: &Character) -> u64 {
    let mut hash = StateHash::default();
    hash.absorb(&character.pose());
    hash.value()
}

#[test]
fn the_body_comes_out_of_the_pack() {
    let (pack, source) = (pack(), Model::from_mjcf(QUADRUPED_MJCF).unwrap());
    assert_eq!(pack.mjcf(), Some(QUADRUPED_MJCF));
    assert_eq!(pack.skeleton(), source.skeleton());
    assert_eq!(pack.actuation(), Some(&source.actuation()));
    let model = Model::for_pack(&pack).unwrap();
    assert_eq!(model.skeleton(), source.skeleton());
    let (bodies, joints) = (model.skeleton().body_count(), model.skeleton().joint_count());
    assert_ne!((bodies, joints), (15, 28), "it is no humanoid");
    assert_eq!(pack.to_bytes(), CharacterPack::from_bytes(&pack.to_bytes()).unwrap().to_bytes());
}

#[test]
fn its_observation_says_how_it_stands_and_not_where() {
    let model = Model::from_mjcf(QUADRUPED_MJCF).unwrap();
    let observe = |x, y, heading| {
        let mut character = Character::new(&model);
        character.stand_at(x, y, heading, 0.0).unwrap();
        let mut state = CharacterState::new(model.skeleton());
        character.sense_into(&mut state);
        let mut observation = vec![f32::NAN; model.skeleton().observation_len()];
        observe_into(model.skeleton(), &state, &mut observation);
        observation
    };
    let here = observe(0.0, 0.0, Heading::FORWARD);
    assert!(here.iter().all(|number| number.is_finite()));
    let there = observe(7.0, -3.0, Heading::from_angle(2.0));
    let apart = here.iter().zip(&there).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(apart < 1e-5, "the same stance elsewhere differs by {apart}");
}

#[test]
fn its_controller_moves_it_and_a_skill_ends() {
    let pack = pack();
    let mut character = Character::new(&Model::for_pack(&pack).unwrap());
    let mut controller = Controller::new(Arc::clone(&pack));
    let before = character.pose().qpos;
    let mut ended = None;
    for tick in 0..90 {
        character.control_tick(&mut controller, &command(&pack, tick), DT_SECS).unwrap();
        let report = controller.report();
        assert_eq!((report.fault, report.off_rate), (None, false), "tick {tick}");
        ended = ended.or(report.skill_ended);
    }
    let (skill, end) = ended.expect("a skill of at most a second ends within three");
    assert_eq!(Some(skill), pack.skill_named("bow"));
    assert!(matches!(end, SkillEnd::Recognised | SkillEnd::TimeLimit), "{end:?}");
    let after = character.pose().qpos;
    let moved = before[7..].iter().zip(&after[7..]).filter(|(a, b)| (**a - **b).abs() > 0.01).count();
    assert!(moved >= pack.skeleton().joint_count() / 2, "{moved} joints moved");
}

#[test]
fn a_controller_saved_as_bytes_at_every_tick_goes_on_to_the_same_bits() {
    let pack = pack();
    let model = Model::for_pack(&pack).unwrap();
    let run = |through_bytes: bool| {
        let mut character = Character::new(&model);
        let mut controller = Controller::new(Arc::clone(&pack));
        let mut state = ControllerState::new(&pack);
        let mut bytes = vec![0; state.byte_len()];
        for tick in 0..90 {
            if through_bytes {
                controller.save_into(&mut state);
                state.write_bytes(&mut bytes);
                controller = Controller::new(Arc::clone(&pack));
                state.read_bytes(&pack, &bytes).unwrap();
                controller.restore(&state).unwrap();
            }
            character.control_tick(&mut controller, &command(&pack, tick), DT_SECS).unwrap();
        }
        hash(&character)
    };
    assert_eq!(run(true), run(false));
}

#[test]
fn a_crowd_of_them_does_the_same_as_each_alone() {
    let pack = pack();
    let model = Model::for_pack(&pack).unwrap();
    // Enough of them for the batch, which sums in another order.
    let count = 12;
    let starts = |index: usize| {
        let mut character = Character::new(&model);
        character.stand_at(index as f32, 0.0, Heading::from_angle(0.3 * index as f32), 0.0).unwrap();
        character
    };
    let mut crowd = Crowd::new((0..count).map(starts).collect(), NonZeroUsize::new(2)).unwrap();
    let mut controllers = vec![Controller::new(Arc::clone(&pack)); count];
    for tick in 0..15 {
        assert_eq!(crowd.control_tick(&mut controllers, &vec![command(&pack, tick); count], DT_SECS), 0);
    }
    for index in 0..count {
        let (mut alone, mut controller) = (starts(index), Controller::new(Arc::clone(&pack)));
        (0..15).for_each(|tick| alone.control_tick(&mut controller, &command(&pack, tick), DT_SECS).unwrap());
        let (one, other) = (alone.pose().qpos, crowd.character(index).pose().qpos);
        let apart = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-3, "character {index} is {apart} apart from itself in a crowd");
    }
}

#[test]
fn a_humanoid_cannot_be_steered_by_its_pack() {
    let pack = pack();
    let humanoid = Character::new(&Model::from_mjcf(integration_tests::HUMANOID_MJCF).unwrap());
    let mut controller = Controller::new(Arc::clone(&pack));
    let mut state = CharacterState::new(humanoid.model().skeleton());
    humanoid.sense_into(&mut state);
    controller.tick(&state, &Command::default(), DT_SECS);
    assert!(controller.report().fault.is_some());
    assert_eq!(controller.joint_targets().len(), pack.skeleton().joint_count());
}
