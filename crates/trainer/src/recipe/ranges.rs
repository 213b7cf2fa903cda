//! The range of every number of a recipe.

use std::path::Path;

use files::quoted;
use toml::Value;

use super::{Recipe, RecipeError};
use crate::toml_file::TomlFileError;

/// Field, least and largest value. A star stands for any name, as in tables of bodies.
const RANGES: &[(&str, f64, f64)] = &[
    ("clips.share", 1e-6, 1e6),
    ("clips.seconds", 0.0, 600.0),
    ("clips.hold_seconds", 0.0, 60.0),
    ("clips.pace", 0.1, 10.0),
    ("clips.side_steps_mps", 0.1, 1.5),
    ("clips.leap.flight", 0.0, 600.0),
    ("clips.leap.seconds", 0.0, 2.0),
    ("phases.samples", 1.0, 1e12),
    ("environment.num_envs", 1.0, 65_536.0),
    ("environment.horizon", 1.0, 1024.0),
    ("environment.episode_ticks", 1.0, 1e6),
    ("environment.exploration.deterministic_share", 0.0, 0.99),
    ("environment.exploration.deterministic_secs", 0.0, 600.0),
    ("environment.command.speed_mps", 0.0, 20.0),
    ("environment.command.target_metres", 0.0, 1000.0),
    ("environment.command.target_secs", 0.0, 3600.0),
    ("environment.command.stop_share", 0.0, 1.0),
    ("environment.command.slow_stop_share", 0.0, 1.0),
    ("environment.command.fast_target_factor", 0.1, 100.0),
    ("environment.command.stick_share", 0.0, 1.0),
    ("environment.command.any_direction_share", 0.0, 1.0),
    ("environment.command.assisted_share", 0.0, 1.0),
    ("environment.command.sweep_share", 0.0, 1.0),
    ("environment.command.edge_sweep_secs", 0.05, 600.0),
    ("environment.command.edge_rest_secs", 0.0, 600.0),
    ("environment.command.jump_share", 0.0, 1.0),
    ("environment.command.edge_secs", 0.0, 60.0),
    ("environment.command.edge_secs_factors", 0.1, 10.0),
    ("environment.command.clock_seconds", 0.0, 600.0),
    ("environment.command.strafe.facing_secs", 0.0, 3600.0),
    ("environment.command.strafe.jump_share", 0.0, 1.0),
    ("environment.command.strafe.aside", 0.05, 2.0),
    ("environment.command.strafe.back", 0.05, 2.0),
    ("environment.command.strafe.turn_rate", 0.0, 20.0),
    ("environment.command.strafe.max_facing_error", 0.1, 3.2),
    ("environment.command.strafe.max_angle", 0.0, 3.2),
    ("environment.reward.task_weight", 0.0, 1.0),
    ("environment.reward.speed_scale_mps", 0.01, 20.0),
    ("environment.reward.turning_style_factor", 0.0, 1.0),
    ("environment.reward.sideways_weight", 0.0, 100.0),
    ("environment.reward.head_speed_share", 0.0, 1.0),
    ("environment.reward.averaging_secs", 0.0, 10.0),
    ("environment.reward.kept_facing_share", 0.0, 1.0),
    ("environment.reward.linear_speed_share", 0.0, 1.0),
    ("environment.reward.strict_facing_share", 0.0, 1.0),
    ("environment.reward.facing_factor", 0.0, 1.0),
    ("environment.reward.turn_rate_rps", 0.0, 20.0),
    ("environment.reward.height_share", 0.0, 1.0),
    ("environment.reward.tracking_weight", 0.0, 1.0),
    ("environment.reward.tracking_share", 0.0, 1.0),
    ("environment.reward.fall_cost", 0.0, 1e4),
    ("environment.reward.foot_slip_cost", 0.0, 100.0),
    ("environment.reward.foot_slip_most_mps", 0.1, 10.0),
    ("environment.reward.standing_root_metres", 0.01, 100.0),
    ("environment.reward.standing_head_metres", 0.01, 100.0),
    ("environment.termination.height_factor", 0.0, 2.0),
    ("environment.termination.min_heights.*", 0.0, 100.0),
    ("environment.termination.fall_metres", 0.0, 100.0),
    ("environment.termination.lying_metres", 0.0, 100.0),
    ("environment.termination.standing_metres", 0.0, 100.0),
    ("environment.termination.down_metres", 0.0, 100.0),
    ("environment.termination.max_tracking_error_metres", 1e-6, 100.0),
    ("environment.reset.other_clips_share", 0.0, 1.0),
    ("environment.reset.standing_share", 0.0, 1.0),
    ("environment.reset.any_node_share", 0.0, 1.0),
    ("environment.reset.limp_share", 0.0, 1.0),
    ("environment.reset.pre_failure_share", 0.0, 1.0),
    ("environment.reset.in_play.share", 0.0, 1.0),
    ("environment.reset.in_play.maximum_speed_mps", 0.1, 20.0),
    ("environment.reset.in_play.least_push", 0.0, 1.0),
    ("environment.reset.in_play.from_behind_share", 0.0, 1.0),
    ("environment.reset.hand_over.share", 0.0, 1.0),
    ("environment.randomisation.terrain_metres", 0.0, 0.5),
    ("environment.randomisation.step_metres", 0.0, 0.5),
    ("environment.randomisation.slope_metres", 0.0, 5.0),
    ("environment.randomisation.dynamics", 0.0, 0.5),
    ("environment.randomisation.latency_share", 0.0, 1.0),
    ("environment.randomisation.long_push_share", 0.0, 1.0),
    ("environment.randomisation.push_secs", 0.0, 1e6),
    ("environment.randomisation.push_newton", 0.0, 5000.0),
    ("environment.meetings.share", 0.0, 1.0),
    ("environment.meetings.pause_secs", 0.0, 600.0),
    ("ppo.gamma", 0.0, 0.9999),
    ("ppo.epochs", 1.0, 64.0),
    ("ppo.minibatch", 1.0, 65_536.0),
    ("ppo.action_std", 1e-4, 2.0),
    ("ppo.target_kl", 1e-6, 10.0),
    ("ppo.learning_rate", 1e-9, 1.0),
    ("ppo.min_learning_rate", 1e-9, 1.0),
    ("ppo.max_learning_rate", 1e-9, 1.0),
    ("ppo.behaviour_cloning", 0.0, 1e6),
    ("ppo.regularisation", 0.0, 1e3),
    ("ppo.symmetry", 0.0, 1e6),
    ("ppo.critic_hidden", 1.0, 2048.0),
    ("discriminator.hidden", 1.0, 2048.0),
    ("discriminator.updates", 0.0, 64.0),
    ("discriminator.batch", 1.0, 16_384.0),
    ("discriminator.noise_std", 0.0, 10.0),
    ("discriminator.replay_size", 1.0, 200_000.0),
];

impl Recipe {
    /// Checks every number.
    pub(super) fn check_ranges(&self, path: &Path) -> Result<(), RecipeError> {
        let wrong = |message: String| TomlFileError::toml(path, message);
        let value = Value::try_from(self).map_err(|e| wrong(e.to_string()))?;
        check(path, &value, "", "")
    }
}

/// Checks the numbers of a value. `field` is what an error names, `key` what the table of ranges knows it by.
fn check(path: &Path, value: &Value, field: &str, key: &str) -> Result<(), RecipeError> {
    let found = match value {
        Value::Integer(number) => *number as f64,
        Value::Float(number) => *number,
        Value::Array(items) => {
            // A list of numbers is one field, a list of tables has its index in the name.
            return items.iter().enumerate().try_for_each(|(index, item)| {
                let listed = matches!(item, Value::Table(_));
                let field = if listed { format!("{field}[{index}]") } else { field.to_owned() };
                check(path, item, &field, key)
            });
        }
        Value::Table(fields) => {
            return fields.iter().try_for_each(|(name, value)| {
                let joined = |prefix: &str| match prefix {
                    "" => name.clone(),
                    prefix => format!("{prefix}.{name}"),
                };
                check(path, value, &joined(field), &joined(key))
            });
        }
        _ => return Ok(()),
    };
    let Some((least, most)) = range(key) else {
        let message = format!("{} has no range", quoted(field));
        return Err(TomlFileError::toml(path, message).into());
    };
    // In single precision, as the fields are; not a number is in no range.
    if (least as f32..=most as f32).contains(&(found as f32)) {
        return Ok(());
    }
    Err(RecipeError::Range { path: path.to_owned(), field: quoted(field), least, most, found })
}

/// The range of a field by its key, as `phases.ppo.gamma` or `clips.share`.
fn range(key: &str) -> Option<(f64, f64)> {
    let in_phase = key.strip_prefix("phases.").filter(|rest| rest.contains('.')).unwrap_or(key);
    let fits = |pattern: &str| match pattern.strip_suffix('*') {
        Some(prefix) => in_phase.strip_prefix(prefix).is_some_and(|name| !name.contains('.')),
        None => pattern == in_phase,
    };
    RANGES.iter().find(|(pattern, ..)| fits(pattern)).map(|(_, least, most)| (*least, *most))
}
