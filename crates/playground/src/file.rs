//! Reads a scene from RON and checks it. Lengths are metres, angles degrees, sizes whole and not halved.

use glam::{EulerRot, Quat, Vec2, Vec3};
use policy_core::contract::{Fixture, Joint, Prop, Solid};
use ron::extensions::Extensions;
use serde::Deserialize;

use super::layout::Blocks;
use super::{Checkpoint, Pace, Paint, PaintedFixture, PlacedProp, Playground, Start, Swinging, Waypoint};

/// Largest text of a scene, bytes.
const MOST_BYTES: usize = 1 << 20;
/// Most things of each kind.
const MOST_THINGS: usize = 512;
/// Farthest that anything may be from the origin, metres.
const FARTHEST_M: f32 = 500.0;
/// Most characters of a scene.
const MOST_STARTS: usize = 16;

/// Why a text is no scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneFileError {
    /// Too long.
    #[error("expected a scene of at most {MOST_BYTES} bytes, found {found}")]
    Long {
        /// Bytes.
        found: usize,
    },
    /// No RON, or not the fields of a scene.
    #[error("expected a scene in RON, found: {0}")]
    Ron(#[from] ron::error::SpannedError),
    /// Too many or too few of something.
    #[error("expected {least} to {most} {what}, found {found}")]
    Count {
        /// Of what.
        what: &'static str,
        /// Least.
        least: usize,
        /// Most.
        most: usize,
        /// In the file.
        found: usize,
    },
    /// A number that is out of its range.
    #[error("expected {what} of {least} to {most}, found {found}")]
    Range {
        /// Which number.
        what: &'static str,
        /// Least.
        least: f32,
        /// Greatest.
        most: f32,
        /// In the file.
        found: f32,
    },
    /// Two props of one name.
    #[error("expected names that differ, found {name:?} twice")]
    SameName {
        /// The name.
        name: String,
    },
    /// A prop of the way that is not there, or does not swing.
    #[error("expected the name of a prop that swings, for the way to lead past it, found {name:?}")]
    Swing {
        /// The name.
        name: String,
    },
    /// A place outside the area of the scene.
    #[error("expected {what} within the area, found one at {at}")]
    Outside {
        /// Of what.
        what: &'static str,
        /// Where.
        at: Vec2,
    },
}

/// Numbers as a file has them.
type Pair = [f32; 2];
type Triple = [f32; 3];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    name: String,
    area: (Pair, Pair),
    characters: Vec<StartEntry>,
    fixtures: Vec<FixtureEntry>,
    props: Vec<PropEntry>,
    checkpoints: Vec<CheckpointEntry>,
    #[serde(default)]
    way: Vec<WaypointEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StartEntry {
    at: Pair,
    #[serde(default)]
    heading: f32,
    #[serde(default)]
    zone: Option<(Pair, Pair)>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CheckpointEntry {
    at: Pair,
    radius: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WaypointEntry {
    at: Pair,
    near: f32,
    #[serde(default)]
    pace: Pace,
    #[serde(default)]
    past: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
enum FixtureEntry {
    /// A cuboid about `at`.
    Block {
        at: Triple,
        size: Triple,
        #[serde(default)]
        yaw: f32,
        paint: Paint,
    },
    /// Steps up from the foot `at` along `yaw`.
    Stairs { at: Triple, yaw: f32, width: f32, steps: usize, riser: f32, run: f32, paint: Paint },
    /// A slope up from the foot `at` along `yaw`.
    Ramp { at: Triple, yaw: f32, width: f32, length: f32, riser: f32, paint: Paint },
    /// A cylinder about `at`, upright or along `yaw` when it lies.
    Pole {
        at: Triple,
        radius: f32,
        length: f32,
        #[serde(default)]
        lies_along: Option<f32>,
        paint: Paint,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
enum ShapeEntry {
    Box(Triple),
    Ball(f32),
    Capsule { radius: f32, length: f32 },
    Cylinder { radius: f32, length: f32 },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
enum JointEntry {
    Hinge { anchor: Triple, axis: Triple, range: Option<(f32, f32)>, damping: f32 },
    Ball { anchor: Triple, damping: f32 },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PropEntry {
    name: String,
    shape: ShapeEntry,
    mass: f32,
    at: Triple,
    #[serde(default)]
    yaw: f32,
    #[serde(default)]
    pitch: f32,
    #[serde(default)]
    friction: Option<f32>,
    #[serde(default)]
    bounce: f32,
    paint: Paint,
    #[serde(default)]
    joint: Option<JointEntry>,
    #[serde(default)]
    swing: Option<f32>,
}

impl Playground {
    /// Reads a scene.
    ///
    /// # Errors
    /// When the text is no RON of a scene, or a number or count in it is out of its range. What only the physics
    /// can tell, such as a joint that closes a loop, is found when the scene is built.
    pub fn from_ron(text: &str) -> Result<Self, SceneFileError> {
        if text.len() > MOST_BYTES {
            return Err(SceneFileError::Long { found: text.len() });
        }
        let options = ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME);
        let file: SceneFile = options.from_str(text)?;
        count("characters", [1, MOST_STARTS], file.characters.len())?;
        count("checkpoints", [2, 64], file.checkpoints.len())?;
        count("fixtures", [0, MOST_THINGS], file.fixtures.len())?;
        count("props", [0, MOST_THINGS], file.props.len())?;
        let area = rectangle("an area", file.area)?;
        let within = |what, at: Pair| {
            let at = Vec2::from(at);
            let inside = at.cmpge(area[0]).all() && at.cmple(area[1]).all();
            if inside { Ok(at) } else { Err(SceneFileError::Outside { what, at }) }
        };
        let mut starts = Vec::new();
        for StartEntry { at, heading, zone } in file.characters {
            let zone = zone.map_or(Ok(area), |zone| rectangle("a zone", zone))?;
            let heading = range("a heading, degrees,", [-360.0, 360.0], heading)?.to_radians();
            starts.push(Start { at: within("a start", at)?, heading, zone });
        }
        let mut checkpoints = Vec::new();
        for CheckpointEntry { at, radius } in file.checkpoints {
            let radius = range("the radius of a checkpoint", [0.1, 10.0], radius)?;
            checkpoints.push(Checkpoint { at: within("a checkpoint", at)?, radius });
        }
        let mut blocks = Blocks::default();
        file.fixtures.into_iter().try_for_each(|fixture| fixture.add_to(&mut blocks))?;
        count("blocks", [0, MOST_THINGS], blocks.0.len())?;
        let mut props: Vec<PlacedProp> = Vec::new();
        for entry in file.props {
            let prop = entry.placed()?;
            if props.iter().any(|other| other.name == prop.name) {
                return Err(SceneFileError::SameName { name: prop.name });
            }
            props.push(prop);
        }
        count("points of the way", [0, MOST_THINGS], file.way.len())?;
        let mut way = Vec::new();
        for WaypointEntry { at, near, pace, past } in file.way {
            let past = past.map(|name| swinging(&props, name)).transpose()?;
            let near_m = range("the reach of a point of the way", [0.1, 10.0], near)?;
            way.push(Waypoint { at: within("a point of the way", at)?, near_m, pace, past });
        }
        Ok(Self { name: file.name, area, starts, fixtures: blocks.0, props, checkpoints, way })
    }
}

impl FixtureEntry {
    fn add_to(self, blocks: &mut Blocks) -> Result<(), SceneFileError> {
        match self {
            Self::Block { at, size, yaw, paint } => {
                blocks.cuboid(place(at)?, extents(size)?, turn(yaw)?, paint);
            }
            Self::Stairs { at, yaw, width, steps, riser, run, paint } => {
                count("steps", [1, 64], steps)?;
                let size = extents([run, width, riser])?;
                blocks.stairs((place(at)?, turn(yaw)?), steps, size, paint);
            }
            Self::Ramp { at, yaw, width, length, riser, paint } => {
                let size = extents([length, width, riser])?;
                blocks.ramp((place(at)?, turn(yaw)?), size, paint);
            }
            Self::Pole { at, radius, length, lies_along, paint } => {
                let solid = Solid::Cylinder { radius: size(radius)?, half_length: 0.5 * size(length)? };
                let rotation = match lies_along {
                    Some(yaw) => turn(yaw)? * Quat::from_rotation_y(std::f32::consts::FRAC_PI_2),
                    None => Quat::IDENTITY,
                };
                let fixture = Fixture { rotation, ..Fixture::new(solid, place(at)?) };
                blocks.0.push(PaintedFixture { fixture, paint });
            }
        }
        Ok(())
    }
}

impl PropEntry {
    fn placed(self) -> Result<PlacedProp, SceneFileError> {
        let half = |length: f32| size(length).map(|length| 0.5 * length);
        let solid = match self.shape {
            ShapeEntry::Box(whole) => Solid::Cuboid { half_extents: 0.5 * extents(whole)? },
            ShapeEntry::Ball(radius) => Solid::Sphere { radius: size(radius)? },
            ShapeEntry::Capsule { radius, length } => {
                Solid::Capsule { radius: size(radius)?, half_length: half(length)? }
            }
            ShapeEntry::Cylinder { radius, length } => {
                Solid::Cylinder { radius: size(radius)?, half_length: half(length)? }
            }
        };
        let mass_kg = range("a mass, kg,", [0.05, 1000.0], self.mass)?;
        let bounce = range("a bounce", [0.0, 0.95], self.bounce)?;
        let friction = range("a friction", [0.0, 5.0], self.friction.unwrap_or(0.8))?;
        let pitch = range("a pitch, degrees,", [-180.0, 180.0], self.pitch)?.to_radians();
        Ok(PlacedProp {
            name: self.name,
            prop: Prop { friction, bounce, ..Prop::new(solid, mass_kg) },
            position: place(self.at)?,
            // Pitch turns the front down.
            rotation: turn(self.yaw)? * Quat::from_euler(EulerRot::ZYX, 0.0, pitch, 0.0),
            paint: self.paint,
            joint: self.joint.map(JointEntry::joint).transpose()?,
            swing_m: self.swing.map(|height| range("a swing", [0.05, 10.0], height)).transpose()?,
        })
    }
}

impl JointEntry {
    fn joint(self) -> Result<Joint, SceneFileError> {
        let damped = |damping| range("a damping", [0.0, 1000.0], damping);
        Ok(match self {
            Self::Hinge { anchor, axis, range: limits, damping } => {
                let angle = |degrees: f32| range("an angle, degrees,", [-360.0, 360.0], degrees);
                let limits = match limits {
                    Some((low, high)) => Some([angle(low)?.to_radians(), angle(high)?.to_radians()]),
                    None => None,
                };
                Joint::Hinge {
                    anchor: place(anchor)?,
                    axis: axis.into(),
                    range: limits,
                    damping: damped(damping)?,
                }
            }
            Self::Ball { anchor, damping } => {
                Joint::Ball { anchor: place(anchor)?, damping: damped(damping)? }
            }
        })
    }
}

/// The index of the prop of that name that swings.
fn swinging(props: &[PlacedProp], name: String) -> Result<Swinging, SceneFileError> {
    let found = props.iter().enumerate().find(|(_, prop)| prop.name == name);
    let swings = found.and_then(|(prop, placed)| Some(Swinging { prop, radps: placed.swing_radps()? }));
    swings.ok_or(SceneFileError::Swing { name })
}

fn count(what: &'static str, [least, most]: [usize; 2], found: usize) -> Result<(), SceneFileError> {
    if (least..=most).contains(&found) {
        Ok(())
    } else {
        Err(SceneFileError::Count { what, least, most, found })
    }
}

fn range(what: &'static str, [least, most]: [f32; 2], found: f32) -> Result<f32, SceneFileError> {
    if (least..=most).contains(&found) {
        Ok(found)
    } else {
        Err(SceneFileError::Range { what, least, most, found })
    }
}

fn size(found: f32) -> Result<f32, SceneFileError> {
    range("a size", [0.01, FARTHEST_M], found)
}

fn extents(whole: Triple) -> Result<Vec3, SceneFileError> {
    whole.into_iter().try_for_each(|length| size(length).map(drop))?;
    Ok(whole.into())
}

fn place(at: Triple) -> Result<Vec3, SceneFileError> {
    let at = Vec3::from(at);
    range("a distance from the origin", [0.0, FARTHEST_M], at.length())?;
    Ok(at)
}

fn turn(yaw: f32) -> Result<Quat, SceneFileError> {
    Ok(Quat::from_rotation_z(range("a yaw, degrees,", [-360.0, 360.0], yaw)?.to_radians()))
}

fn rectangle(what: &'static str, corners: (Pair, Pair)) -> Result<[Vec2; 2], SceneFileError> {
    let (low, high) = (Vec2::from(corners.0), Vec2::from(corners.1));
    for (least, most) in [(low.x, high.x), (low.y, high.y)] {
        range(what, [-FARTHEST_M, FARTHEST_M], least)?;
        range(what, [least, FARTHEST_M], most)?;
    }
    Ok([low, high])
}

#[cfg(test)]
#[path = "file_tests.rs"]
mod tests;
