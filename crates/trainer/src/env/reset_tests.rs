use std::path::Path;

use clips::Clip;
use glam::{Quat, Vec2, Vec3};
use physics_bridge::Model;
use random::Rng;

use super::super::config::EnvironmentConfig;
use super::super::demonstrations::Demonstrations;
use super::super::made_up::{Setting, still};
use super::super::normalisers::Normalisers;
use super::*;
use crate::ppo::Done;

/// The humanoid, and one clip to train on with its normalisers.
fn humanoid_with(clip: Clip) -> (Model, Normalisers, Demonstrations) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
    let model = Model::load(path).unwrap();
    let normalisers = Normalisers::from_clips(std::slice::from_ref(&clip), &model).unwrap();
    let clips = Demonstrations::from_clips(&[(clip, 1.0, false)], &model, &normalisers.frame).unwrap();
    (model, normalisers, clips)
}

#[test]
fn a_standing_start_is_upright_and_moves_ahead() {
    let mut tilted = still(30);
    tilted.local_rotations = vec![vec![Quat::from_rotation_x(0.3); 15]; 30];
    let (model, normalisers, clips) = humanoid_with(tilted);
    let mut config = EnvironmentConfig::default();
    (config.reset.standing_share, config.reward.tracking_weight) = (1.0, 0.5);
    let setting = Setting::alone("walk", (model, normalisers), config);
    let demonstrations = [&clips];
    let context = setting.context(&demonstrations);
    let mut env = Env::new(&setting.model, &context, Rng::new(5, 0));
    let mut speeds = Vec::new();
    for _ in 0..20 {
        env.reset(&context, false);
        let root = *env.state.root();
        assert!((root.rotation * Vec3::Z).z > 0.999 && env.state.root_height() > 0.8);
        let along = root.linear_velocity.truncate().dot(env.heading().direction());
        assert!((along - root.linear_velocity.length()).abs() < 1e-4, "{:?}", root.linear_velocity);
        assert!(!env.tracks(), "a clip that it did not start in");
        speeds.push(along);
    }
    let most = speeds.iter().copied().fold(0.0, f32::max);
    assert!(most <= WALKING_START_MPS && most > 0.7 * WALKING_START_MPS, "{speeds:?}");
    assert!(speeds.iter().any(|speed| *speed < 0.3 * WALKING_START_MPS), "{speeds:?}");
}

/// Settings of a skill that sees a clock of 1.5 s.
fn timed() -> EnvironmentConfig {
    let mut config = EnvironmentConfig::default();
    (config.command.clock_seconds, config.reward.tracking_weight) = (1.5, 0.9);
    config
}

#[test]
fn a_timed_skill_is_to_go_straight_ahead() {
    let (model, normalisers, clips) = humanoid_with(still(46));
    let mut config = timed();
    (config.command.stick_share, config.command.stop_share) = (1.0, 0.0);
    config.reset.standing_share = 0.3;
    let setting = Setting::alone("kick", (model, normalisers), config);
    let demonstrations = [&clips];
    let context = setting.context(&demonstrations);
    let mut env = Env::new(&setting.model, &context, Rng::new(6, 0));
    for _ in 0..16 {
        env.reset(&context, false);
        let ahead = env.heading().direction();
        let way = (env.command.target - env.root_position()).normalize();
        assert!(ahead.distance(way) < 1e-3, "it faces {ahead} and is to go {way}");
    }
}

#[test]
fn a_timed_skill_sees_the_second_of_its_clip_in_every_start() {
    let (model, normalisers, clips) = humanoid_with(still(46));
    let mut config = timed();
    (config.reset.standing_share, config.reset.other_clips_share) = (0.3, 0.3);
    let setting = Setting::alone("kick", (model, normalisers), config);
    let demonstrations = [&clips];
    let context = EnvContext { start_demonstrations: Some(&clips), ..setting.context(&demonstrations) };
    let mut env = Env::new(&setting.model, &context, Rng::new(6, 0));
    let mut input = vec![0.0; context.critic_inputs()];
    let at = context.skeleton.observation_len();
    // How far the hand of the clock has gone, in [0, 1].
    let mut share = |env: &Env| {
        env.observe_into(&context, &mut input);
        let [x, y] = [input[at], input[at + 1]];
        assert!((x.hypot(y) - 2.5).abs() < 1e-3, "{x} {y}");
        y.atan2(x) / std::f32::consts::PI
    };
    let (mut starts, mut over) = (Vec::new(), 0);
    for _ in 0..80 {
        env.reset(&context, false);
        let before = share(&env);
        starts.push(before);
        // At the end of the clip the clock stands still. What is seen then is what the time-out is valued by.
        let ended = env.track_clip(&context).1 == Done::TimedOut;
        let ticks = if ended { 0.0 } else { 1.0 };
        assert!((share(&env) - before - ticks / 45.0).abs() < 1e-3, "a tick of 1.5 s");
        over += usize::from(ended);
    }
    assert!(over > 0, "no clip was over");
    let early = starts.iter().filter(|share| **share < 0.1).count();
    assert!((36..=64).contains(&early), "half from elsewhere begin with the clip: {early} of 80");
    assert!(starts.iter().any(|share| *share > 0.7), "others start anywhere in it: {starts:?}");
}

#[test]
fn a_character_that_is_to_stand_can_be_paid_for_facing_where_it_faced() {
    let (model, normalisers, clips) = humanoid_with(still(30));
    let paid = |kept_facing_share, stop_share, turned: f32| {
        let mut config = EnvironmentConfig::default();
        (config.reset.standing_share, config.command.stop_share) = (1.0, stop_share);
        (config.command.stick_share, config.reward.kept_facing_share) = (1.0, kept_facing_share);
        let setting = Setting::alone("idle", (model.clone(), normalisers.clone()), config);
        let demonstrations = [&clips];
        let context = setting.context(&demonstrations);
        let mut env = Env::new(&setting.model, &context, Rng::new(7, 0));
        env.reset(&context, false);
        env.command.target = env.root_position();
        let root = &mut env.state.bodies[0];
        root.rotation = Quat::from_rotation_z(turned) * root.rotation;
        env.reward(&context, Vec2::ZERO).task
    };
    assert!((paid(1.0, 1.0, 0.0) - paid(0.0, 1.0, 0.0)).abs() < 1e-6, "it faces where it faced");
    assert!(paid(1.0, 1.0, 1.0) < paid(1.0, 1.0, 0.5) && paid(1.0, 1.0, 0.5) < paid(1.0, 1.0, 0.0) - 0.02);
    assert_eq!(paid(0.0, 1.0, 1.0), paid(0.0, 1.0, 0.0), "without a share it may turn");
    assert_eq!(paid(1.0, 0.0, 1.0), paid(1.0, 0.0, 0.0), "and a character that is to go turns to its target");
}
