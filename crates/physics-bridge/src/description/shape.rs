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

/// Corners around a geom that is no [`Shape`], to find the lowest point of a character: those of a mesh, or of the box
/// around a cylinder or an ellipsoid.
#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    /// The body that it moves with.
    pub body: BodyId,
    /// MuJoCo's id of it.
    pub geom: usize,
    /// In the frame of the geom, metres.
    corners: Box<[DVec3]>,
}

/// The bounds of all other geoms of the bodies that can touch something; of all others when nothing can.
pub(crate) fn bounds(model: &MjModel, layout: &Layout, shapes: &[Shape]) -> Box<[Bounds]> {
    let is_shape = |geom: usize| {
        matches!(
            model.geom_type()[geom],
            MjtGeomBase::mjGEOM_SPHERE | MjtGeomBase::mjGEOM_CAPSULE | MjtGeomBase::mjGEOM_BOX
        )
    };
    let of = |geom: usize| {
        let body = layout.bodies[model.geom_bodyid()[geom] as usize]?;
        Some(Bounds { body, geom, corners: corners(model, geom) })
    };
    let touches =
        |bounds: &Bounds| model.geom_contype()[bounds.geom] | model.geom_conaffinity()[bounds.geom] != 0;
    let all: Vec<_> = (0..model.ngeom() as usize).filter(|&geom| !is_shape(geom)).filter_map(of).collect();
    let solid: Vec<_> = all.iter().filter(|bounds| touches(bounds)).cloned().collect();
    if solid.is_empty() && shapes.is_empty() { all.into() } else { solid.into() }
}

fn corners(model: &MjModel, geom: usize) -> Box<[DVec3]> {
    if model.geom_type()[geom] == MjtGeomBase::mjGEOM_MESH {
        // MuJoCo has compiled the model: a geom that is a mesh has one.
        let mesh = model.geom_dataid()[geom] as usize;
        let first = model.mesh_vertadr()[mesh] as usize;
        let vertices = &model.mesh_vert()[first..][..model.mesh_vertnum()[mesh] as usize];
        return vertices.iter().map(|&vertex| Vec3::from(vertex).as_dvec3()).collect();
    }
    let [x, y, z, half_x, half_y, half_z] = model.geom_aabb()[geom];
    let (centre, half_extents) = (DVec3::new(x, y, z), DVec3::new(half_x, half_y, half_z));
    corner_signs().map(|signs| centre + half_extents * signs).collect()
}

/// The signs of the coordinates of the corners of a box about the origin.
fn corner_signs() -> impl Iterator<Item = DVec3> {
    let sign = |corner: u32, axis: u32| if corner >> axis & 1 == 0 { 1.0 } else { -1.0 };
    (0..8).map(move |corner| DVec3::new(sign(corner, 0), sign(corner, 1), sign(corner, 2)))
}

impl Bounds {
    /// Calls `visit` with each corner, world space, of a geom at `centre`.
    pub(crate) fn low_points(
        &self,
        centre: DVec3,
        world_from_geom: DMat3,
        mut visit: impl FnMut(DVec3, f64),
    ) {
        self.corners.iter().for_each(|&corner| visit(centre + world_from_geom * corner, 0.0));
    }
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
                for signs in corner_signs() {
                    visit(centre + world_from_shape * (half_extents.as_dvec3() * signs), 0.0);
                }
            }
        }
    }
}
