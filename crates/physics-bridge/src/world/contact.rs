//! What touches what, where, and how hard.

use glam::{DVec3, Vec3};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::BodyId;

use super::handle::{CharacterHandle, FixtureHandle, PropHandle};
use super::places::{Owner, Places};
use super::scene::Scene;

/// A part of a world that can be touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The plane and the terrain.
    Ground,
    /// A fixture.
    Fixture(FixtureHandle),
    /// A prop.
    Prop(PropHandle),
    /// A body of a character.
    Body(CharacterHandle, BodyId),
}

/// A point at which two parts touch. World space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldContact {
    /// The two.
    pub parts: [Part; 2],
    /// Where, metres.
    pub position: Vec3,
    /// From the first to the second, a unit vector.
    pub normal: Vec3,
    /// What presses on the second, newtons; friction included. The same presses on the first, the other way.
    pub force: Vec3,
    /// How deep the two are in each other, metres; negative while they are still apart.
    pub depth: f32,
}

/// Contacts that are kept of a tick.
pub(super) fn most_contacts(scene: &Scene) -> usize {
    (64 + 32 * scene.characters.iter().count() + 16 * scene.props.iter().count()).min(1 << 14)
}

/// The part that a body of MuJoCo belongs to.
pub(super) fn part(owner: Owner, scene: &Scene) -> Part {
    match owner {
        Owner::Ground => Part::Ground,
        Owner::Fixture(index) => Part::Fixture(scene.fixtures.handle(index)),
        Owner::Prop(index) => Part::Prop(scene.props.handle(index)),
        Owner::Character(index, body) => Part::Body(scene.characters.handle(index), body),
    }
}

/// Replaces `contacts` with those of the substep that was just solved, as many as it has room for.
pub(super) fn collect(
    data: &MjData<Box<MjModel>>,
    places: &Places,
    scene: &Scene,
    contacts: &mut Vec<WorldContact>,
) {
    contacts.clear();
    let bodies = data.model().geom_bodyid();
    let part_of = |geom: i32| {
        let body = usize::try_from(geom).map_or(0, |geom| bodies[geom] as usize);
        part(places.owners[body], scene)
    };
    let room = contacts.capacity();
    contacts.extend(data.contact().iter().enumerate().take(room).map(|(index, contact)| {
        let [nx, ny, nz, ax, ay, az, bx, by, bz] = contact.frame;
        let (normal, along, across) =
            (DVec3::new(nx, ny, nz), DVec3::new(ax, ay, az), DVec3::new(bx, by, bz));
        let [press, slide_along, slide_across, ..] = data.contact_force(index);
        let force = normal * press + along * slide_along + across * slide_across;
        WorldContact {
            parts: contact.geom.map(part_of),
            position: DVec3::from(contact.pos).as_vec3(),
            normal: normal.as_vec3(),
            force: force.as_vec3(),
            depth: -contact.dist as f32,
        }
    }));
}
