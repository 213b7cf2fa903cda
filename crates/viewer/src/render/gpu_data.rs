//! The layouts that the shaders read, and how a [`Scene`] becomes them.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3};

use super::appearance::ContactPatch;
use super::config::RenderConfig;
use super::scene::{Figure, Scene};

/// `Frame` of `common.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct FrameData {
    clip_from_world: Mat4,
    world_from_clip: Mat4,
    sun_clip_from_world: Mat4,
    eye: [f32; 4],
    to_sun: [f32; 4],
    sun: [f32; 4],
    zenith: [f32; 4],
    horizon: [f32; 4],
    bounce: [f32; 4],
    casters: [f32; 4],
    fade: [f32; 4],
}

/// What `skinned.wgsl` reads of a whole character.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct InstanceData {
    pub(super) tint: [f32; 4],
    pub(super) ground: f32,
    pub(super) first: u32,
}

/// A patch of `contact.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct ContactData {
    pub(super) centre: [f32; 4],
    pub(super) along: [f32; 4],
    pub(super) across: [f32; 4],
}

/// An instance of `shape.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct MarkerData {
    pub(super) rows: [[f32; 4]; 3],
    pub(super) colour: [f32; 4],
}

impl MarkerData {
    pub(super) fn new(place: Mat4, colour: [f32; 4]) -> Self {
        let rows = place.transpose();
        Self { rows: [rows.x_axis, rows.y_axis, rows.z_axis].map(|r| r.to_array()), colour }
    }
}

/// The part of the ground that gets shadows, seen from the sun.
struct SunView {
    clip_from_world: Mat4,
    /// World size of the map.
    extent: f32,
    /// Where something casts, texture coordinates: min, max.
    casters: [f32; 4],
}

impl FrameData {
    pub(super) fn new(scene: &Scene, aspect: f32, config: &RenderConfig) -> Self {
        let clip_from_world = scene.view.clip_from_world(aspect);
        let sun = SunView::fit(scene, config);
        let light = &config.light;
        let texel = sun.extent / config.shadow_size as f32;
        let penumbra = light.penumbra_m.max(1.5 * texel) / sun.extent;
        Self {
            clip_from_world,
            world_from_clip: clip_from_world.inverse(),
            sun_clip_from_world: sun.clip_from_world,
            eye: scene.view.eye.extend(light.exposure).to_array(),
            to_sun: light.to_sun.normalize().extend(config.shadow_taps as f32).to_array(),
            sun: light.sun.extend(penumbra).to_array(),
            zenith: light.zenith.extend(0.0).to_array(),
            horizon: light.horizon.extend(0.0).to_array(),
            bounce: light.bounce.extend(0.0).to_array(),
            casters: sun.casters,
            fade: [14.0, 75.0, texel, 0.0],
        }
    }
}

impl SunView {
    /// Fits the map around the focus and the figures near it, and keeps it still to whole texels.
    fn fit(scene: &Scene, config: &RenderConfig) -> Self {
        let to_sun = config.light.to_sun.normalize();
        let near = |p: &&Figure| p.positions[0].distance(scene.focus) < config.shadow_reach_m;
        let shown = &scene.figures;
        let far = shown.iter().filter(near).map(|f| f.positions[0].distance(scene.focus)).fold(0.0, f32::max);
        // Steps of a fifth, so that the size does not change every frame.
        let radius =
            (2.0 * 1.2_f32.powf(((far + 1.4) / 2.0).max(1.0).log(1.2).ceil())).min(config.shadow_reach_m);
        let texel = 2.0 * radius / config.shadow_size as f32;
        let axes = glam::camera::rh::view::look_at_mat4(to_sun, Vec3::ZERO, Vec3::Z);
        let centre = axes.transform_point3(scene.focus);
        let centre =
            Vec3::new((centre.x / texel).round() * texel, (centre.y / texel).round() * texel, centre.z);
        let depth = 2.0 * radius + 6.0;
        let projection = glam::camera::rh::proj::directx::orthographic(
            centre.x - radius,
            centre.x + radius,
            centre.y - radius,
            centre.y + radius,
            -centre.z - depth,
            -centre.z + depth,
        );
        let clip_from_world = projection * axes;
        let mut low = Vec2::splat(f32::INFINITY);
        let mut high = Vec2::splat(f32::NEG_INFINITY);
        for position in shown.iter().flat_map(|f| &f.positions) {
            let clip = clip_from_world.project_point3(*position);
            let uv = Vec2::new(clip.x, -clip.y) * 0.5 + 0.5;
            (low, high) = (low.min(uv), high.max(uv));
        }
        for thing in &scene.things {
            let (centre, reach) = thing.sphere();
            if centre.distance(scene.focus) < radius + reach {
                let clip = clip_from_world.project_point3(centre);
                let (uv, grown) = (Vec2::new(clip.x, -clip.y) * 0.5 + 0.5, Vec2::splat(0.5 * reach / radius));
                (low, high) = (low.min(uv - grown), high.max(uv + grown));
            }
        }
        let margin = Vec2::splat((0.32 + config.light.penumbra_m) / (2.0 * radius));
        let (low, high) = ((low - margin).max(Vec2::splat(0.002)), (high + margin).min(Vec2::splat(0.998)));
        Self { clip_from_world, extent: 2.0 * radius, casters: [low.x, low.y, high.x, high.y] }
    }
}

/// Writes the dark patches under a figure.
pub(super) fn contacts(patches: &[ContactPatch], figure: &Figure, out: &mut Vec<ContactData>) {
    let slope = Vec2::from(figure.slope);
    for patch in patches {
        let i = patch.body.index();
        let (position, rotation) = (figure.positions[i], figure.rotations[i]);
        let at = position + rotation * patch.middle;
        let ground = figure.ground + slope.dot((at - figure.positions[0]).truncate());
        let height = (at.z - ground).max(0.0);
        let near = 1.0 - height / patch.vanish;
        if near <= 0.0 {
            continue;
        }
        let forward = (rotation * Vec3::X).truncate().normalize_or(Vec2::X);
        let grown = 1.0 + 0.6 * (1.0 - near);
        let on_ground = |v: Vec2| v.extend(slope.dot(v)).extend(0.0).to_array();
        out.push(ContactData {
            centre: [at.x, at.y, ground + 0.004, patch.darkness * near],
            along: on_ground(forward * patch.half_length * grown),
            across: on_ground(forward.perp() * patch.half_width * grown),
        });
    }
}
