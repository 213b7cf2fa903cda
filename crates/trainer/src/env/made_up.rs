//! What the tests of this folder make up, and the pack that they share.

use std::path::Path;
use std::sync::Arc;

use clips::Clip;
use glam::{Quat, Vec3};
use physics_bridge::Model;
use policy_core::{CharacterPack, Skeleton};

use super::config::EnvironmentConfig;
use super::demonstrations::Demonstrations;
use super::env::EnvContext;
use super::graph::{GraphNode, TrainingGraph};
use super::normalisers::Normalisers;
use super::termination::TerminationHeights;

/// What an environment needs: nothing is handed over, pushed or met in it.
pub(super) struct Setting {
    pub(super) model: Model,
    normalisers: Normalisers,
    config: EnvironmentConfig,
    graph: TrainingGraph,
    heights: TerminationHeights,
}

impl Setting {
    /// A setting of one skill.
    pub(super) fn alone(
        skill: &str,
        (model, normalisers): (Model, Normalisers),
        config: EnvironmentConfig,
    ) -> Self {
        let graph = TrainingGraph::alone(vec![GraphNode::new(skill, &config, 1.0)], 0).unwrap();
        Self::new((model, normalisers), config, graph)
    }

    /// A setting of skills on a graph.
    pub(super) fn new(
        (model, normalisers): (Model, Normalisers),
        config: EnvironmentConfig,
        graph: TrainingGraph,
    ) -> Self {
        let heights = TerminationHeights::new(&config.termination, model.skeleton()).unwrap();
        Self { model, normalisers, config, graph, heights }
    }

    /// Its context, with the clips of each skill.
    pub(super) fn context<'a>(&'a self, demonstrations: &'a [&'a Demonstrations]) -> EnvContext<'a> {
        EnvContext {
            config: &self.config,
            skeleton: self.model.skeleton(),
            graph: &self.graph,
            demonstrations,
            start_demonstrations: None,
            hand_over: &[],
            normalisers: &self.normalisers,
            heights: &self.heights,
            pushed: &[],
            company: None,
        }
    }
}

/// The shipped body and pack, and the pack's normalisers.
pub(super) fn shipped() -> (Model, Arc<CharacterPack>, Normalisers) {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    let model = Model::load(assets.join("humanoid.xml")).unwrap();
    let pack = std::fs::read(assets.join("humanoid.pack.safetensors")).unwrap();
    let pack = Arc::new(CharacterPack::from_bytes(&pack).unwrap());
    let normalisers = Normalisers {
        observation: pack.tensors().observation_normaliser.clone(),
        frame: pack.tensors().discriminator_normaliser.clone(),
    };
    (model, pack, normalisers)
}

/// Index of a body of the humanoid.
pub(super) fn body(name: &str) -> usize {
    Skeleton::humanoid().body_named(name).unwrap().index()
}

/// The humanoid at rest, 0.9 m up, for so many frames at 30 Hz.
pub(super) fn still(frames: usize) -> Clip {
    let bodies = Skeleton::humanoid().bodies().iter().map(|body| body.name.clone()).collect();
    Clip {
        name: "still".into(),
        looping: false,
        times: (0..frames).map(|i| i as f32 / 30.0).collect(),
        root_positions: vec![Vec3::new(0.0, 0.0, 0.9); frames],
        local_rotations: vec![vec![Quat::IDENTITY; 15]; frames],
        bodies,
    }
}
