use glam::{Quat, Vec3};
use policy_core::Skeleton;

use super::*;

/// Index of a body of the humanoid.
fn body(name: &str) -> usize {
    Skeleton::humanoid().body_named(name).unwrap().index()
}

/// Index of a joint of the humanoid.
fn joint(name: &str) -> usize {
    Skeleton::humanoid().joint_named(name).unwrap().index()
}

fn still(frames: usize) -> Clip {
    Clip {
        name: "still".into(),
        looping: false,
        bodies: humanoid::bodies(),
        times: (0..frames).map(|i| i as f32 / 30.0).collect(),
        root_positions: vec![Vec3::new(0.0, 0.0, 0.9); frames],
        local_rotations: vec![vec![Quat::IDENTITY; 15]; frames],
    }
}

/// A clip whose right knee swings and which walks along x, one metre a second, in a cycle of one second.
fn swinging() -> Clip {
    let mut clip = still(121);
    clip.times = (0..121).map(|i| i as f32 / 120.0).collect();
    clip.looping = true;
    for (i, t) in clip.times.clone().into_iter().enumerate() {
        clip.root_positions[i].x = t;
        let bend = 0.5 - 0.5 * (std::f32::consts::TAU * t).cos();
        clip.local_rotations[i][body("right_shin")] = Quat::from_rotation_y(bend);
    }
    clip.checked().unwrap()
}

fn json_of(clip: &Clip) -> String {
    serde_json::json!({
        "name": clip.name, "loop": if clip.looping { "wrap" } else { "none" }, "up": "z", "quat": "xyzw",
        "bodies": clip.bodies.to_vec(), "times": clip.times,
        "root_pos": clip.root_positions.iter().map(|p| p.to_array()).collect::<Vec<_>>(),
        "local_rot": clip.local_rotations.iter()
            .map(|r| r.iter().map(|q| q.to_array()).collect::<Vec<_>>()).collect::<Vec<_>>(),
    })
    .to_string()
}

#[test]
fn json_comes_back_as_it_went() {
    let clip = swinging();
    assert_eq!(json::parse("still", &json_of(&clip)).unwrap(), clip);
}

#[test]
fn hostile_json_is_refused() {
    let good = json_of(&swinging());
    for bad in [
        String::new(),
        "{}".into(),
        "[1, 2".into(),
        good[..good.len() / 2].to_owned(),
        good.replace("wrap", "sometimes"),
        good.replace("\"z\"", "\"y\""),
        good.replace("right_foot", "left_foot"),
        good.replacen("0.9", "1e39", 1),
        good.replacen("[0.0,0.0,0.0,1.0]", "[0.0,0.0,0.0,0.0]", 1),
        good.replacen("[0.0,0.0,0.0,1.0]", "[0.0,0.0,1.0]", 1),
        good.replacen("[0.0,0.0,0.0,1.0],", "", 1),
    ] {
        assert!(json::parse("bad", &bad).is_err(), "{}", &bad[..bad.len().min(80)]);
    }
}

#[test]
fn a_deepmimic_clip_is_turned_upright() {
    let mut frame = vec![0.1, 1.0, 0.9, -2.0];
    // Root, chest, neck, right hip; knee; ankle, shoulder; elbow; then the left side.
    frame.extend([1.0, 0.0, 0.0, 0.0].repeat(4));
    frame.push(-0.7);
    frame.extend([1.0, 0.0, 0.0, 0.0].repeat(2));
    frame.push(0.4);
    frame.extend([1.0, 0.0, 0.0, 0.0]);
    frame.push(-0.7);
    frame.extend([1.0, 0.0, 0.0, 0.0].repeat(2));
    frame.push(0.4);
    assert_eq!(frame.len(), 44);
    let text = serde_json::json!({ "Loop": "none", "Frames": [frame.clone(), frame.clone()] }).to_string();
    let clip = deepmimic::parse("dm", &text).unwrap();
    assert_eq!(clip.root_positions[0], Vec3::new(1.0, 2.0, 0.9));
    let knee = clip.local_rotations[0][body("right_shin")];
    assert!(knee.angle_between(Quat::from_rotation_y(0.7)) < 1e-4);
    let elbow = clip.local_rotations[0][body("left_lower_arm")];
    assert!(elbow.angle_between(Quat::from_rotation_y(-0.4)) < 1e-4);
    frame.pop();
    let short = serde_json::json!({ "Loop": "none", "Frames": [frame.clone(), frame] }).to_string();
    assert!(deepmimic::parse("dm", &short).is_err());
    assert!(deepmimic::parse("dm", "{\"Loop\":\"none\",\"Frames\":[]}").is_err());
}

#[test]
fn times_must_ascend_and_stay_short() {
    let mut clip = still(3);
    clip.times[2] = clip.times[1];
    assert!(matches!(clip.checked(), Err(ClipError::Times { frame: 2, .. })));
    let mut clip = still(3);
    clip.times[2] = 1e9;
    assert!(matches!(clip.checked(), Err(ClipError::Duration { .. })));
    // The last two become one time when the first becomes zero.
    let mut clip = still(3);
    clip.times = vec![-100.0, 1e-9, 2e-9];
    assert!(matches!(clip.checked(), Err(ClipError::Times { frame: 2, .. })));
    assert!(matches!(still(1).checked(), Err(ClipError::FrameCount { found: 1, .. })));
}

#[test]
fn the_mirror_of_the_mirror_is_the_clip() {
    let mut clip = swinging();
    clip.root_positions[3].y = 0.2;
    let twice = clip.mirrored().mirrored();
    assert_eq!(twice.root_positions, clip.root_positions);
    assert_eq!(twice.local_rotations, clip.local_rotations);
    let once = clip.mirrored();
    assert_eq!(once.root_positions[3].y, -0.2);
    assert_eq!(once.local_rotations[5][body("left_shin")], clip.local_rotations[5][body("right_shin")]);
}

#[test]
fn a_symmetric_clip_is_its_own_mirror_image_half_a_cycle_later() {
    let mut limping = swinging();
    let turn = Quat::from_rotation_z(0.4);
    for (i, frame) in limping.local_rotations.iter_mut().enumerate() {
        let phase = (i as f32 / 120.0) * std::f32::consts::TAU;
        frame[0] = turn * Quat::from_rotation_z(0.3 * phase.sin() + 0.2 * phase.cos().powi(2));
        frame[body("left_shin")] *= Quat::from_rotation_y(0.3);
    }
    limping.root_positions.iter_mut().for_each(|p| *p = turn * *p);
    let even = limping.symmetric().unwrap();
    let (mirrored, half) = (even.mirrored(), 0.5 * even.duration());
    let apart = |one: &Clip, other: &Clip, time: f32| {
        let ((p, a), (q, b)) = (one.sample(time), other.sample(time + half));
        let furthest = a.iter().zip(&b).map(|(a, b)| a.angle_between(*b)).fold(0.0, f32::max);
        (furthest, (p.y - q.y).abs())
    };
    for time in [0.0, 0.1, 0.27, 0.45] {
        let (angle, aside) = apart(&even, &mirrored, time);
        assert!(angle < 0.01 && aside < 1e-4, "{time}: {angle} rad, {aside} m");
        assert!(apart(&limping, &limping.mirrored(), time).0 > 0.1);
    }
    // The limp goes and the gait stays: the knees bend, the way is as long, and leads ahead.
    let offset = even.cycle_offset();
    assert!((offset.x - 1.0).abs() < 1e-3 && offset.y.abs() < 1e-3, "{offset}");
    let bend = |clip: &Clip, frame: usize| {
        clip.local_rotations[frame][body("left_shin")].angle_between(Quat::IDENTITY)
    };
    assert!((bend(&even, 60) - bend(&even, 0)).abs() > 0.1);
    let error = swinging().held(1.0).unwrap().symmetric().unwrap_err().to_string();
    assert!(error.contains("expected one that loops"), "{error}");
}

#[test]
fn a_cycle_is_closed_and_its_velocities_are_those_of_the_motion() {
    let motion = Motion::fit(&swinging(), &Skeleton::humanoid()).unwrap();
    assert_eq!(motion.poses.len(), 120);
    assert!((motion.cycle_offset[0] - 1.0).abs() < 1e-6 && (motion.mean_speed() - 1.0).abs() < 1e-3);
    let knee = joint("right_knee");
    for (i, pose) in motion.poses.iter().enumerate() {
        assert!((pose.qvel[0] - 1.0).abs() < 1e-3, "pose {i}: {}", pose.qvel[0]);
        let tau = std::f64::consts::TAU;
        let expected = 0.5 * tau * (tau * i as f64 / 120.0).sin();
        assert!((pose.qvel[6 + knee] - expected).abs() < 0.02, "pose {i}: {}", pose.qvel[6 + knee]);
    }
    assert_eq!(motion.earlier(2, 1), 118);
    assert_eq!(Motion::fit(&still(31), &Skeleton::humanoid()).unwrap().earlier(2, 1), 0);
}

#[test]
fn joint_angles_give_the_rotations_back() {
    let mut fit = JointFit::new(&Skeleton::humanoid(), "a", &humanoid::bodies()).unwrap();
    let mut rotations = vec![Quat::IDENTITY; 15];
    let hip = Quat::from_rotation_y(-1.2) * Quat::from_rotation_x(0.3) * Quat::from_rotation_z(-0.2);
    rotations[body("left_thigh")] = hip;
    rotations[body("right_lower_arm")] = Quat::from_rotation_y(-1.0);
    let angles = fit.angles(&rotations);
    let joint = |name: &str| angles[joint(name)];
    assert!((joint("left_hip_y") + 1.2).abs() < 1e-4 && (joint("left_hip_x") - 0.3).abs() < 1e-4);
    assert!((joint("left_hip_z") + 0.2).abs() < 1e-4 && (joint("right_elbow") + 1.0).abs() < 1e-4);
    assert!(fit.worst().0 < 1e-6);
}

#[test]
fn a_placed_pose_moves_and_turns_with_its_velocity() {
    let pose = Motion::fit(&swinging(), &Skeleton::humanoid()).unwrap().poses[10].clone();
    let turned = placed(&pose, 5.0, -3.0, std::f64::consts::FRAC_PI_2);
    assert_eq!((turned.qpos[0], turned.qpos[1], turned.qpos[2]), (5.0, -3.0, pose.qpos[2]));
    assert!((turned.qvel[1] - pose.qvel[0]).abs() < 1e-9 && turned.qvel[0].abs() < 1e-9);
}

#[test]
fn a_missing_folder_or_clip_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = ClipFolder::from_argument(Some(folder.path().to_owned())).unwrap();
    let error = folder.load("walk").unwrap_err().to_string();
    assert!(error.contains("walk.json"), "{error}");
    let error = ClipError::NoFolder { variable: MOTIONS_VARIABLE }.to_string();
    assert!(error.contains("--motions") && error.contains("DeepMimic"), "{error}");
}

#[test]
fn half_way_to_a_stand_a_walk_bends_and_goes_half_as_much() {
    let (walk, stand) = (swinging(), still(2));
    let half = walk.towards(&stand, 0.5).unwrap();
    assert!((half.cycle_offset().x - 0.5).abs() < 1e-6 && half.duration() == walk.duration());
    let knee = body("right_shin");
    let bend = |clip: &Clip| clip.local_rotations[60][knee].angle_between(Quat::IDENTITY);
    assert!((bend(&walk.towards(&stand, 0.0).unwrap()) - bend(&walk)).abs() < 1e-3);
    assert!(bend(&walk) > 0.5 && (bend(&half) - 0.5 * bend(&walk)).abs() < 1e-3);
    // What it goes towards is the same on both sides, whatever side that clip begins on.
    let whole = walk.towards(&walk.mirrored(), 1.0).unwrap();
    let [left, right] = ["left_shin", "right_shin"].map(|name| whole.local_rotations[0][body(name)]);
    assert!(left.angle_between(right) < 1e-3);
}

#[test]
fn a_clip_goes_to_no_pose_of_other_bodies() {
    let mut other = still(2);
    other.bodies = vec!["root".to_owned()].into();
    other.local_rotations = vec![vec![Quat::IDENTITY]; 2];
    let error = swinging().towards(&other.checked().unwrap(), 0.5).unwrap_err().to_string();
    assert!(error.contains("right_shin") && error.ends_with("found root"), "{error}");
}

#[test]
fn an_excerpt_has_the_frames_of_its_seconds_and_no_others() {
    let walk = swinging();
    let excerpt = walk.excerpt([0.25, 0.75]).unwrap();
    assert!((excerpt.duration() - 0.5).abs() < 0.02 && excerpt.times[0] == 0.0, "{}", excerpt.duration());
    let first = walk.times.iter().position(|t| *t > 0.2499).unwrap();
    assert_eq!(excerpt.root_positions[0], walk.root_positions[first]);
    assert_eq!(excerpt.looping, walk.looping);
    for seconds in [[0.5, 0.5], [-0.1, 0.5], [0.5, 60.0], [f32::NAN, 0.5]] {
        let error = walk.excerpt(seconds).unwrap_err().to_string();
        assert!(error.contains("expected an excerpt [from, to]"), "{error}");
    }
}

#[test]
fn a_clip_backwards_goes_back_and_a_pace_changes_its_time_alone() {
    let clip = swinging();
    let back = clip.reversed().checked().unwrap();
    assert_eq!((back.times[0], back.duration()), (0.0, clip.duration()));
    assert!((back.cycle_offset() + clip.cycle_offset()).length() < 1e-6);
    assert_eq!(back.local_rotations[40], clip.local_rotations[80]);
    let slow = clip.at_pace(0.5).unwrap();
    assert!((slow.duration() - 2.0 * clip.duration()).abs() < 1e-6);
    assert_eq!(slow.local_rotations, clip.local_rotations);
}

#[test]
fn a_clip_that_is_held_ends_at_rest_and_no_longer_loops() {
    let walk = swinging();
    let held = walk.held(0.5).unwrap();
    assert!(walk.looping && !held.looping && (held.duration() - walk.duration() - 0.5).abs() < 1e-5);
    let (last, rotations) = held.sample(walk.duration());
    for seconds in [0.1, 0.5] {
        assert_eq!(held.sample(walk.duration() + seconds), (last, rotations.clone()));
    }
    assert_eq!(walk.held(0.0).unwrap(), Clip { looping: false, ..walk.clone() });
    for seconds in [-0.1, f32::NAN, 700.0] {
        assert!(walk.held(seconds).is_err(), "{seconds}");
    }
}

#[test]
fn side_steps_go_left_in_a_cycle_and_plant_their_feet() {
    let clip = still(2).side_steps(0.5).unwrap();
    assert!(clip.looping && (clip.cycle_offset().y / clip.duration() - 0.5).abs() < 1e-4);
    let model = physics_bridge::Model::load(
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml"),
    );
    let model = model.unwrap();
    let fitted = fit(&clip, &model).unwrap();
    assert!(fitted.clearances.iter().all(|clearance| *clearance > -0.02), "nothing is far in the ground");
    // The lower foot stands, and what stands stays.
    let slip = fitted.states.iter().map(|state| {
        let feet = ["left_foot", "right_foot"].map(|foot| state.bodies[body(foot)]);
        let lower = if feet[0].position.z < feet[1].position.z { feet[0] } else { feet[1] };
        lower.linear_velocity.truncate().length()
    });
    let mean = slip.sum::<f32>() / fitted.states.len() as f32;
    assert!(mean < 0.15, "{mean} m/s");
    let swung = fitted.states.iter().map(|s| s.bodies[body("left_foot")].position.z);
    let (least, most) = swung.fold((9.0_f32, 0.0_f32), |(a, b), z| (a.min(z), b.max(z)));
    assert!((0.03..0.2).contains(&(most - least)), "{least} to {most} m");
}

#[test]
fn a_punch_reaches_ahead_and_ends_as_it_begins() {
    let clip = still(2).punch().unwrap();
    assert!(!clip.looping && (clip.duration() - 1.35).abs() < 1e-3, "{}", clip.duration());
    let [first, last] = [&clip.local_rotations[0], clip.local_rotations.last().unwrap()];
    assert!(first.iter().zip(last).all(|(a, b)| a.angle_between(*b) < 1e-3));
    // Where a fist is from its shoulder at the moment of the longest reach, the arms 0.3 m long each.
    let fist = |side: &str| {
        let rotations = clip.sample(0.65).1;
        let [torso, upper, lower] =
            ["torso".into(), format!("{side}_upper_arm"), format!("{side}_lower_arm")]
                .map(|name: String| rotations[body(&name)]);
        torso * (upper * (Vec3::NEG_Z + lower * Vec3::NEG_Z)) * 0.3
    };
    let (strikes, guards) = (fist("right"), fist("left"));
    assert!(strikes.truncate().length() > 0.55 && strikes.z.abs() < 0.2, "{strikes}");
    assert!(guards.truncate().length() < 0.45, "{guards}");
}

/// A run at 2.4 m/s that lifts its left thigh and swings its right one back; what is a flight is up to the test.
fn running() -> Clip {
    let mut clip = still(61);
    clip.looping = true;
    for (i, t) in clip.times.clone().into_iter().enumerate() {
        clip.root_positions[i].x = 2.4 * t;
        clip.local_rotations[i][body("left_thigh")] = Quat::from_rotation_y(-0.5);
        clip.local_rotations[i][body("right_thigh")] = Quat::from_rotation_y(0.3);
        clip.local_rotations[i][body("right_shin")] = Quat::from_rotation_y(0.4);
        clip.local_rotations[i][body("left_shin")] = Quat::from_rotation_y(0.4);
    }
    clip.checked().unwrap()
}

#[test]
fn a_leap_flies_as_long_as_it_is_to_and_as_a_body_falls() {
    let (run, leap) = (running(), Leap { flight: [0.6, 0.75], seconds: 0.45 });
    let made = run.leap(&leap).unwrap();
    assert!(!made.looping && (made.duration() - run.duration() - 0.3).abs() < 0.02, "{}", made.duration());
    let height = |secs: f32| made.sample(secs).0.z - 0.9;
    // A flight of that time rises by g T^2 / 8; that of the clip itself is not counted twice.
    let wanted = 9.81 / 8.0 * (0.45_f32.powi(2) - 0.15_f32.powi(2));
    assert!((height(0.6 + 0.225) - wanted).abs() < 0.01, "{}", height(0.825));
    assert!(
        (height(0.6)).abs() < 0.01 && height(1.05).abs() < 0.02,
        "it leaves and comes back at its height"
    );
    assert!(height(0.4) < -0.05 && height(1.3) < -0.05, "it dips before and after");
    let steady = |secs: f32| (made.sample(secs).0.x - 2.4 * secs).abs();
    assert!([0.3, 0.7, 1.0, 1.5].into_iter().all(|secs| steady(secs) < 0.02), "at the speed of the run");
    let bend = |secs: f32, part: &str| 2.0 * made.sample(secs).1[body(part)].w.abs().min(1.0).acos();
    assert!(
        bend(0.4, "right_shin") > 0.5 && (bend(0.4, "left_shin") - 0.4).abs() < 0.01,
        "the leg behind pushes off"
    );
    assert!(
        bend(1.3, "left_shin") > 0.5 && (bend(1.3, "right_shin") - 0.4).abs() < 0.01,
        "the leg ahead lands"
    );
    assert!(bend(0.825, "left_shin") > 0.8, "tucked up");
}

#[test]
fn a_leap_needs_a_flight_within_its_clip_and_legs() {
    for (flight, seconds) in [
        ([0.0, 0.2], 0.4),
        ([0.3, 0.2], 0.4),
        ([1.5, 2.0], 0.6),
        ([0.6, 0.8], 0.1),
        ([0.6, 0.8], 2.5),
        ([f32::NAN, 0.8], 0.4),
        ([0.6, 0.8], f32::NAN),
    ] {
        let said = running().leap(&Leap { flight, seconds }).unwrap_err().to_string();
        assert!(said.contains("flight") && said.contains("found"), "{said}");
    }
    let mut clip = running();
    clip.bodies = clip.bodies.iter().map(|name| name.replace("left_foot", "paw")).collect();
    let said = clip.leap(&Leap { flight: [0.6, 0.8], seconds: 0.4 }).unwrap_err().to_string();
    assert!(said.contains("left_foot"), "{said}");
}

#[test]
fn side_steps_need_legs() {
    let mut clip = still(2);
    clip.bodies = clip.bodies.iter().map(|name| name.replace("left_shin", "calf")).collect();
    let said = clip.side_steps(0.5).unwrap_err().to_string();
    assert!(said.contains("left_shin") && said.contains("calf"), "{said}");
}
