//! The saved state of a controller: for rewinding, saved games and rollback.

use std::mem::MaybeUninit;
use std::sync::Arc;

use policy_core::{ControllerState, Skeleton};

use crate::border::{input, output, present, same_skeleton};
use crate::controller::PsController;
use crate::error::{PsStatus, fail, guard, guard_or};
use crate::pack::PsPack;

/// Everything that the next tick of a controller depends on. Make one, then save into it as often as you like.
pub struct PsState {
    state: ControllerState,
    skeleton: Arc<Skeleton>,
}

/// The state of a new controller. Allocates. NULL on failure.
#[unsafe(no_mangle)]
pub extern "C" fn ps_state_new(pack: Option<&PsPack>) -> Option<Box<PsState>> {
    guard_or(None, || {
        let pack = &present("a pack", pack)?.pack;
        let skeleton = Arc::clone(pack.skeleton());
        Ok(Some(Box::new(PsState { state: ControllerState::new(pack), skeleton })))
    })
}

/// Frees a state.
#[unsafe(no_mangle)]
pub extern "C" fn ps_state_free(state: Option<Box<PsState>>) {
    guard_or((), || {
        drop(state);
        Ok(())
    });
}

/// Saves a controller into a state of the same skeleton. Does not allocate.
#[unsafe(no_mangle)]
pub extern "C" fn ps_controller_save(
    controller: Option<&PsController>,
    state: Option<&mut PsState>,
) -> PsStatus {
    guard(|| {
        let (controller, state) = (present("a controller", controller)?, present("a state", state)?);
        same_skeleton(controller.controller.pack().skeleton(), &state.skeleton)?;
        controller.controller.save_into(&mut state.state);
        Ok(())
    })
}

/// Goes on from a saved state: the next ticks give the bits that they gave then. The state must be one of the controller's
/// pack. Does not allocate.
#[unsafe(no_mangle)]
pub extern "C" fn ps_controller_restore(
    controller: Option<&mut PsController>,
    state: Option<&PsState>,
) -> PsStatus {
    guard(|| {
        let (controller, state) = (present("a controller", controller)?, present("a state", state)?);
        same_skeleton(controller.controller.pack().skeleton(), &state.skeleton)?;
        let restored = controller.controller.restore(&state.state);
        restored.map_err(|e| fail(PsStatus::BadState, format_args!("{e}")))
    })
}

/// Bytes of a state: the same number for all states of a pack. 0 on failure.
#[unsafe(no_mangle)]
pub extern "C" fn ps_state_byte_len(state: Option<&PsState>) -> usize {
    guard_or(0, || Ok(present("a state", state)?.state.byte_len()))
}

/// Writes a state as bytes that are the same on every machine. `capacity` is the number of bytes that there is room for. Does
/// not allocate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ps_state_to_bytes(
    state: Option<&PsState>,
    bytes: *mut u8,
    capacity: usize,
) -> PsStatus {
    guard(|| {
        let state = &present("a state", state)?.state;
        // SAFETY: the contract of every function.
        let room = unsafe { output("bytes", bytes, capacity, state.byte_len()) }?;
        room.fill(MaybeUninit::new(0));
        // SAFETY: every byte was just written.
        state.write_bytes(unsafe { room.assume_init_mut() });
        Ok(())
    })
}

/// Reads a state from bytes that were written for the same pack. After PS_STATUS_BAD_STATE it is the state of a new
/// controller; after any other error it is unchanged. Does not allocate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ps_state_from_bytes(
    state: Option<&mut PsState>,
    pack: Option<&PsPack>,
    bytes: *const u8,
    len: usize,
) -> PsStatus {
    guard(|| {
        let (state, pack) = (present("a state", state)?, present("a pack", pack)?);
        same_skeleton(&state.skeleton, pack.pack.skeleton())?;
        // SAFETY: the contract of every function.
        let bytes = unsafe { input("bytes of a state", bytes, len, state.state.byte_len()) }?;
        let read = state.state.read_bytes(&pack.pack, bytes);
        read.map_err(|e| fail(PsStatus::BadState, format_args!("{e}")))
    })
}
