//! Owns MuJoCo's log handler. MuJoCo's own writes to the console and to a file in the working folder; this
//! one drops warnings, because the counters that go with them become [`Diverged`](crate::Diverged) errors.

use std::sync::Once;

use mujoco_rs::logging::set_log_handler;
use mujoco_rs::wrappers::mj_logging::{MjLogMessage, MjtLogLevel, log_config, set_log_config};

static INSTALLED: Once = Once::new();

/// Installs the handler, once in the life of the process. Every way to a model passes through here before
/// it touches MuJoCo.
pub(crate) fn install() {
    INSTALLED.call_once(|| {
        // SAFETY: both calls write globals of MuJoCo, which no other thread may read meanwhile. This crate
        // reaches MuJoCo only through a `Model`, each constructor of which waits here for the `Once`. A
        // program that also uses mujoco-rs by itself loads its first `Model` before it starts threads;
        // the crate root says so.
        unsafe {
            set_log_handler(handle);
            set_log_config(log_config().with_topics(0).with_logto_file(false).with_logto_console(false));
        }
    });
}

/// An error is MuJoCo's last word: the process ends after it, so it is the one message that is printed.
fn handle(message: &MjLogMessage) {
    if message.level() == MjtLogLevel::mjLOG_ERROR {
        eprintln!("MuJoCo cannot go on: {}", message.subject());
    }
}
