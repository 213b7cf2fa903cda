//! Steering: a body that drifts is brought onto its course, and a turn is begun with a lead.

mod common;

use std::f32::consts::PI;
use std::sync::Arc;

use common::standing;
use glam::{Quat, Vec2};
use policy_core::{CharacterState, Command, Controller, ControllerConfig, ControllerState, Steering};

const DT: f32 = 1.0 / 30.0;

fn controller(steering: Option<Steering>) -> Controller {
    let config = ControllerConfig { steering, ..ControllerConfig::default() };
    Controller::with_config(Arc::new(common::pack(0.0)), config)
}

/// A body with this heading and course, radians, and speed.
fn body(heading: f32, course: f32, speed: f32) -> CharacterState {
    let mut state = standing();
    let root = &mut state.bodies[0];
    root.rotation = Quat::from_rotation_z(heading);
    root.linear_velocity = (Vec2::from_angle(course) * speed).extend(0.0);
    state
}

/// Angle of the policy's target in the heading frame after `ticks`. The target lies at this angle from world x.
fn asked(controller: &mut Controller, state: &CharacterState, target: f32, ticks: usize) -> f32 {
    let target = Some(state.root().position.truncate() + 5.0 * Vec2::from_angle(target));
    for _ in 0..ticks {
        controller.tick(state, &Command { target, ..Command::default() }, DT);
    }
    let [x, y] = controller.report().target;
    y.atan2(x)
}

/// The last course of a body that turns to the policy's target and slides aside by `drift`.
fn walked(steering: Option<Steering>, drift: f32, target: f32) -> f32 {
    let mut controller = controller(steering);
    let (mut heading, mut course) = (0.0, drift);
    for _ in 0..240 {
        let off = asked(&mut controller, &body(heading, course, 1.2), target, 1);
        heading += 3.0 * off * DT;
        course = heading + drift;
    }
    course
}

#[test]
fn drift_is_trimmed_away() {
    for drift in [0.3f32, -0.2] {
        for target in [0.0, 2.5, -PI + 0.1] {
            let off = |course: f32| (course - target + PI).rem_euclid(2.0 * PI) - PI;
            assert!((off(walked(None, drift, target)) - drift).abs() < 0.02);
            let left = off(walked(Some(Steering::default()), drift, target));
            assert!(left.abs() < 0.02, "{left} of {drift} to {target}");
        }
    }
}

#[test]
fn a_turn_is_led_up_to_a_right_angle_and_not_beyond_the_target() {
    let ask =
        |target: f32| asked(&mut controller(Some(Steering::default())), &body(0.0, 0.0, 1.2), target, 1);
    for target in [0.7f32, 1.0, -0.8] {
        assert!(ask(target).abs() > target.abs() + 0.1, "{target}: {}", ask(target));
        assert!(ask(target).abs() <= PI / 2.0 + 1e-4, "{target}: {}", ask(target));
    }
    for target in [2.0f32, 2.3, -2.2] {
        assert!((ask(target) - target).abs() < 1e-4, "{target}: {}", ask(target));
    }
}

#[test]
fn what_lies_behind_is_asked_for_at_the_side_to_which_the_body_turns() {
    let behind = 0.75 * PI;
    for (target, turning, expected) in [
        (3.0, 0.0, behind),
        (-3.0, 0.0, -behind),
        (3.0, -1.0, -behind),
        (-3.0, 1.0, behind),
        (2.0, -1.0, 2.0),
    ] {
        let mut state = body(0.0, 0.0, 0.0);
        state.bodies[0].angular_velocity.z = turning;
        let steering = Some(Steering { lead: 0.0, ..Steering::default() });
        let found = asked(&mut controller(steering), &state, target, 1);
        assert!((found - expected).abs() < 1e-3, "{found} for {target}, turning at {turning}");
        let plain = asked(&mut controller(None), &state, target, 1);
        assert!((plain - target).abs() < 1e-3, "{plain}");
    }
}

#[test]
fn a_hip_that_swings_does_not_change_the_side_of_a_turn() {
    let mut controller = controller(Some(Steering::default()));
    let mut state = body(0.0, 0.0, 1.2);
    for (tick, target) in [3.1, -3.1, 3.0, -2.9, 2.6].into_iter().enumerate() {
        state.bodies[0].angular_velocity.z = if tick % 2 == 0 { -1.0 } else { 1.0 };
        let found = asked(&mut controller, &state, target, 1);
        assert!((found + 0.75 * PI).abs() < 1e-3, "{found} in tick {tick}");
    }
    assert!(asked(&mut controller, &state, 1.0, 1) > 0.0, "no longer behind");
    assert!(asked(&mut controller, &state, 2.6, 1) > 0.0, "and then to the nearer side");
}

#[test]
fn the_trim_is_limited_and_forgotten_without_a_target() {
    let limits = Steering { lead: 0.0, trim_per_second: 5.0, trim_limit_radians: 0.2, ..Steering::default() };
    let mut controller = controller(Some(limits));
    let aside = body(0.0, 0.4, 1.2);
    assert!((asked(&mut controller, &aside, 0.0, 90) + 0.2).abs() < 1e-3);
    controller.tick(&aside, &Command::default(), DT);
    assert_eq!(controller.report().target, [0.0; 2]);
    assert!(asked(&mut controller, &aside, 0.0, 1).abs() < 0.1);
}

#[test]
fn a_standing_body_has_no_course() {
    let mut controller = controller(Some(Steering::default()));
    let swaying = body(0.0, 1.5, 0.05);
    assert!(asked(&mut controller, &swaying, 0.0, 60).abs() < 1e-3);
}

#[test]
fn numbers_that_are_not_finite_leave_the_state_sound() {
    for bad in [f32::NAN, f32::INFINITY] {
        let steering = Steering { trim_per_second: bad, lead: bad, ..Steering::default() };
        let mut controller = controller(Some(steering));
        asked(&mut controller, &body(0.1, 0.3, 1.2), 0.0, 10);
        assert!(controller.joint_targets().iter().all(|t| t.is_finite()));
        let mut state = ControllerState::new(controller.pack());
        controller.save_into(&mut state);
        assert_eq!(controller.restore(&state), Ok(()), "{bad}");
    }
}

#[test]
fn bytes_hold_the_side_of_a_turn() {
    let behind = 0.75 * PI;
    // Far from the origin a target is known to some millimetres only; just ahead of the angle at which a target lies behind there is no side.
    for (far, target) in [(0.0, PI - 0.1), (0.0, 0.1 - PI), (3e5, PI - 0.1), (0.0, behind - 5e-4), (0.0, 0.3)]
    {
        let mut controller = controller(Some(Steering::default()));
        let mut state = body(0.0, 0.0, 0.0);
        state.bodies.iter_mut().for_each(|body| body.position.x += far);
        asked(&mut controller, &state, target, 2);
        let [saved, read] = common::saved_and_read(&controller);
        assert_eq!(read, saved, "{target} at {far}");
    }
}
