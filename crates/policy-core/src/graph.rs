//! The policy graph: nodes are policies, edges join a policy to the one it was regularised towards, paths
//! are ordered lists of nodes that a trigger runs along (paper, section 3.2).

use alloc::string::String;
use alloc::vec::Vec;

use crate::ids::{NodeId, PathId};
use crate::mlp::Mlp;
use crate::path::{GraphPosition, Path};
use crate::route::RouteTable;

/// Most policies in one graph.
pub const MAX_NODES: usize = 64;

/// One policy of the graph; its index is that of its parameters in the pack. The default has neither name nor variants: something to fill in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Node {
    /// Unique name, such as `walk`.
    pub name: String,
    /// A root lower than this above the ground, metres, means that the character has fallen; `None` where no height
    /// does. Coming here from a lower gait, such as a crawl, requires standing first: the root 0.1 m above this
    /// height. Standing up for more than 3 s counts as a fall.
    pub fall_height: Option<f32>,
    /// Speed at which a character goes straight ahead here, metres per second, where it has one.
    pub speed_mps: Option<f32>,
    /// True for a policy that faces [`Command::facing`](crate::Command::facing) and moves in any direction.
    pub strafes: bool,
    /// Variant of the policy that it is blended with on uneven ground.
    pub rough_ground: Option<NodeId>,
    /// Variant of the policy that it is blended with while the character does not move yet as it is asked to.
    pub agile: Option<NodeId>,
    /// Variant of the policy that acts once the character stands still, or goes straight, for a while.
    pub steady: Option<NodeId>,
    /// Variant of a policy that moves: it acts while the character has no target and stays in the gait. That of a policy that stands acts on
    /// uneven ground, at its node.
    pub resting: Option<NodeId>,
    /// Variant of the policy that acts while the character sets off from a stand, until it is as fast as that variant's speed.
    pub starting: Option<NodeId>,
    /// Variant of the policy that acts from the moment in which a character that goes is to stand, until it stands.
    pub stopping: Option<NodeId>,
    /// Variant of the policy that acts while a character turns: from the moment in which its target lies far aside until it goes there, or faces it
    /// in a gait that is slower than 0.4 m/s.
    pub turning: Option<NodeId>,
    /// Variant of the policy that acts where a push drives a character that goes off its course, until it has its balance back.
    pub catching: Option<NodeId>,
    /// Variant of a low policy, such as a crawl, that acts while the character stands up out of it: until it has stood up for the fall height
    /// of that variant.
    pub rising: Option<NodeId>,
}

impl Node {
    /// True for a gait that stands: its speed is 0.
    #[must_use]
    pub fn stands(&self) -> bool {
        self.speed_mps == Some(0.0)
    }

    /// Its variants, where it has them: for rough ground, agile, steady, resting, starting, stopping, turning, catching, rising.
    #[must_use]
    pub fn variants(&self) -> [Option<NodeId>; 9] {
        let Self { rough_ground, agile, steady, resting, starting, stopping, turning, catching, .. } = *self;
        [rough_ground, agile, steady, resting, starting, stopping, turning, catching, self.rising]
    }
}

/// A straight line between the parameters of two policies that is itself a good policy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The two nodes.
    pub nodes: [NodeId; 2],
    /// Time from the first node to the second, seconds, above 0.
    pub seconds: f32,
    /// Time from the second node to the first, seconds, above 0.
    pub seconds_back: f32,
    /// True for an edge that a character crosses and does not rest on, because nothing half-way is a gait: between a crouch
    /// and a crawl. See [`PolicyGraph::settled`].
    pub transit: bool,
    /// Euclidean distance between the parameters: the cost of the edge in graph search.
    pub distance: f32,
}

impl Edge {
    /// An edge to rest on. Its distance is found when the graph is made.
    #[must_use]
    pub fn new(nodes: [NodeId; 2], [seconds, seconds_back]: [f32; 2]) -> Self {
        Self { nodes, seconds, seconds_back, transit: false, distance: 0.0 }
    }

    /// Time to the other end from `node`, seconds.
    #[must_use]
    pub fn seconds_from(&self, node: NodeId) -> f32 {
        if node == self.nodes[0] { self.seconds } else { self.seconds_back }
    }
}

/// Nodes, edges and paths, and the cheapest ways between nodes. Immutable; part of a
/// [`CharacterPack`](crate::CharacterPack).
#[derive(Clone, Debug)]
pub struct PolicyGraph {
    nodes: Vec<Node>,
    edges: Vec<Edge>,
    paths: Vec<Path>,
    routes: RouteTable,
    strafing: Option<NodeId>,
    greatest_fall_height: f32,
}

/// Why a graph can't be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GraphError {
    /// No node, or too many.
    #[error("expected 1 to {MAX_NODES} policies, found {found}")]
    NodeCount {
        /// Nodes given.
        found: usize,
    },
    /// Two things of one kind share a name, or the name is empty.
    #[error("expected a {kind} name that is not empty and unique, found {name:?}")]
    Name {
        /// `policy`, `path`, ...
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A number of a node is not what it must be.
    #[error("expected {expected} for {field} of policy {node:?}, found {found}")]
    NodeNumber {
        /// Name of the node.
        node: String,
        /// Name of the field.
        field: &'static str,
        /// What it must be.
        expected: &'static str,
        /// What it is.
        found: f32,
    },
    /// An edge joins a node to itself, to a node that is not there, takes no finite time above 0, or is infinitely long.
    #[error(
        "expected edge {edge} to join two different policies at a finite distance in a finite time above 0, found \
         {found:?}"
    )]
    Edge {
        /// Index of the edge.
        edge: usize,
        /// The edge.
        found: Edge,
    },
    /// A path is too short or runs where there is no edge.
    #[error("expected path {path:?} to run along edges from node to node, found {from} then {to:?}")]
    Path {
        /// Name of the path.
        path: String,
        /// Index of a node.
        from: usize,
        /// Index of the next node, if any.
        to: Option<usize>,
    },
}

impl PolicyGraph {
    /// A graph of nodes, edges, and paths as (name, nodes). `policies` are the nodes' parameters and give the edges their
    /// distances.
    ///
    /// # Errors
    /// When a name, number, edge or path is not as [`GraphError`] says.
    ///
    /// # Panics
    /// When there are not as many policies as nodes or their shapes differ; a pack is checked before.
    pub fn from_parts(
        nodes: Vec<Node>,
        edges: &[Edge],
        paths: Vec<(String, Vec<NodeId>)>,
        policies: &[Mlp],
    ) -> Result<Self, GraphError> {
        assert_eq!(nodes.len(), policies.len(), "one policy for each node");
        if !(1..=MAX_NODES).contains(&nodes.len()) {
            return Err(GraphError::NodeCount { found: nodes.len() });
        }
        check_names("policy", nodes.iter().map(|n| n.name.as_str()))?;
        check_names("path", paths.iter().map(|(name, _)| name.as_str()))?;
        for node in &nodes {
            check_node(node)?;
        }
        let mut checked = Vec::with_capacity(edges.len());
        for (index, &edge) in edges.iter().enumerate() {
            let mut edge = Edge { distance: 0.0, ..edge };
            let [a, b] = edge.nodes.map(NodeId::index);
            let joins = a != b && a < nodes.len() && b < nodes.len();
            let timed = [edge.seconds, edge.seconds_back].iter().all(|s| *s > 0.0 && s.is_finite());
            if !joins || !timed {
                return Err(GraphError::Edge { edge: index, found: edge });
            }
            // `joins` says that both are nodes, and there is a policy for each node.
            edge.distance = libm::sqrt(policies[a].squared_distance(&policies[b])) as f32;
            // Parameters near the greatest number are finite, but their difference may not be.
            if !edge.distance.is_finite() {
                return Err(GraphError::Edge { edge: index, found: edge });
            }
            checked.push(edge);
        }
        let routes = RouteTable::new(nodes.len(), &checked);
        let paths = paths.into_iter().map(|(name, nodes)| Path { name, nodes }).collect();
        let strafing = nodes.iter().position(|node| node.strafes).map(NodeId::new);
        let mut graph = Self { nodes, edges: checked, paths, routes, strafing, greatest_fall_height: 0.0 };
        let heights = graph.originals().filter_map(|(_, node)| node.fall_height);
        graph.greatest_fall_height = heights.fold(0.0, f32::max);
        for path in &graph.paths {
            graph.check_path(path)?;
        }
        Ok(graph)
    }

    fn check_path(&self, path: &Path) -> Result<(), GraphError> {
        let bad = |from: NodeId, to: Option<NodeId>| {
            let (from, to) = (from.index(), to.map(NodeId::index));
            Err(GraphError::Path { path: path.name.clone(), from, to })
        };
        if path.nodes.len() < 2 {
            return bad(path.nodes.first().copied().unwrap_or_default(), None);
        }
        // `windows` gives pairs. A path along edges names nodes of the graph only.
        match path.nodes.windows(2).find(|pair| self.edge_between(pair[0], pair[1]).is_none()) {
            Some(pair) => bad(pair[0], Some(pair[1])),
            None => Ok(()),
        }
    }

    /// Nodes, by index.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// A node.
    ///
    /// # Panics
    /// When the id is of another graph.
    #[must_use]
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// Nodes that are no variant of another one, with their ids.
    pub fn originals(&self) -> impl Iterator<Item = (NodeId, &Node)> {
        let all = self.nodes.iter().enumerate().map(|(index, node)| (NodeId::new(index), node));
        all.filter(|(id, _)| !self.is_variant(*id))
    }

    /// True for a node that is a variant of another one: for rough ground, an agile one and so on.
    #[must_use]
    pub fn is_variant(&self, id: NodeId) -> bool {
        self.nodes.iter().any(|node| node.variants().contains(&Some(id)))
    }

    /// Edges.
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Paths, by index.
    #[must_use]
    pub fn paths(&self) -> &[Path] {
        &self.paths
    }

    /// A path.
    ///
    /// # Panics
    /// When the id is of another graph.
    #[must_use]
    pub fn path(&self, id: PathId) -> &Path {
        &self.paths[id.index()]
    }

    /// Cheapest ways between all nodes.
    #[must_use]
    pub fn routes(&self) -> &RouteTable {
        &self.routes
    }

    /// The node called `name`.
    #[must_use]
    pub fn node_named(&self, name: &str) -> Option<NodeId> {
        self.nodes.iter().position(|n| n.name == name).map(NodeId::new)
    }

    /// The path called `name`.
    #[must_use]
    pub fn path_named(&self, name: &str) -> Option<PathId> {
        self.paths.iter().position(|p| p.name == name).map(PathId::new)
    }

    /// The first node that strafes.
    pub(crate) fn strafing(&self) -> Option<NodeId> {
        self.strafing
    }

    /// The greatest fall height of a node that is no variant, metres; 0 where none has one. A rising variant has one of its own, which is that of
    /// no gait.
    pub(crate) fn greatest_fall_height(&self) -> f32 {
        self.greatest_fall_height
    }

    /// The first node that is a gait that stands.
    pub(crate) fn standing(&self) -> Option<NodeId> {
        self.nodes.iter().position(Node::stands).map(NodeId::new)
    }

    /// True when `position` lies on a node or an edge of this graph.
    #[must_use]
    pub fn contains(&self, position: GraphPosition) -> bool {
        let nodes = [position.from, position.to].iter().all(|n| n.index() < self.nodes.len());
        let joined = position.from == position.to || self.edge_between(position.from, position.to).is_some();
        nodes && joined && (0.0..=1.0).contains(&position.t)
    }

    /// The edge that joins two nodes.
    #[must_use]
    pub fn edge_between(&self, a: NodeId, b: NodeId) -> Option<&Edge> {
        self.edges.iter().find(|e| e.nodes == [a, b] || e.nodes == [b, a])
    }

    /// The edge that a position lies on; none at a node.
    pub(crate) fn edge_at(&self, position: GraphPosition) -> Option<&Edge> {
        match position.as_node() {
            Some(_) => None,
            None => self.edge_between(position.from, position.to),
        }
    }
}

pub(crate) fn check_names<'a>(
    kind: &'static str,
    names: impl Iterator<Item = &'a str> + Clone,
) -> Result<(), GraphError> {
    for (i, name) in names.clone().enumerate() {
        if name.is_empty() || names.clone().take(i).any(|n| n == name) {
            return Err(GraphError::Name { kind, name: name.into() });
        }
    }
    Ok(())
}

fn check_node(node: &Node) -> Result<(), GraphError> {
    let fields = [("fall_height", node.fall_height), ("speed_mps", node.speed_mps)];
    for (field, number) in fields {
        if let Some(found) = number.filter(|n| !n.is_finite() || *n < 0.0) {
            let expected = "a finite number of at least 0";
            return Err(GraphError::NodeNumber { node: node.name.clone(), field, expected, found });
        }
    }
    Ok(())
}
