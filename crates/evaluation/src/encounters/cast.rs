//! Characters in one world, each with a pad.

use glam::Vec2;
use physics_bridge::{CharacterHandle, Diverging, World, WorldEdit, WorldError};
use policy_core::contract::WALKING_START_MPS;
use policy_core::{
    Bindings, CharacterState, Command, CommandMapper, Controller, ControllerConfig, GamepadState, Heading,
};

use super::{Fate, RISE_SECS};
use crate::Rig;
use crate::eval_character::is_upright;
use crate::trial::{Gait, TICK_SECS, stick_along, ticks};

/// Where a character begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark {
    /// Metres.
    pub at: Vec2,
    /// Direction it looks and goes along, radians from x.
    pub angle: f32,
}

/// A character of the cast.
#[derive(Debug)]
pub(super) struct Player {
    pub handle: CharacterHandle,
    pub pad: GamepadState,
    pub state: CharacterState,
    controller: Controller,
    mapper: CommandMapper,
    fell_at: Option<u32>,
    up_at: Option<u32>,
    /// True when it diverged in the last tick.
    diverges: bool,
    /// True once the world has put it back, after which it stands without having got up.
    put_back: bool,
}

impl Player {
    /// Points the stick to a direction, radians from x, as far as `push` in [0, 1].
    pub fn steer(&mut self, angle: f32, push: f32) {
        self.pad.left_stick = stick_along(angle, push);
    }

    /// Horizontal place of the pelvis, metres.
    pub fn position(&self) -> Vec2 {
        self.state.root().position.truncate()
    }

    /// True from a fall until it is on its feet again, and in a tick in which its physics diverged, which counts as a fall.
    pub fn is_down(&self) -> bool {
        self.diverges || self.controller.is_down()
    }

    /// True since its first fall.
    pub fn has_fallen(&self) -> bool {
        self.fell_at.is_some()
    }
}

/// One world, its characters, and the ticks that have passed.
#[derive(Debug)]
pub(super) struct Cast {
    pub world: World,
    pub players: Vec<Player>,
    tick: u32,
}

impl Cast {
    /// A world on flat ground with a character in `gait` at every mark, and what `build` adds.
    pub fn new<T>(
        rig: &Rig<'_>,
        gait: &Gait,
        marks: &[Mark],
        build: impl FnOnce(&mut WorldEdit<'_>) -> Result<T, WorldError>,
    ) -> Result<(Self, T), WorldError> {
        let model = rig.model.described();
        let config = ControllerConfig { start: gait.start, ..rig.config };
        let mut world = World::new(model)?;
        let (handles, built) = world.edit(|edit| {
            let add = |mark: &Mark| {
                let heading = Heading::from_angle(mark.angle);
                edit.add_character(model, mark.at.x, mark.at.y, heading, WALKING_START_MPS)
            };
            let handles: Vec<CharacterHandle> = marks.iter().map(add).collect::<Result<_, _>>()?;
            Ok((handles, build(edit)?))
        })?;
        let player = |(handle, mark): (CharacterHandle, &Mark)| {
            let mut player = Player {
                handle,
                pad: gait.pad,
                state: CharacterState::new(rig.pack.skeleton()),
                controller: Controller::with_config(rig.pack.clone(), config),
                mapper: CommandMapper::new(rig.pack, &Bindings::default()),
                fell_at: None,
                up_at: None,
                diverges: false,
                put_back: false,
            };
            player.steer(mark.angle, gait.settled_push());
            player
        };
        let players = handles.into_iter().zip(marks).map(player).collect();
        let mut cast = Self { world, players, tick: 0 };
        cast.sense()?;
        Ok((cast, built))
    }

    fn sense(&mut self) -> Result<(), WorldError> {
        self.players.iter_mut().try_for_each(|p| self.world.sense_into(p.handle, &mut p.state))
    }

    /// One control tick by the pads.
    pub fn tick(&mut self) -> Result<(), WorldError> {
        self.tick_with(|_, _| None)
    }

    /// One control tick; `command` has an own command for some characters, by their number, in place of the pad's.
    pub fn tick_with(
        &mut self,
        mut command: impl FnMut(usize, &Player) -> Option<Command>,
    ) -> Result<(), WorldError> {
        for (index, player) in self.players.iter_mut().enumerate() {
            let by_pad = player.mapper.map(&player.pad, Heading::FORWARD, &player.state);
            let command = command(index, player).unwrap_or(by_pad);
            self.world.actuate(player.handle, player.controller.tick(&player.state, &command, TICK_SECS))?;
        }
        self.world.step();
        let diverged = |handle| {
            let mut culprits = self.world.divergences().iter();
            culprits.any(|divergence| divergence.what == Some(Diverging::Character(handle)))
        };
        for player in &mut self.players {
            player.diverges = diverged(player.handle);
            player.put_back |= player.diverges;
        }
        self.sense()?;
        self.tick += 1;
        for player in &mut self.players {
            let up = is_upright(player.controller.pack().skeleton(), &player.state);
            match player.fell_at {
                None if player.is_down() => player.fell_at = Some(self.tick),
                Some(_) if player.up_at.is_none() && !player.put_back && !player.is_down() && up => {
                    player.up_at = Some(self.tick);
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Ticks for a time.
    pub fn run(&mut self, secs: f32) -> Result<(), WorldError> {
        (0..ticks(secs)).try_for_each(|_| self.tick())
    }

    /// Ticks on until those that fell had their time to get up, and tells how all fared.
    pub fn fates(mut self, arrived: impl Fn(&Player) -> Option<bool>) -> Result<Vec<Fate>, WorldError> {
        let arrivals: Vec<_> = self.players.iter().map(arrived).collect();
        let fell: Vec<_> = self.players.iter().map(|player| player.fell_at).collect();
        let lies = |player: &Player| player.fell_at.is_some() && player.up_at.is_none();
        for _ in 0..ticks(RISE_SECS) {
            if !self.players.iter().any(lies) {
                break;
            }
            for player in &mut self.players {
                player.pad = GamepadState::default();
            }
            self.tick()?;
        }
        let rose = |player: &Player, fell: u32| player.up_at.is_some_and(|up| up - fell <= ticks(RISE_SECS));
        let fates = self.players.iter().zip(fell).zip(arrivals).map(|((player, fell), arrived)| Fate {
            fell: fell.is_some(),
            rose: fell.is_some_and(|fell| rose(player, fell)),
            arrived,
        });
        Ok(fates.collect())
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use physics::{Engine, Model};
    use policy_core::CharacterPack;

    use super::*;
    use crate::{Effort, Progress};

    #[test]
    fn a_divergence_is_a_fall_without_getting_up() {
        let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
        let pack = std::fs::read(assets.join("humanoid.pack.safetensors")).unwrap();
        let pack = Arc::new(CharacterPack::from_bytes(&pack).unwrap());
        let described = physics_bridge::Model::load(assets.join("humanoid.xml")).unwrap();
        let model = Model::new(&described, Engine::Mujoco).unwrap();
        let rig = Rig::new(&model, &pack, ControllerConfig::default(), Effort::QUICK, Progress::hidden());
        let idle = Gait::named(&pack, "idle").unwrap();
        let marks = [0.0, 10.0].map(|x| Mark { at: Vec2::new(x, 0.0), angle: 0.0 });
        let (mut cast, ()) = Cast::new(&rig, &idle, &marks, |_| Ok(())).unwrap();
        let [wild, _] = [0, 1].map(|index| cast.players[index].handle);
        let mut pose = physics_bridge::Character::new(&described).pose();
        cast.world.pose_into(wild, &mut pose).unwrap();
        pose.qvel[8] = 1e5;
        cast.world.set_pose(wild, &pose.qpos, &pose.qvel).unwrap();
        cast.tick().unwrap();
        assert!(cast.players[0].is_down() && !cast.players[1].is_down());
        let fates = cast.fates(|_| None).unwrap();
        assert!(fates[0].fell && !fates[0].rose && !fates[1].fell, "{fates:?}");
    }
}
