//! A control tick of a crowd with policy-core's controllers: sense, prepare, evaluate as a batch, accept, actuate,
//! step. One thread takes a part of the crowd up to accept; all threads share the steps. The batch computes a character
//! in the same way whatever part it is in, so the length of the parts changes no bit.

use std::sync::Arc;
use std::time::{Duration, Instant};

use policy_core::contract::PhysicsCharacter;
use policy_core::{
    Arithmetic, BatchScratch, Blend, BlendMode, CharacterPack, Command, Controller, evaluate_batch_into,
};
use rayon::prelude::*;

use super::{Crowd, Member};

/// Most characters that are evaluated together: as many as share one pass over the parameters.
const LONGEST_PART: usize = 48;

/// Parts are a multiple of this long, the number of characters that the batch computes side by side.
const BLOCK: usize = 6;

/// Crowds with fewer characters evaluate each by itself, which is as fast.
const LEAST_BATCH: usize = 6;

/// What all members of a crowd's batches have in common: the pack and arithmetic of the first controller.
#[derive(Clone, Debug)]
struct Shared {
    pack: Arc<CharacterPack>,
    arithmetic: Arithmetic,
    /// False in a small crowd, which has no batch.
    batched: bool,
}

/// Room for one part of a crowd.
#[derive(Debug)]
pub(super) struct Batch {
    pack: Arc<CharacterPack>,
    scratch: BatchScratch,
    /// Which of the part's characters are in the batch.
    members: Vec<usize>,
    blends: Vec<Blend>,
    inputs: Vec<f32>,
    actions: Vec<f32>,
    time: Duration,
}

impl<P: PhysicsCharacter + Send> Crowd<P> {
    /// Runs one control tick of every character with its controller and command, as
    /// [`Character::control_tick`](crate::Character::control_tick). Returns how many diverged.
    ///
    /// In a crowd of at least six, policies are evaluated as a batch. That agrees with one by one to rounding, so a
    /// character of a crowd may leave the track that it would follow alone. A controller with another pack or
    /// arithmetic than the first one, or with [`BlendMode::Actions`], is evaluated by itself. Allocates in the first
    /// call and after the first controller's pack has changed.
    ///
    /// # Panics
    /// When there are not as many `controllers` or `commands` as characters.
    pub fn control_tick(
        &mut self,
        controllers: &mut [Controller],
        commands: &[Command],
        dt_secs: f32,
    ) -> usize {
        assert_eq!(commands.len(), self.len(), "one command for each character");
        self.control_tick_with(controllers, dt_secs, |index, controller| (controller, commands[index]))
    }

    /// As [`Crowd::control_tick`], for controllers that are part of something larger: `steering` returns the
    /// controller and the command of the character with that index.
    ///
    /// # Panics
    /// When there are not as many `owners` as characters, or when `steering` panics.
    pub fn control_tick_with<C, F>(&mut self, owners: &mut [C], dt_secs: f32, steering: F) -> usize
    where
        C: Send,
        F: Fn(usize, &mut C) -> (&mut Controller, Command) + Sync,
    {
        assert_eq!(owners.len(), self.members.len(), "one controller for each character");
        let Some(first) = owners.first_mut() else { return 0 };
        let (first, _) = steering(0, first);
        let shared = Shared {
            pack: Arc::clone(first.pack()),
            arithmetic: first.config().arithmetic,
            batched: self.members.len() >= LEAST_BATCH,
        };
        let share = self.members.len().div_ceil(self.threads());
        let length = share.next_multiple_of(BLOCK).min(LONGEST_PART);
        self.fit_batches(&shared.pack, self.members.len().div_ceil(length));
        let (members, batches) = (&mut self.members, &mut self.batches);
        let parts = members.par_chunks_mut(length).zip(owners.par_chunks_mut(length)).zip(batches);
        self.pool.install(|| {
            let ticked = parts.enumerate().map(|(part, ((members, owners), batch))| {
                let mut part = Part { first: part * length, dt_secs, shared: &shared, members, owners };
                batch.control(&mut part, &steering);
                part.step(&steering)
            });
            ticked.sum()
        })
    }

    /// Makes room for so many parts. Allocates when there are more than before or the pack is another.
    fn fit_batches(&mut self, pack: &Arc<CharacterPack>, parts: usize) {
        self.batches.retain(|batch| Arc::ptr_eq(&batch.pack, pack));
        self.batches.truncate(parts);
        while self.batches.len() < parts {
            self.batches.push(Batch::new(pack));
        }
    }

    /// Time that controllers and policies took in the last control tick, summed over the threads.
    #[must_use]
    pub fn control_time(&self) -> Duration {
        self.batches.iter().map(|batch| batch.time).sum()
    }
}

/// Some of the characters, with what holds their controllers.
struct Part<'a, P: PhysicsCharacter, C> {
    /// Index of the first.
    first: usize,
    dt_secs: f32,
    shared: &'a Shared,
    members: &'a mut [Member<P>],
    owners: &'a mut [C],
}

impl<P: PhysicsCharacter + Send, C: Send> Part<'_, P, C> {
    /// Steps every character with its controller's targets. Returns how many diverged.
    fn step<F>(self, steering: &F) -> usize
    where
        F: Fn(usize, &mut C) -> (&mut Controller, Command) + Sync,
    {
        let pairs = self.members.par_iter_mut().zip(self.owners).enumerate();
        let stepped = pairs.map(|(index, (member, owner))| {
            member.step(steering(self.first + index, owner).0.joint_targets())
        });
        stepped.sum()
    }
}

impl Batch {
    fn new(pack: &Arc<CharacterPack>) -> Self {
        let shape = &pack.policies()[0];
        Self {
            pack: Arc::clone(pack),
            scratch: BatchScratch::for_mlp(shape, LONGEST_PART),
            members: Vec::with_capacity(LONGEST_PART),
            blends: Vec::with_capacity(LONGEST_PART),
            inputs: Vec::with_capacity(LONGEST_PART * shape.inputs()),
            actions: vec![0.0; LONGEST_PART * shape.outputs()],
            time: Duration::ZERO,
        }
    }

    /// Senses every character of a part and makes its joint targets.
    fn control<P, C, F>(&mut self, part: &mut Part<'_, P, C>, steering: &F)
    where
        P: PhysicsCharacter,
        F: Fn(usize, &mut C) -> (&mut Controller, Command),
    {
        part.members.iter_mut().for_each(|member| member.sense());
        let start = Instant::now();
        self.prepare(part, steering);
        self.evaluate(part, steering);
        self.time = start.elapsed();
    }

    /// Prepares every controller and collects those that the batch evaluates. The others complete their tick.
    fn prepare<P, C, F>(&mut self, part: &mut Part<'_, P, C>, steering: &F)
    where
        P: PhysicsCharacter,
        F: Fn(usize, &mut C) -> (&mut Controller, Command),
    {
        self.members.clear();
        self.blends.clear();
        self.inputs.clear();
        for (index, (member, owner)) in part.members.iter().zip(part.owners.iter_mut()).enumerate() {
            let (controller, command) = steering(part.first + index, owner);
            let config = controller.config();
            let fits = part.shared.batched
                && Arc::ptr_eq(controller.pack(), &part.shared.pack)
                && config.arithmetic == part.shared.arithmetic
                && config.blend_mode != BlendMode::Actions;
            let state = &member.sensed;
            if !fits {
                controller.tick(state, &command, part.dt_secs);
            } else if controller.prepare(state, &command, part.dt_secs) {
                self.members.push(index);
                self.blends.push(controller.report().blend);
                self.inputs.extend_from_slice(controller.policy_input());
            }
        }
    }

    /// Evaluates the batch and makes joint targets of it.
    fn evaluate<P, C, F>(&mut self, part: &mut Part<'_, P, C>, steering: &F)
    where
        P: PhysicsCharacter,
        F: Fn(usize, &mut C) -> (&mut Controller, Command),
    {
        if self.members.is_empty() {
            return;
        }
        let arithmetic = part.shared.arithmetic;
        let outputs = self.pack.policies()[0].outputs();
        let actions = &mut self.actions[..self.members.len() * outputs];
        let (policies, scratch) = (self.pack.policies(), &mut self.scratch);
        evaluate_batch_into(policies, arithmetic, &self.blends, &self.inputs, scratch, actions);
        for (&index, action) in self.members.iter().zip(actions.chunks_exact(outputs)) {
            steering(part.first + index, &mut part.owners[index]).0.accept(action);
        }
    }
}
