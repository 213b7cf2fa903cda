//! The interface as an engine uses it: describing a pack, ticks, reports, saving.

mod common;

use std::ffi::{CStr, CString};
use std::mem::MaybeUninit;
use std::sync::Arc;

use common::{Body, DT, JOINTS, MJCF, controller, last_error, load, old_bytes, pack, tick, walking};
use policy_core::glam::Vec2;
use policy_core::{CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal};
use policy_space::*;

fn written<T>(write: impl FnOnce(&mut MaybeUninit<T>) -> PsStatus) -> T {
    let mut slot = MaybeUninit::zeroed();
    assert_eq!(write(&mut slot), PsStatus::Ok, "{}", last_error());
    // SAFETY: the function succeeded, so it has written.
    unsafe { slot.assume_init() }
}

fn report(controller: &PsController) -> PsReport {
    written(|slot| ps_controller_report(Some(controller), Some(slot)))
}

fn name(pack: &PsPack, part: PsPart, index: i32) -> &str {
    let name = ps_pack_name(Some(pack), part as i32, index);
    assert!(!name.is_null(), "{}", last_error());
    // SAFETY: a name of a pack ends with a zero and lives as long as the pack.
    unsafe { CStr::from_ptr(name) }.to_str().unwrap()
}

#[test]
fn a_pack_describes_itself() {
    let pack = pack();
    let info = written(|slot| ps_pack_info(Some(&pack), Some(slot)));
    assert_eq!((info.body_count, info.joint_count, info.policy_input_len), (15, 28, 225));
    assert_eq!((info.control_hz, info.physics_hz, info.mass_kg), (30.0, 120.0, 48.9));
    assert_eq!(ps_pack_count(Some(&pack), PsPart::Node as i32), 2);
    assert_eq!((name(&pack, PsPart::Body, 2), name(&pack, PsPart::Node, 1)), ("head", "walk"));
    assert_eq!(name(&pack, PsPart::Joint, 0), "abdomen_x");
    assert_eq!((ps_pack_parent(Some(&pack), 0), ps_pack_parent(Some(&pack), 2)), (PS_NONE, 1));
    let stance = CString::new("stance").unwrap();
    // SAFETY: a C string.
    let path = unsafe { ps_pack_find(Some(&pack), PsPart::Path as i32, stance.as_ptr()) };
    assert_eq!((path, ps_pack_path_len(Some(&pack), path)), (1, 2));
    let mut nodes = [7; 3];
    // SAFETY: room for three.
    assert_eq!(unsafe { ps_pack_path_nodes(Some(&pack), path, nodes.as_mut_ptr(), 3) }, PsStatus::Ok);
    assert_eq!(nodes, [0, 1, 7]);
    let joint = written(|slot| ps_pack_joint(Some(&pack), 0, Some(slot)));
    assert_eq!((joint.body, joint.axis), (1, [1.0, 0.0, 0.0]));
    assert!(joint.range[0] < 0.0 && joint.action_gain > 0.0);
    let motors = written(|slot: &mut MaybeUninit<[PsMotor; JOINTS]>| {
        // SAFETY: room for all joints.
        unsafe { ps_pack_motors(Some(&pack), slot.as_mut_ptr().cast(), JOINTS) }
    });
    assert_eq!(motors[5], PsMotor { gain: 5.0, damping: 2.0, force_limit: 3.0, armature: 0.5 });
    let node = written(|slot| ps_pack_node(Some(&pack), 1, Some(slot)));
    assert!(node.fall_height.is_nan() || node.fall_height > 0.0);
    assert_eq!(ps_pack_recovery(Some(&pack)), PS_NONE);
    // SAFETY: text of the pack.
    assert_eq!(unsafe { CStr::from_ptr(ps_pack_mjcf(Some(&pack))) }.to_str(), Ok(MJCF));
    let mut len = 0;
    assert!(!ps_pack_mesh(Some(&pack), Some(&mut len)).is_null());
    assert_eq!(len, 3);
}

#[test]
fn an_old_pack_lacks_motors_and_mjcf() {
    let pack = load(old_bytes());
    assert!(ps_pack_mjcf(Some(&pack)).is_null());
    assert_eq!(ps_last_status(), PsStatus::Absent);
    // SAFETY: no room, and none is needed to fail.
    assert_eq!(unsafe { ps_pack_motors(Some(&pack), std::ptr::null_mut(), 0) }, PsStatus::Absent);
    assert!(last_error().contains("motor"), "{}", last_error());
    assert_eq!(written(|slot| ps_pack_info(Some(&pack), Some(slot))).physics_hz, 0.0);
}

#[test]
fn ticks_give_the_bits_of_the_core() {
    let pack = pack();
    let mut ours = controller(&pack);
    let core = Arc::new(CharacterPack::from_bytes(&common::bytes()).unwrap());
    let mut theirs = Controller::new(Arc::clone(&core));
    let mut state = CharacterState::new(core.skeleton());
    let (mut body, mut targets) = (Body::standing(), [0.0; JOINTS]);
    let command = Command {
        target: Some(Vec2::new(5.0, 0.5)),
        goal: Goal::Path { path: policy_core::PathId::new(0), coordinate: 0.7 },
        ..Command::default()
    };
    for i in 0..40 {
        body.bodies[4].position[0] = 0.01 * i as f32;
        body.velocities[3] = 0.1 * i as f32;
        for (to, from) in state.bodies.iter_mut().zip(&body.bodies) {
            to.position = from.position.into();
            to.rotation = policy_core::glam::Quat::from_array(from.rotation);
        }
        state.joint_velocities.copy_from_slice(&body.velocities);
        assert_eq!(tick(&mut ours, &body, &walking(), &mut targets), PsStatus::Ok);
        assert_eq!(theirs.tick(&state, &command, DT)[..], targets);
    }
    let report = report(&ours);
    assert_eq!((report.position.from_node, report.position.to_node), (0, 1));
    assert!((report.position.t - 0.7).abs() < 1e-6 && report.blend_count == 2, "{report:?}");
    assert_eq!(report.evaluation, PsEvaluation::Cached as i32);
    assert_eq!((report.skill, report.fault, report.off_rate), (PS_NONE, 0, 0));
}

#[test]
fn two_halves_make_a_tick() {
    let pack = pack();
    let (mut whole, mut halves) = (controller(&pack), controller(&pack));
    let body = Body::standing();
    let (mut expected, mut found, mut input) = ([0.0; JOINTS], [0.0; JOINTS], [0.0; 225]);
    let core = CharacterPack::from_bytes(&common::bytes()).unwrap();
    let still = PsCommand { goal: PsGoal::Stay as i32, ..walking() };
    tick(&mut whole, &body, &still, &mut expected);
    let sensed = body.sensed();
    // SAFETY: room for all inputs.
    let prepared = unsafe {
        ps_controller_prepare(Some(&mut halves), Some(&sensed), Some(&still), DT, input.as_mut_ptr(), 225)
    };
    assert_eq!(prepared, PsStatus::Ok);
    let mut action = [0.0; JOINTS];
    let policy = &core.policies()[0];
    let mut scratch = policy_core::MlpScratch::for_mlp(policy);
    policy.evaluate_into(policy_core::Arithmetic::Reproducible, &input, &mut scratch, &mut action);
    // SAFETY: as many numbers as said.
    let accepted = unsafe {
        ps_controller_accept(Some(&mut halves), action.as_ptr(), JOINTS, found.as_mut_ptr(), JOINTS)
    };
    assert_eq!(accepted, PsStatus::Ok);
    assert_eq!(found, expected);
    let in_place = action.as_mut_ptr();
    // SAFETY: as many numbers as said.
    let accepted = unsafe { ps_controller_accept(Some(&mut halves), in_place, JOINTS, in_place, JOINTS) };
    assert_eq!((accepted, action), (PsStatus::Ok, expected), "the action may be in the array of the targets");
}

#[test]
fn a_restored_controller_repeats_its_bits() {
    let pack = pack();
    let (mut first, mut second) = (controller(&pack), controller(&pack));
    let (body, mut targets) = (Body::standing(), [0.0; JOINTS]);
    let mut state = ps_state_new(Some(&pack)).unwrap();
    for _ in 0..10 {
        tick(&mut first, &body, &walking(), &mut targets);
    }
    assert_eq!(ps_controller_save(Some(&first), Some(&mut state)), PsStatus::Ok);
    let mut bytes = vec![0u8; ps_state_byte_len(Some(&state))];
    // SAFETY: as many bytes as said.
    let saved = unsafe { ps_state_to_bytes(Some(&state), bytes.as_mut_ptr(), bytes.len()) };
    let mut sent = ps_state_new(Some(&pack)).unwrap();
    // SAFETY: as many bytes as said.
    let read = unsafe { ps_state_from_bytes(Some(&mut sent), Some(&pack), bytes.as_ptr(), bytes.len()) };
    assert_eq!((saved, read), (PsStatus::Ok, PsStatus::Ok), "{}", last_error());
    assert_eq!(ps_controller_restore(Some(&mut second), Some(&sent)), PsStatus::Ok);
    let mut again = [0.0; JOINTS];
    for _ in 0..10 {
        tick(&mut first, &body, &walking(), &mut targets);
        tick(&mut second, &body, &walking(), &mut again);
        assert_eq!(targets, again);
    }
}

#[test]
fn a_controller_outlives_its_pack_and_goes_on_with_another() {
    let old = pack();
    let mut controller = controller(&old);
    ps_pack_free(Some(old));
    let (body, mut targets) = (Body::standing(), [0.0; JOINTS]);
    for _ in 0..30 {
        tick(&mut controller, &body, &walking(), &mut targets);
    }
    let position = report(&controller).position;
    assert_eq!(ps_controller_set_pack(Some(&mut controller), Some(&pack())), PsStatus::Ok);
    assert_eq!(report(&controller).position, position);
    assert_eq!(tick(&mut controller, &body, &walking(), &mut targets), PsStatus::Ok);
    assert_eq!(ps_controller_place_at(Some(&mut controller), 1, 1, 0.0), PsStatus::Ok);
    assert_eq!(report(&controller).position.from_node, 1);
    assert_eq!(ps_controller_reset(Some(&mut controller)), PsStatus::Ok);
    assert_eq!(report(&controller).position.from_node, 0);
    ps_controller_free(Some(controller));
}

#[test]
fn the_choices_reach_the_controller() {
    let pack = pack();
    let mut config = written(|slot| ps_config_default(Some(slot)));
    let usual = ControllerConfig::default();
    assert_eq!((config.auto_recover != 0, config.start_node), (usual.auto_recover, 0));
    assert_eq!(config.turn_assist != 0, usual.turn_assist.is_some());
    assert_eq!(config.steering != 0, usual.steering.is_some());
    (config.start_node, config.blend_mode) = (1, PsBlendMode::Switch as i32);
    let mut controller = ps_controller_new(Some(&pack), Some(&config)).unwrap();
    assert_eq!(report(&controller).position.from_node, 1);
    let (body, mut targets) = (Body::standing(), [0.0; JOINTS]);
    tick(&mut controller, &body, &walking(), &mut targets);
    let blends = |c: &PsController| report(c).blend_count;
    assert_eq!(blends(&controller), 1);
    assert_eq!(ps_controller_set_blend_mode(Some(&mut controller), 0), PsStatus::Ok);
    for _ in 0..10 {
        tick(&mut controller, &body, &walking(), &mut targets);
    }
    assert_eq!(blends(&controller), 2);
    let term = PsBlendTerm { policy: 1, weights: [0.5, 0.25, 1.0, 0.0] };
    let manual = PsCommand { blend: &raw const term, blend_count: 1, ..walking() };
    assert_eq!(tick(&mut controller, &body, &manual, &mut targets), PsStatus::Ok);
    assert_eq!((blends(&controller), report(&controller).blend[0]), (1, term));
    assert_eq!(ps_controller_cancel_skill(Some(&mut controller)), PS_NONE);
}
