//! Adding and removing while the world runs: any number of changes at once, all or none.

use glam::{DQuat, DVec3};
use policy_core::Heading;
use policy_core::contract::{DescriptionError, Fixture, Joint, Motion, Prop};

use super::World;
use super::handle::{CharacterHandle, FixtureHandle, JointHandle, PropHandle};
use super::scene::{JointRecord, PropRecord, Rope, Scene};
use super::stand::check_stand;
use crate::description::model::Model;
use crate::description::world_error::WorldError;

/// Most characters in a world.
const MOST_CHARACTERS: usize = 1024;

/// How much longer the steps of a world may be than those of a character, seconds.
const TIMESTEP_TOLERANCE_SECS: f64 = 1e-6;

/// Most props and fixtures in a world, of each.
const MOST_THINGS: usize = 4096;

/// Changes to a [`World`], made by [`World::edit`].
#[derive(Debug)]
pub struct WorldEdit<'w> {
    world: &'w World,
    scene: Scene,
    placements: Vec<Placement>,
    /// True when the simulation has to be built anew.
    builds: bool,
}

/// Where something new is to be.
#[derive(Clone, Debug)]
pub(super) enum Placement {
    Prop(usize, Motion),
    Character { index: usize, place: [f32; 2], heading: f32, speed_mps: f32 },
}

impl World {
    /// Adds and removes things, all at once. What stays keeps its state bit for bit, and handles stay valid. When
    /// `change` fails, nothing is changed. Contacts are forgotten until the next tick. A recorded history begins
    /// anew when the simulation is built anew, and goes on otherwise.
    ///
    /// # Errors
    /// Those of `change`, and when MuJoCo refuses what was put together.
    pub fn edit<T>(
        &mut self,
        change: impl FnOnce(&mut WorldEdit<'_>) -> Result<T, WorldError>,
    ) -> Result<T, WorldError> {
        let scene = self.scene.clone();
        let mut edit = WorldEdit { world: self, scene, placements: Vec::new(), builds: false };
        let changed = change(&mut edit);
        let WorldEdit { scene, placements, builds, .. } = edit;
        // A handle that a failed edit returned must never name something else.
        self.scene.generations_after(&scene);
        let result = changed?;
        if builds {
            self.rebuild(scene, &placements)?;
        } else {
            self.exchange(scene, &placements);
        }
        Ok(result)
    }
}

impl WorldEdit<'_> {
    /// Adds a character that stands on the ground at a point, metres, world space, on the highest fixture there,
    /// facing along `heading`. All of it moves along `heading` at `speed_mps`: 0 for a policy that stands.
    ///
    /// The setting of its model for strength applies; gravity and friction are the world's, mass is that of the MJCF.
    ///
    /// # Errors
    /// When it has another control rate than the world or was made for shorter steps, or a number is out of its range.
    pub fn add_character(
        &mut self,
        model: &Model,
        x: f32,
        y: f32,
        heading: Heading,
        speed_mps: f32,
    ) -> Result<CharacterHandle, WorldError> {
        check_stand(x, y, heading, speed_mps)?;
        let ground = &self.world.ground;
        let fits = model.control_hz() == ground.control_hz()
            && model.timestep_secs() > ground.timestep_secs() - TIMESTEP_TOLERANCE_SECS;
        if !fits {
            return Err(WorldError::Rate {
                control_hz: ground.control_hz(),
                timestep_secs: ground.timestep_secs(),
                found_control_hz: model.control_hz(),
                found_timestep_secs: model.timestep_secs(),
            });
        }
        self.at_most("characters", self.scene.characters.iter().count(), MOST_CHARACTERS)?;
        let generation = self.scene.generation();
        let index = self.scene.characters.insert(generation, true, model.clone());
        let heading = heading.angle();
        self.placements.push(Placement::Character { index, place: [x, y], heading, speed_mps });
        self.builds = true;
        Ok(self.scene.characters.handle(index))
    }

    /// Adds a prop. Takes one that was reserved, or that was removed since the last build, if there is an equal one.
    ///
    /// # Errors
    /// When a number is out of its range.
    pub fn add_prop(&mut self, prop: Prop, motion: Motion) -> Result<PropHandle, WorldError> {
        prop.check()?;
        motion.check()?;
        let generation = self.scene.generation();
        let is_spare = |index: usize| {
            let slot = self.scene.props.slot(index);
            slot.is_some_and(|slot| !slot.present && slot.value.hold.is_none() && slot.value.prop == prop)
                && self.scene.joints_of(index).is_empty()
        };
        let spare = (0..self.scene.props.end()).find(|&index| is_spare(index));
        let index = match spare {
            Some(index) => {
                let slot = self.scene.props.slot_mut(index).expect("a spare");
                (slot.generation, slot.present) = (generation, true);
                index
            }
            None => self.insert_prop(generation, true, prop)?,
        };
        self.placements.push(Placement::Prop(index, motion));
        Ok(self.scene.props.handle(index))
    }

    /// Keeps `count` such props ready, so that they can be added without building the simulation anew. They are ready
    /// again whenever they are removed.
    ///
    /// # Errors
    /// When a number is out of its range.
    pub fn reserve_props(&mut self, prop: &Prop, count: usize) -> Result<(), WorldError> {
        prop.check()?;
        for _ in 0..count {
            let generation = self.scene.generation();
            let index = self.insert_prop(generation, false, prop.clone())?;
            self.scene.props.at_mut(index).is_reserved = true;
        }
        Ok(())
    }

    /// Adds a fixture.
    ///
    /// # Errors
    /// When a number is out of its range.
    pub fn add_fixture(&mut self, fixture: Fixture) -> Result<FixtureHandle, WorldError> {
        fixture.check()?;
        self.at_most("fixtures", self.scene.fixtures.iter().count(), MOST_THINGS)?;
        let generation = self.scene.generation();
        let index = self.scene.fixtures.insert(generation, true, fixture);
        self.builds = true;
        Ok(self.scene.fixtures.handle(index))
    }

    /// Joins a prop to another one, or to the world where there is none. A rope joins any two; a hinge, slide or ball
    /// joint is for a prop that does not hang on one yet, or else for another that does not.
    ///
    /// # Errors
    /// When a handle is stale, a number is out of its range, or the joint would close a loop.
    pub fn join(
        &mut self,
        prop: PropHandle,
        other: Option<PropHandle>,
        joint: Joint,
    ) -> Result<JointHandle, WorldError> {
        joint.check()?;
        let a = self.scene.props.index_of(prop)?;
        let b = other.map(|other| self.scene.props.index_of(other)).transpose()?;
        if b == Some(a) {
            return Err(WorldError::Loop);
        }
        let generation = self.scene.generation();
        let record = if let Joint::Rope { ends, length } = joint {
            let local = |prop: Option<usize>, end: glam::Vec3| {
                let (position, rotation) = self.pose(prop);
                rotation.inverse() * (end.as_dvec3() - position)
            };
            let points = [local(Some(a), ends[0]), local(b, ends[1])];
            JointRecord::Rope(Rope { props: [Some(a), b], points, length: length.into() })
        } else {
            let is_free = |prop: usize| self.scene.props.at(prop).hold.is_none();
            match (is_free(a), b) {
                (true, Some(b)) if self.scene.root_of(b) == a && !is_free(b) => {
                    return Err(WorldError::Loop);
                }
                (true, _) => JointRecord::Hold { prop: a },
                (false, Some(b)) if is_free(b) && self.scene.root_of(a) != b => JointRecord::Hold { prop: b },
                _ => return Err(WorldError::Loop),
            }
        };
        let index = self.scene.joints.insert(generation, true, record.clone());
        if let JointRecord::Hold { prop: held } = record {
            let parent = if held == a { b } else { Some(a) };
            let poses = [self.pose(Some(held)), self.pose(parent)];
            self.scene.hang(held, parent, &joint, poses, index);
        }
        self.builds = true;
        Ok(self.scene.joints.handle(index))
    }

    /// Removes a character.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn remove_character(&mut self, character: CharacterHandle) -> Result<(), WorldError> {
        let index = self.scene.characters.index_of(character)?;
        self.scene.characters.clear(index);
        self.placements.retain(|p| !matches!(p, Placement::Character { index: i, .. } if *i == index));
        self.builds = true;
        Ok(())
    }

    /// Removes a prop and its joints. What hung on it is free and goes on as it moved.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn remove_prop(&mut self, prop: PropHandle) -> Result<(), WorldError> {
        let index = self.scene.props.index_of(prop)?;
        for joint in self.scene.joints_of(index) {
            self.scene.remove_joint(joint);
            self.builds = true;
        }
        self.placements.retain(|p| !matches!(p, Placement::Prop(i, _) if *i == index));
        if let Some(slot) = self.scene.props.slot_mut(index) {
            slot.present = false;
        }
        Ok(())
    }

    /// Removes a fixture.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn remove_fixture(&mut self, fixture: FixtureHandle) -> Result<(), WorldError> {
        let index = self.scene.fixtures.index_of(fixture)?;
        self.scene.fixtures.clear(index);
        self.builds = true;
        Ok(())
    }

    /// Removes a joint. What hung on it is free and goes on as it moved.
    ///
    /// # Errors
    /// When the handle is stale.
    pub fn remove_joint(&mut self, joint: JointHandle) -> Result<(), WorldError> {
        let index = self.scene.joints.index_of(joint)?;
        self.scene.remove_joint(index);
        self.builds = true;
        Ok(())
    }

    fn insert_prop(&mut self, generation: u32, present: bool, prop: Prop) -> Result<usize, WorldError> {
        self.at_most("props", self.scene.props.iter().count(), MOST_THINGS)?;
        self.builds = true;
        let record = PropRecord { prop, hold: None, is_reserved: false };
        Ok(self.scene.props.insert(generation, present, record))
    }

    fn at_most(&self, what: &'static str, found: usize, most: usize) -> Result<(), WorldError> {
        if found < most { Ok(()) } else { Err(DescriptionError::TooMany { what, most }.into()) }
    }

    /// Where a prop is now, or will be when the edit is done; the identity for the world.
    fn pose(&self, prop: Option<usize>) -> (DVec3, DQuat) {
        let Some(index) = prop else { return (DVec3::ZERO, DQuat::IDENTITY) };
        let placed = self.placements.iter().rev().find_map(|placement| match placement {
            Placement::Prop(placed, motion) if *placed == index => Some(motion),
            _ => None,
        });
        match placed {
            Some(motion) => (motion.position.as_dvec3(), motion.rotation.as_dquat().normalize()),
            None => self.world.exact_motion(self.world.places.prop(index).body).0,
        }
    }
}
