//! What only a trainer, a converter or a panel needs: parts of packs, features of discriminators, rules by which training
//! follows a game.

pub use crate::action::{ActionScaling, ActionScalingError};
pub use crate::agility::BRAKING_METRES;
pub use crate::blend::{BlendFull, BlendTerm, MAX_BLEND_TERMS};
pub use crate::evaluator::Evaluation;
pub use crate::fall::{FallDetector, Heights, LATE_RISE_SECONDS, RISE_SECONDS, fall_height, step_heights};
pub use crate::features::{FRAME_AGES, FrameHistory, HISTORY_LEN, discriminator_frame_into};
pub use crate::footfall::foot_comes_down;
pub use crate::graph::{Edge, GraphError, MAX_NODES, Node};
pub use crate::ids::{DiscriminatorId, JointId};
pub use crate::mlp::{Layer, MAX_LAYERS, MAX_WIDTH, MlpError};
pub use crate::normaliser::{LEAST_DEVIATION, NORMALISED_LIMIT, Normaliser, NormaliserError};
pub use crate::observation::{TARGET_LEN, TARGET_RANGE_METRES};
pub use crate::pack::PackTensors;
pub use crate::path::Path;
pub use crate::route::RouteTable;
pub use crate::skeleton::{MAX_SKELETON_PARTS, Roles, SkeletonBody, SkeletonError, SkeletonJoint};
pub use crate::skill::{EndCondition, SkillProgress, clock_input};
pub use crate::steering::SteeringState;
pub use crate::strafe::{face_in_observation, strafing_share};
