//! The collision shapes of the bodies: to draw a character without a mesh, and to find its lowest point.

use glam::{DMat3, DVec3, Quat, Vec3};
use mujoco_rs::wrappers::mj_model::{MjModel, MjtGeomBase};
use policy_core::BodyId;

use super::body_poses::rotation;
use super::layout::Layout;

/// A primitive fixed to a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// The body that it moves with.
    pub body: BodyId,
    /// Its centre in the body frame, metres.
    pub position: Vec3,
    /// `body_from_shape`, a unit quaternion.
    pub rotation: Quat,
    /// What it is.
    pub kind: ShapeKind,
}

/// Kind and size of a [`Shape`], metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ShapeKind {
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f32,
    },
    /// A cylinder along z with round ends.
    Capsule {
        /// Its radius.
        radius: f32,
        /// Half its length between the centres of the ends.
        half_length: f32,
    },
    /// A cuboid.
    Cuboid {
        /// Half its sides.
        half_extents: Vec3,
    },
}

/// Every sphere, capsule and box of the bodies, each with MuJoCo's id of it; other geoms are left out.
pub(crate) fn shapes(model: &MjModel, layout: &Layout) -> (Box<[Shape]>, Box<[usize]>) {
    let shape = |geom: usize| {
        // MuJoCo has compiled the model: what it says of its parts are indices of its own arrays.
        let body = layout.bodies[model.geom_bodyid()[geom] as usize]?;
        let size = model.geom_size()[geom].map(|s| s as f32);
        let kind = match model.geom_type()[geom] {
            MjtGeomBase::mjGEOM_SPHERE => ShapeKind::Sphere { radius: size[0] },
            MjtGeomBase::mjGEOM_CAPSULE => ShapeKind::Capsule { radius: size[0], half_length: size[1] },
            MjtGeomBase::mjGEOM_BOX => ShapeKind::Cuboid { half_extents: Vec3::from(size) },
            _ => return None,
        };
        let position = DVec3::from(model.geom_pos()[geom]).as_vec3();
        let rotation = rotation(model.geom_quat()[geom]);
        Some((Shape { body, position, rotation, kind }, geom))
    };
    let found: Vec<_> = (0..model.ngeom() as usize).filter_map(shape).collect();
    (found.iter().map(|f| f.0).collect(), found.iter().map(|f| f.1).collect())
}

impl ShapeKind {
    /// Calls `visit` with each point, world space, that can be the lowest, and how far below it the surface is.
    pub(crate) fn low_points(
        &self,
        centre: DVec3,
        world_from_shape: DMat3,
        mut visit: impl FnMut(DVec3, f64),
    ) {
        match *self {
            ShapeKind::Sphere { radius } => visit(centre, radius.into()),
            ShapeKind::Capsule { radius, half_length } => {
                let axis = world_from_shape.z_axis * f64::from(half_length);
                visit(centre + axis, radius.into());
                visit(centre - axis, radius.into());
            }
            ShapeKind::Cuboid { half_extents } => {
                for corner in 0..8 {
                    let sign = |axis: u32| if corner >> axis & 1 == 0 { 1.0 } else { -1.0 };
                    let signs = DVec3::new(sign(0), sign(1), sign(2));
                    visit(centre + world_from_shape * (half_extents.as_dvec3() * signs), 0.0);
                }
            }
        }
    }
}
