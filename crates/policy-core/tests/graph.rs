//! Search and travel on the policy graph.

mod common;

use common::{n, pack};
use policy_core::format::EdgeEntry;
use policy_core::training::Layer;
use policy_core::{CharacterPack, GraphPosition, Mlp, NodeId, PolicyGraph};
use proptest::prelude::*;

const DT: f32 = 1.0 / 30.0;

fn node(pack: &CharacterPack, name: &str) -> NodeId {
    pack.graph().node_named(name).unwrap()
}

/// Cheapest way by trying all simple ways, the plain definition.
fn cheapest(graph: &PolicyGraph, from: NodeId, to: NodeId, seen: &mut Vec<NodeId>) -> f32 {
    if from == to {
        return 0.0;
    }
    seen.push(from);
    let mut best = f32::INFINITY;
    for edge in graph.edges() {
        for [a, b] in [edge.nodes, [edge.nodes[1], edge.nodes[0]]] {
            if a == from && !seen.contains(&b) {
                best = best.min(edge.distance + cheapest(graph, b, to, seen));
            }
        }
    }
    seen.pop();
    best
}

#[test]
fn search_finds_the_cheapest_way() {
    let mut manifest = common::manifest();
    manifest.edges.push(EdgeEntry {
        nodes: ["idle".into(), "crouch".into()],
        seconds: 1.0,
        seconds_back: None,
        transit: false,
    });
    manifest.edges.push(EdgeEntry {
        nodes: ["run".into(), "idle".into()],
        seconds: 1.0,
        seconds_back: None,
        transit: false,
    });
    let pack = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap();
    let graph = pack.graph();
    for a in 0..graph.nodes().len() {
        for b in 0..graph.nodes().len() {
            let [a, b] = [a, b].map(n);
            let (found, expected) = (graph.routes().cost(a, b), cheapest(graph, a, b, &mut Vec::new()));
            assert!(
                found == expected || (found - expected).abs() < 1e-3,
                "{a:?} to {b:?}: {found}, {expected}"
            );
            let route = graph.routes().route(a, b);
            assert_eq!(route.is_empty(), expected.is_infinite());
            let length: f32 =
                route.windows(2).map(|w| graph.edge_between(w[0], w[1]).unwrap().distance).sum();
            assert!(route.is_empty() || (length - expected).abs() < 1e-3);
        }
    }
    assert!(graph.routes().route(n(0), node(&pack, "roll")).is_empty(), "roll hangs on no edge");
}

#[test]
fn policies_that_are_infinitely_far_apart_make_no_edge() {
    let mut tensors = common::tensors(0.0);
    let far = |end: f32| {
        let layers = common::POLICY_SIZES
            .windows(2)
            .map(|w| Layer::from_input_major(w[0], w[1], &vec![end; w[0] * w[1]], &vec![end; w[1]]).unwrap());
        Mlp::from_layers(layers.collect()).unwrap()
    };
    // Idle and walk, which an edge joins.
    (tensors.policies[0], tensors.policies[1]) = (far(3e38), far(-3e38));
    let error = CharacterPack::from_parts(common::manifest(), tensors).unwrap_err().to_string();
    assert!(error.contains("finite distance"), "{error}");
}

#[test]
fn the_way_from_run_to_crawl_leads_through_walk_in_the_time_of_its_edges() {
    let pack = pack(0.0);
    let graph = pack.graph();
    let mut position = GraphPosition::node(node(&pack, "run"));
    let goal = GraphPosition::node(node(&pack, "crawl"));
    let mut nodes = vec![position.from];
    let mut seconds = 0.0;
    while position.as_node() != Some(goal.from) {
        graph.travel(&mut position, goal, DT);
        seconds += DT;
        assert!(seconds < 10.0, "it arrives");
        if *nodes.last().unwrap() != position.nearest_node() {
            nodes.push(position.nearest_node());
        }
    }
    let names: Vec<&str> = nodes.iter().map(|&n| graph.node(n).name.as_str()).collect();
    assert_eq!(names, ["run", "jog", "walk", "crouch", "crawl"]);
    assert!((seconds - 2.0).abs() < 1.5 * DT, "four edges of half a second, took {seconds}");
}

#[test]
fn an_edge_may_take_longer_one_way_than_the_other() {
    let mut manifest = common::manifest();
    manifest.edges[0].seconds_back = Some(0.25);
    let pack = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap();
    let seconds = |from: usize, to: usize| {
        let mut position = GraphPosition::node(n(from));
        (1..).find(|_| {
            pack.graph().travel(&mut position, GraphPosition::node(n(to)), 0.01);
            position.as_node() == Some(n(to))
        })
    };
    assert!((49..=51).contains(&seconds(0, 1).unwrap()) && (24..=26).contains(&seconds(1, 0).unwrap()));
}

#[test]
fn a_character_rests_at_the_nearer_end_of_a_transit_edge() {
    let mut manifest = common::manifest();
    manifest.edges[4].transit = true;
    let pack = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap();
    let graph = pack.graph();
    let [crouch, crawl] = ["crouch", "crawl"].map(|name| node(&pack, name));
    let between = |t: f32| GraphPosition { from: crouch, to: crawl, t };
    let rests = |asked: f32, present: GraphPosition| graph.settled(between(asked), present).as_node();
    let there = GraphPosition::node;
    assert_eq!([0.3, 0.59, 0.61].map(|t| rests(t, there(crouch))), [crouch, crouch, crawl].map(Some));
    assert_eq!([0.39, 0.41, 1.0].map(|t| rests(t, there(crawl))), [crouch, crawl, crawl].map(Some));
    assert_eq!([0.49, 0.51].map(|t| rests(t, there(n(0)))), [crouch, crawl].map(Some));
    let backwards = GraphPosition { from: crawl, to: crouch, t: 0.45 };
    assert_eq!(graph.settled(backwards, there(crouch)).as_node(), Some(crouch), "told from the other end");
    let walks = GraphPosition { from: n(0), to: n(1), t: 0.4 };
    assert_eq!(graph.settled(walks, there(crouch)), walks, "an edge to rest on");
}

#[test]
fn no_way_means_no_move() {
    let pack = pack(0.0);
    let mut position = GraphPosition { from: n(0), to: n(1), t: 0.4 };
    pack.graph().travel(&mut position, GraphPosition::node(node(&pack, "roll")), 1.0);
    assert_eq!(position, GraphPosition { from: n(0), to: n(1), t: 0.4 });
    for dt in [0.0, -1.0, f32::NAN] {
        pack.graph().travel(&mut position, GraphPosition::node(n(1)), dt);
        assert_eq!(position.t, 0.4);
    }
}

#[test]
fn coordinates_and_positions_are_each_others_inverse() {
    let pack = pack(0.0);
    for path in pack.graph().paths() {
        for i in 0..=30 {
            let coordinate = i as f32 * 0.1;
            let found = path.coordinate(path.position(coordinate)).unwrap();
            assert!((found - coordinate.min(path.end())).abs() < 1e-5);
        }
        assert_eq!(path.coordinate(path.position(f32::NAN)), Some(0.0));
        assert_eq!(path.coordinate(path.position(9.0)), Some(3.0));
    }
    let speed = &pack.graph().paths()[0];
    assert_eq!(speed.coordinate(GraphPosition { from: n(4), to: n(5), t: 0.5 }), None);
    assert_eq!(speed.coordinate(GraphPosition { from: n(2), to: n(1), t: 0.25 }), Some(1.75));
}

proptest! {
    #[test]
    fn travel_is_continuous_and_arrives(
        start in 0.0f32..3.0, end in 0.0f32..3.0, paths in prop::array::uniform2(0usize..2), steps in 1usize..400,
    ) {
        let pack = pack(0.0);
        let graph = pack.graph();
        let mut position = graph.paths()[paths[0]].position(start);
        let goal = graph.paths()[paths[1]].position(end);
        // Where both paths have a coordinate it may not jump; elsewhere one of them has.
        let place = |p: GraphPosition| [0, 1].map(|i| graph.paths()[i].coordinate(p));
        for _ in 0..steps {
            let before = place(position);
            graph.travel(&mut position, goal, DT);
            prop_assert!((0.0..=1.0).contains(&position.t));
            for (a, b) in before.into_iter().zip(place(position)) {
                if let (Some(a), Some(b)) = (a, b) {
                    prop_assert!((a - b).abs() <= DT / 0.5 + 1e-5, "{a} to {b}");
                }
            }
        }
        if steps > 240 {
            let there = goal.along(position.from, position.to).is_some_and(|t| (t - position.t).abs() < 1e-5);
            prop_assert!(there || goal.as_node() == position.as_node(), "{position:?} {goal:?}");
        }
    }
}
