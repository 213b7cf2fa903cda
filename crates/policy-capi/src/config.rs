//! Choices that are made once for a controller.

use std::mem::MaybeUninit;

use policy_core::{
    Arithmetic, BlendMode, CharacterPack, ControllerConfig, GiveWay, NodeId, Steering, TurnAssist,
};

use crate::border::{finite, id, index, present};
use crate::error::{PsStatus, fail, guard};

/// How a blend of policies becomes one action.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsBlendMode {
    /// Interpolate the parameters: the method of the paper.
    Parameters = 0,
    /// Evaluate every policy and interpolate their actions.
    Actions = 1,
    /// The policy with the greatest blend weight alone.
    Switch = 2,
}

/// How products are summed.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsArithmetic {
    /// The same bits on every machine.
    Reproducible = 0,
    /// Fused multiply-add where the processor has it.
    Fused = 1,
}

/// Choices that are made once for a controller. Fill it with ps_config_default, then change what you want.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PsConfig {
    /// PsArithmetic.
    pub arithmetic: i32,
    /// PsBlendMode.
    pub blend_mode: i32,
    /// Not 0: cache the parameters of a resting blend, as large as one policy.
    pub cache_blends: i32,
    /// Not 0: start the recovery skill when the character has fallen.
    pub auto_recover: i32,
    /// Not 0: start it too when standing up out of a low gait takes longer than 0.1 s, or 2.2 s where the gait has a rising variant.
    pub assist_rise: i32,
    /// Node to start at.
    pub start_node: i32,
    /// Time over which joint targets pass from one policy to the other when a skill starts or ends, seconds, at most 3600; 0 for a
    /// jump.
    pub handover_secs: f32,
    /// Time after a skill in which the character stays in the gait that the skill returns to, and turns little, seconds, at most
    /// 3600; 0 to go on at once.
    pub settle_secs: f32,
    /// Not 0: fast gaits slow down and slow ones speed up while the target lies far off the heading.
    pub turn_assist: i32,
    /// Angle from which the turn assist slows a faster gait down, radians.
    pub turn_begin_radians: f32,
    /// Angle from which it does so fully, radians; more than turn_begin_radians.
    pub turn_full_radians: f32,
    /// Angle from which the turn assist speeds a slower gait up, radians.
    pub turn_slow_begin_radians: f32,
    /// Angle from which it does so fully, radians; more than turn_slow_begin_radians.
    pub turn_slow_full_radians: f32,
    /// Not 0: hold the course and lead into turns.
    pub steering: i32,
    /// How much further the policy is asked to turn, for each radian between the course and the target; at least 0.
    pub steering_lead: f32,
    /// How fast the trim against drift grows, radians a second for each radian between course and target; at least 0.
    pub steering_trim_per_second: f32,
    /// Largest trim, radians; at least 0.
    pub steering_trim_limit_radians: f32,
    /// Time constant of the low-pass on the velocity, seconds; at least 0.
    pub steering_velocity_secs: f32,
    /// Not 0: stop for a moment when something holds the character up.
    pub give_way: i32,
    /// Share of its speed towards the target below which it is held up, in (0, 1).
    pub give_way_held_up_share: f32,
    /// How long it stands then, seconds; 0 to 3600.
    pub give_way_stop_secs: f32,
    /// Not 0: blend gaits with their variants for rough ground where the ground is uneven.
    pub footing: i32,
    /// Not 0: blend gaits with their starting variants while the character sets off from a stand, with their turning variants
    /// while it turns, with their stopping variants while it comes to a stand, with their agile variants while it does not move
    /// yet as it is asked to, with their steady variants once it has for a while, with their resting variants where it is to
    /// go nowhere, and with their rising variants while it stands up out of them.
    pub agility: i32,
    /// Not 0: step back with the pack's first policy that strafes when the body tips over backwards, and catch a push that
    /// drives it off its course by the catching variants of its gaits.
    pub capture_steps: i32,
}

impl Default for PsConfig {
    fn default() -> Self {
        let (config, turn) = (ControllerConfig::default(), TurnAssist::default());
        let (steering, give_way) = (Steering::default(), GiveWay::default());
        Self {
            arithmetic: match config.arithmetic {
                Arithmetic::Reproducible => PsArithmetic::Reproducible as i32,
                Arithmetic::Fused => PsArithmetic::Fused as i32,
            },
            blend_mode: match config.blend_mode {
                BlendMode::Parameters => PsBlendMode::Parameters as i32,
                BlendMode::Actions => PsBlendMode::Actions as i32,
                BlendMode::Switch => PsBlendMode::Switch as i32,
            },
            cache_blends: config.cache_blends.into(),
            auto_recover: config.auto_recover.into(),
            assist_rise: config.assist_rise.into(),
            start_node: id(config.start.index()),
            handover_secs: config.handover_secs,
            settle_secs: config.settle_secs,
            turn_assist: config.turn_assist.is_some().into(),
            turn_begin_radians: turn.begin_radians,
            turn_full_radians: turn.full_radians,
            turn_slow_begin_radians: turn.slow_begin_radians,
            turn_slow_full_radians: turn.slow_full_radians,
            steering: config.steering.is_some().into(),
            steering_lead: steering.lead,
            steering_trim_per_second: steering.trim_per_second,
            steering_trim_limit_radians: steering.trim_limit_radians,
            steering_velocity_secs: steering.velocity_secs,
            give_way: config.give_way.is_some().into(),
            give_way_held_up_share: give_way.held_up_share,
            give_way_stop_secs: give_way.stop_secs,
            footing: config.footing.into(),
            agility: config.agility.into(),
            capture_steps: config.capture_steps.into(),
        }
    }
}

impl PsConfig {
    /// The choices for a controller of `pack`.
    pub(crate) fn checked(&self, pack: &CharacterPack) -> Result<ControllerConfig, PsStatus> {
        let arithmetic =
            [Arithmetic::Reproducible, Arithmetic::Fused][index("kind of arithmetic", self.arithmetic, 2)?];
        let turn = TurnAssist {
            begin_radians: finite("turn_begin_radians", self.turn_begin_radians)?,
            full_radians: finite("turn_full_radians", self.turn_full_radians)?,
            slow_begin_radians: finite("turn_slow_begin_radians", self.turn_slow_begin_radians)?,
            slow_full_radians: finite("turn_slow_full_radians", self.turn_slow_full_radians)?,
        };
        for (field, begin, full) in [
            ("turn_full_radians", turn.begin_radians, turn.full_radians),
            ("turn_slow_full_radians", turn.slow_begin_radians, turn.slow_full_radians),
        ] {
            if self.turn_assist != 0 && begin >= full {
                let text = format_args!("expected {field} above {begin}, found {full}");
                return Err(fail(PsStatus::BadNumber, text));
            }
        }
        let steering = Steering {
            lead: not_negative("steering_lead", self.steering_lead)?,
            trim_per_second: not_negative("steering_trim_per_second", self.steering_trim_per_second)?,
            trim_limit_radians: not_negative(
                "steering_trim_limit_radians",
                self.steering_trim_limit_radians,
            )?,
            velocity_secs: not_negative("steering_velocity_secs", self.steering_velocity_secs)?,
        };
        let held_up_share = finite("give_way_held_up_share", self.give_way_held_up_share)?;
        if self.give_way != 0 && !(held_up_share > 0.0 && held_up_share < 1.0) {
            let text =
                format_args!("expected give_way_held_up_share above 0 and below 1, found {held_up_share}");
            return Err(fail(PsStatus::BadNumber, text));
        }
        let give_way = GiveWay {
            held_up_share,
            stop_secs: not_negative("give_way_stop_secs", self.give_way_stop_secs)?,
        };
        Ok(ControllerConfig {
            arithmetic,
            cache_blends: self.cache_blends != 0,
            auto_recover: self.auto_recover != 0,
            assist_rise: self.assist_rise != 0,
            start: NodeId::new(index("node", self.start_node, pack.graph().nodes().len())?),
            blend_mode: blend_mode(self.blend_mode)?,
            handover_secs: not_negative("handover_secs", self.handover_secs)?,
            settle_secs: not_negative("settle_secs", self.settle_secs)?,
            turn_assist: (self.turn_assist != 0).then_some(turn),
            steering: (self.steering != 0).then_some(steering),
            give_way: (self.give_way != 0).then_some(give_way),
            footing: self.footing != 0,
            agility: self.agility != 0,
            capture_steps: self.capture_steps != 0,
        })
    }
}

/// A number of at least 0.
fn not_negative(name: &str, number: f32) -> Result<f32, PsStatus> {
    if finite(name, number)? < 0.0 {
        return Err(fail(PsStatus::BadNumber, format_args!("expected {name} of at least 0, found {number}")));
    }
    Ok(number)
}

/// A blend mode from outside.
pub(crate) fn blend_mode(mode: i32) -> Result<BlendMode, PsStatus> {
    let modes = [BlendMode::Parameters, BlendMode::Actions, BlendMode::Switch];
    Ok(modes[index("blend mode", mode, modes.len())?])
}

/// Writes the usual choices.
#[unsafe(no_mangle)]
pub extern "C" fn ps_config_default(config: Option<&mut MaybeUninit<PsConfig>>) -> PsStatus {
    guard(|| {
        present("the place of a config", config)?.write(PsConfig::default());
        Ok(())
    })
}
