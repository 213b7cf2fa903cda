//! Targets, and what is written to Rapier before each of its steps.

use rapier3d::dynamics::{
    IntegrationParameters, JointAxesMask, JointAxis, MultibodyJointSet, RigidBodySet, SpringCoefficients,
};
use rapier3d::math::{Pose as RapierPose, Vector};

use super::pose::unit;
use super::{Articulation, Drive, Removed};

/// A limit farther than this from the angle gets no row in the solver: radians, and seconds of the hinge's velocity.
///
/// Rapier solves a row with the whole mass matrix for every limit, and a limit acts only once the angle is beyond it.
const LIMIT_MARGIN: f32 = 0.1;
const LIMIT_MARGIN_SECS: f32 = 0.05;

/// Rapier's substeps in a step with [`Drive::Motors`]. With the four of Rapier's default characters fall more easily.
const MOTORS_SUBSTEPS: usize = 2;

/// Iterations of Rapier's projected Gauss-Seidel solver over the contacts in each substep. With one, legs that touch throw the character down: after
/// 27 % of rolls, against 2 % with four. Rapier takes two contacts of one multibody for independent.
const PGS_ITERATIONS: usize = 4;

/// Contacts with what is fixed, about as soft as MuJoCo's default ones: a foot that is pressed by 1,000 N gives 5.2 mm, in MuJoCo 5.5 mm, and 0.1 mm
/// with Rapier's default of 60 Hz and 10. With that default a crawl falls 3.6 times a minute.
const CONTACT_SOFTNESS: SpringCoefficients<f32> =
    SpringCoefficients { natural_frequency: 10.0, damping_ratio: 1.0 };

/// Shapes that are nearer than this make a contact, metres. With Rapier's default of 20 mm a foot that lands meets a rigid contact one
/// step before it touches, whatever [`CONTACT_SOFTNESS`] is, and a crouch falls once a minute on slopes of 7 degrees.
const PREDICTION_METRES: f32 = 0.0005;

impl Drive {
    /// Sets what a character needs of Rapier's solver: substeps, iterations over the contacts, from which distance on there are contacts, and how
    /// soft those with fixed bodies are, such as the ground. All else stays, `dt` included. They hold for everything in the game's world: a crate
    /// rests 2.5 mm deep in the ground, and three times as deep with two of its kind on it.
    pub fn tune(self, parameters: &mut IntegrationParameters) {
        parameters.num_solver_iterations = match self {
            Drive::Torques => 1,
            Drive::Motors => MOTORS_SUBSTEPS,
        };
        parameters.num_internal_pgs_iterations = PGS_ITERATIONS;
        parameters.static_contact_softness = CONTACT_SOFTNESS;
        parameters.normalized_prediction_distance = PREDICTION_METRES;
    }
}

impl Articulation {
    /// Sets the angles that the motors pull the joints to, radians, in the order of the skeleton. They act from the
    /// next [`Articulation::before_step`] on. Joints without a finite target keep theirs; targets without a joint
    /// are ignored.
    pub fn actuate(&mut self, targets: &[f32]) {
        for (own, &target) in self.targets.iter_mut().zip(targets) {
            if target.is_finite() {
                *own = target;
            }
        }
    }

    /// Writes torques, or motor targets, to Rapier. Call it before each physics step; with [`Drive::Motors`] once
    /// after each [`Articulation::actuate`] suffices. Replaces the forces and torques that act on the bodies of the
    /// character. Makes the root's rotation a unit quaternion again when it has drifted: Rapier never does, and a
    /// character that turns slowly would stretch without bound. Allocates nothing of its own.
    ///
    /// # Errors
    /// When the game removed a body or joint of the character.
    pub fn before_step(
        &mut self,
        bodies: &mut RigidBodySet,
        joints: &mut MultibodyJointSet,
    ) -> Result<(), Removed> {
        self.multibody(joints)?;
        let root = self.bodies[0];
        let body = bodies.get_mut(root).ok_or_else(|| self.removed_body(root))?;
        let place = *body.position();
        let rotation = unit(place.rotation);
        if rotation != place.rotation {
            body.set_position(RapierPose::from_parts(place.translation, rotation), false);
        }
        let (multibody, _) = joints.get_mut(self.joint).expect("looked up above");
        match self.drive {
            Drive::Motors => {
                for (hinge, &target) in self.hinges.iter().zip(&self.targets) {
                    let link = multibody.link_mut(hinge.link).expect("looked up above");
                    link.joint.data.motors[JointAxis::AngX as usize].target_pos = target;
                }
                self.torques.fill(Vector::ZERO);
            }
            Drive::Torques => {
                self.torques.fill(Vector::ZERO);
                for (index, (hinge, motor)) in self.hinges.iter().zip(self.model.motors()).enumerate() {
                    let speed = multibody.generalized_velocity()[hinge.dof].abs();
                    let link = multibody.link_mut(hinge.link).expect("looked up above");
                    let angle = link.joint.coords()[JointAxis::AngX as usize];
                    let limits = link.joint.data.limits[JointAxis::AngX as usize];
                    let margin = LIMIT_MARGIN + LIMIT_MARGIN_SECS * speed;
                    let near = angle < limits.min + margin || angle > limits.max - margin;
                    link.joint.data.limit_axes.set(JointAxesMask::ANG_X, near);
                    let torque = motor.gain * (self.targets[index] - angle);
                    let torque = torque.clamp(-motor.force_limit, motor.force_limit);
                    let torque = link.local_to_world().rotation * hinge.axis * torque;
                    self.torques[hinge.child] += torque;
                    self.torques[hinge.parent] -= torque;
                }
            }
        }
        for (&link, &torque) in self.links.iter().zip(&self.torques) {
            let body = bodies.get_mut(link).ok_or_else(|| self.removed_body(link))?;
            body.reset_forces(false);
            body.reset_torques(false);
            body.add_torque(torque, false);
        }
        Ok(())
    }
}
