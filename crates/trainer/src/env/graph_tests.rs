use super::*;

fn node(name: &str, speed_mps: f32) -> GraphNode {
    GraphNode {
        name: name.into(),
        speed_mps,
        speed_scale_mps: 0.6,
        max_tracking_error_metres: 0.35,
        termination: TerminationRule::Upright(1.0),
        share: 1.0,
        task: 1.0,
        root_metres: 0.0,
        edge_secs: 0.0,
    }
}

fn graph() -> TrainingGraph {
    let nodes = vec![node("walk", 1.0), node("idle", 0.0), node("run", 3.0), node("crawl", 0.2)];
    TrainingGraph::new(nodes, vec![vec![1, 0, 2], vec![1, 0, 3]])
}

#[test]
fn paths_share_their_edges() {
    let graph = graph();
    assert_eq!(graph.edges(), [[1, 0], [0, 2], [0, 3]]);
    assert_eq!(graph.position(0, 0.25), graph.position(1, 0.25));
    assert_eq!(graph.position(1, 9.0), GraphPosition { edge: 2, t: 1.0 });
    assert!((graph.speed_mps(graph.position(0, 1.5)) - 2.0).abs() < 1e-6);
    let nodes = [0.0, 0.5, 1.0, 1.5, 2.0].map(|coordinate| graph.node_at(graph.position(1, coordinate)));
    assert_eq!(nodes, [Some(1), None, Some(0), None, Some(3)]);
}

#[test]
fn weights_of_a_place_sum_to_one() {
    let graph = graph();
    let mut weights = vec![0.0; graph.position_len()];
    for i in 0..=20 {
        graph.position_into(graph.position(1, i as f32 * 0.1), &mut weights);
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{weights:?}");
    }
    assert_eq!(weights, [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn a_path_of_one_node_is_that_node() {
    let graph = TrainingGraph::new(vec![node("walk", 1.0), node("roll", 0.5)], vec![vec![1]]);
    let position = graph.position(0, 0.0);
    assert_eq!((graph.edges()[position.edge], position.t), ([1, 1], 1.0));
    assert_eq!((graph.speed_mps(position), graph.weight(position, 0)), (0.5, 0.0));
    assert_eq!(graph.draw(0, &mut Rng::new(1, 1)), 0.0);
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
    let graph = TrainingGraph::new(nodes, vec![vec![0, 1], vec![0, 2]]);
    let secs =
        |path, from, to| graph.edge_secs(graph.position(path, from), graph.position(path, to), [0.6, 0.5]);
    assert_eq!([secs(0, 0.2, 1.0), secs(0, 0.8, 0.0)], [0.6, 0.5]);
    assert_eq!([secs(1, 0.2, 1.0), secs(1, 0.8, 0.0)], [1.0, 1.0]);
}
