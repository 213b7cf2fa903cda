//! What happens to what diverges: a character stands up where it last was well, a prop is taken out, a prop on a joint
//! goes back to where it was joined. The rest of the world repeats the tick as if that had been so from its start.

use policy_core::contract::ROOT_QPOS;

use super::World;
use super::accuse::{Culprit, is_bad};
use super::handle::{CharacterHandle, PropHandle};
use super::places::Owner;
use crate::cause::{Cause, Excess};

/// Where what was taken out is kept, far below everything.
const ASIDE: [f64; 3] = [0.0, 0.0, -5000.0];

/// Rounds in which what may be a mere consequence waits.
const PATIENT_ROUNDS: u32 = 3;

/// What exceeds a limit by this share of the worst, or less, may be a mere consequence.
const CONSEQUENCE: f32 = 0.1;

/// Something that diverged, and what was done about it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Divergence {
    /// What diverged; `None` when it belongs to nothing. The handle of what was taken out is stale by now.
    pub what: Option<Diverging>,
    /// What was wrong.
    pub cause: Cause,
    /// Value and limit, where there is one.
    pub excess: Option<Excess>,
    /// What was done.
    pub remedy: Remedy,
}

/// What can diverge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Diverging {
    /// A character.
    Character(CharacterHandle),
    /// A prop, and all that hangs on it.
    Prop(PropHandle),
}

/// What is done about a divergence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remedy {
    /// It stands, or hangs, where it last was well.
    PutBack,
    /// It is no longer in the world.
    TakenOut,
    /// Targets that are not finite were ignored; the joints keep those of before.
    Ignored,
    /// Nothing.
    None,
}

/// Where a character last was well: on the ground, metres, at what height, facing where, radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Standing {
    pub place: [f32; 3],
    pub heading: f32,
}

impl World {
    /// Deals with what was found wrong. In the first rounds props go before characters, and what is far beyond a limit
    /// before what is just beyond one: the others may just have met it.
    pub(super) fn remedy(&mut self, round: u32) {
        let culprits = std::mem::take(&mut self.culprits);
        let is_prop = |culprit: &Culprit| matches!(culprit.owner, Owner::Prop(_));
        let any_prop = culprits.iter().any(is_prop);
        let worst = culprits.iter().map(Culprit::severity).fold(0.0, f32::max);
        for culprit in &culprits {
            let waits = round < PATIENT_ROUNDS
                && (any_prop && !is_prop(culprit) || culprit.severity() < CONSEQUENCE * worst);
            if waits && !self.starts_bad(culprit.owner) {
                continue;
            }
            let (what, remedy) = match culprit.owner {
                Owner::Prop(root) => {
                    let what = Diverging::Prop(self.scene.props.handle(root));
                    (what, self.remedy_prop(root, round))
                }
                Owner::Character(index, _) => {
                    let what = Diverging::Character(self.scene.characters.handle(index));
                    (what, self.remedy_character(index, round))
                }
                Owner::Ground | Owner::Fixture(_) => continue,
            };
            let told = self.divergences.iter_mut().find(|divergence| divergence.what == Some(what));
            match told {
                Some(divergence) => divergence.remedy = remedy,
                None => {
                    let Culprit { cause, excess, .. } = *culprit;
                    self.divergences.push(Divergence { what: Some(what), cause, excess, remedy });
                }
            }
        }
        self.culprits = culprits;
        self.culprits.clear();
    }

    /// True when a character has bad numbers already.
    fn starts_bad(&self, owner: Owner) -> bool {
        let Owner::Character(index, _) = owner else { return false };
        let span = &self.places.character(index).span;
        let numbers = self.data.qpos()[span.qpos.clone()].iter().chain(&self.data.qvel()[span.dofs.clone()]);
        numbers.into_iter().any(is_bad)
    }

    fn remedy_prop(&mut self, root: usize, round: u32) -> Remedy {
        let hangs = self.scene.props.at(root).hold.is_some();
        let remedy = if hangs && round <= PATIENT_ROUNDS { Remedy::PutBack } else { Remedy::TakenOut };
        for index in 0..self.scene.props.end() {
            if self.scene.props.slot(index).is_none() || self.scene.root_of(index) != root {
                continue;
            }
            if remedy == Remedy::TakenOut {
                self.take_out_prop(index);
            } else {
                self.rest_prop(index);
            }
        }
        remedy
    }

    fn remedy_character(&mut self, index: usize, round: u32) -> Remedy {
        if round > PATIENT_ROUNDS {
            self.take_out_character(index);
            return Remedy::TakenOut;
        }
        let Standing { place: [x, y, z], heading } = self.standing[index];
        self.stand(index, [x, y, z], heading, 0.0);
        Remedy::PutBack
    }

    /// Takes a prop out of the world until the next build: nothing touches it, and its handle is stale.
    pub(super) fn take_out_prop(&mut self, index: usize) {
        let body = self.places.prop(index).body;
        self.forces.clear(body);
        if let Some(slot) = self.scene.props.slot_mut(index) {
            slot.present = false;
        }
        self.show_prop(index, false);
        self.rest_prop(index);
    }

    /// Takes a character out of the world until the next build.
    pub(super) fn take_out_character(&mut self, index: usize) {
        for body in self.places.character(index).span.bodies.clone() {
            self.forces.clear(body);
        }
        if let Some(slot) = self.scene.characters.slot_mut(index) {
            slot.present = false;
        }
        self.show_character(index, false);
        self.rest_character(index);
    }

    /// At rest: on its joint as it was joined, or aside.
    pub(super) fn rest_prop(&mut self, index: usize) {
        let span = &self.places.prop(index).span;
        let qpos = &mut self.data.qpos_mut()[span.qpos.clone()];
        qpos.fill(0.0);
        match qpos.len() {
            4 => qpos[0] = 1.0,
            7 => {
                qpos[..3].copy_from_slice(&ASIDE);
                qpos[3] = 1.0;
            }
            _ => {}
        }
        self.data.qvel_mut()[span.dofs.clone()].fill(0.0);
        self.data.qacc_warmstart_mut()[span.dofs.clone()].fill(0.0);
    }

    fn rest_character(&mut self, index: usize) {
        let place = self.places.character(index);
        let stand = self.scene.characters.at(index).stand();
        place.layout.write_qpos(&stand.qpos, self.data.qpos_mut());
        self.data.qpos_mut()[place.layout.root_qpos..][..3].copy_from_slice(&ASIDE);
        self.data.qvel_mut()[place.span.dofs.clone()].fill(0.0);
        self.data.qacc_warmstart_mut()[place.span.dofs.clone()].fill(0.0);
        for (joint, &angle) in place.layout.joints.iter().zip(&stand.qpos[ROOT_QPOS..]) {
            self.data.ctrl_mut()[joint.ctrl] = angle;
        }
    }

    /// Keeps what was taken out where it is, against gravity.
    pub(super) fn rest_absent(&mut self) {
        for index in 0..self.scene.props.end() {
            if self.scene.props.slot(index).is_some_and(|slot| !slot.present) {
                self.rest_prop(index);
            }
        }
        for index in 0..self.scene.characters.end() {
            if self.scene.characters.slot(index).is_some_and(|slot| !slot.present) {
                self.rest_character(index);
            }
        }
    }
}
