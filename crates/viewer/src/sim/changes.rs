//! What changes a world between ticks: resets, settings, blend modes, ghosts, going back in time.

use glam::Vec2;
use policy_core::contract::{MAX_DISTANCE_M, Settings};
use policy_core::{BlendMode, GamepadState, GraphPosition, Heading};

use super::bodies::Bodies;
use super::{Ghost, GhostKind, LEAST_FRICTION, SimError, Simulation, SteeredCharacter};

/// Way that a character must have before the end of the world, metres.
const ROOM_M: f32 = 100.0;

impl Simulation {
    /// Stands a character up where it is, or at its start when that is so far away that it would diverge again.
    pub fn stand_up(&mut self, index: usize) {
        let (at, heading) = (self.steered[index].position(), self.steered[index].heading());
        // Also for a place that is no number.
        let near = at.length() < MAX_DISTANCE_M - ROOM_M;
        let at = if near { at } else { self.start_of(index).0 };
        if self.bodies.stand_at(index, at, heading) {
            self.totals.stood_up += 1;
            self.restart(index);
        }
    }

    /// Stands a character somewhere else, facing as it does. False when it can't stand there.
    pub fn carry(&mut self, index: usize, to: Vec2) -> bool {
        let heading = self.steered[index].heading();
        let stood = self.bodies.stand_at(index, to, heading);
        if stood {
            self.restart(index);
        }
        stood
    }

    /// Puts every character back to the start.
    pub fn reset(&mut self) {
        if self.playback.is_some() {
            return self.show_pose(0);
        }
        if self.shared().is_some() {
            // Props are back where they were too. What was built once is built again.
            let built = self.rebuild(self.config);
            debug_assert!(built.is_ok(), "{built:?}");
        } else {
            for index in 0..self.steered.len() {
                let (at, heading) = self.start_of(index);
                self.steered[index].forget_falls();
                if self.bodies.stand_at(index, at, heading) {
                    self.restart(index);
                }
            }
        }
        self.mapper.reset();
        self.last_pad = GamepadState::default();
        self.restart_ghost();
    }

    /// Begins anew with a character that was put somewhere. The player's history begins with its pad.
    fn restart(&mut self, index: usize) {
        self.steered[index].restart(self.bodies.of(index));
        if self.shared().is_some() {
            // They share one past.
            self.steered.iter_mut().for_each(SteeredCharacter::forget_past);
        }
        if index == 0 || self.shared().is_some() {
            self.pads.clear();
            *self.pads.next() = self.last_pad;
        }
    }

    /// Changes gravity, friction, strength and mass. Friction below [`LEAST_FRICTION`] is raised to it.
    ///
    /// # Errors
    /// When a setting is out of its range; nothing is changed then.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), SimError> {
        let settings = Settings { friction: settings.friction.max(LEAST_FRICTION), ..settings };
        let model = self.model.with_settings(settings)?;
        match &mut self.bodies {
            Bodies::Apart(crowd) => {
                for character in crowd.characters_mut() {
                    character.set_model(&model)?;
                }
            }
            Bodies::Together(shared) => shared.set_model(model.described())?,
        }
        if let Some(ghost) = &mut self.ghost {
            ghost.set_settings(settings)?;
        }
        self.model = model;
        Ok(())
    }

    /// How every controller makes an action of a blend, from the next tick on. The ghost keeps its own mode, and so do all in a
    /// comparison.
    pub fn set_blend_mode(&mut self, mode: BlendMode) {
        if self.config.comparison {
            return;
        }
        self.steered.iter_mut().for_each(|steered| steered.controller.set_blend_mode(mode));
    }

    /// A second character from the player's present state, under another blend mode or in another engine.
    ///
    /// # Errors
    /// When that engine can't load the body; nothing is changed then.
    pub fn start_ghost(&mut self, kind: GhostKind) -> Result<(), SimError> {
        let Bodies::Apart(crowd) = &self.bodies else {
            return Err(SimError::NotInPlayground {
                said: "Ghosts need the empty floor: choose Scene \"empty\" in Physics.",
            });
        };
        self.ghost = Ghost::of(crowd.character(0), &self.steered[0], kind)?;
        Ok(())
    }

    /// Ends the comparison.
    pub fn stop_ghost(&mut self) {
        self.ghost = None;
    }

    /// Starts the ghost again from the player's present state, if there is one.
    fn restart_ghost(&mut self) {
        if let Some(ghost) = self.ghost.take() {
            let started = self.start_ghost(ghost.kind());
            // The engine has loaded this body before.
            debug_assert!(started.is_ok(), "{started:?}");
        }
    }

    /// Takes every character that keeps a history to its state `age` ticks ago, with its controller. The next tick
    /// continues from there as it did the first time, bit for bit under the same pad; what came after is forgotten.
    pub fn rewind_to(&mut self, age: usize) {
        let rewound: Vec<bool> = match &mut self.bodies {
            Bodies::Apart(crowd) => crowd.characters_mut().map(|c| c.rewind_to(age).is_ok()).collect(),
            Bodies::Together(shared) => vec![shared.rewind_to(age); self.steered.len()],
        };
        for (index, _) in rewound.iter().enumerate().filter(|(_, rewound)| **rewound) {
            self.steered[index].rewind_to(age, self.bodies.of(index));
        }
        if let Some(pad) = self.pads.rewind_to(age).copied() {
            self.last_pad = pad;
            // The mapper remembers the buttons of the pad that it saw last.
            self.mapper.map(&pad, Heading::FORWARD, &self.steered[0].state);
        }
        self.restart_ghost();
    }

    pub(super) fn renew_controllers(&mut self) {
        for steered in &mut self.steered {
            steered.renew_controller().expect("the state comes from a controller of the same pack");
        }
    }

    /// Puts the player's controller at a position on the graph at once. Returns false when the graph has no such
    /// position.
    pub fn place_at(&mut self, position: GraphPosition) -> bool {
        self.steered[0].controller.place_at(position)
    }
}
