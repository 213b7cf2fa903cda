//! Which bodies of one character touch each other: those that do in MuJoCo, by the bits of their geoms.

use rapier3d_mjcf::MjcfRobot;
use rapier3d_mjcf::mjcf_rs::Model as Description;
use rapier3d_mjcf::mjcf_rs::body::Geom;

/// Pairs of indices in `MjcfRobot::bodies` that have geoms and never touch each other; `None` when no pair of the
/// character touches.
///
/// MuJoCo's rule: two geoms touch when a bit of one's `contype` is in the other's `conaffinity`, unless their bodies are
/// rigidly joined, or parent and child, or in an `exclude`. Here two bodies touch with all their geoms when any two of
/// those do.
pub(super) fn apart(robot: &MjcfRobot, description: &Description) -> Option<Vec<[usize; 2]>> {
    let bodies = robot.bodies.iter().enumerate().skip(1);
    let solid: Vec<usize> =
        bodies.filter(|(_, body)| !body.colliders.is_empty()).map(|(index, _)| index).collect();
    let mut pairs = Vec::new();
    for (at, &one) in solid.iter().enumerate() {
        pairs.extend(solid[at + 1..].iter().map(|&other| [one, other]));
    }
    let all = pairs.len();
    pairs.retain(|pair| !touch(description, pair.map(|body| robot.bodies[body].mjcf_body_id)));
    (pairs.len() < all).then_some(pairs)
}

/// True when two bodies of the MJCF touch each other.
fn touch(description: &Description, [one, other]: [usize; 2]) -> bool {
    let welds = [one, other].map(|body| weld(description, body));
    let parents = welds.map(|weld| parent_weld(description, weld));
    if welds[0] == welds[1] || parents[0] == Some(welds[1]) || parents[1] == Some(welds[0]) {
        return false;
    }
    let name = |body: usize| description.bodies[body].body.name.as_deref();
    let excluded = description.contact.excludes.iter().any(|pair| {
        let [first, second] = [&pair.body1, &pair.body2].map(|name| Some(name.as_str()));
        [first, second] == [name(one), name(other)] || [second, first] == [name(one), name(other)]
    });
    let geoms = |body: usize| &description.bodies[body].body.geoms;
    let meet = |a: &Geom, b: &Geom| a.contype & b.conaffinity != 0 || b.contype & a.conaffinity != 0;
    !excluded && geoms(one).iter().any(|a| geoms(other).iter().any(|b| meet(a, b)))
}

/// The body that a body without joints is rigidly joined to; itself when it has joints.
fn weld(description: &Description, body: usize) -> usize {
    let entry = &description.bodies[body];
    match entry.parent {
        Some(parent) if entry.body.joints.is_empty() => weld(description, parent),
        _ => body,
    }
}

/// The weld that the joints of a weld hang on; `None` for one that hangs on the world, whose children do touch it.
fn parent_weld(description: &Description, weld_of_body: usize) -> Option<usize> {
    let parent = description.bodies[weld_of_body].parent.filter(|&parent| parent != 0)?;
    Some(weld(description, parent))
}
