use policy_core::Skeleton;
use policy_core::training::TARGET_RANGE_METRES;

use super::super::config::EnvironmentConfig;
use super::super::graph::GraphNode;
use super::super::termination::Termination;
use super::*;

/// A character that stands.
const UP: Heights = Heights { root: 0.9, head: 1.5 };

/// A character on hands and knees.
const LOW: Heights = Heights { root: 0.3, head: 0.5 };

/// A character at a horizontal position that faces along x.
fn at(position: Vec2) -> CharacterState {
    let skeleton = Skeleton::humanoid();
    let mut state = CharacterState::new(&skeleton);
    state.body_mut(skeleton.root()).position = position.extend(0.9);
    state
}

fn with(command: CommandConfig) -> EnvironmentConfig {
    EnvironmentConfig { command, ..EnvironmentConfig::default() }
}

fn edge() -> TrainingGraph {
    let node = |name: &str, speed_mps, share| {
        GraphNode::new(name, &with(CommandConfig { speed_mps, ..CommandConfig::default() }), share)
    };
    TrainingGraph::along(vec![node("walk", 1.25, 0.3), node("idle", 0.0, 0.7)], &[vec![0, 1]], [1.0; 2])
        .unwrap()
}

#[test]
fn on_a_single_node_the_blend_stays() {
    let config = CommandConfig::default();
    let graph = TrainingGraph::alone(edge().nodes().to_vec(), 1).unwrap();
    let mut rng = Rng::new(1, 1);
    let mut command = Command::start(&config, &graph, false, &mut rng);
    command.aim(&config, &graph, (Vec2::ZERO, 0.0), &mut rng);
    for _ in 0..1000 {
        command.advance(&config, &graph, &at(Vec2::ZERO), UP, &mut rng);
        assert_eq!(graph.pair_and_blend(command.position), (0, 1.0));
    }
}

#[test]
fn it_can_stay_at_the_end_of_an_edge() {
    let config = CommandConfig { stay_at_end: true, ..CommandConfig::default() };
    let (graph, mut rng) = (edge(), Rng::new(5, 1));
    for _ in 0..20 {
        let mut command = Command::start(&config, &graph, false, &mut rng);
        command.aim(&config, &graph, (Vec2::ZERO, 0.0), &mut rng);
        for _ in 0..100 {
            command.advance(&config, &graph, &at(Vec2::ZERO), UP, &mut rng);
            assert_eq!(graph.pair_and_blend(command.position), (0, 1.0));
        }
    }
}

#[test]
fn blends_and_targets_stay_in_range_and_are_renewed() {
    let (config, graph, mut rng) = (CommandConfig::default(), edge(), Rng::new(2, 1));
    let (mut at_child, mut targets, mut count) = (0, 0, 0);
    for _ in 0..200 {
        let mut command = Command::start(&config, &graph, false, &mut rng);
        command.aim(&config, &graph, (Vec2::ONE, 0.0), &mut rng);
        for _ in 0..150 {
            let before = command.target;
            command.advance(&config, &graph, &at(Vec2::ONE), UP, &mut rng);
            assert!((0.0..=1.0).contains(&graph.pair_and_blend(command.position).1));
            assert!(command.target.distance(Vec2::ONE) <= 10.001);
            targets += usize::from(command.target != before);
            at_child += usize::from(graph.pair_and_blend(command.position).1 == 1.0);
            count += 1;
        }
    }
    assert!(targets > 100 && (0.2..0.5).contains(&(at_child as f32 / count as f32)));
}

#[test]
fn a_moving_coordinate_rests_where_it_came_to() {
    let config = CommandConfig {
        edge_sweep_secs: [0.1, 0.1],
        edge_rest_secs: [2.0, 2.0],
        jump_share: 0.0,
        ..Default::default()
    };
    let (graph, mut rng) = (edge(), Rng::new(4, 1));
    let (mut rests, mut moves) = (0, 0);
    for _ in 0..50 {
        let mut command = Command::start(&config, &graph, false, &mut rng);
        command.aim(&config, &graph, (Vec2::ZERO, 0.0), &mut rng);
        let mut still = 60;
        for _ in 0..300 {
            let before = graph.pair_and_blend(command.position).1;
            command.advance(&config, &graph, &at(Vec2::ZERO), UP, &mut rng);
            if graph.pair_and_blend(command.position).1 == before {
                still += 1;
            } else {
                moves += 1;
                // Either on its way, a tenth of a second at most, or after a rest of two seconds.
                assert!(still == 0 || still >= 58, "{still}");
                rests += usize::from(still > 0);
                still = 0;
            }
        }
    }
    assert!(rests > 50 && moves > rests, "{rests} {moves}");
}

#[test]
fn leaving_a_low_gait_requires_standing_first() {
    let node = |name: &str, rule| {
        let mut config = EnvironmentConfig::default();
        config.termination.rule = rule;
        GraphNode::new(name, &config, 1.0)
    };
    let nodes = vec![node("crouch", Termination::Upright), node("crawl", Termination::Lying)];
    let graph = TrainingGraph::along(nodes, &[vec![0, 1]], [1.0; 2]).unwrap();
    let config = CommandConfig { sweep_share: 1.0, ..CommandConfig::default() };
    let mut rng = Rng::new(6, 1);
    let mut command = Command::start(&config, &graph, false, &mut rng);
    while graph.pair_and_blend(command.position).1 > 0.0 {
        command.advance(&config, &graph, &at(Vec2::ZERO), UP, &mut rng);
    }
    let mut held = 0.0_f32;
    for _ in 0..400 {
        command.advance(&config, &graph, &at(Vec2::ZERO), LOW, &mut rng);
        held = held.max(command.fall.rising_seconds());
    }
    assert!(held > 0.0 && !command.stuck(), "{held}");
    // Asked to stay up, it is late after 0.8 s and stuck after three.
    let mut command = Command { asked: 0.0, goal: 0.0, ..Command::at(&graph, PathId::new(0), 0.01) };
    for tick in 1..=95 {
        command.advance(&config, &graph, &at(Vec2::ZERO), LOW, &mut rng);
        assert!(command.is_late() == (tick > 24) || tick == 24, "{tick}");
        assert!(command.stuck() == (tick >= 90) || (89..=91).contains(&tick), "{tick}");
        assert!(command.position.as_node().is_none(), "it waits");
    }
    command.advance(&config, &graph, &at(Vec2::ZERO), UP, &mut rng);
    assert!(command.position.as_node().is_some() && !command.is_late());
}

#[test]
fn a_sweep_goes_to_both_ends_and_does_not_rest() {
    let config = CommandConfig { sweep_share: 1.0, ..CommandConfig::default() };
    let (graph, mut rng) = (edge(), Rng::new(5, 1));
    for _ in 0..20 {
        let mut command = Command::start(&config, &graph, false, &mut rng);
        command.aim(&config, &graph, (Vec2::ZERO, 0.0), &mut rng);
        let (mut ends, mut still) = ([false; 2], 0);
        // A sweep there and back takes 4 to 8 s.
        for _ in 0..250 {
            let before = graph.pair_and_blend(command.position).1;
            command.advance(&config, &graph, &at(Vec2::ZERO), UP, &mut rng);
            ends = [
                ends[0] || graph.pair_and_blend(command.position).1 == 0.0,
                ends[1] || graph.pair_and_blend(command.position).1 == 1.0,
            ];
            still += usize::from(graph.pair_and_blend(command.position).1 == before);
        }
        assert!(ends == [true; 2] && still <= 5, "{ends:?} {still}");
    }
}

#[test]
fn the_position_follows_what_is_asked_no_faster_than_an_edge_allows() {
    let config =
        CommandConfig { edge_secs: 1.0, jump_share: 1.0, stick_share: 1.0, ..CommandConfig::default() };
    let nodes = [("walk", 1.25), ("idle", 0.0)].map(|(name, speed_mps)| {
        GraphNode::new(name, &with(CommandConfig { speed_mps, ..config.clone() }), 1.0)
    });
    let (graph, mut rng) =
        (TrainingGraph::along(nodes.to_vec(), &[vec![0, 1]], [1.0; 2]).unwrap(), Rng::new(3, 1));
    let mut moved = 0.0;
    for _ in 0..50 {
        let mut command = Command::start(&config, &graph, false, &mut rng);
        command.aim(&config, &graph, (Vec2::ZERO, 0.0), &mut rng);
        for tick in 0..300 {
            let (before, position) = (graph.pair_and_blend(command.position).1, Vec2::splat(tick as f32));
            command.advance(&config, &graph, &at(position), UP, &mut rng);
            let step = (graph.pair_and_blend(command.position).1 - before).abs();
            assert!(step <= DT_SECS + 1e-6, "{step}");
            moved += step;
            let away = command.target.distance(position);
            assert!(away < 1e-3 || (away - TARGET_RANGE_METRES).abs() < 1e-3, "{away}");
        }
    }
    assert!(moved > 50.0, "{moved}");
}

#[test]
fn an_episode_that_starts_at_a_node_rests_there_or_goes_elsewhere() {
    let config = CommandConfig { sweep_share: 1.0, jump_share: 0.0, ..CommandConfig::default() };
    let (graph, mut rng) = (edge(), Rng::new(9, 1));
    let (mut resting, mut counts) = (0, [0; 2]);
    for _ in 0..200 {
        let mut command = Command::start(&config, &graph, true, &mut rng);
        counts[command.position.as_node().expect("at a node").index()] += 1;
        let before = command.position;
        (0..30).for_each(|_| command.advance(&config, &graph, &at(Vec2::ZERO), UP, &mut rng));
        resting += usize::from(command.position == before);
        assert!(!command.sweeps);
    }
    assert!((100..180).contains(&resting) && counts.iter().all(|count| *count > 30), "{resting} {counts:?}");
}

#[test]
fn a_stick_turns_by_a_quarter_at_most_unless_any_direction_is_asked_for() {
    let most_turn = |any_direction_share| {
        let target_secs = [DT_SECS, DT_SECS];
        let config = CommandConfig {
            stick_share: 1.0,
            stop_share: 0.0,
            any_direction_share,
            target_secs,
            ..Default::default()
        };
        let graph = TrainingGraph::alone(vec![edge().nodes()[0].clone()], 0).unwrap();
        let mut rng = Rng::new(8, 1);
        let mut command = Command::start(&config, &graph, false, &mut rng);
        command.aim(&config, &graph, (Vec2::ZERO, 0.0), &mut rng);
        let mut most: f32 = 0.0;
        for _ in 0..500 {
            let before = command.target;
            command.advance(&config, &graph, &at(Vec2::ZERO), UP, &mut rng);
            most = most.max(before.angle_to(command.target).abs());
        }
        most
    };
    assert!(most_turn(0.0) <= QUARTER + 1e-3 && most_turn(0.5) > 3.0);
}

#[test]
fn slow_gaits_have_stops_and_fast_ones_times_of_their_own() {
    let stops_and_secs = |speed_mps| {
        let target_secs = [1.0, 1.0];
        let config = CommandConfig {
            stop_share: 0.0,
            slow_stop_share: Some(1.0),
            fast_target_factor: 3.0,
            target_secs,
            ..Default::default()
        };
        let node = GraphNode { speed_mps, ..edge().nodes()[0].clone() };
        let graph = TrainingGraph::alone(vec![node], 0).unwrap();
        let mut rng = Rng::new(8, 1);
        let mut command = Command::start(&config, &graph, false, &mut rng);
        command.aim(&config, &graph, (Vec2::ZERO, 0.0), &mut rng);
        (command.stop, command.target_ticks as f32 * DT_SECS)
    };
    for (speed_mps, stops, secs) in
        [(0.0, false, 1.0), (0.4, true, 1.0), (1.25, false, 1.0), (2.8, false, 3.0)]
    {
        let found = stops_and_secs(speed_mps);
        assert!(found.0 == stops && (found.1 - secs).abs() < 2.0 * DT_SECS, "{speed_mps} m/s: {found:?}");
    }
}
