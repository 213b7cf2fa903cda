//! The encounters themselves, each small enough to be watched.

use std::collections::BTreeMap;
use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Quat, Vec2, Vec3};
use physics_bridge::{Fixture, Joint, Motion, Prop, PropHandle, Solid, WorldEdit, WorldError};
use random::Rng;

use super::cast::{Cast, Mark};
use super::{EncounterReport, Fate};
use crate::trial::{Gait, TICK_SECS, ticks};
use crate::{Effort, Rig};

/// Seconds before a ball is thrown, least and most: any phase of a step.
const BEFORE_SECS: [f32; 2] = [2.0, 3.0];

/// Seconds in which a ball that hit may make it fall.
const AFTER_SECS: f32 = 3.0;

/// From here a ball is thrown, metres.
const THROW_METRES: f32 = 2.5;

/// Height at which a ball hits, metres: the chest.
const CHEST_METRES: f32 = 1.1;

/// Balls: kilograms, and metres per second.
const BALLS_KG: [f32; 4] = [2.0, 3.0, 5.0, 8.0];
const BALLS_MPS: [f32; 3] = [5.0, 8.0, 12.0];

/// Crates in the way, kilograms.
const CRATES_KG: [f32; 3] = [1.0, 5.0, 20.0];

/// Steps of a stair, metres.
const STAIRS_METRES: [f32; 3] = [0.05, 0.10, 0.15];

/// Characters that cross a square at once.
const CROWD: usize = 30;

/// Half a door's height, and the height of its middle, metres.
const DOOR_METRES: [f32; 2] = [1.0, 1.05];

/// What is met, by name. Empty for a pack without a walk.
///
/// # Errors
/// When the character can't be put into a world.
pub fn measure_encounters(rig: &Rig<'_>) -> Result<BTreeMap<String, EncounterReport>, WorldError> {
    let mut all = BTreeMap::new();
    let seeds: Vec<u64> = (0..rig.effort.encounters as u64).collect();
    let mut add = |name: String, secs: f32, seeds: &[u64], trial: &(dyn Fn(u64) -> Fates + Sync)| {
        let fates = rig.each(seeds, secs, |seed| trial(*seed)).into_iter().collect::<Result<Vec<_>, _>>()?;
        all.insert(name, EncounterReport::of(&fates.concat()));
        Ok::<(), WorldError>(())
    };
    for gait in ["walk", "jog"].iter().filter_map(|name| Gait::named(rig.pack, name)) {
        add(format!("head_on_{}", gait.name), 18.0, &seeds, &|seed| head_on(rig, &gait, seed))?;
        for kg in CRATES_KG {
            let name = format!("crate_{kg}kg_{}", gait.name);
            add(name, 9.0, &seeds, &|seed| crate_in_the_way(rig, &gait, kg, seed))?;
        }
    }
    if let Some(walk) = Gait::named(rig.pack, "walk") {
        let crowds = &seeds[..seeds.len().div_ceil(8)];
        add("crowd_of_30".into(), 600.0, crowds, &|seed| crowd(rig, &walk, seed))?;
        add("door".into(), 10.0, &seeds, &|seed| door(rig, &walk, seed))?;
        for rise in STAIRS_METRES {
            let name = format!("stairs_{}cm", (100.0 * rise).round());
            add(name, 10.0, &seeds, &|seed| stairs(rig, &walk, rise, seed))?;
        }
    }
    for gait in ["idle", "walk"].iter().filter_map(|name| Gait::named(rig.pack, name)) {
        for (kg, mps) in BALLS_KG.into_iter().flat_map(|kg| BALLS_MPS.map(|mps| (kg, mps))) {
            let name = format!("ball_{kg}kg_{mps}mps_{}", gait.name);
            add(name, 6.0, &seeds, &|seed| ball(rig, &gait, [kg, mps], seed))?;
        }
    }
    Ok(all)
}

type Fates = Result<Vec<Fate>, WorldError>;

/// About how long all take, in seconds of one character's time.
pub(in super::super) fn nominal_secs(effort: &Effort) -> f32 {
    let each = 2.0 * (18.0 + 9.0 * CRATES_KG.len() as f32) + 10.0 + 10.0 * STAIRS_METRES.len() as f32;
    let balls = 2.0 * 6.0 * (BALLS_KG.len() * BALLS_MPS.len()) as f32;
    effort.encounters as f32 * (each + balls) + 600.0 * effort.encounters.div_ceil(8) as f32
}

fn mark(x: f32, y: f32, angle: f32) -> Mark {
    Mark { at: Vec2::new(x, y), angle }
}

/// Two walk into each other, shoulder to shoulder up to face to face, and go on for two seconds.
fn head_on(rig: &Rig<'_>, gait: &Gait, seed: u64) -> Fates {
    let mut rng = Rng::new(seed, 51);
    let (apart, aside) = (rng.range(6.0, 7.0), rng.range(-0.3, 0.3));
    let marks = [mark(-0.5 * apart, 0.0, 0.0), mark(0.5 * apart, aside, PI)];
    let (mut cast, ()) = Cast::new(rig, gait, &marks, |_| Ok(()))?;
    let mut met = 0.0;
    for _ in 0..ticks(9.0) {
        cast.tick()?;
        let near = cast.players[0].position().distance(cast.players[1].position()) < 0.7;
        met += if near || met > 0.0 { TICK_SECS } else { 0.0 };
        if met > 2.0 {
            break;
        }
    }
    cast.players.iter_mut().for_each(|player| player.steer(0.0, 0.0));
    cast.run(2.0)?;
    cast.fates(|_| None)
}

/// Two groups of fifteen, three abreast and 1.6 m apart, cross each other's way at a right angle. None avoids another.
fn crowd(rig: &Rig<'_>, gait: &Gait, seed: u64) -> Fates {
    const ABREAST: usize = 3;
    const APART: f32 = 1.6;
    let mut rng = Rng::new(seed, 52);
    let marks: Vec<Mark> = (0..CROWD)
        .map(|index| {
            let (group, place) = (index % 2, index / 2);
            let mut around = |middle: f32| middle + rng.range(-0.3, 0.3);
            let aside = around(APART * ((place % ABREAST) as f32 - 1.0));
            let behind = around(-4.0 - APART * (place / ABREAST) as f32);
            let angle = FRAC_PI_2 * group as f32;
            let along = Vec2::from_angle(angle);
            Mark { at: behind * along + aside * along.perp(), angle }
        })
        .collect();
    let (mut cast, ()) = Cast::new(rig, gait, &marks, |_| Ok(()))?;
    cast.run(14.0)?;
    cast.fates(|_| None)
}

/// A ball thrown at the chest from any side.
fn ball(rig: &Rig<'_>, gait: &Gait, [kg, mps]: [f32; 2], seed: u64) -> Fates {
    let mut rng = Rng::new(seed, 53);
    // As dense as a medicine ball.
    let radius = 0.12 * (kg / 3.0_f32).cbrt();
    let prop = Prop::new(Solid::Sphere { radius }, kg);
    let aside = Motion::at(Vec3::new(0.0, 200.0, radius));
    let (mut cast, ball) = Cast::new(rig, gait, &[mark(0.0, 0.0, 0.0)], |edit| edit.add_prop(prop, aside))?;
    cast.run(rng.range(BEFORE_SECS[0], BEFORE_SECS[1]))?;
    // A prop that diverged may have been taken out.
    if cast.players[0].has_fallen() || cast.world.prop(ball).is_err() {
        return Ok(Vec::new());
    }
    throw(&mut cast, ball, mps, rng.angle())?;
    cast.run(AFTER_SECS)?;
    cast.fates(|_| None)
}

/// Throws at where the first character will be.
fn throw(cast: &mut Cast, ball: PropHandle, mps: f32, angle: f32) -> Result<(), WorldError> {
    let root = cast.players[0].state.root();
    let secs = THROW_METRES / mps;
    let chest = (root.position.truncate() + secs * root.linear_velocity.truncate()).extend(CHEST_METRES);
    let from = chest - THROW_METRES * Vec2::from_angle(angle).extend(0.0);
    let velocity = (chest - from) / secs + Vec3::Z * (0.5 * 9.81 * secs);
    cast.world.place_prop(ball, Motion::at(from).moving(velocity))
}

/// A crate lies on the way; it goes on for eight seconds.
fn crate_in_the_way(rig: &Rig<'_>, gait: &Gait, kg: f32, seed: u64) -> Fates {
    let mut rng = Rng::new(seed, 54);
    let half = 0.225;
    let prop = Prop::new(Solid::Cuboid { half_extents: Vec3::splat(half) }, kg);
    let place = Motion::at(Vec3::new(rng.range(4.0, 5.0), rng.range(-0.25, 0.25), half));
    let motion = Motion { rotation: Quat::from_rotation_z(rng.angle()), ..place };
    let (mut cast, _) = Cast::new(rig, gait, &[mark(0.0, 0.0, 0.0)], |edit| edit.add_prop(prop, motion))?;
    cast.run(8.0)?;
    cast.fates(|_| None)
}

/// A door of 3 kg on a hinge, to be pushed open.
fn door(rig: &Rig<'_>, gait: &Gait, seed: u64) -> Fates {
    let mut rng = Rng::new(seed, 55);
    let x = rng.range(3.5, 4.5);
    let [half_height, middle] = DOOR_METRES;
    let wall = |edit: &mut WorldEdit<'_>, side: f32| {
        let solid = Solid::Cuboid { half_extents: Vec3::new(0.075, 1.2, 1.1) };
        edit.add_fixture(Fixture::new(solid, Vec3::new(x, side * 2.0, 1.1)))
    };
    let (mut cast, ()) = Cast::new(rig, gait, &[mark(0.0, rng.range(-0.2, 0.2), 0.0)], |edit| {
        wall(edit, 1.0)?;
        wall(edit, -1.0)?;
        let leaf = Solid::Cuboid { half_extents: Vec3::new(0.03, 0.75, half_height) };
        let at = Motion::at(Vec3::new(x, 0.0, middle));
        let door = edit.add_prop(Prop::new(leaf, 3.0), at)?;
        let anchor = Vec3::new(x, 0.75, middle);
        edit.join(
            door,
            None,
            Joint::Hinge { anchor, axis: Vec3::Z, range: Some([-2.2, 2.2]), damping: 0.5 },
        )?;
        Ok(())
    })?;
    for _ in 0..ticks(10.0) {
        let player = &mut cast.players[0];
        // To the middle of the opening, then straight on.
        let at = player.position();
        let to = Vec2::new(if at.x < x { x + 0.5 } else { at.x + 2.0 }, 0.0);
        player.steer((to - at).to_angle(), 1.0);
        cast.tick()?;
    }
    cast.fates(|player| Some(player.position().x > x + 0.7))
}

/// Four steps up to a landing.
fn stairs(rig: &Rig<'_>, gait: &Gait, rise: f32, seed: u64) -> Fates {
    const STEPS: u32 = 4;
    const RUN: f32 = 0.6;
    let mut rng = Rng::new(seed, 56);
    let foot = rng.range(2.5, 3.5);
    let landing = foot + STEPS as f32 * RUN;
    let (mut cast, ()) = Cast::new(rig, gait, &[mark(0.0, 0.0, 0.0)], |edit| {
        for step in 0..=STEPS {
            let length = if step == STEPS { 8.0 } else { RUN };
            let half = Vec3::new(0.5 * length, 1.5, 0.5 * rise * (step.min(STEPS - 1) + 1) as f32);
            let middle = Vec3::new(foot + step as f32 * RUN + 0.5 * length, 0.0, half.z);
            edit.add_fixture(Fixture::new(Solid::Cuboid { half_extents: half }, middle))?;
        }
        Ok(())
    })?;
    for _ in 0..ticks(10.0) {
        let player = &mut cast.players[0];
        let at = player.position();
        player.steer((Vec2::new(at.x + 2.0, 0.0) - at).to_angle(), 1.0);
        if at.x > landing + 1.0 {
            break;
        }
        cast.tick()?;
    }
    cast.fates(|player| Some(!player.has_fallen() && player.position().x > landing))
}
