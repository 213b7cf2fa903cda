//! One control tick of physics.

use std::sync::OnceLock;
use std::time::Instant;

use glam::Quat;
use mujoco_rs::wrappers::mj_data::MjtTimer;
use policy_core::Heading;

use super::World;
use super::contact;
use super::ray::footing_below;
use super::recover::Standing;
use crate::description::body_poses::rotation;
use crate::kinematics::sense_into;

/// How often a tick is begun anew before it is left out.
const ROUNDS: u32 = 12;

/// Time that a world spent in the stages of MuJoCo, seconds since it was built. All zero unless
/// [`measure_stages`](crate::measure_stages) was called before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageTimes {
    /// Physics steps.
    pub steps: u64,
    /// Places of the bodies, and what acts on them.
    pub kinematics: f64,
    /// Inertia.
    pub inertia: f64,
    /// Finding contacts.
    pub collision: f64,
    /// Setting up constraints.
    pub constraints: f64,
    /// Velocities and what follows from them.
    pub velocity: f64,
    /// Motors.
    pub actuation: f64,
    /// Solving the constraints.
    pub solver: f64,
    /// Integrating.
    pub advance: f64,
    /// All of it.
    pub total: f64,
}

/// Lets MuJoCo measure the time of its stages, in all worlds of the process, from now on. Costs about a microsecond a
/// step. Call it before the program starts threads.
pub fn measure_stages() {
    extern "C" fn now() -> f64 {
        static START: OnceLock<Instant> = OnceLock::new();
        START.get_or_init(Instant::now).elapsed().as_secs_f64()
    }
    // SAFETY: a global of MuJoCo is written, which no other thread reads meanwhile, as the documentation demands.
    unsafe { mujoco_rs::mujoco_c::mjcb_time = Some(now) };
}

impl World {
    /// Runs one control tick of physics. Returns how many things diverged; [`World::divergences`] tells which. Does
    /// not allocate.
    ///
    /// Something that diverges again and again is taken out. If the tick can't be saved even so, it is left out:
    /// everything stays as it was, but for what was put back.
    pub fn step(&mut self) -> usize {
        self.divergences.clear();
        self.divergences.append(&mut self.waiting);
        for round in 0..ROUNDS {
            if round > 0 {
                self.return_to_start();
                self.find_first_culprits();
                self.remedy(round - 1);
                self.data.step1();
            } else if std::mem::take(&mut self.is_touched) && self.accuse_implausible() {
                self.remedy(0);
                self.data.step1();
            }
            self.note_start();
            if self.run_substeps(false) {
                self.tick += 1;
                break;
            }
        }
        if !self.culprits.is_empty() {
            self.return_to_start();
            self.culprits.clear();
            self.data.step1();
        }
        self.note_standing();
        self.record();
        self.divergences.len()
    }

    /// Of several culprits, most may just have met the first. Repeats the tick, which is at its start, to find it, and
    /// returns to the start.
    fn find_first_culprits(&mut self) {
        if self.culprits.len() < 2 {
            return;
        }
        self.culprits.clear();
        if !self.accuse_warned() {
            self.data.step1();
            self.run_substeps(true);
            self.return_to_start();
        }
    }

    /// The substeps of a tick. False when something diverged; the culprits are then known. Motion beyond the limits is
    /// looked for at the end of the tick, or also after every substep.
    fn run_substeps(&mut self, every_substep: bool) -> bool {
        let substeps = self.ground.substeps();
        for substep in 0..substeps {
            self.forces.apply(&mut self.data);
            // The two halves of `mj_step`, turned round, so that everything derived from the state is up to date
            // when the tick ends.
            self.data.step2();
            // Bad numbers are found before anything is derived from them.
            if self.accuse_warned() {
                return false;
            }
            if substep + 1 == substeps {
                contact::collect(&self.data, &self.places, &self.scene, &mut self.contacts);
                self.rest_absent();
            }
            self.data.step1();
            if self.accuse_warned() {
                return false;
            }
            if (every_substep || substep + 1 == substeps) && self.accuse_implausible() {
                return false;
            }
        }
        true
    }

    /// Notes the state at the start of the tick.
    fn note_start(&mut self) {
        if let Some(mut before) = self.before.take() {
            before.record(self);
            self.before = Some(before);
        }
    }

    /// Returns to the state at the start of the tick, with nothing derived from it.
    fn return_to_start(&mut self) {
        if let Some(before) = self.before.take() {
            self.load_state(&before);
            self.before = Some(before);
        }
    }

    /// Notes where the characters are well, and the ground below them.
    fn note_standing(&mut self) {
        for (index, _) in self.scene.characters.present() {
            let root = self.places.character(index).layout.body_ids[0];
            let world_from_root: Quat = rotation(self.data.xquat()[root]);
            let place = self.data.xpos()[root].map(|number| number as f32);
            let heading = Heading::from_rotation(world_from_root).angle();
            self.standing[index] = Standing { place, heading };
        }
        self.note_ground();
    }

    /// Notes how high the ground is below each character and ahead of its legs. A ray begins at the height of the root.
    pub(super) fn note_ground(&mut self) {
        for (index, model) in self.scene.characters.present() {
            let state = &mut self.grounds[index];
            sense_into(&self.data, &self.places.character(index).layout, state);
            let (z, top) = (state.root().position.z, state.step_top(model.skeleton()));
            state.sense_ground(model.skeleton(), |at| {
                let parts = (&self.places, &self.scene);
                footing_below(&mut self.data, parts, &self.ground, [at.x, at.y, z], top)
            });
        }
    }

    /// Where the time went since the world was built.
    #[must_use]
    pub fn stage_times(&self) -> StageTimes {
        let time = |timer: MjtTimer| self.data.timer()[timer as usize].duration;
        StageTimes {
            steps: u64::try_from(self.data.timer()[MjtTimer::mjTIMER_ADVANCE as usize].number).unwrap_or(0),
            kinematics: time(MjtTimer::mjTIMER_POS_KINEMATICS),
            inertia: time(MjtTimer::mjTIMER_POS_INERTIA),
            collision: time(MjtTimer::mjTIMER_POS_COLLISION),
            constraints: time(MjtTimer::mjTIMER_POS_MAKE) + time(MjtTimer::mjTIMER_POS_PROJECT),
            velocity: time(MjtTimer::mjTIMER_VELOCITY),
            actuation: time(MjtTimer::mjTIMER_ACTUATION),
            solver: time(MjtTimer::mjTIMER_CONSTRAINT),
            advance: time(MjtTimer::mjTIMER_ADVANCE),
            total: time(MjtTimer::mjTIMER_STEP),
        }
    }
}
