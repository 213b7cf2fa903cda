//! Builds the simulation of a scene: one MuJoCo model of the ground, the characters, the props, the fixtures and what
//! joins them.
//!
//! # Who touches whom
//! Two geoms of MuJoCo touch when a bit of one's `contype` is in the other's `conaffinity`. A character gets a code:
//! half of 24 bits are set, another half for each. Its geoms have the code as type and the other 12 bits as affinity.
//! So its own never match, and those of two characters always do, because no code contains another. What else is in
//! the world has all bits. Seven higher bits keep what a character's own model says about touching itself.

use std::collections::BTreeSet;

use mujoco_rs::wrappers::mj_editing::{Attach, MjSpec, SpecItem};
use mujoco_rs::wrappers::mj_model::{MjModel, MjtDisableBit, MjtGeomBase, MjtJacobian, MjtObjBase};

use super::places::{Places, character_prefix};
use super::scene::Scene;
use super::settings::copy_motors;
use super::solids;
use crate::description::layout::Layout;
use crate::description::mjcf::{self, FLOOR};
use crate::description::model::Model;
use crate::description::model_error::ModelError;
use crate::description::terrain::{PLANE_DROP, Terrain};
use crate::description::world_error::WorldError;

/// Bits of a code.
const CODE_BITS: u32 = 24;

/// All bits of a code: what touches everything.
pub(super) const EVERYTHING: i32 = (1 << CODE_BITS) - 1;

/// Bits that are left for what a character's model says about touching itself.
const OWN_BITS: u32 = 31 - CODE_BITS;

/// Working memory, bytes: of a world, and of each character, prop and fixture in it. Only what is used is backed by
/// real memory.
const MEMORY: [i64; 4] = [16 << 20, 4 << 20, 256 << 10, 64 << 10];

/// A scene, built.
pub(super) struct Built {
    pub physics: Box<MjModel>,
    pub places: Places,
}

/// Builds `scene` on the ground, and with the solver's options, of `ground`.
pub(super) fn build(ground: &Model, scene: &Scene) -> Result<Built, WorldError> {
    let mut spec = MjSpec::new();
    *spec.option_mut() = ground.physics().opt().clone();
    spec.option_mut().disableflags |= MjtDisableBit::mjDSBL_AUTORESET as i32;
    // The same arithmetic whatever the size, so that adding a crate changes no bit of what is far from it.
    spec.option_mut().jacobian = MjtJacobian::mjJAC_SPARSE as i32;
    spec.compiler_mut().set_degree(false);
    let count = |found: usize, each: i64| i64::try_from(found).unwrap_or(0) * each;
    let memory = MEMORY[0]
        + count(scene.characters.iter().count(), MEMORY[1])
        + count(scene.props.iter().count(), MEMORY[2])
        + count(scene.fixtures.iter().count(), MEMORY[3]);
    spec.set_memory(memory);
    add_ground(&mut spec, ground)?;
    add_characters(&mut spec, scene)?;
    solids::add(&mut spec, scene);
    let compile = |error: &dyn std::error::Error| WorldError::Compile { message: error.to_string() };
    let mut physics = Box::new(spec.compile().map_err(|error| compile(&error))?);
    apply_strength(&mut physics, scene)?;
    let places = Places::of(&physics, scene)?;
    apply_friction(&mut physics, ground.settings().friction.into());
    Ok(Built { physics, places })
}

/// The plane and the terrain, with the contact properties of the model's own.
fn add_ground(spec: &mut MjSpec, ground: &Model) -> Result<(), WorldError> {
    let model = ground.physics();
    let missing = || ModelError::Missing { kind: "geom", name: FLOOR.into() };
    let id = model.name_to_id(MjtObjBase::mjOBJ_GEOM, FLOOR).ok_or_else(missing)?;
    let grid = ground.terrain().grid();
    let floor = spec.world_body_mut().add_geom().with_name(FLOOR);
    floor.set_type(MjtGeomBase::mjGEOM_PLANE);
    *floor.size_mut() = [0.0, 0.0, 1.0];
    *floor.pos_mut() = model.geom_pos()[id];
    if ground.terrain() != Terrain::Flat {
        floor.pos_mut()[2] += PLANE_DROP; // `add_height_field` drops it again
    }
    *floor.friction_mut() = model.geom_friction()[id];
    *floor.solref_mut() = model.geom_solref()[id];
    *floor.solimp_mut() = model.geom_solimp()[id];
    floor.set_condim(model.geom_condim()[id]);
    floor.set_priority(model.geom_priority()[id]);
    floor.set_contype(EVERYTHING);
    floor.set_conaffinity(EVERYTHING);
    grid.map_or(Ok(()), |grid| Ok(mjcf::add_height_field(spec, &grid)?))
}

/// Attaches every character. Each text is parsed once for all characters of it that follow each other.
fn add_characters(spec: &mut MjSpec, scene: &Scene) -> Result<(), WorldError> {
    let mut parsed: Option<(Model, MjSpec)> = None;
    for (index, slot) in scene.characters.iter() {
        let model = &slot.value;
        if !parsed.as_ref().is_some_and(|(last, _)| std::ptr::eq(last.mjcf(), model.mjcf())) {
            let child = MjSpec::from_xml_string(model.mjcf())
                .map_err(|error| WorldError::Compile { message: error.to_string() })?;
            parsed = Some((model.clone(), child));
        }
        let Some((_, child)) = &mut parsed else { continue };
        let root = model.skeleton().bodies()[0].name.as_str();
        let prefix = character_prefix(index);
        let body = child.body_mut(root).ok_or_else(|| WorldError::Compile { message: root.into() })?;
        spec.world_body_mut()
            .add_frame()
            .attach_by_deep_copy(body, &prefix, "")
            .map_err(|error| WorldError::Compile { message: error.to_string() })?;
        set_codes(spec, model, index)?;
    }
    Ok(())
}

/// Gives the geoms of a character its code.
fn set_codes(spec: &mut MjSpec, model: &Model, index: usize) -> Result<(), WorldError> {
    let prefix = character_prefix(index);
    let code = code(index);
    let own = own_bits(model)?;
    for body in model.skeleton().bodies() {
        let name = format!("{prefix}{}", body.name);
        let Some(body) = spec.body_mut(&name) else { continue };
        for geom in body.geom_iter_mut(false) {
            let [contype, conaffinity] = [geom.contype(), geom.conaffinity()];
            if contype | conaffinity != 0 {
                geom.set_contype(code | packed(contype, &own));
                geom.set_conaffinity(!code & EVERYTHING | packed(conaffinity, &own));
            }
        }
    }
    Ok(())
}

/// The bits by which geoms of a character can touch each other: those in a type and in an affinity.
fn own_bits(model: &Model) -> Result<BTreeSet<u32>, WorldError> {
    let physics = model.physics();
    let dynamic = |geom: &usize| model.layout().bodies[physics.geom_bodyid()[*geom] as usize].is_some();
    let geoms = || (0..physics.ngeom() as usize).filter(dynamic);
    let types = geoms().fold(0, |bits, geom| bits | physics.geom_contype()[geom]);
    let affinities = geoms().fold(0, |bits, geom| bits | physics.geom_conaffinity()[geom]);
    let bits: BTreeSet<u32> = (0..32).filter(|&bit| (types & affinities) >> bit & 1 == 1).collect();
    let found = u32::try_from(bits.len()).expect("at most 32 bits");
    if found > OWN_BITS {
        return Err(WorldError::ContactBits { most: OWN_BITS, found });
    }
    Ok(bits)
}

/// The bits of a mask that are `own`, moved above the code.
fn packed(mask: i32, own: &BTreeSet<u32>) -> i32 {
    let moved = own.iter().enumerate().map(|(to, &from)| (mask >> from & 1) << (CODE_BITS as usize + to));
    moved.fold(0, |bits, bit| bits | bit)
}

/// The code of the character of that index: the numbers with half of the bits set, in order.
fn code(index: usize) -> i32 {
    let mut code = (1u32 << (CODE_BITS / 2)) - 1;
    for _ in 0..index {
        // The next greater number with as many bits set.
        let lowest = code & code.wrapping_neg();
        let ripple = code + lowest;
        code = ripple | (((code ^ ripple) >> 2) / lowest);
    }
    code as i32
}

/// Applies the strength that the settings of each character's model give it.
fn apply_strength(physics: &mut MjModel, scene: &Scene) -> Result<(), WorldError> {
    for (index, slot) in scene.characters.iter() {
        let layout = Layout::attached(physics, slot.value.skeleton(), &character_prefix(index))?;
        copy_motors(physics, &layout, &slot.value);
    }
    Ok(())
}

/// Multiplies the friction of all but the plane and the terrain, which have it from their own model.
fn apply_friction(physics: &mut MjModel, factor: f64) {
    for geom in 0..physics.geom_bodyid().len() {
        if physics.geom_bodyid()[geom] != 0 {
            physics.geom_friction_mut()[geom][0] *= factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_match_all_but_their_own() {
        let codes: Vec<i32> = (0..300).map(code).collect();
        for (i, a) in codes.iter().enumerate() {
            assert_eq!(a.count_ones(), CODE_BITS / 2);
            for (j, b) in codes.iter().enumerate() {
                assert_eq!(a & !b & EVERYTHING != 0, i != j, "characters {i} and {j}");
            }
            assert!(a & EVERYTHING != 0 && !a & EVERYTHING != 0, "everything else touches it");
        }
    }

    #[test]
    fn own_bits_are_packed() {
        let own = BTreeSet::from([1, 5]);
        assert_eq!(packed(0b10_0010, &own), 0b11 << CODE_BITS);
        assert_eq!(packed(0b10_0000, &own), 0b10 << CODE_BITS);
        assert_eq!(packed(0b1, &own), 0);
    }
}
