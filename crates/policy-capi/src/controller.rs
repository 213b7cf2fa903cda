//! The controller behind a handle: the control tick.

use std::sync::Arc;

use policy_core::training::MAX_NODES;
use policy_core::{CharacterState, Controller, GraphPosition, JointTargets, NodeId};

use crate::PS_NONE;
use crate::border::{Room, finite, id, index, input, present};
use crate::command::PsCommand;
use crate::config::{PsConfig, blend_mode};
use crate::error::{PsStatus, fail, guard, guard_or};
use crate::pack::PsPack;
use crate::sensed::{PsSensed, check};

/// Steers one character.
pub struct PsController {
    pub(crate) controller: Controller,
    sensed: CharacterState,
}

/// A controller at its start node. `config` may be NULL for the usual choices. Allocates. NULL on failure.
#[unsafe(no_mangle)]
pub extern "C" fn ps_controller_new(
    pack: Option<&PsPack>,
    config: Option<&PsConfig>,
) -> Option<Box<PsController>> {
    guard_or(None, || {
        let pack = &present("a pack", pack)?.pack;
        let config = config.copied().unwrap_or_default().checked(pack)?;
        let controller = Controller::with_config(Arc::clone(pack), config);
        let sensed = CharacterState::new(pack.skeleton());
        Ok(Some(Box::new(PsController { controller, sensed })))
    })
}

/// Frees a controller.
#[unsafe(no_mangle)]
pub extern "C" fn ps_controller_free(controller: Option<Box<PsController>>) {
    guard_or((), || {
        drop(controller);
        Ok(())
    });
}

/// One control tick: from what the character senses and what the game asks to joint targets in radians, one for each hinge.
///
/// `dt_secs` is the time since the last tick, usually 1 / control_hz; at most 0.25 s of it count. `capacity` is the number of
/// entries that `targets` has room for. A bad number in `sensed` is PS_STATUS_BAD_NUMBER; the targets are then those of a
/// zero action and nothing else has changed but the report. With any other error nothing has changed. Does not allocate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ps_controller_tick(
    controller: Option<&mut PsController>,
    sensed: Option<&PsSensed>,
    command: Option<&PsCommand>,
    dt_secs: f32,
    targets: *mut f32,
    capacity: usize,
) -> PsStatus {
    guard(|| {
        let PsController { controller, sensed: state } = present("a controller", controller)?;
        let (sensed, command) = (present("what is sensed", sensed)?, present("a command", command)?);
        let joints = state.joint_velocities.len();
        let targets = Room::checked("joint targets", targets, capacity, joints)?;
        let pack = Arc::clone(controller.pack());
        // SAFETY: the contract of every function.
        let command = unsafe { command.checked(&pack) }?;
        let dt_secs = elapsed(dt_secs)?;
        // SAFETY: the contract of every function.
        unsafe { sensed.copy_into(pack.skeleton(), state) }?;
        let sound = check(pack.skeleton(), state).inspect_err(|_| state.ground_height = f32::NAN);
        let computed: &JointTargets = controller.tick(state, &command, dt_secs);
        // SAFETY: the contract of every function. All arrays that it reads were read before.
        write(computed, unsafe { targets.slice() });
        sound
    })
}

/// The first half of a tick, for an engine that evaluates policies itself: writes the inputs of the policy, normalised, and
/// sets the blend of the report. Call ps_controller_accept with the action. `capacity` is the number of entries that `input`
/// has room for, at least PsPackInfo.policy_input_len. Errors are those of ps_controller_tick; the input is then not
/// written. Does not allocate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ps_controller_prepare(
    controller: Option<&mut PsController>,
    sensed: Option<&PsSensed>,
    command: Option<&PsCommand>,
    dt_secs: f32,
    input: *mut f32,
    capacity: usize,
) -> PsStatus {
    guard(|| {
        let PsController { controller, sensed: state } = present("a controller", controller)?;
        let (sensed, command) = (present("what is sensed", sensed)?, present("a command", command)?);
        let pack = Arc::clone(controller.pack());
        let skeleton = pack.skeleton();
        let input = Room::checked("inputs of a policy", input, capacity, skeleton.policy_input_len())?;
        // SAFETY: the contract of every function.
        let command = unsafe { command.checked(&pack) }?;
        let dt_secs = elapsed(dt_secs)?;
        // SAFETY: the contract of every function.
        unsafe { sensed.copy_into(skeleton, state) }?;
        let sound = check(skeleton, state).inspect_err(|_| state.ground_height = f32::NAN);
        if controller.prepare(state, &command, dt_secs) {
            // SAFETY: the contract of every function. All arrays that it reads were read before.
            write(controller.policy_input(), unsafe { input.slice() });
        }
        sound
    })
}

/// The second half of a tick: from the action of the policy, one number for each hinge, to joint targets in radians. Numbers
/// that are not finite count as 0. `targets` may be the array of `action`. Does not allocate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ps_controller_accept(
    controller: Option<&mut PsController>,
    action: *const f32,
    action_count: usize,
    targets: *mut f32,
    capacity: usize,
) -> PsStatus {
    guard(|| {
        let PsController { controller, sensed } = present("a controller", controller)?;
        let joints = sensed.joint_velocities.len();
        // SAFETY: the contract of every function.
        let action = unsafe { input("numbers of an action", action, action_count, joints) }?;
        let targets = Room::checked("joint targets", targets, capacity, joints)?;
        let computed: &JointTargets = controller.accept(action);
        // SAFETY: the contract of every function. The action, which may be in the same array, was read before.
        write(computed, unsafe { targets.slice() });
        Ok(())
    })
}

/// Back to the start node, as after the character was put elsewhere. Does not allocate.
#[unsafe(no_mangle)]
pub extern "C" fn ps_controller_reset(controller: Option<&mut PsController>) -> PsStatus {
    guard(|| {
        present("a controller", controller)?.controller.reset();
        Ok(())
    })
}

/// Puts the controller at a position on the graph at once: `t` in [0, 1] of the way from one node to another that is joined
/// to it, or the same node twice. Does not allocate.
#[unsafe(no_mangle)]
pub extern "C" fn ps_controller_place_at(
    controller: Option<&mut PsController>,
    from_node: i32,
    to_node: i32,
    t: f32,
) -> PsStatus {
    guard(|| {
        let controller = &mut present("a controller", controller)?.controller;
        let [from, to] = [from_node, to_node].map(|node| index("node", node, MAX_NODES));
        let position = GraphPosition { from: NodeId::new(from?), to: NodeId::new(to?), t };
        if controller.place_at(position) {
            return Ok(());
        }
        Err(fail(
            PsStatus::BadIndex,
            format_args!(
                "expected a position on the graph, found {t} of the way from node {from_node} to {to_node}"
            ),
        ))
    })
}

/// Sets how a blend becomes an action (PsBlendMode), from the next tick on.
#[unsafe(no_mangle)]
pub extern "C" fn ps_controller_set_blend_mode(controller: Option<&mut PsController>, mode: i32) -> PsStatus {
    guard(|| {
        let controller = &mut present("a controller", controller)?.controller;
        controller.set_blend_mode(blend_mode(mode)?);
        Ok(())
    })
}

/// Forgets a skill that was requested and has not started. Returns it, or PS_NONE.
#[unsafe(no_mangle)]
pub extern "C" fn ps_controller_cancel_skill(controller: Option<&mut PsController>) -> i32 {
    guard_or(PS_NONE, || {
        let cancelled = present("a controller", controller)?.controller.cancel_pending_skill();
        Ok(cancelled.map_or(PS_NONE, |skill| id(skill.index())))
    })
}

/// Goes on with another pack for the same skeleton, for hot reload. Position and skills are kept by their names. Allocates.
#[unsafe(no_mangle)]
pub extern "C" fn ps_controller_set_pack(
    controller: Option<&mut PsController>,
    pack: Option<&PsPack>,
) -> PsStatus {
    guard(|| {
        let (controller, pack) = (present("a controller", controller)?, present("a pack", pack)?);
        let swapped = controller.controller.set_pack(Arc::clone(&pack.pack));
        swapped.map_err(|e| fail(PsStatus::OtherSkeleton, format_args!("{e}")))
    })
}

fn elapsed(dt_secs: f32) -> Result<f32, PsStatus> {
    if finite("dt_secs", dt_secs)? < 0.0 {
        return Err(fail(
            PsStatus::BadNumber,
            format_args!("expected dt_secs of at least 0, found {dt_secs}"),
        ));
    }
    Ok(dt_secs)
}

fn write(from: &[f32], to: &mut [std::mem::MaybeUninit<f32>]) {
    for (slot, number) in to.iter_mut().zip(from) {
        slot.write(*number);
    }
}
