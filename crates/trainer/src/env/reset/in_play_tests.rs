use policy_core::ControllerConfig;
use random::Rng;

use super::super::super::config::EnvironmentConfig;
use super::super::super::demonstrations::Demonstrations;
use super::super::super::made_up::{Setting, shipped, still};
use super::*;

/// Speeds at the starts of 16 tries of a skill, and how many of them track a clip.
fn starts(speed_mps: f32, maximum_speed_mps: Option<f32>, tracking_weight: f32) -> (Vec<f32>, usize) {
    starts_of(speed_mps, InPlayConfig { maximum_speed_mps, ..Default::default() }, tracking_weight)
}

fn starts_of(speed_mps: f32, in_play: InPlayConfig, tracking_weight: f32) -> (Vec<f32>, usize) {
    let mut config = EnvironmentConfig::default();
    (config.reward.tracking_weight, config.command.speed_mps) = (tracking_weight, speed_mps);
    let (mut speeds, mut tracking) = (Vec::new(), 0);
    start_each(config, in_play, |env| {
        speeds.push(env.state.horizontal_speed());
        tracking += usize::from(env.tracks());
    });
    (speeds, tracking)
}

/// Looks at the starts of 16 tries.
fn start_each(mut config: EnvironmentConfig, in_play: InPlayConfig, mut look: impl FnMut(&mut Env)) {
    let (model, pack, normalisers) = shipped();
    let clips = Demonstrations::from_clips(&[(still(30), 1.0, false)], &model, &normalisers.frame).unwrap();
    config.reset.in_play = Some(in_play);
    let gaits = Controller::with_config(pack, ControllerConfig { auto_recover: false, ..Default::default() });
    let setting = Setting::alone("learns", (model, normalisers), config);
    let demonstrations = [&clips];
    let pushed = [setting.model.skeleton().root()];
    let context = EnvContext { company: Some(&gaits), pushed: &pushed, ..setting.context(&demonstrations) };
    let mut env = Env::new(&setting.model, &context, Rng::new(8, 0));
    for _ in 0..16 {
        if env.start_in_play(&context) {
            look(&mut env);
        }
    }
    assert!(env.played.len() == KEPT, "{} starts are kept", env.played.len());
    let without = EnvironmentConfig::default();
    assert!(!env.start_in_play(&EnvContext { config: &without, ..context }));
}

#[test]
fn a_skill_starts_where_a_character_is_slow_enough_and_tracks_its_clip_from_there() {
    let (speeds, tracking) = starts(0.0, Some(0.5), 0.9);
    assert!(speeds.len() >= 12 && tracking == speeds.len(), "{speeds:?}, {tracking}");
    assert!(speeds.iter().all(|speed| *speed < 0.5) && speeds.iter().any(|speed| *speed > 0.1));
}

#[test]
fn a_variant_that_stands_starts_where_the_stick_is_let_go_and_one_that_moves_anywhere() {
    for speed_mps in [0.0, 1.2] {
        let (speeds, tracking) = starts(speed_mps, None, 0.0);
        assert!(speeds.len() >= 12 && tracking == 0, "{speeds:?}, {tracking}");
        assert!(speeds.iter().any(|speed| *speed > 0.5), "{speeds:?}");
    }
}

#[test]
fn a_variant_that_sets_off_starts_out_of_a_stand_alone() {
    let in_play = InPlayConfig { out_of: OutOf::Stand, ..Default::default() };
    let (speeds, _) = starts_of(1.2, in_play, 0.0);
    assert!(speeds.len() >= 12 && speeds.iter().all(|speed| *speed < STANDS_MPS), "{speeds:?}");
}

#[test]
fn variants_that_stop_or_turn_start_in_the_middle_of_a_stride() {
    for speed_mps in [0.0, 1.5] {
        let in_play = InPlayConfig { out_of: OutOf::Stride, ..Default::default() };
        let (speeds, _) = starts_of(speed_mps, in_play, 0.0);
        assert!(speeds.len() >= 12 && speeds.iter().all(|speed| *speed > 0.4), "{speeds:?}");
        assert!(speeds.iter().any(|speed| *speed > 1.5), "out of a jog or a run too: {speeds:?}");
    }
}

#[test]
fn a_skill_out_of_a_run_starts_as_a_foot_comes_down_and_tracks_its_clip() {
    let mut config = EnvironmentConfig::default();
    config.reward.tracking_weight = 0.9;
    let in_play = InPlayConfig { out_of: OutOf::Run, ..Default::default() };
    let mut starts = 0;
    start_each(config, in_play, |env| {
        let velocity = env.state.root().linear_velocity.truncate();
        assert!(velocity.length() >= RUNS_MPS, "{velocity}");
        assert!(env.tracks() && foot_comes_down(env.character.model().skeleton(), &env.state));
        starts += 1;
    });
    assert!(starts >= 12, "{starts}");
}

#[test]
fn a_variant_that_rises_starts_out_of_a_crawl_and_on_the_way_down() {
    let in_play = InPlayConfig { out_of: OutOf::Low, ..Default::default() };
    let mut heights = Vec::new();
    start_each(EnvironmentConfig::default(), in_play, |env| heights.push(env.state.root_height()));
    assert!(heights.len() >= 12, "{heights:?}");
    assert!(heights.iter().any(|height| *height < 0.4), "in a crawl: {heights:?}");
    assert!(heights.iter().any(|height| *height > 0.5), "on the way down: {heights:?}");
}

#[test]
fn a_variant_that_catches_starts_in_the_middle_of_a_push_and_is_to_go_on() {
    for (out_of, heights) in [(OutOf::Push, 0.6..1.1), (OutOf::PushInCrouch, 0.3..0.85)] {
        let mut config = EnvironmentConfig::default();
        (config.command.speed_mps, config.command.stick_share, config.command.stop_share) = (1.5, 1.0, 0.0);
        config.randomisation.push_newton = 600.0;
        let in_play = InPlayConfig { out_of, ..Default::default() };
        let (mut starts, mut driven) = (0, 0);
        start_each(config, in_play, |env| {
            starts += 1;
            let (velocity, way) =
                (env.state.root().linear_velocity.truncate(), env.command.target - env.root_position());
            // Straight on its velocity would be along its way.
            driven += usize::from(velocity.perp_dot(way.normalize()).abs() > 0.3);
            assert!(velocity.length() > 0.1 && way.length() > 1.0, "{velocity}, {way}");
            let height = env.state.root_height();
            assert!(heights.contains(&height), "{out_of:?}: {height}");
        });
        assert!(starts >= 12 && driven >= 3, "{driven} of {starts} are driven aside");
    }
}
