//! Builds the two surfaces of the mannequin, suit and shells, with normals, skin and baked occlusion.

use glam::{Vec3, Vec4};

use super::anatomy::{self, Piece};
use super::bone::Bone;
use super::field::{Shape, normal, smooth_union};
use super::shell::{Shell, used};
use super::surface_nets::Surface;
use super::{markings, rim, surface_nets};

/// Width of the band around a joint in which the suit bends, metres.
const BEND: f32 = 0.07;
/// Fillet between neighbouring bodies of the suit.
const SUIT_FILLET: f32 = 0.05;
/// Edge of a mesh cell of the suit at coarseness 1.
const SUIT_CELL: f32 = 0.0105;

/// A vertex in the rest pose, pelvis at the origin, z up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
    /// How open the surface is to the sky, 0 to 1.
    pub(super) openness: f32,
    /// Up to four bodies and how much the vertex follows each; they sum to 255.
    pub(super) bodies: [u8; 4],
    pub(super) follow: [u8; 4],
}

/// Triangles of one material.
#[derive(Default)]
pub(super) struct Part {
    pub(super) vertices: Vec<Vertex>,
    pub(super) indices: Vec<u32>,
}

/// The distance fields of the whole mannequin in the rest pose.
pub(super) struct Sculpture {
    rest: [Vec3; 15],
    shells: Vec<Piece>,
    suit: Vec<(Bone, Shape)>,
}

impl Sculpture {
    pub(super) fn new() -> Self {
        Self { rest: anatomy::rest_positions(), shells: anatomy::shells(), suit: anatomy::suit() }
    }

    /// Shells with rims, and the suit without what they hide, with dark pieces and markings. Cells are `coarseness` times the size in
    /// `anatomy`.
    pub(super) fn figure(&self, coarseness: f32) -> (Part, Part) {
        let (mut shells, mut suit) = (Part::default(), Part::default());
        for group in Group::ALL {
            self.suit_group(group, coarseness, &mut suit);
        }
        for piece in &self.shells {
            let (origin, group) = (self.rest[piece.body.index()], Group::of(piece.body));
            let field = |p: Vec3| piece_distance(piece, p);
            let (surface, cell) = mesh_of(piece, coarseness);
            if piece.dark {
                self.add(piece.body, &Shell::of(&surface, field), &mut suit);
                continue;
            }
            let whole = rim::rimmed(&surface, cell, field, |p| self.suit_distance(group, origin + p));
            let (plain, marked) = markings::parted(whole, &markings::of(piece.body), field);
            self.add(piece.body, &plain, &mut shells);
            self.add(piece.body, &marked, &mut suit);
        }
        (shells, suit)
    }

    /// Shells without rims and markings, which run into the suit.
    pub(super) fn plain_shells(&self, coarseness: f32) -> Part {
        let mut part = Part::default();
        for piece in self.shells.iter().filter(|piece| !piece.dark) {
            let surface = Shell::of(&mesh_of(piece, coarseness).0, |p| piece_distance(piece, p));
            self.add(piece.body, &surface, &mut part);
        }
        part
    }

    /// Adds a surface in the frame of the body that carries it.
    fn add(&self, body: Bone, surface: &Shell, part: &mut Part) {
        let base = part.vertices.len() as u32;
        part.indices.extend(surface.indices.iter().map(|index| base + index));
        part.vertices.extend(surface.points.iter().map(|point| {
            let follow = ([body as u8, 0, 0, 0], [255, 0, 0, 0]);
            self.vertex(self.rest[body.index()] + point.position, point.normal, follow)
        }));
    }

    /// Arms are meshed by themselves: at rest they touch the hips, and would grow onto them.
    fn suit_group(&self, group: Group, coarseness: f32, part: &mut Part) {
        let low = Vec3::new(-0.2, -0.35, -0.9);
        let high = Vec3::new(0.25, 0.35, 0.8);
        let field = |p: Vec3| self.suit_distance(group, p);
        let surface = surface_nets::mesh(low, high, SUIT_CELL * coarseness, field);
        let buried: Vec<bool> = surface.positions.iter().map(|&p| self.is_buried(group, p)).collect();
        let triangles = surface.indices.chunks_exact(3);
        let shown = triangles.filter(|triangle| !triangle.iter().all(|&i| buried[i as usize]));
        let (positions, indices) = used(&surface.positions, shown.flatten().copied());
        let base = part.vertices.len() as u32;
        part.indices.extend(indices.iter().map(|index| base + index));
        let vertex = |&p: &Vec3| self.vertex(p, normal(p, field), self.follow(group, p));
        part.vertices.extend(positions.iter().map(vertex));
    }

    /// True when the shell of the body it belongs to hides the point, however the joints bend.
    fn is_buried(&self, group: Group, p: Vec3) -> bool {
        let nearest = nearest(&self.body_distances(group, p));
        let over = self.shells.iter().filter(|piece| piece.body.index() == nearest);
        over.map(|piece| piece_distance(piece, p - self.rest[nearest])).any(|d| d < -0.006)
    }

    fn vertex(&self, position: Vec3, normal: Vec3, (bodies, follow): ([u8; 4], [u8; 4])) -> Vertex {
        let openness = self.openness(position, normal, Bone::ALL[usize::from(bodies[0])]);
        Vertex { position, normal, openness, bodies, follow }
    }

    /// Occlusion by what lies within 7 cm along the normal, from five samples of the field. Only bodies that stay near this one count: a
    /// hand that hangs beside the thigh at rest would leave its shade there.
    fn openness(&self, p: Vec3, n: Vec3, body: Bone) -> f32 {
        let mut closed = 0.0;
        let mut share = 1.0;
        for step in 1..=5 {
            let height = 0.014 * step as f32;
            let q = p + n * height;
            let free = self.distance_near(body, q).max(-0.01);
            closed += share * (height - free).max(0.0) / height;
            share *= 0.75;
        }
        (1.0 - 0.36 * closed).clamp(0.12, 1.0)
    }

    /// Distance to the shells and the suit of a body and of those next to it: its parent, its children and its parent's.
    fn distance_near(&self, body: Bone, p: Vec3) -> f32 {
        let is_near = |other: Bone| {
            other == body
                || other.parent() == Some(body)
                || body.parent().is_some_and(|parent| other == parent || other.parent() == Some(parent))
        };
        let shells = self.shells.iter().filter(|piece| is_near(piece.body));
        let shells = shells.map(|piece| piece_distance(piece, p - self.rest[piece.body.index()]));
        let suit = self.suit.iter().filter(|(of, _)| is_near(*of));
        let suit = suit.map(|(of, shape)| shape.distance(p - self.rest[of.index()]));
        shells.chain(suit).fold(f32::INFINITY, f32::min)
    }

    fn body_distances(&self, group: Group, p: Vec3) -> [f32; 15] {
        let mut distances = [f32::INFINITY; 15];
        for (body, shape) in self.suit.iter().filter(|(body, _)| Group::of(*body) == group) {
            let d = &mut distances[body.index()];
            *d = d.min(shape.distance(p - self.rest[body.index()]));
        }
        distances
    }

    /// Bodies that touch in the skeleton melt into each other; others do not, so legs stay apart.
    fn suit_distance(&self, group: Group, p: Vec3) -> f32 {
        let distances = self.body_distances(group, p);
        let joined = Bone::ALL.iter().filter_map(|b| Some((b.index(), b.parent()?.index())));
        joined
            .filter(|&(child, parent)| distances[child].is_finite() && distances[parent].is_finite())
            .map(|(child, parent)| smooth_union(distances[child], distances[parent], fillet(child)))
            .fold(f32::INFINITY, f32::min)
    }

    /// The nearest body and its neighbours in the skeleton share a vertex by how near their surfaces are.
    fn follow(&self, group: Group, p: Vec3) -> ([u8; 4], [u8; 4]) {
        let distances = self.body_distances(group, p);
        let nearest = nearest(&distances);
        let linked = |i: usize| {
            i == nearest
                || Bone::ALL[i].parent() == Some(Bone::ALL[nearest])
                || Bone::ALL[nearest].parent() == Some(Bone::ALL[i])
        };
        let mut shares: Vec<(usize, f32)> = (0..15)
            .filter(|&i| linked(i))
            .map(|i| (i, (1.0 - (distances[i] - distances[nearest]) / BEND).max(0.0)))
            .map(|(i, s)| (i, s * s))
            .collect();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        shares.truncate(4);
        quantised(&shares)
    }
}

/// Parts of the suit that are meshed by themselves.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Group {
    Trunk,
    RightArm,
    LeftArm,
}

impl Group {
    const ALL: [Group; 3] = [Group::Trunk, Group::RightArm, Group::LeftArm];

    fn of(body: Bone) -> Self {
        match body {
            Bone::RightUpperArm | Bone::RightLowerArm | Bone::RightHand => Group::RightArm,
            Bone::LeftUpperArm | Bone::LeftLowerArm | Bone::LeftHand => Group::LeftArm,
            _ => Group::Trunk,
        }
    }
}

fn nearest(distances: &[f32; 15]) -> usize {
    (0..15).fold(0, |best, i| if distances[i] < distances[best] { i } else { best })
}

fn fillet(child: usize) -> f32 {
    if child == Bone::Head.index() { 0.03 } else { SUIT_FILLET }
}

/// Shares as bytes that sum to 255, the largest taking what rounding leaves.
fn quantised(shares: &[(usize, f32)]) -> ([u8; 4], [u8; 4]) {
    let total: f32 = shares.iter().map(|s| s.1).sum();
    let parts: Vec4 = Vec4::from_slice(&{
        let mut all = [0.0; 4];
        for (slot, share) in all.iter_mut().zip(shares) {
            *slot = share.1 / total;
        }
        all
    });
    let mut bytes = (parts * 255.0).to_array().map(|v| v as u8);
    let sum: u32 = bytes.iter().map(|&b| u32::from(b)).sum();
    bytes[0] += (255 - sum) as u8;
    let mut bodies = [0; 4];
    for (i, share) in shares.iter().enumerate() {
        bodies[i] = if bytes[i] == 0 { 0 } else { share.0 as u8 };
    }
    (bodies, bytes)
}

/// The mesh of a piece, and the edge of its cells.
fn mesh_of(piece: &Piece, coarseness: f32) -> (Surface, f32) {
    let (low, high) = bounds(piece.shapes.iter());
    let cell = piece.cell * coarseness;
    (surface_nets::mesh(low, high, cell, |p| piece_distance(piece, p)), cell)
}

fn piece_distance(piece: &Piece, p: Vec3) -> f32 {
    let mut joined = piece.shapes[0].distance(p);
    for shape in &piece.shapes[1..] {
        joined = smooth_union(joined, shape.distance(p), piece.fillet);
    }
    if piece.floor.is_finite() { -smooth_union(-joined, p.z - piece.floor, 0.006) } else { joined }
}

fn bounds<'a>(shapes: impl Iterator<Item = &'a Shape>) -> (Vec3, Vec3) {
    let everything = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
    let (low, high) = shapes.map(Shape::bounds).fold(everything, |a, b| (a.0.min(b.0), a.1.max(b.1)));
    // A fillet bulges a little beyond its shapes.
    (low - Vec3::splat(0.02), high + Vec3::splat(0.02))
}
