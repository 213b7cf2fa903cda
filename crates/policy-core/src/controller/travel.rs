//! Where a character goes: on the graph, and in the world.

use glam::Vec2;

use super::Controller;
use crate::agility::{OnGraph, Urgency};
use crate::balance::{comes_to_rest, is_balanced};
use crate::capture_step::CaptureStep;
use crate::catching::{next_catch, out_of_skill};
use crate::command::Command;
use crate::fall::{Heights, step_heights};
use crate::give_way::GiveWayState;
use crate::ids::NodeId;
use crate::path::GraphPosition;
use crate::rising::{Rise, committed, rising_variant};
use crate::skill::SkillProgress;
use crate::state::CharacterState;
use crate::state_check::countdown_secs;
use crate::steering::{Steering, SteeringState};
use crate::strafe::waits_before_leaving;
use crate::turning::Turn;
use crate::variants::Lasting;

/// Seconds that a character has to stand up by itself out of a low gait without a rising variant.
const ASSIST_SECONDS: f32 = 0.1;

/// Seconds that one with a rising variant has.
const OWN_RISE_SECONDS: f32 = 2.2;

/// A character that has risen by itself is in balance, and settles for no longer than this, seconds.
const RISEN_SETTLES_SECS: f32 = 0.2;

impl Controller {
    /// Where on the graph to go: to the nearest node that a pending skill may start from, else to the command's goal.
    fn goal(&self, state: &CharacterState, command: &Command) -> GraphPosition {
        let (graph, report) = (self.pack.graph(), &self.state.report);
        let goal = match self.pending(state).map(|skill| &skill.entry) {
            Some(entry) => {
                let from = report.position.nearest_node();
                let cost = |node: &&NodeId| graph.routes().cost(from, **node);
                let nearest = entry.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
                nearest.map(|&node| GraphPosition::node(node))
            }
            None => command.goal.position(graph),
        };
        graph.settled(goal.unwrap_or(report.position), report.position)
    }

    /// Where on the graph to go, and the command; a character that is to leave a policy that strafes stays, and turns to its target first.
    /// One that comes to a stand for a skill, or stands after one, has no target: a gait that stands brakes only without.
    pub(super) fn bound_for(&self, state: &CharacterState, command: &Command) -> (Command, GraphPosition) {
        let (position, goal) = (self.state.report.position, self.goal(state, command));
        let held = self.state.report.pending_skill.is_some() || self.state.settle_secs > 0.0;
        let is_to_stand = goal.as_node().is_some_and(|node| self.pack.graph().node(node).stands());
        if held && is_to_stand && self.state.report.skill.is_none() {
            return (Command { target: None, ..*command }, goal);
        }
        match waits_before_leaving(self.pack.graph(), [position, goal], state, command.target) {
            Some(way) => (Command { facing: Some(way), ..*command }, position),
            None => (*command, goal),
        }
    }

    /// Moves along the graph towards a goal. Leaving a low gait requires standing first.
    pub(super) fn travel(
        &mut self,
        goal: GraphPosition,
        (state, heights): (&CharacterState, Heights),
        dt: f32,
    ) {
        if self.state.report.skill.is_some() {
            self.state.rising = Rise::default();
            return;
        }
        let graph = self.pack.graph();
        let report = &mut self.state.report;
        report.goal = goal;
        let mut next = report.position;
        let on_the_way = committed(graph, next).filter(|_| self.config.agility);
        graph.travel(&mut next, on_the_way.unwrap_or(report.goal), dt);
        // Once it rises it rises to its feet, whatever is asked of it meanwhile, unless that takes too long.
        let in_time = self.state.fall.rising_seconds <= OWN_RISE_SECONDS;
        let rises = self.state.rising.share > 0.0 && self.state.fall.rising_seconds > 0.0 && in_time;
        let waits = match rises {
            true => {
                self.state.fall.rising_seconds += dt;
                true
            }
            false => self.state.fall.holds_back(step_heights(graph, [report.position, next]), heights, dt),
        };
        let secs = self.state.fall.rising_seconds;
        let variant =
            if rises { Some(self.state.rising.variant) } else { rising_variant(graph, report.position) };
        let variant = variant.filter(|_| waits && self.config.agility && secs <= OWN_RISE_SECONDS);
        let stands = |variant: NodeId| heights.has_risen(graph.node(variant).fall_height.unwrap_or_default());
        let in_balance = || self.state.rising.share >= 1.0 && is_balanced(self.pack.skeleton(), state);
        let risen = variant.is_some_and(stands) && in_balance();
        self.state.rising = self.state.rising.next(variant.filter(|_| !risen), dt);
        match variant {
            Some(_) if risen => {
                report.position = graph.standing().map_or(next, GraphPosition::node);
                self.state.fall.reset();
                self.state.settle_secs = countdown_secs(self.config.settle_secs.min(RISEN_SETTLES_SECS));
            }
            Some(_) => {}
            None if !waits => report.position = next,
            None => self.be_raised(secs),
        }
    }

    /// Starts the recovery skill of a character that has not stood up by itself in time.
    fn be_raised(&mut self, rising_secs: f32) {
        let assists = self.config.assist_rise && rising_secs > ASSIST_SECONDS;
        if let Some(recovery) = self.pack.recovery().filter(|_| assists) {
            let pending = self.state.report.pending_skill;
            self.start_skill(SkillProgress::start(recovery));
            self.state.fall.rising_seconds = rising_secs;
            // The character rises for it.
            self.state.report.pending_skill = pending;
        }
    }

    /// The command, or to stand for a moment. Skills and falls are none of its business, nor is the speed that a turn takes.
    pub(super) fn giving_way(&mut self, state: &CharacterState, command: &Command, dt: f32) -> Command {
        let report = &self.state.report;
        let turns = self.state.urgency.turn.turns;
        let acts = report.skill.is_none() && report.pending_skill.is_none() && !report.fallen && !turns;
        let memory = &mut self.state.give_way;
        match self.config.give_way.filter(|_| acts) {
            Some(give_way) => {
                give_way.adjusted(memory, (self.pack.graph(), report.position), state, command, dt)
            }
            None => {
                *memory = GiveWayState::default();
                *command
            }
        }
    }

    /// How far the character is from what it is asked to do, after the way on the graph.
    pub(super) fn follow_urgency(&mut self, state: &CharacterState, target: Option<Vec2>, dt: f32) {
        let place = OnGraph::of(self.pack.graph(), &self.state.report);
        let urgency = &mut self.state.urgency;
        *urgency = match self.config.agility {
            true => urgency.next(place, state, target, dt),
            false => Urgency::default(),
        };
        // Out of a skill nothing has learned to turn at once.
        if self.state.report.skill.is_some() || self.state.settle_secs > 0.0 {
            urgency.turn = Turn::default();
        }
        // What held it up stops it, and is still there when it goes on: that is no stop, and no start.
        if self.state.give_way.stop_secs > 0.0 {
            (urgency.start.secs, urgency.stop) = (0.0, Lasting::default());
        }
    }

    /// Steps under a body that tips over backwards, and catches a push off its course, or the end of a skill.
    pub(super) fn keep_balance(&mut self, state: &CharacterState, command: &Command, dt: f32) {
        let report = &self.state.report;
        // Skills, falls and blends chosen by hand are none of its business.
        let acts =
            self.config.capture_steps && report.skill.is_none() && !report.fallen && command.blend.is_none();
        let (graph, skeleton) = (self.pack.graph(), self.pack.skeleton());
        let place = OnGraph::of(graph, report);
        (self.state.capture_step, self.state.catch) = match acts {
            true => {
                let at = comes_to_rest(skeleton, state);
                let target = command.target;
                let (urgency, unevenness) = (&self.state.urgency, self.state.unevenness);
                let catch = out_of_skill(self.state.catch, self.state.settle_secs, unevenness);
                (
                    self.state.capture_step.next((graph, report.position), (state, at), target, dt),
                    next_catch(catch, place, (skeleton, state), target, urgency, unevenness, dt),
                )
            }
            false => (CaptureStep::default(), Lasting::default()),
        };
    }

    /// The target that the policy is to see. Without one there is no course to hold, and the target of a skill stays as it is. A
    /// character that strafes gets the trim alone, and one that turns gets it as far as its gaits act. A gait that turns on the spot
    /// sways, and its course with it: it gets no trim, and no lead while it turns.
    pub(super) fn steered(
        &mut self,
        state: &CharacterState,
        target: Option<Vec2>,
        strafing: f32,
        dt: f32,
    ) -> Option<Vec2> {
        let steering = self.config.steering.filter(|_| self.state.report.skill.is_none());
        let (Some(steering), Some(target)) = (steering, target) else {
            self.state.steering = SteeringState::default();
            return target;
        };
        let turn = self.state.urgency.turn;
        let place = OnGraph::of(self.pack.graph(), &self.state.report);
        let (steering, trim_share) = match place.all_turn_on_the_spot() {
            true => (Steering { lead: if turn.turns { 0.0 } else { steering.lead }, ..steering }, 0.0),
            false => (steering, 1.0 - turn.share),
        };
        let memory = &mut self.state.steering;
        Some(match strafing > 0.0 {
            true => steering.trimmed(memory, state, target, dt),
            false => steering.adjusted(memory, state, target, trim_share, dt),
        })
    }
}
