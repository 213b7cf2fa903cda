//! Props, fixtures and joints of a world.

mod common;

use common::{CRANE, humanoid};
use physics_rapier::{Fixture, FixtureShape, Joint, Model, Motion, Prop, Solid, World, WorldError};
use policy_core::CharacterState;
use policy_core::glam::{Quat, Vec2, Vec3};

/// Seconds that this many control ticks take at 30 a second.
fn step(world: &mut World, ticks: usize) {
    (0..ticks).for_each(|_| world.step());
}

fn at(world: &World, prop: usize) -> Vec3 {
    world.prop(prop).expect("it was added").1.position
}

#[test]
fn every_shape_comes_to_rest_at_its_own_height() {
    let corners: Vec<Vec3> =
        (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 0.4 - 0.2).collect();
    let solids = [
        (Solid::Sphere { radius: 0.3 }, 0.3),
        (Solid::Capsule { radius: 0.1, half_length: 0.3 }, 0.4),
        (Solid::Cylinder { radius: 0.3, half_length: 0.25 }, 0.25),
        (Solid::Cuboid { half_extents: Vec3::new(0.3, 0.2, 0.15) }, 0.15),
        (Solid::Hull { points: corners.into() }, 0.2),
    ];
    for (solid, height) in solids {
        let mut world = World::new(&humanoid());
        let start = Motion::at(Vec3::new(0.0, 0.0, height + 0.05));
        let prop = world.add_prop(&Prop::new(solid.clone(), 5.0), &start).unwrap();
        step(&mut world, 15);
        let found = at(&world, prop).z;
        assert!((found - height).abs() < 0.02, "{solid:?} is {found} m high");
    }
}

#[test]
fn a_fixture_holds_a_prop_and_is_ground_for_a_character() {
    let mut world = World::new(&humanoid());
    let slab = Solid::Cuboid { half_extents: Vec3::new(1.0, 1.0, 0.1) };
    let turned =
        Fixture { rotation: Quat::from_rotation_y(-0.2), ..Fixture::new(slab.clone(), Vec3::Z * 0.5) };
    world.add_fixture(&turned).unwrap();
    let top = |x: f32| 0.5 + 0.1 / 0.2_f32.cos() + x * 0.2_f32.tan();
    for x in [-0.5, 0.0, 0.5] {
        let found = world.ground_below(Vec3::new(x, 0.3, 2.0));
        assert!((found - top(x)).abs() < 1e-4, "{x}: {found}");
    }
    assert_eq!(world.ground_below(Vec3::new(3.0, 0.0, 2.0)), 0.0, "beside it");
    assert_eq!(world.ground_below(Vec3::new(0.0, 0.0, 0.2)), 0.0, "under it");
    let character = world.add_character().unwrap();
    let mut state = CharacterState::new(world.model().skeleton());
    world.sense_into(character, &mut state).unwrap();
    assert!((state.ground_height - top(state.root().position.x)).abs() < 1e-3, "{}", state.ground_height);
    let foot = world.model().skeleton().feet()[0];
    let rise = top(state.body(foot).position.x) - state.ground_height;
    assert!(
        (state.ground_rises[foot.index()] - rise).abs() < 1e-3,
        "a foot at rest: {:?}",
        state.ground_rises
    );

    let mut world = World::new(&humanoid());
    world.add_fixture(&Fixture::new(slab, Vec3::Z * 0.5)).unwrap();
    let prop = world.add_prop(&Prop::cube(0.4, 3.0), &Motion::at(Vec3::Z)).unwrap();
    step(&mut world, 30);
    assert!((at(&world, prop).z - 0.8).abs() < 0.02, "{}", at(&world, prop));
}

#[test]
fn a_character_steps_onto_a_board_and_not_onto_what_is_higher_than_a_step() {
    // A board, one overhead, and a crate that the feet would be inside of.
    for (z, half_height, expected) in [(0.05, 0.05, 0.1), (2.5, 0.05, 0.0), (0.3, 0.3, 0.0)] {
        let mut world = World::new(&humanoid());
        let solid = Solid::Cuboid { half_extents: Vec3::new(1.0, 1.0, half_height) };
        world.add_prop(&Prop::new(solid, 50.0), &Motion::at(Vec3::Z * z)).unwrap();
        let character = world.add_character().unwrap();
        let mut state = CharacterState::new(world.model().skeleton());
        world.sense_into(character, &mut state).unwrap();
        assert!((state.ground_height - expected).abs() < 1e-3, "{z}: {}", state.ground_height);
        let rises = state.ground_rises.iter().all(|rise| rise.abs() < 1e-3);
        assert!(rises, "level below it: {:?}", state.ground_rises);
    }
}

#[test]
fn triangles_and_heights_are_ground_too() {
    let mut world = World::new(&humanoid());
    let triangles = FixtureShape::Triangles {
        points: [Vec3::new(-2.0, -2.0, 0.3), Vec3::new(2.0, -2.0, 0.3), Vec3::new(0.0, 3.0, 0.3)].into(),
        triangles: [[0, 1, 2]].into(),
    };
    let place = Fixture::new(Solid::Sphere { radius: 1.0 }, Vec3::ZERO);
    world.add_fixture(&Fixture { shape: triangles, ..place.clone() }).unwrap();
    // Three points along x and two along y: it rises along x and falls along y.
    let heights = FixtureShape::Heights {
        rows: 2,
        columns: 3,
        half_extents: Vec2::new(2.0, 1.0),
        heights: [1.0, 1.5, 2.0, 0.0, 0.5, 1.0].into(),
    };
    world.add_fixture(&Fixture { shape: heights, position: Vec3::X * 10.0, ..place }).unwrap();
    assert!((world.ground_below(Vec3::new(0.1, 0.0, 2.0)) - 0.3).abs() < 1e-5);
    for (x, y, height) in [(9.0, -0.999, 1.25), (11.0, -0.999, 1.75), (9.0, 0.999, 0.25)] {
        let found = world.ground_below(Vec3::new(x, y, 5.0));
        assert!((found - height).abs() < 0.01, "{x} {y}: {found}");
    }
}

#[test]
fn a_prop_slides_smoothly_over_the_edges_between_triangles() {
    let side = 24_u32;
    let corner = |i: u32| Vec3::new((i % side) as f32 * 0.25 - 3.0, (i / side) as f32 * 0.25 - 3.0, 0.3);
    let squares = (0..(side - 1) * (side - 1)).map(|i| i / (side - 1) * side + i % (side - 1));
    let triangles: Vec<[u32; 3]> =
        squares.flat_map(|i| [[i, i + 1, i + side], [i + 1, i + side + 1, i + side]]).collect();
    let points: Vec<Vec3> = (0..side * side).map(corner).collect();
    let shape = FixtureShape::Triangles { points: points.into(), triangles: triangles.into() };
    let place = Fixture::new(Solid::Sphere { radius: 1.0 }, Vec3::ZERO);
    let mut world = World::new(&humanoid());
    world.add_fixture(&Fixture { shape, friction: 0.0, ..place }).unwrap();
    let cube = Prop { friction: 0.0, ..Prop::cube(0.2, 3.0) };
    let start = Motion::at(Vec3::new(-2.5, 0.1, 0.4)).moving(Vec3::new(1.5, 0.4, 0.0));
    let prop = world.add_prop(&cube, &start).unwrap();
    for tick in 0..75 {
        world.step();
        let (_, motion) = world.prop(prop).unwrap();
        let lift = motion.position.z - 0.4;
        assert!(lift.abs() < 0.01, "lifted by {lift} m in tick {tick}");
        assert!(motion.spin.length() < 0.1, "turned by an edge in tick {tick}: {}", motion.spin);
        assert!((motion.velocity.truncate() - Vec2::new(1.5, 0.4)).length() < 0.05, "{}", motion.velocity);
    }
}

#[test]
fn a_prop_on_ground_that_is_deep_down_is_not_lost() {
    let deep = CRANE.replace(r#"pos="0 0 0.2""#, r#"pos="0 0 -30""#);
    let mut world = World::new(&Model::from_mjcf(&deep).unwrap());
    let prop = world.add_prop(&Prop::cube(0.4, 5.0), &Motion::at(Vec3::new(1.0, 1.0, -29.8))).unwrap();
    assert_eq!(world.reset_lost_props(), 0);
    world.add_prop(&Prop::cube(0.4, 5.0), &Motion::at(Vec3::new(3.0, 1.0, -34.0))).unwrap();
    assert_eq!((world.reset_lost_props(), at(&world, prop).z), (1, -29.8));
}

/// A door of 1 m that stands ajar about a hinge, and what it does under a push across it of so many newtons for a second.
fn door(range: Option<[f32; 2]>, damping: f32, newton: f32) -> f32 {
    let mut world = World::new(&humanoid());
    let leaf = Prop::new(Solid::Cuboid { half_extents: Vec3::new(0.5, 0.03, 0.5) }, 4.0);
    let prop = world.add_prop(&leaf, &Motion::at(Vec3::new(0.5, 0.0, 1.0))).unwrap();
    world.join(prop, None, &Joint::Hinge { anchor: Vec3::Z, axis: Vec3::Z, range, damping }).unwrap();
    for _ in 0..30 {
        world.push_prop(prop, Vec3::Y * newton).unwrap();
        world.step();
        let off = (at(&world, prop) - Vec3::Z).length();
        assert!((off - 0.5).abs() < 0.02, "it leaves its hinge by {off} m");
    }
    let x = world.prop(prop).unwrap().1.rotation * Vec3::X;
    x.y.atan2(x.x)
}

#[test]
fn a_hinge_turns_within_its_range_and_against_its_damping() {
    assert!(door(None, 0.0, 2.0) > 0.25);
    let stopped = door(Some([-0.3, 0.3]), 0.0, 6.0);
    assert!((stopped - 0.3).abs() < 0.05, "{stopped}");
    assert!(door(None, 50.0, 2.0) < 0.3 * door(None, 0.0, 2.0));
}

#[test]
fn slides_balls_and_ropes_hold() {
    let mut world = World::new(&humanoid());
    let mut add =
        |x: f32| world.add_prop(&Prop::ball(0.1, 1.0), &Motion::at(Vec3::new(x, 0.0, 1.0))).unwrap();
    let [slide, ball, rope, one, other] = [0.0, 2.0, 4.0, 6.0, 6.5].map(&mut add);
    world.join(slide, None, &Joint::Slide { axis: Vec3::Z, range: Some([-0.4, 0.4]), damping: 0.0 }).unwrap();
    let anchor = Vec3::new(2.5, 0.0, 1.0);
    world.join(ball, None, &Joint::Ball { anchor, damping: 0.0 }).unwrap();
    let hook = Vec3::new(4.0, 0.0, 1.5);
    world.join(rope, None, &Joint::Rope { ends: [Vec3::new(4.0, 0.0, 1.0), hook], length: 0.8 }).unwrap();
    let between = Vec3::new(6.25, 0.0, 1.0);
    world.join(one, Some(other), &Joint::Ball { anchor: between, damping: 0.0 }).unwrap();
    step(&mut world, 60);
    assert!((at(&world, slide) - Vec3::new(0.0, 0.0, 0.6)).length() < 0.03, "{}", at(&world, slide));
    assert!((at(&world, ball).distance(anchor) - 0.5).abs() < 0.02, "{}", at(&world, ball));
    assert!((at(&world, rope).z - 0.7).abs() < 0.05, "{}", at(&world, rope));
    assert!(at(&world, one).distance(at(&world, other)) < 0.53, "they hang together");
    assert_eq!(world.joint_count(), 4);
}

#[test]
fn a_saved_world_runs_on_bit_for_bit_with_its_joints() {
    let mut world = World::new(&humanoid());
    let bob = world.add_prop(&Prop::ball(0.2, 4.0), &Motion::at(Vec3::new(1.0, 0.0, 2.0))).unwrap();
    world.join(bob, None, &Joint::Ball { anchor: Vec3::Z * 2.0, damping: 0.1 }).unwrap();
    let bits = |world: &World| {
        let mut bits = Vec::new();
        world.state_bits(|word| bits.push(word));
        bits
    };
    step(&mut world, 10);
    let saved = world.save();
    step(&mut world, 20);
    let expected = bits(&world);
    world.restore(&saved).unwrap();
    step(&mut world, 20);
    assert_eq!(bits(&world), expected);
}

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let mut world = World::new(&humanoid());
    let crate_ = world.add_prop(&Prop::cube(0.4, 3.0), &Motion::at(Vec3::Z)).unwrap();
    let said = |result: Result<(), WorldError>| result.unwrap_err().to_string();
    let light = Prop::cube(0.4, -1.0);
    assert!(said(world.add_prop(&light, &Motion::at(Vec3::Z)).map(drop)).contains("mass_kg of a prop"));
    let far = Motion::at(Vec3::X * 1e9);
    assert!(said(world.add_prop(&Prop::cube(0.4, 1.0), &far).map(drop)).contains("position of a prop"));
    let ball = Fixture { friction: f32::NAN, ..Fixture::new(Solid::Sphere { radius: 1.0 }, Vec3::ZERO) };
    assert!(said(world.add_fixture(&ball)).contains("friction of a fixture"));
    let hinge = Joint::Hinge { anchor: Vec3::ZERO, axis: Vec3::Z, range: None, damping: 0.0 };
    assert!(said(world.join(crate_, Some(crate_), &hinge)).contains("one twice"));
    assert!(said(world.join(7, None, &hinge)).contains("one of 1 props, found 7"));
    let bent = Joint::Hinge { anchor: Vec3::ZERO, axis: Vec3::ZERO, range: None, damping: 0.0 };
    assert!(said(world.join(crate_, None, &bent)).contains("length of the axis"));
    assert!(said(world.push_prop(crate_, Vec3::NAN)).contains("finite force"));
    assert_eq!((world.prop_count(), world.fixture_count(), world.joint_count()), (1, 0, 0));
}

/// Contacts with the ground are soft for everything in the world.
#[test]
fn a_stack_of_crates_rests_on_the_ground() {
    let mut world = World::new(&humanoid());
    for floor in 0..3 {
        let start = Motion::at(Vec3::new(0.0, 0.0, 0.2 + 0.4 * floor as f32));
        world.add_prop(&Prop::cube(0.4, 20.0), &start).unwrap();
    }
    step(&mut world, 60);
    for floor in 0..3 {
        let sunk = 0.2 + 0.4 * floor as f32 - at(&world, floor).z;
        assert!((0.001..0.015).contains(&sunk), "crate {floor}: {sunk} m");
    }
}

/// Trap: with Rapier's prediction distance of 20 mm a contact exists before the shapes touch, and what lands stops rigidly at the surface.
#[test]
fn what_lands_sinks_into_the_ground_before_it_stops() {
    let mut world = World::new(&humanoid());
    world.add_prop(&Prop::cube(0.4, 20.0), &Motion::at(Vec3::new(0.0, 0.0, 0.3))).unwrap();
    let mut deepest = 0.0_f32;
    for _ in 0..15 {
        step(&mut world, 1);
        deepest = deepest.max(0.2 - at(&world, 0).z);
    }
    println!("deepest {deepest} m");
    assert!(deepest > 0.006, "{deepest} m");
}
