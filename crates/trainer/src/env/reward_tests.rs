use super::*;

/// Reward at the origin with these settings.
fn with(
    config: &RewardConfig,
    velocity: Vec2,
    target: Vec2,
    [speed_mps, speed_scale_mps]: [f32; 2],
) -> RewardTerms {
    let state = CharacterState::new(&Skeleton::humanoid());
    target_reward(config, &state, velocity, target, Pace { speed_mps, speed_scale_mps, facing: None })
}

/// The same with the default ones.
fn at(velocity: Vec2, target: Vec2, pace: [f32; 2]) -> RewardTerms {
    with(&RewardConfig::default(), velocity, target, pace)
}

/// A body of the humanoid.
fn body(name: &str) -> BodyId {
    Skeleton::humanoid().body_named(name).unwrap()
}

#[test]
fn a_target_far_aside_is_a_turn_and_one_close_by_is_none() {
    let turning =
        |angle: f32, metres: f32| at(Vec2::ZERO, Vec2::from_angle(angle) * metres, [1.25, 0.6]).turning;
    assert_eq!([turning(0.3, 5.0), turning(3.0, 5.0)], [0.0, 1.0]);
    assert!((turning(-0.8, 5.0) - 0.5).abs() < 1e-4);
    assert_eq!(turning(3.0, 0.0), 0.0);
}

const AHEAD: Vec2 = Vec2::new(5.0, 0.0);

#[test]
fn the_right_speed_towards_the_target_is_worth_one() {
    let terms = at(Vec2::new(1.25, 0.0), AHEAD, [1.25, 0.6]);
    assert!((terms.task - 1.0).abs() < 1e-6);
    let away = at(Vec2::new(-1.25, 0.0), AHEAD, [1.25, 0.6]);
    assert!(away.task < 0.5);
}

#[test]
fn a_walk_asked_to_run_or_to_stand_feels_a_slope() {
    let run = |speed: f32| at(Vec2::new(speed, 0.0), AHEAD, [3.5, 0.6]).task;
    assert!(run(1.5) - run(1.3) > 0.02, "{} {}", run(1.5), run(1.3));
    let stand = |speed: f32| at(Vec2::new(speed, 0.0), AHEAD, [0.0, 0.6]).task;
    assert!(stand(1.2) - stand(1.4) > 0.02, "{} {}", stand(1.2), stand(1.4));
}

#[test]
fn a_slow_gait_that_rests_misses_most_of_its_reward() {
    let crawl = |speed: f32| at(Vec2::new(speed, 0.0), AHEAD, [0.34, 0.2]).task;
    assert!(crawl(0.34) - crawl(0.0) > 0.4, "{}", crawl(0.0));
}

#[test]
fn every_degree_towards_the_target_pays() {
    let at = |degrees: f32| at(Vec2::ZERO, 5.0 * Vec2::from_angle(degrees.to_radians()), [0.3, 0.6]).task;
    for degrees in (0..180).step_by(10).map(|d| d as f32) {
        assert!(at(degrees) - at(degrees + 10.0) > 0.01, "{degrees}");
        assert!((at(degrees) - at(-degrees)).abs() < 1e-6);
    }
}

#[test]
fn a_strict_facing_makes_a_little_sideways_cost_much() {
    let at = |degrees: f32, strict_facing_share: f32| {
        let target = 5.0 * Vec2::from_angle(degrees.to_radians());
        let config = RewardConfig { strict_facing_share, ..RewardConfig::default() };
        with(&config, 0.3 * target.normalize(), target, [0.3, 0.6]).task
    };
    assert!((at(0.0, 1.0) - 1.0).abs() < 1e-6 && (at(180.0, 0.5) - 0.7).abs() < 1e-4);
    // 0.3 of 30 degrees in 180, and of a bell of 0.4 radians.
    assert!((at(30.0, 0.0) - 0.95).abs() < 1e-4);
    assert!((at(30.0, 1.0) - (0.7 + 0.3 * (-(30.0_f32.to_radians() / 0.4).powi(2)).exp())).abs() < 1e-4);
    assert!((at(30.0, 0.5) - 0.5 * (at(30.0, 0.0) + at(30.0, 1.0))).abs() < 1e-6);
}

#[test]
fn facing_away_takes_the_reward_for_speed() {
    let at = |degrees: f32, facing_factor: f32| {
        let target = 5.0 * Vec2::from_angle(degrees.to_radians());
        let config = RewardConfig { facing_factor, ..RewardConfig::default() };
        with(&config, 0.3 * target.normalize(), target, [0.3, 0.6]).task
    };
    assert!((at(0.0, 1.0) - 1.0).abs() < 1e-6);
    // A quarter turn away: half of 0.3 for facing, and half of 0.7 for speed.
    assert!((at(90.0, 1.0) - 0.5).abs() < 1e-4 && (at(90.0, 0.5) - 0.675).abs() < 1e-4);
    assert!(at(180.0, 1.0).abs() < 1e-4 && (at(180.0, 0.0) - 0.7).abs() < 1e-4);
}

#[test]
fn a_rate_to_turn_at_pays_for_that_rate_and_for_going_where_it_faces() {
    let config = RewardConfig { turn_rate_rps: 1.0, facing_factor: 1.0, ..RewardConfig::default() };
    let task = |degrees: f32, rate: f32, velocity: Vec2| {
        let mut state = CharacterState::new(&Skeleton::humanoid());
        state.bodies[0].angular_velocity.z = rate;
        let pace = Pace { speed_mps: 0.3, speed_scale_mps: 0.2, facing: None };
        target_reward(&config, &state, velocity, 5.0 * Vec2::from_angle(degrees.to_radians()), pace).task
    };
    let ahead = Vec2::new(0.3, 0.0);
    assert!((task(90.0, 1.0, ahead) - 1.0).abs() < 1e-5 && (task(-90.0, -1.0, ahead) - 1.0).abs() < 1e-5);
    // Three tenths for half the rate, all six for turning away, and nothing more for a spin.
    assert!((task(90.0, 0.0, ahead) - 0.7).abs() < 1e-5 && (task(90.0, -1.0, ahead) - 0.4).abs() < 1e-5);
    assert!((task(90.0, 9.0, ahead) - 0.4).abs() < 1e-5);
    // 0.1 radians are left: it turns at a fifth of the rate.
    assert!((task(0.1_f32.to_degrees(), 0.2, ahead) - 1.0).abs() < 1e-4);
    let aside = task(90.0, 1.0, Vec2::new(0.0, 0.3));
    assert!(aside < 0.85, "going to the target without facing it: {aside}");
}

#[test]
fn every_centimetre_off_the_ground_pays() {
    let at = |metres: f32| {
        let mut state = CharacterState::new(&Skeleton::humanoid());
        state.bodies[0].position.z = metres;
        state.bodies[body("head").index()].position.z = 1.5 * metres;
        standing_reward(&RewardConfig::default(), &Skeleton::humanoid(), &state).task
    };
    assert!(at(0.2) - at(0.1) > 0.05, "{} {}", at(0.2), at(0.1));
    assert!((at(0.9) - 1.0).abs() < 1e-6);
}

#[test]
fn a_foot_that_slips_under_the_weight_costs_and_one_that_rolls_or_swings_does_not() {
    let mut state = CharacterState::new(&Skeleton::humanoid());
    let foot = &mut state.bodies[body("left_foot").index()];
    (foot.position, foot.linear_velocity) = (Vec3::new(0.0, 0.0, 0.05), Vec3::new(0.4, 0.3, 0.2));
    let touch = |body, newton: f32| Contact {
        body,
        other: None,
        position: Vec3::ZERO,
        normal: Vec3::Z,
        force: Vec3::new(50.0, 0.0, newton),
        depth: 0.0,
    };
    let both = [touch(body("left_foot"), 240.0), touch(body("left_hand"), 240.0)];
    assert!((foot_slip_mps(Skeleton::humanoid().feet(), &state, &both, 480.0, 1.0) - 0.25).abs() < 1e-6);
    assert_eq!(foot_slip_mps(Skeleton::humanoid().feet(), &state, &[], 480.0, 1.0), 0.0);
    // A foot that lands with three times the weight costs more than the limit.
    let lands = [touch(body("left_foot"), 3.0 * 480.0)];
    for (most, expected) in [(1.0, 1.0), (4.0, 1.5)] {
        let slip = foot_slip_mps(Skeleton::humanoid().feet(), &state, &lands, 480.0, most);
        assert!((slip - expected).abs() < 1e-6, "{slip}");
    }
    // The point that touches rests while the foot turns about it.
    let foot = &mut state.bodies[body("left_foot").index()];
    (foot.linear_velocity, foot.angular_velocity) = (Vec3::new(0.4, 0.0, 0.0), Vec3::new(0.0, 8.0, 0.0));
    assert!(foot_slip_mps(Skeleton::humanoid().feet(), &state, &both, 480.0, 1.0) < 1e-6);
}

#[test]
fn at_the_target_standing_is_best_whatever_the_heading() {
    assert!((at(Vec2::ZERO, Vec2::ZERO, [1.25, 0.6]).task - 1.0).abs() < 1e-6);
    assert!(at(Vec2::X, Vec2::ZERO, [1.25, 0.6]).task < 0.7);
}

#[test]
fn going_sideways_costs_by_its_weight() {
    let drift = |sideways_weight| {
        let config = RewardConfig { sideways_weight, ..RewardConfig::default() };
        with(&config, Vec2::new(1.25, 0.4), AHEAD, [1.25, 0.6]).task
    };
    assert!((drift(0.0) - 1.0).abs() < 1e-6);
    assert!(drift(0.25) - drift(1.0) > 0.1, "{} {}", drift(0.25), drift(1.0));
}

#[test]
fn the_linear_share_has_a_slope_right_after_a_flip() {
    // Going the wrong way at 1.25 m/s, and a little slower.
    let gain = |linear_speed_share| {
        let config = RewardConfig { linear_speed_share, ..RewardConfig::default() };
        let at = |speed| with(&config, Vec2::new(speed, 0.0), AHEAD, [1.25, 0.6]).task;
        at(-1.0) - at(-1.25)
    };
    assert!(gain(0.0) < 0.01 && gain(0.5) > 0.03, "{} {}", gain(0.0), gain(0.5));
    let exact = RewardConfig { linear_speed_share: 0.5, ..RewardConfig::default() };
    assert!((with(&exact, Vec2::new(1.25, 0.0), AHEAD, [1.25, 0.6]).task - 1.0).abs() < 1e-6);
}

#[test]
fn what_strafes_is_paid_for_facing_its_own_way_and_little_for_speed_without_it() {
    let state = CharacterState::new(&Skeleton::humanoid());
    let task = |facing: Vec2, velocity: Vec2, target: Vec2| {
        let pace = Pace { speed_mps: 1.0, speed_scale_mps: 0.6, facing: Some((facing, 1.0)) };
        target_reward(&RewardConfig::default(), &state, velocity, target, pace).task
    };
    // It faces along x.
    let aside = task(Vec2::X, Vec2::Y, Vec2::Y * 5.0);
    assert!((aside - 1.0).abs() < 1e-6, "aside, facing ahead: {aside}");
    let turned_away = task(-Vec2::X, Vec2::X, Vec2::X * 5.0);
    assert!(turned_away < 0.01, "ahead, and to face back: {turned_away}");
    let stands = task(Vec2::X, Vec2::ZERO, Vec2::ZERO);
    assert!((stands - 1.0).abs() < 1e-6, "standing: {stands}");
}

#[test]
fn a_pelvis_ahead_of_its_head_is_paid_for_half_of_its_speed() {
    let skeleton = Skeleton::humanoid();
    let mut state = CharacterState::new(&skeleton);
    state.body_mut(body("head")).linear_velocity = glam::Vec3::new(-0.2, 0.4, 1.0);
    let paid = |head_speed_share| {
        let config = RewardConfig { head_speed_share, ..RewardConfig::default() };
        paid_velocity(&config, &skeleton, &state, Vec2::X)
    };
    assert_eq!(paid(0.0), Vec2::X);
    assert!(paid(0.5).abs_diff_eq(Vec2::new(0.4, 0.2), 1e-6));
}
