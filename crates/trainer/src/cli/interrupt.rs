//! Signals that stop a training: it saves first. A second signal ends the program at once.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, Result};
use signal_hook::consts::{SIGINT, SIGTERM};

/// A signal that was caught.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Signal(i32);

impl Signal {
    /// Name, as `SIGINT`.
    pub(crate) fn name(self) -> &'static str {
        KNOWN.iter().find(|(number, _)| *number == self.0).map_or("a signal", |(_, name)| name)
    }

    /// 128 and the signal's number: 130 for SIGINT, 143 for SIGTERM, 129 for SIGHUP.
    pub(crate) fn exit_code(self) -> ExitCode {
        ExitCode::from(u8::try_from(128 + self.0).unwrap_or(u8::MAX))
    }
}

#[cfg(unix)]
const KNOWN: &[(i32, &str)] =
    &[(SIGINT, "SIGINT"), (SIGTERM, "SIGTERM"), (signal_hook::consts::SIGHUP, "SIGHUP")];
#[cfg(not(unix))]
const KNOWN: &[(i32, &str)] = &[(SIGINT, "SIGINT"), (SIGTERM, "SIGTERM")];

/// Remembers the first signal.
#[derive(Debug)]
pub(crate) struct Interrupt(Vec<(Signal, Arc<AtomicBool>)>);

impl Interrupt {
    /// Catches SIGINT, SIGTERM and SIGHUP from now on.
    ///
    /// # Errors
    /// When the system refuses a handler.
    pub(crate) fn listen() -> Result<Self> {
        let any = Arc::new(AtomicBool::new(false));
        let mut caught = Vec::new();
        for (number, name) in KNOWN {
            let this = Arc::new(AtomicBool::new(false));
            let registered =
                signal_hook::flag::register_conditional_shutdown(*number, 128 + number, any.clone())
                    .and_then(|_| signal_hook::flag::register(*number, any.clone()))
                    .and_then(|_| signal_hook::flag::register(*number, this.clone()));
            registered.with_context(|| format!("cannot catch {name}"))?;
            caught.push((Signal(*number), this));
        }
        Ok(Self(caught))
    }

    /// The signal that came, if one did.
    pub(crate) fn caught(&self) -> Option<Signal> {
        self.0.iter().find(|(_, flag)| flag.load(Ordering::Relaxed)).map(|(signal, _)| *signal)
    }
}
