//! Taking the state over into a simulation that was built anew.

use glam::{DQuat, DVec3};
use mujoco_rs::wrappers::mj_data::MjData;
use policy_core::contract::MAX_DISTANCE_M;

use super::World;
use super::build;
use super::edit::Placement;
use super::forces::Forces;
use super::places::Span;
use super::recover::Standing;
use super::scene::{HoldKind, Scene};
use crate::description::world_error::WorldError;

impl World {
    /// Builds the simulation of `scene` and takes over the state of everything that stays.
    pub(super) fn rebuild(&mut self, mut scene: Scene, placements: &[Placement]) -> Result<(), WorldError> {
        scene.drop_absent();
        let built = build::build(&self.ground, &scene)?;
        let characters = scene.characters.end();
        let mut new = World {
            ground: self.ground.clone(),
            forces: Forces::new(built.places.owners.len()),
            data: MjData::new(built.physics),
            places: built.places,
            scene,
            tick: self.tick,
            contacts: Vec::new(),
            divergences: self.divergences.clone(),
            culprits: Vec::new(),
            waiting: self.waiting.clone(),
            standing: vec![Standing::default(); characters].into(),
            grounds: Vec::new(),
            sensed: self.sensed.clone(),
            is_touched: true,
            before: None,
            history: None,
        };
        new.data.set_time(self.data.time());
        for index in 0..characters {
            new.carry_character(self, index);
        }
        let props = 0..new.scene.props.end();
        let hung = props.filter_map(|index| new.carry_prop(self, index)).collect();
        new.make_states();
        new.place(placements, hung);
        new.history = self.history.take();
        *self = new;
        self.make_room();
        Ok(())
    }

    /// Takes over a scene of the same layout.
    pub(super) fn exchange(&mut self, scene: Scene, placements: &[Placement]) {
        let old = std::mem::replace(&mut self.scene, scene);
        let present = |scene: &Scene, index| scene.props.slot(index).is_some_and(|slot| slot.present);
        for index in 0..self.scene.props.end() {
            match (present(&old, index), present(&self.scene, index)) {
                (true, false) => self.take_out_prop(index),
                (false, true) => self.show_prop(index, true),
                _ => {}
            }
        }
        self.place(placements, Vec::new());
    }

    /// Puts what is new where it belongs, lets what was hung on a joint move on, and computes what follows.
    fn place(&mut self, placements: &[Placement], mut hung: Vec<Hung>) {
        self.data.kinematics(); // fixtures are where rays will find them
        for placement in placements {
            match *placement {
                Placement::Prop(index, motion) => {
                    self.forces.clear(self.places.prop(index).body);
                    if self.scene.props.at(index).hold.is_none() {
                        self.write_prop(index, &motion);
                    } else {
                        self.rest_prop(index);
                        let at = (motion.position.as_dvec3(), motion.rotation.as_dquat().normalize());
                        let velocity = (motion.spin.as_dvec3(), motion.velocity.as_dvec3());
                        hung.push(Hung { index, at, velocity });
                    }
                }
                Placement::Character { index, place: [x, y], heading, speed_mps } => {
                    self.stand(index, [x, y, MAX_DISTANCE_M], heading, speed_mps);
                }
            }
        }
        hung.sort_by_key(|hung| self.depth(hung.index));
        for hung in hung {
            // A parent moves as it should by now: those come first.
            self.data.step1();
            self.write_rates(&hung);
        }
        self.is_touched = true;
        self.refresh();
    }

    /// How many props are above a prop that hangs on others.
    fn depth(&self, mut prop: usize) -> usize {
        let mut depth = 0;
        while let Some(parent) = self.scene.props.at(prop).hold.as_ref().and_then(|hold| hold.parent) {
            (prop, depth) = (parent, depth + 1);
        }
        depth
    }

    fn carry_character(&mut self, old: &World, index: usize) {
        let Some(slot) = self.scene.characters.slot(index) else { return };
        let same =
            old.scene.characters.slot(index).is_some_and(|before| before.generation == slot.generation);
        if !same {
            return;
        }
        let (from, to) = (old.places.character(index), self.places.character(index));
        copy_numbers(&mut self.data, &to.span, old, &from.span);
        for (to, from) in to.layout.joints.iter().zip(&from.layout.joints) {
            self.data.ctrl_mut()[to.ctrl] = old.data.ctrl()[from.ctrl];
        }
        for (to, from) in to.span.bodies.clone().zip(from.span.bodies.clone()) {
            self.forces.carry(to, &old.forces, from);
            self.data.xfrc_applied_mut()[to] = old.data.xfrc_applied()[from];
        }
        self.standing[index] = old.standing[index];
    }

    /// Takes over a prop. Returns how it moves when it hangs on a new joint, which is written when all parents move.
    fn carry_prop(&mut self, old: &World, index: usize) -> Option<Hung> {
        let slot = self.scene.props.slot(index)?;
        let before = old.scene.props.slot(index).filter(|before| before.generation == slot.generation);
        let Some(before) = before.filter(|_| slot.present) else {
            if !slot.present {
                self.show_prop(index, false);
                self.rest_prop(index);
            }
            return None;
        };
        let (from, to) = (old.places.prop(index), self.places.prop(index));
        let (at, velocity) = old.exact_motion(from.body);
        let hung = if before.value.hold == slot.value.hold {
            copy_numbers(&mut self.data, &to.span, old, &from.span);
            None
        } else if slot.value.hold.is_some() {
            Some(Hung { index, at, velocity })
        } else {
            self.write_free(index, at, velocity);
            None
        };
        let (from, to) = (from.body, self.places.prop(index).body);
        self.forces.carry(to, &old.forces, from);
        self.data.xfrc_applied_mut()[to] = old.data.xfrc_applied()[from];
        hung
    }

    /// Writes what a joint leaves of the motion of a prop relative to what it hangs on. Velocities of the parent must be
    /// up to date.
    fn write_rates(&mut self, &Hung { index, at: (at, turned), velocity: (mut spin, mut velocity) }: &Hung) {
        let Some(hold) = &self.scene.props.at(index).hold else { return };
        if let Some(parent) = hold.parent {
            let body = self.places.prop(parent).body;
            let ((parent_at, _), (parent_spin, parent_velocity)) = self.exact_motion(body);
            spin -= parent_spin;
            velocity -= parent_velocity + parent_spin.cross(at - parent_at);
        }
        let axis = turned * hold.axis;
        let rates = match hold.kind {
            HoldKind::Hinge => [axis.dot(spin), 0.0, 0.0],
            HoldKind::Slide => [axis.dot(velocity), 0.0, 0.0],
            // MuJoCo's is in the frame of the body.
            HoldKind::Ball => (turned.inverse() * spin).to_array(),
        };
        let span = &self.places.prop(index).span;
        let qvel = &mut self.data.qvel_mut()[span.dofs.clone()];
        qvel.iter_mut().zip(rates).for_each(|(to, rate)| *to = rate);
    }
}

/// A prop that hangs on a new joint, and how it moves: pose, spin and velocity, world space.
struct Hung {
    index: usize,
    at: (DVec3, DQuat),
    velocity: (DVec3, DVec3),
}

/// Copies position, velocity and the start of the solver.
fn copy_numbers(
    data: &mut MjData<Box<mujoco_rs::wrappers::mj_model::MjModel>>,
    to: &Span,
    old: &World,
    from: &Span,
) {
    data.qpos_mut()[to.qpos.clone()].copy_from_slice(&old.data.qpos()[from.qpos.clone()]);
    data.qvel_mut()[to.dofs.clone()].copy_from_slice(&old.data.qvel()[from.dofs.clone()]);
    let warm = &old.data.qacc_warmstart()[from.dofs.clone()];
    data.qacc_warmstart_mut()[to.dofs.clone()].copy_from_slice(warm);
}
