//! Taking the state over into a simulation that was built anew.

use glam::DVec3;
use mujoco_rs::wrappers::mj_data::MjData;
use policy_core::contract::MAX_DISTANCE_M;

use super::World;
use super::build;
use super::edit::Placement;
use super::forces::Forces;
use super::places::Span;
use super::recover::Standing;
use super::scene::Scene;
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
            divergences: Vec::new(),
            culprits: Vec::new(),
            waiting: Vec::new(),
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
        for index in 0..new.scene.props.end() {
            new.carry_prop(self, index);
        }
        new.make_states();
        new.place(placements);
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
        self.place(placements);
    }

    /// Puts what is new where it belongs, and computes what follows.
    fn place(&mut self, placements: &[Placement]) {
        self.data.kinematics(); // fixtures are where rays will find them
        for placement in placements {
            match *placement {
                Placement::Prop(index, motion) => {
                    self.forces.clear(self.places.prop(index).body);
                    if self.scene.props.at(index).hold.is_none() {
                        self.write_prop(index, &motion);
                    } else {
                        self.rest_prop(index);
                        let velocity = (motion.spin.as_dvec3(), motion.velocity.as_dvec3());
                        self.write_rates(index, motion.rotation.as_dquat() * DVec3::X, velocity);
                    }
                }
                Placement::Character { index, place: [x, y], heading, speed_mps } => {
                    self.stand(index, [x, y, MAX_DISTANCE_M], heading, speed_mps);
                }
            }
        }
        self.is_touched = true;
        self.refresh();
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

    fn carry_prop(&mut self, old: &World, index: usize) {
        let Some(slot) = self.scene.props.slot(index) else { return };
        let before = old.scene.props.slot(index).filter(|before| before.generation == slot.generation);
        let Some(before) = before.filter(|_| slot.present) else {
            if !slot.present {
                self.show_prop(index, false);
                self.rest_prop(index);
            }
            return;
        };
        let (from, to) = (old.places.prop(index), self.places.prop(index));
        let (pose, (spin, velocity)) = old.exact_motion(from.body);
        if before.value.hold == slot.value.hold {
            copy_numbers(&mut self.data, &to.span, old, &from.span);
        } else if let Some(hold) = &slot.value.hold {
            let parent = hold.parent.and_then(|parent| {
                let place = old.places.props.get(parent)?.as_ref()?;
                Some(old.exact_motion(place.body))
            });
            let (axis, mut relative) = (pose.1 * hold.axis, (spin, velocity));
            if let Some(((parent_at, _), (parent_spin, parent_velocity))) = parent {
                relative.0 -= parent_spin;
                relative.1 -= parent_velocity + parent_spin.cross(pose.0 - parent_at);
            }
            self.write_rates(index, axis, relative);
        } else {
            self.write_free(index, pose, (spin, velocity));
        }
        let (from, to) = (from.body, self.places.prop(index).body);
        self.forces.carry(to, &old.forces, from);
        self.data.xfrc_applied_mut()[to] = old.data.xfrc_applied()[from];
    }

    /// Writes what a joint leaves of a motion relative to what the prop hangs on. `axis` is that of the joint.
    fn write_rates(&mut self, index: usize, axis: DVec3, (spin, velocity): (DVec3, DVec3)) {
        use super::scene::HoldKind;
        let Some(hold) = &self.scene.props.at(index).hold else { return };
        let span = &self.places.prop(index).span;
        let rates = match hold.kind {
            HoldKind::Hinge => [axis.dot(spin), 0.0, 0.0],
            HoldKind::Slide => [axis.dot(velocity), 0.0, 0.0],
            HoldKind::Ball => spin.to_array(),
        };
        let qvel = &mut self.data.qvel_mut()[span.dofs.clone()];
        qvel.iter_mut().zip(rates).for_each(|(to, rate)| *to = rate);
    }
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
