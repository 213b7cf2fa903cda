//! Which inputs and actions of a skeleton are mirror images of each other.

use clips::twin_name;
use glam::Vec3;
use policy_core::Skeleton;
use policy_core::training::{ActionScaling, Normaliser};

use crate::ppo::{Mirror, SignedPermutation};

/// Why a skeleton has no mirror image.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MirrorError {
    /// A body or hinge has a side, and the other side has none of that name.
    #[error("expected a body or hinge named {expected}, the mirror image of {found}, found none")]
    Missing {
        /// The one that is there.
        found: String,
        /// The one that is not.
        expected: String,
    },
    /// A hinge's axis or range is not the mirror image of its partner's.
    #[error("expected axis and range of hinge {first} to be the mirror image of those of {second}")]
    Hinge {
        /// A hinge.
        first: String,
        /// The one that should be its mirror image.
        second: String,
    },
    /// A normaliser was computed from one side alone.
    #[error("expected mean and deviation of input {input} to be those of its mirror image, input {other}")]
    Normaliser {
        /// An input.
        input: usize,
        /// Its mirror image.
        other: usize,
    },
}

/// Signs of the mirror image of a vector, and of one about which something turns.
const POLAR: [f32; 3] = [1.0, -1.0, 1.0];
const AXIAL: [f32; 3] = [-1.0, 1.0, -1.0];

/// The mirror image in the plane of x and z: a body, and its hinges, go to the one whose name has `left` for `right`.
/// Inputs are those of [`policy_core::observe_into`] after `normaliser`, and the target, or where the policy is `timed` its clock, which looks the
/// same in the mirror.
///
/// # Errors
/// When a name is missing on one side, hinges are no mirror images of each other, or the normaliser is not symmetric.
pub fn mirror_of(skeleton: &Skeleton, normaliser: &Normaliser, timed: bool) -> Result<Mirror, MirrorError> {
    let missing = |found: &str| MirrorError::Missing { found: found.to_owned(), expected: swapped(found) };
    let partners = skeleton.bodies().iter().map(|body| {
        let partner = skeleton.body_named(&swapped(&body.name));
        partner.map(policy_core::BodyId::index).ok_or_else(|| missing(&body.name))
    });
    let partners: Vec<usize> = partners.collect::<Result<_, _>>()?;

    let mut inputs = vec![(0, 1.0)];
    let mut vectors = |bodies: std::ops::Range<usize>, signs: &[f32]| {
        let (start, first) = (inputs.len(), bodies.start);
        for body in bodies {
            let from = start + signs.len() * (partners[body] - first);
            inputs.extend(signs.iter().enumerate().map(|(number, sign)| (from + number, *sign)));
        }
    };
    let count = skeleton.body_count();
    vectors(1..count, &POLAR); // places
    vectors(0..count, &[POLAR, POLAR].concat()); // x and z axes
    vectors(0..count, &POLAR); // velocities
    vectors(0..count, &AXIAL); // angular velocities
    for (input, &(other, sign)) in inputs.iter().enumerate() {
        let (mean, deviation) = (normaliser.mean(), normaliser.deviation());
        let apart = (mean[input] - sign * mean[other]).abs() + (deviation[input] - deviation[other]).abs();
        if apart > 1e-3 * deviation[input] {
            return Err(MirrorError::Normaliser { input, other });
        }
    }
    let target = inputs.len();
    inputs.extend([(target, 1.0), (target + 1, if timed { 1.0 } else { -1.0 })]);
    Ok(Mirror { inputs: SignedPermutation::new(inputs), actions: mirrored_joints(skeleton)? })
}

/// The mirror image of an action: a hinge goes to the one whose name has `left` for `right`.
///
/// # Errors
/// When a name is missing on one side, or hinges are no mirror images of each other.
pub fn mirrored_joints(skeleton: &Skeleton) -> Result<SignedPermutation, MirrorError> {
    let missing = |found: &str| MirrorError::Missing { found: found.to_owned(), expected: swapped(found) };
    let bodies = skeleton.bodies();
    let scaling = ActionScaling::from_skeleton(skeleton);
    let actions = skeleton.joints().iter().enumerate().map(|(index, joint)| {
        let partner = skeleton.joint_named(&swapped(&joint.name)).ok_or_else(|| missing(&joint.name))?;
        let other = &skeleton.joints()[partner.index()];
        let axis = Vec3::from_array(AXIAL) * other.axis;
        let sign = axis.dot(joint.axis).round();
        let close = |a: f32, b: f32| (a - b).abs() < 1e-4;
        let (centre, gain) = (scaling.centre(), scaling.gain());
        let same = swapped(&bodies[joint.body.index()].name) == bodies[other.body.index()].name
            && axis.distance(sign * joint.axis) < 1e-3
            && close(centre[index], sign * centre[partner.index()])
            && close(gain[index], gain[partner.index()]);
        let hinge = || MirrorError::Hinge { first: joint.name.clone(), second: other.name.clone() };
        same.then_some((partner.index(), sign)).ok_or_else(hinge)
    });
    Ok(SignedPermutation::new(actions.collect::<Result<_, _>>()?))
}

/// The name on the other side; the same for what is in the middle.
fn swapped(name: &str) -> String {
    twin_name(name).unwrap_or_else(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use clips::{Clip, fit};
    use glam::Quat;
    use policy_core::observe_into;

    use super::*;
    use crate::env::made_up::{shipped, still};

    /// A clip that turns every body, each by another angle, and goes aside.
    fn crooked() -> Clip {
        let mut clip = still(12);
        for (frame, rotations) in clip.local_rotations.iter_mut().enumerate() {
            clip.root_positions[frame].y = 0.02 * frame as f32;
            for (body, rotation) in rotations.iter_mut().enumerate() {
                let angle = 0.01 * (frame * (body + 1)) as f32;
                *rotation = Quat::from_rotation_y(angle) * Quat::from_rotation_x(0.1 - angle);
            }
        }
        clip
    }

    #[test]
    fn what_a_mirrored_character_sees_is_the_mirror_image_of_what_it_saw() {
        let (model, _, normalisers) = shipped();
        let skeleton = model.skeleton();
        let mirror = mirror_of(skeleton, &normalisers.observation, false).unwrap();
        let seen = |clip: &Clip, target: [f32; 2]| {
            let state = fit(clip, &model).unwrap().states[5].clone();
            let mut seen = vec![0.0; skeleton.observation_len()];
            observe_into(skeleton, &state, &mut seen);
            seen.extend(target);
            seen
        };
        let clip = crooked();
        let (first, expected) = (seen(&clip, [0.4, 0.3]), seen(&clip.mirrored(), [0.4, -0.3]));
        let mut found = vec![0.0; expected.len()];
        mirror.inputs.apply_into(&first, &mut found);
        let apart = |a: &[f32]| a.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart(&first) > 0.1, "the clip is not its own mirror image");
        assert!(apart(&found) < 1e-4, "{}", apart(&found));
    }

    #[test]
    fn a_clock_looks_the_same_in_the_mirror_and_a_target_does_not() {
        let (model, _, normalisers) = shipped();
        let target = model.skeleton().observation_len();
        for (timed, sign) in [(false, -1.0), (true, 1.0)] {
            let inputs = mirror_of(model.skeleton(), &normalisers.observation, timed).unwrap().inputs;
            assert_eq!((inputs.entry(target), inputs.entry(target + 1)), ((target, 1.0), (target + 1, sign)));
        }
    }

    #[test]
    fn knees_swap_and_the_trunk_leans_to_the_other_side() {
        let (model, _, normalisers) = shipped();
        let skeleton = model.skeleton();
        let mirror = mirror_of(skeleton, &normalisers.observation, false).unwrap();
        let entry = |name: &str| {
            let (from, sign) = mirror.actions.entry(skeleton.joint_named(name).unwrap().index());
            (skeleton.joints()[from].name.clone(), sign)
        };
        assert_eq!(entry("left_knee"), ("right_knee".into(), 1.0));
        assert_eq!(entry("right_hip_x"), ("left_hip_x".into(), -1.0));
        assert_eq!(entry("abdomen_y"), ("abdomen_y".into(), 1.0));
        assert_eq!(entry("abdomen_z"), ("abdomen_z".into(), -1.0));
    }

    #[test]
    fn a_normaliser_of_one_side_alone_is_refused() {
        let skeleton = Skeleton::humanoid();
        let mut mean = vec![0.0; skeleton.observation_len()];
        mean[2] = 0.5; // the torso aside
        let one_sided =
            Normaliser::from_mean_and_deviation(&mean, &vec![1.0; skeleton.observation_len()]).unwrap();
        let error = mirror_of(&skeleton, &one_sided, false).unwrap_err();
        assert_eq!(error, MirrorError::Normaliser { input: 2, other: 2 });
    }
}
