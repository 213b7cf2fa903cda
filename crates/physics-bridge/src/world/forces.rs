//! Forces from outside: pushes for a while, impulses, and grabs that pull a point of a body to a point in the world.

use glam::{DVec3, Vec3};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::BodyId;
use policy_core::contract::{
    DescriptionError, MAX_DISTANCE_M, MAX_FORCE_N, MAX_PUSHED_MPS, PushError, check_impulse, check_push,
    within,
};

use super::World;
use super::handle::{CharacterHandle, GrabHandle, Handle, PropHandle};
use super::solids::{quat, vec3};
use crate::description::world_error::WorldError;
use crate::kinematics::velocity_at;

/// Most grabs at a time.
pub const MAX_GRABS: usize = 64;

/// Stiffness of a grab: what it pulls swings so fast, rad/s.
const GRAB_RADPS: f64 = 8.0;

/// Damping ratio of a grab.
const GRAB_DAMPING: f64 = 0.7;

/// What can be pushed and grabbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Movable {
    /// A prop.
    Prop(PropHandle),
    /// A body of a character.
    Body(CharacterHandle, BodyId),
}

impl From<PropHandle> for Movable {
    fn from(prop: PropHandle) -> Self {
        Movable::Prop(prop)
    }
}

/// A spring from a point of a body to a point in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grab {
    generation: u32,
    /// MuJoCo's body.
    body: usize,
    /// The point in the frame of the body.
    point: DVec3,
    target: DVec3,
    most_force: f64,
}

/// All forces under way. World axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Forces {
    pushes: Box<[Push]>,
    grabs: [Option<Grab>; MAX_GRABS],
    /// True while a force has to be written to MuJoCo, or a zero after the last one.
    under_way: bool,
}

/// Forces on the centre of mass of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Push {
    force: [f32; 3],
    substeps_left: u32,
    /// Newton seconds, for the next substep.
    impulse: [f32; 3],
}

impl Forces {
    /// No force on any of so many bodies. Allocates.
    pub(super) fn new(bodies: usize) -> Self {
        Self { pushes: vec![Push::default(); bodies].into(), grabs: [None; MAX_GRABS], under_way: false }
    }

    /// Overwrites this with the forces on as many bodies. Does not allocate.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.pushes.copy_from_slice(&other.pushes);
        self.grabs = other.grabs;
        self.under_way = other.under_way;
    }

    /// Takes over the forces on one body of a world that was built before.
    pub(super) fn carry(&mut self, to: usize, old: &Self, from: usize) {
        self.pushes[to] = old.pushes[from];
        for (slot, grab) in self.grabs.iter_mut().zip(&old.grabs) {
            if let Some(grab) = grab.filter(|grab| grab.body == from) {
                *slot = Some(Grab { body: to, ..grab });
            }
        }
        self.under_way |= old.under_way;
    }

    /// Ends the forces on a body.
    pub(super) fn clear(&mut self, body: usize) {
        self.pushes[body] = Push::default();
        self.grabs.iter_mut().filter(|grab| grab.is_some_and(|g| g.body == body)).for_each(|g| *g = None);
        self.under_way = true;
    }

    /// Writes the forces of the substep that comes next. Velocities in `data` must be up to date.
    pub(super) fn apply(&mut self, data: &mut MjData<Box<MjModel>>) {
        let grabbed = self.grabs.iter().any(Option::is_some);
        if !self.under_way && !grabbed {
            return;
        }
        self.under_way = grabbed;
        let timestep = data.model_opt().timestep;
        for (id, push) in self.pushes.iter_mut().enumerate().skip(1) {
            let mut force = Vec3::from(push.impulse).as_dvec3() / timestep;
            if push.substeps_left > 0 {
                push.substeps_left -= 1;
                force += Vec3::from(push.force).as_dvec3();
            }
            push.impulse = [0.0; 3];
            // One more substep after the last one, to write zeros.
            self.under_way |= force.length_squared() > 0.0 || push.substeps_left > 0;
            if force.length_squared() > 0.0 && outruns(data, id, force) {
                force = DVec3::ZERO;
            }
            data.xfrc_applied_mut()[id] = [force.x, force.y, force.z, 0.0, 0.0, 0.0];
        }
        for grab in self.grabs.iter().flatten() {
            let (force, torque) = grab.pull(data);
            let sum = &mut data.xfrc_applied_mut()[grab.body];
            for (number, more) in sum.iter_mut().zip(force.to_array().into_iter().chain(torque.to_array())) {
                *number += more;
            }
        }
    }
}

impl Grab {
    /// Force on the body and its torque about the centre of mass.
    fn pull(&self, data: &MjData<Box<MjModel>>) -> (DVec3, DVec3) {
        let (model, id) = (data.model(), self.body);
        let point = vec3(data.xpos()[id]) + quat(data.xquat()[id]) * self.point;
        let (_, velocity) = velocity_at(data.cvel()[id], point - reference(data, id));
        let mass = model.body_subtreemass()[model.body_rootid()[id] as usize];
        // A light limb of a heavy body: what holds it may be stiff, but is damped by the limb alone.
        let limb = 1.0 / model.body_invweight0()[id][0].max(1e-6);
        let stiffness = mass * GRAB_RADPS * GRAB_RADPS;
        let damping = 2.0 * GRAB_DAMPING * (stiffness * limb.min(mass)).sqrt();
        let force = (self.target - point) * stiffness - velocity * damping;
        let force = force.clamp_length_max(self.most_force);
        (force, (point - vec3(data.xipos()[id])).cross(force))
    }
}

impl World {
    /// Pushes something at its centre of mass with `force` newtons, world axes, for `secs` from now, rounded to whole
    /// substeps. Replaces the push that still acts on it. While it already moves along the force at
    /// [`MAX_PUSHED_MPS`], the force is zero.
    ///
    /// # Errors
    /// When the handle is stale, there is no such body, a number is not finite, the force is over 1 MN, or the
    /// duration negative or over an hour.
    pub fn push(&mut self, what: impl Into<Movable>, force: Vec3, secs: f32) -> Result<(), WorldError> {
        let body = self.body_of(what.into())?;
        check_push(BodyId::new(0), 1, force, secs)?;
        let substeps = (f64::from(secs) / self.ground.timestep_secs()).round();
        let push = &mut self.forces.pushes[body];
        (push.force, push.substeps_left) = (force.to_array(), substeps as u32);
        self.forces.under_way = true;
        Ok(())
    }

    /// Hits something at its centre of mass with `impulse` newton seconds, world axes, during the next substep.
    /// Several impulses before it add up.
    ///
    /// # Errors
    /// When the handle is stale, there is no such body, or the impulse is not finite or over 1 MN s.
    pub fn impulse(&mut self, what: impl Into<Movable>, impulse: Vec3) -> Result<(), WorldError> {
        let body = self.body_of(what.into())?;
        let push = &mut self.forces.pushes[body];
        let sum = Vec3::from(push.impulse) + impulse;
        check_impulse(BodyId::new(0), 1, sum)?;
        push.impulse = sum.to_array();
        self.forces.under_way = true;
        Ok(())
    }

    /// Grabs something at the point `at`, world space, and pulls that point towards it with a damped spring of at most
    /// `most_force_n` newtons, in (0, 1 MN]. [`World::move_grab`] moves the end of the spring.
    ///
    /// # Errors
    /// When the handle is stale, there is no such body, a number is out of its range, or there are [`MAX_GRABS`].
    pub fn grab(
        &mut self,
        what: impl Into<Movable>,
        at: Vec3,
        most_force_n: f32,
    ) -> Result<GrabHandle, WorldError> {
        let body = self.body_of(what.into())?;
        within("a grab", "at", at.length(), [0.0, MAX_DISTANCE_M])?;
        within("a grab", "most_force_n", most_force_n, [f32::MIN_POSITIVE, MAX_FORCE_N])?;
        let free = self.forces.grabs.iter().position(Option::is_none);
        let index = free.ok_or(DescriptionError::TooMany { what: "grabs", most: MAX_GRABS })?;
        let target = at.as_dvec3();
        let offset = target - vec3(self.data.xpos()[body]);
        let point = quat(self.data.xquat()[body]).inverse() * offset;
        let generation = self.scene.generation();
        let most_force = most_force_n.into();
        self.forces.grabs[index] = Some(Grab { generation, body, point, target, most_force });
        Ok(Handle::new(index, generation))
    }

    /// Moves the point that a grab pulls to, metres, world space.
    ///
    /// # Errors
    /// When the grab was released, or what it held is gone, or a number is out of its range.
    pub fn move_grab(&mut self, grab: GrabHandle, to: Vec3) -> Result<(), WorldError> {
        within("a grab", "to", to.length(), [0.0, MAX_DISTANCE_M])?;
        self.grab_mut(grab)?.as_mut().expect("checked").target = to.as_dvec3();
        Ok(())
    }

    /// Ends a grab.
    ///
    /// # Errors
    /// When it was released before, or what it held is gone.
    pub fn release(&mut self, grab: GrabHandle) -> Result<(), WorldError> {
        *self.grab_mut(grab)? = None;
        self.forces.under_way = true;
        Ok(())
    }

    /// Ends all grabs: also those that a restored state brought back.
    pub fn release_all(&mut self) {
        self.forces.grabs = [None; MAX_GRABS];
        self.forces.under_way = true;
    }

    /// The entry of a grab, which is not empty.
    fn grab_mut(&mut self, grab: GrabHandle) -> Result<&mut Option<Grab>, WorldError> {
        let slot = self.forces.grabs.get_mut(grab.index());
        slot.filter(|slot| slot.is_some_and(|g| g.generation == grab.generation()))
            .ok_or(WorldError::Stale { what: "a grab" })
    }

    /// MuJoCo's body of something that moves.
    pub(super) fn body_of(&self, what: Movable) -> Result<usize, WorldError> {
        match what {
            Movable::Prop(prop) => Ok(self.places.prop(self.scene.props.index_of(prop)?).body),
            Movable::Body(character, body) => {
                let index = self.scene.characters.index_of(character)?;
                let ids = &self.places.character(index).layout.body_ids;
                let missing = PushError::Body { bodies: ids.len(), found: body.index() };
                Ok(*ids.get(body.index()).ok_or(missing)?)
            }
        }
    }
}

/// The point that MuJoCo's velocity of a body is of.
pub(super) fn reference(data: &MjData<Box<MjModel>>, id: usize) -> DVec3 {
    vec3(data.subtree_com()[data.model().body_rootid()[id] as usize])
}

/// True when the centre of mass of a body moves along `force` faster than a push can drive it.
fn outruns(data: &MjData<Box<MjModel>>, id: usize, force: DVec3) -> bool {
    let (_, velocity) = velocity_at(data.cvel()[id], vec3(data.xipos()[id]) - reference(data, id));
    velocity.dot(force) > f64::from(MAX_PUSHED_MPS) * force.length()
}
