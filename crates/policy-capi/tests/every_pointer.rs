//! Every function of the header, with a null pointer in the place of each of its pointers, and with arrays that are short.

mod common;

use std::collections::BTreeSet;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use common::{Body, DT, JOINTS, controller, last_error, load, old_bytes, pack, tick, walking};
use policy_space::*;

/// Functions without a pointer, and those that take a null pointer: what is freed may be null.
const OTHERS: [&str; 8] = [
    "ps_abi_version",
    "ps_config_default",
    "ps_controller_free",
    "ps_last_error",
    "ps_last_status",
    "ps_pack_free",
    "ps_state_free",
    "ps_status_name",
];

/// Names the functions that were called with null pointers.
#[derive(Default)]
struct Called(BTreeSet<&'static str>);

impl Called {
    /// The call that was just made found a null pointer, and said so.
    #[track_caller]
    fn found_null<T>(&mut self, name: &'static str, _returned: T) {
        assert_eq!(ps_last_status(), PsStatus::NullPointer, "{name}: {}", last_error());
        assert!(last_error().contains("found a null pointer"), "{name}: {}", last_error());
        self.0.insert(name);
        // The next success or failure starts from another status.
        ps_controller_set_blend_mode(None, 99);
        assert!(ps_pack_name(Some(&pack()), 99, 0).is_null());
        assert_eq!(ps_last_status(), PsStatus::BadIndex);
    }
}

#[test]
fn every_function_refuses_every_null_pointer() {
    let (pack, body, mut called) = (pack(), Body::standing(), Called::default());
    let (mut made, mut state) = (controller(&pack), ps_state_new(Some(&pack)).unwrap());
    let (sensed, command, mut numbers) = (body.sensed(), walking(), [0.0; 512]);
    let (out, room) = (numbers.as_mut_ptr(), numbers.len());
    // SAFETY: null, or slices with their lengths.
    unsafe {
        called.found_null("ps_pack_from_bytes", ps_pack_from_bytes(null(), 3).is_none());
        called.found_null("ps_pack_from_file", ps_pack_from_file(null()).is_none());
        called.found_null("ps_pack_find", ps_pack_find(None, 0, c"walk".as_ptr()));
        called.found_null("ps_pack_find", ps_pack_find(Some(&pack), 0, null()));
        called.found_null("ps_pack_motors", ps_pack_motors(None, null_mut(), JOINTS));
        called.found_null("ps_pack_motors", ps_pack_motors(Some(&pack), null_mut(), JOINTS));
        called.found_null("ps_pack_path_nodes", ps_pack_path_nodes(None, 0, null_mut(), 9));
        called.found_null("ps_pack_path_nodes", ps_pack_path_nodes(Some(&pack), 0, null_mut(), 9));
        for halves in [ps_controller_tick, ps_controller_prepare] {
            let name = if halves as *const () == ps_controller_tick as *const () {
                "ps_controller_tick"
            } else {
                "ps_controller_prepare"
            };
            called.found_null(name, halves(None, Some(&sensed), Some(&command), DT, out, room));
            called.found_null(name, halves(Some(&mut made), None, Some(&command), DT, out, room));
            called.found_null(name, halves(Some(&mut made), Some(&sensed), None, DT, out, room));
            called.found_null(
                name,
                halves(Some(&mut made), Some(&sensed), Some(&command), DT, null_mut(), room),
            );
            let parts =
                [PsSensed { bodies: null(), ..sensed }, PsSensed { joint_velocities: null(), ..sensed }];
            for part in &parts {
                called.found_null(name, halves(Some(&mut made), Some(part), Some(&command), DT, out, room));
            }
            let blend = PsCommand { blend: null(), blend_count: 1, ..command };
            called.found_null(name, halves(Some(&mut made), Some(&sensed), Some(&blend), DT, out, room));
        }
        let action = [0.0; JOINTS];
        let accept = ps_controller_accept;
        called.found_null("ps_controller_accept", accept(None, action.as_ptr(), JOINTS, out, room));
        called.found_null("ps_controller_accept", accept(Some(&mut made), null(), JOINTS, out, room));
        let no_room = accept(Some(&mut made), action.as_ptr(), JOINTS, null_mut(), room);
        called.found_null("ps_controller_accept", no_room);
        called.found_null("ps_state_to_bytes", ps_state_to_bytes(None, null_mut(), 0));
        called.found_null("ps_state_to_bytes", ps_state_to_bytes(Some(&state), null_mut(), 1 << 20));
        let len = ps_state_byte_len(Some(&state));
        called.found_null("ps_state_from_bytes", ps_state_from_bytes(None, Some(&pack), null(), len));
        called.found_null("ps_state_from_bytes", ps_state_from_bytes(Some(&mut state), None, null(), len));
        let read = ps_state_from_bytes(Some(&mut state), Some(&pack), null(), len);
        called.found_null("ps_state_from_bytes", read);
    }
    called.found_null("ps_pack_count", ps_pack_count(None, 0));
    called.found_null("ps_pack_name", ps_pack_name(None, 0, 0));
    called.found_null("ps_pack_character", ps_pack_character(None));
    called.found_null("ps_pack_mjcf", ps_pack_mjcf(None));
    called.found_null("ps_pack_mesh", ps_pack_mesh(None, Some(&mut 0)));
    called.found_null("ps_pack_mesh", ps_pack_mesh(Some(&pack), None));
    called.found_null("ps_pack_info", ps_pack_info(None, Some(&mut MaybeUninit::uninit())));
    called.found_null("ps_pack_info", ps_pack_info(Some(&pack), None));
    called.found_null("ps_pack_parent", ps_pack_parent(None, 0));
    called.found_null("ps_pack_ground_lookahead_secs", ps_pack_ground_lookahead_secs(None, 0) < 0.0);
    called.found_null("ps_pack_joint", ps_pack_joint(None, 0, Some(&mut MaybeUninit::uninit())));
    called.found_null("ps_pack_joint", ps_pack_joint(Some(&pack), 0, None));
    called.found_null("ps_pack_node", ps_pack_node(None, 0, Some(&mut MaybeUninit::uninit())));
    called.found_null("ps_pack_node", ps_pack_node(Some(&pack), 0, None));
    called.found_null("ps_pack_path_len", ps_pack_path_len(None, 0));
    called.found_null("ps_pack_recovery", ps_pack_recovery(None));
    called.found_null("ps_controller_new", ps_controller_new(None, None).is_none());
    called.found_null("ps_controller_reset", ps_controller_reset(None));
    called.found_null("ps_controller_place_at", ps_controller_place_at(None, 0, 0, 0.0));
    called.found_null("ps_controller_set_blend_mode", ps_controller_set_blend_mode(None, 0));
    called.found_null("ps_controller_cancel_skill", ps_controller_cancel_skill(None));
    called.found_null("ps_controller_set_pack", ps_controller_set_pack(None, Some(&pack)));
    called.found_null("ps_controller_set_pack", ps_controller_set_pack(Some(&mut made), None));
    called.found_null("ps_controller_report", ps_controller_report(None, Some(&mut MaybeUninit::uninit())));
    called.found_null("ps_controller_report", ps_controller_report(Some(&made), None));
    called.found_null("ps_controller_save", ps_controller_save(None, Some(&mut state)));
    called.found_null("ps_controller_save", ps_controller_save(Some(&made), None));
    called.found_null("ps_controller_restore", ps_controller_restore(None, Some(&state)));
    called.found_null("ps_controller_restore", ps_controller_restore(Some(&mut made), None));
    called.found_null("ps_state_new", ps_state_new(None).is_none());
    called.found_null("ps_state_byte_len", ps_state_byte_len(None));

    // Nothing was lost: the controller does what a new one does.
    let (mut other, mut targets, mut expected) = (controller(&pack), [0.0; JOINTS], [1.0; JOINTS]);
    for _ in 0..3 {
        assert_eq!(tick(&mut made, &body, &command, &mut targets), PsStatus::Ok, "{}", last_error());
        assert_eq!(tick(&mut other, &body, &command, &mut expected), PsStatus::Ok);
        assert_eq!(targets, expected);
    }

    // A function that the header gains comes here too.
    let header = include_str!("../include/policy_space.h");
    let words = header.split(|c: char| !c.is_ascii_alphanumeric() && c != '_' && c != '(');
    let names = words.filter_map(|word| word.strip_prefix("ps_")?.split_once('('));
    let declared: BTreeSet<String> = names.map(|(name, _)| format!("ps_{name}")).collect();
    assert!(declared.len() > 30, "{declared:?}");
    for name in &declared {
        let is_known = called.0.contains(name.as_str()) || OTHERS.contains(&name.as_str());
        assert!(is_known, "{name} was not called with null pointers");
    }
}

#[test]
fn short_arrays_are_errors_in_every_function() {
    let (pack, body) = (pack(), Body::standing());
    let mut made = controller(&pack);
    let (sensed, command, mut out) = (body.sensed(), walking(), [7.0; JOINTS]);
    let wrong_count = |status: PsStatus, part: &str| {
        assert_eq!(status, PsStatus::WrongCount, "{}", last_error());
        assert!(last_error().contains(part), "{:?} does not say {part:?}", last_error());
    };
    // SAFETY: as many entries as said.
    unsafe {
        let prepared = ps_controller_prepare(
            Some(&mut made),
            Some(&sensed),
            Some(&command),
            DT,
            out.as_mut_ptr(),
            JOINTS,
        );
        wrong_count(prepared, "inputs of a policy, found 28");
        let (action, made) = ([0.0; JOINTS], &mut made);
        let accept = ps_controller_accept;
        wrong_count(
            accept(Some(made), action.as_ptr(), 27, out.as_mut_ptr(), JOINTS),
            "28 numbers of an action",
        );
        wrong_count(accept(Some(made), action.as_ptr(), JOINTS, out.as_mut_ptr(), 27), "28 joint targets");
        let mut motors = [PsMotor::default(); 3];
        wrong_count(ps_pack_motors(Some(&pack), motors.as_mut_ptr(), 3), "28 motors, found 3");
        assert_eq!(motors, [PsMotor::default(); 3]);
    }
    assert_eq!(out, [7.0; JOINTS], "nothing was written");
}

#[test]
fn an_action_and_a_ground_that_are_not_finite() {
    let (pack, mut body) = (pack(), Body::standing());
    let (mut made, mut sound) = (controller(&pack), controller(&pack));
    let (mut targets, mut expected) = ([7.0; JOINTS], [7.0; JOINTS]);
    let mut action = [0.0; JOINTS];
    action[3] = f32::NAN;
    action[5] = f32::INFINITY;
    // SAFETY: as many entries as said.
    unsafe {
        let accept = ps_controller_accept;
        let status = accept(Some(&mut made), action.as_ptr(), JOINTS, targets.as_mut_ptr(), JOINTS);
        assert_eq!(status, PsStatus::Ok, "they count as 0");
        let zero = [0.0; JOINTS];
        accept(Some(&mut sound), zero.as_ptr(), JOINTS, expected.as_mut_ptr(), JOINTS);
    }
    assert_eq!(targets, expected);

    let sensed = PsSensed { ground_height: f32::NAN, ..body.sensed() };
    // SAFETY: as many entries as said.
    let status = unsafe {
        let out = targets.as_mut_ptr();
        ps_controller_tick(Some(&mut made), Some(&sensed), Some(&walking()), DT, out, JOINTS)
    };
    assert_eq!(status, PsStatus::BadNumber);
    assert!(last_error().contains("ground_height"), "{}", last_error());
    let mut heights = [0.0; 15];
    heights[14] = f32::INFINITY;
    let sensed = PsSensed { ground_heights: heights.as_ptr(), ..body.sensed() };
    // SAFETY: as many entries as said.
    let status = unsafe {
        let out = targets.as_mut_ptr();
        ps_controller_tick(Some(&mut made), Some(&sensed), Some(&walking()), DT, out, JOINTS)
    };
    assert_eq!(status, PsStatus::BadNumber);
    assert!(last_error().contains("ground_heights for body \"left_foot\""), "{}", last_error());
    body.velocities[4] = f32::NEG_INFINITY;
    assert_eq!(tick(&mut made, &body, &walking(), &mut targets), PsStatus::BadNumber);
    assert_eq!(tick(&mut made, &Body::standing(), &walking(), &mut targets), PsStatus::Ok);
}

#[test]
fn a_state_of_another_pack_is_refused() {
    let (pack, old) = (pack(), load(old_bytes()));
    let state = ps_state_new(Some(&old)).unwrap();
    let mut controller = controller(&pack);
    let restored = ps_controller_restore(Some(&mut controller), Some(&state));
    // The same skeleton and graph: a state of either fits.
    assert_eq!(restored, PsStatus::Ok, "{}", last_error());
    let mut bytes = vec![0; ps_state_byte_len(Some(&state))];
    let mut read = ps_state_new(Some(&pack)).unwrap();
    // SAFETY: as many bytes as said.
    unsafe {
        assert_eq!(ps_state_to_bytes(Some(&state), bytes.as_mut_ptr(), bytes.len()), PsStatus::Ok);
        let middle = bytes.len() / 2;
        bytes[middle..].fill(0xff);
        let status = ps_state_from_bytes(Some(&mut read), Some(&pack), bytes.as_ptr(), bytes.len());
        assert_eq!(status, PsStatus::BadState, "{}", last_error());
    }
    assert_eq!(ps_controller_restore(Some(&mut controller), Some(&read)), PsStatus::Ok, "that of a new one");
}
