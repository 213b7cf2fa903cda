//! The props as they are drawn: where they were at the last two ticks, and what holds them.

use glam::{Quat, Vec3};
use physics_bridge::{Motion, PropHandle, Solid, WorldEdit, WorldError};

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
    /// Its number in the scene.
    pub(super) of_scene: Option<usize>,
    /// What was thrown or put there.
    pub(super) loose: Option<LooseKind>,
    /// Position and rotation at the last tick but one and at the last.
    poses: [(Vec3, Quat); 2],
}

impl Piece {
    /// A piece at rest where `motion` has it.
    pub(super) fn new(handle: PropHandle, solid: Solid, paint: Paint, motion: &Motion) -> Self {
        let pose = (motion.position, motion.rotation);
        Self { handle, paint, anchor: None, solid, of_scene: None, loose: None, poses: [pose; 2] }
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
        let mut piece = Piece::new(handle, placed.prop.solid.clone(), placed.paint, &motion);
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
