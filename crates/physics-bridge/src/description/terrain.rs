//! The shapes of ground that a character can be set on, as functions of the place.
//! Refuses what a foot can't meet sensibly: numbers outside the stated ranges.

use serde::{Deserialize, Serialize};

use super::model_error::ModelError;

/// The ground. Anything but [`Terrain::Flat`] is a square height field of 80 m about the origin. Its lowest point is
/// at z = 0, and it comes down to that height at its rim. An endless plane lies 0.1 m below it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
#[non_exhaustive]
pub enum Terrain {
    /// The plane of the MJCF.
    #[default]
    Flat,
    /// Smooth hills.
    Wavy {
        /// Height of the highest hill that can be, metres, in [0.01, 2].
        height_m: f32,
        /// From crest to crest, metres, in [1, 40].
        wavelength_m: f32,
        /// Places the hills.
        seed: u32,
    },
    /// Square terraces about the origin, like flights of stairs up and down again.
    Steps {
        /// Height of a step, metres, in [0.01, 0.5].
        rise_m: f32,
        /// Depth of a step, metres, in [0.2, 10].
        run_m: f32,
        /// Steps up before the steps down, in [1, 100].
        count: u32,
    },
}

/// Half the side of a height field, metres.
pub(crate) const HALF_EXTENT: f64 = 40.0;

/// How far the endless plane lies below a height field, metres: far enough that nothing touches both.
pub(crate) const PLANE_DROP: f64 = 0.1;

/// Over this distance from its rim, metres, hills flatten out.
const RIM: f64 = 3.0;

/// A square grid of heights, row by row: x grows along a row, y from row to row.
pub(crate) struct Grid {
    /// Points in a row, and rows.
    pub side: usize,
    /// Metres, the lowest exactly 0.
    pub heights: Vec<f32>,
    /// The greatest of them.
    pub highest: f32,
}

impl Terrain {
    /// Checks every number against its range.
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        match *self {
            Terrain::Flat => Ok(()),
            Terrain::Wavy { height_m, wavelength_m, .. } => {
                within("height_m", height_m, 0.01, 2.0)?;
                within("wavelength_m", wavelength_m, 1.0, 40.0)
            }
            Terrain::Steps { rise_m, run_m, count } => {
                within("rise_m", rise_m, 0.01, 0.5)?;
                within("run_m", run_m, 0.2, 10.0)?;
                within("count", count as f32, 1.0, 100.0)
            }
        }
    }

    /// Heights on a grid fine enough for the shape; `None` for flat ground.
    pub(crate) fn grid(&self) -> Option<Grid> {
        let (cell, height): (f64, Box<dyn Fn(f64, f64) -> f64>) = match *self {
            Terrain::Flat => return None,
            Terrain::Wavy { height_m, wavelength_m, seed } => {
                let waves = waves(wavelength_m.into(), seed);
                let height = move |x: f64, y: f64| f64::from(height_m) * hills(&waves, x, y);
                ((f64::from(wavelength_m) / 16.0).clamp(0.1, 0.5), Box::new(height))
            }
            Terrain::Steps { rise_m, run_m, count } => {
                let level = move |x: f64, y: f64| terrace(x.abs().max(y.abs()), run_m.into(), count);
                (0.1, Box::new(move |x, y| f64::from(rise_m) * level(x, y)))
            }
        };
        let intervals = (2.0 * HALF_EXTENT / cell).round() as usize;
        let coordinate = |i: usize| HALF_EXTENT * (2.0 * i as f64 / intervals as f64 - 1.0);
        let side = intervals + 1;
        let mut heights: Vec<f32> =
            (0..side * side).map(|i| height(coordinate(i % side), coordinate(i / side)) as f32).collect();
        let lowest = heights.iter().copied().fold(f32::INFINITY, f32::min);
        heights.iter_mut().for_each(|h| *h -= lowest);
        let highest = heights.iter().copied().fold(0.0, f32::max);
        Some(Grid { side, heights, highest })
    }
}

fn within(field: &'static str, found: f32, least: f32, most: f32) -> Result<(), ModelError> {
    if (least..=most).contains(&found) {
        Ok(())
    } else {
        Err(ModelError::Terrain { field, least, most, found })
    }
}

/// A travelling direction and phase: height is the mean of their sines.
type Wave = [f64; 3];

/// Three plane waves, 60 degrees apart, turned and shifted by `seed`.
fn waves(wavelength: f64, seed: u32) -> [Wave; 3] {
    let wave_number = std::f64::consts::TAU / wavelength;
    // Multiples of the golden ratio spread evenly, so nearby seeds differ much.
    let spread = |k: u32| (f64::from(seed) * 4.0 + f64::from(k)) * 0.618_033_988_749_894_9 % 1.0;
    [0, 1, 2].map(|k| {
        let angle = std::f64::consts::TAU * (spread(0) + f64::from(k) / 6.0);
        let phase = std::f64::consts::TAU * spread(k + 1);
        [wave_number * angle.cos(), wave_number * angle.sin(), phase]
    })
}

/// Height in [0, 1], level towards the rim.
fn hills(waves: &[Wave; 3], x: f64, y: f64) -> f64 {
    let sum: f64 = waves.iter().map(|[kx, ky, phase]| (kx * x + ky * y + phase).sin()).sum();
    let inwards = ((HALF_EXTENT - x.abs().max(y.abs())) / RIM).clamp(0.0, 1.0);
    (0.5 + sum / 6.0) * inwards * inwards * (3.0 - 2.0 * inwards)
}

/// Steps above the lowest at a distance from the middle, counting down to 0 at the rim.
fn terrace(distance: f64, run: f64, count: u32) -> f64 {
    let step = ((distance + 1e-6) / run).floor();
    let to_the_rim = ((HALF_EXTENT - distance + 1e-6) / run).floor();
    let within_flight = step % f64::from(2 * count);
    within_flight.min(f64::from(2 * count) - within_flight).min(to_the_rim)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HILLS: Terrain = Terrain::Wavy { height_m: 0.3, wavelength_m: 4.0, seed: 7 };
    const STAIRS: Terrain = Terrain::Steps { rise_m: 0.1, run_m: 1.0, count: 3 };

    fn rim_is_level(grid: &Grid) -> bool {
        (0..grid.side).all(|i| {
            let last = grid.side - 1;
            [(0, i), (last, i), (i, 0), (i, last)]
                .iter()
                .all(|&(r, c)| grid.heights[r * grid.side + c] == 0.0)
        })
    }

    #[test]
    fn hills_stay_in_range_and_end_level() {
        let grid = HILLS.grid().unwrap();
        assert!(grid.heights.iter().all(|h| (0.0..=0.3).contains(h)));
        assert!(grid.highest > 0.2, "highest {}", grid.highest);
        assert!(rim_is_level(&grid));
        assert_ne!(
            grid.heights,
            Terrain::Wavy { height_m: 0.3, wavelength_m: 4.0, seed: 8 }.grid().unwrap().heights
        );
    }

    #[test]
    fn stairs_go_up_and_down() {
        let levels: Vec<f64> = (0..9).map(|i| terrace(f64::from(i) + 0.5, 1.0, 3)).collect();
        assert_eq!(levels, [0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0, 1.0, 2.0]);
        let grid = STAIRS.grid().unwrap();
        assert!((grid.highest - 0.3).abs() < 1e-6);
        assert!(rim_is_level(&grid));
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let error = Terrain::Wavy { height_m: f32::NAN, wavelength_m: 4.0, seed: 0 }.check().unwrap_err();
        assert!(error.to_string().contains("height_m"), "{error}");
        let error = Terrain::Steps { rise_m: 0.1, run_m: 1.0, count: 0 }.check().unwrap_err();
        assert!(error.to_string().contains("count"), "{error}");
    }
}
