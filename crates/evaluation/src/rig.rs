//! What every measure of a player's kind works with: the character, the pack, and the characters that have settled in each gait.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use physics::Model;
use policy_core::{CharacterPack, ControllerConfig};
use rayon::prelude::*;

use super::trial::{Gait, Settled};
use super::{Effort, Progress};

/// A character on flat ground, a pack, and how much is measured.
#[derive(Debug)]
pub struct Rig<'a> {
    /// The character on flat ground.
    pub model: &'a Model,
    /// The pack.
    pub pack: &'a Arc<CharacterPack>,
    /// What the player's controller does by itself. Trials that end with a fall keep it from getting up.
    pub config: ControllerConfig,
    /// How much is measured.
    pub effort: Effort,
    progress: Progress,
    settled: Mutex<BTreeMap<&'static str, Arc<[Settled]>>>,
}

impl<'a> Rig<'a> {
    /// A rig in which no character has settled yet.
    #[must_use]
    pub fn new(
        model: &'a Model,
        pack: &'a Arc<CharacterPack>,
        config: ControllerConfig,
        effort: Effort,
        progress: Progress,
    ) -> Self {
        Self { model, pack, config, effort, progress, settled: Mutex::default() }
    }

    /// The player's controller, but one that does not get up by itself: a trial ends with a fall.
    #[must_use]
    pub fn fragile_config(&self) -> ControllerConfig {
        ControllerConfig { auto_recover: false, ..self.config }
    }

    /// The gaits of the pack that are measured, among them those that only set off from another.
    #[must_use]
    pub fn gaits_and_starts(&self) -> Vec<Gait> {
        self.effort.gaits.of(self.pack)
    }

    /// The gaits of the pack that are measured and go on for as long as the pad is held.
    #[must_use]
    pub fn gaits(&self) -> Vec<Gait> {
        self.gaits_and_starts().into_iter().filter(|gait| !gait.is_start).collect()
    }

    /// Characters that have settled in a gait: [`Effort::settled`] of them, less those that fall on the way. They settle once.
    #[must_use]
    pub fn settled(&self, gait: &Gait) -> Arc<[Settled]> {
        let mut all = self.settled.lock().unwrap_or_else(PoisonError::into_inner);
        let settle = || {
            let seeds: Vec<u64> = (0..self.effort.settled as u64).collect();
            let settle = |seed: &u64| Settled::one(self.model, self.pack, self.fragile_config(), gait, *seed);
            self.each(&seeds, Settled::NOMINAL_SECS, settle).into_iter().flatten().collect()
        };
        all.entry(gait.name).or_insert_with(settle).clone()
    }

    /// Characters that have settled in the gait called `name`; none when the pack lacks it.
    #[must_use]
    pub fn settled_in(&self, name: &str) -> Arc<[Settled]> {
        Gait::named(self.pack, name).map_or(Arc::new([]), |gait| self.settled(&gait))
    }

    /// Runs a trial for each item on all cores, in the order of the items. Each counts as `secs` of a character's time.
    pub fn each<T: Sync, R: Send>(&self, items: &[T], secs: f32, trial: impl Fn(&T) -> R + Sync) -> Vec<R> {
        let run = |item: &T| {
            let result = trial(item);
            self.progress.add(secs);
            result
        };
        items.par_iter().map(run).collect()
    }
}
