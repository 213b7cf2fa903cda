//! Where episodes start: in clips, in other clips, or limp on the ground.

use physics_bridge::{Pose, Terrain, WALKING_START_MPS};
use policy_core::{Heading, JointTargets};

use super::super::demonstrations::StartPose;
use super::super::population::Stage;
use super::{Agent, Imitated, own_clips};
use crate::clip::placed;

/// Characters on a terrain start this near to its middle, metres along each axis.
const TERRAIN_HALF_METRES: f32 = 25.0;

/// Ticks of an episode that starts before a failure, at most: what it is about comes first.
const MISHAP_TICKS: u32 = 120;

/// Draws of a start state until one is none that fails at once; the last one is taken as it is.
const START_TRIES: usize = 4;

impl Agent {
    /// Chooses where the next episode starts: on flat ground at the origin, on a terrain anywhere near its middle.
    pub(super) fn choose_place(&mut self) {
        if self.character.model().terrain() != Terrain::Flat {
            let half = f64::from(TERRAIN_HALF_METRES);
            let mut along = || half * f64::from(self.rng.range(-1.0, 1.0));
            self.place = (along(), along());
        }
    }

    /// Goes back to a moment before an earlier failure; false when there is none.
    pub(super) fn start_before_failure(&mut self, stage: &Stage<'_>) -> bool {
        let Some(past) = self.mishaps.take(&mut self.rng) else { return false };
        self.character.restore(&past.snapshot).expect("a snapshot of the same character");
        self.character.sense_into(&mut self.state);
        (self.history, self.command) = (past.history, past.command);
        (self.imitated, self.imitator) = (None, false);
        self.born_at = self.born_at.max(stage.config.episode_ticks.saturating_sub(MISHAP_TICKS));
        self.age = self.born_at;
        true
    }

    /// Starts out of clips, or limp from there.
    pub(super) fn start_in_clips(&mut self, stage: &Stage<'_>, limp: bool) {
        for _ in 0..START_TRIES {
            let start = self.draw_start(stage);
            if limp {
                self.drop_limp(stage, &start);
            } else {
                self.start_from(&start);
            }
            if !self.has_fallen(stage) {
                break;
            }
        }
    }

    /// A start state out of other clips, those of any node, those around the place on the course, or the last node's.
    pub(super) fn draw_start(&mut self, stage: &Stage<'_>) -> StartPose {
        let start = &stage.config.start;
        let nodes = stage.demonstrations.len();
        let node = match stage.start_demonstrations {
            Some(other) if self.rng.chance(start.other) => {
                let clips = own_clips(stage);
                let beginning = clips.draw_beginning(&mut self.rng);
                self.imitated = Some(Imitated::into_clips(nodes - 1, beginning, clips));
                return other.draw_start(&mut self.rng);
            }
            _ if self.rng.chance(start.anywhere) => self.rng.index(nodes),
            _ if start.along => {
                let [from, to] = stage.course.edges()[self.command.place.edge];
                if self.rng.chance(self.command.place.t) { to } else { from }
            }
            _ => nodes - 1,
        };
        let start = stage.demonstrations[node].draw_start(&mut self.rng);
        self.imitated = (self.imitator || node == nodes - 1).then(|| Imitated::at_once(node, start.moment));
        start
    }

    /// Sets the character down in a random heading, lifted until nothing is in the ground.
    fn start_from(&mut self, start: &StartPose) {
        let (x, y) = self.place;
        let mut pose = placed(&start.pose, x, y, f64::from(self.rng.angle()));
        pose.qpos[2] += f64::from(self.character.model().height_at(x as f32, y as f32));
        self.set(&pose);
        let clearance = self.character.clearance();
        if clearance < 0.0 {
            pose.qpos[2] -= f64::from(clearance);
            self.set(&pose);
        }
        self.character.sense_into(&mut self.state);
        self.history.clear();
        for frame in start.frames.iter() {
            *self.history.push() = *frame;
        }
    }

    /// Stands the character up in a random heading, going that way at up to a walk's speed.
    pub(super) fn launch(&mut self, stage: &Stage<'_>) {
        let (x, y) = (self.place.0 as f32, self.place.1 as f32);
        let heading = Heading::from_angle(self.rng.angle());
        let speed = self.rng.range(0.0, WALKING_START_MPS);
        self.character.stand_at(x, y, heading, speed).expect("a place and a speed that are finite");
        self.character.sense_into(&mut self.state);
        self.history.clear();
        self.push_frame(stage);
    }

    fn set(&mut self, pose: &Pose) {
        self.character.set_pose(&pose.qpos, &pose.qvel).expect("a clip's pose was tried when it was fitted");
    }

    /// Drops the character in a random attitude with loose joints and lets it come to rest for a while.
    pub(super) fn drop_limp(&mut self, stage: &Stage<'_>, start: &StartPose) {
        let mut pose = placed(&start.pose, self.place.0, self.place.1, 0.0);
        let turn = glam::Quat::from_euler(
            glam::EulerRot::ZYX,
            self.rng.angle(),
            self.rng.range(-1.6, 1.6),
            self.rng.angle(),
        );
        pose.qpos[2] =
            0.7 + f64::from(self.character.model().height_at(self.place.0 as f32, self.place.1 as f32));
        pose.qpos[3..7].copy_from_slice(&[turn.w, turn.x, turn.y, turn.z].map(f64::from));
        pose.qvel.fill(0.0);
        if self.character.set_pose(&pose.qpos, &pose.qvel).is_err() {
            return self.start_from(start);
        }
        self.history.clear();
        let ticks = 12 + self.rng.index(24);
        for _ in 0..ticks {
            self.character.sense_into(&mut self.state);
            self.push_frame(stage);
            self.go_limp();
            if self.character.step().is_err() {
                return self.start_from(start);
            }
        }
        self.character.sense_into(&mut self.state);
        self.push_frame(stage);
    }

    /// Targets that follow the joints: nearly no torque but the joints' damping.
    fn go_limp(&mut self) {
        let pose = self.character.pose();
        let mut targets = JointTargets::default();
        for (target, angle) in targets.0.iter_mut().zip(&pose.qpos[7..]) {
            *target = *angle as f32;
        }
        self.character.actuate(&targets);
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::{Quat, Vec3};
    use physics_bridge::Model;
    use policy_core::{BODY_COUNT, Body};

    use super::super::super::config::{EnvironmentConfig, Start};
    use super::super::super::course::{Course, CourseNode};
    use super::super::super::demonstrations::Demonstrations;
    use super::super::super::normalisers::Normalisers;
    use super::*;
    use crate::Rng;
    use crate::clip::tests::still;

    #[test]
    fn who_is_launched_stands_upright_and_goes_where_he_looks() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
        let model = Model::load(path).unwrap();
        let mut tilted = still(30);
        tilted.local_rotations = vec![[Quat::from_rotation_x(0.3); BODY_COUNT]; 30];
        let normalisers = Normalisers::from_clips(std::slice::from_ref(&tilted), &model).unwrap();
        let clips = Demonstrations::from_clips(&[(tilted, 1.0, false)], &model, &normalisers.frame).unwrap();
        let start = Start { launched: 1.0, ..Start::default() };
        let config = EnvironmentConfig { imitation: 0.5, start, ..EnvironmentConfig::default() };
        let stage = Stage {
            config: &config,
            course: &Course::new(vec![CourseNode::new("walk", &config, 1.0)], vec![vec![0]]),
            demonstrations: &[&clips],
            start_demonstrations: None,
            recovery: None,
            normalisers: &normalisers,
        };
        let mut agent = Agent::new(&model, Rng::new(5, 0));
        let mut speeds = Vec::new();
        for _ in 0..20 {
            agent.reset(&stage, false);
            let pelvis = *agent.state.body(Body::Pelvis);
            assert!((pelvis.rotation * Vec3::Z).z > 0.999 && agent.state.height_of(Body::Pelvis) > 0.8);
            let along = pelvis.linear_velocity.truncate().dot(agent.heading().direction());
            assert!((along - pelvis.linear_velocity.length()).abs() < 1e-4, "{:?}", pelvis.linear_velocity);
            assert!(!agent.imitates(), "a clip that it did not start in");
            speeds.push(along);
        }
        let most = speeds.iter().copied().fold(0.0, f32::max);
        assert!(most <= WALKING_START_MPS && most > 0.7 * WALKING_START_MPS, "{speeds:?}");
        assert!(speeds.iter().any(|speed| *speed < 0.3 * WALKING_START_MPS), "{speeds:?}");
    }
}
