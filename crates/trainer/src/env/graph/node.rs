//! Nodes of a graph as training sees them, and policy-core's graph of them.

use policy_core::training::{Edge, GraphError, Layer, Node};
use policy_core::{Mlp, NodeId, PolicyGraph};

use crate::env::command::{DT_SECS, StrafeConfig};
use crate::env::config::EnvironmentConfig;
use crate::env::termination::TerminationRule;

/// A node as training sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphNode {
    /// Name of its skill.
    pub name: String,
    /// Speed that its policy is commanded to, metres per second.
    pub speed_mps: f32,
    /// How its policy is asked to strafe, if it does.
    pub strafe: Option<StrafeConfig>,
    /// Least scale of the reward for its speed, metres per second.
    pub speed_scale_mps: f32,
    /// Early-termination threshold of its clips' tracking, metres.
    pub max_tracking_error_metres: f32,
    /// What counts as a failure at it.
    pub termination: TerminationRule,
    /// Root height below which a game's character has fallen there, metres; `None` where no height is a fall.
    pub fall_height: Option<f32>,
    /// How often episodes rest at it, relative to the other nodes of a path.
    pub share: f32,
    /// Factor on the weight of the task reward.
    pub task: f32,
    /// Mean height of the root above the ground in its clips, metres.
    pub root_metres: f32,
    /// Least seconds to cross its edges; the longer time of the two ends holds.
    pub edge_secs: f32,
}

impl GraphNode {
    /// The node of a skill with these settings.
    #[must_use]
    pub fn new(name: &str, config: &EnvironmentConfig, share: f32) -> Self {
        let termination = TerminationRule::of(&config.termination);
        Self {
            name: name.into(),
            speed_mps: config.command.speed_mps,
            strafe: config.command.strafe,
            speed_scale_mps: config.reward.speed_scale_mps,
            max_tracking_error_metres: config.termination.max_tracking_error_metres,
            termination,
            fall_height: match termination {
                TerminationRule::Upright(_) => Some(config.termination.fall_metres),
                TerminationRule::Lying => Some(config.termination.lying_metres),
                TerminationRule::Again | TerminationRule::Never => None,
            },
            share,
            task: 1.0,
            root_metres: 0.0,
            edge_secs: config.command.edge_secs,
        }
    }
}

/// policy-core's graph of nodes, edges and paths. The policies only give the costs of ways, which here are hops.
pub(super) fn policy_graph(
    nodes: &[GraphNode],
    pairs: &[[usize; 2]],
    paths: Vec<(String, Vec<NodeId>)>,
    factors: [f32; 2],
) -> Result<PolicyGraph, GraphError> {
    let layer = Layer::from_input_major(1, 1, &[0.0], &[0.0]).expect("one zero is a layer");
    let policy = Mlp::from_layers(vec![layer]).expect("one layer is a network");
    let edges: Vec<_> = pairs
        .iter()
        .map(|pair| Edge::new(pair.map(NodeId::new), edge_seconds(pair.map(|node| &nodes[node]), factors)))
        .collect();
    let known = |node: &GraphNode| Node {
        name: node.name.clone(),
        fall_height: node.fall_height,
        speed_mps: Some(node.speed_mps),
        strafes: node.strafe.is_some(),
        ..Node::default()
    };
    let policies = vec![policy; nodes.len()];
    PolicyGraph::from_parts(nodes.iter().map(known).collect(), &edges, paths, &policies)
}

/// Seconds from the first node to the second and back; at least a tick.
fn edge_seconds([from, to]: [&GraphNode; 2], [faster, slower]: [f32; 2]) -> [f32; 2] {
    let secs = from.edge_secs.max(to.edge_secs);
    let upright = [from, to].iter().all(|node| node.termination == TerminationRule::Upright(1.0));
    let factors = match (upright, to.speed_mps > from.speed_mps) {
        (true, true) => [faster, slower],
        (true, false) => [slower, faster],
        (false, _) => [1.0; 2],
    };
    factors.map(|factor| (secs * factor).max(DT_SECS))
}
