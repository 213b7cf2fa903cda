//! Ties the nodes of a document to the bodies of the character.

use glam::{Affine3A, Mat3A, Mat4, Quat, Vec3};
use policy_core::Body;

use super::MeshError;
use crate::mannequin::rest_positions;

/// Limbs that point at least this far off their rest direction are turned, as a cosine (25 degrees).
const TURN_BEYOND: f32 = 0.906;

/// Where the nodes stand in the rest pose, and which body each follows.
pub(super) struct Binding {
    /// World (z up) from node, all nodes.
    pub(super) world_from_node: Vec<Mat4>,
    /// The body that each node follows.
    pub(super) body_of_node: Vec<Body>,
    /// Frame of each body from the world of the rest pose.
    pub(super) body_from_world: [Affine3A; 15],
}

impl Binding {
    pub(super) fn of(document: &gltf::Document) -> Result<Self, MeshError> {
        let parents = parents(document);
        let nodes: Vec<gltf::Node<'_>> = document.nodes().collect();
        let named: Vec<Option<Body>> = nodes.iter().map(|n| n.name().and_then(Body::from_name)).collect();
        let missing: Vec<&'static str> =
            Body::ALL.iter().filter(|b| !named.contains(&Some(**b))).map(|b| b.name()).collect();
        if !missing.is_empty() {
            return Err(MeshError::MissingBodies { missing });
        }
        let mut world_from_node = Vec::with_capacity(nodes.len());
        let mut body_of_node = Vec::with_capacity(nodes.len());
        for node in 0..nodes.len() {
            let mut matrix = Mat4::IDENTITY;
            let mut body = None;
            for ancestor in chain(&parents, node)? {
                matrix = Mat4::from_cols_array_2d(&nodes[ancestor].transform().matrix()) * matrix;
                body = body.or(named[ancestor]);
            }
            world_from_node.push(world_from_gltf() * matrix);
            // Nodes above the pelvis move with it.
            body_of_node.push(body.unwrap_or(Body::Pelvis));
        }
        let mut origins = [Vec3::ZERO; 15];
        for (node, body) in named.iter().enumerate() {
            if let Some(body) = body {
                origins[body.index()] = world_from_node[node].w_axis.truncate();
            }
        }
        Ok(Self { world_from_node, body_of_node, body_from_world: body_frames(&origins) })
    }
}

/// `(x, y, z)` of glTF, y up and facing z, is `(z, x, y)` of the world, z up and facing x.
fn world_from_gltf() -> Mat4 {
    Mat4::from_cols(Vec3::Y.extend(0.0), Vec3::Z.extend(0.0), Vec3::X.extend(0.0), Vec3::ZERO.extend(1.0))
}

fn parents(document: &gltf::Document) -> Vec<Option<usize>> {
    let mut parents = vec![None; document.nodes().count()];
    for node in document.nodes() {
        for child in node.children() {
            parents[child.index()] = Some(node.index());
        }
    }
    parents
}

/// The node and its ancestors up to the root.
fn chain(parents: &[Option<usize>], node: usize) -> Result<Vec<usize>, MeshError> {
    let mut chain = vec![node];
    while let Some(parent) = parents[chain[chain.len() - 1]] {
        chain.push(parent);
        if chain.len() > parents.len() {
            return Err(MeshError::Unsupported { what: format!("node {node} being its own ancestor") });
        }
    }
    Ok(chain)
}

/// Frames of the bodies: at their nodes, turned so that a limb lies along the frame as it does in the character.
fn body_frames(origins: &[Vec3; 15]) -> [Affine3A; 15] {
    let rest = rest_positions();
    let mut turns = [Quat::IDENTITY; 15];
    let mut frames = [Affine3A::IDENTITY; 15];
    for body in Body::ALL {
        let i = body.index();
        let turn = match end_of(body) {
            Some(end) => {
                let here = (origins[end.index()] - origins[i]).normalize_or_zero();
                let there = (rest[end.index()] - rest[i]).normalize_or_zero();
                let far = here.length_squared() > 0.5 && here.dot(there) < TURN_BEYOND;
                if far { Quat::from_rotation_arc(here, there) } else { Quat::IDENTITY }
            }
            None => body.parent().map_or(Quat::IDENTITY, |parent| turns[parent.index()]),
        };
        turns[i] = turn;
        let rotation = Mat3A::from_quat(turn);
        frames[i] = Affine3A { matrix3: rotation, translation: -(rotation * glam::Vec3A::from(origins[i])) };
    }
    frames
}

/// The body at the far end of a limb; hands and feet have none.
fn end_of(body: Body) -> Option<Body> {
    match body {
        Body::Pelvis => Some(Body::Torso),
        Body::Torso => Some(Body::Head),
        _ => Body::ALL.into_iter().find(|b| b.parent() == Some(body)),
    }
}
