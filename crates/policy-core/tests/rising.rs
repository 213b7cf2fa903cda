//! Rises: out of a low gait a character gives all of its weight to the rising variant of that gait, until it stands.

mod common;

use std::sync::Arc;

use common::{hand_over, policy, standing, weight_of};
use glam::Vec2;
use policy_core::{CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal};

const DT: f32 = 1.0 / 30.0;

/// The rising variant of the made-up pack's crawl, and its fall height: 0.1 m above it the character has risen.
const RISES: (&str, f32) = ("run", 0.65);

fn pack() -> Arc<CharacterPack> {
    let mut manifest = common::gaits(|_| ());
    manifest.edges[4].transit = true;
    let crawl = &mut manifest.policies[policy("crawl")];
    (crawl.fall_height, crawl.rising) = (Some(0.1), Some(RISES.0.into()));
    manifest.policies[policy(RISES.0)].fall_height = Some(RISES.1);
    Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap())
}

fn crawling(change: impl FnOnce(&mut ControllerConfig)) -> Controller {
    let pack = pack();
    let start = pack.graph().node_named("crawl").unwrap();
    let mut config = ControllerConfig { start, ..ControllerConfig::default() };
    change(&mut config);
    Controller::with_config(pack, config)
}

/// A body with its root so high, and its head above that.
fn at(root: f32) -> CharacterState {
    let mut state = standing();
    let lower = state.bodies[0].position.z - root;
    state.bodies.iter_mut().for_each(|body| body.position.z -= lower);
    state
}

/// One tick with a root so high, asked to go to a gait. Returns the share of the rising variant.
fn tick(controller: &mut Controller, root: f32, to: &str) -> f32 {
    let goal = Goal::Node(controller.pack().graph().node_named(to).unwrap());
    let command = Command { goal, target: Some(Vec2::X * 10.0), ..Command::default() };
    controller.tick(&at(root), &command, DT);
    weight_of(controller, RISES.0)
}

fn node(controller: &Controller) -> &str {
    let node = controller.report().position.as_node().expect("it is at a node");
    &controller.pack().graph().node(node).name
}

#[test]
fn it_acts_until_the_character_stands_and_goes_on_from_the_gait_that_stands() {
    let mut controller = crawling(|_| ());
    let shares: Vec<f32> = (0..5).map(|_| tick(&mut controller, 0.3, "walk")).collect();
    assert!((shares[0] - DT / 0.1).abs() < 1e-5 && shares[3..] == [1.0, 1.0], "within 0.1 s: {shares:?}");
    for root in [0.5, 0.6, 0.7, 0.74] {
        assert_eq!(tick(&mut controller, root, "walk"), 1.0);
        assert_eq!((node(&controller), controller.report().target), ("crawl", [0.0; 2]));
        assert!(controller.report().skill.is_none() && !controller.report().fallen && !controller.is_down());
    }
    let shares: Vec<f32> = (0..7).map(|_| tick(&mut controller, 0.76, "walk")).collect();
    assert!((shares[0] - (1.0 - DT / 0.2)).abs() < 1e-5 && shares[6] < 1e-6, "0.2 s back: {shares:?}");
    assert_eq!(node(&controller), "idle", "it settles");
    (0..60).for_each(|_| _ = tick(&mut controller, 0.9, "walk"));
    assert_eq!((node(&controller), controller.report().skill), ("walk", None));
    assert!(controller.report().target[0] > 0.0);
}

#[test]
fn the_recovery_skill_takes_over_a_rise_that_is_late() {
    let mut controller = crawling(|_| ());
    let ticks = (0..200).take_while(|_| tick(&mut controller, 0.4, "crouch") > 0.0).count();
    assert!((65..=67).contains(&ticks), "{ticks} ticks");
    assert_eq!(controller.report().skill_started, controller.pack().recovery());
    assert!(!controller.is_down(), "it rises out of a gait");
    // So it does at once where the variant is not to act.
    let mut without = crawling(|config| config.agility = false);
    assert!((0..5).all(|_| tick(&mut without, 0.3, "crouch") == 0.0));
    assert!(without.report().skill.is_some());
}

#[test]
fn a_character_that_is_sent_back_down_stands_up_first() {
    let mut controller = crawling(|_| ());
    (0..10).for_each(|_| _ = tick(&mut controller, 0.5, "walk"));
    assert!((0..10).all(|_| tick(&mut controller, 0.6, "crawl") == 1.0), "half-way up it would fall");
    assert_eq!(node(&controller), "crawl");
    tick(&mut controller, 0.8, "crawl");
    assert_eq!(node(&controller), "idle");
    (0..120).for_each(|_| _ = tick(&mut controller, 0.9, "crawl"));
    assert_eq!((node(&controller), weight_of(&controller, RISES.0)), ("crawl", 0.0), "and down again");
}

#[test]
fn half_way_down_it_goes_down_first() {
    // The way from idle to the edge takes a second, and the edge half of one.
    for (ticks, turns_back) in [(34, true), (39, false)] {
        let mut controller = Controller::new(pack());
        assert!((0..ticks).all(|_| tick(&mut controller, 0.9, "crawl") == 0.0), "into a crawl nothing rises");
        let on_edge = controller.report().position;
        assert!(on_edge.as_node().is_none(), "{on_edge:?}");
        let mut nodes: Vec<String> = Vec::new();
        for _ in 0..30 {
            let share = tick(&mut controller, if turns_back { 0.65 } else { 0.4 }, "crouch");
            assert_eq!(share > 0.0, !turns_back && nodes.iter().any(|node| node == "crawl"));
            let at = controller.report().position.as_node();
            nodes.extend(at.map(|node| controller.pack().graph().node(node).name.clone()));
        }
        assert_eq!(nodes.iter().any(|node| node == "crouch"), turns_back, "{on_edge:?}: {nodes:?}");
        assert_eq!(nodes.iter().any(|node| node == "crawl"), !turns_back, "{on_edge:?}: {nodes:?}");
    }
}

#[test]
fn the_height_of_the_variant_makes_no_gait_a_low_one() {
    // 0.5 is less than 0.75 of 0.8.
    let mut manifest = common::gaits(|_| ());
    manifest.policies[policy("crawl")].rising = Some(RISES.0.into());
    manifest.policies[policy(RISES.0)].fall_height = Some(0.8);
    let pack = Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap());
    let config = ControllerConfig { auto_recover: false, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack, config);
    let mut lies = at(0.7);
    lies.bodies[0].rotation = glam::Quat::from_rotation_y(1.5);
    (0..60).for_each(|_| _ = controller.tick(&lies, &Command::default(), DT));
    assert!(controller.report().fallen, "it lies on something high");
}

#[test]
fn a_saved_state_goes_on_with_its_rise() {
    let mut controller = crawling(|_| ());
    (0..2).for_each(|_| _ = tick(&mut controller, 0.3, "walk"));
    let mut other = crawling(|_| ());
    hand_over(&controller, &mut other);
    for root in [0.4, 0.7, 0.8, 0.8, 0.9] {
        let shares = [&mut controller, &mut other].map(|c| tick(c, root, "walk"));
        assert!(shares[0] == shares[1] && shares[0] > 0.0, "{shares:?}");
        assert_eq!(controller.report(), other.report());
    }
}
