//! Facing one way and moving another.

mod common;

use std::sync::Arc;

use common::standing;
use policy_core::bindings::{Control, PathBinding};
use policy_core::glam::{Quat, Vec2};
use policy_core::training::strafing_share;
use policy_core::{
    Bindings, Blend, Button, CharacterPack, CharacterState, Command, CommandMapper, Controller,
    ControllerConfig, GamepadState, Goal, Heading, PathId, PolicyId, TurnAssist, observe_into, target_input,
};

const DT: f32 = 1.0 / 30.0;

/// The made-up pack, whose crouch strafes; it lies at 2 of the second path.
fn pack() -> Arc<CharacterPack> {
    let mut manifest = common::manifest();
    manifest.policies[4].strafes = true;
    Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap())
}

fn at(node: &str) -> Controller {
    let pack = pack();
    let start = pack.graph().node_named(node).unwrap();
    Controller::with_config(pack, ControllerConfig { start, ..ControllerConfig::default() })
}

/// Standing, turned by an angle.
fn turned(radians: f32) -> CharacterState {
    let mut state = standing();
    for body in &mut state.bodies {
        let turn = Quat::from_rotation_z(radians);
        (body.position, body.rotation) = (turn * body.position, turn * body.rotation);
    }
    state
}

/// The normalised observation of a controller at a node that is to face along x, and of one that is not.
fn seen(node: &str, facing: Option<Vec2>) -> Vec<f32> {
    let (mut controller, state) = (at(node), turned(0.3));
    let asked = Command { target: Some(Vec2::new(0.0, 3.0)), facing, ..Command::default() };
    controller.tick(&state, &asked, DT);
    controller.policy_input().to_vec()
}

#[test]
fn a_policy_that_strafes_sees_what_is_left_to_turn_and_its_own_target() {
    let (pack, state) = (pack(), turned(0.3));
    let mut expected = vec![0.0; 223];
    observe_into(pack.skeleton(), &state, &mut expected);
    // The root's x axis, whose y is the sine of the angle to the way to face, to the left.
    let (sin, cos) = (-0.3_f32).sin_cos();
    (expected[43], expected[44]) = (cos, -sin);
    pack.tensors().observation_normaliser.normalise_in_place(&mut expected);
    expected.extend(target_input(&state, Vec2::new(0.0, 3.0)));
    for (is, expected) in seen("crouch", Some(Vec2::X * 4.0)).iter().zip(&expected) {
        assert!((is - expected).abs() < 1e-5, "{is} instead of {expected}");
    }
}

#[test]
fn a_way_to_face_changes_one_axis_for_a_policy_that_strafes_and_nothing_for_others() {
    assert_eq!(seen("walk", Some(Vec2::X)), seen("walk", None));
    // No direction at all: nothing is left to turn.
    let (own, faces) = (seen("crouch", Some(Vec2::ZERO)), seen("crouch", Some(Vec2::X)));
    let differ = own.iter().zip(&faces).enumerate().filter(|(_, (a, b))| a != b);
    assert_eq!(differ.map(|(index, _)| index).collect::<Vec<_>>(), [43, 44]);
}

#[test]
fn without_a_way_to_face_it_faces_where_it_goes() {
    assert_eq!(seen("crouch", None), seen("crouch", Some(Vec2::Y)));
}

#[test]
fn the_share_is_that_of_the_blend_weights() {
    let pack = pack();
    let share = |blend: &Blend| strafing_share(pack.graph(), blend);
    let [walk, crouch] = [PolicyId::new(1), PolicyId::new(4)];
    assert_eq!(share(&Blend::single(walk)), 0.0);
    assert_eq!(share(&Blend::single(crouch)), 1.0);
    assert!((share(&Blend::between(walk, crouch, 0.25)) - 0.25).abs() < 1e-6);
    assert_eq!(share(&Blend::between(walk, crouch, f32::NAN)), 0.0);
    assert_eq!(share(&Blend::single(PolicyId::new(63))), 0.0);
}

#[test]
fn turn_assist_leaves_a_policy_that_strafes_alone() {
    let (pack, state) = (pack(), standing());
    let goal = Goal::Path { path: PathId::new(1), coordinate: 2.0 };
    let asked = Command { target: Some(Vec2::new(-5.0, 0.0)), goal, ..Command::default() };
    assert_eq!(TurnAssist::default().adjusted(pack.graph(), &state, &asked), asked);
}

#[test]
fn its_button_makes_the_character_face_where_the_camera_looks() {
    let pack = pack();
    let binding = |path: &str, button| PathBinding {
        path: path.into(),
        control: Control::Button(button),
        first: 2.0,
        needs_stick: false,
    };
    // The second path ends with a crawl, which does not strafe; of the first one nothing does.
    let mut manifest = common::manifest();
    manifest.policies[4].strafes = true;
    manifest.paths[1].nodes.truncate(3);
    let short = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap();
    let paths = vec![binding("stance", Button::RightStick), binding("speed", Button::North)];
    let bindings = Bindings { paths, ..Bindings::default() };
    let camera = Heading::from_angle(1.0);
    let facing = |pack: &CharacterPack, button: Option<Button>| {
        let mut pad = GamepadState { left_stick: [1.0, 0.0], ..GamepadState::default() };
        button.into_iter().for_each(|button| pad.buttons.set(button, true));
        CommandMapper::new(pack, &bindings).map(&pad, camera, &standing()).facing
    };
    assert_eq!(facing(&short, Some(Button::RightStick)), Some(camera.direction()));
    assert_eq!(facing(&short, Some(Button::North)), None);
    assert_eq!(facing(&short, None), None);
    assert_eq!(facing(&pack, Some(Button::RightStick)), None);
}

/// Where a controller that strafes is on the graph after it is asked to walk for a tick, and the sine of what its policy has left to turn.
fn asked_to_walk(velocity: Vec2, target: Option<Vec2>) -> (f32, f32) {
    let mut controller = at("crouch");
    let walk = controller.pack().graph().node_named("walk").unwrap();
    let mut state = standing();
    state.bodies.iter_mut().for_each(|body| body.linear_velocity = velocity.extend(0.0));
    let asked = Command { target, goal: Goal::Node(walk), ..Command::default() };
    controller.tick(&state, &asked, DT);
    let left = controller.policy_input()[44] - {
        let mut ahead = at("crouch");
        ahead.tick(&state, &Command { facing: Some(Vec2::X), ..Command::default() }, DT);
        ahead.policy_input()[44]
    };
    (strafing_share(controller.pack().graph(), &controller.report().position.blend()), left)
}

#[test]
fn it_turns_to_its_target_and_goes_there_before_it_leaves_for_a_walk() {
    let (behind, ahead) = (Some(Vec2::new(-5.0, 1.0)), Some(Vec2::new(5.0, 0.5)));
    let (weight, left) = asked_to_walk(Vec2::X * -0.5, behind);
    assert_eq!(weight, 1.0, "it stays");
    assert!(left.abs() > 0.1, "and turns, {left}");
    assert_eq!(asked_to_walk(Vec2::X * -0.5, ahead).0, 1.0, "it still goes backwards");
    assert!(asked_to_walk(Vec2::X * 0.5, ahead).0 < 1.0);
    assert_eq!(asked_to_walk(Vec2::X * -0.5, None), (1.0, 0.0), "it comes to rest first");
    assert!(asked_to_walk(Vec2::ZERO, None).0 < 1.0);
}

#[test]
fn it_is_trimmed_to_the_way_it_is_told_to_go_and_a_new_way_begins_anew() {
    let mut controller = at("crouch");
    let mut state = standing();
    // Told to go to the left, it goes to the left and a little ahead; it faces ahead all along.
    state.bodies.iter_mut().for_each(|body| body.linear_velocity = Vec2::new(0.1, 0.4).extend(0.0));
    let mut shown = |target: Vec2, ticks: usize| {
        let asked = Command { target: Some(target), facing: Some(Vec2::X), ..Command::default() };
        (0..ticks).for_each(|_| {
            controller.tick(&state, &asked, DT);
        });
        let [x, y] = controller.report().target;
        y.atan2(x)
    };
    let left = Vec2::new(0.0, 5.0);
    let quarter = std::f32::consts::FRAC_PI_2;
    assert!((shown(left, 1) - quarter).abs() < 0.05);
    let trimmed = shown(left, 60);
    assert!(trimmed > quarter + 0.2, "asked to go back a little, {trimmed}");
    assert!((shown(Vec2::new(0.0, -5.0), 1) + quarter).abs() < 0.05);
}
