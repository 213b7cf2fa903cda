use policy_core::training::Heights;
use policy_core::{CharacterState, Skeleton};

use super::super::super::config::EnvironmentConfig;
use super::super::super::graph::GraphNode;
use super::super::CommandConfig;
use super::*;

const STRAFE: StrafeConfig = StrafeConfig {
    facing_secs: [60.0; 2],
    jump_share: 0.0,
    aside: 0.5,
    back: 0.8,
    turn_rate: [0.5, 3.5],
    max_facing_error: 1.0,
    max_angle: std::f32::consts::PI,
};

/// A path from a walk to a gait that strafes, both of 1 m/s.
fn graph() -> TrainingGraph {
    let node = |name, strafe| {
        let command = CommandConfig { speed_mps: 1.0, strafe, ..CommandConfig::default() };
        GraphNode::new(name, &EnvironmentConfig { command, ..EnvironmentConfig::default() }, 1.0)
    };
    let nodes = vec![node("walk", None), node("strafe", Some(STRAFE))];
    TrainingGraph::along(nodes, &[vec![0, 1]], [1.0; 2]).unwrap()
}

/// A command at a coordinate of [`graph`] that faces along an angle, with the stick that far from there.
fn held(graph: &TrainingGraph, coordinate: f32, facing: f32, stick: f32) -> Command {
    let mut command = Command {
        facing: Some(Facing { ticks: 1000, ..Facing::along(facing) }),
        stick: Some(stick),
        target_ticks: 1000,
        ..Command::at(graph, policy_core::PathId::new(0), coordinate)
    };
    command.follow_stick(graph, Vec2::ZERO);
    command
}

#[test]
fn the_stick_of_a_camera_turns_with_it_and_the_speed_is_less_aside_and_backwards() {
    let graph = graph();
    let speed = |coordinate, stick| held(&graph, coordinate, 1.0, stick).speed_mps(&graph, Vec2::ZERO);
    let near = |is: f32, expected: f32| assert!((is - expected).abs() < 1e-3, "{is} instead of {expected}");
    near(speed(1.0, 0.0), 1.0);
    near(speed(1.0, QUARTER), 0.5);
    near(speed(1.0, -2.0 * QUARTER), 0.8);
    near(speed(0.5, QUARTER), 0.75);
    near(speed(0.0, QUARTER), 1.0);
    near(held(&graph, 1.0, 1.0, QUARTER).target.to_angle(), 1.0 + QUARTER);
    let mut stopped = held(&graph, 1.0, 1.0, QUARTER);
    stopped.stop = true;
    stopped.follow_stick(&graph, Vec2::ZERO);
    near(stopped.speed_mps(&graph, Vec2::ZERO), 1.0);
}

#[test]
fn steering_leaves_a_character_that_strafes_its_target() {
    let (graph, config) = (graph(), CommandConfig::default());
    let mut state = CharacterState::new(&Skeleton::humanoid());
    state.bodies[0].linear_velocity.y = 1.0;
    let mut rng = Rng::new(1, 1);
    let heights = Heights { root: 0.9, head: 1.5 };
    for (coordinate, same) in [(1.0, true), (0.0, false)] {
        let mut command = Command { assisted: true, ..held(&graph, coordinate, 0.0, 0.3) };
        (0..10).for_each(|_| command.advance(&config, &graph, &state, heights, &mut rng));
        assert_eq!(command.seen_target == command.target, same);
    }
}

#[test]
fn an_episode_begins_as_its_clip_moves() {
    let graph = graph();
    let mut command = held(&graph, 1.0, 1.0, 0.0);
    command.go_on(&graph, Vec2::ONE, Vec2::from_angle(-0.5));
    assert!(!command.stop && ((command.target - Vec2::ONE).to_angle() + 0.5).abs() < 1e-5);
    command.go_on(&graph, Vec2::ONE, Vec2::ZERO);
    assert!(command.stop && command.target == Vec2::ONE);
    let mut plain = Command { facing: None, ..command };
    plain.go_on(&graph, Vec2::ZERO, Vec2::Y);
    assert_eq!(plain, Command { facing: None, ..command });
}

#[test]
fn the_way_to_face_turns_at_the_pace_of_a_thumb_or_jumps() {
    let mut rng = Rng::new(5, 1);
    let turns = |jump_share: f32, rng: &mut Rng| {
        let config = StrafeConfig { facing_secs: [0.5, 1.0], jump_share, ..STRAFE };
        let mut facing = Facing::along(0.0);
        let steps = (0..600).map(|_| {
            let before = facing.radians;
            facing.advance(&config, rng);
            (facing.radians - before).abs()
        });
        steps.fold(0.0, f32::max)
    };
    assert!((0.02..=STRAFE.turn_rate[1] * DT_SECS + 1e-5).contains(&turns(0.0, &mut rng)));
    assert!(turns(1.0, &mut rng) > 0.5);
}

#[test]
fn an_episode_fails_where_it_faces_far_from_its_way() {
    let graph = graph();
    let fails = |coordinate, heading| {
        held(&graph, coordinate, 1.0, 0.0).faces_elsewhere(&graph, Heading::from_angle(heading))
    };
    assert!(fails(1.0, -0.1) && fails(0.6, 2.1) && !fails(1.0, 0.1) && !fails(0.4, 3.0));
}

#[test]
fn ways_to_go_stay_within_the_largest_angle() {
    let mut rng = Rng::new(7, 0);
    for most in [0.5, 2.0, std::f32::consts::PI] {
        for anywhere in [false, true] {
            let angles: Vec<f32> = (0..400).map(|_| way_to_go(most, anywhere, &mut rng)).collect();
            assert!(angles.iter().all(|angle| angle.abs() <= most), "{most}");
            let widest = angles.iter().fold([0.0f32; 2], |[low, high], &a| [low.min(a), high.max(a)]);
            assert!(
                widest[0] < -0.9 * most.min(QUARTER) && widest[1] > 0.9 * most.min(QUARTER),
                "{widest:?}"
            );
        }
    }
    let back = (0..100).any(|_| way_to_go(std::f32::consts::PI, false, &mut rng).abs() > 3.1);
    assert!(back, "straight back is among the ways");
}
