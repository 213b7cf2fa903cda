//! What an arena is made of.

use std::sync::Arc;

use physics_rapier::Prop;
use playground::{Paint, PlacedProp, Playground, Start};
use policy_core::glam::{Quat, Vec2, Vec3};
use replay::{Header, MOST_PLAYERS, StateHash};

use crate::error::ArenaError;

/// Most crates on flat ground.
pub const MOST_CRATES: usize = 64;

/// Distance between players at the start, metres.
const SPACING_M: f32 = 1.6;
/// Length of a crate, metres, and its mass.
const CRATE_M: f32 = 0.4;
const CRATE_KG: f32 = 5.0;
/// Half the length of the area of flat ground, metres. The ground itself has no end.
const HALF_M: f32 = 50.0;

/// Where an arena is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArenaScene {
    /// Flat ground with crates.
    Flat {
        /// Crates that lie about, up to [`MOST_CRATES`].
        crates: usize,
    },
    /// The playground of the demo, with characters that wander.
    Playground,
}

/// What an arena is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArenaConfig {
    /// Characters that a pad steers: 1 to 8, in the playground as many as it has starts.
    pub players: usize,
    /// Where they are.
    pub scene: ArenaScene,
    /// Places the crates, and leads those that wander.
    pub seed: u32,
}

impl Default for ArenaConfig {
    fn default() -> Self {
        Self { players: 1, scene: ArenaScene::Flat { crates: 4 }, seed: 1 }
    }
}

impl ArenaConfig {
    /// What the replay with this header was played on.
    ///
    /// # Errors
    /// When the header names no scene that an arena has.
    pub fn of(header: &Header) -> Result<Self, ArenaError> {
        let crates = header.scene.strip_prefix("arena/").and_then(|count| count.parse().ok());
        let scene = match crates {
            Some(crates) => ArenaScene::Flat { crates },
            None if header.scene == ArenaScene::Playground.name() => ArenaScene::Playground,
            None => return Err(ArenaError::Scene { found: header.scene.clone() }),
        };
        Ok(Self { players: header.players.into(), scene, seed: header.seed })
    }

    /// What stands there.
    pub(crate) fn layout(self) -> Result<Arc<Playground>, ArenaError> {
        let layout = match self.scene {
            ArenaScene::Flat { crates } if crates > MOST_CRATES => {
                return Err(ArenaError::Crates { found: crates });
            }
            ArenaScene::Flat { crates } => Arc::new(flat(self.players.min(MOST_PLAYERS), crates, self.seed)),
            ArenaScene::Playground => Playground::shipped()?,
        };
        let most = layout.starts.len().min(MOST_PLAYERS);
        if (1..=most).contains(&self.players) {
            Ok(layout)
        } else {
            let most = if self.scene == ArenaScene::Playground { most } else { MOST_PLAYERS };
            Err(ArenaError::Players { most, found: self.players })
        }
    }
}

impl ArenaScene {
    /// The name in the header of a replay. That of the playground ends in a hash of its text: another layout is another scene.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Flat { crates } => format!("arena/{crates}"),
            Self::Playground => format!("playground/{:016x}", StateHash::of(playground::SHIPPED.as_bytes())),
        }
    }
}

/// Flat ground, players in a row across, crates ahead of them.
fn flat(players: usize, crates: usize, seed: u32) -> Playground {
    let area = [Vec2::splat(-HALF_M), Vec2::splat(HALF_M)];
    let start = |index: usize| {
        let at = Vec2::new(0.0, (index as f32 - (players as f32 - 1.0) / 2.0) * SPACING_M);
        Start { at, heading: 0.0, zone: area }
    };
    let placed = |index: usize| PlacedProp {
        name: format!("crate_{index}"),
        prop: Prop::cube(CRATE_M, CRATE_KG),
        position: crate_at(index, seed),
        rotation: Quat::IDENTITY,
        paint: Paint::Wood,
        joint: None,
        swing_m: None,
    };
    Playground {
        name: "flat".into(),
        area,
        starts: (0..players).map(start).collect(),
        fixtures: Vec::new(),
        props: (0..crates).map(placed).collect(),
        checkpoints: Vec::new(),
        way: Vec::new(),
    }
}

/// Where a crate lies: in rows ahead of the players, each a little off.
fn crate_at(index: usize, seed: u32) -> Vec3 {
    let (row, column) = (index / 4, index % 4);
    let mixed = (index as u32 ^ seed.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b);
    let off = |shift: u32| ((mixed >> shift) & 0xff) as f32 / 255.0 - 0.5;
    Vec3::new(
        3.0 + 1.5 * row as f32 + 0.8 * off(8),
        (column as f32 - 1.5) * 1.2 + 0.6 * off(20),
        0.5 * CRATE_M,
    )
}
