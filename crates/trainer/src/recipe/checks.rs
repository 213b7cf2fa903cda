//! What must hold between the fields of a recipe. The range of each number is checked before.

use super::file::is_plain;
use super::{Phase, Recipe};
use crate::env::OutOf;

/// Whether it holds, the field, what was expected and what was found.
type Check = (bool, &'static str, &'static str, String);

/// Most rows of a rollout: num_envs times horizon.
const MOST_ROWS: usize = 1 << 20;

/// Most hidden layers of critic and discriminators.
const MOST_HIDDEN: usize = 8;

/// Most phases, clips, paths and skills.
const MOST_ENTRIES: usize = 256;

impl Recipe {
    pub(super) fn checks(&self) -> Vec<Check> {
        let mut checks = self.graph_checks();
        if checks.iter().all(|check| check.0) {
            checks.extend(self.phases.iter().flat_map(|phase| self.phase_checks(phase)));
            checks.extend(self.phases.iter().flat_map(|phase| self.reward_checks(phase)));
        }
        checks
    }

    /// Names, clips, paths and phases.
    fn graph_checks(&self) -> Vec<Check> {
        let skills = || self.paths.iter().flatten();
        let named = skills().chain(&self.parent).chain(&self.variant_of);
        let on_a_path = |ends: &[String; 2]| {
            let joined = |pair: &[String]| pair == ends;
            self.paths.iter().any(|path| path.windows(2).any(joined))
        };
        let twice = |path: &Vec<String>| (1..path.len()).any(|i| path[..i].contains(&path[i]));
        let count = |what: usize| (1..=MOST_ENTRIES).contains(&what);
        let (clips, paths) = (self.clips.len(), self.paths.len());
        let names = "lower-case letters, digits and underscores, at most 64";
        vec![
            (is_plain(&self.skill), "skill", names, self.skill.clone()),
            (
                named.clone().all(|n| is_plain(n)),
                "parent, variant_of and paths",
                names,
                format!("{:?} {:?} {:?}", self.parent, self.variant_of, self.paths),
            ),
            (self.clips.iter().all(|c| is_plain(&c.name)), "clips.name", names, format!("{:?}", self.clips)),
            (
                named.clone().all(|n| *n != self.skill),
                "parent, variant_of and paths",
                "other skills",
                self.skill.clone(),
            ),
            (
                self.variant_of.is_none() || (paths == 0 && self.parent.is_none()),
                "variant_of",
                "none beside a parent or paths",
                self.variant_of.clone().unwrap_or_default(),
            ),
            (!self.edge || self.parent.is_some(), "edge", "a parent beside it", "none".into()),
            (
                (clips == 0) != (paths == 0),
                "clips",
                "at least one clip, or paths instead",
                format!("{clips} clips and {paths} paths"),
            ),
            (
                clips <= MOST_ENTRIES && skills().count() <= MOST_ENTRIES,
                "clips and paths",
                "at most 256 entries",
                format!("{clips} clips and {} skills", skills().count()),
            ),
            (
                paths == 0 || self.parent.is_none(),
                "parent",
                "none beside paths",
                self.parent.clone().unwrap_or_default(),
            ),
            (
                self.paths.iter().all(|p| p.len() > 1 && !twice(p)),
                "paths",
                "at least two skills in each, none of them twice",
                format!("{:?}", self.paths),
            ),
            (
                self.halfway.iter().all(on_a_path),
                "halfway",
                "edges of the paths",
                format!("{:?}", self.halfway),
            ),
            (count(self.phases.len()), "phases", "1 to 256 phases", self.phases.len().to_string()),
        ]
    }

    /// One phase, by itself and beside the first one.
    fn phase_checks(&self, phase: &Phase) -> Vec<Check> {
        let Phase { environment: env, ppo, discriminator, .. } = phase;
        let first = self.first();
        let (reset, command) = (&env.reset, &env.command);
        let ordered = |[least, most]: [f32; 2]| least <= most;
        let rows = env.num_envs.saturating_mul(env.horizon);
        let hidden = |sizes: &[usize]| (1..=MOST_HIDDEN).contains(&sizes.len());
        let secs = [command.target_secs, command.edge_sweep_secs, command.edge_rest_secs];
        let between = [secs[0], secs[1], secs[2], command.target_metres, env.exploration.deterministic_secs];
        let same = (env.num_envs, env.horizon, &reset.clips, ppo.minibatch, &ppo.critic_hidden) == {
            let (env, ppo) = (&first.environment, &first.ppo);
            (env.num_envs, env.horizon, &env.reset.clips, ppo.minibatch, &ppo.critic_hidden)
        } && (&discriminator.hidden, discriminator.batch, discriminator.replay_size)
            == (&first.discriminator.hidden, first.discriminator.batch, first.discriminator.replay_size);
        let started = |e: &crate::env::EnvironmentConfig| -> Vec<_> {
            e.reset.hand_over.iter().map(|start| (start.skill.clone(), start.out_of.clone())).collect()
        };
        vec![
            (
                rows <= MOST_ROWS,
                "environment.num_envs times horizon",
                "at most 1048576 rows",
                rows.to_string(),
            ),
            (
                same && started(env) == started(&first.environment),
                "phases",
                "the same num_envs, horizon, minibatch, hidden sizes, batch, replay_size, reset.clips and hand_over but for its shares",
                "others".into(),
            ),
            (
                hidden(&ppo.critic_hidden) && hidden(&discriminator.hidden),
                "critic_hidden and hidden",
                "1 to 8 hidden layers",
                format!("{} and {}", ppo.critic_hidden.len(), discriminator.hidden.len()),
            ),
            (
                between.into_iter().all(ordered),
                "target_metres, target_secs, edge_sweep_secs, edge_rest_secs and deterministic_secs",
                "the least value before the largest",
                format!("{between:?}"),
            ),
            (
                ppo.symmetry == 0.0
                    || (command.clock_seconds > 0.0) == (first.environment.command.clock_seconds > 0.0),
                "ppo.symmetry",
                "0 where this phase has a clock and the first one has none, or the other way round: a clock looks the same in the mirror, a target does not",
                ppo.symmetry.to_string(),
            ),
            (
                ppo.min_learning_rate <= ppo.max_learning_rate,
                "ppo.min_learning_rate and max_learning_rate",
                "the least value before the largest",
                format!("{} and {}", ppo.min_learning_rate, ppo.max_learning_rate),
            ),
        ]
    }

    /// What goes with skills alone, and what with skills that are trained together.
    fn reward_checks(&self, phase: &Phase) -> Vec<Check> {
        let Phase { environment, ppo, .. } = phase;
        let (reward, reset, command) = (&environment.reward, &environment.reset, &environment.command);
        let (together, tracks) = (!self.paths.is_empty(), reward.tracking_weight > 0.0);
        vec![
            (
                together || reward.task_weight + reward.tracking_weight <= 1.0 + 1e-6,
                "environment.reward.task_weight and tracking_weight",
                "weights that sum to at most 1",
                format!("{} and {}", reward.task_weight, reward.tracking_weight),
            ),
            (
                !together || ppo.behaviour_cloning == 0.0,
                "ppo.behaviour_cloning",
                "none beside paths",
                ppo.behaviour_cloning.to_string(),
            ),
            (
                !ppo.symmetrise
                    || (!together && !self.edge && ppo.symmetry > 0.0 && ppo.behaviour_cloning == 0.0),
                "ppo.symmetrise",
                "true beside a symmetry above 0 alone, without paths, edge or behaviour_cloning",
                ppo.symmetrise.to_string(),
            ),
            (
                command.clock_seconds == 0.0 || (!together && reward.tracking_weight > 0.0),
                "environment.command.clock_seconds",
                "0 beside paths and without a tracking_weight: the clock is that of the clip that is tracked",
                command.clock_seconds.to_string(),
            ),
            (
                reset.in_play.is_none_or(|in_play| {
                    let stands = in_play.maximum_speed_mps.is_some();
                    let runs = in_play.out_of == OutOf::Run;
                    !together && if tracks { stands != runs } else { !stands && !runs }
                }),
                "environment.reset.in_play",
                "none beside paths; with a tracking_weight one with a maximum_speed_mps or an out_of of \"run\", and without a tracking_weight one without either",
                format!("{:?}", reset.in_play),
            ),
            (
                reset.in_play.is_none_or(|in_play| !in_play.out_of.pushes())
                    || (phase.environment.randomisation.push_newton > 0.0 && command.stick_share == 1.0),
                "environment.reset.in_play.out_of",
                "a push beside a randomisation.push_newton above 0 and a command.stick_share of 1 alone",
                format!("{:?}", reset.in_play),
            ),
            (
                reset.in_play.is_none_or(|in_play| !in_play.out_of.pushes())
                    || phase.environment.meetings.share == 0.0,
                "environment.reset.in_play.out_of",
                "no push beside meetings: it would not reach the world in which they meet",
                format!("{:?}", reset.in_play),
            ),
            (
                command.clock_seconds == 0.0 || reset.limp_share == 0.0,
                "environment.reset.limp_share",
                "0 beside a clock",
                reset.limp_share.to_string(),
            ),
            (
                !together || reward.tracking_share > 0.0 || reward.tracking_weight == 0.0,
                "environment.reward.tracking_weight",
                "none beside paths without a tracking_share",
                reward.tracking_weight.to_string(),
            ),
            (
                together || reward.tracking_share == 0.0,
                "environment.reward.tracking_share",
                "none without paths",
                reward.tracking_share.to_string(),
            ),
            (
                together || reset.hand_over.is_empty(),
                "environment.reset.hand_over",
                "none without paths",
                format!("{:?}", reset.hand_over),
            ),
            (
                together || reward.tracking_weight == 0.0 || reset.pre_failure_share == 0.0,
                "environment.reset.pre_failure_share",
                "none beside tracking: such a start has no clip to track",
                reset.pre_failure_share.to_string(),
            ),
            (
                reset.clips.len() <= MOST_ENTRIES && reset.clips.iter().all(|name| is_plain(name)),
                "environment.reset.clips",
                "at most 256 names of clips",
                format!("{:?}", reset.clips),
            ),
        ]
    }
}
