//! What players throw and put down: beside the layout's props in the world, in the order in which they were added.

use playground::{LooseKind, Paint};
use policy_core::Button;
use policy_core::contract::{Motion, Solid};
use policy_core::glam::Vec3;
use replay::Pad;

use crate::arena::Arena;
use crate::error::ArenaError;

/// Throws a ball from the player to where its camera looks.
pub const THROW_BUTTON: Button = Button::DpadUp;
/// Puts a prop in front of the player: a crate, a barrel, a beach ball and a log, in turn.
pub const PUT_BUTTON: Button = Button::DpadDown;

/// A prop of the layout, or one that was thrown or put down, and how it moves.
#[derive(Clone, Copy, Debug)]
pub struct PropView<'a> {
    /// Its shape.
    pub solid: &'a Solid,
    /// Its colour.
    pub paint: Paint,
    /// The point that it hangs on, metres, world space.
    pub anchor: Option<Vec3>,
    /// Where it is and how it moves.
    pub motion: Motion,
}

impl Arena {
    /// Each prop of the layout, then what was thrown and put down.
    pub fn props(&self) -> impl Iterator<Item = PropView<'_>> + '_ {
        let placed = self.layout().props.iter().map(|placed| {
            (placed.paint, placed.joint.as_ref().and_then(policy_core::contract::Joint::anchor))
        });
        let loose = self.loose.iter().map(|kind| (kind.prop().1, None));
        placed.chain(loose).enumerate().filter_map(|(index, (paint, anchor))| {
            let (solid, motion) = self.world.prop(index)?;
            Some(PropView { solid, paint, anchor, motion })
        })
    }

    /// How many more of a kind can be thrown or put down. A restart gives them back.
    #[must_use]
    pub fn left(&self, kind: LooseKind) -> usize {
        kind.most().saturating_sub(self.loose.iter().filter(|other| **other == kind).count())
    }

    /// What the buttons of a player throw and put down. Allocates when they do.
    pub(crate) fn throw(&mut self, player: usize, pad: Pad) -> Result<(), ArenaError> {
        let presses = |button| self.players[player].presses(pad, button);
        let (throws, puts) = (presses(THROW_BUTTON), presses(PUT_BUTTON));
        let root = self.players[player].state.root().position;
        if throws {
            self.add_loose(LooseKind::Ball, &playground::thrown(root, pad.heading()))?;
        }
        if puts {
            let before = self.loose.iter().filter(|kind| **kind != LooseKind::Ball).count();
            let kind = LooseKind::PUT[before % LooseKind::PUT.len()];
            self.add_loose(kind, &playground::put_down(root, pad.heading()))?;
        }
        Ok(())
    }

    /// Adds one, if there is one left and it is not thrown from beyond the world.
    fn add_loose(&mut self, kind: LooseKind, motion: &Motion) -> Result<(), ArenaError> {
        if self.left(kind) > 0 && motion.check().is_ok() {
            self.world.add_prop(&kind.prop().0, motion)?;
            self.loose.push(kind);
        }
        Ok(())
    }
}
