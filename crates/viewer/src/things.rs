//! Fixtures, props and checkpoints of a playground as things to draw.

use glam::{Mat4, Quat, Vec3};
use policy_core::contract::{FixtureShape, Solid as Shape};

use crate::render::{Marker, Scene, Solid};
use playground::{Paint, Playground, Race, RaceState};

/// Marks of cubes: their edges.
const EDGES: f32 = 1.0;
/// Marks of what is round: octants.
const OCTANTS: f32 = 0.5;
/// Radius of a rod that something hangs on, metres.
const ROD_M: f32 = 0.03;
/// Height of the light above the next checkpoint, metres.
const BEACON_M: f32 = 2.6;
const NEXT_COLOUR: [f32; 3] = [0.98, 0.75, 0.10];
const LATER_COLOUR: [f32; 4] = [0.75, 0.78, 0.82, 0.55];

/// Adds what never moves.
pub fn fixtures(scene: &mut Scene, layout: &Playground) {
    for painted in &layout.fixtures {
        let fixture = &painted.fixture;
        if let FixtureShape::Solid(shape) = &fixture.shape {
            add(scene, shape, (fixture.position, fixture.rotation), painted.paint);
        }
    }
}

/// Adds a prop where it is, and a rod to the point that it hangs on, metres, if it hangs far from it.
pub fn prop(scene: &mut Scene, shape: &Shape, pose: (Vec3, Quat), paint: Paint, anchor: Option<Vec3>) {
    add(scene, shape, pose, paint);
    if let Some(anchor) = anchor
        && anchor.distance(pose.0) > reach_of(shape)
    {
        rod(scene, anchor, pose.0);
    }
}

fn add(scene: &mut Scene, shape: &Shape, (position, rotation): (Vec3, Quat), paint: Paint) {
    let [r, g, b] = colour(paint);
    let world_from_shape = Mat4::from_rotation_translation(rotation, position);
    let mut push = |solid, scale: Vec3, up: f32, marks: f32| {
        let local = Mat4::from_scale_rotation_translation(scale, Quat::IDENTITY, Vec3::Z * up);
        scene.things.push(Marker { solid, place: world_from_shape * local, colour: [r, g, b, marks] });
    };
    match *shape {
        Shape::Sphere { radius } => push(Solid::Ball, Vec3::splat(radius), 0.0, OCTANTS),
        Shape::Capsule { radius, half_length } => {
            push(Solid::Tube, Vec3::new(radius, radius, half_length), 0.0, OCTANTS);
            push(Solid::Ball, Vec3::splat(radius), half_length, OCTANTS);
            push(Solid::Ball, Vec3::splat(radius), -half_length, OCTANTS);
        }
        Shape::Cylinder { radius, half_length } => {
            push(Solid::Drum, Vec3::new(radius, radius, half_length), 0.0, OCTANTS);
        }
        Shape::Cuboid { half_extents } => push(Solid::Cube, half_extents, 0.0, EDGES),
        // No scene has hulls.
        Shape::Hull { .. } => {}
    }
}

/// How far from its middle a shape reaches.
fn reach_of(shape: &Shape) -> f32 {
    match *shape {
        Shape::Sphere { radius } => radius,
        Shape::Capsule { radius, half_length } => radius + half_length,
        Shape::Cylinder { radius, half_length } => radius.hypot(half_length),
        Shape::Cuboid { half_extents } => half_extents.length(),
        Shape::Hull { .. } => f32::INFINITY,
    }
}

fn rod(scene: &mut Scene, from: Vec3, to: Vec3) {
    let along = to - from;
    let turn = Quat::from_rotation_arc(Vec3::Z, along.normalize_or(Vec3::Z));
    let scale = Vec3::new(ROD_M, ROD_M, 0.5 * along.length());
    let place = Mat4::from_scale_rotation_translation(scale, turn, 0.5 * (from + to));
    let [r, g, b] = colour(Paint::Steel);
    scene.things.push(Marker { solid: Solid::Tube, place, colour: [r, g, b, EDGES] });
}

/// A ring on the ground for each checkpoint, and a light above the next.
pub fn checkpoints(scene: &mut Scene, layout: &Playground, race: &Race) {
    for (index, checkpoint) in layout.checkpoints.iter().enumerate() {
        let is_next = index == race.next();
        // Those that are done are left out.
        if race.state() == RaceState::Running && index < race.next() {
            continue;
        }
        let ground = layout.height_at(checkpoint.at, 1.0) + 0.02;
        let [r, g, b] = NEXT_COLOUR;
        let colour = if is_next { [r, g, b, 0.9] } else { LATER_COLOUR };
        ring(scene, checkpoint.at.extend(ground), checkpoint.radius, colour);
        if is_next {
            let scale = Vec3::new(0.12, 0.12, 0.5 * BEACON_M);
            let middle = checkpoint.at.extend(ground + 0.5 * BEACON_M);
            let place = Mat4::from_scale_rotation_translation(scale, Quat::IDENTITY, middle);
            scene.markers.push(Marker { solid: Solid::Tube, place, colour: [r, g, b, 0.35] });
        }
    }
}

/// Linear colours.
fn colour(paint: Paint) -> [f32; 3] {
    match paint {
        Paint::Concrete => [0.36, 0.37, 0.38],
        Paint::Wood => [0.42, 0.24, 0.11],
        Paint::Steel => [0.22, 0.25, 0.29],
        Paint::Red => [0.58, 0.09, 0.07],
        Paint::Orange => [0.78, 0.30, 0.05],
        Paint::Yellow => [0.74, 0.54, 0.08],
        Paint::Green => [0.13, 0.38, 0.16],
        Paint::Blue => [0.09, 0.25, 0.52],
        Paint::Violet => [0.30, 0.16, 0.44],
    }
}

/// Adds a ring that lies about a point, metres.
pub(crate) fn ring(scene: &mut Scene, centre: Vec3, radius: f32, colour: [f32; 4]) {
    let scale = Vec3::new(radius, radius, 1.0);
    let place = Mat4::from_scale_rotation_translation(scale, Quat::IDENTITY, centre);
    scene.markers.push(Marker { solid: Solid::Ring, place, colour });
}
