//! Feet of clips on the ground. People bend their toes as a heel rises. A foot of one piece puts its tip into the floor with the
//! same ankle, and a clip that is lifted for that stands on nothing.

use physics_bridge::{Character, Pose, PoseError};
use policy_core::{BodyId, CharacterState, Skeleton};

/// A hinge tips its foot when its axis is this near to the y axis: least |y| of the unit axis.
const TIPPING_AXIS: f32 = 0.9;

/// Halvings of the angle that an ankle is turned by.
const HALVINGS: usize = 10;

/// Turns each ankle of a pose towards a level foot, as little as brings no point of the foot lower than the ground, or than
/// its sole would be: a foot that is in the ground as a whole stays there.
///
/// A foot without a hinge that tips it is left alone.
pub(super) fn put_on_ground(pose: &mut Pose, character: &mut Character) -> Result<(), PoseError> {
    character.set_pose(&pose.qpos, &pose.qvel)?;
    let skeleton = character.model().skeleton().clone();
    let mut state = CharacterState::new(&skeleton);
    for &foot in skeleton.feet() {
        let Some((ankle, sign, [low, high])) = tipping_joint(&skeleton, foot) else { continue };
        let lowest = character.clearance_of(foot);
        if lowest >= 0.0 {
            continue;
        }
        character.sense_into(&mut state);
        let ahead = state.body(foot).rotation * glam::Vec3::X;
        // `set_pose` checked the length: 7 numbers for the root, one for each joint. Ranges ascend.
        let was = pose.qpos[7 + ankle];
        // A turn about +y tips the toes down.
        let level = was + f64::from(sign * ahead.z.clamp(-1.0, 1.0).asin());
        let level = level.clamp(f64::from(low), f64::from(high));
        let mut lowest_at = |share: f64| {
            pose.qpos[7 + ankle] = was + share * (level - was);
            character.set_pose(&pose.qpos, &pose.qvel).map(|()| character.clearance_of(foot))
        };
        let allowed = lowest_at(1.0)?.min(0.0);
        if allowed <= lowest {
            lowest_at(0.0)?;
            continue;
        }
        let (mut least, mut most) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (least + most);
            if lowest_at(middle)? < allowed {
                least = middle;
            } else {
                most = middle;
            }
        }
        lowest_at(most)?;
    }
    Ok(())
}

/// Index, sign and range of the hinge that tips a foot about the y axis.
fn tipping_joint(skeleton: &Skeleton, foot: BodyId) -> Option<(usize, f32, [f32; 2])> {
    skeleton.joints().iter().enumerate().find_map(|(index, joint)| {
        let along = joint.axis.normalize().y;
        (joint.body == foot && along.abs() > TIPPING_AXIS).then_some((index, along.signum(), joint.range))
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use physics_bridge::Model;

    use super::*;

    const RIGHT_ANKLE_Y: usize = 7 + 19;

    /// A stand, lifted, with the right ankle turned, put on the ground; the ankle's angle and the foot's lowest point after it.
    fn put(lift: f64, ankle: f64) -> (f64, f32) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
        let model = Model::load(path).unwrap();
        let mut character = Character::new(&model);
        character.stand_at(0.0, 0.0, policy_core::Heading::FORWARD, 0.0).unwrap();
        let mut pose = character.pose();
        pose.qvel.fill(0.0);
        pose.qpos[2] += lift;
        pose.qpos[RIGHT_ANKLE_Y] += ankle;
        let before = pose.clone();
        put_on_ground(&mut pose, &mut character).unwrap();
        let others = |pose: &Pose| {
            let mut others = pose.qpos.clone();
            others[RIGHT_ANKLE_Y] = 0.0;
            others
        };
        assert_eq!(others(&pose), others(&before), "nothing but the ankle is turned");
        character.set_pose(&pose.qpos, &pose.qvel).unwrap();
        (
            pose.qpos[RIGHT_ANKLE_Y] - before.qpos[RIGHT_ANKLE_Y],
            character.clearance_of(model.skeleton().body_named("right_foot").unwrap()),
        )
    }

    #[test]
    fn a_tip_or_a_heel_in_the_ground_is_turned_out_of_it_and_no_further() {
        // A foot 3 cm up whose toes point down by half a right angle, or up.
        let (turned, lowest) = put(0.03, 0.7);
        assert!((-0.6..-0.3).contains(&turned) && lowest.abs() < 1e-3, "{turned} {lowest}");
        let (turned, lowest) = put(0.01, -0.7);
        assert!((0.1..0.7).contains(&turned) && lowest.abs() < 1e-3, "{turned} {lowest}");
    }

    #[test]
    fn a_foot_that_is_in_the_ground_as_a_whole_becomes_level_there() {
        let (turned, lowest) = put(-0.02, 0.5);
        assert!((turned + 0.5).abs() < 0.01 && (lowest + 0.02).abs() < 1e-3, "{turned} {lowest}");
        assert_eq!(put(-0.02, 0.0).0, 0.0);
    }

    #[test]
    fn a_foot_in_the_air_keeps_its_angle() {
        assert_eq!(put(0.3, 0.7).0, 0.0);
    }
}
