//! From pointers to references and slices: null pointers and counts are checked here.

use std::ffi::{CStr, c_char};

use policy_core::Skeleton;

use crate::error::{PsStatus, fail};

/// What a pointer leads to.
pub(crate) fn present<T>(what: &str, pointer: Option<T>) -> Result<T, PsStatus> {
    pointer.ok_or_else(|| fail(PsStatus::NullPointer, format_args!("expected {what}, found a null pointer")))
}

/// An array of exactly `expected` entries that is read.
///
/// # Safety
/// `pointer` is null, or aligned and valid for reads of `count` entries while the slice lives.
pub(crate) unsafe fn input<'a, T>(
    what: &str,
    pointer: *const T,
    count: usize,
    expected: usize,
) -> Result<&'a [T], PsStatus> {
    if count != expected {
        let text = format_args!("expected {expected} {what}, found {count}");
        return Err(fail(PsStatus::WrongCount, text));
    }
    if count == 0 {
        return Ok(&[]);
    }
    check_pointer(what, pointer)?;
    // SAFETY: not null; the caller promises the rest. What a skeleton or pack expects does not exceed memory.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Room for entries that are written, and nothing else yet: it may be an array that is read before that.
#[derive(Clone, Copy)]
pub(crate) struct Room<T> {
    pointer: *mut T,
    needed: usize,
}

impl<T> Room<T> {
    /// The first `needed` entries of an array with room for at least so many.
    pub(crate) fn checked(
        what: &str,
        pointer: *mut T,
        capacity: usize,
        needed: usize,
    ) -> Result<Self, PsStatus> {
        if capacity < needed {
            let text = format_args!("expected room for {needed} {what}, found {capacity}");
            return Err(fail(PsStatus::WrongCount, text));
        }
        if needed > 0 {
            check_pointer(what, pointer)?;
        }
        Ok(Self { pointer, needed })
    }

    /// The entries, to be written.
    ///
    /// # Safety
    /// `pointer` is valid for writes of `capacity` entries while the slice lives, unless no entry is needed, and nothing else that lives
    /// leads there: slices of [`input`] are read before.
    pub(crate) unsafe fn slice<'a>(self) -> &'a mut [std::mem::MaybeUninit<T>] {
        if self.needed == 0 {
            return &mut [];
        }
        // SAFETY: not null; the caller promises the rest, and `needed` is at most what is there. Nothing is read of it.
        unsafe { std::slice::from_raw_parts_mut(self.pointer.cast(), self.needed) }
    }
}

/// An array with room for at least `needed` entries that is written at once: the first `needed` of them.
///
/// # Safety
/// That of [`Room::slice`].
pub(crate) unsafe fn output<'a, T>(
    what: &str,
    pointer: *mut T,
    capacity: usize,
    needed: usize,
) -> Result<&'a mut [std::mem::MaybeUninit<T>], PsStatus> {
    // SAFETY: the caller's promise is passed on.
    Room::checked(what, pointer, capacity, needed).map(|room| unsafe { room.slice() })
}

/// A text that ends with a zero.
///
/// # Safety
/// `pointer` is null or leads to bytes that end with a zero and don't change while the text lives.
pub(crate) unsafe fn text<'a>(what: &str, pointer: *const c_char) -> Result<&'a str, PsStatus> {
    check_pointer(what, pointer)?;
    // SAFETY: not null; the caller promises the rest.
    let bytes = unsafe { CStr::from_ptr(pointer) };
    bytes.to_str().map_err(|_| fail(PsStatus::BadName, format_args!("expected UTF-8 in {what}")))
}

fn check_pointer<T>(what: &str, pointer: *const T) -> Result<(), PsStatus> {
    if pointer.is_null() {
        return Err(fail(PsStatus::NullPointer, format_args!("expected {what}, found a null pointer")));
    }
    if !pointer.is_aligned() {
        let expected = align_of::<T>();
        let text = format_args!("expected {what} at a multiple of {expected} bytes, found {pointer:p}");
        return Err(fail(PsStatus::NullPointer, text));
    }
    Ok(())
}

/// An index from outside into a list of `count` things.
pub(crate) fn index(what: &str, index: i32, count: usize) -> Result<usize, PsStatus> {
    let within = usize::try_from(index).ok().filter(|i| *i < count);
    within.ok_or_else(|| {
        fail(PsStatus::BadIndex, format_args!("expected the index of a {what} below {count}, found {index}"))
    })
}

/// A finite number from outside.
pub(crate) fn finite(what: &str, number: f32) -> Result<f32, PsStatus> {
    if number.is_finite() {
        return Ok(number);
    }
    Err(fail(PsStatus::BadNumber, format_args!("expected a finite number for {what}, found {number}")))
}

/// Refuses a pack or state that is for another skeleton.
pub(crate) fn same_skeleton(ours: &Skeleton, other: &Skeleton) -> Result<(), PsStatus> {
    if std::ptr::eq(ours, other) || ours == other {
        return Ok(());
    }
    let (joints, bodies) = (ours.joint_count(), ours.body_count());
    let (other_joints, other_bodies) = (other.joint_count(), other.body_count());
    Err(fail(
        PsStatus::OtherSkeleton,
        format_args!(
            "expected the controller's skeleton ({bodies} bodies, {joints} joints), found another \
             ({other_bodies} bodies, {other_joints} joints)"
        ),
    ))
}

/// An id as C has it.
pub(crate) fn id(index: usize) -> i32 {
    i32::try_from(index).expect("a pack has fewer than 65,536 parts")
}
