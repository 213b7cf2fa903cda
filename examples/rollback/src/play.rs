//! Two players in real time, each with a copy of the game, over a made-up network.

use std::fmt;
use std::time::{Duration, Instant};

use anyhow::{bail, ensure};
use ggrs::{DesyncDetection, GgrsError, GgrsEvent, P2PSession, PlayerType, SessionBuilder, SessionState};
use lockstep::script_pad;

use crate::game::{Game, Netplay};
use crate::network::{Socket, Weather, Wire};

/// Frames a second.
const FPS: usize = 30;
/// Most frames that a player may be ahead of what it knows.
const MAX_PREDICTION: usize = 8;
/// Frames between a press and its effect.
const INPUT_DELAY: usize = 1;
/// Longest time for the two to find each other.
const PATIENCE: Duration = Duration::from_secs(30);

/// What a game came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Played {
    /// Frames that both players agree on.
    pub confirmed: i32,
    /// For each player: frames run, rollbacks, most frames run again at once, times it waited for the other.
    pub players: [[u32; 4]; 2],
    /// Packets sent and lost.
    pub packets: [u32; 2],
    /// The hash of the last frame that both agree on.
    pub hash: u64,
}

impl fmt::Display for Played {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "both players agree on every one of {} frames, state {:016x}",
            self.confirmed, self.hash
        )?;
        for (index, [run, rollbacks, deepest, waited]) in self.players.iter().enumerate() {
            writeln!(
                f,
                "player {index}: {run} frames run, {rollbacks} rollbacks of at most {deepest} frames, waited {waited} times"
            )?;
        }
        write!(f, "packets: {} sent, {} lost", self.packets[0], self.packets[1])
    }
}

/// Plays the script of `lockstep` for so many frames; `paced` at 30 a second, else as fast as packets arrive.
///
/// # Errors
/// When the two do not find each other, or their states differ in a frame.
pub fn run(frames: u32, weather: Weather, paced: bool) -> anyhow::Result<Played> {
    let wire = Wire::new(weather);
    let mut sessions = [session(0, &wire)?, session(1, &wire)?];
    let mut games = [Game::new(2)?, Game::new(2)?];
    let mut waited = [0; 2];
    let start = Instant::now();
    while sessions.iter().any(|session| session.current_state() != SessionState::Running) {
        sessions.iter_mut().for_each(P2PSession::poll_remote_clients);
        ensure!(start.elapsed() < PATIENCE, "expected the players to find each other within {PATIENCE:?}");
        std::thread::sleep(Duration::from_millis(2));
    }
    let mut next = Instant::now();
    // Each goes on until what it knows for sure has reached the last frame.
    while sessions.iter().any(|session| session.confirmed_frame() < frames as i32) {
        for (index, (session, game)) in sessions.iter_mut().zip(&mut games).enumerate() {
            session.poll_remote_clients();
            for event in session.events() {
                if let GgrsEvent::DesyncDetected { frame, local_checksum, remote_checksum, .. } = event {
                    bail!(
                        "in frame {frame}: expected the state {local_checksum:016x} of both players, found {remote_checksum:016x}"
                    );
                }
                ensure!(!matches!(event, GgrsEvent::Disconnected { .. }), "player {index} lost the other");
            }
            let pad = script_pad(session.current_frame().max(0) as u32 % lockstep::SCRIPT_TICKS, index);
            session.add_local_input(index, pad.into())?;
            match session.advance_frame() {
                Ok(requests) => game.handle(requests)?,
                Err(GgrsError::PredictionThreshold) => waited[index] += 1,
                Err(error) => return Err(error.into()),
            }
        }
        next += Duration::from_secs(1) / FPS as u32;
        let pause =
            if paced { next.saturating_duration_since(Instant::now()) } else { Duration::from_millis(1) };
        std::thread::sleep(pause);
    }
    let confirmed = sessions.iter().map(P2PSession::confirmed_frame).min().unwrap_or(0);
    let [first, second] = &games;
    // GGRS's own report of a difference comes a second late.
    for (frame, hash) in first.hashes().range(..=confirmed) {
        let other = second.hashes().get(frame);
        ensure!(
            other == Some(hash),
            "in frame {frame}: expected the state {hash:016x} of both, found {other:016x?}"
        );
    }
    let hash = first.hashes().range(..=confirmed).next_back().map_or(0, |(_, hash)| *hash);
    let wire = wire.borrow();
    let of = |index: usize| {
        let game = &games[index];
        [game.run, game.rollbacks, game.deepest, waited[index]]
    };
    Ok(Played { confirmed, players: [of(0), of(1)], packets: [wire.sent, wire.lost], hash })
}

fn session(
    index: usize,
    wire: &std::rc::Rc<std::cell::RefCell<Wire>>,
) -> Result<P2PSession<Netplay>, GgrsError> {
    let other = 1 - index;
    SessionBuilder::<Netplay>::new()
        .with_num_players(2)?
        .with_fps(FPS)?
        .with_max_prediction_window(MAX_PREDICTION)
        .with_input_delay(INPUT_DELAY)
        .with_desync_detection_mode(DesyncDetection::On { interval: FPS as u32 })
        .add_player(PlayerType::Local, index)?
        .add_player(PlayerType::Remote(other), other)?
        .start_p2p_session(Socket::new(wire, index))
}
