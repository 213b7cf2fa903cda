//! GGRS's sync test: after every frame goes back, runs the frames again and compares the hashes.

use std::time::Instant;

use ggrs::SessionBuilder;
use lockstep::{SCRIPT_TICKS, script_pad};

use crate::game::{Game, Netplay};

/// Runs so many frames, each of the last `distance` again, and says how many were run in all.
///
/// # Errors
/// When a frame that is run again ends in another state.
pub fn run(frames: u32, distance: usize) -> anyhow::Result<String> {
    let mut session = SessionBuilder::<Netplay>::new()
        .with_num_players(2)?
        .with_max_prediction_window(8)
        .with_check_distance(distance)
        .start_synctest_session()?;
    let mut game = Game::new(2)?;
    let start = Instant::now();
    for frame in 0..frames {
        for player in 0..2 {
            session.add_local_input(player, script_pad(frame % SCRIPT_TICKS, player).into())?;
        }
        let requests = session.advance_frame()?;
        game.handle(requests)?;
    }
    let state = game.hashes().values().next_back().copied().unwrap_or(0);
    Ok(format!(
        "{frames} frames, each of the last {distance} run again and equal: {} frames in {:.0} s, state {state:016x}",
        game.run,
        start.elapsed().as_secs_f64(),
    ))
}
