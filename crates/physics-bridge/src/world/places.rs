//! Where things of a scene are in MuJoCo's arrays, found by name once, after the simulation was built.

use std::ops::Range;

use glam::DVec3;
use mujoco_rs::wrappers::mj_model::{MjModel, MjtObjBase};
use policy_core::BodyId;

use super::scene::{JointRecord, Scene};
use crate::StateHash;
use crate::description::layout::Layout;
use crate::description::model_error::ModelError;

/// What a body of MuJoCo belongs to, by index in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    Ground,
    Fixture(usize),
    Prop(usize),
    Character(usize, BodyId),
}

/// A range of numbers of one thing in `qpos`, one in `qvel`, and its bodies.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Span {
    pub qpos: Range<usize>,
    pub dofs: Range<usize>,
    pub bodies: Range<usize>,
}

/// A character.
#[derive(Clone, Debug)]
pub(super) struct CharacterPlace {
    pub layout: Layout,
    pub span: Span,
}

/// A prop.
#[derive(Clone, Debug)]
pub(super) struct PropPlace {
    pub body: usize,
    pub span: Span,
    /// MuJoCo's geoms.
    pub geoms: Range<usize>,
    /// How far it reaches from the origin of its body, metres.
    pub reach: f64,
}

/// A fixture.
#[derive(Clone, Debug)]
pub(super) struct FixturePlace {
    /// MuJoCo's geoms.
    pub geoms: Range<usize>,
    /// A circle around it, seen from above: centre and radius, metres.
    pub circle: ([f64; 2], f64),
}

/// Where everything is.
#[derive(Debug)]
pub(super) struct Places {
    pub characters: Vec<Option<CharacterPlace>>,
    pub props: Vec<Option<PropPlace>>,
    pub fixtures: Vec<Option<FixturePlace>>,
    /// MuJoCo's tendon of each joint that is a rope.
    pub ropes: Vec<Option<usize>>,
    /// What each of MuJoCo's bodies belongs to.
    pub owners: Box<[Owner]>,
    /// MuJoCo's body of each number in `qpos`.
    pub qpos_bodies: Box<[usize]>,
    /// `contype` and `conaffinity` of each geom while its owner is present.
    pub geom_bits: Box<[[i32; 2]]>,
    /// Sliding friction of each geom while the world's settings are the usual ones.
    pub frictions: Box<[f64]>,
    /// `contype` and `conaffinity` of each body.
    pub body_bits: Box<[[i32; 2]]>,
    /// The same for equal models, and hardly ever for others.
    pub hash: u64,
}

impl Places {
    pub(super) fn of(model: &MjModel, scene: &Scene) -> Result<Self, ModelError> {
        let bodies = model.nbody() as usize;
        let mut places = Self {
            characters: vec![None; scene.characters.end()],
            props: vec![None; scene.props.end()],
            fixtures: vec![None; scene.fixtures.end()],
            ropes: vec![None; scene.joints.end()],
            owners: vec![Owner::Ground; bodies].into(),
            qpos_bodies: qpos_bodies(model),
            geom_bits: bits(model.geom_contype(), model.geom_conaffinity()),
            frictions: model.geom_friction().iter().map(|friction| friction[0]).collect(),
            body_bits: bits(model.body_contype(), model.body_conaffinity()),
            hash: hash(model),
        };
        for (index, slot) in scene.characters.iter() {
            let layout = Layout::attached(model, slot.value.skeleton(), &character_prefix(index))?;
            for (body, &id) in layout.body_ids.iter().enumerate() {
                places.owners[id] = Owner::Character(index, BodyId::new(body));
            }
            let [joints, bodies] = [layout.joints.len(), layout.body_ids.len()];
            let first = layout.body_ids[0];
            let span = Span {
                qpos: layout.root_qpos..layout.root_qpos + 7 + joints,
                dofs: layout.root_dof..layout.root_dof + 6 + joints,
                bodies: first..first + bodies,
            };
            places.characters[index] = Some(CharacterPlace { layout, span });
        }
        for (index, _) in scene.props.iter() {
            let body = find(model, &prop_name(index))?;
            places.owners[body] = Owner::Prop(index);
            let joint = model.body_jntadr()[body] as usize;
            let (qpos, dof) = (model.jnt_qposadr()[joint] as usize, model.body_dofadr()[body] as usize);
            let dofs = model.body_dofnum()[body] as usize;
            let numbers = [0, 1, 0, 4, 0, 0, 7][dofs];
            let span = Span { qpos: qpos..qpos + numbers, dofs: dof..dof + dofs, bodies: body..body + 1 };
            let geoms = geoms(model, body);
            places.props[index] = Some(PropPlace { body, span, reach: reach(model, &geoms), geoms });
        }
        for (index, _) in scene.fixtures.iter() {
            let body = find(model, &fixture_name(index))?;
            places.owners[body] = Owner::Fixture(index);
            let geoms = geoms(model, body);
            let [x, y, _] = model.body_pos()[body];
            places.fixtures[index] = Some(FixturePlace { circle: ([x, y], reach(model, &geoms)), geoms });
        }
        for (index, slot) in scene.joints.iter() {
            if let JointRecord::Rope(_) = slot.value {
                places.ropes[index] = model.name_to_id(MjtObjBase::mjOBJ_TENDON, &rope_name(index));
            }
        }
        Ok(places)
    }

    /// The place of a character that is in the scene.
    pub(super) fn character(&self, index: usize) -> &CharacterPlace {
        self.characters[index].as_ref().expect("built with the scene")
    }

    /// The place of a prop that is in the scene.
    pub(super) fn prop(&self, index: usize) -> &PropPlace {
        self.props[index].as_ref().expect("built with the scene")
    }
}

/// What the names of a character's parts begin with.
pub(super) fn character_prefix(index: usize) -> String {
    format!("c{index}/")
}

pub(super) fn prop_name(index: usize) -> String {
    format!("p{index}")
}

pub(super) fn fixture_name(index: usize) -> String {
    format!("f{index}")
}

pub(super) fn rope_name(index: usize) -> String {
    format!("r{index}")
}

fn find(model: &MjModel, name: &str) -> Result<usize, ModelError> {
    let missing = || ModelError::Missing { kind: "body", name: name.into() };
    model.name_to_id(MjtObjBase::mjOBJ_BODY, name).ok_or_else(missing)
}

fn bits(types: &[i32], affinities: &[i32]) -> Box<[[i32; 2]]> {
    types.iter().zip(affinities).map(|(&a, &b)| [a, b]).collect()
}

fn qpos_bodies(model: &MjModel) -> Box<[usize]> {
    let mut bodies = vec![0; model.nq() as usize];
    // MuJoCo has compiled the model: joints are in the order of their numbers in `qpos`.
    for (joint, &first) in model.jnt_qposadr().iter().enumerate() {
        bodies[first as usize..].fill(model.jnt_bodyid()[joint] as usize);
    }
    bodies.into()
}

/// The geoms of a body.
fn geoms(model: &MjModel, body: usize) -> Range<usize> {
    let first = model.body_geomadr()[body] as usize;
    first..first + model.body_geomnum()[body] as usize
}

/// How far geoms of one body reach from its origin, metres.
fn reach(model: &MjModel, geoms: &Range<usize>) -> f64 {
    let reach = |geom: usize| DVec3::from(model.geom_pos()[geom]).length() + model.geom_rbound()[geom];
    geoms.clone().map(reach).fold(0.0, f64::max)
}

/// A hash of what makes up a model.
fn hash(model: &MjModel) -> u64 {
    let mut hash = StateHash::default();
    for size in [model.nq(), model.nv(), model.nu(), model.nbody(), model.ngeom(), model.ntendon()] {
        hash.absorb_bits(size as u64);
    }
    let numbers = (model.body_mass().iter().copied())
        .chain(model.body_inertia().iter().flatten().copied())
        .chain(model.body_pos().iter().flatten().copied())
        .chain(model.body_quat().iter().flatten().copied())
        .chain(model.geom_size().iter().flatten().copied())
        .chain(model.geom_pos().iter().flatten().copied())
        .chain(model.geom_friction().iter().flatten().copied())
        .chain(model.geom_solref().iter().flatten().copied())
        .chain(model.jnt_axis().iter().flatten().copied())
        .chain(model.jnt_pos().iter().flatten().copied())
        .chain(model.jnt_range().iter().flatten().copied())
        .chain(model.tendon_range().iter().flatten().copied())
        .chain(model.dof_damping().iter().copied())
        .chain(model.actuator_gainprm().iter().flatten().copied());
    numbers.for_each(|number| hash.absorb_bits(number.to_bits()));
    model.geom_contype().iter().for_each(|&bits| hash.absorb_bits(bits as u64));
    hash.value()
}
