//! A control tick of a crowd with policy-core's controllers: sense, prepare, evaluate as a batch, accept, actuate,
//! step. Characters are taken in parts that one thread runs from beginning to end.

use std::sync::Arc;
use std::time::{Duration, Instant};

use policy_core::{BatchScratch, Blend, BlendMode, CharacterPack, Command, Controller, evaluate_batch_into};
use rayon::prelude::*;

use super::{Crowd, Member};

/// Characters that are evaluated together. Parts are this long whatever the number of threads, so that it changes no
/// bit. A multiple of the batch's block.
const PART: usize = 24;

/// Crowds with fewer characters evaluate each by itself, which is as fast.
const LEAST_BATCH: usize = 6;

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

impl Crowd {
    /// Runs one control tick of every character with its controller and command, as
    /// [`Character::control_tick`](crate::Character::control_tick). Returns how many diverged.
    ///
    /// In a crowd of at least six, policies are evaluated as a batch. That agrees with one by one to rounding, so a
    /// character of a crowd may leave the track that it would follow alone. A controller with another pack or
    /// arithmetic than the first of its part, or with [`BlendMode::Actions`], is evaluated by itself. Allocates in the
    /// first call and after the packs changed.
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
        let batched = owners.len() >= LEAST_BATCH;
        for (part, owners) in owners.chunks_mut(PART).enumerate() {
            let (first, _) = steering(part * PART, &mut owners[0]);
            match self.batches.get_mut(part) {
                Some(batch) if Arc::ptr_eq(&batch.pack, first.pack()) => {}
                Some(batch) => *batch = Batch::new(first.pack()),
                None => self.batches.push(Batch::new(first.pack())),
            }
        }
        let (members, batches) = (&mut self.members, &mut self.batches);
        let parts = members.par_chunks_mut(PART).zip(owners.par_chunks_mut(PART)).zip(batches);
        self.pool.install(|| {
            let ticked = parts.enumerate().map(|(part, ((members, owners), batch))| {
                let part = Part { first: part * PART, dt_secs, batched, members, owners };
                batch.tick(part, &steering)
            });
            ticked.sum()
        })
    }

    /// Time that controllers and policies took in the last control tick, summed over the threads.
    #[must_use]
    pub fn control_time(&self) -> Duration {
        self.batches.iter().map(|batch| batch.time).sum()
    }
}

/// The characters that one thread takes.
struct Part<'a, C> {
    /// Index of the first.
    first: usize,
    dt_secs: f32,
    batched: bool,
    members: &'a mut [Member],
    owners: &'a mut [C],
}

impl Batch {
    fn new(pack: &Arc<CharacterPack>) -> Self {
        let shape = &pack.policies()[0];
        Self {
            pack: Arc::clone(pack),
            scratch: BatchScratch::for_mlp(shape, PART),
            members: Vec::with_capacity(PART),
            blends: Vec::with_capacity(PART),
            inputs: Vec::with_capacity(PART * shape.inputs()),
            actions: vec![0.0; PART * shape.outputs()],
            time: Duration::ZERO,
        }
    }

    /// A control tick of a part. Returns how many diverged.
    fn tick<C, F>(&mut self, mut part: Part<'_, C>, steering: &F) -> usize
    where
        F: Fn(usize, &mut C) -> (&mut Controller, Command),
    {
        part.members.iter_mut().for_each(|member| member.character.sense());
        let start = Instant::now();
        self.prepare(&mut part, steering);
        self.evaluate(&mut part, steering);
        self.time = start.elapsed();
        let pairs = part.members.iter_mut().zip(part.owners).enumerate();
        let step = |(index, (member, owner)): (usize, (&mut Member, &mut C))| {
            member.step(steering(part.first + index, owner).0.joint_targets())
        };
        pairs.map(step).sum()
    }

    /// Prepares every controller and collects those that the batch evaluates. The others complete their tick.
    fn prepare<C, F>(&mut self, part: &mut Part<'_, C>, steering: &F)
    where
        F: Fn(usize, &mut C) -> (&mut Controller, Command),
    {
        self.members.clear();
        self.blends.clear();
        self.inputs.clear();
        let mut arithmetic = None;
        for (index, (member, owner)) in part.members.iter().zip(part.owners.iter_mut()).enumerate() {
            let (controller, command) = steering(part.first + index, owner);
            let config = controller.config();
            let fits = part.batched
                && Arc::ptr_eq(controller.pack(), &self.pack)
                && config.blend_mode != BlendMode::Actions
                && *arithmetic.get_or_insert(config.arithmetic) == config.arithmetic;
            let state = member.character.sensed();
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
    fn evaluate<C, F>(&mut self, part: &mut Part<'_, C>, steering: &F)
    where
        F: Fn(usize, &mut C) -> (&mut Controller, Command),
    {
        let Some(&first) = self.members.first() else { return };
        let arithmetic = steering(part.first + first, &mut part.owners[first]).0.config().arithmetic;
        let outputs = self.pack.policies()[0].outputs();
        let actions = &mut self.actions[..self.members.len() * outputs];
        let (policies, scratch) = (self.pack.policies(), &mut self.scratch);
        evaluate_batch_into(policies, arithmetic, &self.blends, &self.inputs, scratch, actions);
        for (&index, action) in self.members.iter().zip(actions.chunks_exact(outputs)) {
            steering(part.first + index, &mut part.owners[index]).0.accept(action);
        }
    }
}
