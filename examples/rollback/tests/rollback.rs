//! A short sync test and a short game over a bad network.
#![allow(missing_docs, reason = "tests")]

use rollback::network::Weather;
use rollback::{cost, play, sync_test};

#[test]
fn every_frame_that_is_run_again_is_the_same() {
    let said = sync_test::run(60, 4).unwrap();
    assert!(said.starts_with("60 frames") && said.contains("equal"), "{said}");
}

#[test]
fn two_players_agree_over_a_bad_network() {
    let weather = Weather { latency_ms: 30, jitter_ms: 40, loss_percent: 20, seed: 3 };
    let played = play::run(60, weather, false).unwrap();
    assert!(played.confirmed >= 60, "{played}");
    assert!(played.packets[1] > 0 && played.players.iter().all(|player| player[1] > 0), "{played}");
}

#[test]
fn the_cost_of_a_rollback_is_measured() {
    let cost = cost::measure(1, 3).unwrap();
    assert!(cost.frames > cost.save && !cost.restore.is_zero(), "{cost:?}");
}
