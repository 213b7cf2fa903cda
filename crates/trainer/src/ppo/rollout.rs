//! What environments observed, did and were paid in some ticks, and what follows: advantages and returns.

/// How a tick ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Done {
    /// The episode continues.
    #[default]
    No,
    /// It failed: nothing comes after.
    Failed,
    /// It was cut off: what would have come is worth the critic's guess.
    TimedOut,
}

/// `horizon` ticks of `num_envs` environments. Row `step * num_envs + env` of every buffer.
#[derive(Clone, Debug)]
pub struct Rollout {
    /// Ticks.
    pub horizon: usize,
    /// Environments.
    pub num_envs: usize,
    /// Inputs of the policy, `[rows][inputs]`.
    pub inputs: Vec<f32>,
    /// Edge every row acted on: an index into the learner's edges.
    pub edge: Vec<usize>,
    /// Blend weight every row acted with: 0 at the edge's first policy, 1 at its second.
    pub blend: Vec<f32>,
    /// True for rows that act by the mean, without noise. No policy learns from them.
    pub deterministic: Vec<bool>,
    /// Inputs of the critic, `[rows][critic inputs]`: those of the policy and the position on the graph.
    pub critic_inputs: Vec<f32>,
    /// Actions taken, `[rows][actions]`.
    pub actions: Vec<f32>,
    /// Mean of the distribution they were drawn from.
    pub means: Vec<f32>,
    /// Targets of behaviour cloning, `[rows][actions]`; NaN in rows without one. Empty without behaviour cloning.
    pub cloning_targets: Vec<f32>,
    /// Reward of every row.
    pub rewards: Vec<f32>,
    /// How every row ended.
    pub done: Vec<Done>,
    /// Critic inputs after every row that timed out, and its row.
    pub cut_off: Vec<(usize, Vec<f32>)>,
    /// Critic inputs after the last tick, `[num_envs][critic inputs]`.
    pub last_critic_inputs: Vec<f32>,
    /// The critic's value of every row.
    pub values: Vec<f32>,
    /// Advantage of every row.
    pub advantages: Vec<f32>,
    /// Return of every row: what the critic should have said.
    pub returns: Vec<f32>,
    next_values: Vec<f32>,
}

impl Rollout {
    /// Empty buffers for policies with so many inputs and actions, and a critic with so many inputs.
    #[must_use]
    pub fn new(
        (horizon, num_envs): (usize, usize),
        (inputs, critic_inputs): (usize, usize),
        actions: usize,
    ) -> Self {
        let rows = horizon * num_envs;
        let scalar = vec![0.0; rows];
        Self {
            horizon,
            num_envs,
            inputs: vec![0.0; rows * inputs],
            edge: vec![0; rows],
            blend: vec![1.0; rows],
            deterministic: vec![false; rows],
            critic_inputs: vec![0.0; rows * critic_inputs],
            actions: vec![0.0; rows * actions],
            means: vec![0.0; rows * actions],
            cloning_targets: Vec::new(),
            rewards: scalar.clone(),
            done: vec![Done::No; rows],
            cut_off: Vec::new(),
            last_critic_inputs: vec![0.0; num_envs * critic_inputs],
            values: scalar.clone(),
            advantages: scalar.clone(),
            returns: scalar.clone(),
            next_values: scalar,
        }
    }

    /// Rows in all.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.horizon * self.num_envs
    }

    /// Forgets which rows timed out, before the next ticks are recorded.
    pub fn clear(&mut self) {
        self.cut_off.clear();
    }

    /// Records what tick `step` brought: how it ended, and for those cut off the critic's inputs afterwards.
    ///
    /// # Panics
    /// When `done` has not one entry for each character.
    pub fn record(&mut self, step: usize, done: &[Done], critic_inputs_after: &[f32]) {
        assert_eq!(done.len(), self.num_envs, "one end for each environment");
        let first = step * self.num_envs;
        self.done[first..first + self.num_envs].copy_from_slice(done);
        let len = critic_inputs_after.len() / self.num_envs;
        for (i, _) in done.iter().enumerate().filter(|(_, d)| **d == Done::TimedOut) {
            self.cut_off.push((first + i, critic_inputs_after[i * len..(i + 1) * len].to_vec()));
        }
    }

    /// Generalised advantage estimation over rewards and values that are there already. `last` holds the values after
    /// the last tick, `cut_off` those after the rows of [`Rollout::cut_off`].
    pub fn estimate_advantages(&mut self, gamma: f32, lambda: f32, last: &[f32], cut_off: &[f32]) {
        let n = self.num_envs;
        let rows = self.rows();
        self.next_values[..rows - n].copy_from_slice(&self.values[n..]);
        self.next_values[rows - n..].copy_from_slice(last);
        for ((row, _), value) in self.cut_off.iter().zip(cut_off) {
            self.next_values[*row] = *value;
        }
        for env in 0..n {
            let mut advantage = 0.0;
            for row in (0..self.horizon).rev().map(|step| step * n + env) {
                let next = if self.done[row] == Done::Failed { 0.0 } else { self.next_values[row] };
                let td_error = self.rewards[row] + gamma * next - self.values[row];
                let carried = if self.done[row] == Done::No { gamma * lambda * advantage } else { 0.0 };
                advantage = td_error + carried;
                self.advantages[row] = advantage;
                self.returns[row] = advantage + self.values[row];
            }
        }
    }

    /// Shifts and scales the advantages to mean 0 and deviation 1; those of deterministic rows, which explore nothing, become 0.
    pub fn normalise_advantages(&mut self) {
        let tried =
            || self.advantages.iter().zip(&self.deterministic).filter(|(_, deterministic)| !**deterministic);
        let n = tried().count().max(1) as f64;
        let mean = tried().map(|(a, _)| f64::from(*a)).sum::<f64>() / n;
        let variance = tried().map(|(a, _)| (f64::from(*a) - mean).powi(2)).sum::<f64>() / n;
        let deviation = variance.sqrt() + 1e-6;
        for (a, deterministic) in self.advantages.iter_mut().zip(&self.deterministic) {
            *a = if *deterministic { 0.0 } else { ((f64::from(*a) - mean) / deviation) as f32 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rollout(rewards: &[f32], values: &[f32], done: &[Done]) -> Rollout {
        let mut rollout = Rollout::new((rewards.len(), 1), (1, 2), 1);
        rollout.rewards.copy_from_slice(rewards);
        rollout.values.copy_from_slice(values);
        rollout.done.copy_from_slice(done);
        rollout
    }

    #[test]
    fn with_lambda_one_the_return_is_the_discounted_sum() {
        let mut r = rollout(&[1.0, 2.0, 3.0], &[0.5, -1.0, 0.3], &[Done::No; 3]);
        r.estimate_advantages(0.9, 1.0, &[10.0], &[]);
        assert!((r.returns[0] - (1.0 + 0.9 * 2.0 + 0.81 * 3.0 + 0.729 * 10.0)).abs() < 1e-5);
    }

    #[test]
    fn with_lambda_zero_the_advantage_is_the_surprise() {
        let mut r = rollout(&[1.0, 2.0], &[0.5, -1.0], &[Done::No; 2]);
        r.estimate_advantages(0.9, 0.0, &[10.0], &[]);
        assert!((r.advantages[0] - (1.0 - 0.9 - 0.5)).abs() < 1e-6);
        assert!((r.advantages[1] - (2.0 + 9.0 + 1.0)).abs() < 1e-6);
    }

    #[test]
    fn a_failure_is_worth_nothing_and_a_time_out_the_guess() {
        let mut r = rollout(&[1.0, 2.0, 3.0], &[0.0; 3], &[Done::Failed, Done::TimedOut, Done::No]);
        r.cut_off.push((1, Vec::new()));
        r.estimate_advantages(0.5, 1.0, &[100.0], &[8.0]);
        assert_eq!(r.returns, [1.0, 2.0 + 4.0, 3.0 + 50.0]);
    }

    #[test]
    fn characters_do_not_mix() {
        let mut r = Rollout::new((2, 2), (1, 2), 1);
        r.rewards.copy_from_slice(&[1.0, 10.0, 2.0, 20.0]);
        r.estimate_advantages(1.0, 1.0, &[0.0, 0.0], &[]);
        assert_eq!(r.returns, [3.0, 30.0, 2.0, 20.0]);
        r.normalise_advantages();
        assert!(r.advantages.iter().sum::<f32>().abs() < 1e-5);
    }

    #[test]
    fn quiet_rows_have_returns_but_no_advantage() {
        let mut r = rollout(&[1.0, 5.0, 3.0], &[0.0; 3], &[Done::Failed; 3]);
        r.deterministic[1] = true;
        r.estimate_advantages(0.9, 1.0, &[0.0], &[]);
        r.normalise_advantages();
        assert_eq!(r.returns, [1.0, 5.0, 3.0]);
        assert!(r.advantages[1] == 0.0 && (r.advantages[0] + 1.0).abs() < 1e-5, "{:?}", r.advantages);
    }
}
