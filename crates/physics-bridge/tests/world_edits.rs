//! A shared world that changes: what is kept, what is refused, what handles name.

mod common;

use common::humanoid;
use common::shared_world::{add, bits, pose, put, run, world, wriggle};
use glam::{Quat, Vec2, Vec3};
use physics_bridge::{
    Fixture, FixtureShape, Joint, MASS_RANGE_KG, Motion, Movable, Part, Prop, Solid, World, WorldError,
};
use policy_core::{BodyId, CharacterState, Heading, JointTargets};

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

#[test]
fn a_huge_target_of_one_character_leaves_the_motors_of_another_alone() {
    let targets_after = |huge: f32| {
        let (mut world, model) = world();
        let [one, other] = [0.0, 3.0].map(|x| add(&mut world, &model, x, 0.0, 0.0, 0.0));
        let mut targets = JointTargets::new(model.skeleton());
        world.actuate(other, &targets).unwrap();
        targets[3] = huge;
        world.actuate(one, &targets).unwrap();
        let told = world.step();
        (told, bits(&world, other))
    };
    let (told, expected) = targets_after(0.0);
    assert_eq!(told, 0);
    for huge in [1e11, -1e30, f32::MAX, f32::INFINITY] {
        let (told, found) = targets_after(huge);
        assert_eq!((told, found == expected), (1, true), "{huge}");
    }
}

#[test]
fn a_build_keeps_what_is_still_to_be_told() {
    let (mut world, model) = world();
    let character = add(&mut world, &model, 0.0, 0.0, 0.0, 0.0);
    world.actuate(character, &[f32::NAN]).unwrap();
    put(&mut world, Prop::cube(0.3, 2.0), Motion::at(Vec3::new(9.0, 9.0, 1.0)));
    assert_eq!(world.step(), 1, "the target that was ignored before the build");
    let before = world.divergences().to_vec();
    put(&mut world, Prop::cube(0.3, 2.0), Motion::at(Vec3::new(9.0, 5.0, 1.0)));
    assert_eq!(world.divergences(), before);
}

#[test]
fn rays_do_not_meet_what_was_taken_out() {
    let (mut world, _) = world();
    let prop = put(&mut world, Prop::cube(2.0, 2.0), Motion::at(Vec3::new(0.0, 0.0, 1.0)));
    world.edit(|edit| edit.remove_prop(prop)).unwrap();
    // From below the floor, to where it is kept.
    let hit = world.ray(Vec3::Z * -4000.0, Vec3::NEG_Z, 3000.0, None).unwrap();
    assert_eq!(hit, None);
}

#[test]
fn shapes_at_the_edge_of_what_is_allowed_are_built_or_refused() {
    let (mut world, _) = world();
    let thin = |thickness: f32| -> Vec<Vec3> {
        let corner = |i: usize| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32 * thickness);
        (0..16).map(|i| corner(i % 8)).collect()
    };
    let solids = [
        Solid::Hull { points: thin(0.0021).into() },
        Solid::Hull { points: thin(99.0).into() },
        Solid::Hull { points: thin(0.003).iter().map(|p| *p * Vec3::new(0.003, 0.003, 1.0)).collect() },
        Solid::Cuboid { half_extents: Vec3::new(0.005, 100.0, 0.005) },
        Solid::Cylinder { radius: 100.0, half_length: 0.005 },
        Solid::Sphere { radius: 0.005 },
    ];
    for (index, solid) in solids.into_iter().enumerate() {
        for mass in MASS_RANGE_KG {
            let motion = Motion::at(Vec3::new(500.0 * index as f32, 0.1 * mass, 150.0));
            let added = world.edit(|edit| edit.add_prop(Prop::new(solid.clone(), mass), motion));
            assert!(matches!(added, Ok(_) | Err(WorldError::Compile { .. })), "{added:?}");
        }
    }
    let slivers = Fixture {
        shape: FixtureShape::Triangles {
            points: vec![Vec3::ZERO, Vec3::X, Vec3::new(0.5, 3e-6, 0.0), Vec3::Y * 100.0].into(),
            triangles: vec![[0, 1, 2], [0, 1, 3], [1, 0, 3]].into(),
        },
        ..Fixture::new(Solid::Sphere { radius: 1.0 }, Vec3::new(0.0, -500.0, 0.0))
    };
    let added = world.edit(|edit| edit.add_fixture(slivers));
    assert!(matches!(added, Ok(_) | Err(WorldError::Compile { .. })), "{added:?}");
    for _ in 0..30 {
        world.step();
    }
    assert!(world.props().count() > 4);
}
