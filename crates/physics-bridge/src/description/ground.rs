//! How high the ground is, as the compiled model has it: what is walked on, not what was asked for.

use mujoco_rs::wrappers::mj_model::{MjModel, MjtGeomBase, MjtObjBase};
use policy_core::contract::HeightField;

use super::mjcf::{FLOOR, HEIGHT_FIELD};
use super::model_error::ModelError;

/// Ground of a model: an endless plane and, on some terrains, a height field above it.
#[derive(Debug)]
pub(crate) struct Ground {
    plane_height: f32,
    pub field: Option<HeightField>,
}

impl Ground {
    pub(crate) fn of(model: &MjModel) -> Result<Self, ModelError> {
        let floor = model
            .name_to_id(MjtObjBase::mjOBJ_GEOM, FLOOR)
            .ok_or_else(|| ModelError::Missing { kind: "geom", name: FLOOR.into() })?;
        // MuJoCo has compiled the model: what it says of its parts are indices of its own arrays.
        let is_level = model.geom_type()[floor] == MjtGeomBase::mjGEOM_PLANE
            && model.geom_bodyid()[floor] == 0
            && model.geom_quat()[floor] == [1.0, 0.0, 0.0, 0.0];
        if !is_level {
            return Err(ModelError::Kind { kind: "geom", name: FLOOR.into(), expected: "a level plane" });
        }
        let field =
            model.name_to_id(MjtObjBase::mjOBJ_GEOM, HEIGHT_FIELD).map(|geom| height_field(model, geom));
        Ok(Self { plane_height: model.geom_pos()[floor][2] as f32, field })
    }

    pub(crate) fn height_at(&self, x: f32, y: f32) -> f32 {
        let above = self.field.as_ref().and_then(|field| field.height_at(x, y));
        above.map_or(self.plane_height, |height| height.max(self.plane_height))
    }
}

/// Reads back the height field of a geom that this crate made.
fn height_field(model: &MjModel, geom: usize) -> HeightField {
    let field = model.geom_dataid()[geom] as usize;
    let (rows, columns) = (model.hfield_nrow()[field] as usize, model.hfield_ncol()[field] as usize);
    let [half_x, half_y, scale, _] = model.hfield_size()[field];
    let first = model.hfield_adr()[field] as usize;
    let base = model.geom_pos()[geom][2];
    let heights = &model.hfield_data()[first..first + rows * columns];
    let heights: Vec<f32> = heights.iter().map(|&h| (base + f64::from(h) * scale) as f32).collect();
    HeightField::from_heights([rows, columns], [half_x as f32, half_y as f32], heights)
        .expect("MuJoCo has compiled the field, and this crate made it")
}

#[cfg(test)]
mod tests {
    use crate::{Character, Model, Terrain};

    const HUMANOID: &str = include_str!("../../../../assets/humanoid.xml");

    fn on(terrain: Terrain) -> Model {
        Model::from_mjcf(HUMANOID).unwrap().with_terrain(terrain).unwrap()
    }

    fn terrains() -> [Model; 3] {
        [
            on(Terrain::Wavy { height_m: 0.7, wavelength_m: 3.0, seed: 3 }),
            on(Terrain::Wavy { height_m: 0.1, wavelength_m: 20.0, seed: 4 }),
            on(Terrain::Steps { rise_m: 0.15, run_m: 0.7, count: 4 }),
        ]
    }

    /// Points spread over and beyond the terrain.
    fn points() -> impl Iterator<Item = (f32, f32)> {
        (0..2000_u16).map(|i| {
            let spread = |step: f32| (f32::from(i) * step).fract() * 90.0 - 45.0;
            (spread(0.618_034), spread(0.754_878))
        })
    }

    #[test]
    fn heights_are_where_mujocos_rays_meet_the_ground() {
        for model in terrains() {
            let mut data = model.new_data();
            data.qpos_mut()[2] = 500.0; // out of the way
            data.step1();
            for (x, y) in points() {
                let (_, distance) =
                    data.ray(&[x.into(), y.into(), 100.0], &[0.0, 0.0, -1.0], None, true, None, None);
                let (found, expected) = (model.height_at(x, y), 100.0 - distance as f32);
                assert!((found - expected).abs() < 2e-4, "{found} at {x}, {y}; the ray says {expected}");
            }
        }
    }

    #[test]
    fn grid_points_have_their_height() {
        for model in terrains() {
            let field = model.height_field().unwrap();
            let (rows, columns) = (field.rows(), field.columns());
            assert_eq!(field.heights().len(), rows * columns);
            for i in 0..500 {
                let point = field.point(i * 31 % rows, i * 17 % columns);
                assert!((model.height_at(point.x, point.y) - point.z).abs() < 1e-3, "{point}");
            }
        }
    }

    #[test]
    fn flat_ground_is_the_plane_everywhere() {
        let model = Model::from_mjcf(HUMANOID).unwrap();
        assert!(model.height_field().is_none());
        assert!(points().all(|(x, y)| model.height_at(x, y) == 0.0));
        assert_eq!(model.height_at(f32::NAN, 0.0), 0.0);
        let hills = &terrains()[0];
        assert_eq!(hills.height_at(f32::NAN, 0.0), hills.height_at(1e9, 1e9));
    }

    #[test]
    fn feet_meet_the_terrain_where_it_is() {
        for model in terrains() {
            let mut character = Character::new(&model);
            for (x, y) in [(0.0, 0.0), (3.3, -8.1), (-20.0, 11.5), (60.0, 0.0)] {
                character.stand_at(x, y, policy_core::Heading::FORWARD, 0.0).unwrap();
                assert!(character.clearance().abs() < 1e-4);
                (0..6).for_each(|_| character.step().unwrap());
                assert!(!character.contacts().is_empty(), "touches nothing at {x}, {y}");
                for contact in character.contacts() {
                    let below = model.height_at(contact.position.x, contact.position.y);
                    let off = (contact.position.z - below) * contact.normal.z;
                    assert!(off.abs() < 0.03, "touches {off} m off the ground at {}", contact.position);
                }
                let mut state = policy_core::CharacterState::new(model.skeleton());
                character.sense_into(&mut state);
                let root = state.root().position;
                assert_eq!(state.ground_height, model.height_at(root.x, root.y));
            }
        }
    }
}
