//! Hinges, slides, ball joints and ropes in a shared world.

mod common;

use common::shared_world::{run, world};
use glam::{Quat, Vec3};
use physics_bridge::{Joint, Motion, Prop, Solid, WorldError};

#[test]
fn a_door_swings_on_its_hinge() {
    let (mut world, _) = world();
    let half_extents = Vec3::new(0.5, 0.03, 1.0);
    let door = world
        .edit(|edit| {
            let door = edit.add_prop(
                Prop::new(Solid::Cuboid { half_extents }, 10.0),
                Motion::at(Vec3::new(0.5, 0.0, 1.1)),
            )?;
            let range = Some([-2.0, 1.0]);
            edit.join(door, None, Joint::Hinge { anchor: Vec3::ZERO, axis: Vec3::Z, range, damping: 0.5 })?;
            Ok(door)
        })
        .unwrap();
    world.push(door, Vec3::Y * 60.0, 0.3).unwrap();
    let mut widest = 0f32;
    for _ in 0..90 {
        assert_eq!(world.step(), 0);
        let motion = world.motion(door).unwrap();
        let angle = motion.position.y.atan2(motion.position.x);
        assert!((motion.position.truncate().length() - 0.5).abs() < 0.01, "it stays on its hinge");
        assert!((motion.position.z - 1.1).abs() < 0.01);
        widest = widest.max(angle);
    }
    assert!((0.5..1.2).contains(&widest), "it swung to its stop: {widest}");
}

#[test]
fn slides_slide_and_balls_swing() {
    let (mut world, _) = world();
    let (slide, bob) = world
        .edit(|edit| {
            let slide = edit.add_prop(Prop::cube(0.3, 3.0), Motion::at(Vec3::Z * 1.0))?;
            let (axis, range) = (Vec3::X, Some([-0.5, 0.5]));
            edit.join(slide, None, Joint::Slide { axis, range, damping: 0.0 })?;
            let bob = edit.add_prop(Prop::ball(0.1, 2.0), Motion::at(Vec3::new(5.0, 1.0, 2.0)))?;
            edit.join(bob, None, Joint::Ball { anchor: Vec3::new(5.0, 0.0, 2.0), damping: 0.0 })?;
            Ok((slide, bob))
        })
        .unwrap();
    world.impulse(slide, Vec3::new(9.0, 9.0, 9.0)).unwrap();
    let (mut lowest, mut farthest) = (f32::MAX, 0f32);
    for _ in 0..45 {
        assert_eq!(world.step(), 0);
        lowest = lowest.min(world.motion(bob).unwrap().position.z);
        let at = world.motion(slide).unwrap().position;
        assert!(at.y.abs() < 0.01 && (at.z - 1.0).abs() < 0.01, "{at}");
        farthest = farthest.max(at.x);
    }
    assert!((0.4..0.6).contains(&farthest), "{farthest}");
    assert!(lowest < 1.15, "the bob swung below its anchor: {lowest}");
    let arm = world.motion(bob).unwrap().position.distance(Vec3::new(5.0, 0.0, 2.0));
    assert!((arm - 1.0).abs() < 0.02, "{arm}");
}

#[test]
fn a_rope_holds_its_length() {
    let (mut world, _) = world();
    let from = Vec3::new(0.0, 0.0, 3.0);
    let (first, second) = world
        .edit(|edit| {
            let first = edit.add_prop(Prop::ball(0.1, 1.0), Motion::at(from + Vec3::X))?;
            let second = edit.add_prop(Prop::ball(0.1, 1.0), Motion::at(from + Vec3::X * 1.5))?;
            edit.join(first, None, Joint::Rope { ends: [from + Vec3::X, from], length: 1.0 })?;
            let ends = [from + Vec3::X, from + Vec3::X * 1.5];
            edit.join(first, Some(second), Joint::Rope { ends, length: 0.5 })?;
            Ok((first, second))
        })
        .unwrap();
    let mut swung = false;
    for _ in 0..120 {
        assert_eq!(world.step(), 0);
        let [a, b] = [first, second].map(|ball| world.motion(ball).unwrap().position);
        assert!(a.distance(from) < 1.06, "{}", a.distance(from));
        assert!(a.distance(b) < 0.56, "{}", a.distance(b));
        swung |= a.z < 2.1;
    }
    assert!(swung);
}

#[test]
fn a_prop_that_loses_what_it_hangs_on_goes_on_as_it_moved() {
    let (mut world, _) = world();
    let (arm, tip, joint) = world
        .edit(|edit| {
            let arm = edit.add_prop(Prop::cube(0.2, 2.0), Motion::at(Vec3::new(0.5, 0.0, 3.0)))?;
            edit.join(arm, None, Joint::Ball { anchor: Vec3::Z * 3.0, damping: 0.0 })?;
            let tip = edit.add_prop(Prop::cube(0.2, 2.0), Motion::at(Vec3::new(1.0, 0.0, 3.0)))?;
            let anchor = Vec3::new(0.75, 0.0, 3.0);
            let joint =
                edit.join(tip, Some(arm), Joint::Hinge { anchor, axis: Vec3::Y, range: None, damping: 0.0 })?;
            Ok((arm, tip, joint))
        })
        .unwrap();
    run(&mut world, 10);
    let before = world.motion(tip).unwrap();
    assert!(before.velocity.length() > 0.5, "it swings: {before:?}");
    world.edit(|edit| edit.remove_prop(arm)).unwrap();
    let after = world.motion(tip).unwrap();
    assert!(after.position.distance(before.position) < 1e-5, "{after:?} {before:?}");
    assert!(after.velocity.distance(before.velocity) < 1e-4, "{after:?} {before:?}");
    assert!(after.spin.distance(before.spin) < 1e-4, "{after:?} {before:?}");
    let gone = world.edit(|edit| edit.remove_joint(joint)).unwrap_err();
    assert!(matches!(gone, WorldError::Stale { what: "a joint" }), "{gone}");
    run(&mut world, 30);
    assert!(world.motion(tip).unwrap().position.z < before.position.z - 1.0, "it falls");
}

#[test]
fn joints_that_close_a_loop_are_refused() {
    let (mut world, _) = world();
    let cube = |edit: &mut physics_bridge::WorldEdit<'_>, x: f32| {
        edit.add_prop(Prop::cube(0.2, 1.0), Motion::at(Vec3::new(x, 0.0, 2.0)))
    };
    let ball = |x: f32| Joint::Ball { anchor: Vec3::new(x, 0.0, 2.0), damping: 0.0 };
    let (a, b) = world.edit(|edit| Ok((cube(edit, 0.0)?, cube(edit, 1.0)?))).unwrap();
    for (one, other) in [(a, Some(a)), (b, Some(a))] {
        let closes = world.edit(|edit| {
            edit.join(a, Some(b), ball(0.5))?;
            edit.join(b, None, ball(1.5))?;
            edit.join(one, other, ball(0.7))
        });
        assert!(matches!(closes, Err(WorldError::Loop)), "{closes:?}");
    }
    // The second prop takes the first one's joint when the first hangs already.
    world
        .edit(|edit| {
            edit.join(a, None, ball(-0.5))?;
            edit.join(a, Some(b), ball(0.5))
        })
        .unwrap();
    run(&mut world, 30);
    let [a, b] = [a, b].map(|prop| world.motion(prop).unwrap().position);
    assert!((a.distance(b) - 1.0).abs() < 0.05 || a.distance(b) < 1.0, "{a} {b}");
    assert!(a.distance(Vec3::new(-0.5, 0.0, 2.0)) < 0.52);
}

/// Where something is that moves and is turned.
fn moving(position: Vec3, rotation: Quat, velocity: Vec3, spin: Vec3) -> Motion {
    Motion { position, rotation, velocity, spin }
}

#[test]
fn a_turned_prop_keeps_the_part_of_its_motion_that_its_joint_leaves() {
    let at = Vec3::new(0.0, 0.0, 3.0);
    let turned = Quat::from_rotation_x(0.9) * Quat::from_rotation_z(0.7);
    let spin = Vec3::new(0.5, -1.0, 2.0);
    let motion = moving(at, turned, Vec3::new(1.0, 0.2, 0.3), spin);
    let axis = Vec3::new(0.0, 0.6, 0.8);
    let joints = [
        (Joint::Hinge { anchor: at, axis, range: None, damping: 0.0 }, axis * axis.dot(spin), Vec3::ZERO),
        (Joint::Ball { anchor: at, damping: 0.0 }, spin, Vec3::ZERO),
        (Joint::Slide { axis, range: None, damping: 0.0 }, Vec3::ZERO, axis * axis.dot(motion.velocity)),
    ];
    for (joint, spin, velocity) in joints {
        // At once, and a free prop that is hung up later.
        for at_once in [true, false] {
            let (mut world, _) = world();
            let add = |edit: &mut physics_bridge::WorldEdit<'_>| edit.add_prop(Prop::cube(0.3, 3.0), motion);
            let prop = if at_once {
                let both = |edit: &mut physics_bridge::WorldEdit<'_>| {
                    let prop = add(edit)?;
                    edit.join(prop, None, joint).map(|_| prop)
                };
                world.edit(both).unwrap()
            } else {
                let prop = world.edit(add).unwrap();
                world.edit(|edit| edit.join(prop, None, joint)).unwrap();
                prop
            };
            let found = world.motion(prop).unwrap();
            assert!(found.spin.distance(spin) < 1e-4, "{joint:?} {at_once}: {found:?}");
            assert!(found.velocity.distance(velocity) < 1e-4, "{joint:?} {at_once}: {found:?}");
        }
    }
}

#[test]
fn a_prop_that_is_hung_on_a_moving_one_keeps_its_own_motion() {
    let (mut world, _) = world();
    let turned = Quat::from_rotation_z(0.8);
    let (drift, spin) = (Vec3::new(1.0, 2.0, 0.0), Vec3::Z * 3.0);
    let arm = moving(Vec3::Z * 3.0, turned, drift, spin);
    let out = turned * Vec3::X;
    // It turns with the arm, and slides outwards besides.
    let tip = moving(Vec3::Z * 3.0 + out, turned, drift + spin.cross(out) + out * 0.5, spin);
    let (arm, tip) = world
        .edit(|edit| {
            let arm = edit.add_prop(Prop::cube(0.2, 2.0), arm)?;
            let tip = edit.add_prop(Prop::cube(0.2, 2.0), tip)?;
            edit.join(tip, Some(arm), Joint::Slide { axis: out, range: None, damping: 0.0 })?;
            Ok((arm, tip))
        })
        .unwrap();
    let [arm, tip] = [arm, tip].map(|prop| world.motion(prop).unwrap());
    assert!(arm.velocity.distance(drift) < 1e-4 && arm.spin.distance(spin) < 1e-4, "{arm:?}");
    let expected = drift + spin.cross(out) + out * 0.5;
    assert!(tip.velocity.distance(expected) < 1e-3 && tip.spin.distance(spin) < 1e-4, "{tip:?}");
}
