//! What holds two props together, or a prop to the world.

use core::f32::consts::TAU;

use super::MAX_DISTANCE_M;
use super::description_error::{DescriptionError, within};
use glam::Vec3;

/// Range of the damping of a hinge, slide or ball joint, N m s/rad or N s/m.
pub const DAMPING_RANGE: [f32; 2] = [0.0, 10_000.0];

/// Range of the length of a rope, metres.
pub const ROPE_RANGE_M: [f32; 2] = [0.01, 1000.0];

/// A joint between a prop and another prop or the world. Points and axes are world space, where the props are when
/// it is added. Two props that a hinge, slide or ball joint joins do not touch each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// Turns about an axis.
    Hinge {
        /// A point on the axis.
        anchor: Vec3,
        /// Direction of the axis, not zero.
        axis: Vec3,
        /// Least and greatest angle from where it is now, radians, in [-2 pi, 2 pi]; `None` turns freely.
        range: Option<[f32; 2]>,
        /// In [`DAMPING_RANGE`].
        damping: f32,
    },
    /// Slides along an axis without turning.
    Slide {
        /// Direction of the axis, not zero.
        axis: Vec3,
        /// Least and greatest distance from where it is now, metres, in [-1000, 1000]; `None` slides freely.
        range: Option<[f32; 2]>,
        /// In [`DAMPING_RANGE`].
        damping: f32,
    },
    /// Turns about a point.
    Ball {
        /// The point.
        anchor: Vec3,
        /// In [`DAMPING_RANGE`].
        damping: f32,
    },
    /// Keeps two points no further apart than a length.
    Rope {
        /// The point on the prop, and that on the other prop or in the world.
        ends: [Vec3; 2],
        /// Metres, in [`ROPE_RANGE_M`].
        length: f32,
    },
}

impl Joint {
    /// The point in the world that it turns about, metres; `None` for one that turns about no point.
    #[must_use]
    pub fn anchor(&self) -> Option<Vec3> {
        match self {
            Self::Hinge { anchor, .. } | Self::Ball { anchor, .. } => Some(*anchor),
            Self::Slide { .. } | Self::Rope { .. } => None,
        }
    }

    /// Checks every number.
    ///
    /// # Errors
    /// When one is out of its range; the first one is named.
    pub fn check(&self) -> Result<(), DescriptionError> {
        const WHAT: &str = "a joint";
        let point = |field, point: Vec3| within(WHAT, field, point.length(), [0.0, MAX_DISTANCE_M]);
        let limits = |range: Option<[f32; 2]>, most: f32| {
            range.map_or(Ok(()), |[low, high]| {
                within(WHAT, "range[0]", low, [-most, most])?;
                within(WHAT, "range[1]", high, [low, most])
            })
        };
        match *self {
            Joint::Hinge { anchor, axis, range, damping } => {
                point("anchor", anchor)?;
                within(WHAT, "length of the axis", axis.length(), [1e-3, 1e3])?;
                limits(range, TAU)?;
                within(WHAT, "damping", damping, DAMPING_RANGE)
            }
            Joint::Slide { axis, range, damping } => {
                within(WHAT, "length of the axis", axis.length(), [1e-3, 1e3])?;
                limits(range, 1000.0)?;
                within(WHAT, "damping", damping, DAMPING_RANGE)
            }
            Joint::Ball { anchor, damping } => {
                point("anchor", anchor)?;
                within(WHAT, "damping", damping, DAMPING_RANGE)
            }
            Joint::Rope { ends, length } => {
                point("ends[0]", ends[0])?;
                point("ends[1]", ends[1])?;
                within(WHAT, "length", length, ROPE_RANGE_M)
            }
        }
    }
}
