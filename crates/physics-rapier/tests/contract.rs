//! The contract that physics-bridge keeps too: pose, sense, actuate, step, and what is refused.

mod common;

use common::{CRANE, HUMANOID, body, crane, hash, humanoid, wriggle};
use physics_rapier::{Cause, Character, Drive, Model, ModelError, PoseError, PushError};
use policy_core::glam::Vec3;
use policy_core::{BodyId, CharacterState, Heading, Skeleton};

#[test]
fn a_model_tells_what_it_is_made_of() {
    let model = humanoid();
    assert_eq!(**model.skeleton(), Skeleton::humanoid());
    let actuation = model.actuation();
    assert!((actuation.physics_hz - 120.0).abs() < 1e-3 && (actuation.mass_kg - 48.8908).abs() < 1e-3);
    let knee = actuation.joints[common::joint(&model, "left_knee").index()];
    assert_eq!([knee.gain, knee.damping, knee.force_limit, knee.armature], [300.0, 30.0, 200.0, 0.02]);
}

#[test]
fn any_skeleton_will_do() {
    let model = crane();
    let names: Vec<&str> = model.skeleton().joints().iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["hang", "swing", "twist"], "in the order of the motors");
    assert_eq!((model.skeleton().body_count(), model.substeps()), (4, 6));
    let mut character = Character::new(&model);
    wriggle(&mut character, 60);
    let mut state = CharacterState::new(&Skeleton::humanoid());
    character.sense_into(&mut state);
    assert!(state.fits(model.skeleton()) && state.is_finite());
}

#[test]
fn a_pose_comes_back_as_it_was_set() {
    for model in [humanoid(), crane()] {
        let mut character = Character::new(&model);
        let mut pose = character.pose();
        for (index, number) in pose.qpos.iter_mut().enumerate().skip(7) {
            *number = 0.05 * index as f64 % 0.3;
        }
        pose.qpos[..7].copy_from_slice(&[1.0, -2.0, 3.0, 0.5, 0.5, -0.5, 0.5]);
        for (index, number) in pose.qvel.iter_mut().enumerate() {
            *number = 0.1 * index as f64;
        }
        character.set_pose(&pose.qpos, &pose.qvel).unwrap();
        let found = character.pose();
        for (a, b) in pose.qpos.iter().chain(&pose.qvel).zip(found.qpos.iter().chain(&found.qvel)) {
            assert!((a - b).abs() < 1e-5, "{pose:?} {found:?}");
        }
    }
}

#[test]
fn it_stands_where_it_is_told() {
    let model = humanoid();
    let mut character = Character::new(&model);
    character.stand_at(3.0, -2.0, Heading::from_angle(2.0), 1.5).unwrap();
    let mut state = CharacterState::new(model.skeleton());
    character.sense_into(&mut state);
    let root = *state.root();
    assert!((root.position.truncate() - policy_core::glam::Vec2::new(3.0, -2.0)).length() < 1e-5);
    assert!((Heading::from_rotation(root.rotation).angle() - 2.0).abs() < 1e-5);
    assert!((root.linear_velocity.truncate() - Heading::from_angle(2.0).direction() * 1.5).length() < 1e-5);
    let lowest = [body(&model, "left_foot"), body(&model, "right_foot")].map(|foot| state.height_of(foot));
    assert!(lowest[0] > 0.03 && lowest[0] < 0.06, "its soles are on the ground, {lowest:?}");
}

#[test]
fn the_same_start_has_the_same_future() {
    for drive in [Drive::Torques, Drive::Motors] {
        let run = || {
            let mut character = Character::with_drive(&humanoid(), drive);
            wriggle(&mut character, 60);
            (hash(&character), character)
        };
        let ((first, mut character), (second, _)) = (run(), run());
        assert_eq!(first, second);
        // A character that is posed again forgets its past.
        character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0).unwrap();
        wriggle(&mut character, 60);
        assert_eq!(hash(&character), first);
        wriggle(&mut character, 1);
        assert_ne!(hash(&character), first);
    }
}

/// Written down on x86-64. Another processor that disagrees breaks what the feature promises.
#[test]
#[cfg(feature = "enhanced-determinism")]
fn the_hash_is_that_of_every_machine() {
    let mut character = Character::new(&crane());
    wriggle(&mut character, 60);
    assert_eq!(format!("{:016x}", hash(&character)), "63e568771b574577");
}

#[test]
fn bad_poses_pushes_and_targets_change_nothing() {
    let model = humanoid();
    let mut character = Character::new(&model);
    let pose = character.pose();
    let mut bad = pose.clone();
    bad.qpos[9] = f64::NAN;
    let error = character.set_pose(&bad.qpos, &bad.qvel).unwrap_err();
    assert!(matches!(error, PoseError::NotFinite { field: "qpos", index: 9, .. }), "{error}");
    let error = character.set_pose(&pose.qpos[1..], &pose.qvel).unwrap_err();
    assert_eq!(error, PoseError::Length { field: "qpos", expected: 35, found: 34 });
    bad = pose.clone();
    bad.qpos[3] = 0.1;
    let error = character.set_pose(&bad.qpos, &bad.qvel).unwrap_err();
    assert!(matches!(error, PoseError::Quaternion { .. }), "{error}");
    // Finite, but too large for single precision.
    bad = pose.clone();
    bad.qpos[1] = 1e39;
    let error = character.set_pose(&bad.qpos, &bad.qvel).unwrap_err();
    assert_eq!(error, PoseError::NotFinite { field: "qpos", index: 1, found: 1e39 });
    bad = pose.clone();
    bad.qvel[8] = -1e300;
    let error = character.set_pose(&bad.qpos, &bad.qvel).unwrap_err();
    assert_eq!(error, PoseError::NotFinite { field: "qvel", index: 8, found: -1e300 });
    assert!(character.stand_at(f32::INFINITY, 0.0, Heading::FORWARD, 0.0).is_err());
    assert_eq!(character.pose(), pose);

    let error = character.push(BodyId::new(15), Vec3::X, 1.0).unwrap_err();
    assert_eq!(error, PushError::Body { bodies: 15, found: 15 });
    assert!(character.push(BodyId::new(0), Vec3::X * f32::NAN, 1.0).is_err());
    assert!(character.impulse(BodyId::new(0), Vec3::X * 1e9).is_err());
    assert!(!character.is_pushed(BodyId::new(0)));

    let before = character.articulation().targets().to_vec();
    character.actuate(&[f32::NAN; 3]);
    assert_eq!(character.articulation().targets(), before);
    character.step().unwrap();
}

#[test]
fn implausible_motion_is_refused_and_undone() {
    let model = humanoid();
    let mut character = Character::new(&model);
    let mut pose = character.pose();
    pose.qvel[0] = 80.0;
    character.set_pose(&pose.qpos, &pose.qvel).unwrap();
    let error = character.step().unwrap_err();
    assert_eq!((error.cause, error.body.as_str(), error.tick), (Cause::TooFast, "pelvis", 0), "{error}");
    let back = character.pose();
    assert!((back.qvel[0] - 80.0).abs() < 1e-4 && (back.qpos[2] - pose.qpos[2]).abs() < 1e-5);
}

#[test]
fn a_wrong_mjcf_is_refused_with_its_part() {
    let swap = |text: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        Model::from_mjcf(&text.replace(from, to)).map(|_| ()).unwrap_err()
    };
    let cases = [
        ("<freejoint/>", "", "free joint"),
        (r#"kp="20" forcerange="-10 10""#, r#"kp="20""#, "hang"),
        (r#"<position joint="twist" kp="60" forcerange="-40 40"/>"#, "", "twist"),
        (r#"joint="twist" kp="60""#, r#"joint="twist" kp="60" kv="3""#, "twist"),
        (r#"axis="0 1 0" pos="0 0 .1" range="-1.5 1.5""#, r#"axis="0 1 0""#, "hang"),
        (r#"<joint name="hang""#, r#"<joint name="hang" type="slide""#, "hang"),
        (r#"<body name="plate""#, "<body", "name"),
        ("0.00555555555", "0.007", "0.007"),
        ("<worldbody>", r#"<include file="/etc/passwd"/><worldbody>"#, "line 4"),
        ("<worldbody>", r#"<asset><mesh name="m" file="m.obj"/></asset><worldbody>"#, "file"),
        ("</worldbody>", "", "MJCF"),
    ];
    for (from, to, word) in cases {
        let error = swap(CRANE, from, to).to_string();
        assert!(error.contains(word), "{from}: {error}");
    }
    let loose = r#"</body><body name="crate" pos="3 0 1"><geom size="1"/></body></worldbody>"#;
    let error = swap(CRANE, "</body>\n  </worldbody>", loose).to_string();
    assert!(error.contains("crate"), "{error}");
    let hidden = r#"<a b="/>">"#.repeat(50_000);
    let deep = [hidden, "<a><!-- </a> -->".repeat(50_000), "<a>".repeat(100_000)];
    for text in deep.into_iter().chain([String::new(), " ".repeat(2 << 20), "<mujoco/>".into()]) {
        assert!(Model::from_mjcf(&text).is_err());
    }
}

#[test]
fn a_character_without_geoms_is_refused() {
    let mut bare = String::new();
    for line in CRANE.lines().filter(|line| !line.contains("<geom") || line.contains("plane")) {
        bare.push_str(&line.replace("</body>", ""));
        bare.push_str(if line.contains("</body>") {
            "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></body>\n"
        } else {
            "\n"
        });
    }
    let error = Model::from_mjcf(&bare).unwrap_err();
    assert!(matches!(error, ModelError::NoGeoms), "{error}");
}

#[test]
fn names_tell_the_roles_in_capitals_too() {
    let named = |hook, plate| CRANE.replace("\"hook\"", hook).replace("\"plate\"", plate);
    let model = Model::from_mjcf(&named("\"LeftHand\"", "\"Foot_R\"")).unwrap();
    let roles = model.skeleton().roles();
    assert_eq!((roles.hands.len(), roles.feet.len()), (1, 1), "{roles:?}");
}

#[test]
fn a_skeleton_has_to_fit_its_mjcf() {
    let model = Model::from_mjcf_with_skeleton(HUMANOID, Skeleton::humanoid()).unwrap();
    assert_eq!(model.skeleton().joint_count(), 28);
    let error = Model::from_mjcf_with_skeleton(CRANE, Skeleton::humanoid()).unwrap_err();
    assert!(matches!(&error, ModelError::Missing { kind: "body", name } if name == "pelvis"), "{error}");
    let turned = HUMANOID.replace(r#"name="left_knee" axis="0 1 0""#, r#"name="left_knee" axis="0 -1 0""#);
    let error = Model::from_mjcf_with_skeleton(&turned, Skeleton::humanoid()).unwrap_err().to_string();
    assert!(error.contains("left_knee") && error.contains("axis"), "{error}");
    let wider = HUMANOID.replace(r#"axis="0 1 0" range="0 160""#, r#"axis="0 1 0" range="0 170""#);
    let error = Model::from_mjcf_with_skeleton(&wider, Skeleton::humanoid()).unwrap_err().to_string();
    assert!(error.contains("right_knee") && error.contains("range"), "{error}");
}
