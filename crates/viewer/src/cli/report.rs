//! What a run without a window says in the end.

use serde::Serialize;

use crate::sim::{SharedWorld, Simulation};
use crate::text::counted;
use playground::RaceState;

/// The report, as written to the file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Simulated time.
    pub seconds: f64,
    /// The signal that ended the run before its time.
    pub ended_by: Option<&'static str>,
    /// What stood on the floor.
    pub scene: &'static str,
    /// Number of characters.
    pub characters: usize,
    /// Physics engine.
    pub physics: &'static str,
    /// Blend mode.
    pub mode: &'static str,
    /// Ground.
    pub terrain: &'static str,
    /// Seed.
    pub seed: u32,
    /// Share of the ticks in which a character neither lay nor got up.
    pub upright_fraction: f64,
    /// Way of the root body seen from above, mean over the characters.
    pub distance_m: f64,
    /// Falls of all characters.
    pub falls: u64,
    /// What happens to a character that fell.
    pub after_a_fall: String,
    /// Times a character was stood up because it could not get up by itself.
    pub stood_up: u64,
    /// Times the physics diverged; each time the character was stood up.
    pub diverged: usize,
    /// Replay files with the states before the first ten divergences.
    pub replays: Vec<String>,
    /// Distance over time.
    pub mean_speed_mps: f64,
    /// Ticks of all characters for each second on the clock, drawing not counted.
    pub control_ticks_per_second: f64,
    /// Time of one controller's tick, mean.
    pub policy_microseconds_per_tick: f64,
    /// Each blend mode of a comparison; empty without one.
    pub comparison: Vec<Compared>,
    /// The player's run over the course, where there is one.
    pub race: Option<RaceReport>,
    /// Over all positions and velocities: equal runs have equal hashes.
    pub state_hash: String,
    /// Pictures written.
    pub frames: usize,
    /// What drew them.
    pub adapter: Option<String>,
}

/// What became of one blend mode in a comparison.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Compared {
    /// Its name.
    pub mode: &'static str,
    /// Falls of its character.
    pub falls: u32,
}

impl Compared {
    /// All modes that a world compares.
    #[must_use]
    pub fn of(sim: &Simulation) -> Vec<Self> {
        let characters = if sim.config().comparison { sim.characters() } else { &[] };
        characters.iter().map(|c| Self { mode: c.blend_mode().name(), falls: c.falls() }).collect()
    }
}

/// How far the player came on the course.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RaceReport {
    /// Checkpoints of the course.
    pub checkpoints: usize,
    /// Those that the last run passed.
    pub passed: usize,
    /// True when the run has ended.
    pub finished: bool,
    /// Time on the clock.
    pub seconds: f32,
    /// Falls during the run.
    pub falls: u32,
}

impl RaceReport {
    /// Of a world with a course.
    #[must_use]
    pub fn of(shared: &SharedWorld, tick_secs: f32) -> Self {
        let (race, checkpoints) = (shared.race(), shared.scene().checkpoints.len());
        let finished = race.state() == RaceState::Finished;
        Self {
            checkpoints,
            passed: if finished { checkpoints } else { race.next() },
            finished,
            seconds: race.secs(tick_secs),
            falls: race.falls(),
        }
    }
}

impl Report {
    /// The report in one line.
    #[must_use]
    pub fn summary(&self) -> String {
        format!(
            "{:.1} s, {}: upright {:.1} %, {:.2} m, {}, {:.2} m/s, state {}",
            self.seconds,
            counted(self.characters as u64, "character"),
            100.0 * self.upright_fraction,
            self.distance_m,
            counted(self.falls, "fall"),
            self.mean_speed_mps,
            self.state_hash,
        )
    }
}
