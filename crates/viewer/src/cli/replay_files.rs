//! Replays named by the command line: read before the world is made, written when the run ends.

use std::path::Path;

use anyhow::{Context as _, bail};
use replay::{MOST_BYTES, Playback, Recorder, Replay, StateHash};

use super::{Demo, load};
use crate::app::{App, ReplayLine};
use crate::files;
use crate::replays::{Replaying, Setting};

/// Reads `--replay` and makes its choices those of the command line. Nothing is changed without it.
///
/// # Errors
/// When the file can't be read or is no replay of the demo's scenes.
pub fn chosen(demo: &Demo) -> anyhow::Result<(Demo, Option<Replay>)> {
    let Some(path) = &demo.replay else { return Ok((demo.clone(), None)) };
    let bytes = files::read(path, MOST_BYTES as u64).with_context(|| format!("replay {}", path.display()))?;
    let replay = Replay::from_bytes(&bytes).with_context(|| format!("replay {}", path.display()))?;
    let setting =
        Setting::from_header(replay.header()).with_context(|| format!("replay {}", path.display()))?;
    let demo = Demo {
        scene: Some(setting.scene),
        physics: setting.engine,
        terrain: setting.ground,
        characters: Some(setting.characters),
        mode: setting.mode,
        seed: replay.header().seed,
        ..demo.clone()
    };
    Ok((demo, Some(replay)))
}

/// Begins to play a replay or to record one, as the command line says.
///
/// # Errors
/// When the replay is of another pack.
pub fn begin(demo: &Demo, replay: Option<&Replay>, app: &mut App) -> anyhow::Result<()> {
    if replay.is_none() && demo.record_replay.is_none() {
        return Ok(());
    }
    let pack_hash = StateHash::of(&load::pack_bytes(demo.character.as_deref())?);
    let header = Setting::of(&app.sim).header(&app.sim, pack_hash);
    let path = demo.replay.as_deref().or(demo.record_replay.as_deref());
    let name = path.and_then(Path::file_name).unwrap_or_default().to_string_lossy();
    app.replay_line = ReplayLine { name: name.into_owned(), ended: None };
    app.replaying = match replay {
        Some(replay) => {
            header.expect(replay.header())?;
            Replaying::Playing(Box::new(Playback::new(replay)))
        }
        None => Replaying::Recording(Box::new(Recorder::new(header)?)),
    };
    Ok(())
}

/// Ends a run: what stopped a replay is an error, and a recording is written.
///
/// # Errors
/// When the state differed from a replay's, or the file can't be written.
pub fn end(demo: &Demo, app: &App) -> anyhow::Result<()> {
    // A run that ended before its first tick has recorded nothing: a file of that name stays as it is.
    let recorded = app.replaying.recorded().filter(|replay| replay.ticks() > 0);
    if let (Some(path), Some(replay)) = (&demo.record_replay, recorded) {
        write(path, replay)?;
    }
    if let Some(stopped) = &app.replay_stopped {
        bail!("{stopped}");
    }
    Ok(())
}

fn write(path: &Path, replay: &Replay) -> anyhow::Result<()> {
    files::write(path, &replay.to_bytes()).with_context(|| format!("cannot write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;
    use crate::cli::Cli;
    use crate::cli::open::open;

    #[test]
    fn a_run_without_a_tick_leaves_an_earlier_recording_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("walk.replay");
        std::fs::write(&path, "an earlier one").unwrap();
        let line = ["policy-space", "--headless", "--no-layout", "--record-replay", path.to_str().unwrap()];
        let demo = Cli::try_parse_from(line).unwrap().demo;
        let mut app = open(&demo).unwrap().app;
        begin(&demo, None, &mut app).unwrap();
        end(&demo, &app).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "an earlier one");
        app.tick();
        end(&demo, &app).unwrap();
        assert_eq!(Replay::from_bytes(&std::fs::read(&path).unwrap()).unwrap().ticks(), 1);
    }
}
