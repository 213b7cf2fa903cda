//! Uneven ground: hills, slopes and steps, in every gait.

use std::collections::BTreeMap;

use physics::ModelError;
use physics_bridge::Terrain;

use super::roam::{FallReport, roam};
use crate::Rig;
use crate::chosen::{Chosen, Named};

/// Places the hills.
const SEED: u32 = 7;

/// Grounds and their names. Slopes are long hills of 7 degrees in the root mean square.
const GROUNDS: [(&str, Terrain); 4] = [
    ("hills_35cm", Terrain::Wavy { height_m: 0.35, wavelength_m: 6.0, seed: SEED }),
    ("slopes_7deg", Terrain::Wavy { height_m: 1.92, wavelength_m: 20.0, seed: SEED }),
    ("steps_5cm", Terrain::Steps { rise_m: 0.05, run_m: 0.8, count: 6 }),
    ("steps_10cm", Terrain::Steps { rise_m: 0.10, run_m: 0.8, count: 6 }),
];

/// The uneven grounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroundList;

impl Named for GroundList {
    fn names() -> Vec<&'static str> {
        GROUNDS.map(|(name, _)| name).into()
    }
}

/// Some of the uneven grounds.
pub type Grounds = Chosen<GroundList>;

impl Grounds {
    /// Names and terrains.
    pub(super) fn terrains(self) -> impl Iterator<Item = (&'static str, Terrain)> {
        GROUNDS.into_iter().filter(move |(name, _)| self.contains(name))
    }
}

/// Falls by ground, and in it by gait.
///
/// # Errors
/// When the model can't be set on uneven ground.
pub fn measure_terrain(rig: &Rig<'_>) -> Result<BTreeMap<String, BTreeMap<String, FallReport>>, ModelError> {
    let seeds: Vec<u64> = (0..rig.effort.roamers as u64).collect();
    let secs = rig.effort.roam_secs;
    let mut grounds = BTreeMap::new();
    for (name, terrain) in rig.effort.grounds.terrains() {
        let model = rig.model.with_terrain(terrain)?;
        let measure = |gait: &_| {
            rig.each(&seeds, secs, |seed| roam(rig, &model, gait, |none, _, _| none, (secs, *seed)))
        };
        let gaits = rig.gaits();
        let falls = gaits.iter().map(|gait| (gait.name.into(), FallReport::of(&measure(gait), secs)));
        grounds.insert(name.into(), falls.collect());
    }
    Ok(grounds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use physics_bridge::Model;

    #[test]
    fn slopes_are_as_steep_as_their_name_says() {
        let humanoid = include_str!("../../../../assets/humanoid.xml");
        let model = Model::from_mjcf(humanoid).unwrap().with_terrain(GROUNDS[1].1).unwrap();
        let slope = |x: f32, y: f32| {
            let across = model.height_at(x + 0.5, y) - model.height_at(x - 0.5, y);
            let along = model.height_at(x, y + 0.5) - model.height_at(x, y - 0.5);
            across * across + along * along
        };
        let squares: f32 = (0..3600).map(|i| slope((i % 60) as f32 - 30.0, (i / 60) as f32 - 30.0)).sum();
        let degrees = (squares / 3600.0).sqrt().atan().to_degrees();
        assert!((6.5..7.5).contains(&degrees), "{degrees}");
    }
}
