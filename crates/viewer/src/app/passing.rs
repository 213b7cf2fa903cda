//! Time that passes: ticks of the world, the camera that follows, and what is told when the physics diverges.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use glam::Vec3;
use physics::PhysicsCharacter;

use super::{App, Failure, Grab};
use crate::sim::{Divergence, Held, Playback};
use crate::text::counted;

/// Ticks of one frame stop after this time; a frame at 30 Hz is as long.
const TICKS_BUDGET: Duration = Duration::from_millis(30);

/// What is nearer to the middle between two players hides neither, metres.
const BETWEEN_PLAYERS_M: f32 = 1.0;

/// Failures of this process so far: each has a file of its own.
static FAILURES: AtomicUsize = AtomicUsize::new(0);

impl App {
    /// Lets `dt` seconds of the clock on the wall pass: physics in whole ticks, camera, gauges.
    pub fn advance(&mut self, dt: f32) {
        self.keys.advance(dt);
        self.pad_taps.see(self.pad.state.buttons);
        self.second_taps.see(self.pad.second.unwrap_or_default().buttons);
        self.watch_user(dt);
        self.refused =
            self.refused.take().map(|(what, secs)| (what, secs - dt)).filter(|(_, secs)| *secs > 0.0);
        if let Some(analysis) = self.analysis_soon.as_ref().and_then(|soon| soon.try_recv().ok()) {
            (self.analysis, self.analysis_soon) = (Some(analysis), None);
        }
        if self.failure.is_none() {
            let due = self.clock.ticks_due(dt);
            let ran = self.run_ticks(due);
            self.clock.ran(ran, dt);
        }
        self.follow(dt.min(0.1), self.alpha());
    }

    /// Runs the ticks of a frame; returns how many. What does not fit into the time of a frame is dropped: a world that is too slow
    /// falls behind, and the picture does not. A failure and the end of a replay end it early.
    fn run_ticks(&mut self, due: u32) -> u32 {
        let (start, was_paused) = (Instant::now(), self.clock.paused);
        for tick in 1..=due {
            let divergences = self.tick();
            if let Some(first) = divergences.first() {
                self.fail(first, &divergences);
            }
            let is_over = self.failure.is_some() || self.clock.paused != was_paused;
            if is_over || start.elapsed() > TICKS_BUDGET {
                return tick;
            }
        }
        due
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
        let hit = self.camera.line().and_then(|(from, line)| self.hidden_at(from, line));
        self.camera.keep_clear(dt, hit);
        self.camera.fly(dt, self.keys.flight());
    }

    /// How far along the camera's line something hides the players, metres. They are looked through. With two of them the line begins
    /// between them, where a wall may be: what is that near does not count.
    fn hidden_at(&mut self, from: Vec3, line: Vec3) -> Option<f32> {
        let players = 1 + usize::from(self.sim.has_second_player());
        let hit = self.sim.shared_mut()?.hidden_at(from, line, line.length(), players)?;
        (players == 1 || hit > BETWEEN_PLAYERS_M).then_some(hit)
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
        self.keys.end_tick();
        self.pad_taps.clear();
        self.second_taps.clear();
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
        let (process, number) = (std::process::id(), FAILURES.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(format!("policy-space-diverged-{process}-{number}.json"));
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
