use random::Rng;

use super::super::{Done, Mirror, PpoConfig, SignedPermutation};
use super::*;
use crate::nn::Network;

const CHARACTERS: usize = 64;
const STEPS: usize = 16;

/// A cart on a line: it sees where the goal is, its action moves it, and being near the goal pays.
struct Cart {
    position: f32,
    goal: f32,
    age: usize,
}

impl Cart {
    fn new(rng: &mut Rng) -> Self {
        Self { position: rng.range(-1.0, 1.0), goal: rng.range(-1.0, 1.0), age: 0 }
    }
}

fn learner(seed: u64) -> Learner {
    let config = PpoConfig {
        gamma: 0.9,
        action_std: 0.3,
        minibatch: 256,
        learning_rate: 1e-3,
        max_learning_rate: 5e-3,
        ..PpoConfig::default()
    };
    let mut rng = Rng::new(seed, 0);
    let actor = Network::new(&[2, 32, 1], 0.01, &mut rng);
    let critic = Network::new(&[3, 32, 1], 0.01, &mut rng);
    Learner::new(config, vec![Actor::learning(actor, None)], vec![[0, 0]], critic, rng)
}

/// One iteration; returns the mean reward.
fn iterate(learner: &mut Learner, carts: &mut [Cart], rollout: &mut Rollout, rng: &mut Rng) -> f32 {
    let observe = |carts: &[Cart], out: &mut [f32], width: usize| {
        for (cart, row) in carts.iter().zip(out.chunks_exact_mut(width)) {
            row.fill(1.0);
            row[..2].copy_from_slice(&[cart.position, cart.goal]);
        }
    };
    rollout.clear();
    for step in 0..STEPS {
        let rows = step * CHARACTERS..(step + 1) * CHARACTERS;
        observe(carts, &mut rollout.inputs[2 * rows.start..2 * rows.end], 2);
        observe(carts, &mut rollout.critic_inputs[3 * rows.start..3 * rows.end], 3);
        learner.act(rollout, step);
        let mut done = [Done::No; CHARACTERS];
        for (i, cart) in carts.iter_mut().enumerate() {
            cart.position += 0.3 * rollout.actions[rows.start + i].clamp(-1.0, 1.0);
            cart.age += 1;
            rollout.rewards[rows.start + i] = (-4.0 * (cart.position - cart.goal).powi(2)).exp();
            done[i] = match cart.age {
                20.. => Done::TimedOut,
                _ if cart.position.abs() > 2.0 => Done::Failed,
                _ => Done::No,
            };
        }
        observe(carts, &mut rollout.last_critic_inputs, 3);
        let after = rollout.last_critic_inputs.clone();
        rollout.record(step, &done, &after);
        for (cart, _) in carts.iter_mut().zip(done).filter(|(_, d)| *d != Done::No) {
            *cart = Cart::new(rng);
        }
    }
    observe(carts, &mut rollout.last_critic_inputs, 3);
    learner.compute_returns(rollout);
    learner.update(rollout);
    rollout.rewards.iter().sum::<f32>() / rollout.rewards.len() as f32
}

fn train(seed: u64, iterations: usize) -> (f32, f32, Learner) {
    let mut learner = learner(seed);
    let mut rng = Rng::new(seed, 1);
    let mut carts: Vec<Cart> = (0..CHARACTERS).map(|_| Cart::new(&mut rng)).collect();
    let mut rollout = Rollout::new((STEPS, CHARACTERS), (2, 3), 1);
    let first = iterate(&mut learner, &mut carts, &mut rollout, &mut rng);
    let last = (1..iterations).map(|_| iterate(&mut learner, &mut carts, &mut rollout, &mut rng)).last();
    (first, last.unwrap_or(first), learner)
}

#[test]
fn a_tiny_environment_is_solved() {
    let (first, last, _) = train(1, 120);
    assert!(first < 0.5 && last > 0.85, "mean reward from {first} to {last}");
}

#[test]
fn a_seed_repeats_itself_bit_by_bit() {
    let (a, b) = (train(2, 3).2, train(2, 3).2);
    assert_eq!(a.actor(), b.actor());
    assert_eq!(a.critic, b.critic);
    assert_ne!(a.actor(), train(3, 3).2.actor());
}

#[test]
fn one_thread_gives_what_many_give() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(|| train(4, 2).2).actor(), train(4, 2).2.actor());
}

#[test]
fn a_strong_pull_keeps_a_child_at_its_parent() {
    let distance = |regularisation: f32| {
        let mut learner = learner(5);
        learner.config.regularisation = regularisation;
        let parent = learner.actor().clone();
        learner = Learner::new(
            learner.config,
            vec![Actor::frozen(parent.clone()), Actor::learning(parent, Some(0))],
            vec![[1, 1]],
            learner.critic,
            learner.rng,
        );
        let mut rng = Rng::new(5, 1);
        let mut carts: Vec<Cart> = (0..CHARACTERS).map(|_| Cart::new(&mut rng)).collect();
        let mut rollout = Rollout::new((STEPS, CHARACTERS), (2, 3), 1);
        for _ in 0..20 {
            iterate(&mut learner, &mut carts, &mut rollout, &mut rng);
        }
        learner.distance_to_parent()
    };
    let (free, held) = (distance(0.0), distance(1.0));
    assert!(held < 0.2 * free, "{free} {held}");
}

#[test]
fn a_guide_leads_the_policy_and_rows_without_one_do_not() {
    let led = |behaviour_cloning: f32| {
        let mut learner = learner(6);
        learner.config.behaviour_cloning = 100.0;
        let mut rng = Rng::new(6, 1);
        let mut carts: Vec<Cart> = (0..CHARACTERS).map(|_| Cart::new(&mut rng)).collect();
        let mut rollout = Rollout::new((STEPS, CHARACTERS), (2, 3), 1);
        rollout.cloning_targets = vec![behaviour_cloning; STEPS * CHARACTERS];
        for _ in 0..20 {
            iterate(&mut learner, &mut carts, &mut rollout, &mut rng);
        }
        rollout.means.iter().sum::<f32>() / rollout.means.len() as f32
    };
    assert!((led(0.5) - 0.5).abs() < 0.05, "{}", led(0.5));
    assert!(led(f32::NAN).abs() < 0.3, "{}", led(f32::NAN));
}

/// The mirror image of a cart: everything negated.
fn mirror() -> Mirror {
    let negated = |count: usize| SignedPermutation::new((0..count).map(|i| (i, -1.0)).collect());
    Mirror { inputs: negated(2), actions: negated(1) }
}

#[test]
fn a_policy_learns_the_mean_of_its_teacher_and_the_mirror_image_whatever_it_is_paid() {
    let mut learner = learner(8);
    learner.mirror = Some(mirror());
    let mut rng = Rng::new(8, 1);
    let teacher = Network::new(&[2, 32, 1], 1.0, &mut rng);
    let act = |learner: &mut Learner, input: [f32; 2]| {
        let mut mean = [0.0];
        learner.means_into(&input, &[0], &[0.0], &mut mean);
        mean[0]
    };
    learner.actors[0].network.clone_from(&teacher);
    let [seen, mirrored] = [[0.2, -0.1], [-0.2, 0.1]];
    let [before, before_mirrored] = [act(&mut learner, seen), act(&mut learner, mirrored)];
    assert!((before + before_mirrored).abs() > 0.05, "the teacher is not symmetric");
    learner.teacher = Some(teacher);
    (learner.config.symmetrise, learner.config.symmetry) = (true, 1.0);
    learner.config.max_learning_rate = 3e-3;
    let mut rollout = Rollout::new((STEPS, CHARACTERS), (2, 3), 1);
    rollout.cloning_targets = vec![f32::NAN; STEPS * CHARACTERS];
    for _ in 0..200 {
        for input in &mut rollout.inputs {
            *input = 0.3 * rng.normal();
        }
        for step in 0..STEPS {
            learner.act(&mut rollout, step);
            learner.symmetric_targets(&mut rollout, step);
        }
        rollout.advantages.iter_mut().for_each(|advantage| *advantage = rng.normal());
        learner.update(&rollout);
    }
    let expected = 0.5 * (before - before_mirrored);
    let [after, after_mirrored] = [act(&mut learner, seen), act(&mut learner, mirrored)];
    assert!((after - expected).abs() < 0.02, "{after}, {expected} of {before}");
    assert!((after_mirrored + expected).abs() < 0.02, "{after_mirrored}, {} of {before_mirrored}", -expected);
}

#[test]
fn a_symmetry_loss_makes_a_policy_act_in_the_mirror_as_its_mirror_image() {
    let asymmetry = |symmetry: f32| {
        let mut learner = learner(7);
        learner.config.symmetry = symmetry;
        learner.mirror = Some(mirror());
        let mut rng = Rng::new(7, 1);
        let mut carts: Vec<Cart> = (0..CHARACTERS).map(|_| Cart::new(&mut rng)).collect();
        let mut rollout = Rollout::new((STEPS, CHARACTERS), (2, 3), 1);
        for _ in 0..40 {
            iterate(&mut learner, &mut carts, &mut rollout, &mut rng);
        }
        let mut means = [0.0; 2];
        learner.means_into(&[0.5, -0.3, -0.5, 0.3], &[0; 2], &[0.0; 2], &mut means);
        (means[0] + means[1]).abs()
    };
    let (free, held) = (asymmetry(0.0), asymmetry(50.0));
    assert!(held < 0.3 * free, "{free} {held}");
}
