//! Many shared worlds on all cores.

use std::num::NonZeroUsize;

use rayon::ThreadPool;
use rayon::prelude::*;

use super::{CrowdError, threads};
use crate::world::World;

/// Worlds that know nothing of each other, stepped on all cores.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # const HUMANOID: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/humanoid.xml"));
/// use physics_bridge::{Model, World, Worlds};
///
/// let model = Model::from_mjcf(HUMANOID)?;
/// let worlds = (0..3).map(|_| World::new(&model)).collect::<Result<_, _>>()?;
/// let mut worlds = Worlds::new(worlds, None)?;
/// let mut players = vec![(); 3]; // what the controllers of each world's characters are kept in
/// let diverged = worlds.tick_with(&mut players, |_index, _players, world| world.step());
/// assert_eq!(diverged, 0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Worlds {
    worlds: Vec<World>,
    pool: ThreadPool,
}

impl Worlds {
    /// So many worlds on `threads`, by default one for every core. Allocates.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn new(worlds: Vec<World>, threads: Option<NonZeroUsize>) -> Result<Self, CrowdError> {
        Ok(Self { worlds, pool: self::threads(threads)? })
    }

    /// The worlds.
    #[must_use]
    pub fn worlds(&self) -> &[World] {
        &self.worlds
    }

    /// The worlds, to edit them.
    pub fn worlds_mut(&mut self) -> &mut [World] {
        &mut self.worlds
    }

    /// Runs `tick` on every world, with something of its own, such as its characters' controllers: usually
    /// [`World::control_tick`] or [`World::step`]. Returns the sum of what it returns, how many things diverged.
    ///
    /// # Panics
    /// When there are not as many `owners` as worlds, or when `tick` panics.
    pub fn tick_with<C, F>(&mut self, owners: &mut [C], tick: F) -> usize
    where
        C: Send,
        F: Fn(usize, &mut C, &mut World) -> usize + Sync,
    {
        assert_eq!(owners.len(), self.worlds.len(), "one owner for each world");
        self.pool.install(|| {
            let pairs = self.worlds.par_iter_mut().zip(owners).enumerate();
            pairs.map(|(index, (world, owner))| tick(index, owner, world)).sum()
        })
    }
}
