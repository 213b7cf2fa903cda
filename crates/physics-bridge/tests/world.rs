//! A shared world: what touches what, and how it moves.

mod common;

use common::shared_world;
use common::shared_world::{add, pose, put, run, world, wriggle};
use common::{humanoid, wriggle_into};
use glam::{Quat, Vec2, Vec3};
use physics_bridge::{
    Fixture, FixtureShape, Motion, Movable, Part, Prop, Settings, Solid, Terrain, World, WorldError,
};
use policy_core::{CharacterState, FOOT_LOOKAHEAD_SECS, Heading, JointTargets};

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

    let (mut world, _) = shared_world::world();
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
fn a_character_steps_onto_a_board_and_not_onto_what_is_higher_than_a_step() {
    let slab = |x: f32, z: f32, half_height: f32| {
        let solid = Solid::Cuboid { half_extents: Vec3::new(1.0, 1.0, half_height) };
        (Prop::new(solid, 50.0), Motion::at(Vec3::new(x, 0.0, z)))
    };
    // A board, one overhead, a crate that the feet would be inside of; then nothing.
    for (prop, expected) in [
        (Some(slab(0.0, 0.05, 0.05)), 0.1),
        (Some(slab(0.0, 2.5, 0.05)), 0.0),
        (Some(slab(0.0, 0.3, 0.3)), 0.0),
        (Some(slab(5.0, 0.05, 0.05)), 0.0),
        (None, 0.0),
    ] {
        let (mut world, model) = world();
        let character = world
            .edit(|edit| {
                prop.iter().try_for_each(|(prop, motion)| edit.add_prop(prop.clone(), *motion).map(drop))?;
                edit.add_character(&model, 0.0, 0.0, Heading::FORWARD, 0.0)
            })
            .unwrap();
        let mut state = CharacterState::new(model.skeleton());
        world.sense_into(character, &mut state).unwrap();
        assert!((state.ground_height - expected).abs() < 1e-3, "{prop:?}: {}", state.ground_height);
    }
}

#[test]
fn a_world_has_the_terrain_of_its_model() {
    let flat = humanoid();
    for terrain in [
        Terrain::Wavy { height_m: 0.7, wavelength_m: 6.0, seed: 3 },
        Terrain::Steps { rise_m: 0.1, run_m: 1.5, count: 4 },
    ] {
        let model = flat.with_terrain(terrain).unwrap();
        let mut world = World::new(&model).unwrap();
        let place = Vec2::new(4.5, 0.6);
        let ground = model.height_at(place.x, place.y);
        assert!(ground > 0.05, "{ground}");
        let character = add(&mut world, &flat, place.x, place.y, 0.0, 0.0);
        let at = (place + Vec2::Y * 3.0).extend(ground + 1.0);
        let ball = put(&mut world, Prop { bounce: 0.0, ..Prop::ball(0.1, 1.0) }, Motion::at(at));
        run(&mut world, 20);
        let mut state = CharacterState::new(flat.skeleton());
        world.sense_into(character, &mut state).unwrap();
        let root = state.root().position;
        assert!((state.ground_height - model.height_at(root.x, root.y)).abs() < 1e-3);
        let foot = flat.skeleton().feet()[0];
        let comes_to = state.body(foot).position + FOOT_LOOKAHEAD_SECS * state.body(foot).linear_velocity;
        let rise = model.height_at(comes_to.x, comes_to.y) - state.ground_height;
        assert!((state.ground_rises[foot.index()] - rise).abs() < 1e-3, "{rise} {:?}", state.ground_rises);
        assert!((0.6..1.0).contains(&(root.z - state.ground_height)), "{root} {}", state.ground_height);
        let ball = world.motion(ball).unwrap().position;
        let below = model.height_at(ball.x, ball.y);
        assert!((0.05..0.2).contains(&(ball.z - below)), "{ball} {below}");
    }
}

#[test]
fn a_world_has_the_friction_and_gravity_of_its_model() {
    let slides = |friction: f32, gravity: f32| {
        let settings = Settings { friction, gravity, ..Settings::default() };
        let mut world = World::new(&humanoid().with_settings(settings).unwrap()).unwrap();
        let crate_ = put(&mut world, Prop::cube(0.4, 5.0), Motion::at(Vec3::Z * 0.2).moving(Vec3::X * 3.0));
        run(&mut world, 45);
        world.motion(crate_).unwrap().position.x
    };
    let (usual, ice, moon) = (slides(1.0, 1.0), slides(0.1, 1.0), slides(1.0, 0.165));
    assert!(ice > 2.0 * usual && moon > 1.5 * usual, "{usual} {ice} {moon}");
}

#[test]
fn settings_change_while_a_world_runs() {
    let (mut world, model) = world();
    let [a, b] = [0.0, 3.0].map(|x| add(&mut world, &model, x, 0.0, 0.0, 0.0));
    let crate_ = put(&mut world, Prop::cube(0.4, 5.0), Motion::at(Vec3::new(-3.0, 0.0, 2.0)));
    let with = |settings| model.with_settings(settings).unwrap();
    world.set_ground(&with(Settings { gravity: 0.0, ..Settings::default() })).unwrap();
    run(&mut world, 30);
    assert!((world.motion(crate_).unwrap().position.z - 2.0).abs() < 1e-4, "it floats");
    world.set_ground(&model).unwrap();
    world.set_model(b, &with(Settings { strength: 0.0, ..Settings::default() })).unwrap();
    run(&mut world, 30);
    let before = [a, b].map(|character| pose(&world, character).qpos[2]);
    assert!(world.motion(crate_).unwrap().position.z < 1.0 && before[1] < before[0] - 0.05, "{before:?}");
    put(&mut world, Prop::cube(0.3, 5.0), Motion::at(Vec3::new(-5.0, 0.0, 2.0)));
    run(&mut world, 15);
    assert!(pose(&world, b).qpos[2] < before[1], "the settings outlast a build");
    world.set_model(b, &model).unwrap();
    assert_eq!(world.model(b).unwrap().settings(), Settings::default());
    let other = common::quadruped();
    assert!(matches!(world.set_ground(&other), Err(WorldError::OtherModel)));
    assert!(matches!(world.set_model(b, &other), Err(WorldError::OtherModel)));
}
