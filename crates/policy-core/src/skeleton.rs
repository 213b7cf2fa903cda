//! A character's bodies and hinges: names, order, parents and roles. Every layout follows from it.
//!
//! The order is part of each observation and action. It comes from the pack and is checked here once.

use alloc::string::String;
use alloc::vec::Vec;

use glam::Vec3;

use crate::features::FRAME_AGES;
use crate::ids::{BodyId, JointId};
use crate::observation::TARGET_LEN;

mod humanoid;

/// Most bodies of one skeleton, and most joints.
pub const MAX_SKELETON_PARTS: usize = 256;

/// A body. The root comes first, and each parent before its children.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SkeletonBody {
    /// Unique name, as in the MJCF and in glTF nodes.
    pub name: String,
    /// The body it hangs on; `None` for the root alone.
    pub parent: Option<BodyId>,
}

/// An actuated hinge.
#[derive(Clone, Debug, PartialEq)]
pub struct SkeletonJoint {
    /// Unique name.
    pub name: String,
    /// The body that it moves.
    pub body: BodyId,
    /// Axis in the frame of that body; of any length but zero.
    pub axis: Vec3,
    /// Least and greatest angle, radians.
    pub range: [f32; 2],
}

/// What some bodies are for. Hands and feet are the end effectors of the discriminator's features, in this order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Roles {
    /// Tells whether the character is upright.
    pub head: Option<BodyId>,
    /// Hands, or nothing.
    pub hands: Vec<BodyId>,
    /// Feet, or nothing.
    pub feet: Vec<BodyId>,
}

/// Bodies, hinges and roles of one kind of character. Immutable; share it between characters.
///
/// ```
/// use policy_core::Skeleton;
/// let humanoid = Skeleton::humanoid();
/// assert_eq!((humanoid.body_count(), humanoid.joint_count()), (15, 28));
/// assert_eq!(humanoid.observation_len(), 15 * 15 - 2);
/// let head = humanoid.body_named("head").unwrap();
/// assert_eq!(humanoid.head(), Some(head));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    bodies: Vec<SkeletonBody>,
    joints: Vec<SkeletonJoint>,
    roles: Roles,
    jointed: Vec<BodyId>,
}

/// Why a skeleton can't be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SkeletonError {
    /// No body or joint, or too many.
    #[error("expected 1 to {MAX_SKELETON_PARTS} {what}, found {found}")]
    Count {
        /// `bodies` or `joints`.
        what: &'static str,
        /// How many there are.
        found: usize,
    },
    /// Two parts share a name, or a name is empty.
    #[error("expected a {what} name that is not empty and unique, found {name:?}")]
    Name {
        /// `body` or `joint`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A body has no parent, or one that comes after it.
    #[error("expected the parent of body {body:?} among the bodies before it, found {found:?}")]
    Parent {
        /// Name of the body.
        body: String,
        /// Its parent.
        found: Option<BodyId>,
    },
    /// A joint or a role names a body that is not there.
    #[error("expected a body of the skeleton for {owner}, found index {found}")]
    Body {
        /// The joint or role.
        owner: String,
        /// Index of the body.
        found: usize,
    },
    /// A joint turns about no axis or has no range.
    #[error(
        "expected an axis and an increasing finite range for joint {joint:?}, found {axis} and {range:?}"
    )]
    Joint {
        /// Name of the joint.
        joint: String,
        /// Its axis.
        axis: Vec3,
        /// Its range, radians.
        range: [f32; 2],
    },
}

impl Skeleton {
    /// A skeleton of bodies, hinges and roles.
    ///
    /// # Errors
    /// When a count, name, parent, body, axis or range is not as [`SkeletonError`] says.
    pub fn from_parts(
        bodies: Vec<SkeletonBody>,
        joints: Vec<SkeletonJoint>,
        roles: Roles,
    ) -> Result<Self, SkeletonError> {
        for (what, found) in [("bodies", bodies.len()), ("joints", joints.len())] {
            if !(1..=MAX_SKELETON_PARTS).contains(&found) {
                return Err(SkeletonError::Count { what, found });
            }
        }
        check_names("body", bodies.iter().map(|b| &b.name))?;
        check_names("joint", joints.iter().map(|j| &j.name))?;
        for (index, body) in bodies.iter().enumerate() {
            let found = body.parent;
            let fits = if index == 0 { found.is_none() } else { found.is_some_and(|p| p.index() < index) };
            if !fits {
                return Err(SkeletonError::Parent { body: body.name.clone(), found });
            }
        }
        for joint in &joints {
            check_joint(joint, bodies.len())?;
        }
        let named = [
            ("the role head", roles.head.as_slice()),
            ("the role hands", &roles.hands),
            ("the role feet", &roles.feet),
        ];
        for (owner, ids) in named {
            if let Some(id) = ids.iter().find(|id| id.index() >= bodies.len()) {
                return Err(SkeletonError::Body { owner: owner.into(), found: id.index() });
            }
        }
        let hangs = |id: &BodyId| joints.iter().any(|j| j.body == *id);
        let jointed = (0..bodies.len()).map(BodyId::new).filter(hangs).collect();
        Ok(Self { bodies, joints, roles, jointed })
    }

    /// Bodies, in the order of observations.
    #[must_use]
    pub fn bodies(&self) -> &[SkeletonBody] {
        &self.bodies
    }

    /// Hinges, in the order of actions, joint targets and joint velocities.
    #[must_use]
    pub fn joints(&self) -> &[SkeletonJoint] {
        &self.joints
    }

    /// Number of bodies, the root included.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// Number of hinges.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// A body.
    ///
    /// # Panics
    /// When the id is of a larger skeleton.
    #[must_use]
    pub fn body(&self, id: BodyId) -> &SkeletonBody {
        &self.bodies[id.index()]
    }

    /// The body that `id` hangs on; `None` for the root.
    ///
    /// # Panics
    /// When the id is of a larger skeleton.
    #[must_use]
    pub fn parent(&self, id: BodyId) -> Option<BodyId> {
        self.bodies[id.index()].parent
    }

    /// The body called `name`.
    #[must_use]
    pub fn body_named(&self, name: &str) -> Option<BodyId> {
        self.bodies.iter().position(|b| b.name == name).map(BodyId::new)
    }

    /// The hinge called `name`.
    #[must_use]
    pub fn joint_named(&self, name: &str) -> Option<JointId> {
        self.joints.iter().position(|j| j.name == name).map(JointId::new)
    }

    /// The body that carries the character's position and heading: the first one.
    #[must_use]
    pub fn root(&self) -> BodyId {
        BodyId::new(0)
    }

    /// The head, if one is named.
    #[must_use]
    pub fn head(&self) -> Option<BodyId> {
        self.roles.head
    }

    /// The hands.
    #[must_use]
    pub fn hands(&self) -> &[BodyId] {
        &self.roles.hands
    }

    /// The feet.
    #[must_use]
    pub fn feet(&self) -> &[BodyId] {
        &self.roles.feet
    }

    /// What the bodies are for.
    #[must_use]
    pub fn roles(&self) -> &Roles {
        &self.roles
    }

    /// Bodies that hang on at least one hinge, in body order.
    #[must_use]
    pub fn jointed_bodies(&self) -> &[BodyId] {
        &self.jointed
    }

    /// Numbers of an observation, before the target: `15 * bodies - 2`.
    #[must_use]
    pub fn observation_len(&self) -> usize {
        15 * self.bodies.len() - 2
    }

    /// Inputs of a policy: the observation and the target.
    #[must_use]
    pub fn policy_input_len(&self) -> usize {
        self.observation_len() + TARGET_LEN
    }

    /// Numbers of one discriminator frame: 13 for the root, 6 for each jointed body, one for each hinge, 3 for each hand
    /// and foot.
    #[must_use]
    pub fn frame_len(&self) -> usize {
        13 + 6 * self.jointed.len() + self.joints.len() + 3 * (self.roles.hands.len() + self.roles.feet.len())
    }

    /// Inputs of a discriminator: one frame for each of its ages.
    #[must_use]
    pub fn discriminator_input_len(&self) -> usize {
        self.frame_len() * FRAME_AGES.len()
    }
}

fn check_names<'a>(
    what: &'static str,
    names: impl Iterator<Item = &'a String> + Clone,
) -> Result<(), SkeletonError> {
    for (i, name) in names.clone().enumerate() {
        if name.is_empty() || names.clone().take(i).any(|n| n == name) {
            return Err(SkeletonError::Name { what, name: name.clone() });
        }
    }
    Ok(())
}

fn check_joint(joint: &SkeletonJoint, bodies: usize) -> Result<(), SkeletonError> {
    if joint.body.index() >= bodies {
        let owner = alloc::format!("joint \"{}\"", joint.name);
        return Err(SkeletonError::Body { owner, found: joint.body.index() });
    }
    let [low, high] = joint.range;
    // An axis of finite numbers may still be too long to be normalised.
    let length_squared = joint.axis.length_squared();
    let turns = length_squared > 1e-12 && length_squared.is_finite();
    if !turns || !low.is_finite() || !high.is_finite() || low >= high {
        return Err(SkeletonError::Joint { joint: joint.name.clone(), axis: joint.axis, range: joint.range });
    }
    Ok(())
}

#[cfg(test)]
#[path = "skeleton_tests.rs"]
mod tests;
