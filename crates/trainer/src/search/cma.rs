//! CMA-ES (Hansen, "The CMA Evolution Strategy: A Tutorial", 2016): candidates are drawn from a normal distribution that moves to the best of
//! them and takes on the shape of the steps that helped.

use random::Rng;

/// Stream of the generator.
const STREAM: u64 = 61;

/// The distribution, and the candidates of the generation that is under way.
#[derive(Clone, Debug)]
pub struct Cma {
    mean: Vec<f64>,
    spread: f64,
    covariance: Matrix,
    covariance_path: Vec<f64>,
    spread_path: Vec<f64>,
    generation: i32,
    rng: Rng,
    /// Steps in units of the spread that were asked for in this generation, and their costs as far as they are told.
    steps: Vec<Vec<f64>>,
    costs: Vec<f64>,
}

/// A square matrix, row by row.
#[derive(Clone, Debug)]
struct Matrix {
    size: usize,
    values: Vec<f64>,
}

impl Matrix {
    fn identity(size: usize) -> Self {
        let mut values = vec![0.0; size * size];
        values.iter_mut().step_by(size + 1).for_each(|v| *v = 1.0);
        Self { size, values }
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.size..(i + 1) * self.size]
    }

    /// The lower triangle L with `L L^T` equal to this one. A pivot that rounding has made zero or less counts as a tiny one.
    fn cholesky(&self) -> Self {
        let n = self.size;
        let mut lower = Self { size: n, values: vec![0.0; n * n] };
        for i in 0..n {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| lower.row(i)[k] * lower.row(j)[k]).sum();
                let left = self.row(i)[j] - known;
                let value = if i == j { left.max(1e-20).sqrt() } else { left / lower.row(j)[j] };
                lower.values[i * n + j] = value;
            }
        }
        lower
    }

    /// This lower triangle times `x`.
    fn times(&self, x: &[f64]) -> Vec<f64> {
        (0..self.size).map(|i| dot(self.row(i), x)).collect()
    }

    /// What this lower triangle makes `b` of.
    fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x = Vec::with_capacity(self.size);
        for (i, b) in b.iter().enumerate() {
            let known = dot(&self.row(i)[..i], &x);
            x.push((b - known) / self.row(i)[i]);
        }
        x
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

impl Cma {
    /// Starts at `mean` with a standard deviation of `spread` in every number.
    ///
    /// # Panics
    /// When `mean` is empty, or `spread` is not positive.
    #[must_use]
    pub fn new(mean: Vec<f64>, spread: f64, seed: u64) -> Self {
        assert!(!mean.is_empty() && spread > 0.0, "numbers to search and a positive spread");
        let size = mean.len();
        Self {
            mean,
            spread,
            covariance: Matrix::identity(size),
            covariance_path: vec![0.0; size],
            spread_path: vec![0.0; size],
            generation: 0,
            rng: Rng::new(seed, STREAM),
            steps: Vec::new(),
            costs: Vec::new(),
        }
    }

    /// Candidates of a generation.
    #[must_use]
    pub fn population(&self) -> usize {
        4 + (3.0 * (self.mean.len() as f64).ln()) as usize
    }

    /// The next candidate. The first one is the start. Its cost has to be told before the next one.
    ///
    /// # Panics
    /// When the candidate before it was not told.
    pub fn ask(&mut self) -> Vec<f64> {
        assert_eq!(self.steps.len(), self.costs.len(), "a candidate is told before the next one");
        let size = self.mean.len();
        let step = if self.generation == 0 && self.steps.is_empty() {
            vec![0.0; size]
        } else {
            let normal: Vec<f64> = (0..size).map(|_| f64::from(self.rng.normal())).collect();
            self.covariance.cholesky().times(&normal)
        };
        let candidate = self.mean.iter().zip(&step).map(|(m, y)| m + self.spread * y).collect();
        self.steps.push(step);
        candidate
    }

    /// Takes the cost of the candidate that was asked for last. One that is not finite counts as the worst.
    ///
    /// # Panics
    /// When no candidate waits for its cost.
    pub fn tell(&mut self, cost: f64) {
        assert!(self.steps.len() > self.costs.len(), "a candidate to tell the cost of");
        self.costs.push(if cost.is_finite() { cost } else { f64::MAX });
        if self.costs.len() == self.population() {
            self.adapt();
        }
    }

    /// Moves on to the next generation.
    fn adapt(&mut self) {
        let n = self.mean.len() as f64;
        let costs = core::mem::take(&mut self.costs);
        let steps = core::mem::take(&mut self.steps);
        let mut order: Vec<usize> = (0..costs.len()).collect();
        order.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        let parents = &order[..order.len() / 2];
        let raw: Vec<f64> =
            (1..=parents.len()).map(|rank| (parents.len() as f64 + 0.5).ln() - (rank as f64).ln()).collect();
        let total: f64 = raw.iter().sum();
        let weights: Vec<f64> = raw.iter().map(|w| w / total).collect();
        let effective = 1.0 / dot(&weights, &weights);

        let path_rate = 4.0 / (n + 4.0);
        let spread_rate = (effective + 2.0) / (n + effective + 5.0);
        let path_share = 2.0 / ((n + 1.3).powi(2) + effective);
        let steps_share = 2.0 * (effective - 2.0 + 1.0 / effective) / ((n + 2.0).powi(2) + effective);
        let steps_share = steps_share.min(1.0 - path_share);
        let damping = 1.0 + spread_rate;
        // Mean length of a normal vector.
        let expected = n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));

        let mean_step: Vec<f64> = (0..self.mean.len())
            .map(|i| parents.iter().zip(&weights).map(|(p, w)| w * steps[*p][i]).sum())
            .collect();
        self.generation += 1;
        let whitened = self.covariance.cholesky().solve(&mean_step);
        let gain = (spread_rate * (2.0 - spread_rate) * effective).sqrt();
        for (path, white) in self.spread_path.iter_mut().zip(&whitened) {
            *path = (1.0 - spread_rate) * *path + gain * white;
        }
        let length = norm(&self.spread_path);
        let settled = (1.0 - (1.0 - spread_rate).powi(2 * self.generation)).sqrt();
        let moves = if length / settled < (1.4 + 2.0 / (n + 1.0)) * expected { 1.0 } else { 0.0 };
        let gain = moves * (path_rate * (2.0 - path_rate) * effective).sqrt();
        for (path, step) in self.covariance_path.iter_mut().zip(&mean_step) {
            *path = (1.0 - path_rate) * *path + gain * step;
        }
        let size = self.mean.len();
        for (at, value) in self.covariance.values.iter_mut().enumerate() {
            let (i, j) = (at / size, at % size);
            let of_path = self.covariance_path[i] * self.covariance_path[j];
            let of_steps: f64 =
                parents.iter().zip(&weights).map(|(p, w)| w * steps[*p][i] * steps[*p][j]).sum();
            *value =
                (1.0 - path_share - steps_share) * *value + path_share * of_path + steps_share * of_steps;
        }
        self.mean.iter_mut().zip(&mean_step).for_each(|(m, y)| *m += self.spread * y);
        self.spread *= ((spread_rate / damping) * (length / expected - 1.0)).exp();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least cost found in so many tries.
    fn least(start: &[f64], tries: usize, cost: impl Fn(&[f64]) -> f64) -> f64 {
        let mut cma = Cma::new(start.to_vec(), 0.3, 1);
        let mut least = f64::INFINITY;
        for _ in 0..tries {
            let cost = cost(&cma.ask());
            cma.tell(cost);
            least = least.min(cost);
        }
        least
    }

    #[test]
    fn it_finds_the_bottom_of_a_long_valley() {
        // Rosenbrock's function: narrow, and bent.
        let valley = |x: &[f64]| {
            x.windows(2).map(|w| 100.0 * (w[1] - w[0] * w[0]).powi(2) + (1.0 - w[0]).powi(2)).sum::<f64>()
        };
        assert!(least(&[0.0; 5], 4000, valley) < 1e-8);
        // A hundred times as steep along one axis as along another, and turned.
        let ellipse = |x: &[f64]| (x[0] + x[1] - 3.0).powi(2) * 1e4 + (x[0] - x[1]).powi(2);
        assert!(least(&[0.0; 2], 1500, ellipse) < 1e-10);
    }

    #[test]
    fn the_first_candidate_is_the_start_and_a_seed_repeats() {
        let run = |seed| {
            let mut cma = Cma::new(vec![1.0, 2.0], 0.5, seed);
            let candidates: Vec<Vec<f64>> = (0..20)
                .map(|_| {
                    let candidate = cma.ask();
                    cma.tell(candidate[0] + candidate[1]);
                    candidate
                })
                .collect();
            candidates
        };
        assert_eq!(run(1)[0], [1.0, 2.0]);
        assert_eq!(run(1), run(1));
        assert_ne!(run(1)[1], run(2)[1]);
    }

    #[test]
    fn costs_that_are_not_numbers_are_survived() {
        let mut cma = Cma::new(vec![0.0; 3], 0.5, 1);
        for index in 0..200 {
            let candidate = cma.ask();
            assert!(candidate.iter().all(|x| x.is_finite()), "{candidate:?}");
            cma.tell(if index % 3 == 0 { f64::NAN } else { norm(&candidate) });
        }
    }
}
