//! One character as the demo keeps it: controller, command, the last two poses, its history and its sums.

use std::sync::Arc;

use glam::Vec2;
use physics_bridge::{BodyPoses, Pose};
use policy_core::{
    Arithmetic, BlendMode, CharacterPack, CharacterState, Command, Controller, ControllerConfig,
    ControllerState, Goal, Heading, StateError, TickReport,
};

use super::bodies::BodyRef;
use super::rewind::{Ring, SavedTick};
use super::{SHOVED_BELOW_MPS, Totals};

/// A gait without a direction is held within this distance of where it came to rest, metres.
const HOLDS_WITHIN_M: f32 = 0.3;

/// A nearer target turns it too slowly, metres.
const TURNS_BEYOND_M: f32 = 3.0;

/// A blend that is nearer to its goal has arrived, in coordinates of a path.
const ARRIVED: f32 = 0.05;

/// It came to rest below this speed, metres per second.
const RESTS_BELOW_MPS: f32 = 0.7;

/// A character's controller, and what is known of its motion.
#[derive(Clone, Debug)]
pub struct SteeredCharacter {
    /// Steers it.
    pub controller: Controller,
    /// What it sensed after the last tick.
    pub state: CharacterState,
    /// What it was asked in the last tick.
    pub command: Command,
    /// Seconds it has been down with no skill to get up.
    pub(super) down_secs: f32,
    /// Seconds that the last shove still acts.
    pub(super) shoved_secs: f32,
    was_down: bool,
    falls: u32,
    /// Where a gait without a direction came to rest.
    place: Option<Vec2>,
    poses: [BodyPoses; 2],
    pose: Pose,
    /// One entry for each tick that the physics keeps; `None` where it keeps none.
    history: Option<Box<Ring<SavedTick>>>,
}

impl SteeredCharacter {
    pub(super) fn new(pack: Arc<CharacterPack>, mode: BlendMode, body: BodyRef<'_>) -> Self {
        let skeleton = body.skeleton().unwrap_or(pack.skeleton());
        let history =
            body.keeps_history().then(|| Box::new(Ring::new(body.control_hz(), &SavedTick::new(&pack))));
        let mut steered = Self {
            state: CharacterState::new(skeleton),
            poses: [BodyPoses::new(skeleton), BodyPoses::new(skeleton)],
            pose: Pose::new(skeleton),
            command: Command::default(),
            down_secs: 0.0,
            shoved_secs: 0.0,
            was_down: false,
            falls: 0,
            place: None,
            history,
            controller: Controller::with_config(pack, config(mode)),
        };
        steered.restart(body);
        steered
    }

    /// What the controller did in the last tick.
    #[must_use]
    pub fn report(&self) -> &TickReport {
        self.controller.report()
    }

    /// Where the root body is, seen from above.
    #[must_use]
    pub fn position(&self) -> Vec2 {
        self.state.root().position.truncate()
    }

    /// Where it looks.
    #[must_use]
    pub fn heading(&self) -> Heading {
        Heading::from_rotation(self.state.root().rotation)
    }

    /// Horizontal speed of the root body, metres per second.
    #[must_use]
    pub fn speed(&self) -> f32 {
        self.state.horizontal_speed()
    }

    /// True from a fall until it is on its feet again.
    #[must_use]
    pub fn is_down(&self) -> bool {
        self.controller.is_down()
    }

    /// False while a shove acts, and for a character that is down or fast.
    pub(super) fn can_be_shoved(&self, least_height: f32) -> bool {
        let root = self.state.root();
        let fast = root.linear_velocity.length() > SHOVED_BELOW_MPS;
        let low = self.state.root_height() < least_height;
        self.shoved_secs <= 0.0 && !fast && !low && !self.is_down()
    }

    /// Times it fell since it was put to its start.
    #[must_use]
    pub fn falls(&self) -> u32 {
        self.falls
    }

    /// How its controller makes an action of a blend.
    #[must_use]
    pub fn blend_mode(&self) -> BlendMode {
        self.controller.config().blend_mode
    }

    pub(super) fn forget_falls(&mut self) {
        self.falls = 0;
    }

    /// Poses `alpha` of the way from the last tick but one to the last.
    #[must_use]
    pub fn poses(&self, alpha: f32) -> BodyPoses {
        interpolated(&self.poses[0], &self.poses[1], alpha)
    }

    /// Takes the player's command. The target moves along, so that a crowd keeps its order.
    pub(super) fn receive(&mut self, command: &Command, player: Vec2) {
        self.command = *command;
        self.command.target = match command.target {
            Some(target) => {
                self.place = None;
                Some(target - player + self.position())
            }
            None => self.held_target(),
        };
    }

    /// Without a direction a gait such as a crouch wanders off. Its target is then the place where it came to rest; `None`
    /// while it is near that place.
    fn held_target(&mut self) -> Option<Vec2> {
        let holds = self.has_arrived() && (self.place.is_some() || self.speed() < RESTS_BELOW_MPS);
        if !holds || self.is_down() {
            self.place = None;
            return None;
        }
        let here = self.position();
        let place = *self.place.get_or_insert(here);
        let off = place - here;
        (off.length() > HOLDS_WITHIN_M).then(|| here + off.clamp_length_min(TURNS_BEYOND_M))
    }

    /// True when the blend is where the command wants it, and that is not the policy that stands still.
    fn has_arrived(&self) -> bool {
        let (position, graph) = (self.report().position, self.controller.pack().graph());
        match self.command.goal {
            Goal::Stay => false,
            Goal::Node(node) => node.index() > 0 && position.as_node() == Some(node),
            Goal::Path { path, coordinate } => graph.paths().get(path.index()).is_some_and(|path| {
                let now = path.coordinate(position);
                coordinate > 0.0 && now.is_some_and(|now| (now - coordinate.min(path.end())).abs() < ARRIVED)
            }),
        }
    }

    /// Updates poses, history and sums after a tick of `dt_secs`.
    pub(super) fn observe(&mut self, body: BodyRef<'_>, dt_secs: f32, totals: &mut Totals) {
        let before = self.position();
        self.take_pose(body);
        let down = self.is_down();
        let fell = down && !self.was_down;
        self.falls += u32::from(fell);
        totals.tick(before.distance(self.position()), down, fell);
        self.was_down = down;
        let helpless = down && self.controller.pack().recovery().is_none();
        self.down_secs = if helpless { self.down_secs + dt_secs } else { 0.0 };
        self.shoved_secs = (self.shoved_secs - dt_secs).max(0.0);
        self.remember();
        body.pose_into(&mut self.pose);
        totals.hash.absorb(&self.pose);
    }

    /// Updates poses after a tick whose physics diverged: the character is in its state before it, and so is the controller where
    /// a history is kept.
    pub(super) fn observe_divergence(&mut self, body: BodyRef<'_>) {
        self.load_saved(0);
        self.take_pose(body);
        self.stand_still();
    }

    /// Begins anew after a shared world put it back. The past stays: it can be taken back to before.
    pub(super) fn put_back(&mut self, body: BodyRef<'_>) {
        self.controller.reset();
        (self.down_secs, self.shoved_secs, self.was_down) = (0.0, 0.0, false);
        self.place = None;
        self.remember();
        self.take_pose(body);
        self.stand_still();
    }

    /// Forgets the past, as its world does.
    pub(super) fn forget_past(&mut self) {
        if let Some(history) = &mut self.history {
            history.clear();
        }
        self.remember();
    }

    /// Begins anew where the character was put.
    pub(super) fn restart(&mut self, body: BodyRef<'_>) {
        self.controller.reset();
        (self.down_secs, self.shoved_secs, self.was_down) = (0.0, 0.0, false);
        self.place = None;
        self.forget_past();
        self.take_pose(body);
        self.stand_still();
    }

    /// Goes back with the character, `age` ticks before the newest.
    pub(super) fn rewind_to(&mut self, age: usize, body: BodyRef<'_>) {
        self.load_saved(age);
        self.take_pose(body);
        self.stand_still();
    }

    /// Puts a new controller in the place of this one, its state carried over as bytes.
    ///
    /// # Errors
    /// When the bytes are refused; nothing is changed then.
    pub(super) fn renew_controller(&mut self) -> Result<(), StateError> {
        let pack = self.controller.pack();
        let mut state = ControllerState::new(pack);
        self.controller.save_into(&mut state);
        let mut bytes = vec![0; state.byte_len()];
        state.write_bytes(&mut bytes);
        let mut read = ControllerState::new(pack);
        read.read_bytes(pack, &bytes)?;
        let mut renewed = Controller::with_config(Arc::clone(pack), *self.controller.config());
        renewed.restore(&read)?;
        self.controller = renewed;
        Ok(())
    }

    /// Keeps the present tick beside that of the physics.
    fn remember(&mut self) {
        if let Some(history) = &mut self.history {
            let saved = history.next();
            self.controller.save_into(&mut saved.controller);
            (saved.down_secs, saved.shoved_secs) = (self.down_secs, self.shoved_secs);
            (saved.was_down, saved.falls, saved.place) = (self.was_down, self.falls, self.place);
        }
    }

    fn load_saved(&mut self, age: usize) {
        let Some(saved) = self.history.as_mut().and_then(|history| history.rewind_to(age)) else { return };
        let restored = self.controller.restore(&saved.controller);
        // It was saved by a controller of the same pack.
        debug_assert!(restored.is_ok(), "{restored:?}");
        (self.down_secs, self.shoved_secs) = (saved.down_secs, saved.shoved_secs);
        (self.was_down, self.falls, self.place) = (saved.was_down, saved.falls, saved.place);
    }

    /// Forgets the pose of the tick before.
    fn stand_still(&mut self) {
        let [before, now] = &mut self.poses;
        before.copy_from(now);
    }

    fn take_pose(&mut self, body: BodyRef<'_>) {
        body.sense_into(&mut self.state);
        self.poses.swap(0, 1);
        take_poses(&self.state, &mut self.poses[1]);
    }
}

/// Controllers of the demo repeat bit for bit on every machine.
fn config(mode: BlendMode) -> ControllerConfig {
    ControllerConfig { arithmetic: Arithmetic::Reproducible, blend_mode: mode, ..ControllerConfig::default() }
}

/// Writes where the bodies of a state are.
pub(super) fn take_poses(state: &CharacterState, out: &mut BodyPoses) {
    out.positions.clear();
    out.positions.extend(state.bodies.iter().map(|body| body.position));
    out.rotations.clear();
    out.rotations.extend(state.bodies.iter().map(|body| body.rotation));
}

/// Poses `alpha` of the way from `a` to `b`, which have as many bodies.
#[must_use]
pub fn interpolated(a: &BodyPoses, b: &BodyPoses, alpha: f32) -> BodyPoses {
    let mut poses = b.clone();
    for (position, from) in poses.positions.iter_mut().zip(&a.positions) {
        *position = from.lerp(*position, alpha);
    }
    for (rotation, from) in poses.rotations.iter_mut().zip(&a.rotations) {
        *rotation = from.slerp(*rotation, alpha);
    }
    poses
}
