//! The props as they are drawn: where they were at the last two ticks, and what holds them.

use glam::{Quat, Vec3};
use physics_bridge::{
    CharacterHandle, FixtureHandle, Motion, Prop, PropHandle, Solid, WorldEdit, WorldError,
};

use super::{LooseKind, SharedWorld};
use playground::{Paint, Playground};

/// A prop of the scene, or one that was thrown or put there.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// In the physics.
    pub handle: PropHandle,
    /// Its colour.
    pub paint: Paint,
    /// The point in the world that it hangs on or turns about, metres.
    pub anchor: Option<Vec3>,
    /// Its shape.
    pub solid: Solid,
    /// Kilograms.
    pub mass_kg: f32,
    /// Its number in the scene.
    pub(super) of_scene: Option<usize>,
    /// What was thrown or put there.
    pub(super) loose: Option<LooseKind>,
    /// Position and rotation at the last tick but one and at the last.
    poses: [(Vec3, Quat); 2],
}

impl Piece {
    /// A piece at rest where `motion` has it.
    pub(super) fn new(handle: PropHandle, prop: &Prop, paint: Paint, motion: &Motion) -> Self {
        let pose = (motion.position, motion.rotation);
        let (solid, mass_kg) = (prop.solid.clone(), prop.mass_kg);
        Self { handle, paint, anchor: None, solid, mass_kg, of_scene: None, loose: None, poses: [pose; 2] }
    }

    /// From end to end, metres; of a hull, which no scene has, 0.
    #[must_use]
    pub fn length_m(&self) -> f32 {
        match self.solid {
            Solid::Sphere { radius } => 2.0 * radius,
            Solid::Capsule { radius, half_length } => 2.0 * (radius + half_length),
            Solid::Cylinder { radius, half_length } => 2.0 * radius.max(half_length),
            Solid::Cuboid { half_extents } => 2.0 * half_extents.max_element(),
            Solid::Hull { .. } => 0.0,
        }
    }

    /// Position and rotation `alpha` of the way into the last tick.
    #[must_use]
    pub fn pose(&self, alpha: f32) -> (Vec3, Quat) {
        let [(from, turned), (to, turns)] = self.poses;
        (from.lerp(to, alpha), turned.slerp(turns, alpha))
    }
}

/// Adds the props of a scene.
pub(super) fn add(edit: &mut WorldEdit<'_>, scene: &Playground) -> Result<Vec<Piece>, WorldError> {
    let mut pieces = Vec::with_capacity(scene.props.len());
    for (index, placed) in scene.props.iter().enumerate() {
        let motion = placed.start();
        let handle = edit.add_prop(placed.prop.clone(), motion)?;
        let mut piece = Piece::new(handle, &placed.prop, placed.paint, &motion);
        piece.of_scene = Some(index);
        if let Some(joint) = placed.joint {
            edit.join(handle, None, joint)?;
            piece.anchor = joint.anchor();
        }
        pieces.push(piece);
    }
    Ok(pieces)
}

impl SharedWorld {
    /// The props that are in the world.
    #[must_use]
    pub fn pieces(&self) -> &[Piece] {
        &self.state.pieces
    }

    /// Colour of a fixture of the scene.
    #[must_use]
    pub fn paint_of(&self, fixture: FixtureHandle) -> Option<Paint> {
        self.fixtures.iter().find(|(handle, _)| *handle == fixture).map(|(_, paint)| *paint)
    }

    /// The index of a character.
    #[must_use]
    pub fn index_of(&self, character: CharacterHandle) -> Option<usize> {
        self.characters.iter().position(|&handle| handle == character)
    }

    /// True for a pendulum that is kept swinging.
    #[must_use]
    pub fn is_driven(&self, piece: &Piece) -> bool {
        piece.of_scene.is_some_and(|index| self.scene.props[index].swing_m.is_some())
    }

    /// Notes where the props are. Those that the physics has taken out are forgotten.
    pub(super) fn look(&mut self) {
        let world = &self.world;
        self.state.pieces.retain_mut(|piece| {
            let Ok(motion) = world.motion(piece.handle) else { return false };
            piece.poses = [piece.poses[1], (motion.position, motion.rotation)];
            true
        });
    }
}
