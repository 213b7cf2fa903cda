//! Whole control ticks: commands, skills, falls and bad states.

mod common;

use std::sync::Arc;

use common::{n, p, standing};
use policy_core::bindings::{Control, PathBinding};
use policy_core::glam::{Quat, Vec2, Vec3};
use policy_core::{
    Bindings, Blend, BlendMode, Button, Buttons, CharacterPack, Command, CommandMapper, Controller,
    ControllerConfig, GamepadState, Goal, GraphPosition, Heading, PathId, Refusal, SkillEnd, SkillId,
    StateFault,
};
use proptest::prelude::*;

const DT: f32 = 1.0 / 30.0;

fn controller(logit: f32, start: &str) -> Controller {
    let pack: CharacterPack = common::pack(logit);
    let start = pack.graph().node_named(start).unwrap();
    Controller::with_config(Arc::new(pack), ControllerConfig { start, ..ControllerConfig::default() })
}

fn along(path: usize, coordinate: f32) -> Goal {
    Goal::Path { path: PathId::new(path), coordinate }
}

fn skill(controller: &Controller, name: &str) -> SkillId {
    controller.pack().skill_named(name).unwrap()
}

#[test]
fn it_travels_to_the_goal_at_a_limited_rate() {
    let mut controller = controller(0.0, "idle");
    let command = Command { goal: along(0, 2.5), ..Command::default() };
    for tick in 1..=60 {
        controller.tick(&standing(), &command, DT);
        let coordinate =
            controller.pack().graph().paths()[0].coordinate(controller.report().position).unwrap();
        assert!((coordinate - (tick as f32 * DT / 0.5).min(2.5)).abs() < 1e-4, "{tick}: {coordinate}");
    }
    assert_eq!(controller.report().blend.terms().len(), 2);
}

#[test]
fn it_does_not_rest_on_a_transit_edge() {
    let mut manifest = common::manifest();
    manifest.edges[4].transit = true;
    let pack = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap();
    let [crouch, crawl] = ["crouch", "crawl"].map(|name| pack.graph().node_named(name).unwrap());
    let mut controller = Controller::new(Arc::new(pack));
    let mut after = |goal: Goal, ticks: u32| {
        for _ in 0..ticks {
            controller.tick(&standing(), &Command { goal, ..Command::default() }, DT);
        }
        controller.report().position.as_node()
    };
    assert_eq!(after(along(1, 2.4), 90), Some(crouch));
    assert_eq!(after(along(1, 2.8), 10), None, "it crosses the edge");
    assert_eq!(after(Goal::Stay, 30), Some(crawl), "and does not stay there");
}

#[test]
fn the_joint_targets_are_those_of_the_blended_policy() {
    let mut controller = controller(0.0, "walk");
    let command = Command { target: Some(Vec2::new(3.0, 0.0)), ..Command::default() };
    let targets = controller.tick(&standing(), &command, DT).clone();
    let mut action = [0.0; 28];
    let walk = &controller.pack().policies()[controller.pack().policy_named("walk").unwrap().index()];
    let mut scratch = policy_core::MlpScratch::for_mlp(walk);
    let input = controller.policy_input();
    assert_eq!(input[223..], [1.5, 0.0]);
    walk.evaluate_into(policy_core::Arithmetic::Reproducible, input, &mut scratch, &mut action);
    assert_eq!(*targets, action, "centres are zero and gains one");
    assert!(action.iter().any(|a| *a != 0.0));
}

#[test]
fn a_recognised_skill_returns_and_an_unrecognised_one_runs_to_its_limit() {
    for (logit, end, least) in [(4.0, SkillEnd::Recognised, 0.2), (-4.0, SkillEnd::TimeLimit, 3.0)] {
        let mut controller = controller(logit, "walk");
        let roll = skill(&controller, "roll");
        controller.tick(&standing(), &Command { skill: Some(roll), ..Command::default() }, DT);
        assert_eq!(controller.report().skill_started, Some(roll));
        assert_eq!(controller.report().blend, Blend::single(p(6)));
        let mut seconds = DT;
        while controller.report().skill_ended.is_none() {
            controller.tick(&standing(), &Command::default(), DT);
            seconds += DT;
            assert!(seconds < 4.0);
        }
        assert_eq!(controller.report().skill_ended, Some((roll, end)));
        assert!(seconds > least && (end == SkillEnd::TimeLimit || seconds < 1.0), "{seconds}");
        assert_eq!(controller.report().position, GraphPosition::node(n(1)));
    }
}

#[test]
fn a_skill_waits_until_the_graph_position_allows_it() {
    let mut controller = controller(0.0, "idle");
    let roll = skill(&controller, "roll");
    controller.tick(&standing(), &Command { skill: Some(roll), ..Command::default() }, DT);
    assert_eq!((controller.report().skill, controller.report().pending_skill), (None, Some(roll)));
    let ticks = (0..60).find(|_| {
        controller.tick(&standing(), &Command { goal: Goal::Node(n(0)), ..Command::default() }, DT);
        controller.report().skill.is_some()
    });
    assert!(ticks.is_some_and(|t| (4..=16).contains(&t)), "{ticks:?}");
}

#[test]
fn a_fall_starts_the_recovery_and_lying_on_repeats_it() {
    let mut controller = controller(-4.0, "walk");
    let get_up = skill(&controller, "get_up");
    let mut lying = standing();
    lying.bodies[0].position.z = 0.2;
    let mut started = Vec::new();
    for tick in 0..200 {
        controller.tick(&lying, &Command::default(), DT);
        if controller.report().skill_started == Some(get_up) {
            started.push(tick);
        }
    }
    assert_eq!(started.len(), 3, "{started:?}");
    assert!((8..=10).contains(&started[0]) && (88..=92).contains(&(started[1] - started[0])), "{started:?}");
    assert!(controller.is_down());
}

#[test]
fn a_skill_that_is_pending_in_a_fall_is_refused() {
    let mut controller = controller(-4.0, "idle");
    let roll = skill(&controller, "roll");
    let mut lying = standing();
    lying.bodies[0].position.z = 0.2;
    let request = Command { skill: Some(roll), ..Command::default() };
    let ends = |controller: &mut Controller| {
        (0..400).find_map(|_| {
            controller.tick(&lying, &Command::default(), DT);
            controller.report().skill_refused
        })
    };
    controller.tick(&lying, &request, DT);
    assert_eq!(controller.report().pending_skill, Some(roll));
    assert_eq!(ends(&mut controller), Some((roll, Refusal::Fell)));
    assert_eq!(controller.report().skill_started, controller.pack().recovery());
    // Asked for while the character lies, and its recovery has to begin anew.
    controller.tick(&lying, &request, DT);
    assert_eq!(ends(&mut controller), Some((roll, Refusal::Fell)));
    assert_eq!(controller.report().pending_skill, None);
}

#[test]
fn a_recovery_that_is_stuck_acts_as_the_lowest_gait_now_and_then() {
    // The state of `standing` is still.
    let mut manifest = common::manifest();
    manifest.skills.iter_mut().for_each(|skill| skill.end.limit_seconds = 8.0);
    let pack = CharacterPack::from_parts(manifest, common::tensors(-4.0)).unwrap();
    let crawl = pack.graph().node_named("crawl").unwrap();
    let mut controller = Controller::new(Arc::new(pack));
    let mut lying = standing();
    lying.bodies[0].position.z = 0.2;
    let (mut others, mut ticks) = (Vec::new(), 0.0);
    while controller.report().skill_ended.is_none() {
        controller.tick(&lying, &Command::default(), DT);
        let recovers = controller.report().skill.is_some();
        ticks += f32::from(u8::from(recovers));
        if recovers && controller.report().blend == GraphPosition::node(crawl).blend() {
            others.push(ticks * DT);
        }
    }
    assert!((2.4..2.7).contains(&others[0]), "{others:?}");
    assert!((115..=125).contains(&others.len()), "a second of every one and a half: {others:?}");
    assert!(others.iter().all(|secs| !(3.6..3.9).contains(secs)), "{others:?}");
}

#[test]
fn low_is_no_fall_where_the_policy_is_low_and_none_without_recovery() {
    let mut lying = standing();
    lying.bodies[0].position.z = 0.3;
    let mut crawling = controller(0.0, "crawl");
    for _ in 0..60 {
        crawling.tick(&lying, &Command::default(), DT);
    }
    assert!(!crawling.report().fallen && crawling.report().skill.is_none());
    let config = ControllerConfig { auto_recover: false, ..ControllerConfig::default() };
    let mut walking = Controller::with_config(Arc::new(common::pack(0.0)), config);
    for _ in 0..60 {
        walking.tick(&lying, &Command::default(), DT);
    }
    assert!(walking.report().fallen && walking.report().skill.is_none());
}

#[test]
fn leaving_a_crawl_requires_standing_first() {
    let at = |pelvis: f32| {
        let mut state = standing();
        state.bodies[0].position.z = pelvis;
        state
    };
    let crouching = Command { goal: Goal::Node(n(1)), ..Command::default() };
    let pack = common::pack(0.0);
    let start = pack.graph().node_named("crawl").unwrap();
    let config = ControllerConfig { assist_rise: false, start, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(Arc::new(pack), config);
    let ticks = |controller: &mut Controller, pelvis: f32, count: u32| {
        for _ in 0..count {
            controller.tick(&at(pelvis), &crouching, DT);
        }
        (controller.report().position.as_node(), controller.report().fallen, controller.report().skill)
    };
    // However long the way is, the position stays on the low edge.
    let crawl = controller.report().position.as_node();
    let (node, fallen, _) = ticks(&mut controller, 0.3, 60);
    assert!(node != Some(n(1)) && !fallen, "{:?}", controller.report().position);
    let held = controller.report().position;
    assert!(Some(held.from) == crawl || Some(held.to) == crawl, "{held:?}");
    // Once up it goes on; otherwise it is a fall.
    let mut risen = controller.clone();
    assert_eq!(ticks(&mut risen, 0.9, 120).0, Some(n(1)));
    assert!(ticks(&mut controller, 0.3, 90).2.is_some());
}

#[test]
fn standing_up_comes_before_a_transit_edge_out_of_a_crawl() {
    let mut manifest = common::manifest();
    manifest.edges[4].transit = true;
    manifest.policies.iter_mut().find(|p| p.name == "crawl").unwrap().fall_height = Some(0.1);
    let pack = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap();
    let crawl = pack.graph().node_named("crawl").unwrap();
    let config = ControllerConfig { start: crawl, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(Arc::new(pack), config);
    let walking = Command { goal: Goal::Node(n(1)), ..Command::default() };
    let mut low = standing();
    low.bodies[0].position.z = 0.3;
    for _ in 0..5 {
        assert_eq!(controller.report().position.as_node(), Some(crawl), "it has not set out");
        controller.tick(&low, &walking, DT);
    }
    assert!(controller.report().skill.is_some() && !controller.is_down());
    // Down into it there is nothing to wait for.
    let mut controller = Controller::new(Arc::clone(controller.pack()));
    for _ in 0..90 {
        controller.tick(&standing(), &Command { goal: Goal::Node(crawl), ..Command::default() }, DT);
    }
    assert_eq!(controller.report().position.as_node(), Some(crawl));
}

#[test]
fn the_recovery_skill_takes_over_when_standing_up_is_late() {
    let mut low = standing();
    low.bodies[0].position.z = 0.3;
    let crouching = Command { goal: Goal::Node(n(1)), ..Command::default() };
    for recover in [false, true] {
        let pack = common::pack(0.0);
        let (start, recovery) = (pack.graph().node_named("crawl").unwrap(), pack.recovery());
        let config = ControllerConfig { auto_recover: recover, start, ..ControllerConfig::default() };
        let mut controller = Controller::with_config(Arc::new(pack), config);
        let mut held = 0;
        while controller.report().skill.is_none() {
            let before = controller.report().position;
            controller.tick(&low, &crouching, DT);
            assert!(!controller.report().fallen);
            held = if controller.report().position == before { held + 1 } else { 0 };
            assert!(held < 60, "{:?}", controller.report());
        }
        assert!((3..=4).contains(&held), "{held} ticks are 0.1 s");
        assert_eq!(controller.report().skill_started, recovery);
        assert!(!controller.is_down(), "standing up out of a crawl is no fall");
    }
}

#[test]
fn a_skill_that_is_asked_for_in_a_crawl_waits_until_the_character_has_risen() {
    let mut low = standing();
    low.bodies[0].position.z = 0.3;
    let pack = common::pack(0.0);
    let (start, recovery) = (pack.graph().node_named("crawl").unwrap(), pack.recovery());
    let roll = pack.skill_named("roll");
    let config = ControllerConfig { start, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(Arc::new(pack), config);
    let mut asked = Command { skill: roll, ..Command::default() };
    for _ in 0..90 {
        controller.tick(&low, &asked, DT);
        asked.skill = None;
        if controller.report().skill.is_some() {
            break;
        }
    }
    assert_eq!(controller.report().skill_started, recovery);
    assert_eq!(controller.report().pending_skill, roll, "it rises for the roll");
}

#[test]
fn a_state_that_is_not_finite_gives_a_safe_action_and_a_flag() {
    let mut controller = controller(0.0, "walk");
    controller.tick(&standing(), &Command::default(), DT);
    let mut bad = standing();
    bad.joint_velocities[4] = f32::INFINITY;
    assert_eq!(controller.tick(&bad, &Command::default(), DT)[..], [0.0; 28]);
    assert_eq!(controller.report().fault, Some(StateFault::NonFinite));
    controller.tick(&standing(), &Command::default(), DT);
    assert_eq!(controller.report().fault, None);
}

#[test]
fn manual_blends_replace_the_graph_and_bad_ones_do_not() {
    let mut controller = controller(0.0, "walk");
    let mut tick = |blend| {
        controller.tick(&standing(), &Command { blend: Some(blend), ..Command::default() }, DT);
        controller.report().blend
    };
    let manual = Blend::between_per_layer(p(0), p(3), [0.2, 0.5, 0.9, 0.0]);
    assert_eq!(tick(manual), manual);
    let walk = Blend::single(p(1));
    for bad in [Blend::single(p(99)), Blend::between(p(0), p(1), f32::NAN), Blend::default()] {
        assert_eq!(tick(bad), walk);
    }
}

#[test]
fn a_pad_becomes_a_command() {
    let pack = common::pack(0.0);
    let mut mapper = CommandMapper::new(&pack, &Bindings::default());
    let state = standing();
    let mut map = |pad: GamepadState, camera| mapper.map(&pad, camera, &state);
    let neutral = map(GamepadState::default(), Heading::FORWARD);
    assert_eq!((neutral.target, neutral.goal), (None, along(0, 0.0)));

    let pad = GamepadState { left_stick: [0.0, 1.0], right_trigger: 0.5, ..GamepadState::default() };
    let command = map(pad, Heading::from_angle(std::f32::consts::FRAC_PI_2));
    assert!((command.target.unwrap() - Vec2::new(0.0, 5.0)).length() < 1e-5, "up is where the camera looks");
    assert_eq!(command.goal, along(0, 2.0));

    let right = map(GamepadState { left_stick: [0.5, 0.0], ..pad }, Heading::FORWARD).target.unwrap();
    assert!((right - Vec2::new(0.0, -2.5)).length() < 1e-5, "right of x is minus y");

    let both = map(GamepadState { left_trigger: 0.75, ..pad }, Heading::FORWARD);
    assert_eq!(both.goal, along(1, 2.5));

    let held = Control::Button(Button::West);
    let style = PathBinding { path: "stance".into(), control: held, first: 1.0, needs_stick: true };
    let named = Bindings { paths: vec![style], ..Bindings::default() };
    let mut styled = CommandMapper::new(&pack, &named);
    let mut goal = |pad: GamepadState| styled.map(&pad, Heading::FORWARD, &state).goal;
    let west = GamepadState { buttons: Buttons::NONE.with(Button::West), ..pad };
    assert_eq!(goal(west), along(1, 3.0));
    assert_eq!(goal(GamepadState { left_stick: [0.0; 2], ..west }), along(0, 0.0));
    assert_eq!(goal(pad), along(0, 2.0));

    let roll = pack.skill_named("roll");
    let held = GamepadState { buttons: Buttons::NONE.with(Button::East), ..pad };
    assert_eq!([map(held, Heading::FORWARD).skill, map(held, Heading::FORWARD).skill], [roll, None]);
    let broken = GamepadState { left_stick: [f32::NAN, f32::INFINITY], ..GamepadState::default() };
    assert_eq!(map(broken, Heading::FORWARD).target, None);
}

fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![6 => -3.0f32..3.0, 1 => any::<f32>(), 1 => Just(f32::NAN), 1 => Just(f32::MAX)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_state_and_no_command_panics_or_gives_targets_that_are_not_finite(
        numbers in prop::collection::vec(any_number(), 32),
        goals in prop::collection::vec((0usize..4, 0usize..70, any_number(), 0usize..5), 6),
    ) {
        let mut controller = controller(0.5, "walk");
        for (kind, index, number, mode) in goals {
            let mut state = standing();
            let v = |i: usize| Vec3::new(numbers[i % 32], numbers[(i + 5) % 32], numbers[(i + 11) % 32]);
            state.bodies[index % 15].position = v(index);
            state.bodies[(index + 3) % 15].linear_velocity = v(index + 1);
            state.bodies[0].rotation = Quat::from_xyzw(numbers[2], numbers[3], numbers[4], numbers[5]);
            state.ground_height = numbers[index % 32];
            let goal = match kind {
                0 => Goal::Stay,
                1 => Goal::Node(n(index)),
                _ => along(index % 3, number),
            };
            let command = Command {
                target: Some(Vec2::new(number, numbers[index % 32])),
                facing: (mode % 2 == 1).then(|| Vec2::new(numbers[(index + 1) % 32], number)),
                goal,
                skill: Some(SkillId::new(index % 4)),
                blend: (kind == 3).then(|| Blend::between(p(index % 9), p(1), number)),
            };
            controller.set_blend_mode(BlendMode::ALL[mode % 3]);
            let targets = controller.tick(&state, &command, number);
            prop_assert!(targets.iter().all(|t| t.is_finite()), "{:?}", controller.report());
        }
    }
}
