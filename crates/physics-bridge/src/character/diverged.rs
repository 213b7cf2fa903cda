//! Why a step was undone.

use policy_core::BodyId;

use super::replay_file::ReplayFile;
use crate::cause::{Cause, Excess};
use crate::description::file::quoted;

/// The simulation of a character diverged. The character is back in its state before the tick.
#[derive(Debug, thiserror::Error)]
#[error(
    "simulation diverged in tick {tick}, substep {substep}: expected plausible motion, found {cause}{}",
    self.details()
)]
#[non_exhaustive]
pub struct Diverged {
    /// Control ticks that the character had completed.
    pub tick: u64,
    /// Substep of the tick in which it was found, from 0.
    pub substep: u32,
    /// What was wrong.
    pub cause: Cause,
    /// The first body with that fault; `None` when it belongs to no body.
    pub body: Option<BodyId>,
    /// Value and limit; `None` for MuJoCo's own checks, which do not tell the value.
    pub excess: Option<Excess>,
    /// The state before the tick, to be saved and replayed.
    pub replay: Box<ReplayFile>,
}

impl Diverged {
    fn details(&self) -> String {
        let name = |body| quoted(&self.replay.skeleton().body(body).name);
        let body = self.body.map_or_else(String::new, |body| format!(", body {}", name(body)));
        let unit = self.cause.unit();
        let excess = self.excess.map_or_else(String::new, |Excess { value, limit }| {
            format!(", {value}{unit} where at most {limit}{unit} is plausible")
        });
        body + &excess
    }
}
