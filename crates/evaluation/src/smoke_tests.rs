//! Every section of what a player feels, on a pack of policies that do nothing: the character keels over and stays there.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec2;
use physics::{Engine, Model};
use policy_core::format::{
    DISCRIMINATOR_LAYOUT, EdgeEntry, EndEntry, Manifest, OBSERVATION_LAYOUT, PACK_FORMAT, PACK_VERSION,
    PathEntry, PolicyEntry, SkeletonEntry, SkillEntry,
};
use policy_core::training::{Layer, Normaliser, PackTensors};
use policy_core::{CharacterPack, ControllerConfig, Mlp, Skeleton};
use random::Rng;

use super::stress::{Cases, Grounds};
use super::trial::{Gait, Gaits, Trial};
use super::{Effort, EvalCharacter, Evaluation, PlayerReport, Progress, Section, evaluate, table};

const HUMANOID: &str = include_str!("../../../assets/humanoid.xml");

const NODES: [&str; 5] = ["idle", "walk", "run", "crawl", "roll"];

const TINY: Effort = Effort {
    settled: 1,
    straight: 1,
    pressed: 1,
    pad_players: 1,
    drops_uneven: 1,
    pad_secs: 1.0,
    roamers: 1,
    roam_secs: 1.0,
    push_step_newton: 500.0,
    ..Effort::QUICK
};

const PLAYER: [Section; 13] = [
    Section::Turns,
    Section::Starts,
    Section::Stops,
    Section::Straight,
    Section::Rise,
    Section::Buttons,
    Section::Jumps,
    Section::Legs,
    Section::RandomPad,
    Section::Terrain,
    Section::GetUp,
    Section::Robustness,
    Section::Pushes,
];

/// A pack in which lying on the ground is no fall when `falls` is false.
fn pack(falls: bool) -> Arc<CharacterPack> {
    let skeleton = Skeleton::humanoid();
    let (inputs, joints) = (skeleton.policy_input_len(), skeleton.joint_count());
    let policy = |name: &str| PolicyEntry {
        name: name.into(),
        layers: vec![inputs, 4, joints],
        fall_height: falls.then_some(0.5),
        speed_mps: Some(if name == "idle" { 0.0 } else { 1.0 }),
        origin: "made up".into(),
        ..PolicyEntry::default()
    };
    let edge = |a: &str, b: &str| EdgeEntry {
        nodes: [a.into(), b.into()],
        seconds: 0.1,
        seconds_back: None,
        transit: false,
    };
    let path =
        |name: &str, nodes: [&str; 3]| PathEntry { name: name.into(), nodes: nodes.map(Into::into).into() };
    let end = EndEntry {
        threshold: 0.5,
        hysteresis: 0.1,
        hold_seconds: 0.1,
        minimum_seconds: 0.0,
        limit_seconds: 0.5,
        minimum_height: 0.0,
    };
    let roll = SkillEntry {
        minimum_speed_mps: 0.0,
        maximum_speed_mps: None,
        on_footfall: false,
        in_stride: Vec::new(),
        clock_seconds: None,
        name: "roll".into(),
        policy: "roll".into(),
        entry: Vec::new(),
        returns_to: "walk".into(),
        discriminator: None,
        end,
    };
    let manifest = Manifest {
        format: PACK_FORMAT.into(),
        version: PACK_VERSION,
        character: "made up".into(),
        control_hz: 30.0,
        observation: OBSERVATION_LAYOUT.into(),
        discriminator: DISCRIMINATOR_LAYOUT.into(),
        checksum: None,
        skeleton: SkeletonEntry::from(&skeleton),
        actuation: None,
        credits: Vec::new(),
        mjcf: None,
        action_centre: vec![0.0; joints],
        action_gain: vec![1.0; joints],
        policies: NODES.map(policy).into(),
        edges: vec![edge("idle", "walk"), edge("walk", "run"), edge("walk", "crawl")],
        paths: vec![path("speed", ["idle", "walk", "run"]), path("stance", ["idle", "walk", "crawl"])],
        discriminators: Vec::new(),
        skills: vec![roll],
        recovery: falls.then(|| "roll".into()),
    };
    let layer = |inputs: usize, outputs: usize| {
        Layer::from_input_major(inputs, outputs, &vec![0.0; inputs * outputs], &vec![0.0; outputs]).unwrap()
    };
    let mlp = || Mlp::from_layers(vec![layer(inputs, 4), layer(4, joints)]).unwrap();
    let normaliser =
        |len: usize| Normaliser::from_mean_and_deviation(&vec![0.0; len], &vec![1.0; len]).unwrap();
    let tensors = PackTensors {
        policies: NODES.iter().map(|_| mlp()).collect(),
        discriminators: Vec::new(),
        observation_normaliser: normaliser(skeleton.observation_len()),
        discriminator_normaliser: normaliser(skeleton.frame_len()),
        mesh: None,
    };
    Arc::new(CharacterPack::from_parts(manifest, tensors).unwrap())
}

fn measured(engine: Engine, falls: bool, effort: &Effort, sections: &[Section]) -> Evaluation {
    let model = physics_bridge::Model::from_mjcf(HUMANOID).unwrap();
    let model = Model::new(&model, engine).unwrap();
    let mut so_far = Vec::new();
    let evaluation = evaluate(
        &model,
        &pack(falls),
        ControllerConfig::default(),
        (effort, sections),
        &BTreeMap::new(),
        &Progress::hidden(),
        |evaluation| so_far.push(evaluation.clone()),
    )
    .unwrap();
    assert_eq!(so_far.len(), sections.len(), "each section is told of");
    assert_eq!(so_far.last(), Some(&evaluation));
    evaluation
}

#[test]
fn some_gaits_are_measured_as_with_all_of_them_and_others_are_not() {
    let gaits = ["walk", "crawl", "strafe"].iter().filter_map(|name| Gaits::from_name(name));
    let effort = Effort { gaits: gaits.fold(Gaits::NONE, Gaits::and), ..TINY };
    let sections = [Section::Turns, Section::Stops, Section::Legs];
    let some = measured(Engine::Mujoco, false, &effort, &sections).player;
    let all = measured(Engine::Mujoco, false, &TINY, &sections).player;
    assert!(some.response.turns.keys().eq(["crawl", "walk"]), "{:?}", some.response.turns.keys());
    assert!(some.response.stop.keys().eq(["crawl", "walk"]), "{:?}", some.response.stop.keys());
    assert!(some.foot_slide_mps.keys().eq(["crawl", "walk"]), "{:?}", some.foot_slide_mps.keys());
    assert_eq!(some.response.turns["walk"], all.response.turns["walk"]);
    assert_eq!(some.response.stop["crawl"], all.response.stop["crawl"]);
}

#[test]
fn some_grounds_are_measured_as_with_all_of_them_and_others_are_not() {
    let effort = Effort { grounds: Grounds::from_name("steps_5cm").unwrap(), ..TINY };
    let sections = [Section::Terrain];
    let some = measured(Engine::Mujoco, false, &effort, &sections).player;
    let all = measured(Engine::Mujoco, false, &TINY, &sections).player;
    assert!(some.terrain.keys().eq(["steps_5cm"]), "{:?}", some.terrain.keys());
    assert_eq!(some.terrain["steps_5cm"], all.terrain["steps_5cm"]);
    assert_eq!(all.terrain.len(), 4);
}

#[test]
fn some_cases_are_measured_as_with_all_of_them_and_others_are_not() {
    let effort = TINY.only(&[], &[], &[Cases::from_name("strength_x0.8").unwrap()]);
    let some = measured(Engine::Mujoco, false, &effort, &[Section::Robustness]).player;
    let all = measured(Engine::Mujoco, false, &TINY, &[Section::Robustness]).player;
    assert!(some.robustness.keys().eq(["strength_x0.8"]), "{:?}", some.robustness.keys());
    assert_eq!(some.robustness["strength_x0.8"], all.robustness["strength_x0.8"]);
    assert_eq!(all.robustness.len(), 14);
}

#[test]
fn a_character_that_lies_on_the_ground_never_turns_and_has_all_keys() {
    let evaluation = measured(Engine::Mujoco, false, &TINY, &PLAYER);
    let json = serde_json::to_value(&evaluation).unwrap();
    let read: PlayerReport = serde_json::from_value(json.clone()).unwrap();
    assert_eq!(table(&read), table(&evaluation.player), "a file says what was measured");
    let gaits = ["idle", "half_stick", "walk", "run", "crawl"];
    for gait in gaits {
        let turn = &json["response"][gait]["turn_180"];
        assert_eq!((&turn["never"], &turn["median_s"]), (&2.into(), &serde_json::Value::Null), "{gait}");
        assert!(turn["trials"] == 2 && turn["falls"] == 0, "{gait}: {turn}");
        assert!(json["terrain"]["hills_35cm"][gait]["falls_per_minute"] == 0.0, "{gait}");
        assert!(json["robustness"]["latency_1_tick"][gait]["falls_per_minute"] == 0.0, "{gait}");
        assert!(json["push_torso"][gait]["left_newton"] == 1000.0, "{gait}");
        assert!(json["foot_slide_mps"][gait].is_number() && json["self_overlap"][gait].is_number(), "{gait}");
        assert_eq!(json["button_presses"][gait]["east"]["started"], 1, "{gait}");
    }
    let start = &json["response"]["start"];
    assert!(start["walk_s"].is_null() && start["run_s"].is_null(), "{start}");
    assert!(json["response"]["stop"]["run"]["s"].is_number(), "what lies still has stopped");
    assert_eq!(json["drift_degrees"]["speed"].as_array().unwrap().len(), 11);
    assert_eq!(json["random_pad"]["everything"]["falls_per_minute"], 0.0);
    assert_eq!(json["crawl_to_upright"]["by_itself"], 0);
    assert!(json["joint_target_jump"]["skill_start_rad"] == 0.0, "all policies want the same");
    assert!(json.get("paths").is_none() && json.get("upright").is_none(), "sections that were not asked for");
}

#[test]
fn a_character_that_falls_on_the_way_to_a_gait_is_left_out_and_falls_are_counted() {
    let effort = Effort { pad_secs: 5.0, roam_secs: 5.0, ..TINY };
    let sections = [
        Section::Turns,
        Section::Legs,
        Section::RandomPad,
        Section::Terrain,
        Section::GetUp,
        Section::Pushes,
    ];
    let report = measured(Engine::Mujoco, true, &effort, &sections).player;
    assert!(report.response.turns["walk"]["turn_90"].trials == 0, "{:?}", report.response.turns);
    assert!(report.random_pad["stick"].falls_per_minute > 0.0, "{:?}", report.random_pad);
    assert!(report.terrain["steps_10cm"]["run"].falls > 0, "{:?}", report.terrain);
    assert_eq!(report.terrain_get_up["steps_10cm"].success, 0.0);
    assert_eq!(report.push_torso["walk"].left_newton, 0.0);
    assert!(report.foot_slide_mps.is_empty());
}

#[test]
fn ahead_is_where_a_stand_faces_and_where_a_walk_is_sent() {
    let pack = pack(false);
    let bridge = physics_bridge::Model::from_mjcf(HUMANOID).unwrap();
    let model = Model::new(&bridge, Engine::Mujoco).unwrap();
    let ahead = |name: &str| {
        let gait = Gait::named(&pack, name).unwrap();
        let mut trial = Trial::new(&model, &pack, ControllerConfig::default(), &gait);
        trial.place(Vec2::ZERO, 0.5);
        trial.ahead()
    };
    assert!((ahead("idle") - 0.5).abs() < 1e-3 && ahead("walk") == 0.0, "{}", ahead("idle"));
}

#[test]
fn a_measure_repeats_itself() {
    let sections = [Section::Starts, Section::Buttons, Section::RandomPad, Section::Robustness];
    let measure = || measured(Engine::Mujoco, false, &TINY, &sections);
    assert_eq!(measure(), measure());
}

/// No section is left out in the other engine, and it measures no less.
#[test]
fn every_section_of_a_player_is_measured_in_rapier_too() {
    let [rapier, mujoco] =
        [Engine::Rapier, Engine::Mujoco].map(|engine| measured(engine, false, &TINY, &PLAYER));
    assert_eq!((rapier.engine, mujoco.engine), ("rapier", "mujoco"));
    let keys = |evaluation: &Evaluation| -> Vec<String> {
        let json = serde_json::to_value(evaluation).unwrap();
        json.as_object().unwrap().keys().cloned().collect()
    };
    assert_eq!(keys(&rapier), keys(&mujoco));
    let player = &rapier.player;
    assert!(player.terrain["hills_35cm"]["walk"].minutes > 0.0 && player.push_torso.len() == 5);
    assert_eq!(player.robustness.len(), mujoco.player.robustness.len());
    assert!(player.foot_slide_mps["walk"].is_finite());
}

#[test]
fn no_two_characters_start_alike() {
    let model = physics_bridge::Model::from_mjcf(HUMANOID).unwrap();
    let model = Model::new(&model, Engine::Mujoco).unwrap();
    let pack = pack(false);
    let idle = pack.graph().node_named("idle").unwrap();
    let starts: Vec<[f32; 2]> = (0..8)
        .map(|seed| {
            let (eval, way) = EvalCharacter::at_by_chance(&model, &pack, idle, &mut Rng::new(seed, 9));
            let velocity = eval.state.root().linear_velocity.truncate();
            assert!(velocity.length() < 1e-6 || velocity.angle_to(Vec2::from_angle(way)).abs() < 1e-3);
            [way, velocity.length()]
        })
        .collect();
    for (index, start) in starts.iter().enumerate() {
        assert!(starts[..index].iter().all(|other| (0..2).all(|i| other[i] != start[i])), "{starts:?}");
    }
}
