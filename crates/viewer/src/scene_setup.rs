//! Sets the scene: what of the world is drawn, and how. Reads the simulation, changes nothing.

use std::collections::VecDeque;

use glam::{Mat4, Quat, Vec2, Vec3};
use physics_bridge::{BodyPoses, HeightField, ShapeKind};

use crate::render::{Figure, GroundGrid, Marker, Scene, Solid, View};
use crate::sim::Simulation;
use crate::things::{self, ring};
use crate::{breath, landmarks};

/// What is shown besides the characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Shown {
    /// Collision shapes instead of the mesh.
    pub collision_shapes: bool,
    /// Where the pad points.
    pub target: bool,
    /// The way walked.
    pub trail: bool,
    /// Forces at contacts.
    pub contact_forces: bool,
    /// Centre of mass, and the point on the ground below it.
    pub centre_of_mass: bool,
}

impl Default for Shown {
    fn default() -> Self {
        Self {
            collision_shapes: false,
            target: true,
            trail: true,
            contact_forces: false,
            centre_of_mass: false,
        }
    }
}

/// Points of a trail.
const TRAIL_POINTS: usize = 240;
/// Distance between them, metres.
const TRAIL_STEP: f32 = 0.08;
/// The ghost walks this far beside the player, metres.
const GHOST_BESIDE: f32 = 0.9;
const TARGET_COLOUR: [f32; 4] = [0.95, 0.42, 0.10, 0.9];
const GHOST_TINT: [f32; 4] = [0.12, 0.42, 0.78, 0.9];

/// The way the player has walked.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    points: VecDeque<Vec3>,
}

impl Trail {
    /// Adds where the player is.
    pub fn follow(&mut self, sim: &Simulation) {
        let at = sim.player().position();
        if !at.is_finite() {
            return;
        }
        let point = at.extend(sim.player().state.ground_height + 0.012);
        match self.points.back() {
            Some(last) if last.distance(point) < TRAIL_STEP => return,
            // A jump is no walk.
            Some(last) if last.distance(point) > 1.5 => self.points.clear(),
            _ => {}
        }
        if self.points.len() == TRAIL_POINTS {
            self.points.pop_front();
        }
        self.points.push_back(point);
    }

    /// Forgets it.
    pub fn clear(&mut self) {
        self.points.clear();
    }

    fn draw(&self, scene: &mut Scene) {
        let opacity = |i: usize| 0.55 * (i + 1) as f32 / self.points.len() as f32;
        for (i, (a, b)) in self.points.iter().zip(self.points.iter().skip(1)).enumerate() {
            let colour = |i| [0.95, 0.55, 0.18, opacity(i)];
            // Flat on the ground: across is horizontal.
            let across = (*b - *a).cross(Vec3::Z).normalize_or(Vec3::X) * 0.014;
            let corners = [(*a - across, i), (*a + across, i), (*b + across, i + 1), (*b - across, i + 1)];
            for corner in [0, 1, 2, 0, 2, 3] {
                let (position, at) = corners[corner];
                let vertex =
                    crate::render::RibbonVertex { position: position.to_array(), colour: colour(at) };
                scene.ribbons.push(vertex);
            }
        }
    }
}

/// What a picture is to show.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Where it is taken from.
    pub view: View,
    /// Only this character; `None` shows all.
    pub alone: Option<usize>,
    /// How far it is from the last tick but one to the last, 0 to 1.
    pub alpha: f32,
    /// What is shown besides the characters.
    pub shown: &'a Shown,
    /// The way the player has walked.
    pub trail: &'a Trail,
}

/// Sets the scene for a picture.
pub fn set_scene(scene: &mut Scene, sim: &Simulation, picture: &Picture<'_>) {
    let &Picture { view, alone, alpha, shown, trail } = picture;
    let who = alone.unwrap_or(0);
    scene.view = view;
    scene.focus = scene.view.target.with_z(sim.characters()[who].state.ground_height);
    scene.figures.clear();
    scene.markers.clear();
    scene.things.clear();
    scene.ribbons.clear();
    scene.hide_figures = shown.collision_shapes;
    landmarks::posts(scene, scene.focus.truncate(), |at| sim.height_at(at, 0.0));
    if let Some(shared) = sim.shared() {
        things::fixtures(scene, shared.scene());
        for piece in shared.pieces() {
            things::prop(scene, &piece.solid, piece.pose(alpha), piece.paint, piece.anchor);
        }
        things::checkpoints(scene, shared.scene(), shared.race());
    }
    for index in (0..sim.characters().len()).filter(|index| alone.is_none_or(|who| who == *index)) {
        let figure = figure(sim, drawn_poses(sim, index, alpha), tint(index));
        if shown.collision_shapes {
            collision_shapes(scene, sim, &figure, [0.85, 0.62, 0.25, 1.0]);
        }
        scene.figures.push(figure);
    }
    if let Some(poses) = sim.ghost_poses(alpha) {
        let mut figure = figure(sim, poses, GHOST_TINT);
        let aside = sim.player().heading().world_from_heading_2d(Vec2::new(0.0, -GHOST_BESIDE)).extend(0.0);
        figure.positions.iter_mut().for_each(|p| *p += aside);
        if shown.collision_shapes {
            collision_shapes(scene, sim, &figure, [0.25, 0.5, 0.9, 1.0]);
        }
        scene.figures.push(figure);
    }
    if shown.trail && who == 0 {
        trail.draw(scene);
    }
    if shown.target {
        target(scene, sim, who);
    }
    if shown.contact_forces {
        for contact in sim.ground_contacts(who) {
            let tip = contact.position + contact.force * 0.0012;
            scene.arrow(contact.position, tip, 0.012, [0.15, 0.75, 0.35, 1.0]);
        }
    }
    if shown.centre_of_mass {
        let centre = sim.centre_of_mass(who);
        let ground = sim.height_at(centre.truncate(), centre.z) + 0.015;
        scene.ball(centre, 0.045, [0.9, 0.15, 0.2, 1.0]);
        scene.line(centre, centre.with_z(ground), 0.008, [[0.9, 0.15, 0.2, 0.8]; 2]);
        ring(scene, centre.with_z(ground), 0.06, [0.9, 0.15, 0.2, 1.0]);
    }
}

/// Poses of a character as they are drawn: one that stands breathes.
fn drawn_poses(sim: &Simulation, index: usize, alpha: f32) -> BodyPoses {
    let (character, mut poses) = (&sim.characters()[index], sim.poses(index, alpha));
    if sim.playback().is_none() && !character.is_down() && character.report().skill.is_none() {
        let secs = (sim.ticks() as f32 + alpha) * sim.tick_secs();
        // Not all at once.
        let secs = secs + 1.3 * index as f32;
        breath::breathe(&mut poses, sim.pack().skeleton(), secs, breath::share_at(character.speed()));
    }
    poses
}

fn figure(sim: &Simulation, poses: BodyPoses, tint: [f32; 4]) -> Figure {
    let root = poses.positions[0];
    let height = |dx: f32, dy: f32| sim.height_at(root.truncate() + Vec2::new(dx, dy), root.z);
    // Over half a metre: what a patch of shadow lies on, not the edge of a step.
    let slope = [height(0.25, 0.0) - height(-0.25, 0.0), height(0.0, 0.25) - height(0.0, -0.25)];
    Figure {
        positions: poses.positions,
        rotations: poses.rotations,
        tint,
        ground: height(0.0, 0.0),
        slope: slope.map(|rise| (2.0 * rise).clamp(-0.6, 0.6)),
    }
}

/// The player in its own colours, the crowd in muted ones that differ.
fn tint(index: usize) -> [f32; 4] {
    const COLOURS: [[f32; 3]; 7] = [
        [0.62, 0.30, 0.18],
        [0.20, 0.38, 0.50],
        [0.52, 0.48, 0.36],
        [0.28, 0.42, 0.30],
        [0.60, 0.50, 0.22],
        [0.40, 0.30, 0.46],
        [0.46, 0.46, 0.48],
    ];
    let [r, g, b] = COLOURS[index * 3 % COLOURS.len()];
    [r, g, b, if index == 0 { 0.0 } else { 0.7 }]
}

fn target(scene: &mut Scene, sim: &Simulation, who: usize) {
    let character = &sim.characters()[who];
    let Some(at) = character.command.target.filter(|t| t.is_finite()) else { return };
    let below = character.state.root().position.z + 0.5;
    let ground = at.extend(sim.height_at(at, below) + 0.015);
    ring(scene, ground, 0.16, TARGET_COLOUR);
    ring(scene, ground, 0.05, TARGET_COLOUR);
    let turn = Quat::from_rotation_x(std::f32::consts::PI);
    let place =
        Mat4::from_scale_rotation_translation(Vec3::new(0.05, 0.05, 0.14), turn, ground + Vec3::Z * 0.32);
    scene.markers.push(Marker { solid: Solid::Cone, place, colour: TARGET_COLOUR });
}

fn collision_shapes(scene: &mut Scene, sim: &Simulation, figure: &Figure, colour: [f32; 4]) {
    for shape in sim.model().shapes() {
        let i = shape.body.index();
        let world_from_body = Mat4::from_rotation_translation(figure.rotations[i], figure.positions[i]);
        let world_from_shape =
            world_from_body * Mat4::from_rotation_translation(shape.rotation, shape.position);
        let mut add = |solid, scale: Vec3, offset: f32| {
            let local = Mat4::from_scale_rotation_translation(scale, Quat::IDENTITY, Vec3::Z * offset);
            scene.markers.push(Marker { solid, place: world_from_shape * local, colour });
        };
        match shape.kind {
            ShapeKind::Sphere { radius } => add(Solid::Ball, Vec3::splat(radius), 0.0),
            ShapeKind::Capsule { radius, half_length } => {
                add(Solid::Tube, Vec3::new(radius, radius, half_length), 0.0);
                add(Solid::Ball, Vec3::splat(radius), half_length);
                add(Solid::Ball, Vec3::splat(radius), -half_length);
            }
            ShapeKind::Cuboid { half_extents } => add(Solid::Cube, half_extents, 0.0),
            _ => {}
        }
    }
}

/// The ground as the renderer takes it; `None` when it is flat.
#[must_use]
pub fn ground_grid(field: Option<&HeightField>, outside: f32) -> Option<GroundGrid> {
    let field = field?;
    let corner = field.point(0, 0);
    Some(GroundGrid {
        rows: field.rows(),
        columns: field.columns(),
        half_extent: [-corner.x, -corner.y],
        heights: field.heights().to_vec(),
        outside,
    })
}
