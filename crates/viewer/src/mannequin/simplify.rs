//! A coarser mesh from a fine one, by clusters of vertices (Rossignac and Borrel 1993): those that lie in one cell, follow one body
//! and face one way become one. A thin shell keeps both its sides, where a grid as coarse as this would miss it.

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;

use super::sculpt::{Part, Vertex};
use super::shell::used;

/// What is less open to the sky than this lies under a shell: at a distance it is not seen.
const HIDDEN_BELOW: f32 = 0.35;

/// Body, cell, and the axis and direction that it faces.
type Cluster = (u8, [i32; 3], usize, bool);

/// The part without what is hidden, with at most one vertex for each body, cell of this edge in metres, and side.
pub(super) fn simplified(part: &Part, cell: f32) -> Part {
    let mut clusters: BTreeMap<Cluster, Vec<usize>> = BTreeMap::new();
    for (index, vertex) in part.vertices.iter().enumerate() {
        clusters.entry(cluster_of(vertex, cell)).or_default().push(index);
    }
    let mut cluster_at = vec![0; part.vertices.len()];
    for (number, members) in clusters.values().enumerate() {
        members.iter().for_each(|&index| cluster_at[index] = number);
    }
    let (mut seen, mut triangles) = (BTreeSet::new(), Vec::new());
    for corners in part.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|corner| corners[corner] as usize);
        let is_hidden = corners.iter().all(|&index| part.vertices[index].openness < HIDDEN_BELOW);
        let [a, b, c] = corners.map(|index| cluster_at[index]);
        let mut sorted = [a, b, c];
        sorted.sort_unstable();
        if !is_hidden && a != b && b != c && c != a && seen.insert(sorted) {
            triangles.push([a, b, c]);
        }
    }
    let middles: Vec<Vertex> = clusters.values().map(|members| middle(part, members)).collect();
    let (vertices, indices) = used(&middles, triangles.into_iter().flatten().map(|number| number as u32));
    Part { vertices, indices }
}

fn cluster_of(vertex: &Vertex, cell: f32) -> Cluster {
    let size = vertex.normal.abs();
    let axis = (1..3).fold(0, |most, axis| if size[axis] > size[most] { axis } else { most });
    let at = (vertex.position / cell).round().as_ivec3();
    (vertex.bodies[0], at.to_array(), axis, vertex.normal[axis] < 0.0)
}

/// The member nearest to the mean of all: it lies on the surface and follows its bodies.
fn middle(part: &Part, members: &[usize]) -> Vertex {
    let at = |index: &usize| part.vertices[*index].position;
    let mean = members.iter().map(at).sum::<Vec3>() / members.len() as f32;
    let nearer =
        |a: &&usize, b: &&usize| at(a).distance_squared(mean).total_cmp(&at(b).distance_squared(mean));
    part.vertices[*members.iter().min_by(nearer).expect("a cluster has a member")]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mannequin::sculpt::Sculpture;

    #[test]
    fn it_is_coarser_and_keeps_the_outline_of_every_body() {
        let fine = Sculpture::new().plain_shells(2.8);
        let coarse = simplified(&fine, 0.05);
        assert!(coarse.indices.len() < fine.indices.len() / 2, "{} indices", coarse.indices.len());
        let extent = |part: &Part, body: u8| {
            let of_body = part.vertices.iter().filter(|vertex| vertex.bodies[0] == body);
            of_body.fold([Vec3::splat(9.0), Vec3::splat(-9.0)], |[low, high], vertex| {
                [low.min(vertex.position), high.max(vertex.position)]
            })
        };
        for body in 0..15 {
            let ([low, high], [least, most]) = (extent(&fine, body), extent(&coarse, body));
            if low.x > high.x {
                continue;
            }
            let lost = (least - low).max(high - most).max_element();
            assert!(lost < 0.03, "body {body} lost {lost} m");
        }
    }

    #[test]
    fn no_triangle_is_flat_or_there_twice() {
        let coarse = simplified(&Sculpture::new().figure(2.8).1, 0.05);
        let mut seen = BTreeSet::new();
        for corners in coarse.indices.chunks_exact(3) {
            let mut sorted = [corners[0], corners[1], corners[2]];
            sorted.sort_unstable();
            assert!(sorted[0] < sorted[1] && sorted[1] < sorted[2] && seen.insert(sorted));
        }
    }
}
