//! Time that passes: ticks of the world, the camera that follows, and what is told when the physics diverges.

use glam::Vec3;
use physics::PhysicsCharacter;

use super::{App, Failure, Grab};
use crate::sim::{Divergence, Held, Playback};
use crate::text::counted;

impl App {
    /// Lets `dt` seconds of the clock on the wall pass: physics in whole ticks, camera, gauges.
    pub fn advance(&mut self, dt: f32) {
        self.keys.advance(dt);
        self.watch_user(dt);
        self.refused =
            self.refused.take().map(|(what, secs)| (what, secs - dt)).filter(|(_, secs)| *secs > 0.0);
        if let Some(analysis) = self.analysis_soon.as_ref().and_then(|soon| soon.try_recv().ok()) {
            (self.analysis, self.analysis_soon) = (Some(analysis), None);
        }
        if self.failure.is_none() {
            for _ in 0..self.clock.ticks_due(dt) {
                let divergences = self.tick();
                if let Some(first) = divergences.first() {
                    self.fail(first, &divergences);
                    break;
                }
            }
        }
        self.follow(dt.min(0.1), self.alpha());
    }

    /// The camera takes `dt` seconds to follow the player, which is `alpha` of the way into the last tick.
    pub fn follow(&mut self, dt: f32, alpha: f32) {
        let input = self.input();
        let player = self.sim.player();
        let (root, apart) = self.middle(alpha);
        let (heading, ground) = (player.heading(), player.state.ground_height);
        self.camera.make_room_for(dt, apart);
        self.follow_compared(dt, alpha);
        let stick = self.layout.preferences.stick(input.right_stick);
        self.camera.advance(dt, stick, root, heading, ground);
        self.camera.follow_head(dt, self.head(alpha));
        let hit = self
            .camera
            .line()
            .and_then(|(from, line)| self.sim.shared_mut()?.hidden_at(from, line, line.length()));
        self.camera.keep_clear(dt, hit);
        self.camera.fly(dt, self.keys.flight());
    }

    /// One tick of the world. Characters whose physics diverged are in their state before it.
    pub fn tick(&mut self) -> Vec<Divergence> {
        self.pull();
        self.follow_tour();
        let Some((input, camera)) = self.steering() else { return Vec::new() };
        self.follow_second();
        self.give_back_to_triggers(&input);
        self.sim.overrides.blend = self.layers.blend();
        let divergences = self.sim.tick(&input, camera);
        self.follow_replay(&input, camera);
        self.observe_first_steps(&input);
        self.note_refusal();
        self.follow_race();
        self.ear.hear(&self.sim, self.camera.listener());
        if self.sim.playback().is_some_and(Playback::has_restarted) {
            self.trail.clear();
        }
        self.trail.follow(&self.sim);
        self.plots.tick(&self.sim);
        if let Some(analysis) = &mut self.analysis {
            analysis.follow(self.sim.player());
        }
        divergences
    }

    /// Between the last tick but one and the last, where the picture is.
    #[must_use]
    pub fn alpha(&self) -> f32 {
        if self.clock.paused || self.failure.is_some() { 1.0 } else { self.clock.alpha() }
    }

    /// Tells of all divergences of a tick at once, in the words of the first.
    fn fail(&mut self, first: &Divergence, all: &[Divergence]) {
        let path = std::env::temp_dir().join("policy-space-diverged.json");
        let saved = first.replay.as_ref().is_some_and(|replay| replay.save(&path).is_ok());
        let replay = saved.then(|| path.display().to_string());
        let mut what = format!("character {}: {}", first.character, first.what);
        if all.len() > 1 {
            what += &format!(" (and {})", counted(all.len() as u64 - 1, "more character"));
        }
        let characters = all.iter().map(|divergence| divergence.character).collect();
        self.failure = Some(Failure { what, replay, characters });
    }

    /// Pulls the body that the mouse holds.
    fn pull(&mut self) {
        let pulled = self.grab.and_then(|grab| Some((grab.held, self.origin_of(grab.held)? + grab.pull)));
        if let Some(shared) = self.sim.shared_mut() {
            shared.hold(pulled);
        } else if let Some(Grab { held: Held::Body(index, body), .. }) = self.grab {
            let force = self.grab.map_or(Vec3::ZERO, |grab| grab.force());
            // A force that is out of range is not worth stopping for: the next frame brings another.
            let secs = self.sim.tick_secs();
            let _ = self.sim.character_mut(index).push(body, force, secs);
        }
    }
}
