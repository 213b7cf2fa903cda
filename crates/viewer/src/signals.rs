//! Signals that ask the program to end: the demo finishes its tick, writes what it owes and leaves. The same signal
//! once more ends it at once.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

#[cfg(unix)]
use signal_hook::consts::SIGHUP;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// The signals, each with its name.
const SIGNALS: &[(i32, &str)] = &[
    (SIGINT, "SIGINT"),
    (SIGTERM, "SIGTERM"),
    #[cfg(unix)]
    (SIGHUP, "SIGHUP"),
];

/// Number of the signal that came last, 0 before any.
static RECEIVED: OnceLock<Arc<AtomicUsize>> = OnceLock::new();

/// From now on signals are noted instead of ending the program.
///
/// # Errors
/// When the system takes no handler.
pub fn watch() -> io::Result<()> {
    let received = RECEIVED.get_or_init(Arc::default);
    let second = Arc::new(AtomicBool::new(false));
    for &(signal, _) in SIGNALS {
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&second))?;
        flag::register(signal, Arc::clone(&second))?;
        flag::register_usize(signal, Arc::clone(received), signal as usize)?;
    }
    Ok(())
}

/// The signal that has asked the program to end, if any has.
#[must_use]
pub fn received() -> Option<Signal> {
    let number = RECEIVED.get()?.load(Ordering::Relaxed);
    SIGNALS
        .iter()
        .find(|(signal, _)| *signal as usize == number)
        .map(|&(number, name)| Signal { number, name })
}

/// A signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    /// Its number.
    pub number: i32,
    /// Its name, such as `SIGINT`.
    pub name: &'static str,
}

impl Signal {
    /// The exit status of a program that ended because of it.
    #[must_use]
    pub fn exit_status(self) -> u8 {
        // Signals are numbered from 1 to 64.
        (128 + self.number) as u8
    }
}
