//! Capture steps: a body that tips over backwards is stepped under, with the policy that strafes, and nothing else changes.

mod common;

use std::sync::Arc;

use common::{acted, hand_over, n, policy, weight_of};
use glam::{Quat, Vec2, Vec3};
use policy_core::format::Manifest;
use policy_core::{
    Blend, CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, GraphPosition, PathId,
    PolicyId, Skeleton,
};

const DT: f32 = 1.0 / 30.0;

/// The policy that strafes in the made-up pack.
const STRAFES: &str = "roll";

/// Ticks in which it takes over, and those that it goes on for afterwards.
const TICKS: [usize; 2] = [3, 9];

fn pack_with(change: impl FnOnce(&mut Manifest)) -> Arc<CharacterPack> {
    let mut manifest = common::manifest();
    let strafes = &mut manifest.policies[policy(STRAFES)];
    (strafes.strafes, strafes.fall_height) = (true, Some(0.5));
    change(&mut manifest);
    Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap())
}

fn controller_at(node: &str, capture_steps: bool) -> Controller {
    let config = ControllerConfig { capture_steps, start: n(policy(node)), ..ControllerConfig::default() };
    Controller::with_config(pack_with(|_| {}), config)
}

/// A body that stands, faces along an angle and moves at a speed along its heading.
fn moving(angle: f32, speed: f32) -> CharacterState {
    let mut state = common::moving(Vec3::new(angle.cos(), angle.sin(), 0.0) * speed);
    for body in &mut state.bodies {
        body.rotation = Quat::from_rotation_z(angle);
    }
    state
}

/// One tick at a walk, with a target 10 m along an angle. Returns the share of the policy that strafes.
fn tick(controller: &mut Controller, state: &CharacterState, towards: Option<f32>) -> f32 {
    let target = towards.map(|angle| 10.0 * Vec2::from_angle(angle));
    let goal = Goal::Path { path: PathId::new(0), coordinate: 1.0 };
    controller.tick(state, &Command { goal, target, ..Command::default() }, DT);
    weight_of(controller, STRAFES)
}

#[test]
fn a_walk_that_tips_over_backwards_steps_back_and_goes_on_once_it_is_balanced() {
    let angle = 2.0;
    let mut controller = controller_at("walk", true);
    assert_eq!(tick(&mut controller, &moving(angle, 0.8), Some(angle)), 0.0);
    assert!(controller.report().target[0] > 0.0);
    let tipping = moving(angle, -0.8);
    let shares: Vec<f32> = (0..TICKS[0]).map(|_| tick(&mut controller, &tipping, Some(angle))).collect();
    assert!((shares[0] - DT / 0.07).abs() < 1e-5 && shares[2] == 1.0, "{shares:?}");
    let [ahead, left] = controller.report().target;
    assert!(ahead < -0.04 && left.abs() < 1e-3, "the target lies behind: {ahead} {left}");
    let balanced = moving(angle, 0.0);
    for _ in 0..TICKS[1] - 1 {
        assert_eq!(tick(&mut controller, &balanced, Some(angle)), 1.0, "it goes on for 0.3 s");
    }
    let back: Vec<f32> = (0..11).map(|_| tick(&mut controller, &balanced, Some(angle))).collect();
    assert!(back.is_sorted_by(|a, b| a >= b) && back[1] < 1.0 && back[10] == 0.0, "{back:?}");
    assert!(controller.report().target[0] > 0.0, "on towards its target");
}

#[test]
fn it_faces_where_it_faced_and_steps_to_where_the_body_tips_meanwhile() {
    let mut controller = controller_at("walk", true);
    for _ in 0..TICKS[0] {
        tick(&mut controller, &moving(0.0, -0.8), Some(0.0));
    }
    let facing = |controller: &Controller| controller.policy_input()[43..45].to_vec();
    assert_eq!(facing(&controller)[1], 0.0);
    // The body is turned, and tips over to its back and its left now.
    let mut turned = moving(0.3, -0.8);
    turned.bodies.iter_mut().for_each(|body| body.linear_velocity.y += 0.6);
    tick(&mut controller, &turned, Some(0.0));
    let seen = facing(&controller);
    assert!((seen[1].atan2(seen[0]) - 0.3).abs() < 1e-5, "0.3 rad are left to turn: {seen:?}");
    let [ahead, left] = controller.report().target;
    assert!(ahead < 0.0 && left > 0.1, "{ahead} {left}");
}

#[test]
fn a_stand_steps_back_too_and_a_low_gait_does_not() {
    for (node, steps) in [("idle", true), ("run", true), ("crouch", true), ("crawl", false), (STRAFES, false)]
    {
        let mut controller = controller_at(node, true);
        let goal = Goal::Stay;
        controller.tick(&moving(0.0, -0.8), &Command { goal, ..Command::default() }, DT);
        let share = weight_of(&controller, STRAFES);
        assert_eq!(share > 0.0 && share < 1.0, steps, "{node}: {share}");
    }
}

#[test]
fn the_steps_begin_once_the_body_would_come_to_rest_behind_its_heels() {
    let share = |speed: f32| tick(&mut controller_at("walk", true), &moving(0.0, speed), Some(0.0));
    assert_eq!(share(-0.05), 0.0, "0.015 of its height behind its ankles");
    assert_eq!(share(-0.2), DT / 0.07, "0.06 of it");
}

#[test]
fn nothing_changes_ahead_aside_in_turns_and_where_it_is_switched_off() {
    let share =
        |controller: &mut Controller, state: &CharacterState, towards| tick(controller, state, towards);
    let mut on = controller_at("walk", true);
    let mut aside = moving(0.0, 0.0);
    aside.bodies.iter_mut().for_each(|body| body.linear_velocity.y = 1.5);
    assert_eq!(share(&mut on, &aside, Some(0.0)), 0.0);
    aside.bodies.iter_mut().for_each(|body| body.linear_velocity.x = -0.8);
    assert_eq!(share(&mut controller_at("idle", true), &aside, None), 0.0, "it stands, and tips aside");
    assert_eq!(share(&mut controller_at("walk", true), &aside, Some(0.0)), DT / 0.07, "it goes");
    assert_eq!(share(&mut on, &moving(0.0, 2.5), Some(0.0)), 0.0);
    assert_eq!(share(&mut on, &moving(0.0, -0.8), Some(1.2)), 0.0, "it turns away");
    assert_eq!(share(&mut on, &moving(0.0, -0.8), Some(0.4)), DT / 0.07, "a target nearly ahead is none");
    assert_eq!(share(&mut controller_at("walk", false), &moving(0.0, -0.8), Some(0.0)), 0.0);
    let none = Arc::new(common::pack(0.0));
    let mut none =
        Controller::with_config(none, ControllerConfig { start: n(1), ..ControllerConfig::default() });
    assert_eq!(share(&mut none, &moving(0.0, -0.8), Some(0.0)), 0.0);
}

#[test]
fn skills_falls_and_blends_by_hand_come_first() {
    let tipping = moving(0.0, -0.8);
    let mut controller = controller_at("walk", true);
    tick(&mut controller, &tipping, Some(0.0));
    let by_hand = Command { blend: Some(Blend::single(PolicyId::new(2))), ..Command::default() };
    controller.tick(&tipping, &by_hand, DT);
    assert_eq!(acted(&controller), [(2, 1.0)]);
    let skill = controller.pack().skill_named("roll");
    let mut rolls = controller_at("walk", true);
    rolls.tick(&tipping, &Command { skill, goal: Goal::Stay, ..Command::default() }, DT);
    assert!(rolls.report().skill.is_some());
    assert_eq!(rolls.report().target[0], 0.0, "a skill without a target has none");
}

#[test]
fn shares_add_up_to_one_beside_all_variants_and_between_two_gaits() {
    let all = ["jog", "run", "crouch"];
    let pack = pack_with(|manifest| {
        for (i, speed) in [0.0, 1.0].into_iter().enumerate() {
            let gait = &mut manifest.policies[i];
            gait.speed_mps = Some(speed);
            let names = all.map(|name| Some(name.to_string()));
            [gait.rough_ground, gait.agile, gait.steady] = names;
        }
    });
    let mut controller = Controller::new(pack);
    assert!(controller.place_at(GraphPosition { from: n(0), to: n(1), t: 0.5 }));
    let mut rough = moving(0.0, -0.8);
    rough.ground_rises[Skeleton::humanoid().feet()[0].index()] = 0.02;
    for _ in 0..8 {
        tick(&mut controller, &rough, Some(0.0));
        assert!(controller.place_at(GraphPosition { from: n(0), to: n(1), t: 0.5 }));
    }
    assert_eq!(tick(&mut controller, &rough, Some(0.0)), 1.0);
}

#[test]
fn on_rough_ground_its_variant_for_rough_ground_steps() {
    let pack = pack_with(|manifest| {
        let strafes = &mut manifest.policies[policy("jog")];
        (strafes.strafes, strafes.rough_ground) = (true, Some(STRAFES.into()));
    });
    let mut controller =
        Controller::with_config(pack, ControllerConfig { start: n(policy("walk")), ..Default::default() });
    let mut rough = moving(0.0, -0.8);
    let foot = Skeleton::humanoid().feet()[0].index();
    rough.ground_rises[foot] = 0.02;
    let half = (0..15).map(|_| tick(&mut controller, &rough, Some(0.0))).last();
    assert!(half.is_some_and(|share| (share - 0.5).abs() < 1e-5), "half-way from level to rough: {half:?}");
    rough.ground_rises[foot] = 0.1;
    let fully = (0..3).map(|_| tick(&mut controller, &rough, Some(0.0))).last();
    assert_eq!(fully, Some(1.0));
    assert!(controller.report().target[0] < -0.04, "the target lies behind");
}

#[test]
fn a_saved_state_goes_on_with_its_steps() {
    let mut controller = controller_at("walk", true);
    tick(&mut controller, &moving(0.0, -0.8), Some(0.0));
    let mut other = controller_at("walk", true);
    hand_over(&controller, &mut other);
    for speed in [-0.8, 0.0, 0.0] {
        let shares = [&mut controller, &mut other].map(|c| tick(c, &moving(0.0, speed), Some(0.0)));
        assert!(shares[0] == shares[1] && shares[0] > 0.0);
        assert_eq!(controller.report(), other.report());
    }
}

#[test]
fn bytes_keep_the_side_of_a_turn_that_a_step_interrupts() {
    let mut controller = controller_at("walk", true);
    tick(&mut controller, &moving(0.0, 0.0), Some(3.0));
    assert!(tick(&mut controller, &moving(0.0, -0.8), Some(0.0)) > 0.0);
    let [saved, read] = common::saved_and_read(&controller);
    assert_eq!(read, saved);
}
