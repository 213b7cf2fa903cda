//! Many characters on all cores. Nothing is shared between them, so the number of threads changes no bit of the
//! result.

mod control;
mod worlds;

use std::num::NonZeroUsize;

use policy_core::contract::PhysicsCharacter;
use policy_core::{CharacterState, JointTargets};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use self::control::Batch;
use crate::character::Character;

pub use self::worlds::Worlds;

/// Characters that are ticked together, of this crate or of another physics.
///
/// [`Crowd::control_tick`] runs controllers. The other ways to tick are for policies of the caller's own.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// use physics_bridge::{Character, Crowd, Model};
///
/// let model = Model::from_mjcf(HUMANOID)?;
/// let mut crowd = Crowd::new((0..4).map(|_| Character::new(&model)).collect(), None)?;
/// let mut ticks = vec![0; crowd.len()]; // what each character's controller keeps from tick to tick
/// let diverged = crowd.tick_with(&mut ticks, |_index, ticks, _state, targets| {
///     *ticks += 1;
///     targets[0] = 0.1; // a controller makes targets of the state here
/// });
/// assert_eq!((diverged, ticks), (0, vec![1; 4]));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Crowd<C: PhysicsCharacter = Character> {
    members: Vec<Member<C>>,
    batches: Vec<Batch>,
    pool: ThreadPool,
}

/// A character, and what a tick of it needs.
#[derive(Debug)]
struct Member<C: PhysicsCharacter> {
    character: C,
    sensed: CharacterState,
    targets: JointTargets,
    failure: Option<C::Diverged>,
}

/// Why a crowd can't be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CrowdError {
    /// The system gives no threads.
    #[error("cannot start the threads of a crowd")]
    Threads {
        /// Why.
        source: rayon::ThreadPoolBuildError,
    },
}

/// So many threads, by default one for every core.
fn threads(count: Option<NonZeroUsize>) -> Result<ThreadPool, CrowdError> {
    ThreadPoolBuilder::new()
        .num_threads(count.map_or(0, NonZeroUsize::get))
        .thread_name(|index| format!("crowd-{index}"))
        .build()
        .map_err(|source| CrowdError::Threads { source })
}

impl<C: PhysicsCharacter + Send> Crowd<C> {
    /// A crowd of `characters` on `threads`, by default one for every core. Allocates; ticks only where they say.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn new(characters: Vec<C>, threads: Option<NonZeroUsize>) -> Result<Self, CrowdError> {
        let pool = self::threads(threads)?;
        let member = |character: C| {
            let sensed = CharacterState::new(character.skeleton());
            let targets = JointTargets::new(character.skeleton());
            Member { character, sensed, targets, failure: None }
        };
        Ok(Self { members: characters.into_iter().map(member).collect(), batches: Vec::new(), pool })
    }

    /// Number of characters.
    #[must_use]
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// True when there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// Threads that step them.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// The characters.
    pub fn characters(&self) -> impl ExactSizeIterator<Item = &C> {
        self.members.iter().map(|member| &member.character)
    }

    /// The characters, to pose or push them.
    pub fn characters_mut(&mut self) -> impl ExactSizeIterator<Item = &mut C> {
        self.members.iter_mut().map(|member| &mut member.character)
    }

    /// A character.
    ///
    /// # Panics
    /// When there is none of that index.
    #[must_use]
    pub fn character(&self, index: usize) -> &C {
        &self.members[index].character
    }

    /// A character, to pose or push it.
    ///
    /// # Panics
    /// When there is none of that index.
    pub fn character_mut(&mut self, index: usize) -> &mut C {
        &mut self.members[index].character
    }

    /// Characters that diverged in the last tick, with their index. Each is in its state before that tick.
    pub fn diverged(&self) -> impl Iterator<Item = (usize, &C::Diverged)> {
        self.members.iter().enumerate().filter_map(|(index, member)| Some((index, member.failure.as_ref()?)))
    }

    /// Runs one control tick of every character. `policy` gets its index and state, and changes the targets (all
    /// zero before) that it is then stepped with. Returns how many diverged.
    ///
    /// # Panics
    /// When `policy` does.
    pub fn tick<F>(&mut self, policy: F) -> usize
    where
        F: Fn(usize, &CharacterState, &mut JointTargets) + Sync,
    {
        self.pool.install(|| {
            let run = |(index, member): (usize, &mut Member<C>)| {
                member.tick(|state, targets| policy(index, state, targets))
            };
            self.members.par_iter_mut().enumerate().map(run).sum()
        })
    }

    /// As [`Crowd::tick`], with something of each character's own, such as its controller.
    ///
    /// # Panics
    /// When there are not as many `controllers` as characters, or when `policy` panics.
    pub fn tick_with<O, F>(&mut self, controllers: &mut [O], policy: F) -> usize
    where
        O: Send,
        F: Fn(usize, &mut O, &CharacterState, &mut JointTargets) + Sync,
    {
        assert_eq!(controllers.len(), self.members.len(), "one controller for each character");
        self.pool.install(|| {
            let run = |(index, (member, controller)): (usize, (&mut Member<C>, &mut O))| {
                member.tick(|state, targets| policy(index, controller, state, targets))
            };
            self.members.par_iter_mut().zip(controllers).enumerate().map(run).sum()
        })
    }

    /// Senses every character, for policies that are evaluated all at once.
    ///
    /// # Panics
    /// When there are not as many `states` as characters.
    pub fn sense_into(&self, states: &mut [CharacterState])
    where
        C: Sync,
        C::Diverged: Sync,
    {
        assert_eq!(states.len(), self.members.len(), "one state for each character");
        self.pool.install(|| {
            self.members
                .par_iter()
                .zip(states)
                .for_each(|(member, state)| member.character.sense_into(state));
        });
    }

    /// Steps every character with its targets. Returns how many diverged.
    ///
    /// # Panics
    /// When there are not as many `targets` as characters.
    pub fn step(&mut self, targets: &[JointTargets]) -> usize {
        assert_eq!(targets.len(), self.members.len(), "joint targets for each character");
        self.pool.install(|| self.members.par_iter_mut().zip(targets).map(|(member, t)| member.step(t)).sum())
    }
}

impl<C: PhysicsCharacter> Member<C> {
    fn tick(&mut self, policy: impl FnOnce(&CharacterState, &mut JointTargets)) -> usize {
        self.sense();
        self.targets.fill(0.0);
        policy(&self.sensed, &mut self.targets);
        self.character.actuate(&self.targets);
        self.finish()
    }

    fn sense(&mut self) {
        self.character.sense_into(&mut self.sensed);
    }

    fn step(&mut self, targets: &[f32]) -> usize {
        self.character.actuate(targets);
        self.finish()
    }

    /// Steps with the targets that are set. Returns 1 when it diverged.
    fn finish(&mut self) -> usize {
        self.failure = self.character.step().err();
        usize::from(self.failure.is_some())
    }
}
