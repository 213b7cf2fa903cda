//! The characters and props of a playground in one world, with the course and the characters that wander.

mod loose;
mod pieces;
mod sight;
mod wishes;

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{Vec2, Vec3};
use physics_bridge::{
    CharacterHandle, Diverging, FixtureHandle, Grab, HISTORY_SECS, Handle, Model, Motion, Movable,
    PropHandle, Remedy, World,
};
use policy_core::{BodyId, Heading};

use super::rewind::Ring;
use super::{SimError, SteeredCharacter};
pub use loose::MOST_BALLS;
pub use pieces::Piece;
pub use playground::LooseKind;
use playground::{Paint, Playground, Race, RaceEvent, Wanderer};

/// What the mouse can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// A body of a character, by index.
    Body(usize, BodyId),
    /// A prop.
    Prop(PropHandle),
}

/// Strongest pull on what is held, newtons.
const HOLD_NEWTON: f32 = 800.0;

/// One world of characters and props.
#[derive(Debug)]
pub struct SharedWorld {
    scene: Arc<Playground>,
    world: World,
    characters: Vec<CharacterHandle>,
    fixtures: Vec<(FixtureHandle, Paint)>,
    state: PlayState,
    history: Option<Box<Ring<PlayState>>>,
    held: Option<(Held, Handle<Grab>)>,
    events: Vec<RaceEvent>,
    /// What diverged since they were read, in words.
    put_right: Vec<String>,
    control_time: Duration,
}

/// All that changes from tick to tick besides the physics and the controllers.
#[derive(Clone, Debug)]
pub(super) struct PlayState {
    pieces: Vec<Piece>,
    wanderers: Vec<Wanderer>,
    race: Race,
    spawned: u32,
}

impl SharedWorld {
    /// The scene with its first `characters` characters of `model`. Equal seeds make those wander alike.
    pub(super) fn new(
        scene: Arc<Playground>,
        model: &Model,
        characters: usize,
        seed: u32,
        history: bool,
    ) -> Result<Self, SimError> {
        if !(1..=scene.starts.len()).contains(&characters) {
            return Err(SimError::PlaygroundCharacters { most: scene.starts.len(), found: characters });
        }
        let mut world = World::new(model)?;
        let (handles, pieces, fixtures) = world.edit(|edit| {
            let mut fixtures = Vec::with_capacity(scene.fixtures.len());
            for painted in &scene.fixtures {
                fixtures.push((edit.add_fixture(painted.fixture.clone())?, painted.paint));
            }
            let pieces = pieces::add(edit, &scene)?;
            loose::reserve(edit)?;
            let mut handles = Vec::new();
            for start in &scene.starts[..characters] {
                let heading = Heading::from_angle(start.heading);
                handles.push(edit.add_character(model, start.at.x, start.at.y, heading, 0.0)?);
            }
            Ok((handles, pieces, fixtures))
        })?;
        let wanderer = |(index, start): (usize, &playground::Start)| {
            Wanderer::new(start.zone, start.heading, seed.into(), index as u64)
        };
        let wanderers = scene.starts[..characters].iter().enumerate().skip(1).map(wanderer).collect();
        let state = PlayState { pieces, wanderers, race: Race::default(), spawned: 0 };
        if history {
            world.record_history(HISTORY_SECS);
        }
        let ring = history.then(|| Box::new(Ring::new(model.control_hz(), &state)));
        let mut shared = Self {
            scene,
            world,
            characters: handles,
            fixtures,
            state,
            history: ring,
            held: None,
            events: Vec::new(),
            put_right: Vec::new(),
            control_time: Duration::ZERO,
        };
        shared.look();
        shared.look();
        shared.restart_history();
        Ok(shared)
    }

    /// What it was made of.
    #[must_use]
    pub fn scene(&self) -> &Arc<Playground> {
        &self.scene
    }

    /// The physics.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The player's run over the course.
    #[must_use]
    pub fn race(&self) -> &Race {
        &self.state.race
    }

    /// Forgets the run over the course: the first ring starts another.
    pub(crate) fn restart_race(&mut self) {
        self.state.race = Race::default();
    }

    /// A character, by index.
    ///
    /// # Panics
    /// When there is none of that index.
    #[must_use]
    pub fn handle(&self, index: usize) -> CharacterHandle {
        self.characters[index]
    }

    /// The prop of that name in the scene, while it is there.
    #[must_use]
    pub fn prop_named(&self, name: &str) -> Option<PropHandle> {
        self.prop_at(self.scene.props.iter().position(|prop| prop.name == name)?)
    }

    /// The motion of a prop, by its index in the scene, while it is there.
    #[must_use]
    pub fn motion_of(&self, index: usize) -> Option<Motion> {
        self.world.motion(self.prop_at(index)?).ok()
    }

    fn prop_at(&self, index: usize) -> Option<PropHandle> {
        self.state.pieces.iter().find(|piece| piece.of_scene == Some(index)).map(|piece| piece.handle)
    }

    /// What happened on the course since this was called last.
    pub fn take_events(&mut self) -> Vec<RaceEvent> {
        std::mem::take(&mut self.events)
    }

    /// What diverged since this was called last, and what became of it.
    pub fn take_put_right(&mut self) -> Vec<String> {
        std::mem::take(&mut self.put_right)
    }

    pub(super) fn control_time(&self) -> Duration {
        self.control_time
    }

    /// Changes gravity, friction and strength.
    pub(super) fn set_model(&mut self, model: &Model) -> Result<(), SimError> {
        self.world.set_ground(model)?;
        for &handle in &self.characters {
            // One that is gone gets it when it comes back.
            if self.world.model(handle).is_ok() {
                self.world.set_model(handle, model)?;
            }
        }
        Ok(())
    }

    pub(super) fn stand_at(&mut self, index: usize, at: Vec2, heading: Heading) -> bool {
        let stood = self.world.stand_at(self.characters[index], at.x, at.y, heading, 0.0).is_ok();
        if stood {
            self.restart_history();
        }
        stood
    }

    pub(super) fn push(&mut self, index: usize, body: BodyId, force: Vec3, secs: f32) -> bool {
        self.world.push(Movable::Body(self.characters[index], body), force, secs).is_ok()
    }

    /// Hits a body of a character with newton seconds. Out of its bounds it does nothing.
    pub fn impulse(&mut self, index: usize, body: BodyId, impulse: Vec3) {
        let _ = self.world.impulse(Movable::Body(self.characters[index], body), impulse);
    }

    /// One tick: controllers, then physics. Indices of the characters that were put back.
    pub(super) fn tick(
        &mut self,
        steered: &mut [SteeredCharacter],
        model: &Model,
        dt_secs: f32,
    ) -> Vec<usize> {
        let start = Instant::now();
        for (steered, &handle) in steered.iter_mut().zip(&self.characters) {
            // One that is gone is put back after the step.
            if self.world.sense_into(handle, &mut steered.state).is_ok() {
                let targets = steered.controller.tick(&steered.state, &steered.command, dt_secs);
                let _ = self.world.actuate(handle, targets);
            }
        }
        self.control_time = start.elapsed();
        self.drive_swings(dt_secs);
        self.world.step();
        self.note_divergences(model)
    }

    /// What follows from a tick for props and course.
    pub(super) fn observe(&mut self, player: &SteeredCharacter) {
        self.look();
        let event = self.state.race.tick(&self.scene.checkpoints, player.position(), player.is_down());
        self.events.extend(event);
        self.remember();
    }

    /// Pulls what is held towards a point, metres, world space; `None` releases it.
    pub fn hold(&mut self, what: Option<(Held, Vec3)>) {
        if let Some((held, grab)) = self.held
            && what.is_none_or(|(wanted, _)| wanted != held)
        {
            // What it held may be gone, and the grab with it.
            let _ = self.world.release(grab);
            self.held = None;
        }
        let Some((wanted, to)) = what else { return };
        let Some((movable, at)) = self.movable(wanted) else { return };
        if self.held.is_none() {
            self.held = self.world.grab(movable, at, HOLD_NEWTON).ok().map(|grab| (wanted, grab));
        }
        if let Some((_, grab)) = self.held
            && self.world.move_grab(grab, to).is_err()
        {
            self.held = None;
        }
    }

    /// What is held, and where its origin is.
    fn movable(&self, held: Held) -> Option<(Movable, Vec3)> {
        match held {
            Held::Prop(prop) => Some((prop.into(), self.world.motion(prop).ok()?.position)),
            Held::Body(index, body) => {
                let handle = *self.characters.get(index)?;
                let mut poses = physics_bridge::BodyPoses::new(self.world.model(handle).ok()?.skeleton());
                self.world.poses_into(handle, &mut poses).ok()?;
                Some((Movable::Body(handle, body), *poses.positions.get(body.index())?))
            }
        }
    }

    /// States that it can be taken back by, and how far back it is now.
    pub(super) fn history(&self) -> (usize, usize) {
        (self.world.history_len().saturating_sub(1), self.world.history_age())
    }

    /// Goes to a state of the past; false when it is not kept. What is held is released.
    pub(super) fn rewind_to(&mut self, age: usize) -> bool {
        if self.world.rewind_to(age).is_err() {
            return false;
        }
        self.world.release_all();
        self.held = None;
        if let Some(state) = self.history.as_mut().and_then(|history| history.rewind_to(age)) {
            self.state = state.clone();
        }
        true
    }

    /// Forgets the past, as the physics does when something is placed.
    fn restart_history(&mut self) {
        if let Some(history) = &mut self.history {
            history.clear();
        }
        self.remember();
    }

    fn remember(&mut self) {
        if let Some(history) = &mut self.history {
            history.next().clone_from(&self.state);
        }
    }

    /// Puts what diverged into words. A character that was taken out comes back to its start.
    fn note_divergences(&mut self, model: &Model) -> Vec<usize> {
        let mut put_back = Vec::new();
        let divergences = self.world.divergences().to_vec();
        for divergence in divergences {
            let outcome = match divergence.remedy {
                Remedy::PutBack => "was put back",
                Remedy::TakenOut => "was taken out",
                Remedy::Ignored => "kept the targets of before",
                _ => "is as it was",
            };
            let who = match divergence.what {
                Some(Diverging::Character(handle)) => {
                    let Some(index) = self.characters.iter().position(|&other| other == handle) else {
                        continue;
                    };
                    if divergence.remedy == Remedy::TakenOut {
                        self.bring_back(index, model);
                    }
                    put_back.push(index);
                    format!("character {index}")
                }
                Some(Diverging::Prop(_)) => "a prop".into(),
                _ => "the world".into(),
            };
            self.put_right
                .push(format!("The physics of {who} diverged ({}): it {outcome}.", divergence.cause));
        }
        put_back
    }

    /// A new body at its start for a character that was taken out.
    fn bring_back(&mut self, index: usize, model: &Model) {
        let start = self.scene.starts[index];
        let heading = Heading::from_angle(start.heading);
        let added = self.world.edit(|edit| edit.add_character(model, start.at.x, start.at.y, heading, 0.0));
        if let Ok(handle) = added {
            self.characters[index] = handle;
            self.restart_history();
        }
    }

    /// Keeps pendulums at their height: a push along their motion while they have less energy than they began with.
    fn drive_swings(&mut self, dt_secs: f32) {
        for piece in &self.state.pieces {
            let Some(prop) = piece.of_scene.map(|index| &self.scene.props[index]) else { continue };
            let Ok(motion) = self.world.motion(piece.handle) else { continue };
            if let Some(force) = prop.swing_force(&motion) {
                let _ = self.world.push(piece.handle, force, dt_secs);
            }
        }
    }
}
