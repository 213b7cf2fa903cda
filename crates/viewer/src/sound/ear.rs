//! Hears a world: what begins to touch, and how hard; what is thrown; hinges that turn.
//!
//! Loudness follows the impulse: the speed at which two approached, times the mass that counts. What already touches is silent.

use glam::Vec3;
use physics_bridge::{Part, WorldContact};
use policy_core::BodyId;

use super::memory::{Memory, Mover, Moving};
use super::{Sound, Timbre};
use crate::sim::{Piece, SharedWorld, Simulation};

/// Mass that counts where a part of a character strikes something, kilograms.
const LIMB_KG: f32 = 5.0;
/// The impulse of the loudest strike, newton seconds: a ball of 3 kg at 9 m/s.
const LOUDEST_NS: f32 = 27.0;
/// Strength grows with this power of the impulse.
const POWER: f32 = 0.6;
/// A slower approach is not heard, metres per second.
const SLOWEST_MPS: f32 = 0.2;
/// A change of a free prop's speed that no contact explains is heard from here on: it bounced within a tick. Metres per second.
const JUMP_MPS: f32 = 1.5;
/// What appears faster than this was thrown, metres per second.
const THROWN_MPS: f32 = 4.0;
/// A hinge is heard above this speed, and again after it was below the other, radians per second.
const CREAKS_RADPS: [f32; 2] = [0.8, 0.25];
/// At this distance and nearer sounds are at their full strength, metres.
const NEAR_M: f32 = 5.0;
/// Beyond this they are not heard, metres.
const FAR_M: f32 = 40.0;
/// The length of a thing that sounds at its timbre's own pitch, metres.
const USUAL_M: f32 = 0.4;
/// Most sounds until they are taken: the first are those of the player.
const MOST: usize = 12;
/// On the empty floor only so many characters are heard.
const MOST_HEARD: usize = 8;

/// Who hears: where, and the direction to the right, a unit vector. World space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Listener {
    /// Metres.
    pub at: Vec3,
    /// To the right.
    pub right: Vec3,
}

/// See the module.
#[derive(Debug, Default)]
pub struct Ear {
    memory: Memory,
    turning: Vec<physics_bridge::PropHandle>,
    sounds: Vec<Sound>,
}

/// Two that touch: what moves first, and what each is.
struct Touch {
    pair: (Mover, Option<Mover>),
    sources: [Source; 2],
    point: Vec3,
    normal: Vec3,
}

/// One of two that touch.
#[derive(Clone, Copy)]
struct Source {
    timbre: Timbre,
    pitch: f32,
    /// `None` for what can't move.
    mass_kg: Option<f32>,
}

impl Ear {
    /// Takes what the last tick of a world brought.
    pub fn hear(&mut self, sim: &Simulation, listener: Listener) {
        if self.memory.is_some() {
            match sim.shared() {
                Some(shared) => self.hear_shared(sim, shared, listener),
                None => self.hear_apart(sim, listener),
            }
        }
        self.memory.look(sim);
    }

    /// Adds sounds that no contact makes, while there is room.
    pub fn add(&mut self, sounds: impl IntoIterator<Item = Sound>) {
        let room = (2 * MOST).saturating_sub(self.sounds.len());
        self.sounds.extend(sounds.into_iter().take(room));
    }

    /// What was heard since this was called last.
    pub fn take(&mut self) -> std::vec::Drain<'_, Sound> {
        self.sounds.drain(..)
    }

    fn hear_shared(&mut self, sim: &Simulation, shared: &SharedWorld, listener: Listener) {
        let feet = sim.pack().skeleton().feet();
        let contacts = shared.world().contacts();
        // The player's come first, in case there are too many.
        for players in [true, false] {
            for contact in contacts {
                let Some(touch) = touch_of(contact, shared, feet) else { continue };
                if matches!(touch.pair.0, Mover::Body(0, _)) == players {
                    self.strike(&touch, listener);
                }
            }
        }
        let gravity = Vec3::Z * -9.81 * shared.world().ground().settings().gravity * sim.tick_secs();
        for piece in shared.pieces() {
            self.follow(piece, shared, gravity, listener);
        }
        self.turning.retain(|handle| shared.world().motion(*handle).is_ok());
    }

    fn hear_apart(&mut self, sim: &Simulation, listener: Listener) {
        let feet = sim.pack().skeleton().feet();
        for index in 0..sim.characters().len().min(MOST_HEARD) {
            for contact in sim.character(index).contacts().iter().filter(|contact| contact.other.is_none()) {
                let touch = Touch {
                    pair: (Mover::Body(index, contact.body), None),
                    sources: [limb(contact.body, feet), FLOOR],
                    point: contact.position,
                    normal: -contact.normal,
                };
                self.strike(&touch, listener);
            }
        }
    }

    /// Both sides of two that begin to touch, as loud as they met.
    fn strike(&mut self, touch: &Touch, listener: Listener) {
        if !self.memory.touch(touch.pair) {
            return;
        }
        let velocity = |mover| self.memory.of(mover).map(|moving: Moving| moving.at(touch.point));
        let Some(first) = velocity(touch.pair.0) else { return };
        let Some(second) = touch.pair.1.map_or(Some(Vec3::ZERO), velocity) else { return };
        let approach = (first - second).dot(touch.normal);
        if approach < SLOWEST_MPS {
            return;
        }
        let [one, other] = touch.sources;
        let strength = strength_of(approach * mass_of(one.mass_kg, other.mass_kg));
        // A soft one damps the other.
        let soft = matches!(one.timbre, Timbre::Step | Timbre::Body);
        self.tell(one, strength, touch.point, listener);
        if one.timbre != other.timbre {
            self.tell(other, if soft { 0.5 * strength } else { 0.8 * strength }, touch.point, listener);
        }
    }

    /// A prop between two ticks: thrown, struck and gone again, or turning on its hinge.
    fn follow(&mut self, piece: &Piece, shared: &SharedWorld, gravity: Vec3, listener: Listener) {
        let Ok(motion) = shared.world().motion(piece.handle) else { return };
        let mover = Mover::Prop(piece.handle);
        let Some(before) = self.memory.of(mover) else {
            if motion.velocity.length() > THROWN_MPS {
                let air = Source { timbre: Timbre::Air, pitch: 1.0, mass_kg: None };
                self.tell(air, 0.3, motion.position, listener);
            }
            return;
        };
        if piece.anchor.is_some() {
            let [fast, slow] = CREAKS_RADPS;
            let spin = motion.spin.length();
            let at = self.turning.iter().position(|handle| *handle == piece.handle);
            match at {
                // What is driven to swing turns all the time.
                None if spin > fast && !shared.is_driven(piece) => {
                    self.turning.push(piece.handle);
                    let creak = Source { timbre: Timbre::Creak, ..source_of(piece) };
                    self.tell(creak, (0.1 * spin).min(0.35), motion.position, listener);
                }
                Some(at) if spin < slow => drop(self.turning.swap_remove(at)),
                _ => {}
            }
            return;
        }
        let jump = motion.velocity - before.velocity - gravity;
        let is_stopped = jump.dot(before.velocity) < 0.0;
        if is_stopped && jump.length() > JUMP_MPS && !self.memory.touches(mover) {
            let strength = strength_of(jump.length() * piece.mass_kg);
            self.tell(source_of(piece), strength, motion.position, listener);
        }
    }

    fn tell(&mut self, source: Source, strength: f32, at: Vec3, listener: Listener) {
        let way = at - listener.at;
        let distance = way.length();
        if self.sounds.len() >= MOST || distance > FAR_M {
            return;
        }
        let strength = strength * NEAR_M / distance.max(NEAR_M);
        let pan = 0.7 * way.dot(listener.right) / distance.max(1.0);
        self.sounds.push(Sound { pitch: source.pitch, pan, ..Sound::new(source.timbre, strength) });
    }
}

const FLOOR: Source = Source { timbre: Timbre::Stone, pitch: 1.0, mass_kg: None };

fn strength_of(impulse_ns: f32) -> f32 {
    (impulse_ns / LOUDEST_NS).clamp(0.0, 1.0).powf(POWER)
}

/// The mass that counts where two meet.
fn mass_of(one: Option<f32>, other: Option<f32>) -> f32 {
    match (one, other) {
        (Some(one), Some(other)) => one * other / (one + other),
        (Some(mass), None) | (None, Some(mass)) => mass,
        (None, None) => 0.0,
    }
}

fn limb(body: BodyId, feet: &[BodyId]) -> Source {
    let timbre = if feet.contains(&body) { Timbre::Step } else { Timbre::Body };
    Source { timbre, pitch: 1.0, mass_kg: Some(LIMB_KG) }
}

/// A prop: large ones are low.
fn source_of(piece: &Piece) -> Source {
    let pitch = (USUAL_M / piece.length_m().max(0.05)).sqrt().clamp(0.5, 2.0);
    Source { timbre: Timbre::of(Some(&piece.solid), piece.paint), pitch, mass_kg: Some(piece.mass_kg) }
}

/// What a contact is to the ear; `None` for a character that touches itself, and for what is gone.
fn touch_of(contact: &WorldContact, shared: &SharedWorld, feet: &[BodyId]) -> Option<Touch> {
    let side = |part: Part| match part {
        Part::Ground => Some((None, FLOOR)),
        Part::Fixture(handle) => {
            let timbre = Timbre::of(None, shared.paint_of(handle)?);
            Some((None, Source { timbre, ..FLOOR }))
        }
        Part::Prop(handle) => {
            let piece = shared.pieces().iter().find(|piece| piece.handle == handle)?;
            Some((Some(Mover::Prop(handle)), source_of(piece)))
        }
        Part::Body(handle, body) => {
            Some((Some(Mover::Body(shared.index_of(handle)?, body)), limb(body, feet)))
        }
    };
    let [first, second] = contact.parts.map(side);
    let (first, second) = (first?, second?);
    let is_body = |mover| matches!(mover, Some(Mover::Body(..)));
    // Bodies come first, then props; the normal is from the first to the second.
    let swap = first.0.is_none() || (!is_body(first.0) && is_body(second.0));
    let ((one, first), (other, second), normal) =
        if swap { (second, first, -contact.normal) } else { (first, second, contact.normal) };
    if let (Some(Mover::Body(mine, _)), Some(Mover::Body(others, _))) = (one, other)
        && mine == others
    {
        return None;
    }
    Some(Touch { pair: (one?, other), sources: [first, second], point: contact.position, normal })
}
