//! Back ends: the sources of devices and reports.

#[cfg(feature = "gilrs")]
mod gilrs;
#[cfg(feature = "hidapi")]
mod hid;

use std::time::Instant;

#[cfg(feature = "gilrs")]
pub use gilrs::GilrsBackend;
#[cfg(feature = "hidapi")]
pub use hid::HidBackend;

use crate::device::{DeviceEvent, DeviceKey};

/// A source of pads. No call waits: a back end that must wait uses a thread of its own.
pub trait PadBackend {
    /// Appends all events since the last call.
    fn poll_into(&mut self, events: &mut Vec<(Instant, DeviceEvent)>);

    /// Sends an output report to a device. Returns false when the device doesn't accept it.
    fn send(&mut self, key: DeviceKey, report: &[u8]) -> bool;
}

/// Why a back end can't start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BackendError {
    /// hidapi can't start.
    #[error("hidapi cannot start: {message}")]
    Hid {
        /// Its message.
        message: String,
    },
    /// gilrs can't start.
    #[error("gilrs cannot start: {message}")]
    Gilrs {
        /// Its message.
        message: String,
    },
    /// The system can't start a thread.
    #[error("cannot start a thread for reading pads: {0}")]
    Thread(std::io::Error),
}

impl From<std::io::Error> for BackendError {
    fn from(error: std::io::Error) -> Self {
        Self::Thread(error)
    }
}

/// A key that was not used before.
#[cfg(any(feature = "hidapi", feature = "gilrs"))]
fn new_key() -> DeviceKey {
    use std::sync::atomic::{AtomicU64, Ordering};
    static NEXT: AtomicU64 = AtomicU64::new(1);
    DeviceKey(NEXT.fetch_add(1, Ordering::Relaxed))
}
