//! What is to be drawn in one picture, as plain data. World space, z up, metres, linear colours.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Quat, Vec3};

/// Where the picture is taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Place of the eye.
    pub eye: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// Vertical field of view, radians.
    pub fov: f32,
}

impl View {
    /// Clip space (depth 0 near to 1 far) from world, for a picture of the given width over height.
    #[must_use]
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        let projection = glam::camera::rh::proj::directx::perspective(self.fov, aspect, 0.05, 600.0);
        projection * glam::camera::rh::view::look_at_mat4(self.eye, self.target, Vec3::Z)
    }
}

impl Default for View {
    fn default() -> Self {
        Self { eye: Vec3::new(-3.2, -2.0, 1.7), target: Vec3::new(0.0, 0.0, 0.85), fov: 0.7 }
    }
}

/// A column of a picture that several scenes share, as high as the whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Its left edge, pixels.
    pub left: u32,
    /// Pixels.
    pub width: u32,
    /// The first part clears the whole picture.
    pub first: bool,
    /// The last part completes it.
    pub last: bool,
}

impl Part {
    /// All of a picture of a size (width, height).
    #[must_use]
    pub const fn whole([width, _]: [u32; 2]) -> Self {
        Self { left: 0, width, first: true, last: true }
    }
}

/// A character.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Origins of the body frames, in the order of the skeleton.
    pub positions: Vec<Vec3>,
    /// `world_from_body`, in the same order.
    pub rotations: Vec<Quat>,
    /// Colour of its clothes and how much of it, 0 to 1.
    pub tint: [f32; 4],
    /// Height of the ground below its root body.
    pub ground: f32,
    /// How that height changes along x and y.
    pub slope: [f32; 2],
}

/// Number of simple solids.
pub(super) const SOLIDS: usize = 6;

/// A simple solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Solid {
    /// Ball of radius 1.
    Ball,
    /// Cylinder of radius 1 along z from -1 to 1, without lids.
    Tube,
    /// Cube from -1 to 1.
    Cube,
    /// Cone of radius 1, from z = 0 to its tip at z = 1.
    Cone,
    /// Flat ring in the xy plane, radius 1, a tenth wide.
    Ring,
    /// Cylinder of radius 1 along z from -1 to 1, with lids.
    Drum,
}

impl Solid {
    /// All solids in the order of the vertex buffer.
    pub const ALL: [Solid; SOLIDS] =
        [Solid::Ball, Solid::Tube, Solid::Cube, Solid::Cone, Solid::Ring, Solid::Drum];
}

/// A solid somewhere in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// Which solid.
    pub solid: Solid,
    /// World from solid; a rotation and scales along the solid's axes.
    pub place: Mat4,
    /// Colour and opacity.
    pub colour: [f32; 4],
}

impl Marker {
    /// A ball around it: middle and radius, metres.
    pub(super) fn sphere(&self) -> (Vec3, f32) {
        let axes = [self.place.x_axis, self.place.y_axis, self.place.z_axis];
        let squared: f32 = axes.iter().map(|axis| axis.truncate().length_squared()).sum();
        (self.place.w_axis.truncate(), squared.sqrt())
    }
}

/// Corner of a flat triangle in the world.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct RibbonVertex {
    /// World space.
    pub position: [f32; 3],
    /// Colour and opacity.
    pub colour: [f32; 4],
}

/// Everything in one picture.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The eye.
    pub view: View,
    /// What the shadows are fitted around.
    pub focus: Vec3,
    /// Characters.
    pub figures: Vec<Figure>,
    /// Hides the figures but not their shadows, to see the collision shapes alone.
    pub hide_figures: bool,
    /// Solids of one plain colour, in front of everything that is drawn before them.
    pub markers: Vec<Marker>,
    /// Opaque things of the world, which are lit, throw shadows and catch them. Their opacity says how they are marked,
    /// so that rotation and size can be seen: 1 darkens the edges of a cube, less paints every other octant.
    pub things: Vec<Marker>,
    /// Triangles, three vertices each.
    pub ribbons: Vec<RibbonVertex>,
}

impl Scene {
    /// Adds a line from `a` to `b`, a flat ribbon that faces the eye, `width` metres wide.
    pub fn line(&mut self, a: Vec3, b: Vec3, width: f32, colours: [[f32; 4]; 2]) {
        let across = (b - a).cross(self.view.eye - (a + b) * 0.5).normalize_or(Vec3::Z) * width * 0.5;
        let corners = [(a - across, 0), (a + across, 0), (b + across, 1), (b - across, 1)];
        for i in [0, 1, 2, 0, 2, 3] {
            let (position, end) = corners[i];
            self.ribbons.push(RibbonVertex { position: position.to_array(), colour: colours[end] });
        }
    }

    /// Adds an arrow.
    pub fn arrow(&mut self, from: Vec3, to: Vec3, radius: f32, colour: [f32; 4]) {
        let along = to - from;
        let length = along.length();
        if length < 1e-4 {
            return;
        }
        let turn = Quat::from_rotation_arc(Vec3::Z, along / length);
        let head = (4.0 * radius).min(0.5 * length);
        let middle = from + along * (0.5 * (length - head) / length);
        let shaft = Vec3::new(radius, radius, 0.5 * (length - head));
        let tip = Vec3::new(2.2 * radius, 2.2 * radius, head);
        let neck = to - along * (head / length);
        self.markers.push(Marker {
            solid: Solid::Tube,
            place: Mat4::from_scale_rotation_translation(shaft, turn, middle),
            colour,
        });
        self.markers.push(Marker {
            solid: Solid::Cone,
            place: Mat4::from_scale_rotation_translation(tip, turn, neck),
            colour,
        });
    }

    /// Adds a ball.
    pub fn ball(&mut self, centre: Vec3, radius: f32, colour: [f32; 4]) {
        let place = Mat4::from_scale_rotation_translation(Vec3::splat(radius), Quat::IDENTITY, centre);
        self.markers.push(Marker { solid: Solid::Ball, place, colour });
    }
}
