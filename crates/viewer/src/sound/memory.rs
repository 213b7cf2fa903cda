//! What the ear remembers of the tick before: how everything moved, and what touched.

use glam::Vec3;
use physics_bridge::PropHandle;
use policy_core::BodyId;

use crate::sim::Simulation;

/// Ticks that two have to be apart before they are heard again: what rests on something chatters.
const APART_TICKS: u8 = 4;

/// Something that moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mover {
    /// A body of a character, by its index.
    Body(usize, BodyId),
    Prop(PropHandle),
}

/// What touches: something that moves, and the other if that moves too.
pub(super) type Pair = (Mover, Option<Mover>);

/// How something moves, world space, metres and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moving {
    pub(super) position: Vec3,
    pub(super) velocity: Vec3,
    pub(super) spin: Vec3,
}

impl Moving {
    /// Velocity of its point that is at `point`.
    pub(super) fn at(&self, point: Vec3) -> Vec3 {
        self.velocity + self.spin.cross(point - self.position)
    }
}

/// See the module.
#[derive(Debug, Default)]
pub(super) struct Memory {
    bodies: Vec<Vec<Moving>>,
    props: Vec<(PropHandle, Moving)>,
    touching: Vec<(Pair, u8)>,
}

impl Memory {
    /// How it moved in the tick before; `None` for what was not there.
    pub(super) fn of(&self, mover: Mover) -> Option<Moving> {
        match mover {
            Mover::Body(index, body) => self.bodies.get(index)?.get(body.index()).copied(),
            Mover::Prop(handle) => self.props.iter().find(|(other, _)| *other == handle).map(|(_, m)| *m),
        }
    }

    /// True when there was a tick before.
    pub(super) fn is_some(&self) -> bool {
        !self.bodies.is_empty()
    }

    /// Notes that two touch; true when they had been apart.
    pub(super) fn touch(&mut self, pair: Pair) -> bool {
        if let Some((_, apart)) = self.touching.iter_mut().find(|(other, _)| *other == pair) {
            *apart = 0;
            return false;
        }
        self.touching.push((pair, 0));
        true
    }

    /// True when something touched `mover` in this tick or a moment ago.
    pub(super) fn touches(&self, mover: Mover) -> bool {
        self.touching.iter().any(|((one, other), _)| *one == mover || *other == Some(mover))
    }

    /// Takes how everything moves now.
    pub(super) fn look(&mut self, sim: &Simulation) {
        self.touching.retain_mut(|(_, apart)| {
            *apart += 1;
            *apart <= APART_TICKS
        });
        self.bodies.resize_with(sim.characters().len(), Vec::new);
        for (moving, character) in self.bodies.iter_mut().zip(sim.characters()) {
            moving.clear();
            moving.extend(character.state.bodies.iter().map(|body| Moving {
                position: body.position,
                velocity: body.linear_velocity,
                spin: body.angular_velocity,
            }));
        }
        self.props.clear();
        let Some(shared) = sim.shared() else { return };
        let moving = |handle| {
            let motion = shared.world().motion(handle).ok()?;
            let (position, velocity, spin) = (motion.position, motion.velocity, motion.spin);
            Some((handle, Moving { position, velocity, spin }))
        };
        self.props.extend(shared.pieces().iter().filter_map(|piece| moving(piece.handle)));
    }
}
