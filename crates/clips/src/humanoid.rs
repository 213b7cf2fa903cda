//! The humanoid of the formats that do not name their bodies.

use std::sync::Arc;

use policy_core::Skeleton;

/// Its bodies, in the order of AMP's clips.
pub(super) fn bodies() -> Arc<[String]> {
    Skeleton::humanoid().bodies().iter().map(|body| body.name.clone()).collect()
}
