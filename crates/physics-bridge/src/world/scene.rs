//! What is in a world, as descriptions: from it the simulation is built again when something is added. Cloning copies
//! pointers and numbers, so an edit works on a copy and a failed edit leaves no trace.

use glam::{DQuat, DVec3};
use policy_core::contract::{Fixture, Joint, Prop};

use super::handle::Slots;
use crate::description::model::Model;

/// Everything in a world.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub characters: Slots<Model>,
    pub props: Slots<PropRecord>,
    pub fixtures: Slots<Fixture>,
    pub joints: Slots<JointRecord>,
    next_generation: u32,
}

/// A prop, and what it hangs on.
#[derive(Clone, Debug)]
pub(super) struct PropRecord {
    pub prop: Prop,
    pub hold: Option<Hold>,
    /// True when it is kept aside for later while it is not present.
    pub is_reserved: bool,
}

/// How a prop hangs on another prop or on the world.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hold {
    /// Index of the prop that it hangs on; `None` for the world.
    pub parent: Option<usize>,
    /// Index of the joint.
    pub joint: usize,
    pub kind: HoldKind,
    /// Where the prop is in its parent while the joint is at zero.
    pub position: DVec3,
    /// `parent_from_prop` while the joint is at zero.
    pub rotation: DQuat,
    /// A point of the joint in the frame of the prop.
    pub anchor: DVec3,
    /// Its axis in the frame of the prop, a unit vector.
    pub axis: DVec3,
    pub range: Option<[f64; 2]>,
    pub damping: f64,
}

/// The joints that a prop can hang on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HoldKind {
    Hinge,
    Slide,
    Ball,
}

/// A joint.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum JointRecord {
    /// The prop of that index hangs on it.
    Hold { prop: usize },
    /// A rope.
    Rope(Rope),
}

/// Two points that stay near each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rope {
    /// Index of the prop at each end; `None` for the world, at the second end only.
    pub props: [Option<usize>; 2],
    /// The points, each in the frame of its prop.
    pub points: [DVec3; 2],
    /// Metres.
    pub length: f64,
}

impl Scene {
    pub(super) fn new() -> Self {
        Self {
            characters: Slots::new("a character"),
            props: Slots::new("a prop"),
            fixtures: Slots::new("a fixture"),
            joints: Slots::new("a joint"),
            next_generation: 1,
        }
    }

    /// A generation that no handle has.
    pub(super) fn generation(&mut self) -> u32 {
        self.next_generation += 1;
        self.next_generation
    }

    /// Never lets a generation be given twice, also after an older scene was restored.
    pub(super) fn generations_after(&mut self, other: &Scene) {
        self.next_generation = self.next_generation.max(other.next_generation);
    }

    /// The prop that does not hang on another one, above `prop`.
    pub(super) fn root_of(&self, mut prop: usize) -> usize {
        while let Some(parent) = self.props.at(prop).hold.as_ref().and_then(|hold| hold.parent) {
            prop = parent;
        }
        prop
    }

    /// Joints that touch a prop: what it hangs on, what hangs on it, its ropes.
    pub(super) fn joints_of(&self, prop: usize) -> Vec<usize> {
        let touches = |record: &JointRecord| match *record {
            JointRecord::Hold { prop: held } => {
                held == prop || self.props.at(held).hold.as_ref().is_some_and(|h| h.parent == Some(prop))
            }
            JointRecord::Rope(rope) => rope.props.contains(&Some(prop)),
        };
        self.joints.present().filter(|(_, record)| touches(record)).map(|(index, _)| index).collect()
    }

    /// Removes a joint; what hung on it is free.
    pub(super) fn remove_joint(&mut self, joint: usize) {
        if let JointRecord::Hold { prop } = *self.joints.at(joint) {
            self.props.at_mut(prop).hold = None;
        }
        self.joints.clear(joint);
    }

    /// Drops what is neither present nor reserved, before the simulation is built again.
    pub(super) fn drop_absent(&mut self) {
        let absent: Vec<(usize, bool)> = (self.props.iter())
            .filter(|(_, slot)| !slot.present)
            .map(|(index, slot)| (index, slot.value.is_reserved))
            .collect();
        for (index, is_reserved) in absent {
            for joint in self.joints_of(index) {
                self.remove_joint(joint);
            }
            if !is_reserved {
                self.props.clear(index);
            }
        }
        let gone: Vec<usize> =
            self.characters.iter().filter(|(_, s)| !s.present).map(|(index, _)| index).collect();
        gone.into_iter().for_each(|index| self.characters.clear(index));
    }

    /// Hangs `prop`, which is free, on a joint. Poses are of now: the prop's, and its parent's or the identity.
    pub(super) fn hang(
        &mut self,
        prop: usize,
        parent: Option<usize>,
        joint: &Joint,
        [(at, turned), (parent_at, parent_turned)]: [(DVec3, DQuat); 2],
        index: usize,
    ) {
        let into = turned.inverse();
        let (kind, anchor, axis, range, damping) = match *joint {
            Joint::Hinge { anchor, axis, range, damping } => (HoldKind::Hinge, anchor, axis, range, damping),
            Joint::Slide { axis, range, damping } => (HoldKind::Slide, at.as_vec3(), axis, range, damping),
            Joint::Ball { anchor, damping } => (HoldKind::Ball, anchor, glam::Vec3::Z, None, damping),
            Joint::Rope { .. } => unreachable!("a rope holds no prop"),
        };
        self.props.at_mut(prop).hold = Some(Hold {
            parent,
            joint: index,
            kind,
            position: parent_turned.inverse() * (at - parent_at),
            rotation: (parent_turned.inverse() * turned).normalize(),
            anchor: into * (anchor.as_dvec3() - at),
            axis: (into * axis.as_dvec3()).normalize(),
            range: range.map(|limits| limits.map(f64::from)),
            damping: damping.into(),
        });
    }
}
