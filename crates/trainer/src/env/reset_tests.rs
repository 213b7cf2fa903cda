use std::path::Path;

use glam::{Quat, Vec3};
use physics_bridge::Model;
use policy_core::{BODY_COUNT, Body};

use super::super::config::EnvironmentConfig;
use super::super::demonstrations::Demonstrations;
use super::super::graph::{GraphNode, TrainingGraph};
use super::super::normalisers::Normalisers;
use super::super::termination::TerminationHeights;
use super::*;
use crate::Rng;
use crate::clip::tests::still;

#[test]
fn a_standing_start_is_upright_and_moves_ahead() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
    let model = Model::load(path).unwrap();
    let mut tilted = still(30);
    tilted.local_rotations = vec![[Quat::from_rotation_x(0.3); BODY_COUNT]; 30];
    let normalisers = Normalisers::from_clips(std::slice::from_ref(&tilted), &model).unwrap();
    let clips = Demonstrations::from_clips(&[(tilted, 1.0, false)], &model, &normalisers.frame).unwrap();
    let mut config = EnvironmentConfig::default();
    (config.reset.standing_share, config.reward.tracking_weight) = (1.0, 0.5);
    let context = EnvContext {
        config: &config,
        graph: &TrainingGraph::new(vec![GraphNode::new("walk", &config, 1.0)], vec![vec![0]]),
        demonstrations: &[&clips],
        start_demonstrations: None,
        hand_over: None,
        normalisers: &normalisers,
        heights: &TerminationHeights::new(&config.termination).unwrap(),
    };
    let mut env = Env::new(&model, Rng::new(5, 0));
    let mut speeds = Vec::new();
    for _ in 0..20 {
        env.reset(&context, false);
        let pelvis = *env.state.body(Body::Pelvis);
        assert!((pelvis.rotation * Vec3::Z).z > 0.999 && env.state.height_of(Body::Pelvis) > 0.8);
        let along = pelvis.linear_velocity.truncate().dot(env.heading().direction());
        assert!((along - pelvis.linear_velocity.length()).abs() < 1e-4, "{:?}", pelvis.linear_velocity);
        assert!(!env.tracks(), "a clip that it did not start in");
        speeds.push(along);
    }
    let most = speeds.iter().copied().fold(0.0, f32::max);
    assert!(most <= WALKING_START_MPS && most > 0.7 * WALKING_START_MPS, "{speeds:?}");
    assert!(speeds.iter().any(|speed| *speed < 0.3 * WALKING_START_MPS), "{speeds:?}");
}
