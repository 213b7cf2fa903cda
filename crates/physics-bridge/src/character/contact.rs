//! Where a character touches, and how hard.

use glam::{DVec3, Vec3};
use mujoco_rs::wrappers::mj_data::MjData;
use mujoco_rs::wrappers::mj_model::MjModel;
use policy_core::{BodyId, Skeleton};
use std::sync::Arc;

use crate::description::layout::Layout;

/// Contacts kept of a tick. A body that lies on a fine terrain can have more.
pub(super) fn most_contacts(skeleton: &Skeleton) -> usize {
    (4 * skeleton.body_count()).max(64)
}

/// A point at which a body touches the ground or another body. World space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The body that is touched.
    pub body: BodyId,
    /// The other body; `None` for the ground.
    pub other: Option<BodyId>,
    /// Where, metres.
    pub position: Vec3,
    /// Away from the ground or the other body, a unit vector.
    pub normal: Vec3,
    /// What presses on the body there, newtons; friction included.
    pub force: Vec3,
    /// How deep the two are in each other, metres; negative while they are still apart.
    pub depth: f32,
}

/// Replaces `contacts` with those of the substep that was just solved, as many as it has room for.
pub(super) fn collect(data: &MjData<Arc<MjModel>>, layout: &Layout, contacts: &mut Vec<Contact>) {
    contacts.clear();
    let model = data.model();
    let bodies = model.geom_bodyid();
    let body_of = |geom: i32| layout.bodies[bodies[usize::try_from(geom).ok()?] as usize];
    for (index, contact) in data.contact().iter().enumerate() {
        let [first, second] = contact.geom.map(body_of);
        // MuJoCo's normal points from the first to the second, and its force acts on the second.
        let (body, other, sign) = match (first, second) {
            (_, Some(second)) => (second, first, 1.0),
            (Some(first), None) => (first, None, -1.0),
            (None, None) => continue,
        };
        if contacts.len() == contacts.capacity() {
            break;
        }
        let [nx, ny, nz, ax, ay, az, bx, by, bz] = contact.frame;
        let (normal, along, across) =
            (DVec3::new(nx, ny, nz), DVec3::new(ax, ay, az), DVec3::new(bx, by, bz));
        let [press, slide_along, slide_across, ..] = data.contact_force(index);
        let force = normal * press + along * slide_along + across * slide_across;
        contacts.push(Contact {
            body,
            other,
            position: DVec3::from(contact.pos).as_vec3(),
            normal: (normal * sign).as_vec3(),
            force: (force * sign).as_vec3(),
            depth: -contact.dist as f32,
        });
    }
}
