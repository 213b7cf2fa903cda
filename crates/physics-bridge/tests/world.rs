//! A shared world: what touches what, what is kept, what is refused.

mod common;

use common::{humanoid, wriggle_into};
use glam::{Quat, Vec2, Vec3};
use physics_bridge::{
    CharacterHandle, Fixture, FixtureShape, Joint, Model, Motion, Movable, Part, Pose, Prop, PropHandle,
    Solid, World, WorldError,
};
use policy_core::{BodyId, CharacterState, Heading, JointTargets};

fn world() -> (World, Model) {
    let model = humanoid();
    (World::new(&model).unwrap(), model)
}

fn add(world: &mut World, model: &Model, x: f32, y: f32, degrees: f32, speed: f32) -> CharacterHandle {
    let heading = Heading::from_angle(degrees.to_radians());
    world.edit(|edit| edit.add_character(model, x, y, heading, speed)).unwrap()
}

fn put(world: &mut World, prop: Prop, motion: Motion) -> PropHandle {
    world.edit(|edit| edit.add_prop(prop, motion)).unwrap()
}

fn run(world: &mut World, ticks: u32) {
    for _ in 0..ticks {
        assert_eq!(world.step(), 0, "{:?}", world.divergences());
    }
}

/// Moves all characters, each in its own way.
fn wriggle(world: &mut World, ticks: u32) {
    let characters: Vec<_> = world.characters().collect();
    for _ in 0..ticks {
        for &character in &characters {
            let mut targets = JointTargets::new(world.model(character).unwrap().skeleton());
            wriggle_into(world.tick() + 17 * character.index() as u64, &mut targets);
            world.actuate(character, &targets).unwrap();
        }
        assert_eq!(world.step(), 0, "{:?}", world.divergences());
    }
}

fn pose(world: &World, character: CharacterHandle) -> Pose {
    let mut pose = Pose::new(world.model(character).unwrap().skeleton());
    world.pose_into(character, &mut pose).unwrap();
    pose
}

/// The bits of everything that a character and a prop are in.
fn bits(world: &World, character: CharacterHandle) -> Vec<u64> {
    let pose = pose(world, character);
    pose.qpos.iter().chain(&pose.qvel).map(|number| number.to_bits()).collect()
}

#[test]
fn a_character_stands_as_it_does_alone() {
    let (mut world, model) = world();
    let character = add(&mut world, &model, 3.0, -2.0, 90.0, 0.0);
    let mut alone = physics_bridge::Character::new(&model);
    alone.stand_at(3.0, -2.0, Heading::from_angle(90f32.to_radians()), 0.0).unwrap();
    let mut state = CharacterState::new(model.skeleton());
    let mut expected = state.clone();
    for tick in 0..30 {
        world.sense_into(character, &mut state).unwrap();
        alone.sense_into(&mut expected);
        for (found, expected) in state.bodies.iter().zip(&expected.bodies) {
            assert!(found.position.distance(expected.position) < 2e-3, "{tick}: {found:?} {expected:?}");
        }
        let mut targets = JointTargets::new(model.skeleton());
        wriggle_into(tick, &mut targets);
        world.actuate(character, &targets).unwrap();
        alone.actuate(&targets);
        assert_eq!(world.step(), 0);
        alone.step().unwrap();
    }
}

#[test]
fn characters_touch_each_other_and_not_themselves() {
    let (mut world, model) = world();
    let a = add(&mut world, &model, 0.0, 0.0, 0.0, 3.0);
    let b = add(&mut world, &model, 1.2, 0.0, 180.0, 3.0);
    let mut met = false;
    for _ in 0..45 {
        assert_eq!(world.step(), 0);
        for contact in world.contacts() {
            match contact.parts {
                [Part::Body(one, _), Part::Body(other, _)] => {
                    assert_ne!(one, other, "none touches itself");
                    met = true;
                }
                [Part::Ground, Part::Body(..)] | [Part::Body(..), Part::Ground] => {}
                parts => panic!("{parts:?}"),
            }
        }
    }
    assert!(met);
    let (a, b) = (pose(&world, a), pose(&world, b));
    assert!(a.qpos[0] < b.qpos[0] + 0.3, "they did not walk through each other: {} {}", a.qpos[0], b.qpos[0]);
}

#[test]
fn a_heap_of_characters_touches_and_stays_well() {
    let (mut world, model) = world();
    world
        .edit(|edit| {
            for index in 0..9 {
                let (x, y) = (0.35 * (index / 3) as f32, 0.35 * (index % 3) as f32);
                edit.add_character(&model, x, y, Heading::FORWARD, 0.0)?;
            }
            Ok(())
        })
        .unwrap();
    wriggle(&mut world, 60);
    let between = |parts: &[Part; 2]| matches!(parts, [Part::Body(a, _), Part::Body(b, _)] if a != b);
    assert!(world.contacts().iter().any(|contact| between(&contact.parts)));
}

#[test]
fn a_crate_is_pushed_by_a_character_and_by_a_force() {
    let (mut world, model) = world();
    add(&mut world, &model, 0.0, 0.0, 0.0, 4.0);
    let at = Vec3::new(0.7, 0.0, 0.4);
    let crate_ =
        put(&mut world, Prop::new(Solid::Cuboid { half_extents: Vec3::splat(0.4) }, 4.0), Motion::at(at));
    run(&mut world, 30);
    assert!(world.motion(crate_).unwrap().position.x > 0.75, "{:?}", world.motion(crate_));

    let (mut world, _) = self::world();
    let crate_ = put(&mut world, Prop::cube(0.4, 5.0), Motion::at(Vec3::Z * 0.2));
    world.push(crate_, Vec3::X * 200.0, 0.2).unwrap();
    run(&mut world, 30);
    let moved = world.motion(crate_).unwrap().position;
    assert!(moved.x > 0.3 && moved.z < 0.5, "{moved}");
    world.impulse(crate_, Vec3::Y * 20.0).unwrap();
    run(&mut world, 5);
    assert!(world.motion(crate_).unwrap().position.y > 0.1);
}

#[test]
fn every_solid_comes_to_rest_on_the_ground() {
    let points: Vec<Vec3> = (0..8)
        .map(|i| 0.2 * Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - Vec3::splat(0.1))
        .collect();
    let solids = [
        Solid::Sphere { radius: 0.1 },
        Solid::Capsule { radius: 0.1, half_length: 0.2 },
        Solid::Cylinder { radius: 0.2, half_length: 0.1 },
        Solid::Cuboid { half_extents: Vec3::splat(0.1) },
        Solid::Hull { points: points.into() },
    ];
    let (mut world, _) = world();
    let props: Vec<_> = world
        .edit(|edit| {
            let place = |(index, solid): (usize, Solid)| {
                let at = Vec3::new(index as f32, 0.0, 0.6);
                let lying = Motion { rotation: Quat::from_rotation_x(1.2), ..Motion::at(at) };
                edit.add_prop(Prop::new(solid, 2.0), lying)
            };
            solids.into_iter().enumerate().map(place).collect()
        })
        .unwrap();
    run(&mut world, 240);
    for prop in props {
        let motion = world.motion(prop).unwrap();
        assert!((0.08..0.24).contains(&motion.position.z), "{motion:?}");
        assert!(motion.velocity.length() < 0.2, "{motion:?}");
    }
}

#[test]
fn a_ball_bounces_and_a_beanbag_does_not() {
    let highest_after = |bounce: f32| {
        let (mut world, _) = world();
        let ball = Prop { bounce, ..Prop::ball(0.12, 0.6) };
        let ball = put(&mut world, ball, Motion::at(Vec3::Z * 2.0).moving(Vec3::X));
        let mut has_fallen = false;
        let mut highest = 0f32;
        for _ in 0..60 {
            assert_eq!(world.step(), 0);
            let motion = world.motion(ball).unwrap();
            has_fallen |= motion.position.z < 0.2;
            if has_fallen {
                highest = highest.max(motion.position.z);
            }
        }
        highest
    };
    let (dead, half, lively) = (highest_after(0.0), highest_after(0.5), highest_after(0.8));
    assert!(dead < 0.3, "{dead}");
    assert!((0.4..1.0).contains(&half), "{half}");
    assert!(lively > half + 0.2, "{lively} {half}");
}

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
fn edits_keep_the_state_of_everything_else() {
    let (mut world, model) = world();
    let (a, b) = (add(&mut world, &model, 0.0, 0.0, 0.0, 0.0), add(&mut world, &model, 3.0, 0.0, 45.0, 1.0));
    let ball = put(&mut world, Prop::ball(0.1, 1.0), Motion::at(Vec3::new(0.0, 3.0, 1.0)).moving(Vec3::X));
    wriggle(&mut world, 7);
    let before = (bits(&world, a), bits(&world, b), world.motion(ball).unwrap());
    let (c, crate_) = world
        .edit(|edit| {
            let c = edit.add_character(&model, 10.0, 0.0, Heading::FORWARD, 0.0)?;
            let crate_ = edit.add_prop(Prop::cube(0.3, 2.0), Motion::at(Vec3::new(9.0, 9.0, 1.0)))?;
            edit.add_fixture(Fixture::new(Solid::Sphere { radius: 1.0 }, Vec3::new(-9.0, 0.0, 0.0)))?;
            Ok((c, crate_))
        })
        .unwrap();
    assert_eq!(before, (bits(&world, a), bits(&world, b), world.motion(ball).unwrap()));
    wriggle(&mut world, 5);
    let before = (bits(&world, a), bits(&world, c), world.motion(ball).unwrap());
    world
        .edit(|edit| {
            edit.remove_character(b)?;
            edit.remove_prop(crate_)
        })
        .unwrap();
    assert_eq!(before, (bits(&world, a), bits(&world, c), world.motion(ball).unwrap()));
    assert!(matches!(world.motion(crate_), Err(WorldError::Stale { what: "a prop" })));
    wriggle(&mut world, 5);
}

#[test]
fn what_is_far_moves_alike_whether_or_not_something_is_added() {
    let run = |adds: bool| {
        let (mut world, model) = world();
        let a = add(&mut world, &model, 0.0, 0.0, 0.0, 0.0);
        put(&mut world, Prop::cube(0.3, 2.0), Motion::at(Vec3::new(-5.0, 0.0, 1.0)));
        wriggle(&mut world, 5);
        if adds {
            put(&mut world, Prop::ball(0.1, 1.0), Motion::at(Vec3::new(50.0, 0.0, 1.0)));
        }
        wriggle(&mut world, 5);
        pose(&world, a)
    };
    let (alone, beside) = (run(false), run(true));
    for (a, b) in alone.qpos.iter().zip(&beside.qpos) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn reserved_and_removed_props_come_back_without_a_build() {
    let (mut world, model) = world();
    let a = add(&mut world, &model, 0.0, 0.0, 0.0, 0.0);
    let ball = Prop::ball(0.1, 1.0);
    world.edit(|edit| edit.reserve_props(&ball, 3)).unwrap();
    assert_eq!(world.props().count(), 0);
    wriggle(&mut world, 3);
    assert!(world.contacts().iter().all(|c| !c.parts.iter().any(|part| matches!(part, Part::Prop(_)))));
    let saved = world.save();
    let thrown: Vec<_> =
        (0..3).map(|i| put(&mut world, ball.clone(), Motion::at(Vec3::new(3.0, i as f32, 2.0)))).collect();
    world.restore(&saved).unwrap(); // the layout is the same: nothing was built
    assert!(world.motion(thrown[0]).is_err(), "what came later is gone");
    let again = put(&mut world, ball.clone(), Motion::at(Vec3::new(3.0, 0.0, 2.0)));
    assert!(!thrown.contains(&again), "no handle comes twice");
    wriggle(&mut world, 20);
    assert!(world.motion(again).unwrap().position.z < 1.0, "it fell");
    world.edit(|edit| edit.remove_prop(again)).unwrap();
    assert!(world.motion(again).is_err());
    assert!(world.restore(&saved).is_ok());
    assert_eq!(world.save().hash(), saved.hash());
    let _ = a;
}

#[test]
fn a_failed_edit_changes_nothing() {
    let (mut world, model) = world();
    let a = add(&mut world, &model, 0.0, 0.0, 0.0, 0.0);
    wriggle(&mut world, 3);
    let before = world.save();
    let mut leaked = None;
    let error = world
        .edit(|edit| {
            edit.remove_character(a)?;
            leaked = Some(edit.add_prop(Prop::cube(0.3, 1.0), Motion::at(Vec3::Z))?);
            edit.add_prop(Prop::cube(0.3, -1.0), Motion::at(Vec3::Z))
        })
        .unwrap_err();
    assert_eq!(error.to_string(), "expected mass_kg of a prop between 0.01 and 10000, found -1");
    assert_eq!(world.save(), before);
    assert!(world.model(a).is_ok());
    put(&mut world, Prop::cube(0.3, 1.0), Motion::at(Vec3::Z));
    assert!(world.motion(leaked.unwrap()).is_err(), "a handle of a failed edit names nothing");
}

#[test]
fn bad_numbers_are_refused_by_name() {
    let (mut world, model) = world();
    let nan = f32::NAN;
    let cube = || Prop::cube(0.3, 1.0);
    let flat: Vec<Vec3> = (0..6).map(|i| Vec3::new(i as f32, (i * i) as f32, 0.0)).collect();
    let solid = |solid| Prop::new(solid, 1.0);
    for (prop, motion, field) in [
        (Prop { friction: nan, ..cube() }, Motion::at(Vec3::Z), "friction"),
        (Prop { bounce: 1.0, ..cube() }, Motion::at(Vec3::Z), "bounce"),
        (Prop { mass_kg: 1e9, ..cube() }, Motion::at(Vec3::Z), "mass_kg"),
        (solid(Solid::Sphere { radius: 0.0 }), Motion::at(Vec3::Z), "radius"),
        (solid(Solid::Capsule { radius: 0.1, half_length: nan }), Motion::at(Vec3::Z), "half_length"),
        (
            solid(Solid::Cuboid { half_extents: Vec3::new(1.0, 1.0, -1.0) }),
            Motion::at(Vec3::Z),
            "half_extents.z",
        ),
        (solid(Solid::Hull { points: flat.into() }), Motion::at(Vec3::Z), "hull"),
        (solid(Solid::Hull { points: Vec::new().into() }), Motion::at(Vec3::Z), "hull"),
        (cube(), Motion::at(Vec3::Z * 1e6), "position"),
        (cube(), Motion::at(Vec3::Z).moving(Vec3::X * 1e6), "velocity"),
        (cube(), Motion { spin: Vec3::splat(nan), ..Motion::at(Vec3::Z) }, "spin"),
        (cube(), Motion { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..Motion::at(Vec3::Z) }, "rotation"),
    ] {
        let error = world.edit(|edit| edit.add_prop(prop, motion)).unwrap_err().to_string();
        assert!(
            error.contains(field) && error.contains("expected") && error.contains("found"),
            "{field}: {error}"
        );
    }
    let triangles = |triangles: Vec<[u32; 3]>| Fixture {
        shape: FixtureShape::Triangles {
            points: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X * 2.0].into(),
            triangles: triangles.into(),
        },
        ..Fixture::new(Solid::Sphere { radius: 1.0 }, Vec3::ZERO)
    };
    let heights = |count: usize| Fixture {
        shape: FixtureShape::Heights {
            rows: 2,
            columns: 3,
            half_extents: Vec2::ONE,
            heights: vec![0.5; count].into(),
        },
        ..Fixture::new(Solid::Sphere { radius: 1.0 }, Vec3::ZERO)
    };
    for (fixture, field) in [
        (triangles(vec![[0, 1, 4]]), "corners below 4"),
        (triangles(vec![[0, 1, 3]]), "area"),
        (triangles(vec![]), "triangles"),
        (heights(5), "6 heights"),
    ] {
        let error = world.edit(|edit| edit.add_fixture(fixture)).unwrap_err().to_string();
        assert!(error.contains(field), "{field}: {error}");
    }
    assert!(world.edit(|edit| edit.add_character(&model, nan, 0.0, Heading::FORWARD, 0.0)).is_err());
    assert!(world.edit(|edit| edit.add_fixture(heights(6))).is_ok());
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

#[test]
fn saved_worlds_continue_bit_for_bit() {
    let (mut world, model) = world();
    add(&mut world, &model, 0.0, 0.0, 0.0, 1.0);
    add(&mut world, &model, 0.6, 0.1, 180.0, 1.0);
    let crate_ = put(&mut world, Prop::cube(0.4, 6.0), Motion::at(Vec3::new(0.3, 0.5, 0.6)));
    world.record_history(1.0);
    wriggle(&mut world, 10);
    world.push(crate_, Vec3::X * 40.0, 0.5).unwrap();
    world.grab(crate_, Vec3::new(0.3, 0.5, 1.0), 200.0).unwrap();
    let saved = world.save();
    wriggle(&mut world, 15);
    let end = world.save();
    world.restore(&saved).unwrap();
    assert_eq!(world.save(), saved);
    wriggle(&mut world, 15);
    assert_eq!(world.save(), end);
    world.rewind_to(15).unwrap();
    assert_eq!((world.save(), world.history_age()), (saved.clone(), 15));
    wriggle(&mut world, 15);
    assert_eq!(world.save(), end);
    assert!(world.rewind_to(99).is_err());
    put(&mut world, Prop::cube(0.2, 1.0), Motion::at(Vec3::new(9.0, 0.0, 1.0)));
    let error = world.restore(&saved).unwrap_err();
    assert!(error.to_string().contains("layout"), "{error}");
}

#[test]
fn grabs_carry_and_let_go() {
    let (mut world, model) = world();
    let character = add(&mut world, &model, 0.0, 0.0, 0.0, 0.0);
    let crate_ = put(&mut world, Prop::cube(0.3, 5.0), Motion::at(Vec3::new(3.0, 0.0, 0.15)));
    let grab = world.grab(crate_, Vec3::new(3.0, 0.0, 0.3), 500.0).unwrap();
    world.move_grab(grab, Vec3::new(4.0, 0.0, 1.5)).unwrap();
    run(&mut world, 60);
    let held = world.motion(crate_).unwrap().position;
    assert!(held.distance(Vec3::new(4.0, 0.0, 1.35)) < 0.3, "{held}");
    world.release(grab).unwrap();
    assert!(matches!(world.release(grab), Err(WorldError::Stale { what: "a grab" })));
    run(&mut world, 30);
    assert!(world.motion(crate_).unwrap().position.z < 0.2);
    let hand = model.skeleton().body_named("right_hand").unwrap();
    let mut state = CharacterState::new(model.skeleton());
    world.sense_into(character, &mut state).unwrap();
    let at = state.bodies[hand.index()].position;
    let grab = world.grab(Movable::Body(character, hand), at, 2000.0).unwrap();
    world.move_grab(grab, Vec3::new(0.0, 0.0, 3.0)).unwrap();
    run(&mut world, 90);
    world.sense_into(character, &mut state).unwrap();
    let lifted = state.bodies[hand.index()].position;
    assert!(lifted.z > 1.8, "the character hangs by its hand: {lifted}");
}

#[test]
fn rays_meet_what_is_there() {
    let (mut world, model) = world();
    let character = add(&mut world, &model, 0.0, 0.0, 0.0, 0.0);
    let crate_ = put(&mut world, Prop::cube(1.0, 5.0), Motion::at(Vec3::new(3.0, 0.0, 0.5)));
    let wall =
        Fixture::new(Solid::Cuboid { half_extents: Vec3::new(0.1, 2.0, 2.0) }, Vec3::new(6.0, 0.0, 0.0));
    let wall = world.edit(|edit| edit.add_fixture(wall)).unwrap();
    let from = Vec3::new(-2.0, 0.0, 0.9);
    let hit = world.ray(from, Vec3::X * 3.0, 50.0, None).unwrap().unwrap();
    assert!(matches!(hit.part, Part::Body(found, _) if found == character), "{hit:?}");
    let low = world.ray(Vec3::new(1.0, 0.0, 0.5), Vec3::X, 50.0, None).unwrap().unwrap();
    assert_eq!(low.part, Part::Prop(crate_));
    assert!((low.distance - 1.5).abs() < 1e-3 && low.normal.distance(Vec3::NEG_X) < 1e-3, "{low:?}");
    let beyond = world.ray(Vec3::new(1.0, 0.0, 0.5), Vec3::X, 50.0, Some(crate_.into())).unwrap().unwrap();
    assert_eq!(beyond.part, Part::Fixture(wall));
    assert_eq!(world.ray(Vec3::new(1.0, 0.0, 0.5), Vec3::X, 1.0, None).unwrap(), None);
    assert!(world.ray(from, Vec3::ZERO, 1.0, None).is_err());
    let down = world.ray(Vec3::new(1.5, 5.0, 2.0), Vec3::NEG_Z, 50.0, None).unwrap().unwrap();
    assert_eq!(down.part, Part::Ground);
}

#[test]
fn characters_stand_on_fixtures_and_sense_their_height() {
    let (mut world, model) = world();
    let slab = |z: f32| {
        Fixture::new(Solid::Cuboid { half_extents: Vec3::new(1.0, 1.0, 0.25) }, Vec3::new(5.0, 0.0, z))
    };
    let mesh = Fixture {
        shape: FixtureShape::Triangles {
            points: vec![
                Vec3::new(-1.0, -1.0, 0.4),
                Vec3::new(1.0, -1.0, 0.4),
                Vec3::new(1.0, 1.0, 0.4),
                Vec3::new(-1.0, 1.0, 0.4),
            ]
            .into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]].into(),
        },
        ..Fixture::new(Solid::Sphere { radius: 1.0 }, Vec3::new(10.0, 0.0, 0.0))
    };
    let field = Fixture {
        shape: FixtureShape::Heights {
            rows: 5,
            columns: 5,
            half_extents: Vec2::ONE,
            heights: vec![0.3; 25].into(),
        },
        ..Fixture::new(Solid::Sphere { radius: 1.0 }, Vec3::new(15.0, 0.0, 0.0))
    };
    let characters = world
        .edit(|edit| {
            for fixture in [slab(0.25), mesh, field] {
                edit.add_fixture(fixture)?;
            }
            [0.0, 5.0, 10.0, 15.0]
                .into_iter()
                .map(|x| edit.add_character(&model, x, 0.1, Heading::FORWARD, 0.0))
                .collect::<Result<Vec<_>, _>>()
        })
        .unwrap();
    let mut state = CharacterState::new(model.skeleton());
    let mut heights = |world: &World| -> Vec<[f32; 2]> {
        characters
            .iter()
            .map(|&c| {
                world.sense_into(c, &mut state).unwrap();
                [state.ground_height, state.root().position.z]
            })
            .collect()
    };
    let start = heights(&world);
    run(&mut world, 10);
    for (now, then) in [(heights(&world), &start)].iter().flat_map(|(a, b)| a.iter().zip(b.iter())) {
        assert!((now[1] - then[1]).abs() < 0.05, "they do not sink: {now:?} {then:?}");
    }
    for ([ground, root], expected) in start.iter().zip([0.0, 0.5, 0.4, 0.3]) {
        assert!((ground - expected).abs() < 0.01, "{ground} {expected}");
        assert!((root - expected - start[0][1]).abs() < 0.01, "{root} {expected}");
    }
}

#[test]
fn stale_handles_are_errors_everywhere() {
    let (mut world, model) = world();
    let character = add(&mut world, &model, 0.0, 0.0, 0.0, 0.0);
    let crate_ = put(&mut world, Prop::cube(0.3, 1.0), Motion::at(Vec3::Z));
    let grab = world.grab(crate_, Vec3::Z, 10.0).unwrap();
    world
        .edit(|edit| {
            edit.remove_prop(crate_)?;
            edit.remove_character(character)
        })
        .unwrap();
    let mut state = CharacterState::new(model.skeleton());
    let body = Movable::Body(character, BodyId::new(0));
    assert!(world.sense_into(character, &mut state).is_err());
    assert!(world.actuate(character, &[0.0]).is_err());
    assert!(world.stand_at(character, 0.0, 0.0, Heading::FORWARD, 0.0).is_err());
    assert!(world.push(body, Vec3::X, 0.1).is_err());
    assert!(world.impulse(crate_, Vec3::X).is_err());
    assert!(world.grab(body, Vec3::X, 1.0).is_err());
    assert!(world.move_grab(grab, Vec3::X).is_err());
    assert!(world.place_prop(crate_, Motion::at(Vec3::Z)).is_err());
    assert!(world.prop(crate_).is_err() && world.motion(crate_).is_err() && world.model(character).is_err());
    assert!(world.edit(|edit| edit.remove_prop(crate_)).is_err());
    assert!(world.edit(|edit| edit.remove_character(character)).is_err());
    assert!(
        world.edit(|edit| edit.join(crate_, None, Joint::Ball { anchor: Vec3::Z, damping: 0.0 })).is_err()
    );
    // Another thing in the same place has another handle.
    let other = put(&mut world, Prop::cube(0.3, 1.0), Motion::at(Vec3::Z));
    assert_eq!(other.index(), crate_.index());
    assert!(world.motion(crate_).is_err() && world.motion(other).is_ok());
    assert!(world.push(Movable::Body(character, BodyId::new(99)), Vec3::X, 0.1).is_err());
}

#[test]
fn characters_of_several_models_share_a_world() {
    let (humanoid, quadruped) = (humanoid(), common::quadruped());
    let mut world = World::new(&quadruped).unwrap();
    let weak =
        humanoid.with_settings(physics_bridge::Settings { strength: 0.0, ..Default::default() }).unwrap();
    let (tall, limp, dog) = world
        .edit(|edit| {
            let tall = edit.add_character(&humanoid, 0.0, 0.0, Heading::FORWARD, 0.0)?;
            let limp = edit.add_character(&weak, 4.0, 0.0, Heading::FORWARD, 0.0)?;
            Ok((tall, limp, edit.add_character(&quadruped, 8.0, 0.0, Heading::FORWARD, 0.0)?))
        })
        .unwrap();
    run(&mut world, 12);
    let heights = [tall, limp, dog].map(|character| pose(&world, character).qpos[2]);
    let stands = [&humanoid, &weak, &quadruped].map(|model| {
        let mut alone = physics_bridge::Character::new(model);
        (0..12).for_each(|_| alone.step().unwrap());
        alone.pose().qpos[2]
    });
    for (height, stand) in heights.iter().zip(&stands) {
        assert!((height - stand).abs() < 0.03, "{heights:?} {stands:?}");
    }
    assert!(heights[1] < heights[0] - 0.005, "without strength it sinks: {heights:?}");
    let mut coarse = World::new(&humanoid).unwrap();
    let error =
        coarse.edit(|edit| edit.add_character(&quadruped, 0.0, 0.0, Heading::FORWARD, 0.0)).unwrap_err();
    assert!(matches!(error, WorldError::Rate { .. }), "{error}");
}

#[test]
fn targets_that_are_no_numbers_are_ignored_and_told_once() {
    let (mut world, model) = world();
    let character = add(&mut world, &model, 0.0, 0.0, 0.0, 0.0);
    let mut targets = JointTargets::new(model.skeleton());
    targets[3] = f32::NAN;
    world.actuate(character, &targets).unwrap();
    assert_eq!(world.step(), 1);
    let found = world.divergences()[0];
    assert_eq!(
        (found.cause, found.remedy),
        (physics_bridge::Cause::BadControl, physics_bridge::Remedy::Ignored)
    );
    assert_eq!(found.what, Some(physics_bridge::Diverging::Character(character)));
    run(&mut world, 3);
}
