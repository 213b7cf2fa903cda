use policy_core::training::Heights;
use policy_core::{PathId, Skeleton};
use random::Rng;

use super::super::super::config::EnvironmentConfig;
use super::super::super::graph::GraphNode;
use super::super::{CommandConfig, INTENT_LEN};
use super::*;

/// A character that stands.
const UP: Heights = Heights { root: 0.9, head: 1.5 };

/// A path from standing to a walk and a run, all edges a second, with these settings.
fn speeds(config: &CommandConfig) -> TrainingGraph {
    let config = CommandConfig { edge_secs: 1.0, ..config.clone() };
    let nodes = [("idle", 0.0), ("walk", 1.25), ("run", 3.5)].map(|(name, speed_mps)| {
        GraphNode::new(
            name,
            &EnvironmentConfig {
                command: CommandConfig { speed_mps, ..config.clone() },
                ..EnvironmentConfig::default()
            },
            1.0,
        )
    });
    TrainingGraph::along(nodes.to_vec(), &[vec![0, 1, 2]], [1.0; 2]).unwrap()
}

/// A character at the origin that faces along x.
fn standing() -> CharacterState {
    let skeleton = Skeleton::humanoid();
    let mut state = CharacterState::new(&skeleton);
    state.body_mut(skeleton.root()).position.z = 0.9;
    state
}

/// A stick of a player that asks for a direction, off the heading by an angle, at a coordinate of [`speeds`].
fn held(assisted: bool, angle: f32, coordinate: f32) -> (CommandConfig, TrainingGraph, Command) {
    let config = CommandConfig { target_secs: [60.0; 2], ..CommandConfig::default() };
    let graph = speeds(&config);
    let command = Command {
        stick: Some(angle),
        assisted,
        target_ticks: 1000,
        ..Command::at(&graph, PathId::new(0), coordinate)
    };
    (config, graph, command)
}

fn advanced(assisted: bool, angle: f32, coordinate: f32, ticks: usize) -> (Command, TrainingGraph) {
    let (config, graph, mut command) = held(assisted, angle, coordinate);
    let mut rng = Rng::new(3, 1);
    (0..ticks).for_each(|_| command.advance(&config, &graph, &standing(), UP, &mut rng));
    (command, graph)
}

#[test]
fn an_assisted_stick_slows_down_to_turn_and_sees_no_target_straight_behind() {
    let (plain, _) = advanced(false, 3.0, 2.0, 60);
    assert!((plain.coordinate, plain.seen_target) == (2.0, plain.target));
    let (turning, _) = advanced(true, 3.0, 2.0, 60);
    assert!((turning.coordinate - 1.0).abs() < 1e-3, "{}", turning.coordinate);
    assert!((turning.target.to_angle() - 3.0).abs() < 1e-3, "{}", turning.target);
    let seen = turning.seen_target.to_angle();
    assert!((seen - 0.75 * std::f32::consts::PI).abs() < 1e-3, "{seen}");
    let (slow, _) = advanced(true, 3.0, 0.5, 60);
    assert!((slow.coordinate - 1.0).abs() < 1e-3, "a slow walk turns as a walk: {}", slow.coordinate);
    assert!(slow.seen_target.length() > 1.5 * slow.target.length());
}

#[test]
fn a_released_stick_leads_back_to_standing_and_then_on() {
    for (assisted, expected) in [(true, 0.0), (false, 2.0)] {
        let (config, graph, mut command) = held(assisted, 0.0, 2.0);
        (command.stop, command.leads_to_standing) = (true, true);
        let mut rng = Rng::new(3, 1);
        let state = standing();
        (0..90).for_each(|_| command.advance(&config, &graph, &state, UP, &mut rng));
        assert!(command.coordinate == expected && command.target == Vec2::ZERO, "{command:?}");
        let mut intent = [0.0; INTENT_LEN];
        command.intent_into(&mut intent);
        assert_eq!(intent[0], 0.0, "where it is asked to be");
        command.stop = false;
        (0..90).for_each(|_| command.advance(&config, &graph, &state, UP, &mut rng));
        assert_eq!(command.coordinate, 2.0);
    }
}

#[test]
fn a_stick_asks_for_the_first_gait_at_once_while_it_leaves_standing() {
    let (_, graph, command) = held(true, 0.0, 2.0);
    let prompt = |coordinate, asked| Command { coordinate, asked, ..command }.prompt_mps(&graph);
    assert!((prompt(0.2, 2.0) - 1.25).abs() < 1e-5);
    assert!((prompt(0.2, 0.6) - 0.75).abs() < 1e-5, "half a stick asks for less");
    assert_eq!((prompt(1.0, 2.0), prompt(0.2, 0.0)), (0.0, 0.0));
    assert_eq!(Command { stop: true, coordinate: 0.2, ..command }.prompt_mps(&graph), 0.0);
    assert_eq!(Command { stick: None, coordinate: 0.2, ..command }.prompt_mps(&graph), 0.0);
}
