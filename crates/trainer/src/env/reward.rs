//! Task rewards: pure functions of what happened in a tick. All lie in [0, 1].

use glam::{Vec2, Vec3};
use physics_bridge::Contact;
use policy_core::training::BRAKING_METRES;
use policy_core::{BodyId, CharacterState, Heading, Skeleton};
use serde::{Deserialize, Serialize};

/// What the task reward is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Task {
    /// Going to the target at the commanded speed, facing it.
    #[default]
    Target,
    /// Standing: root and head high, upright, still.
    Stand,
}

/// What a tick is worth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RewardConfig {
    /// What the task reward is for.
    pub task: Task,
    /// Weight of the task reward. The style reward gets what task and tracking leave of 1. Where skills are trained together,
    /// a factor on the weight in the last phase of each skill's own recipe.
    pub task_weight: f32,
    /// Least scale of the speed reward, metres per second. A slow gait needs a small one, or standing still is almost as good.
    pub speed_scale_mps: f32,
    /// True to command the speed of the first gait as soon as the stick asks for it, while the coordinate still leaves standing.
    pub prompt_start: bool,
    /// Factor on the weight of the style reward while the target lies far aside; the task reward gets the rest. No clip turns.
    pub turning_style_factor: f32,
    /// Weight of the squared sideways speed beside the squared error of the speed.
    pub sideways_weight: f32,
    /// Share of the head's velocity in the velocity that is paid for; the rest is the root's. Paid for the root alone, a character that sets
    /// off pushes its pelvis ahead and leans back.
    pub head_speed_share: f32,
    /// Time over which the velocity that is paid for is averaged, seconds; 0 to pay for that of each tick. A gait that sways keeps its sway and is
    /// paid for where it goes.
    pub averaging_secs: f32,
    /// Share of the speed reward that falls evenly with the velocity error, from 1 at none to 0 at twice the commanded speed.
    /// It has a slope where the bells are flat: right after the stick was flipped.
    pub linear_speed_share: f32,
    /// Share of the facing reward that only a character that nearly faces its target gets.
    pub strict_facing_share: f32,
    /// Share of the facing reward of a character that is to stand that is for facing where it faced when the episode began. A quick stop
    /// otherwise turns it about.
    pub kept_facing_share: f32,
    /// How much of the reward for speed a character loses that faces away from its target. A low gait otherwise creeps aside
    /// and backwards rather than turn.
    pub facing_factor: f32,
    /// How fast it is to turn to a target that lies far aside, radians per second; 0 for a character that is paid for facing its target. It is then paid for
    /// turning at this rate and for going where it faces, whatever the shares and factors of facing and turning say. A low gait that is paid for facing
    /// spins on its knees, or rests half-way.
    pub turn_rate_rps: f32,
    /// Share of the task reward for the height of the root: that of the clips at the position on the graph.
    pub height_share: f32,
    /// Weight of the reward for tracking a clip. Above zero an episode fails when the tracking error exceeds its threshold,
    /// and is truncated at the clip's end. Where skills are trained together, trackers get it beside the other rewards.
    pub tracking_weight: f32,
    /// Joint training only: share of episodes that start at a node and track the clips of each node they rest at.
    pub tracking_share: f32,
    /// Penalty of a failure. What failing forgoes weighs little beside style once falls are a minute apart.
    pub fall_cost: f32,
    /// Foot-slip penalty each tick, for 1 m/s of feet that bear all the weight; where the character should be upright.
    pub foot_slip_cost: f32,
    /// Most that the feet slip in a tick, in units of [`Self::foot_slip_cost`]. A foot of a run lands with up to three times the weight at 1 m/s;
    /// beyond the most, a faster landing costs no more.
    pub foot_slip_most_mps: f32,
    /// Height of a standing character's root above the ground, metres; for [`Task::Stand`].
    pub standing_root_metres: f32,
    /// Height of a standing character's head above the ground, metres; for [`Task::Stand`].
    pub standing_head_metres: f32,
}

impl Default for RewardConfig {
    fn default() -> Self {
        Self {
            task: Task::Target,
            task_weight: 0.5,
            speed_scale_mps: 0.6,
            prompt_start: false,
            turning_style_factor: 1.0,
            sideways_weight: 0.25,
            head_speed_share: 0.0,
            averaging_secs: 0.0,
            linear_speed_share: 0.0,
            strict_facing_share: 0.0,
            kept_facing_share: 0.0,
            facing_factor: 0.0,
            turn_rate_rps: 0.0,
            height_share: 0.0,
            tracking_weight: 0.0,
            tracking_share: 0.0,
            fall_cost: 0.0,
            foot_slip_cost: 0.0,
            foot_slip_most_mps: 1.0,
            standing_root_metres: 0.83,
            standing_head_metres: 1.25,
        }
    }
}

/// What a tick was worth, before the weights of a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RewardTerms {
    /// Task reward, 0 to 1.
    pub task: f32,
    /// Reward for tracking a clip, 0 to 1.
    pub tracking: f32,
    /// Speed towards the target, metres per second.
    pub speed_mps: f32,
    /// Speed commanded, metres per second.
    pub commanded_mps: f32,
    /// How fast the feet slip, see [`foot_slip_mps`].
    pub foot_slip_mps: f32,
    /// How far it has to turn to face the target: 0 ahead, 1 far aside.
    pub turning: f32,
}

impl RewardTerms {
    /// With a share of the task reward for a root at a height above the ground, metres: `exp(-|error| / 0.15)`.
    #[must_use]
    pub fn with_height(self, state: &CharacterState, (share, metres): (f32, f32)) -> Self {
        let height = state.root_height();
        let reward = (-(height - metres).abs() / 0.15).exp();
        Self { task: (1.0 - share) * self.task + share * reward, ..self }
    }
}

/// How fast the feet slip over what they stand on, metres per second, weighted by the share of the character's weight that
/// presses there; at most `most_mps`.
#[must_use]
pub fn foot_slip_mps(
    feet: &[BodyId],
    state: &CharacterState,
    contacts: &[Contact],
    weight_newton: f32,
    most_mps: f32,
) -> f32 {
    let feet = contacts.iter().filter(|contact| feet.contains(&contact.body));
    let sum: f32 = feet
        .map(|contact| {
            let foot = state.body(contact.body);
            let arm = contact.position - foot.position;
            let velocity = foot.linear_velocity + foot.angular_velocity.cross(arm);
            let along = velocity - contact.normal * velocity.dot(contact.normal);
            along.length() * contact.force.dot(contact.normal).max(0.0)
        })
        .sum();
    (sum / weight_newton).min(most_mps)
}

/// Speed that a target should be approached with, at a position on the graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Speed, metres per second.
    pub speed_mps: f32,
    /// See [`RewardConfig::speed_scale_mps`].
    pub speed_scale_mps: f32,
    /// Direction to face, world, and how much of the facing reward is for it; the rest is for facing the target.
    pub facing: Option<(Vec2, f32)>,
}

/// Angle to the target at which the strict reward for facing it has fallen to 1/e, radians.
const STRICT_FACING_RADIANS: f32 = 0.4;

/// Angles to the target between which a character turns ever more, radians.
const TURNING_RADIANS: [f32; 2] = [0.4, 1.2];

/// The velocity that is paid for: that of the root over the tick, and the head's in its share. A skeleton without a head has the root's alone.
#[must_use]
pub fn paid_velocity(config: &RewardConfig, skeleton: &Skeleton, state: &CharacterState, root: Vec2) -> Vec2 {
    let head = skeleton.head().map(|head| state.body(head).linear_velocity.truncate());
    root.lerp(head.unwrap_or(root), config.head_speed_share)
}

/// Share of the reward of a character that is paid for turning at a rate which is for the rate; the rest is for going where it faces.
const TURN_RATE_SHARE: f32 = 0.6;

/// Rate of a turn for each radian that is left of it, per second: it slows down in the last 30 degrees.
const RATE_PER_RADIAN: f32 = 2.0;

/// Reward for turning at the rate that leads to a target at this angle off the heading: 1 at that rate, falling evenly to 0 at twice the rate of a
/// wide turn away from it.
fn turn_rate_reward(state: &CharacterState, angle: f32, turn_rate_rps: f32) -> f32 {
    let wanted = (RATE_PER_RADIAN * angle).clamp(-turn_rate_rps, turn_rate_rps);
    (1.0 - (state.root().angular_velocity.z - wanted).abs() / (2.0 * turn_rate_rps)).max(0.0)
}

/// Reward for going to `target` and facing it. `velocity` is that of the root over the tick, metres per second.
///
/// `0.4 exp(-2 d) + 0.3 exp(-2 d / 9) + 0.3 facing` with `d = (e^2 + w s^2) / scale^2`, speed error `e`, sideways speed `s` and
/// the sideways weight `w`. The scale grows with the commanded speed from its least value on: evenly below a walk, with the
/// root above. The narrow bell makes the speed exact. The wide one gives a walk that is told to run, or to stand, a slope. A
/// share of both bells can be replaced by a reward that falls evenly with the velocity error.
/// Facing falls evenly from 1 to 0 straight behind; the strict share of it is a bell. With a rate to turn at, the character goes where it faces, and 0.6 of the
/// reward are for that rate.
#[must_use]
pub fn target_reward(
    config: &RewardConfig,
    state: &CharacterState,
    velocity: Vec2,
    target: Vec2,
    pace: Pace,
) -> RewardTerms {
    let root = state.root();
    let to_target = target - root.position.truncate();
    let distance = to_target.length();
    let facing_now = Heading::from_rotation(root.rotation).direction();
    let near = (distance / BRAKING_METRES).min(1.0);
    let direction = if distance > 1e-3 { to_target / distance } else { facing_now };
    let angle = facing_now.angle_to(direction);
    let paid_rate = config.turn_rate_rps > 0.0;
    let direction = if paid_rate { facing_now } else { direction };
    let commanded_mps = pace.speed_mps * near;
    let along = velocity.dot(direction);
    let sideways = velocity.perp_dot(direction);
    let relative = commanded_mps / 1.25;
    let scale = (0.6 * relative.min(relative.sqrt())).max(pace.speed_scale_mps);
    let squares = (along - commanded_mps).powi(2) + config.sideways_weight * sideways * sideways;
    let error = squares / (scale * scale);
    let loss = |aside: f32| {
        let evenly = aside.abs() / std::f32::consts::PI;
        let steeply = 1.0 - (-(aside / STRICT_FACING_RADIANS).powi(2)).exp();
        evenly + config.strict_facing_share * (steeply - evenly)
    };
    // Close by, the direction of the target says nothing.
    let (own, share) = pace.facing.unwrap_or((direction, 0.0));
    let [to_target, to_own] = [direction, own].map(|wanted| facing_now.angle_to(wanted));
    let facing = 1.0 - (1.0 - share) * near * loss(to_target) - share * loss(to_own);
    let bells = 0.4 * (-2.0 * error).exp() + 0.3 * (-2.0 * error / 9.0).exp();
    let off = (velocity - commanded_mps * direction).length() / (2.0 * pace.speed_mps.max(1.0));
    let linear = 0.7 * (1.0 - off).max(0.0);
    // Turning to the target and going there must not be worth much to a character that is to face elsewhere.
    let away = (share * loss(to_own)).max(config.facing_factor * (1.0 - share) * near * loss(to_target));
    let speed = (bells + config.linear_speed_share * (linear - bells)) * (1.0 - away);
    let [begins, fully] = TURNING_RADIANS;
    let turns = |aside: f32| ((aside.abs() - begins) / (fully - begins)).clamp(0.0, 1.0);
    let turning = (1.0 - share) * near * turns(to_target) + share * turns(to_own);
    let task = match paid_rate {
        true => {
            let rate = turn_rate_reward(state, angle, config.turn_rate_rps);
            TURN_RATE_SHARE * rate + (1.0 - TURN_RATE_SHARE) * speed / 0.7
        }
        false => speed + 0.3 * facing,
    };
    RewardTerms { task, speed_mps: along, commanded_mps, turning, ..RewardTerms::default() }
}

/// Speed of the root up to which standing up is at ease, metres per second.
const RISING_MPS: f32 = 1.2;

/// Reward for standing: root and head at their heights, the trunk upright, still once it is up, without a leap. The trunk is the body that the head hangs on, or the root.
#[must_use]
pub fn standing_reward(config: &RewardConfig, skeleton: &Skeleton, state: &CharacterState) -> RewardTerms {
    let root = (state.root_height() / config.standing_root_metres).clamp(0.0, 1.0);
    let head = skeleton
        .head()
        .map_or(root, |head| (state.height_of(head) / config.standing_head_metres).clamp(0.0, 1.0));
    let trunk = skeleton.head().and_then(|head| skeleton.parent(head)).unwrap_or(skeleton.root());
    let up = (state.body(trunk).rotation * Vec3::Z).z.max(0.0);
    let speed = state.horizontal_speed();
    let height = 0.5 * (root + head);
    let still = if height > 0.9 { (-speed * speed).exp() } else { 0.0 };
    // Standing up faster than at ease pays little.
    let excess = (state.root().linear_velocity.length() - RISING_MPS).max(0.0);
    let calm = (-3.0 * excess).exp();
    // Linear in the height, so that the first centimetres off the ground pay as well as the last.
    let task = calm * (0.5 * height + 0.3 * height * up + 0.2 * still);
    RewardTerms { task, ..RewardTerms::default() }
}

#[cfg(test)]
#[path = "reward_tests.rs"]
mod tests;
