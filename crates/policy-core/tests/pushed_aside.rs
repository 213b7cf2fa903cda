//! Pushes aside: a gait that a push tips over to a side stands for a moment, by the policy for that side, and goes on then.

mod common;

use std::sync::Arc;

use common::{acted, hand_over, moving, n, weight_of};
use glam::{Vec2, Vec3};
use policy_core::format::Manifest;
use policy_core::{
    Blend, CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, GraphPosition, PathId,
    PolicyId, Skeleton,
};

const DT: f32 = 1.0 / 30.0;

/// The policies that catch a push to the left and to the right in the made-up pack.
const CATCHES: [&str; 2] = ["crawl", "roll"];

/// Ticks for which it stands after the body last tipped over.
const STANDS_TICKS: usize = 15;

/// Velocity aside that tips the body over, metres per second.
const TIPS: f32 = 1.2;

fn pack_with(change: impl FnOnce(&mut Manifest)) -> Arc<CharacterPack> {
    let mut manifest = common::manifest();
    for (index, speed) in [0.0, 1.0].into_iter().enumerate() {
        manifest.policies[index].speed_mps = Some(speed);
        manifest.policies[index].pushed_aside = Some(CATCHES.map(Into::into));
    }
    manifest.policies[2].speed_mps = Some(2.0);
    change(&mut manifest);
    Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap())
}

/// A controller of a character that has walked at its pace for a second.
fn walking(change: impl FnOnce(&mut Manifest), capture_steps: bool) -> Controller {
    let config =
        ControllerConfig { capture_steps, start: n(1), give_way: None, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack_with(change), config);
    for _ in 0..30 {
        tick(&mut controller, &drifting(0.0));
    }
    controller
}

/// A body that goes ahead at 1 m/s and aside at a speed; to the left is positive.
fn drifting(aside: f32) -> CharacterState {
    moving(Vec3::new(1.0, aside, 0.0))
}

/// One tick at a walk with a target ahead. Returns the shares of the policies that catch.
fn tick(controller: &mut Controller, state: &CharacterState) -> [f32; 2] {
    let goal = Goal::Path { path: PathId::new(0), coordinate: 1.0 };
    let target = Some(Vec2::X * 10.0);
    controller.tick(state, &Command { goal, target, ..Command::default() }, DT);
    CATCHES.map(|name| weight_of(controller, name))
}

#[test]
fn it_stands_at_once_on_the_side_of_the_push_and_goes_on_half_a_second_after_it() {
    for (side, aside) in [(0, TIPS), (1, -TIPS)] {
        let mut controller = walking(|_| {}, true);
        assert_eq!(tick(&mut controller, &drifting(0.2 * aside)), [0.0; 2], "it sways");
        assert!(controller.report().target[0] > 0.0);
        let shares = tick(&mut controller, &drifting(aside));
        assert_eq!([shares[side], shares[1 - side]], [1.0, 0.0], "side {side}");
        assert_eq!(controller.report().target, [0.0; 2], "it stands: no target");
        // Once caught it swings to the other side: the policy stays.
        let back = tick(&mut controller, &drifting(-aside));
        assert_eq!(back[side], 1.0);
        let stands = (0..60).take_while(|_| tick(&mut controller, &drifting(0.0))[side] == 1.0).count();
        assert!((STANDS_TICKS - 1..=STANDS_TICKS).contains(&stands), "{stands} ticks");
        let last = (0..3).map(|_| tick(&mut controller, &drifting(0.0))).last();
        assert_eq!(last, Some([0.0; 2]));
        assert!(controller.report().target[0] > 0.0, "on towards its target");
    }
}

#[test]
fn starts_turns_rough_ground_and_gaits_without_such_policies_are_left_alone() {
    let config = ControllerConfig { start: n(1), ..ControllerConfig::default() };
    let mut starts = Controller::with_config(pack_with(|_| {}), config);
    assert_eq!(tick(&mut starts, &drifting(TIPS)), [0.0; 2], "it has not gone at its pace yet");
    assert_eq!(tick(&mut walking(|_| {}, false), &drifting(TIPS)), [0.0; 2], "switched off");
    let mut rough = walking(|_| {}, true);
    let uneven = |aside: f32| {
        let mut state = drifting(aside);
        state.ground_rises[Skeleton::humanoid().feet()[0].index()] = 0.2;
        state
    };
    (0..15).for_each(|_| assert_eq!(tick(&mut rough, &uneven(0.0)), [0.0; 2]));
    assert_eq!(tick(&mut rough, &uneven(TIPS)), [0.0; 2], "rough ground");
    // Half-way to a gait without them.
    let mut between = walking(|_| {}, true);
    assert!(between.place_at(GraphPosition { from: n(1), to: n(2), t: 0.5 }));
    let goal = Goal::Stay;
    let target = Some(Vec2::X * 10.0);
    between.tick(&drifting(TIPS), &Command { goal, target, ..Command::default() }, DT);
    assert!(CATCHES.iter().all(|name| weight_of(&between, name) == 0.0));
}

#[test]
fn a_blend_by_hand_comes_first_and_an_unknown_name_is_refused() {
    let mut controller = walking(|_| {}, true);
    tick(&mut controller, &drifting(TIPS));
    let by_hand = Command { blend: Some(Blend::single(PolicyId::new(2))), ..Command::default() };
    controller.tick(&drifting(TIPS), &by_hand, DT);
    assert_eq!(acted(&controller), [(2, 1.0)]);
    let mut manifest = common::manifest();
    manifest.policies[1].pushed_aside = Some(["idle".into(), "trot".into()]);
    let error = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap_err().to_string();
    assert!(error.contains("trot") && error.contains("walk"), "{error}");
}

#[test]
fn a_saved_state_goes_on_standing() {
    let mut controller = walking(|_| {}, true);
    tick(&mut controller, &drifting(TIPS));
    let mut other = walking(|_| {}, true);
    hand_over(&controller, &mut other);
    for aside in [TIPS, 0.0, 0.0] {
        let shares = [&mut controller, &mut other].map(|c| tick(c, &drifting(aside)));
        assert!(shares[0] == shares[1] && shares[0][0] > 0.0);
        assert_eq!(controller.report(), other.report());
    }
}
