//! Divergences that can only be provoked from inside: each is caught in its tick, told once and left behind, and the
//! rest of the world moves as if it had not been.

use glam::Vec3;
use policy_core::Heading;
use policy_core::contract::Pose;

use super::{CharacterHandle, Diverging, PropHandle, Remedy, World};
use crate::cause::Cause;
use crate::{Joint, Model, Motion, Prop};

const HUMANOID: &str = include_str!("../../../../assets/humanoid.xml");

struct Fair {
    world: World,
    near: CharacterHandle,
    far: CharacterHandle,
    ball: PropHandle,
    crate_: PropHandle,
    door: PropHandle,
}

/// A character beside a ball, and far from them another, a crate and a door.
fn fair() -> Fair {
    let model = Model::from_mjcf(HUMANOID).unwrap();
    let mut world = World::new(&model).unwrap();
    let (near, far, ball, crate_, door) = world
        .edit(|edit| {
            let near = edit.add_character(&model, 0.0, 0.0, Heading::FORWARD, 0.0)?;
            let far = edit.add_character(&model, 20.0, 0.0, Heading::FORWARD, 0.5)?;
            let ball = edit.add_prop(Prop::ball(0.1, 1.0), Motion::at(Vec3::new(0.4, 0.0, 1.5)))?;
            let crate_ = edit.add_prop(Prop::cube(0.3, 3.0), Motion::at(Vec3::new(20.0, 4.0, 0.5)))?;
            let door = edit.add_prop(Prop::cube(0.5, 5.0), Motion::at(Vec3::new(-20.0, 0.0, 1.0)))?;
            let anchor = Vec3::new(-20.25, 0.0, 1.0);
            edit.join(door, None, Joint::Hinge { anchor, axis: Vec3::Z, range: None, damping: 0.1 })?;
            Ok((near, far, ball, crate_, door))
        })
        .unwrap();
    let mut fair = Fair { world, near, far, ball, crate_, door };
    for _ in 0..5 {
        assert_eq!(fair.world.step(), 0);
    }
    fair
}

impl Fair {
    /// The bits of what is far from the ball.
    fn others(&self) -> Vec<u64> {
        let mut pose = Pose::new(self.world.model(self.far).unwrap().skeleton());
        self.world.pose_into(self.far, &mut pose).unwrap();
        let at = |prop| self.world.motion(prop).unwrap().position.to_array().map(f64::from);
        let props = [self.crate_].into_iter().flat_map(at);
        pose.qpos.iter().chain(&pose.qvel).copied().chain(props).map(f64::to_bits).collect()
    }

    fn qpos(&mut self, prop: PropHandle) -> &mut [f64] {
        let span = self.world.places.prop(prop.index()).span.qpos.clone();
        &mut self.world.data.qpos_mut()[span]
    }

    fn qvel(&mut self, prop: PropHandle) -> &mut [f64] {
        let span = self.world.places.prop(prop.index()).span.dofs.clone();
        &mut self.world.data.qvel_mut()[span]
    }

    /// One tick in which just `what` diverges, and some in which nothing does.
    fn diverges(&mut self, what: Diverging, causes: &[Cause], remedy: Remedy) {
        let mut alike = fair();
        let told = self.world.step();
        assert_eq!(told, 1, "{:?}", self.world.divergences());
        let found = self.world.divergences()[0];
        assert_eq!((found.what, found.remedy), (Some(what), remedy));
        assert!(causes.contains(&found.cause), "{found:?}");
        assert_eq!(self.world.tick(), 6, "no tick is lost");
        alike.world.step();
        assert_eq!(self.others(), alike.others(), "the others are on their way, bit for bit");
        for _ in 0..30 {
            assert_eq!(self.world.step(), 0, "{:?}", self.world.divergences());
            assert_eq!(alike.world.step(), 0);
        }
        assert_eq!(self.others(), alike.others());
        assert!(self.world.data.qpos().iter().all(|number| number.is_finite()));
    }

    fn root_height(&self, character: CharacterHandle) -> f64 {
        let mut pose = Pose::new(self.world.model(character).unwrap().skeleton());
        self.world.pose_into(character, &mut pose).unwrap();
        pose.qpos[2]
    }
}

#[test]
fn a_prop_that_is_no_number_is_taken_out() {
    let mut fair = fair();
    let ball = fair.ball;
    fair.qpos(ball)[1] = f64::NAN;
    fair.diverges(Diverging::Prop(ball), &[Cause::BadPosition], Remedy::TakenOut);
    assert!(fair.world.motion(ball).is_err(), "its handle is stale");
    assert!(fair.root_height(fair.near) > 0.5);
    for value in [f64::INFINITY, 1e12, f64::NAN] {
        let mut fair = self::fair();
        fair.qvel(ball)[0] = value;
        let causes = [Cause::BadPosition, Cause::BadVelocity, Cause::BadAcceleration];
        fair.diverges(Diverging::Prop(ball), &causes, Remedy::TakenOut);
    }
}

#[test]
fn a_prop_too_fast_inside_a_body_is_taken_out_before_it_hits() {
    let mut fair = fair();
    let ball = fair.ball;
    fair.qpos(ball)[..3].copy_from_slice(&[0.0, 0.0, 0.9]);
    fair.qvel(ball)[..3].copy_from_slice(&[1e6, 0.0, 0.0]);
    fair.diverges(Diverging::Prop(ball), &[Cause::TooFast, Cause::TooFarAway], Remedy::TakenOut);
    assert!(fair.root_height(fair.near) > 0.5, "{}", fair.root_height(fair.near));
}

#[test]
fn a_prop_below_the_ground_or_far_away_is_taken_out() {
    for (place, cause) in [([0.0, 0.0, -3.0], Cause::BelowGround), ([3e4, 0.0, 1.0], Cause::TooFarAway)] {
        let mut fair = fair();
        let ball = fair.ball;
        fair.qpos(ball)[..3].copy_from_slice(&place);
        fair.diverges(Diverging::Prop(ball), &[cause, Cause::TooFast], Remedy::TakenOut);
    }
}

#[test]
fn a_prop_on_a_joint_goes_back_to_where_it_was_joined() {
    let mut fair = fair();
    let door = fair.door;
    fair.qvel(door)[0] = 1e4;
    fair.diverges(Diverging::Prop(door), &[Cause::SpinsTooFast], Remedy::PutBack);
    let at = fair.world.motion(door).unwrap().position;
    assert!(at.distance(Vec3::new(-20.0, 0.0, 1.0)) < 0.01, "{at}");
}

#[test]
fn a_character_stands_up_where_it_was() {
    for value in [f64::NAN, 1e5, 1e12] {
        let mut fair = fair();
        let near = fair.near;
        let dofs = fair.world.places.character(near.index()).span.dofs.clone();
        fair.world.data.qvel_mut()[dofs.start + 10] = value;
        let causes = [
            Cause::BadPosition,
            Cause::BadVelocity,
            Cause::BadAcceleration,
            Cause::SpinsTooFast,
            Cause::TooFast,
        ];
        fair.diverges(Diverging::Character(near), &causes, Remedy::PutBack);
        assert!(fair.root_height(near) > 0.5);
    }
}

#[test]
fn several_at_once_are_each_told_once() {
    let mut fair = fair();
    let (ball, crate_, near) = (fair.ball, fair.crate_, fair.near);
    fair.qpos(ball)[0] = f64::NAN;
    fair.qvel(crate_)[2] = 1e7;
    let qpos = fair.world.places.character(near.index()).span.qpos.clone();
    fair.world.data.qpos_mut()[qpos.start + 9] = f64::NAN;
    assert_eq!(fair.world.step(), 3, "{:?}", fair.world.divergences());
    let mut told: Vec<_> = fair.world.divergences().iter().filter_map(|d| d.what).collect();
    told.dedup();
    for what in [Diverging::Prop(ball), Diverging::Prop(crate_), Diverging::Character(near)] {
        assert_eq!(told.iter().filter(|told| **told == what).count(), 1, "{what:?}");
    }
    for _ in 0..10 {
        assert_eq!(fair.world.step(), 0, "{:?}", fair.world.divergences());
    }
}
