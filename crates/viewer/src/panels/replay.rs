//! The line about a replay: which one is played or recorded, how much of it, and how it ended.

use egui::{Align2, Area, Color32, Ui};

use super::race::minutes;
use super::{PRESENT, REQUESTED, WRONG, frame};
use crate::app::{App, ReplayLine};
use crate::replays::Replaying;

/// The overlay at the top of the picture, below that of the course; nothing when there is no replay.
pub(super) fn show(ui: &Ui, app: &App, free: egui::Rect) {
    let Some((text, colour)) = line(&app.replaying, &app.replay_line, app.sim.tick_secs()) else { return };
    let down = if app.sim.shared().is_some() { 52.0 } else { 8.0 };
    let at = free.center_top() + egui::vec2(0.0, down);
    let area = Area::new(egui::Id::unique("replay")).fixed_pos(at).pivot(Align2::CENTER_TOP);
    area.interactable(false).show(ui.ctx(), |ui| frame().show(ui, |ui| ui.colored_label(colour, text)));
}

fn line(replaying: &Replaying, shown: &ReplayLine, tick_secs: f32) -> Option<(String, Color32)> {
    let name = &shown.name;
    let clock = |ticks: u32| minutes(ticks as f32 * tick_secs);
    match (replaying, &shown.ended) {
        (Replaying::Playing(playback), _) => {
            let (now, all) = (clock(playback.tick()), clock(playback.replay().ticks()));
            Some((format!("Replay {name}: {now} of {all}"), PRESENT))
        }
        (Replaying::Recording(recorder), _) => {
            Some((format!("Recording {name}: {}", clock(recorder.replay().ticks())), REQUESTED))
        }
        (Replaying::Off, Some(Ok(()))) => Some((
            format!("Replay {name} is over: every state was the recorded one. P plays on from here."),
            PRESENT,
        )),
        (Replaying::Off, Some(Err(why))) => {
            Some((format!("Replay {name} stopped: {why}. P plays on from here."), WRONG))
        }
        (Replaying::Off, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use policy_core::GamepadState;
    use replay::{Header, Pad, Playback, Recorder};

    use super::*;

    #[test]
    fn it_says_what_is_played_how_much_and_how_it_ended() {
        let scene = "empty/rapier/flat/1/parameters".into();
        let header = Header { pack_hash: 0, seed: 1, hash_every: 30, players: 1, scene };
        let mut recorder = Recorder::new(header).unwrap();
        (0..90).for_each(|_| recorder.push(&[Pad::default()], 5).unwrap());
        let mut shown = ReplayLine { name: "a.replay".into(), ended: None };
        let said =
            |replaying: &Replaying, shown: &ReplayLine| line(replaying, shown, 1.0 / 30.0).map(|said| said.0);
        let mut playing = Replaying::Playing(Box::new(Playback::new(recorder.replay())));
        for _ in 0..60 {
            playing.steer(&GamepadState::default(), policy_core::Heading::FORWARD).unwrap();
        }
        assert_eq!(said(&playing, &shown).unwrap(), "Replay a.replay: 0:02.0 of 0:03.0");
        let recording = Replaying::Recording(Box::new(recorder));
        assert_eq!(said(&recording, &shown).unwrap(), "Recording a.replay: 0:03.0");
        assert_eq!(said(&Replaying::Off, &shown), None);
        shown.ended = Some(Ok(()));
        assert!(said(&Replaying::Off, &shown).unwrap().contains("is over"));
        shown.ended = Some(Err("tick 60 differs".into()));
        assert!(said(&Replaying::Off, &shown).unwrap().contains("stopped: tick 60 differs. P"));
    }
}
