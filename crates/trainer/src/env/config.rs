//! Settings of the environment, as a recipe has them.

use serde::{Deserialize, Serialize};

/// What the task reward asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Task {
    /// Go to the target at the commanded speed, facing it.
    #[default]
    Target,
    /// Stand: pelvis and head high, upright, still.
    Stand,
}

/// When an episode fails.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fall {
    /// When pelvis, torso, head, hands, lower arms or thighs come low.
    #[default]
    Upright,
    /// When the pelvis comes so low that the character lies.
    Lying,
    /// When who had stood up goes down again.
    Again,
    /// Never.
    Never,
}

/// Where episodes start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Start {
    /// Share of episodes that start in a pose of other clips than the skill's own.
    pub other: f32,
    /// Those clips; the parent's when there are none.
    pub clips: Vec<String>,
    /// Share of episodes that start in the pose of standing, set going at up to a walk's speed, as a game sets a character down.
    pub launched: f32,
    /// True to start in the clips of the nodes around the place on the course, not in the skill's own alone.
    pub along: bool,
    /// Share of episodes that start in the clips of any node of the course.
    pub anywhere: f32,
    /// Share of episodes that start limp on the ground, dropped there in a random attitude.
    pub ragdoll: f32,
    /// Share of episodes that start some second before an earlier failure of the same character, with the command it had
    /// then: what goes wrong once in a minute is met often.
    pub mishap: f32,
    /// Episodes, of skills trained together, that start where an episodic skill hands over to a node of the course, after it
    /// raised a character that was dropped limp.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<After>,
}

/// Starts where an episodic skill hands over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct After {
    /// The skill, by its name in the plan of the pack.
    pub skill: String,
    /// Share of episodes.
    pub share: f32,
}

/// Settings of the environment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EnvironmentConfig {
    /// Characters.
    pub characters: usize,
    /// Ticks of a rollout.
    pub steps: usize,
    /// Ticks of an episode.
    pub episode_ticks: u32,
    /// Speed that the skill is commanded to, metres per second.
    pub speed_mps: f32,
    /// Least error of the speed that the task reward takes for a large one, metres per second. A slow gait needs a small one, or
    /// to stand still is almost as good.
    pub least_width_mps: f32,
    /// What the task reward asks for.
    pub task: Task,
    /// Share of the reward for facing the target that only who nearly faces it gets. Without it a slow gait that goes
    /// sideways loses next to nothing.
    pub strict_facing: f32,
    /// Share of the task reward that is for the height of the pelvis: that of the clips at the place on the course, of skills
    /// trained together. It says how low to be between an upright gait and one on the ground.
    pub height: f32,
    /// Weight of the reward for imitating the clip tick by tick from where the episode starts in it; above zero an episode
    /// fails when it has lost the clip and times out at the clip's end. Of skills trained together, what imitators get beside
    /// the rewards for style and task.
    pub imitation: f32,
    /// Distance of the bodies from the clip's, seen from the pelvis, root mean square, at which it has lost the clip, metres. A
    /// slow gait needs a small one, or who rests in one pose never loses it.
    pub lost_metres: f32,
    /// Share of the time in which a character acts by the policy's mean alone, as in a game, in stretches; policies learn from
    /// the rest, judges and critic from all of it.
    pub quiet: f32,
    /// Seconds of such a stretch, least and most.
    pub quiet_secs: [f32; 2],
    /// Share of episodes, of skills trained together, that start at a node and whose character imitates the clips of every
    /// node that it rests at, from the moment on that it is most like.
    pub imitators: f32,
    /// When an episode fails.
    pub fall: Fall,
    /// Factor on the heights of the fall rule; less than 1 for low gaits.
    pub fall_height: f32,
    /// What a failure takes off the reward of its tick. What failing forgoes, some twenty to a hundred ticks of reward, weighs
    /// little beside style once falls are a minute apart.
    pub fall_cost: f32,
    /// What feet that slide cost, each tick, for a metre per second of all the weight; where an upright body is right.
    pub slide_cost: f32,
    /// Distance of new targets, metres, least and most.
    pub target_metres: [f32; 2],
    /// Seconds until a target is renewed, least and most.
    pub target_secs: [f32; 2],
    /// Share of targets that lie where the character stands.
    pub stop: f32,
    /// Share of episodes whose target goes ahead of the character, as the stick of a pad has it.
    pub stick: f32,
    /// Share of coordinates that go to and fro over the whole path, without a rest.
    pub sweep: f32,
    /// Seconds there and back, least and most.
    pub sweep_secs: [f32; 2],
    /// Seconds in which a moving coordinate crosses an edge, least and most.
    pub edge_sweep_secs: [f32; 2],
    /// Seconds that a moving coordinate rests where it came to, least and most: what goes wrong after a change may take its
    /// time.
    pub edge_rest_secs: [f32; 2],
    /// Share of moving coordinates that jump to where they are asked to.
    pub jump: f32,
    /// Seconds that the place on the course takes at least to cross an edge of this skill, as in a pack; 0 for none.
    pub edge_secs: f32,
    /// True to stay at the end of the path: of an edge, at the skill itself.
    pub alone: bool,
    /// Where episodes start.
    pub start: Start,
    /// Mean seconds between pushes of 0.2 s on the pelvis; zero for none.
    pub push_secs: f32,
    /// Largest force of a push, newton.
    pub push_newton: f32,
}

impl Default for EnvironmentConfig {
    fn default() -> Self {
        Self {
            characters: 512,
            steps: 16,
            episode_ticks: 300,
            speed_mps: 1.25,
            least_width_mps: 0.6,
            task: Task::Target,
            strict_facing: 0.0,
            height: 0.0,
            imitation: 0.0,
            imitators: 0.0,
            lost_metres: 0.35,
            quiet: 0.0,
            quiet_secs: [0.5, 3.0],
            fall: Fall::Upright,
            fall_height: 1.0,
            fall_cost: 0.0,
            slide_cost: 0.0,
            target_metres: [1.0, 10.0],
            target_secs: [2.0, 7.0],
            stop: 0.15,
            stick: 0.0,
            sweep: 0.0,
            sweep_secs: [4.0, 8.0],
            edge_sweep_secs: [0.5, 6.0],
            edge_rest_secs: [0.0, 2.0],
            jump: 0.15,
            edge_secs: 0.0,
            alone: false,
            start: Start::default(),
            push_secs: 0.0,
            push_newton: 0.0,
        }
    }
}
