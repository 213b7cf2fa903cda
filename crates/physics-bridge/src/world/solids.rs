//! Props, fixtures and their joints as parts of a MuJoCo model.

use glam::{DQuat, DVec3, Vec3};
use mujoco_rs::wrappers::mj_editing::{MjSpec, MjsBody, MjsGeom, SpecItem};
use mujoco_rs::wrappers::mj_editing::{MjtLimited, MjtMeshInertia};
use mujoco_rs::wrappers::mj_model::{MjtGeomBase, MjtJoint};
use policy_core::contract::{Fixture, FixtureShape, Prop, Solid, TRIANGLE_DEPTH_M};

use super::build::EVERYTHING;
use super::places::{fixture_name, prop_name, rope_name};
use super::scene::{Hold, HoldKind, JointRecord, PropRecord, Rope, Scene};

/// How fast a free prop slows down by itself, 1/s: enough that a ball on a plane comes to rest.
const DRAG: f64 = 0.005;

/// How far below its lowest point a height field is solid, metres.
const FIELD_BASE_M: f64 = 1.0;

/// Swing of a bouncing contact, rad/s: slow enough for steps of 1/120 s.
const BOUNCE_RADPS: f64 = 100.0;

/// Group of the geoms of fixtures, which rays for the ground look at.
pub(super) const FIXTURE_GROUP: usize = 3;

/// Adds all props, fixtures and ropes of a scene.
pub(super) fn add(spec: &mut MjSpec, scene: &Scene) {
    for (index, slot) in scene.props.iter() {
        if let Solid::Hull { points } = &slot.value.prop.solid {
            add_mesh(spec, &prop_name(index), points);
        }
        if slot.value.hold.as_ref().is_none_or(|hold| hold.parent.is_none()) {
            add_prop(spec.world_body_mut(), scene, index);
        }
    }
    for (index, slot) in scene.fixtures.iter() {
        add_fixture(spec, index, &slot.value);
    }
    for (index, slot) in scene.joints.iter() {
        if let JointRecord::Rope(rope) = slot.value {
            add_rope(spec, index, &rope);
        }
    }
}

/// Adds a prop, and those that hang on it, to a body.
fn add_prop(parent: &mut MjsBody, scene: &Scene, index: usize) {
    let PropRecord { prop, hold, .. } = scene.props.at(index);
    let name = prop_name(index);
    let body = parent.add_body().with_name(&name);
    if let Some(hold) = hold {
        *body.pos_mut() = hold.position.to_array();
        *body.quat_mut() = wxyz(hold.rotation);
        add_joint(body, hold);
    } else {
        let joint = body.add_free_joint().with_name(&name);
        joint.damping_mut()[0] = DRAG * f64::from(prop.mass_kg);
    }
    let geom = body.add_geom().with_name(&name);
    shape(geom, &prop.solid, &name);
    geom.set_mass(prop.mass_kg.into());
    touch(geom, prop.friction);
    bounce(geom, prop);
    let children = scene
        .props
        .iter()
        .filter(|(_, slot)| slot.value.hold.as_ref().is_some_and(|hold| hold.parent == Some(index)));
    children.for_each(|(child, _)| add_prop(body, scene, child));
}

fn add_joint(body: &mut MjsBody, hold: &Hold) {
    let joint = body.add_joint();
    joint.set_type(match hold.kind {
        HoldKind::Hinge => MjtJoint::mjJNT_HINGE,
        HoldKind::Slide => MjtJoint::mjJNT_SLIDE,
        HoldKind::Ball => MjtJoint::mjJNT_BALL,
    });
    *joint.pos_mut() = hold.anchor.to_array();
    *joint.axis_mut() = hold.axis.to_array();
    joint.damping_mut()[0] = hold.damping;
    joint.set_limited(if hold.range.is_some() {
        MjtLimited::mjLIMITED_TRUE
    } else {
        MjtLimited::mjLIMITED_FALSE
    });
    *joint.range_mut() = hold.range.unwrap_or_default();
}

fn add_rope(spec: &mut MjSpec, index: usize, rope: &Rope) {
    let name = rope_name(index);
    let ends = ["a", "b"].map(|end| format!("{name}{end}"));
    for (end, (prop, point)) in ends.iter().zip(rope.props.iter().zip(&rope.points)) {
        let body = match prop {
            Some(prop) => spec.body_mut(&prop_name(*prop)).expect("props were added before"),
            None => spec.world_body_mut(),
        };
        *body.add_site().with_name(end).pos_mut() = point.to_array();
    }
    let tendon = spec.add_tendon().with_name(&name);
    for end in &ends {
        tendon.wrap_site(end);
    }
    tendon.set_limited(MjtLimited::mjLIMITED_TRUE);
    *tendon.range_mut() = [0.0, rope.length];
}

fn add_fixture(spec: &mut MjSpec, index: usize, fixture: &Fixture) {
    let name = fixture_name(index);
    let mut parts = 1;
    match &fixture.shape {
        FixtureShape::Solid(Solid::Hull { points }) => add_mesh(spec, &name, points),
        FixtureShape::Triangles { points, triangles } => {
            parts = triangles.len();
            for (part, corners) in triangles.iter().enumerate() {
                add_mesh(spec, &part_name(&name, part), &slab(corners.map(|i| points[i as usize])));
            }
        }
        FixtureShape::Heights { rows, columns, half_extents, heights } => {
            let (lowest, highest) = extent(heights);
            let field = spec.add_hfield().with_name(&name).with_size([
                half_extents.x.into(),
                half_extents.y.into(),
                f64::from(highest - lowest).max(1e-3),
                FIELD_BASE_M,
            ]);
            field.set_nrow(i32::try_from(*rows).expect("a checked number of rows"));
            field.set_ncol(i32::try_from(*columns).expect("a checked number of columns"));
            field.set_userdata(heights);
        }
        FixtureShape::Solid(_) => {}
    }
    let body = spec.world_body_mut().add_body().with_name(&name);
    *body.pos_mut() = fixture.position.as_dvec3().to_array();
    *body.quat_mut() = wxyz(fixture.rotation.as_dquat());
    for part in 0..parts {
        let geom = body.add_geom();
        match &fixture.shape {
            FixtureShape::Solid(solid) => shape(geom, solid, &name),
            FixtureShape::Triangles { .. } => {
                geom.set_type(MjtGeomBase::mjGEOM_MESH);
                geom.set_meshname(&part_name(&name, part));
            }
            FixtureShape::Heights { heights, .. } => {
                geom.set_type(MjtGeomBase::mjGEOM_HFIELD);
                geom.set_hfieldname(&name);
                geom.pos_mut()[2] = extent(heights).0.into();
            }
        }
        touch(geom, fixture.friction);
        geom.set_group(FIXTURE_GROUP as i32);
    }
}

fn part_name(fixture: &str, part: usize) -> String {
    format!("{fixture}t{part}")
}

fn extent(heights: &[f32]) -> (f32, f32) {
    let fold = |start, pick: fn(f32, f32) -> f32| heights.iter().copied().fold(start, pick);
    (fold(f32::INFINITY, f32::min), fold(f32::NEG_INFINITY, f32::max))
}

/// A triangle and its copy below.
fn slab(corners: [Vec3; 3]) -> [Vec3; 6] {
    let [a, b, c] = corners;
    let down = (b - a).cross(c - a).normalize_or_zero() * -TRIANGLE_DEPTH_M;
    [a, b, c, a + down, b + down, c + down]
}

fn add_mesh(spec: &mut MjSpec, name: &str, points: &[Vec3]) {
    let mesh = spec.add_mesh().with_name(name);
    let numbers: Vec<f32> = points.iter().flat_map(|point| point.to_array()).collect();
    mesh.set_uservert(&numbers);
    mesh.set_inertia(MjtMeshInertia::mjMESH_INERTIA_CONVEX);
}

fn shape(geom: &mut MjsGeom, solid: &Solid, mesh: &str) {
    let round = |radius: f32, half_length: f32| [radius.into(), half_length.into(), 0.0];
    let (kind, size) = match solid {
        Solid::Sphere { radius } => (MjtGeomBase::mjGEOM_SPHERE, round(*radius, 0.0)),
        Solid::Capsule { radius, half_length } => (MjtGeomBase::mjGEOM_CAPSULE, round(*radius, *half_length)),
        Solid::Cylinder { radius, half_length } => {
            (MjtGeomBase::mjGEOM_CYLINDER, round(*radius, *half_length))
        }
        Solid::Cuboid { half_extents } => (MjtGeomBase::mjGEOM_BOX, half_extents.as_dvec3().to_array()),
        Solid::Hull { .. } => {
            geom.set_meshname(mesh);
            (MjtGeomBase::mjGEOM_MESH, [0.0; 3])
        }
    };
    geom.set_type(kind);
    *geom.size_mut() = size;
}

fn touch(geom: &mut MjsGeom, friction: f32) {
    *geom.friction_mut() = [friction.into(), 0.005, 0.0001];
    geom.set_condim(3);
    geom.set_contype(EVERYTHING);
    geom.set_conaffinity(EVERYTHING);
}

/// A contact is a damped spring: what is left of the speed after half a swing follows from the damping ratio.
fn bounce(geom: &mut MjsGeom, prop: &Prop) {
    if prop.bounce > 0.0 {
        let loss = -f64::from(prop.bounce).ln();
        let ratio = loss / (std::f64::consts::PI.powi(2) + loss.powi(2)).sqrt();
        geom.set_priority(1);
        *geom.solref_mut() = [1.0 / (BOUNCE_RADPS * ratio), ratio];
        let mut impedance = *geom.solimp();
        (impedance[0], impedance[1]) = (0.98, 0.99);
        *geom.solimp_mut() = impedance;
    }
}

/// MuJoCo's order of a quaternion.
pub(super) fn wxyz(rotation: DQuat) -> [f64; 4] {
    let [x, y, z, w] = rotation.normalize().to_array();
    [w, x, y, z]
}

/// A quaternion in MuJoCo's order.
pub(super) fn quat([w, x, y, z]: [f64; 4]) -> DQuat {
    DQuat::from_xyzw(x, y, z, w)
}

/// A vector of MuJoCo's.
pub(super) fn vec3(v: [f64; 3]) -> DVec3 {
    DVec3::from(v)
}
