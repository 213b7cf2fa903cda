//! What a mesh is bound to: the names of the bodies, and where they are with all joints at zero.

use std::sync::Arc;

use glam::Vec3;
use policy_core::{BodyId, Skeleton};

/// A skeleton in its rest pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    skeleton: Arc<Skeleton>,
    rest: Vec<Vec3>,
}

impl Rig {
    /// The bodies of `skeleton`, at `rest` with all joints at zero, metres, in the order of the skeleton.
    ///
    /// # Panics
    /// When there is not one position for each body.
    #[must_use]
    pub fn new(skeleton: Arc<Skeleton>, rest: Vec<Vec3>) -> Self {
        assert_eq!(skeleton.body_count(), rest.len(), "one position for each body");
        Self { skeleton, rest }
    }

    /// The skeleton.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.skeleton
    }

    /// Where a body is with all joints at zero, metres.
    pub(super) fn rest(&self, body: BodyId) -> Vec3 {
        self.rest[body.index()]
    }

    /// All bodies, each after its parent.
    pub(super) fn bodies(&self) -> impl Iterator<Item = BodyId> + use<> {
        (0..self.rest.len()).map(BodyId::new)
    }

    /// The body at the far end of a limb: the first that hangs on it. Hands, feet and heads have none.
    pub(super) fn end_of(&self, body: BodyId) -> Option<BodyId> {
        self.bodies().find(|other| self.skeleton.parent(*other) == Some(body))
    }
}
