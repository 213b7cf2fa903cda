//! Rays: what is seen along a line, and how high the ground is below a point.

use glam::Vec3;
use mujoco_rs::wrappers::fun::utility::mju_ray_geom;
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::{MjModel, MjtGeomBase};
use policy_core::contract::{MAX_DISTANCE_M, within};

use super::World;
use super::contact::{Part, part};
use super::forces::Movable;
use super::places::{Owner, Places};
use super::scene::Scene;
use super::solids::vec3;
use crate::description::model::Model;
use crate::description::world_error::WorldError;

/// What a ray meets first. World space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// What it meets.
    pub part: Part,
    /// Metres from the origin of the ray.
    pub distance: f32,
    /// Where, metres.
    pub position: Vec3,
    /// Out of the surface, a unit vector.
    pub normal: Vec3,
}

impl World {
    /// What a ray from `origin`, metres, along `direction`, of any length but zero, meets within `most` metres. Sees
    /// through `except` and through what it starts in. Does not allocate.
    ///
    /// # Errors
    /// When a number is out of its range, or the handle of `except` is stale.
    pub fn ray(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        most: f32,
        except: Option<Movable>,
    ) -> Result<Option<RayHit>, WorldError> {
        const WHAT: &str = "a ray";
        within(WHAT, "origin", origin.length(), [0.0, MAX_DISTANCE_M])?;
        within(WHAT, "length of the direction", direction.length(), [1e-6, 1e6])?;
        within(WHAT, "most", most, [0.0, 3.0 * MAX_DISTANCE_M])?;
        let except = except.map(|what| self.body_of(what)).transpose()?;
        let direction = direction.normalize();
        let (from, along) = (origin.as_dvec3().to_array(), direction.as_dvec3().normalize().to_array());
        let mut normal = [0.0; 3];
        let (geom, distance) = self.data.ray(&from, &along, None, true, except, Some(&mut normal));
        let Some(geom) = geom.filter(|_| (0.0..=f64::from(most)).contains(&distance)) else {
            return Ok(None);
        };
        let body = self.data.model().geom_bodyid()[geom] as usize;
        let owner = self.places.owners[body];
        // What was taken out lies far below everything, until the next build.
        if matches!(owner, Owner::Prop(_) | Owner::Character(..)) && !self.is_present(owner) {
            return Ok(None);
        }
        let distance = distance as f32;
        Ok(Some(RayHit {
            part: part(owner, &self.scene),
            distance,
            position: origin + direction * distance,
            normal: vec3(normal).as_vec3(),
        }))
    }

    /// Height of the ground at a point: of the plane, the terrain, and the highest fixture below `z`. Metres.
    pub fn height_below(&mut self, x: f32, y: f32, z: f32) -> f32 {
        height_below(&mut self.data, &self.places, &self.ground, [x, y, z])
    }
}

/// As [`World::height_below`], and of the props that reach no higher than `top`: what a character can step onto.
pub(super) fn footing_below(
    data: &mut MjData<Box<MjModel>>,
    (places, scene): (&Places, &Scene),
    ground: &Model,
    at: [f32; 3],
    top: f32,
) -> f32 {
    let mut height = height_below(data, places, ground, at);
    let from = at.map(f64::from);
    for (index, _) in scene.props.present() {
        let prop = places.prop(index);
        let [x, y, z] = data.xpos()[prop.body];
        // Most props are elsewhere.
        let [aside, ahead] = [from[0] - x, from[1] - y];
        if aside * aside + ahead * ahead > prop.reach * prop.reach || z - prop.reach > f64::from(top) {
            continue;
        }
        let above = [from[0], from[1], z + 2.0 * prop.reach];
        for geom in prop.geoms.clone() {
            let distance = down(data, geom, &above);
            let surface = (above[2] - distance) as f32;
            if distance >= 0.0 && surface <= top {
                height = height.max(surface);
            }
        }
    }
    height
}

/// As [`World::height_below`].
pub(super) fn height_below(
    data: &mut MjData<Box<MjModel>>,
    places: &Places,
    ground: &Model,
    [x, y, z]: [f32; 3],
) -> f32 {
    let mut height = ground.height_at(x, y);
    let from = [x, y, z].map(f64::from);
    for fixture in places.fixtures.iter().flatten() {
        let ([cx, cy], radius) = fixture.circle;
        if (from[0] - cx).hypot(from[1] - cy) > radius {
            continue;
        }
        for geom in fixture.geoms.clone() {
            let distance = down(data, geom, &from);
            if distance >= 0.0 {
                height = height.max((from[2] - distance) as f32);
            }
        }
    }
    height
}

/// How far below a point a geom is; negative when it is not below.
fn down(data: &mut MjData<Box<MjModel>>, geom: usize, from: &[f64; 3]) -> f64 {
    const DOWN: [f64; 3] = [0.0, 0.0, -1.0];
    let kind = data.model().geom_type()[geom];
    match kind {
        MjtGeomBase::mjGEOM_MESH => data.ray_mesh(geom, from, &DOWN, None),
        MjtGeomBase::mjGEOM_HFIELD => data.ray_hfield(geom, from, &DOWN, None),
        _ => {
            let (at, turned) = (&data.geom_xpos()[geom], &data.geom_xmat()[geom]);
            mju_ray_geom(at, turned, &data.model().geom_size()[geom], from, &DOWN, kind, None)
        }
    }
}
