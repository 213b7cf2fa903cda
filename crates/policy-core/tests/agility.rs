//! Agility: gaits are blended with their agile variants while the character does not move as it is asked to, and act alone once it does.

mod common;

use std::sync::Arc;

use common::{acted, hand_over, policy, standing, weight};
use glam::{Quat, Vec2, Vec3};
use policy_core::format::Manifest;
use policy_core::{
    BodyId, CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, GraphPosition,
    NodeId, PathId, Skeleton,
};

const DT: f32 = 1.0 / 30.0;

/// The made-up pack. Its walk goes at 1 m/s and has the roll's policy as its agile variant, and on request the standing one as its
/// variant for rough ground.
fn pack(rough: bool) -> Arc<CharacterPack> {
    changed_pack(rough, |_| {})
}

fn changed_pack(rough: bool, change: impl FnOnce(&mut Manifest)) -> Arc<CharacterPack> {
    let mut manifest = common::manifest();
    manifest.policies[0].speed_mps = Some(0.0);
    manifest.policies[1].speed_mps = Some(1.0);
    manifest.policies[1].agile = Some("roll".into());
    manifest.policies[1].rough_ground = rough.then(|| "idle".into());
    change(&mut manifest);
    Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap())
}

fn controller(agility: bool) -> Controller {
    let config = ControllerConfig { agility, steering: None, give_way: None, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack(false), config);
    for _ in 0..90 {
        tick(&mut controller, &walking(1.0));
    }
    controller
}

/// Faces along x and moves that way.
fn walking(speed: f32) -> CharacterState {
    let mut state = standing();
    for index in 0..Skeleton::humanoid().body_count() {
        state.body_mut(BodyId::new(index)).linear_velocity = Vec3::X * speed;
    }
    state
}

fn towards(target: Vec2) -> Command {
    let goal = Goal::Path { path: PathId::new(0), coordinate: 1.0 };
    Command { goal, target: Some(target), ..Command::default() }
}

/// One tick at a walk towards a target far ahead. Returns the policies and their weights in the first layer.
fn tick(controller: &mut Controller, state: &CharacterState) -> Vec<(usize, f32)> {
    tick_towards(controller, state, Vec2::X)
}

fn tick_towards(controller: &mut Controller, state: &CharacterState, direction: Vec2) -> Vec<(usize, f32)> {
    let target = state.root().position.truncate() + 10.0 * direction;
    controller.tick(state, &towards(target), DT);
    acted(controller)
}

#[test]
fn a_gait_acts_alone_while_it_goes_as_asked_and_as_its_variant_in_a_turn() {
    let mut controller = controller(true);
    assert_eq!(tick(&mut controller, &walking(1.0)), [(1, 1.0)]);
    assert_eq!(tick(&mut controller, &walking(0.75)), [(1, 1.0)], "a speed that sways is no error");
    let roll = policy("roll");
    let shares: Vec<f32> =
        (0..4).map(|_| weight(&tick_towards(&mut controller, &walking(1.0), -Vec2::X), roll)).collect();
    assert!((shares[0] - 1.0 / 3.0).abs() < 1e-5, "a tenth of a second to cross: {shares:?}");
    assert_eq!(shares[3], 1.0);
    let back = tick(&mut controller, &walking(1.0));
    assert!((weight(&back, 1) - DT / 0.3).abs() < 1e-5, "0.3 s back: {back:?}");
    for _ in 0..9 {
        tick(&mut controller, &walking(1.0));
    }
    assert_eq!(tick(&mut controller, &walking(1.0)), [(1, 1.0)]);
}

#[test]
fn a_stand_that_is_to_walk_and_a_heading_that_is_off_bring_it_in_too() {
    let roll = policy("roll");
    let mut starting = controller(true);
    let mut turned = controller(true);
    let mut aside = walking(0.0);
    for index in 0..Skeleton::humanoid().body_count() {
        let body = aside.body_mut(BodyId::new(index));
        body.linear_velocity = Vec3::X;
        body.rotation = Quat::from_rotation_z(1.2) * body.rotation;
    }
    for _ in 0..4 {
        tick(&mut starting, &walking(0.0));
        tick(&mut turned, &aside);
    }
    assert_eq!(weight(&tick(&mut starting, &walking(0.0)), roll), 1.0);
    assert_eq!(weight(&tick(&mut turned, &aside), roll), 1.0);
}

#[test]
fn the_variant_of_a_stand_brakes_and_catches_a_push() {
    let roll = policy("roll");
    let mut stands =
        Controller::new(changed_pack(false, |manifest| manifest.policies[0].agile = Some("roll".into())));
    let mut rest = |speed: f32| {
        stands.tick(&walking(speed), &Command::default(), DT);
        weight(&acted(&stands), roll)
    };
    assert_eq!(rest(0.1), 0.0, "a stand that sways");
    for _ in 0..4 {
        rest(0.6);
    }
    assert_eq!(rest(0.6), 1.0);
}

#[test]
fn a_gait_that_it_is_to_stay_in_comes_to_rest_by_its_variant() {
    let roll = policy("roll");
    let share = |coordinate: f32| {
        let mut controller = controller(true);
        let goal = Goal::Path { path: PathId::new(0), coordinate };
        for _ in 0..4 {
            controller.tick(&walking(0.6), &Command { goal, ..Command::default() }, DT);
        }
        weight(&acted(&controller), roll)
    };
    assert_eq!(share(1.0), 1.0);
    assert_eq!(share(0.0), 0.0, "on the way to standing the stand brakes");
}

#[test]
fn a_gait_that_it_is_to_stay_in_rests_by_its_resting_variant_for_as_long_as_it_has_no_target() {
    let (roll, idle) = (policy("roll"), policy("idle"));
    // Only so that the walk's two variants differ, its agile one is the policy that stands.
    let pack = changed_pack(false, |manifest| {
        manifest.policies[1].agile = Some("idle".into());
        manifest.policies[1].resting = Some("roll".into());
    });
    let config = ControllerConfig { steering: None, give_way: None, ..ControllerConfig::default() };
    let mut controller = Controller::with_config(pack, config);
    for _ in 0..90 {
        tick(&mut controller, &walking(1.0));
    }
    let goal = Goal::Path { path: PathId::new(0), coordinate: 1.0 };
    let mut rest = |speed: f32| {
        controller.tick(&walking(speed), &Command { goal, ..Command::default() }, DT);
        acted(&controller)
    };
    let shares: Vec<f32> = (0..3).map(|_| weight(&rest(0.6), roll)).collect();
    assert!((shares[0] - 1.0 / 3.0).abs() < 1e-5, "a tenth of a second to cross: {shares:?}");
    for _ in 0..90 {
        assert_eq!(rest(0.0), [(roll, 1.0)], "also once it is still");
    }
    let back = (0..3).map(|_| tick(&mut controller, &walking(0.0))).last().unwrap();
    assert_eq!(weight(&back, roll), 0.0, "it is to go on: {back:?}");
    assert_eq!(weight(&back, idle), 1.0, "and starts by its agile variant");
}

#[test]
fn a_stand_that_has_come_to_rest_is_left_to_its_steady_variant_until_anything_is_asked() {
    let roll = policy("roll");
    let mut stands = Controller::new(changed_pack(false, |manifest| {
        manifest.policies[0].steady = Some("roll".into());
        manifest.policies[1].agile = None;
    }));
    let mut rest = |state: &CharacterState, command: &Command, ticks: usize| {
        (0..ticks).for_each(|_| {
            stands.tick(state, command, DT);
        });
        weight(&acted(&stands), roll)
    };
    let goal = Goal::Path { path: PathId::new(0), coordinate: 0.0 };
    let (still, nothing) = (walking(0.0), Command { goal, ..Command::default() });
    assert_eq!(rest(&still, &nothing, 16), 0.0, "half a second to brake");
    let share = rest(&still, &nothing, 16);
    assert!((0.4..0.6).contains(&share), "a second to cross: {share}");
    assert_eq!(rest(&still, &nothing, 17), 1.0);
    assert!(rest(&walking(0.6), &nothing, 2) < 0.4, "a push");
    assert_eq!(rest(&walking(0.6), &nothing, 1), 0.0);
    assert_eq!(rest(&still, &nothing, 50), 1.0);
    let mut on_a_slope = walking(0.0);
    on_a_slope.ground_rises[Skeleton::humanoid().feet()[0].index()] = 0.008;
    assert_eq!(rest(&on_a_slope, &nothing, 3), 0.0, "the ground is not level");
    assert_eq!(rest(&still, &nothing, 50), 1.0);
    assert_eq!(rest(&still, &towards(10.0 * Vec2::X), 3), 0.0, "it is to walk");
}

#[test]
fn a_gait_that_goes_as_asked_for_a_while_is_left_to_its_steady_variant_until_it_is_to_turn() {
    let roll = policy("roll");
    let mut walks = Controller::new(changed_pack(false, |manifest| {
        manifest.policies[1].agile = None;
        manifest.policies[1].steady = Some("roll".into());
    }));
    let last = (0..90).map(|_| weight(&tick(&mut walks, &walking(1.0)), roll)).last();
    assert_eq!(last, Some(1.0));
    let turns: Vec<f32> =
        (0..4).map(|_| weight(&tick_towards(&mut walks, &walking(1.0), -Vec2::X), roll)).collect();
    assert!(turns[0] < 0.7 && turns[2] == 0.0, "a tenth of a second: {turns:?}");
    assert_eq!(weight(&tick(&mut walks, &walking(1.0)), roll), 0.0, "not again at once");
}

#[test]
fn a_gait_that_turns_on_the_spot_is_left_to_its_steady_variant_however_it_sways_until_it_turns() {
    let roll = policy("roll");
    let last_share = |mps: f32| {
        let mut controller = Controller::new(changed_pack(false, |manifest| {
            manifest.policies[1].speed_mps = Some(mps);
            manifest.policies[1].agile = None;
            manifest.policies[1].steady = Some("roll".into());
            manifest.policies[1].turning = Some("idle".into());
        }));
        // Faces aside and moves backwards by turns, a second each.
        let mut sways = |ticks: usize, direction: Vec2| {
            let states = [0.3, -0.6].map(|angle: f32| {
                let mut state = walking(mps * angle.signum());
                state.body_mut(BodyId::new(0)).rotation = Quat::from_rotation_z(angle);
                state
            });
            (0..ticks).fold(f32::NAN, |_, index| {
                let acted = tick_towards(&mut controller, &states[index / 30 % 2], direction);
                weight(&acted, roll)
            })
        };
        [sways(120, Vec2::X), sways(4, Vec2::Y)]
    };
    assert_eq!(last_share(0.3), [1.0, 0.0], "until the target lies aside");
    assert_eq!(last_share(1.0), [0.0, 0.0], "one that is faster is not as it was asked to be");
}

#[test]
fn a_place_between_two_gaits_becomes_steady_from_either_side_unless_it_mostly_stands_or_leads_down() {
    let roll = policy("roll");
    let places = [(0.6, 0.5, 0.6), (0.5, 0.5, 0.5), (0.4, 0.5, 0.0), (0.6, 0.4, 0.0), (1.0, 0.4, 1.0)];
    let from_both_sides = places.iter().flat_map(|place| [(0.0, place), (1.0, place)]);
    for (before, &(coordinate, fall_height, wanted)) in from_both_sides {
        let mut controller = Controller::new(changed_pack(false, |manifest| {
            manifest.policies[0].fall_height = Some(0.5);
            manifest.policies[1].fall_height = Some(fall_height);
            manifest.policies[1].agile = None;
            manifest.policies[1].steady = Some("roll".into());
        }));
        let goal = |coordinate| Goal::Path { path: PathId::new(0), coordinate };
        let mut share = 0.0;
        for tick in 0..180 {
            let goal = goal(if tick < 60 { before } else { coordinate });
            let state = walking(coordinate);
            let target = state.root().position.truncate() + 10.0 * Vec2::X;
            controller.tick(&state, &Command { goal, target: Some(target), ..Command::default() }, DT);
            share = weight(&acted(&controller), roll);
        }
        assert!(
            (share - wanted).abs() < 1e-5,
            "from {before} to {coordinate}, walk at {fall_height} m: expected {wanted}, found {share}"
        );
    }
}

#[test]
fn on_an_edge_that_is_only_crossed_gaits_act_alone_up_and_down() {
    let agile_share_half_way = |transit: bool, lower: usize| {
        let pack = changed_pack(false, |manifest| {
            manifest.edges[0].transit = transit;
            manifest.policies[lower].fall_height = Some(0.2);
        });
        let config = ControllerConfig {
            steering: None,
            give_way: None,
            turn_assist: None,
            ..ControllerConfig::default()
        };
        let mut controller = Controller::with_config(pack, config);
        let mut shares = Vec::new();
        for _ in 0..90 {
            let acted = tick_towards(&mut controller, &standing(), Vec2::NEG_X);
            if controller.report().position.as_node().is_none() {
                shares.push(weight(&acted, policy("roll")));
            }
        }
        assert!(!shares.is_empty());
        shares.into_iter().fold(0.0, f32::max)
    };
    for lower in [0, 1] {
        assert!(agile_share_half_way(false, lower) > 0.1);
        assert_eq!(agile_share_half_way(true, lower), 0.0);
    }
}

#[test]
fn a_speed_beyond_its_pace_is_a_push_of_a_character_that_had_its_pace() {
    let roll = policy("roll");
    let faster = |controller: &mut Controller| weight(&tick(controller, &walking(1.8)), roll);
    let mut pushed = controller(true);
    assert!(faster(&mut pushed) > 0.0);
    for _ in 0..8 {
        faster(&mut pushed);
    }
    assert_eq!(faster(&mut pushed), 1.0, "for as long as it lasts");
    // One that comes from a faster gait slows down by itself.
    let mut slows_down = controller(true);
    assert!(slows_down.place_at(GraphPosition { from: NodeId::new(1), to: NodeId::new(2), t: 0.9 }));
    let mut shares = (0..40).map(|_| faster(&mut slows_down));
    assert!(shares.all(|share| share == 0.0));
    for _ in 0..9 {
        assert_eq!(weight(&tick(&mut slows_down, &walking(1.0)), roll), 0.0);
    }
    assert!(faster(&mut slows_down) > 0.0, "0.3 s at its pace");
}

#[test]
fn without_agility_or_a_variant_nothing_changes() {
    let mut off = controller(false);
    let mut without = Controller::new(Arc::new(common::pack(0.0)));
    for _ in 0..90 {
        tick(&mut without, &walking(1.0));
    }
    for _ in 0..10 {
        assert_eq!(tick_towards(&mut off, &walking(1.0), -Vec2::X), [(1, 1.0)]);
        assert_eq!(tick_towards(&mut without, &walking(1.0), -Vec2::X), [(1, 1.0)]);
    }
}

#[test]
fn rough_ground_comes_before_agility_and_shares_add_up_to_one() {
    let mut controller = Controller::with_config(pack(true), ControllerConfig::default());
    for _ in 0..90 {
        tick(&mut controller, &walking(1.0));
    }
    let mut state = walking(1.0);
    state.ground_rises[Skeleton::humanoid().feet()[0].index()] = 0.1;
    let (roll, rough) = (policy("roll"), policy("idle"));
    let first = tick_towards(&mut controller, &state, -Vec2::X);
    let third = 1.0 / 3.0;
    assert!((weight(&first, rough) - third).abs() < 1e-5, "{first:?}");
    assert!((weight(&first, roll) - (1.0 - third) * third).abs() < 1e-5, "{first:?}");
    assert!((first.iter().map(|term| term.1).sum::<f32>() - 1.0).abs() < 1e-6);
    for _ in 0..3 {
        tick_towards(&mut controller, &state, -Vec2::X);
    }
    assert_eq!(tick_towards(&mut controller, &state, -Vec2::X), [(rough, 1.0)]);
}

#[test]
fn a_state_saved_in_a_turn_goes_on_with_the_same_blend() {
    let mut run = controller(true);
    tick_towards(&mut run, &walking(1.0), -Vec2::X);
    let mut other = controller(true);
    hand_over(&run, &mut other);
    assert!(run.report().blend.terms().len() > 1, "half-way");
    for _ in 0..20 {
        assert_eq!(tick(&mut other, &walking(1.0)), tick(&mut run, &walking(1.0)));
    }
}

#[test]
fn an_unknown_variant_is_refused_by_name() {
    let mut manifest = common::manifest();
    manifest.policies[1].agile = Some("dancer".into());
    let refused = |manifest| {
        let error = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap_err().to_string();
        assert!(error.contains("dancer") && error.contains("policy"), "{error}");
    };
    refused(manifest);
    let mut manifest = common::manifest();
    manifest.policies[0].steady = Some("dancer".into());
    refused(manifest);
}

#[test]
fn while_it_settles_after_a_skill_the_variant_may_act() {
    let mut controller = controller(true);
    let roll = controller.pack().skill_named("roll");
    let ahead = Command { skill: roll, ..towards(10.0 * Vec2::X) };
    controller.tick(&walking(1.0), &ahead, DT);
    assert_eq!(controller.report().skill.map(|progress| progress.skill), roll);
    while controller.report().skill_ended.is_none() {
        tick_towards(&mut controller, &walking(1.0), Vec2::X);
    }
    // It moves as it is asked to: the gait acts alone. Then something stops it.
    for tick in 0..4 {
        assert_eq!(tick_towards(&mut controller, &walking(1.0), Vec2::X), [(1, 1.0)], "tick {tick}");
    }
    let stopped = (0..4).map(|_| tick_towards(&mut controller, &walking(0.0), Vec2::X)).last().unwrap();
    assert_eq!(weight(&stopped, policy("roll")), 1.0, "{stopped:?}");
}
