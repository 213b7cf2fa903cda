//! Bad input at the border: an error with a text that says what was expected, and nothing lost.

mod common;

use std::ffi::CString;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use common::{Body, DT, JOINTS, controller, last_error, pack, tick, walking};
use policy_space::*;

/// The last call failed with this status and a text with this part.
#[track_caller]
fn failed(found: PsStatus, expected: PsStatus, part: &str) {
    assert_eq!(found, expected, "{}", last_error());
    assert_eq!(ps_last_status(), expected);
    assert!(last_error().contains(part), "{:?} does not say {part:?}", last_error());
}

#[test]
fn null_pointers_are_errors() {
    let (pack, body, mut targets) = (pack(), Body::standing(), [0.0; JOINTS]);
    let mut made = controller(&pack);
    let (sensed, command) = (body.sensed(), walking());
    let null_error = PsStatus::NullPointer;
    let out = targets.as_mut_ptr();
    // SAFETY: null or of slices, with their lengths.
    unsafe {
        failed(
            ps_controller_tick(None, Some(&sensed), Some(&command), DT, out, JOINTS),
            null_error,
            "a controller",
        );
        failed(
            ps_controller_tick(Some(&mut made), None, Some(&command), DT, out, JOINTS),
            null_error,
            "sensed",
        );
        failed(
            ps_controller_tick(Some(&mut made), Some(&sensed), None, DT, out, JOINTS),
            null_error,
            "a command",
        );
        let no_room =
            ps_controller_tick(Some(&mut made), Some(&sensed), Some(&command), DT, null_mut(), JOINTS);
        failed(no_room, null_error, "joint targets");
        let no_bodies = PsSensed { bodies: null(), ..sensed };
        let tick = ps_controller_tick(Some(&mut made), Some(&no_bodies), Some(&command), DT, out, JOINTS);
        failed(tick, null_error, "bodies");
        let no_blend = PsCommand { blend_count: 2, ..command };
        let tick = ps_controller_tick(Some(&mut made), Some(&sensed), Some(&no_blend), DT, out, JOINTS);
        failed(tick, null_error, "blend");
        assert!(ps_pack_from_bytes(null(), 3).is_none());
        failed(ps_last_status(), null_error, "the bytes of a pack");
        assert!(ps_pack_from_file(null()).is_none());
        failed(ps_last_status(), null_error, "the path");
        assert_eq!(ps_pack_find(Some(&pack), 0, null()), PS_NONE);
        failed(ps_last_status(), null_error, "the name");
        failed(ps_pack_motors(Some(&pack), null_mut(), JOINTS), null_error, "motors");
        failed(ps_pack_motors(None, null_mut(), JOINTS), null_error, "a pack");
        failed(ps_state_to_bytes(None, null_mut(), 0), null_error, "a state");
    }
    assert!(ps_controller_new(None, None).is_none());
    failed(ps_last_status(), null_error, "a pack");
    assert!(ps_pack_name(None, 0, 0).is_null() && ps_pack_mjcf(None).is_null());
    assert_eq!((ps_pack_count(None, 0), ps_state_byte_len(None)), (0, 0));
    failed(ps_pack_info(Some(&pack), None), null_error, "the place");
    failed(ps_controller_save(Some(&made), None), null_error, "a state");
    ps_pack_free(None);
    ps_controller_free(None);
    ps_state_free(None);
    assert_eq!(tick(&mut made, &body, &command, &mut targets), PsStatus::Ok);
}

#[test]
fn a_misaligned_array_is_an_error() {
    let (pack, body) = (pack(), Body::standing());
    let mut controller = controller(&pack);
    let (sensed, command, mut room) = (body.sensed(), walking(), [0u64; JOINTS]);
    let odd = room.as_mut_ptr().cast::<u8>().wrapping_add(1).cast();
    // SAFETY: refused before it is used.
    let status =
        unsafe { ps_controller_tick(Some(&mut controller), Some(&sensed), Some(&command), DT, odd, JOINTS) };
    failed(status, PsStatus::NullPointer, "a multiple of 4 bytes");
}

#[test]
fn short_arrays_are_errors() {
    let (pack, mut body, mut targets) = (pack(), Body::standing(), [7.0; JOINTS]);
    let mut controller = controller(&pack);
    let short = tick(&mut controller, &body, &walking(), &mut targets[..JOINTS - 1]);
    failed(short, PsStatus::WrongCount, "expected room for 28 joint targets, found 27");
    body.bodies.pop();
    let short = tick(&mut controller, &body, &walking(), &mut targets);
    failed(short, PsStatus::WrongCount, "expected 15 bodies, found 14");
    body = Body::standing();
    body.velocities.push(0.0);
    let long = tick(&mut controller, &body, &walking(), &mut targets);
    failed(long, PsStatus::WrongCount, "expected 28 joint velocities, found 29");
    assert_eq!(targets, [7.0; JOINTS], "nothing was written");
    let mut state = ps_state_new(Some(&pack)).unwrap();
    let mut bytes = [0u8; 8];
    // SAFETY: as many bytes as said.
    unsafe {
        failed(ps_state_to_bytes(Some(&state), bytes.as_mut_ptr(), 8), PsStatus::WrongCount, "room for");
        let read = ps_state_from_bytes(Some(&mut state), Some(&pack), bytes.as_ptr(), 8);
        failed(read, PsStatus::WrongCount, "bytes of a state, found 8");
        let node = ps_pack_path_nodes(Some(&pack), 0, [0].as_mut_ptr(), 1);
        failed(node, PsStatus::WrongCount, "expected room for 2 nodes, found 1");
    }
}

/// A tick with a fault leaves the controller as if it had not been, and its targets are those of a zero action.
#[track_caller]
fn refused(change: impl FnOnce(&mut Body), part: &str) {
    let pack = pack();
    let (mut faulty, mut sound) = (controller(&pack), controller(&pack));
    let (good, mut bad, mut targets, mut expected) =
        (Body::standing(), Body::standing(), [7.0; JOINTS], [7.0; JOINTS]);
    change(&mut bad);
    failed(tick(&mut faulty, &bad, &walking(), &mut targets), PsStatus::BadNumber, part);
    for (joint, target) in targets.iter().enumerate() {
        let mut slot = MaybeUninit::uninit();
        assert_eq!(ps_pack_joint(Some(&pack), joint as i32, Some(&mut slot)), PsStatus::Ok);
        // SAFETY: the function succeeded, so it has written.
        assert_eq!(*target, unsafe { slot.assume_init() }.action_centre);
    }
    for _ in 0..3 {
        assert_eq!(tick(&mut faulty, &good, &walking(), &mut targets), PsStatus::Ok);
        assert_eq!(tick(&mut sound, &good, &walking(), &mut expected), PsStatus::Ok);
        assert_eq!(targets, expected);
    }
}

#[test]
fn bad_transforms_are_errors_that_name_the_body() {
    refused(|b| b.bodies[2].position[1] = f32::NAN, "expected a finite position of body \"head\"");
    refused(|b| b.bodies[0].linear_velocity[0] = f32::INFINITY, "linear_velocity of body \"pelvis\"");
    refused(|b| b.bodies[1].angular_velocity[2] = f32::NAN, "angular_velocity of body \"torso\"");
    refused(|b| b.bodies[14].rotation[3] = f32::NAN, "rotation of length 1 of body \"left_foot\"");
    refused(|b| b.bodies[5].rotation = [0.0; 4], "found length 0");
    refused(|b| b.velocities[0] = f32::NAN, "joint velocity of \"abdomen_x\"");
}

#[test]
fn bad_commands_are_errors_and_nothing_happens() {
    let (pack, body, mut targets) = (pack(), Body::standing(), [7.0; JOINTS]);
    let mut controller = controller(&pack);
    let (index, number) = (PsStatus::BadIndex, PsStatus::BadNumber);
    let terms = [PsBlendTerm { policy: 0, weights: [f32::NAN; 4] }; 17];
    let commands = [
        (PsCommand { goal_index: 2, ..walking() }, index, "expected the index of a path below 2, found 2"),
        (PsCommand { goal_index: -1, ..walking() }, index, "found -1"),
        (PsCommand { goal: 3, ..walking() }, index, "goal"),
        (PsCommand { goal: PsGoal::Node as i32, goal_index: 9, ..walking() }, index, "node"),
        (PsCommand { coordinate: f32::NAN, ..walking() }, number, "coordinate"),
        (PsCommand { target: [0.0, f32::NAN], ..walking() }, number, "target"),
        (PsCommand { has_facing: 1, facing: [f32::NAN, 0.0], ..walking() }, number, "the way to face"),
        (PsCommand { has_skill: 1, ..walking() }, index, "skill"),
        (PsCommand { blend: terms.as_ptr(), blend_count: 1, ..walking() }, number, "blend weight"),
        (
            PsCommand { blend: terms.as_ptr(), blend_count: 17, ..walking() },
            PsStatus::WrongCount,
            "at most 16",
        ),
    ];
    for (command, status, part) in commands {
        failed(tick(&mut controller, &body, &command, &mut targets), status, part);
    }
    let sensed = body.sensed();
    for dt in [f32::NAN, -1.0, f32::INFINITY] {
        // SAFETY: as many numbers as said.
        let status = unsafe {
            let out = targets.as_mut_ptr();
            ps_controller_tick(Some(&mut controller), Some(&sensed), Some(&walking()), dt, out, JOINTS)
        };
        failed(status, number, "dt_secs");
    }
    assert_eq!(targets, [7.0; JOINTS], "nothing was written");
}

#[test]
fn bad_packs_files_names_and_indices_are_errors() {
    let pack = pack();
    // SAFETY: slices with their lengths, C strings.
    unsafe {
        assert!(ps_pack_from_bytes(b"no pack".as_ptr(), 7).is_none());
        failed(ps_last_status(), PsStatus::BadPack, "expected");
        let mut damaged = common::bytes();
        let last = damaged.len() - 1;
        damaged[last] ^= 1;
        assert!(ps_pack_from_bytes(damaged.as_ptr(), damaged.len()).is_none());
        failed(ps_last_status(), PsStatus::BadPack, "checksum");
        let missing = CString::new("no/such/file").unwrap();
        assert!(ps_pack_from_file(missing.as_ptr()).is_none());
        failed(ps_last_status(), PsStatus::File, "no/such/file");
        assert_eq!(ps_pack_find(Some(&pack), PsPart::Path as i32, c"warp".as_ptr()), PS_NONE);
        failed(
            ps_last_status(),
            PsStatus::BadName,
            "expected the name of a path of the pack, found \"warp\"",
        );
        assert_eq!(ps_pack_find(Some(&pack), 0, c"\xff".as_ptr()), PS_NONE);
        failed(ps_last_status(), PsStatus::BadName, "UTF-8");
        assert_eq!(ps_pack_find(Some(&pack), 99, c"walk".as_ptr()), PS_NONE);
        failed(ps_last_status(), PsStatus::BadIndex, "kind");
    }
    assert!(ps_pack_name(Some(&pack), PsPart::Body as i32, 15).is_null());
    failed(ps_last_status(), PsStatus::BadIndex, "below 15, found 15");
    let mut controller = controller(&pack);
    failed(ps_controller_set_blend_mode(Some(&mut controller), 3), PsStatus::BadIndex, "blend mode");
    failed(ps_controller_place_at(Some(&mut controller), 0, 1, 1.5), PsStatus::BadIndex, "1.5 of the way");
    let config = PsConfig { handover_secs: -1.0, ..PsConfig::default() };
    assert!(ps_controller_new(Some(&pack), Some(&config)).is_none());
    failed(ps_last_status(), PsStatus::BadNumber, "handover_secs");
    let config = PsConfig { turn_assist: 1, turn_full_radians: 0.1, ..PsConfig::default() };
    assert!(ps_controller_new(Some(&pack), Some(&config)).is_none());
    failed(ps_last_status(), PsStatus::BadNumber, "turn_full_radians");
    let config = PsConfig { turn_assist: 1, turn_slow_begin_radians: 3.0, ..PsConfig::default() };
    assert!(ps_controller_new(Some(&pack), Some(&config)).is_none());
    failed(ps_last_status(), PsStatus::BadNumber, "turn_slow_full_radians above 3");
    let config = PsConfig { steering_lead: f32::NAN, ..PsConfig::default() };
    assert!(ps_controller_new(Some(&pack), Some(&config)).is_none());
    failed(ps_last_status(), PsStatus::BadNumber, "steering_lead");
    let config = PsConfig { steering_velocity_secs: -0.1, ..PsConfig::default() };
    assert!(ps_controller_new(Some(&pack), Some(&config)).is_none());
    failed(ps_last_status(), PsStatus::BadNumber, "steering_velocity_secs of at least 0");
    for share in [0.0, 1.0, 1.5] {
        let config = PsConfig { give_way: 1, give_way_held_up_share: share, ..PsConfig::default() };
        assert!(ps_controller_new(Some(&pack), Some(&config)).is_none());
        failed(ps_last_status(), PsStatus::BadNumber, "give_way_held_up_share above 0 and below 1");
    }
}

#[test]
fn a_state_for_another_skeleton_stays_as_it_was() {
    let (ours, bytes) = (pack(), common::bytes());
    let core = policy_core::CharacterPack::from_bytes(&bytes).unwrap();
    let (mut manifest, tensors) = (core.manifest().clone(), core.tensors().clone());
    manifest.skeleton.bodies[2].name = "skull".into();
    manifest.skeleton.joints.iter_mut().filter(|j| j.body == "head").for_each(|j| j.body = "skull".into());
    manifest.skeleton.roles.head = Some("skull".into());
    let other = policy_core::CharacterPack::from_parts(manifest, tensors).unwrap();
    let other = common::load(&other.to_bytes());
    let mut made = controller(&ours);
    tick(&mut made, &Body::standing(), &walking(), &mut [0.0; JOINTS]);
    let mut state = ps_state_new(Some(&ours)).unwrap();
    assert_eq!(ps_controller_save(Some(&made), Some(&mut state)), PsStatus::Ok);
    let written = |state: &PsState| {
        let mut bytes = vec![0; ps_state_byte_len(Some(state))];
        // SAFETY: as many bytes as said.
        let status = unsafe { ps_state_to_bytes(Some(state), bytes.as_mut_ptr(), bytes.len()) };
        assert_eq!(status, PsStatus::Ok);
        bytes
    };
    let before = written(&state);
    // SAFETY: as many bytes as said.
    let read = unsafe { ps_state_from_bytes(Some(&mut state), Some(&other), before.as_ptr(), before.len()) };
    failed(read, PsStatus::OtherSkeleton, "skeleton");
    assert_eq!(written(&state), before);
}

#[test]
fn states_of_garbage_are_refused() {
    let pack = pack();
    let mut state = ps_state_new(Some(&pack)).unwrap();
    let garbage = vec![0xab; ps_state_byte_len(Some(&state))];
    // SAFETY: as many bytes as said.
    let read = unsafe { ps_state_from_bytes(Some(&mut state), Some(&pack), garbage.as_ptr(), garbage.len()) };
    failed(read, PsStatus::BadState, "version");
    let mut controller = controller(&pack);
    assert_eq!(ps_controller_restore(Some(&mut controller), Some(&state)), PsStatus::Ok, "a new state");
}
