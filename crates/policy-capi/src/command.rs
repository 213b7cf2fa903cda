//! What a game asks of a character each tick.

use policy_core::glam::Vec2;
use policy_core::training::BlendTerm;
use policy_core::{Blend, CharacterPack, Command, Goal, NodeId, PathId, PolicyId, SkillId};

use crate::border::{finite, index, input};
use crate::error::{PsStatus, fail};
use crate::{PS_MAX_BLEND_TERMS, PS_MAX_LAYERS};

/// Where on the graph to go.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsGoal {
    /// Stay at the present position.
    Stay = 0,
    /// A coordinate on a path.
    Path = 1,
    /// A node, by the cheapest way.
    Node = 2,
}

/// One policy's part in a blend.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PsBlendTerm {
    /// The policy: index of its node.
    pub policy: i32,
    /// Blend weight in each layer, first to last; layers that the policy lacks are ignored.
    pub weights: [f32; PS_MAX_LAYERS],
}

/// What a game asks of a character each tick. Zeros mean: stay.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PsCommand {
    /// Not 0: go to `target`. 0: stand where it is.
    pub has_target: i32,
    /// Point on the ground, world x and y, metres.
    pub target: [f32; 2],
    /// Not 0: face along `facing`, with a policy that strafes. 0: face the target.
    pub has_facing: i32,
    /// Direction to face, world x and y, of any length.
    pub facing: [f32; 2],
    /// PsGoal.
    pub goal: i32,
    /// The path or node of the goal.
    pub goal_index: i32,
    /// Coordinate on the path: i + t lies between its nodes i and i + 1. Clamped to the path.
    pub coordinate: f32,
    /// Not 0: request `skill`. It stays pending until the position on the graph allows it.
    pub has_skill: i32,
    /// The skill that is requested.
    pub skill: i32,
    /// Blend weights that replace the position on the graph, or NULL.
    pub blend: *const PsBlendTerm,
    /// Entries of `blend`, at most PS_MAX_BLEND_TERMS; 0 for none.
    pub blend_count: usize,
}

impl Default for PsCommand {
    fn default() -> Self {
        Self {
            has_target: 0,
            target: [0.0; 2],
            has_facing: 0,
            facing: [0.0; 2],
            goal: PsGoal::Stay as i32,
            goal_index: 0,
            coordinate: 0.0,
            has_skill: 0,
            skill: 0,
            blend: std::ptr::null(),
            blend_count: 0,
        }
    }
}

impl PsCommand {
    /// The command for a controller of `pack`.
    ///
    /// # Safety
    /// `blend` is as the contract of every function says.
    pub(crate) unsafe fn checked(&self, pack: &CharacterPack) -> Result<Command, PsStatus> {
        let vector = |what, has: i32, [x, y]: [f32; 2]| match has {
            0 => Ok(None),
            _ => Ok(Some(Vec2::new(finite(what, x)?, finite(what, y)?))),
        };
        let target = vector("the target", self.has_target, self.target)?;
        let facing = vector("the way to face", self.has_facing, self.facing)?;
        let graph = pack.graph();
        let goal = match self.goal {
            0 => Goal::Stay,
            1 => Goal::Path {
                path: PathId::new(index("path", self.goal_index, graph.paths().len())?),
                coordinate: finite("the coordinate", self.coordinate)?,
            },
            2 => Goal::Node(NodeId::new(index("node", self.goal_index, graph.nodes().len())?)),
            other => {
                let text = format_args!("expected a goal of 0, 1 or 2, found {other}");
                return Err(fail(PsStatus::BadIndex, text));
            }
        };
        let skill = match self.has_skill {
            0 => None,
            _ => Some(SkillId::new(index("skill", self.skill, pack.skills().len())?)),
        };
        // SAFETY: the caller's promise is passed on.
        let blend = unsafe { self.blend(pack) }?;
        Ok(Command { target, facing, goal, skill, blend })
    }

    /// The blend that replaces the position.
    ///
    /// # Safety
    /// `blend` is as the contract of every function says.
    unsafe fn blend(&self, pack: &CharacterPack) -> Result<Option<Blend>, PsStatus> {
        if self.blend_count == 0 {
            return Ok(None);
        }
        if self.blend_count > PS_MAX_BLEND_TERMS {
            let found = self.blend_count;
            let text = format_args!("expected at most {PS_MAX_BLEND_TERMS} terms of a blend, found {found}");
            return Err(fail(PsStatus::WrongCount, text));
        }
        // SAFETY: the caller's promise is passed on.
        let terms = unsafe { input("terms of a blend", self.blend, self.blend_count, self.blend_count) }?;
        let mut blend = Blend::default();
        for term in terms {
            let policy = PolicyId::new(index("policy", term.policy, pack.policies().len())?);
            for weight in term.weights {
                finite("a blend weight", weight)?;
            }
            let pushed = blend.push(BlendTerm { policy, weights: term.weights });
            pushed.expect("at most as many terms as a blend holds");
        }
        Ok(Some(blend))
    }
}
