//! Rollback netcode with GGRS: two players in one process, over a network that delays, loses and reorders what they send.
//!
//! `cargo run --release -p rollback --features deterministic -- play` plays in real time, `sync-test` takes back and runs
//! again every frame, `cost` measures what that takes. [docs/netcode.md](../../../docs/netcode.md) explains.

use clap::{Parser, Subcommand};
use rollback::network::Weather;
use rollback::{cost, play, sync_test};

/// The arena of `lockstep` under GGRS.
#[derive(Debug, Parser)]
#[command(name = "rollback")]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Two players play the script of 20 seconds and more in real time, over a made-up network.
    Play {
        /// Frames, 30 a second.
        #[arg(long, default_value_t = 600)]
        frames: u32,
        /// Time that a packet takes, milliseconds.
        #[arg(long, default_value_t = 60)]
        latency_ms: u64,
        /// At most so much more, milliseconds: packets overtake each other.
        #[arg(long, default_value_t = 40)]
        jitter_ms: u64,
        /// Packets lost, of 100.
        #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(0..=90))]
        loss_percent: u32,
    },
    /// GGRS's own test: after every frame goes back some frames, runs them again and compares hashes.
    SyncTest {
        /// Frames.
        #[arg(long, default_value_t = 10_000)]
        frames: u32,
        /// Frames that are run again each time, 1 to 7.
        #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=7))]
        distance: u32,
    },
    /// What saving, restoring and running 8 frames again takes, for 1, 2 and 8 characters.
    Cost,
}

fn main() -> anyhow::Result<()> {
    match Cli::parse().verb {
        Verb::Play { frames, latency_ms, jitter_ms, loss_percent } => {
            let weather = Weather { latency_ms, jitter_ms, loss_percent, seed: 1 };
            println!("{}", play::run(frames, weather, true)?);
        }
        Verb::SyncTest { frames, distance } => {
            println!("{}", sync_test::run(frames, distance as usize)?);
        }
        Verb::Cost => print!("{}", cost::table()?),
    }
    Ok(())
}
