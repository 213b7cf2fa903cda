//! What must hold for the numbers of a recipe.

use super::Recipe;

/// Whether it holds, the field, what was expected and what was found.
type Check = (bool, &'static str, &'static str, String);

impl Recipe {
    pub(super) fn checks(&self) -> Vec<Check> {
        let (env, ppo, disc) = (&self.environment, &self.ppo, &self.discriminator);
        let plain = |s: &str| {
            !s.is_empty() && s.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        };
        let unit = |x: f32| (0.0..=1.0).contains(&x);
        let positive = |x: f32| x.is_finite() && x > 0.0;
        let ordered = |[a, b]: [f32; 2]| a.is_finite() && b.is_finite() && 0.0 <= a && a <= b;
        vec![
            (plain(&self.skill), "skill", "lower-case letters, digits and underscores", self.skill.clone()),
            (!self.edge || self.parent.is_some(), "edge", "a parent beside it", "none".into()),
            (
                self.clips.is_empty() != self.paths.is_empty(),
                "clips",
                "at least one clip, or paths instead",
                format!("{} clips and {} paths", self.clips.len(), self.paths.len()),
            ),
            (
                self.paths.is_empty() || self.parent.is_none(),
                "parent",
                "none beside paths",
                self.parent.clone().unwrap_or_default(),
            ),
            (
                self.paths.iter().all(|p| p.len() > 1),
                "paths",
                "at least two skills in each",
                format!("{:?}", self.paths),
            ),
            (
                self.frozen.iter().all(|name| self.paths.iter().flatten().any(|n| n == name)),
                "frozen",
                "skills of the paths",
                format!("{:?}", self.frozen),
            ),
            (
                self.clips.iter().all(|c| positive(c.share)),
                "clips.share",
                "positive shares",
                format!("{:?}", self.clips),
            ),
            (
                self.phases
                    .iter()
                    .all(|p| p.terrain_metres == 0.0 || (0.01..=0.5).contains(&p.terrain_metres)),
                "phases.terrain_metres",
                "0, or 0.01 to 0.5",
                format!("{:?}", self.phases),
            ),
            (
                env.push_secs >= 0.0 && (0.0..=5000.0).contains(&env.push_newton),
                "environment.push_secs and push_newton",
                "a time of at least 0, and 0 to 5000 newton",
                format!("{} and {}", env.push_secs, env.push_newton),
            ),
            (
                self.paths.is_empty() || self.phases.iter().all(|p| p.guide == 0.0),
                "phases.guide",
                "none beside paths",
                format!("{:?}", self.phases),
            ),
            (
                self.paths.is_empty()
                    || env.imitators > 0.0
                    || self.phases.iter().all(|p| p.imitation.unwrap_or(env.imitation) == 0.0),
                "phases.imitation",
                "none beside paths without imitators",
                format!("{:?}", self.phases),
            ),
            (
                env.start.after.as_ref().is_none_or(|after| unit(after.share) && !self.paths.is_empty()),
                "environment.start.after",
                "a share in [0, 1], beside paths",
                format!("{:?}", env.start.after),
            ),
            (
                env.slide_cost.is_finite() && env.slide_cost >= 0.0,
                "environment.slide_cost",
                "a weight of at least 0",
                env.slide_cost.to_string(),
            ),
            (
                self.phases.iter().all(|p| (0.0..1.0).contains(&p.quiet.unwrap_or(env.quiet)))
                    && ordered(env.quiet_secs),
                "quiet and environment.quiet_secs",
                "a share below 1, and seconds from least to most",
                format!("{}, {:?} and {:?}", env.quiet, env.quiet_secs, self.phases),
            ),
            (
                unit(env.imitators) && (env.imitators == 0.0 || !self.paths.is_empty()),
                "environment.imitators",
                "a share, beside paths",
                env.imitators.to_string(),
            ),
            (
                self.phases.iter().all(|p| p.guide.is_finite() && p.guide >= 0.0),
                "phases.guide",
                "a weight of at least 0",
                format!("{:?}", self.phases),
            ),
            (!self.phases.is_empty(), "phases", "at least one phase", "none".into()),
            (
                self.phases.iter().all(|p| {
                    let imitation = p.imitation.unwrap_or(env.imitation);
                    let beside = if self.paths.is_empty() { imitation } else { 0.0 };
                    unit(p.task) && unit(imitation) && unit(p.task + beside)
                }),
                "phases.task and imitation",
                "weights in [0, 1] that sum to at most 1",
                format!("{:?}", self.phases),
            ),
            (
                (1..=65_536).contains(&env.characters),
                "environment.characters",
                "1 to 65536",
                env.characters.to_string(),
            ),
            ((1..=1024).contains(&env.steps), "environment.steps", "1 to 1024", env.steps.to_string()),
            (
                env.episode_ticks > 0 && self.phases.iter().all(|p| p.episode_ticks != Some(0)),
                "episode_ticks",
                "at least 1",
                "0".into(),
            ),
            (
                self.phases.iter().all(|p| {
                    let cost = p.fall_cost.unwrap_or(env.fall_cost);
                    cost.is_finite() && cost >= 0.0
                }),
                "fall_cost",
                "rewards of at least 0",
                format!("{} and {:?}", env.fall_cost, self.phases),
            ),
            (
                self.phases.iter().all(|p| {
                    let imitates = p.imitation.unwrap_or(env.imitation) > 0.0;
                    !imitates || !self.paths.is_empty() || p.mishap.unwrap_or(env.start.mishap) == 0.0
                }),
                "mishap",
                "none beside imitation: what was to be imitated is forgotten",
                env.start.mishap.to_string(),
            ),
            (
                positive(env.least_width_mps) && positive(env.lost_metres),
                "environment.least_width_mps and lost_metres",
                "a positive speed and a positive distance",
                format!("{} and {}", env.least_width_mps, env.lost_metres),
            ),
            (env.speed_mps.is_finite(), "environment.speed_mps", "a finite speed", env.speed_mps.to_string()),
            (
                ordered(env.target_metres),
                "environment.target_metres",
                "least and most distance",
                format!("{:?}", env.target_metres),
            ),
            (
                ordered(env.target_secs),
                "environment.target_secs",
                "least and most time",
                format!("{:?}", env.target_secs),
            ),
            (
                [
                    env.height,
                    env.strict_facing,
                    env.sweep,
                    env.stop,
                    env.stick,
                    env.jump,
                    env.start.other,
                    env.start.launched,
                    env.start.anywhere,
                    env.start.ragdoll,
                    env.start.mishap,
                ]
                .into_iter()
                .all(unit),
                "environment.height, strict_facing, sweep, stop, stick, jump and start",
                "shares in [0, 1]",
                format!(
                    "{}, {}, {}, {}, {}, {} and {:?}",
                    env.height, env.strict_facing, env.sweep, env.stop, env.stick, env.jump, env.start
                ),
            ),
            (
                ordered(env.edge_sweep_secs)
                    && ordered(env.edge_rest_secs)
                    && ordered(env.sweep_secs)
                    && env.edge_sweep_secs[0].min(env.sweep_secs[0]) > 0.0
                    && (0.0..60.0).contains(&env.edge_secs),
                "environment.sweep_secs, edge_sweep_secs, edge_rest_secs and edge_secs",
                "least and most time above 0, twice, least and most time, and 0 to 60 s",
                format!(
                    "{:?}, {:?}, {:?} and {}",
                    env.sweep_secs, env.edge_sweep_secs, env.edge_rest_secs, env.edge_secs
                ),
            ),
            ((0.0..1.0).contains(&ppo.gamma), "ppo.gamma", "a discount in [0, 1)", ppo.gamma.to_string()),
            ((0.0..1.0).contains(&ppo.average), "ppo.average", "a share in [0, 1)", ppo.average.to_string()),
            (unit(ppo.gae_lambda), "ppo.gae_lambda", "a discount in [0, 1]", ppo.gae_lambda.to_string()),
            (positive(ppo.deviation), "ppo.deviation", "a positive deviation", ppo.deviation.to_string()),
            (
                self.phases.iter().all(|p| {
                    let shares = [p.ragdoll, p.other, p.mishap];
                    p.deviation.is_none_or(positive) && shares.into_iter().flatten().all(unit)
                }),
                "phases.deviation, ragdoll, other and mishap",
                "a positive deviation and shares in [0, 1]",
                format!("{:?}", self.phases),
            ),
            (
                ppo.epochs > 0 && ppo.minibatch > 0,
                "ppo.epochs and minibatch",
                "at least 1",
                format!("{} and {}", ppo.epochs, ppo.minibatch),
            ),
            (
                positive(ppo.actor_rate) && positive(ppo.critic_rate),
                "ppo.actor_rate and critic_rate",
                "positive rates",
                format!("{} and {}", ppo.actor_rate, ppo.critic_rate),
            ),
            (
                ppo.regularisation >= 0.0,
                "ppo.regularisation",
                "a weight of at least 0",
                ppo.regularisation.to_string(),
            ),
            (
                !ppo.critic_hidden.is_empty() && !disc.hidden.is_empty(),
                "hidden",
                "at least one hidden layer",
                "none".into(),
            ),
            (
                disc.rows > 0 && disc.replay > 0,
                "discriminator.rows and replay",
                "at least 1",
                format!("{} and {}", disc.rows, disc.replay),
            ),
        ]
    }
}
