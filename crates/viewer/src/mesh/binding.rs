//! Ties the nodes of a document to the bodies of a skeleton.

use glam::{Affine3A, Mat3A, Mat4, Quat, Vec3};
use policy_core::BodyId;

use super::{MeshError, Rig};

/// Limbs that point at least this far off their rest direction are turned, as a cosine (25 degrees).
const TURN_BEYOND: f32 = 0.906;

/// Where the nodes are in the rest pose, and which body each follows.
pub(super) struct Binding {
    /// World (z up) from node, all nodes.
    pub(super) world_from_node: Vec<Mat4>,
    /// The body that each node follows.
    pub(super) body_of_node: Vec<BodyId>,
    /// Frame of each body from the world of the rest pose.
    pub(super) body_from_world: Vec<Affine3A>,
}

impl Binding {
    pub(super) fn of(document: &gltf::Document, rig: &Rig) -> Result<Self, MeshError> {
        let parents = parents(document);
        let nodes: Vec<gltf::Node<'_>> = document.nodes().collect();
        let skeleton = rig.skeleton();
        let named: Vec<Option<BodyId>> =
            nodes.iter().map(|n| n.name().and_then(|name| skeleton.body_named(name))).collect();
        let missing = rig.bodies().filter(|body| !named.contains(&Some(*body)));
        let missing: Vec<String> = missing.map(|body| skeleton.body(body).name.clone()).collect();
        if !missing.is_empty() {
            return Err(MeshError::MissingBodies { missing });
        }
        let mut world_from_node = Vec::with_capacity(nodes.len());
        let mut body_of_node = Vec::with_capacity(nodes.len());
        for node in 0..nodes.len() {
            let mut matrix = Mat4::IDENTITY;
            let mut body = None;
            for ancestor in chain(&parents, node)? {
                // Every index of a node is below their number: the gltf crate has checked children.
                matrix = Mat4::from_cols_array_2d(&nodes[ancestor].transform().matrix()) * matrix;
                body = body.or(named[ancestor]);
            }
            world_from_node.push(world_from_gltf() * matrix);
            // Nodes above the root body move with it.
            body_of_node.push(body.unwrap_or(skeleton.root()));
        }
        let mut origins = vec![Vec3::ZERO; skeleton.body_count()];
        for (node, body) in named.iter().enumerate() {
            if let Some(body) = body {
                origins[body.index()] = world_from_node[node].w_axis.truncate();
            }
        }
        Ok(Self { world_from_node, body_of_node, body_from_world: body_frames(rig, &origins) })
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
fn body_frames(rig: &Rig, origins: &[Vec3]) -> Vec<Affine3A> {
    let mut turns: Vec<Quat> = Vec::with_capacity(origins.len());
    let mut frames = Vec::with_capacity(origins.len());
    for body in rig.bodies() {
        let i = body.index();
        let turn = match rig.end_of(body) {
            Some(end) => {
                let here = (origins[end.index()] - origins[i]).normalize_or_zero();
                let there = (rig.rest(end) - rig.rest(body)).normalize_or_zero();
                let known = here.length_squared() > 0.5 && there.length_squared() > 0.5;
                let far = known && here.dot(there) < TURN_BEYOND;
                if far { Quat::from_rotation_arc(here, there) } else { Quat::IDENTITY }
            }
            // Parents come first.
            None => rig.skeleton().parent(body).map_or(Quat::IDENTITY, |parent| turns[parent.index()]),
        };
        turns.push(turn);
        let rotation = Mat3A::from_quat(turn);
        frames.push(Affine3A { matrix3: rotation, translation: -(rotation * glam::Vec3A::from(origins[i])) });
    }
    frames
}
