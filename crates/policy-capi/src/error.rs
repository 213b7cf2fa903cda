//! What went wrong: a status, a text for the calling thread, and the end of every panic.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, c_char};
use std::fmt::{Arguments, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How a call ended.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsStatus {
    /// It did what it says.
    Ok = 0,
    /// A pointer is null where there must be something.
    NullPointer = 1,
    /// An array has too few entries, or another number of entries than the skeleton asks for.
    WrongCount = 2,
    /// A number is not finite or out of its range, or a quaternion is not of length 1.
    BadNumber = 3,
    /// There is no body, joint, node, path, skill or kind of that index.
    BadIndex = 4,
    /// A text is not UTF-8, or no part of the pack has that name.
    BadName = 5,
    /// The file can't be read.
    File = 6,
    /// The bytes are no pack, or the pack is damaged.
    BadPack = 7,
    /// The pack or state is for another skeleton.
    OtherSkeleton = 8,
    /// The state is none of this pack.
    BadState = 9,
    /// The pack does not have it: packs of version 1 have no motors and no MJCF.
    Absent = 10,
    /// The library has a bug. Free the handles of the call and go on without them.
    Panic = 11,
}

impl PsStatus {
    const fn name(self) -> &'static CStr {
        match self {
            PsStatus::Ok => c"ok",
            PsStatus::NullPointer => c"null pointer",
            PsStatus::WrongCount => c"wrong count",
            PsStatus::BadNumber => c"bad number",
            PsStatus::BadIndex => c"bad index",
            PsStatus::BadName => c"bad name",
            PsStatus::File => c"unreadable file",
            PsStatus::BadPack => c"bad pack",
            PsStatus::OtherSkeleton => c"other skeleton",
            PsStatus::BadState => c"bad state",
            PsStatus::Absent => c"absent from the pack",
            PsStatus::Panic => c"bug in the library",
        }
    }

    const ALL: [PsStatus; 12] = [
        PsStatus::Ok,
        PsStatus::NullPointer,
        PsStatus::WrongCount,
        PsStatus::BadNumber,
        PsStatus::BadIndex,
        PsStatus::BadName,
        PsStatus::File,
        PsStatus::BadPack,
        PsStatus::OtherSkeleton,
        PsStatus::BadState,
        PsStatus::Absent,
        PsStatus::Panic,
    ];
}

/// Bytes of the longest text, its closing zero included.
const TEXT_LEN: usize = 512;

/// The last failure of a thread. A fixed buffer, so that failing does not allocate.
struct LastError {
    status: PsStatus,
    text: [u8; TEXT_LEN],
    len: usize,
}

impl Write for LastError {
    /// Appends what fits; a text that is too long is cut off between two characters.
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for character in text.chars() {
            let mut utf8 = [0; 4];
            let bytes = match character {
                '\0' => "?".as_bytes(), // would end the text
                other => other.encode_utf8(&mut utf8).as_bytes(),
            };
            let end = self.len + bytes.len();
            if end >= TEXT_LEN {
                return Err(std::fmt::Error);
            }
            self.text[self.len..end].copy_from_slice(bytes);
            self.len = end;
        }
        Ok(())
    }
}

thread_local! {
    static LAST: RefCell<LastError> =
        const { RefCell::new(LastError { status: PsStatus::Ok, text: [0; TEXT_LEN], len: 0 }) };
}

/// Keeps status and text of a failure for the calling thread and returns the status.
pub(crate) fn fail(status: PsStatus, text: Arguments<'_>) -> PsStatus {
    LAST.with_borrow_mut(|last| {
        (last.status, last.len) = (status, 0);
        // A text that was cut off is still a text.
        let _ = last.write_fmt(text);
        last.text[last.len] = 0;
    });
    status
}

/// Runs the body of a function. Its failures and panics become a status.
pub(crate) fn guard(work: impl FnOnce() -> Result<(), PsStatus>) -> PsStatus {
    match guarded(work) {
        Ok(()) => PsStatus::Ok,
        Err(status) => status,
    }
}

/// Runs the body of a function that returns a value; `failed` is the value of a failure.
pub(crate) fn guard_or<T>(failed: T, work: impl FnOnce() -> Result<T, PsStatus>) -> T {
    guarded(work).unwrap_or(failed)
}

fn guarded<T>(work: impl FnOnce() -> Result<T, PsStatus>) -> Result<T, PsStatus> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| {
        let status = fail(PsStatus::Panic, format_args!("bug in the library: {}", message(&*payload)));
        // Dropping a payload runs code that may panic itself.
        std::mem::forget(payload);
        Err(status)
    })
}

fn message(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<&str>().copied();
    text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("a panic without a text")
}

/// Why the last call of this thread failed, in English and UTF-8: what was expected and what was found. Empty when no
/// call of this thread has failed; a call that succeeds leaves it as it is. Valid until the next failure in this thread.
#[unsafe(no_mangle)]
pub extern "C" fn ps_last_error() -> *const c_char {
    LAST.with_borrow(|last| last.text.as_ptr().cast())
}

/// Status of the last call of this thread that failed, for functions that return no status.
#[unsafe(no_mangle)]
pub extern "C" fn ps_last_status() -> PsStatus {
    LAST.with_borrow(|last| last.status)
}

/// A few words for a status, such as "null pointer". Never null.
#[unsafe(no_mangle)]
pub extern "C" fn ps_status_name(status: i32) -> *const c_char {
    let known = PsStatus::ALL.iter().find(|s| **s as i32 == status);
    known.map_or(c"unknown status", |s| s.name()).as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last_text() -> String {
        LAST.with_borrow(|last| String::from_utf8(last.text[..last.len].to_vec()).unwrap())
    }

    /// As the exported functions are made.
    extern "C" fn panics() -> PsStatus {
        guard(|| panic!("the sky fell at {}", 3))
    }

    #[test]
    fn a_panic_ends_at_the_border() {
        assert_eq!(panics(), PsStatus::Panic);
        assert_eq!(last_text(), "bug in the library: the sky fell at 3");
        assert_eq!(ps_last_status(), PsStatus::Panic);
        let with_odd_payload = guard(|| std::panic::panic_any(17));
        assert_eq!(with_odd_payload, PsStatus::Panic);
        assert!(last_text().ends_with("a panic without a text"));
    }

    #[test]
    fn a_long_text_is_cut_off_between_characters() {
        fail(PsStatus::File, format_args!("{}", "ä".repeat(TEXT_LEN)));
        let text = last_text();
        assert!(text.len() >= TEXT_LEN - 3 && text.chars().all(|c| c == 'ä'), "{text}");
        fail(PsStatus::File, format_args!("a\0b"));
        assert_eq!(last_text(), "a?b");
    }

    #[test]
    fn each_thread_has_a_text_of_its_own() {
        fail(PsStatus::File, format_args!("here"));
        let there = std::thread::spawn(|| (ps_last_status(), last_text())).join().unwrap();
        assert_eq!(there, (PsStatus::Ok, String::new()));
        assert_eq!(last_text(), "here");
    }

    #[test]
    fn statuses_have_names_and_numbers_of_their_own() {
        for (index, status) in PsStatus::ALL.iter().enumerate() {
            assert_eq!(*status as usize, index);
        }
    }
}
