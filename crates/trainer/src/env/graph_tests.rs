use super::super::config::EnvironmentConfig;
use super::*;

pub(in super::super) fn node(name: &str, speed_mps: f32) -> GraphNode {
    let mut config = EnvironmentConfig::default();
    config.command.speed_mps = speed_mps;
    GraphNode::new(name, &config, 1.0)
}

fn graph() -> TrainingGraph {
    let nodes = vec![node("walk", 1.0), node("idle", 0.0), node("run", 3.0), node("crawl", 0.2)];
    TrainingGraph::along(nodes, &[vec![1, 0, 2], vec![1, 0, 3]], [1.0; 2]).unwrap()
}

#[test]
fn paths_share_their_edges() {
    let graph = graph();
    let [speed, stance] = [0, 1].map(PathId::new);
    assert_eq!(graph.pairs(), [[1, 0], [0, 2], [0, 3]]);
    assert_eq!(graph.position(speed, 0.25), graph.position(stance, 0.25));
    assert_eq!(graph.pair_and_blend(graph.position(stance, 1.75)), (2, 0.75));
    assert_eq!(graph.pair_and_blend(graph.position(stance, 9.0)), (2, 1.0));
    assert!((graph.speed_mps(graph.position(speed, 1.5)) - 2.0).abs() < 1e-6);
    for coordinate in [0.0, 0.3, 1.0, 1.6, 2.0] {
        let position = graph.position(stance, coordinate);
        let (pair, t) = graph.pair_and_blend(position);
        let back = graph.position_of(pair, t);
        assert!((0..4).all(|node| (graph.weight(back, node) - graph.weight(position, node)).abs() < 1e-6));
    }
}

#[test]
fn weights_of_a_position_sum_to_one() {
    let graph = graph();
    let mut weights = vec![0.0; graph.position_len()];
    for i in 0..=20 {
        graph.position_into(graph.position(PathId::new(1), i as f32 * 0.1), &mut weights);
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{weights:?}");
    }
    assert_eq!(weights, [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn a_node_alone_is_its_own_pair() {
    let graph = TrainingGraph::alone(vec![node("walk", 1.0), node("roll", 0.5)], 1).unwrap();
    let mut rng = Rng::new(1, 1);
    let path = graph.sample_path(&mut rng);
    let position = graph.position(path, 0.0);
    assert_eq!((graph.pairs(), graph.pair_and_blend(position)), (&[[1, 1]][..], (0, 1.0)));
    assert_eq!(
        (graph.speed_mps(position), graph.weight(position, 0), graph.weight(position, 1)),
        (0.5, 0.0, 1.0)
    );
    assert_eq!((graph.sample(path, &mut rng), graph.end(path), graph.context_len()), (0.0, 0.0, 1));
}

#[test]
fn upright_edges_take_another_time_to_a_faster_node_than_to_a_slower_one() {
    let timed = |name: &str, speed_mps, termination| GraphNode {
        edge_secs: 1.0,
        termination,
        ..node(name, speed_mps)
    };
    let up = TerminationRule::Upright(1.0);
    let nodes =
        vec![timed("walk", 1.0, up), timed("run", 3.0, up), timed("crawl", 0.3, TerminationRule::Lying)];
    let graph = TrainingGraph::along(nodes, &[vec![0, 1], vec![0, 2]], [0.6, 0.5]).unwrap();
    let secs = |from: usize, to: usize| {
        let [from, to] = [from, to].map(NodeId::new);
        graph.policy_graph().edge_between(from, to).unwrap().seconds_from(from)
    };
    assert_eq!([secs(0, 1), secs(1, 0)], [0.6, 0.5]);
    assert_eq!([secs(0, 2), secs(2, 0)], [1.0, 1.0]);
}

#[test]
fn paths_of_nothing_are_refused() {
    let nodes = || vec![node("walk", 1.0), node("idle", 0.0)];
    for paths in [vec![], vec![vec![0]], vec![vec![0, 0]], vec![vec![0, 2]]] {
        assert!(TrainingGraph::along(nodes(), &paths, [1.0; 2]).is_err(), "{paths:?}");
    }
}
