//! Bodies, colliders and joints of a character, put into a world.

use policy_core::BodyId;
use rapier3d::dynamics::{
    GenericJoint, GenericJointBuilder, JointAxesMask, JointAxis, MotorModel, RigidBodyActivation,
};
use rapier3d::geometry::InteractionGroups;
use rapier3d::math::Vector;
use rapier3d_mjcf::MjcfMultibodyOptions;

use super::{Articulation, Drive, Hinge, Sets};
use crate::model::Model;

/// Numbers of the root in the generalised velocities.
const ROOT_DOFS: usize = 6;

impl Articulation {
    /// Puts a character into a world, in the pose of its MJCF. Its colliders are in `groups`. They touch what the
    /// groups let them touch, other characters included. Of each other, those touch that do in MuJoCo by the `contype`
    /// and `conaffinity` of the MJCF: the legs of the humanoid.
    ///
    /// Pairs that do not touch are held apart by disabled impulse joints, which have no row in the solver. They leave
    /// with the character. Allocates.
    #[must_use]
    pub fn insert(model: &Model, world: &mut Sets<'_>, drive: Drive, groups: InteractionGroups) -> Self {
        let mut robot = model.robot().clone();
        for collider in robot.bodies.iter_mut().flat_map(|body| &mut body.colliders) {
            collider.set_collision_groups(groups);
        }
        let contacts = match model.apart() {
            Some(_) => MjcfMultibodyOptions::empty(),
            None => MjcfMultibodyOptions::DISABLE_SELF_CONTACTS,
        };
        let handles = robot.insert_using_multibody_joints(
            world.bodies,
            world.colliders,
            world.multibody_joints,
            world.impulse_joints,
            contacts,
        );
        let mut links = Vec::with_capacity(handles.bodies.len());
        for entry in handles.bodies.iter().flatten() {
            let body = &mut world.bodies[entry.body];
            // A sleeping link would ignore its motors.
            *body.activation_mut() = RigidBodyActivation::cannot_sleep();
            body.recompute_mass_properties_from_colliders(world.colliders);
            links.push(entry.body);
        }
        let body_at =
            |place: usize| handles.bodies[place].as_ref().expect("every body but the world is inserted").body;
        for &[one, other] in model.apart().into_iter().flatten() {
            world.impulse_joints.insert(body_at(one), body_at(other), no_contact(), false);
        }
        let places = model.places();
        let bodies: Vec<_> = places.bodies.iter().map(|&place| body_at(place)).collect();
        let joints: Vec<_> = places.joints.iter().map(|&place| &handles.joints[place]).collect();
        let joint = joints[0].joint.expect("the joints of an MJCF make a tree");

        let (multibody, _) = world.multibody_joints.get_mut(joint).expect("it was just inserted");
        // Only this tells the multibody that its root floats.
        multibody.forward_kinematics(world.bodies, true);
        // Rapier damps the rotation of a free root by default.
        multibody.damping_mut().rows_mut(0, ROOT_DOFS).fill(0.0);
        let index_of = |body| links.iter().position(|&link| link == body).expect("a link");
        let mut hinges = Vec::with_capacity(joints.len());
        for (handle, motor) in joints.iter().zip(model.motors()) {
            let joint = handle.joint.expect("the joints of an MJCF make a tree");
            let (_, link) = world.multibody_joints.get(joint).expect("it was just inserted");
            let (multibody, _) = world.multibody_joints.get_mut(joint).expect("it was just inserted");
            let link = multibody.link_mut(link).expect("the joint's own link");
            if drive == Drive::Motors {
                link.joint.data.set_motor_model(JointAxis::AngX, MotorModel::ForceBased);
                link.joint.data.set_motor_position(JointAxis::AngX, 0.0, motor.gain, 0.0);
                link.joint.data.set_motor_max_force(JointAxis::AngX, motor.force_limit);
            }
            let frame = link.joint.data.local_frame2;
            hinges.push(Hinge {
                link: link.link_id(),
                dof: link.assembly_id(),
                child: index_of(handle.link2),
                parent: index_of(handle.link1),
                axis: frame.rotation * Vector::X,
                anchor: frame.translation,
            });
        }
        let chains = chains(model, &links, &bodies, &hinges);
        let mut articulation = Self {
            model: model.clone(),
            drive,
            bodies,
            torques: vec![Vector::ZERO; links.len()],
            links,
            joint,
            targets: vec![0.0; hinges.len()],
            hinges,
            chains,
        };
        let stand = model.stand();
        articulation
            .set_pose(world, &stand.qpos, &stand.qvel)
            .expect("a checked pose, and bodies that were just inserted");
        articulation
    }
}

/// A joint that joins nothing. Rapier skips contacts between its bodies, also while it is disabled.
fn no_contact() -> GenericJoint {
    let mut joint = GenericJointBuilder::new(JointAxesMask::empty()).contacts_enabled(false).build();
    joint.set_enabled(false);
    joint
}

/// For each body, the hinges from its parent to it, the parent's end first.
fn chains(
    model: &Model,
    links: &[rapier3d::dynamics::RigidBodyHandle],
    bodies: &[rapier3d::dynamics::RigidBodyHandle],
    hinges: &[Hinge],
) -> Vec<Vec<usize>> {
    let chain = |body: usize| {
        let mut chain = Vec::new();
        let mut end = links.iter().position(|&link| link == bodies[body]);
        while let Some(index) = hinges.iter().position(|hinge| Some(hinge.child) == end) {
            if model.skeleton().joints()[index].body != BodyId::new(body) {
                break;
            }
            chain.push(index);
            end = Some(hinges[index].parent);
        }
        chain.reverse();
        chain
    };
    (0..bodies.len()).map(chain).collect()
}
