//! A character's body: an MJCF loaded, checked against a skeleton, and shared.

mod actuation;
mod change;
mod contacts;

use std::sync::Arc;

use policy_core::contract::{CONTROL_HZ, HeightField, Pose, Settings};
use policy_core::{ActuationContract, CharacterPack, JointActuation, Skeleton};
use rapier3d::dynamics::{JointAxesMask, MassProperties, SpringCoefficients};
use rapier3d::geometry::{Collider, ColliderSet};
use rapier3d::math::Vector;
use rapier3d_mjcf::MjcfRobot;

use crate::model_error::ModelError;
use crate::skeleton::Places;
use crate::{mjcf, skeleton};

/// Joint limits about as soft as MuJoCo's default ones; the loader ignores `solreflimit`, and Rapier's default is all but
/// rigid.
///
/// MuJoCo's stiffness is `k d / (1 - d)` times the inertia, with `k = 1 / (d 0.02^2)` and `d = 0.95`: 218 rad/s. It does
/// not count the implicit damping into the inertia, and Rapier does, which is 4 of 5 parts of a knee's. Hence 98 rad/s.
const LIMIT_SOFTNESS: SpringCoefficients<f32> =
    SpringCoefficients { natural_frequency: 98.0 / std::f32::consts::TAU, damping_ratio: 1.0 };

/// Factor on the friction of the MJCF.
///
/// MuJoCo's pyramid holds `1 / (|cos a| + |sin a|)` of the coefficient in the direction `a`, 0.79 in the mean, and its
/// feet creep below that. Rapier's round cone holds all of it. With all of it the sweep to Zombie walk falls more
/// than twice as often.
const FRICTION: f32 = 0.8;

/// A character's body, its ground and its settings, shared by many characters. Cloning copies
/// two pointers.
///
/// ```
/// # fn main() -> Result<(), physics_rapier::ModelError> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// let model = physics_rapier::Model::from_mjcf(HUMANOID)?;
/// assert_eq!((model.substeps(), model.skeleton().joint_count()), (4, 28));
/// assert!((model.mass_kg() - 48.89).abs() < 0.01);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Model {
    shared: Arc<Shared>,
    variant: Arc<Variant>,
}

/// What stays the same whatever the ground and the settings.
struct Shared {
    skeleton: Arc<Skeleton>,
    motors: Vec<JointActuation>,
    control_hz: f32,
    timestep_secs: f64,
    substeps: u32,
    stand: Pose,
    /// Bodies and joints, the world's geoms taken out.
    robot: MjcfRobot,
    ground: Vec<Collider>,
    places: Places,
    /// Pairs of bodies of `robot` that never touch; `None` when no two do.
    apart: Option<Vec<[usize; 2]>>,
    root_offset: Vector,
}

/// What ground and settings change.
#[derive(Clone)]
struct Variant {
    settings: Settings,
    motors: Vec<JointActuation>,
    robot: MjcfRobot,
    ground: Vec<Collider>,
    field: Option<HeightField>,
}

impl Model {
    /// Loads the text of an MJCF, such as `include_str!("../assets/humanoid.xml")`, for [`CONTROL_HZ`] control ticks
    /// per second.
    ///
    /// The skeleton follows from the text alone. Bodies come in the order of the MJCF, the one with the free joint
    /// first. Hinges come in the order of their motors. The first body with `head` in its name is the head, those
    /// with `hand` are hands, those with `foot` or `feet` are feet.
    ///
    /// Characters stand in the keyframe `stand`, or else in the pose of the MJCF itself.
    ///
    /// # Errors
    /// When the text is no valid MJCF, names other files, or is no character: one body that floats and carries all
    /// others, at least one geom, every other joint a limited hinge with a position servo that has a symmetric `forcerange` and no
    /// `kv`, a `timestep` that divides the control period.
    pub fn from_mjcf(mjcf: &str) -> Result<Self, ModelError> {
        Self::load(mjcf, None, CONTROL_HZ as f32)
    }

    /// As [`Model::from_mjcf`], with the order and the roles of `skeleton`, such as that of a pack of version 1.
    ///
    /// # Errors
    /// As [`Model::from_mjcf`], and when a body or hinge of the skeleton is missing in the MJCF, or has another
    /// parent, body, axis or range there, or the MJCF has more of them.
    pub fn from_mjcf_with_skeleton(
        mjcf: &str,
        skeleton: impl Into<Arc<Skeleton>>,
    ) -> Result<Self, ModelError> {
        Self::load(mjcf, Some(skeleton.into()), CONTROL_HZ as f32)
    }

    /// The same for so many control ticks per second.
    ///
    /// # Errors
    /// As [`Model::from_mjcf_with_skeleton`].
    pub fn from_mjcf_at_rate(
        mjcf: &str,
        skeleton: impl Into<Arc<Skeleton>>,
        control_hz: f32,
    ) -> Result<Self, ModelError> {
        Self::load(mjcf, Some(skeleton.into()), control_hz)
    }

    /// The body of a pack, with the pack's skeleton and control rate.
    ///
    /// # Errors
    /// When the pack has no MJCF, as those of version 1, and as [`Model::from_mjcf_with_skeleton`].
    pub fn for_pack(pack: &CharacterPack) -> Result<Self, ModelError> {
        let mjcf = pack.mjcf().ok_or(ModelError::NoMjcf)?;
        Self::load(mjcf, Some(Arc::clone(pack.skeleton())), pack.control_hz())
    }

    fn load(text: &str, given: Option<Arc<Skeleton>>, control_hz: f32) -> Result<Self, ModelError> {
        let (mut robot, description) = mjcf::parse(text)?;
        let skeleton = match given {
            Some(given) => given,
            None => Arc::new(skeleton::derive(&robot, &description)?),
        };
        let places = skeleton::places(&skeleton, &robot, &description)?;
        if places.bodies.iter().all(|&place| robot.bodies[place].colliders.is_empty()) {
            return Err(ModelError::NoGeoms);
        }
        let motors = actuation::motors(&robot, &skeleton, &places)?;
        let timestep_secs = description.option.timestep;
        let substeps = actuation::substeps(control_hz, timestep_secs)?;
        let stand = actuation::stand(&robot, &skeleton, &places)?;
        // A world of a game has a ground of its own.
        let mut ground = std::mem::take(&mut robot.bodies[0].colliders);
        let limbs = robot.bodies.iter_mut().flat_map(|body| &mut body.colliders);
        ground
            .iter_mut()
            .chain(limbs)
            .for_each(|collider| collider.set_friction(FRICTION * collider.friction()));
        for joint in &mut robot.joints {
            joint.joint.softness = LIMIT_SOFTNESS;
            // The loader's motors are for joints between free bodies; ours are set when a character is inserted.
            joint.joint.motor_axes = JointAxesMask::empty();
        }
        let apart = contacts::apart(&robot, &description);
        let root_offset = move_root_to_its_centre_of_mass(&mut robot, places.bodies[0]);
        let variant = Variant {
            settings: Settings::default(),
            motors: motors.clone(),
            robot: robot.clone(),
            ground: ground.clone(),
            field: None,
        };
        let shared = Shared {
            skeleton,
            motors,
            control_hz,
            timestep_secs,
            substeps,
            stand,
            robot,
            ground,
            places,
            apart,
            root_offset,
        };
        Ok(Self { shared: Arc::new(shared), variant: Arc::new(variant) })
    }

    /// Bodies, hinges and roles.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.shared.skeleton
    }

    /// How the motors are driven: gains, damping, force limits, armatures, physics rate, mass. Allocates.
    #[must_use]
    pub fn actuation(&self) -> ActuationContract {
        ActuationContract {
            physics_hz: (1.0 / self.shared.timestep_secs) as f32,
            mass_kg: self.mass_kg() as f32,
            joints: self.variant.motors.clone(),
        }
    }

    /// Control ticks per second.
    #[must_use]
    pub fn control_hz(&self) -> f32 {
        self.shared.control_hz
    }

    /// Physics steps in a control tick.
    #[must_use]
    pub fn substeps(&self) -> u32 {
        self.shared.substeps
    }

    /// Length of a physics step, seconds.
    #[must_use]
    pub fn timestep_secs(&self) -> f64 {
        self.shared.timestep_secs
    }

    /// Mass of the whole character, kilograms.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.variant.robot.bodies.iter().map(|body| f64::from(body.mass)).sum()
    }

    pub(crate) fn motors(&self) -> &[JointActuation] {
        &self.variant.motors
    }

    /// A standing character at rest; its place means nothing.
    pub(crate) fn stand(&self) -> &Pose {
        &self.shared.stand
    }

    pub(crate) fn robot(&self) -> &MjcfRobot {
        &self.variant.robot
    }

    /// Gravity, friction, strength and mass.
    #[must_use]
    pub fn settings(&self) -> Settings {
        self.variant.settings
    }

    /// The uneven ground; `None` on that of the MJCF.
    #[must_use]
    pub fn height_field(&self) -> Option<&HeightField> {
        self.variant.field.as_ref()
    }

    /// Height of the ground of a [`Character`](crate::Character) at a point, metres, world space: of planes that face up and the
    /// height field, 0 without either.
    #[must_use]
    pub fn height_at(&self, x: f32, y: f32) -> f32 {
        let planes = self.variant.ground.iter().filter_map(|collider| plane_height(collider, x, y));
        let field = self.variant.field.as_ref().and_then(|field| field.height_at(x, y));
        planes.chain(field).reduce(f32::max).unwrap_or(0.0)
    }

    /// True when the two are clones of one model.
    pub(crate) fn is(&self, other: &Model) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared) && Arc::ptr_eq(&self.variant, &other.variant)
    }

    /// True when the two are of one MJCF.
    pub(crate) fn shares_body_with(&self, other: &Model) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared)
    }

    pub(crate) fn gravity(&self) -> Vector {
        self.variant.settings.gravity * self.variant.robot.gravity
    }

    pub(crate) fn places(&self) -> &Places {
        &self.shared.places
    }

    /// Pairs of indices in [`Model::robot`]'s bodies that never touch each other; `None` when no two do.
    pub(crate) fn apart(&self) -> Option<&[[usize; 2]]> {
        self.shared.apart.as_deref()
    }

    /// Where Rapier's root frame is in the MJCF's.
    pub(crate) fn root_offset(&self) -> Vector {
        self.shared.root_offset
    }
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Model").field("mass_kg", &self.mass_kg()).finish_non_exhaustive()
    }
}

/// Height of a plane that faces up.
fn plane_height(collider: &Collider, x: f32, y: f32) -> Option<f32> {
    let plane = collider.shape().as_halfspace()?;
    let normal = collider.rotation() * plane.normal;
    let to = collider.translation() - Vector::new(x, y, 0.0);
    (normal.z > 0.1).then(|| normal.dot(to) / normal.z)
}

/// Moves the root's frame to its centre of mass and returns by how much.
///
/// Rapier takes the linear velocity of a free root as its centre of mass's when it computes forces, and as its
/// origin's when it integrates. With the two in one place both are right.
fn move_root_to_its_centre_of_mass(robot: &mut MjcfRobot, root: usize) -> Vector {
    let entry = &mut robot.bodies[root];
    let mut body = entry.body.clone();
    body.recompute_mass_properties_from_colliders(&ColliderSet::new());
    let mass = body.mass_properties().local_mprops;
    let offset = mass.local_com;
    let centred = MassProperties::with_principal_inertia_frame(
        Vector::ZERO,
        mass.mass(),
        mass.principal_inertia(),
        mass.principal_inertia_local_frame,
    );
    entry.body.set_additional_mass_properties(centred, false);
    for collider in &mut entry.colliders {
        let mut pose = *collider.position();
        pose.translation -= offset;
        collider.set_position(pose);
    }
    for joint in robot.joints.iter_mut().filter(|joint| joint.link1 == root) {
        joint.joint.local_frame1.translation -= offset;
    }
    offset
}
