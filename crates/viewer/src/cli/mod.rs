//! The command line of `policy-space`: what to run, parsed and checked.

pub mod bench;
pub mod headless;
pub mod load;
pub mod open;
pub mod pad_input;
pub mod replay_files;
mod report;
mod values;

use std::io::Write as _;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use policy_core::BlendMode;

use crate::app::{App, FirstStep};
use crate::sim::{Engine, GroundKind, SECOND_CHARACTER, SceneKind};
use crate::text;
pub use values::{GhostChoice, PanelList};

/// Steer a physics-based character by blending the parameters of tiny policies.
#[derive(Debug, Parser)]
#[command(name = "policy-space", version, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to run instead of the demo.
    #[command(subcommand)]
    pub command: Option<Task>,
    /// The demo's own choices.
    #[command(flatten)]
    pub demo: Demo,
}

const EXAMPLES: &str = "\
Examples:
  policy-space
      the playground in a window; F1 shows the controls, a gamepad is used when there is one
  policy-space --scene empty
      an empty floor, to study the blending
  policy-space --headless --scene playground --script assets/scripts/walk.ron --seconds 8 --frames out/
      pictures of a walk into the crates of the playground
  policy-space --tour
      plays the playground's course automatically until you press a key
  policy-space --terrain wavy --characters 20
      twenty characters on low hills
  policy-space --headless --script assets/scripts/tour.ron --seconds 20 --report report.json --frames out/
      without a window: 20 seconds under a script of pad input, a report and pictures
  policy-space --headless --script assets/scripts/walk.ron --seconds 5 --frames out/ --panels
      the same, with the panels in the pictures
  policy-space --character quadruped.pack.safetensors
      another character; a pack or a mesh can also be dropped on the window
  policy-space --physics rapier --record-replay walk.replay
      keeps what is pressed; policy-space --replay walk.replay plays it, and compares the state every second
  policy-space --poses walk.json
      plays a clip in a loop in a window; with --headless --frames out/ once, as pictures

Exit status: 0 when it ran, 1 when it could not, 2 when the command line is wrong, 128 and the number of the
signal when one ended it (130 after Ctrl+C); the report and the settings are written then too.";

/// Tasks besides the demo.
#[derive(Debug, Subcommand)]
pub enum Task {
    /// How many characters this machine runs in real time.
    BenchCrowd(Bench),
    /// How fast 1 and 100 characters are drawn at 1280x720, off screen.
    BenchFrame(Bench),
}

/// Choices of a benchmark.
#[derive(Clone, Copy, Debug, Args)]
pub struct Bench {
    /// Print one JSON object instead of a table.
    #[arg(long)]
    pub json: bool,
}

/// Choices of the demo, in a window or without.
#[derive(Clone, Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "switches of a command line")]
pub struct Demo {
    /// Run without a window.
    #[arg(long)]
    pub headless: bool,
    /// Pad input over time (RON), in a window instead of the pads. Without it a run without a window has a neutral pad.
    #[arg(long, value_name = "FILE")]
    pub script: Option<PathBuf>,
    /// Pad input recorded from a device by `pad record`, instead of a script.
    #[arg(long, value_name = "FILE", conflicts_with = "script")]
    pub recording: Option<PathBuf>,
    /// Begin with the tour: over the course of the playground by itself, elsewhere by a script. Any input ends it.
    #[arg(
        long,
        conflicts_with_all = ["script", "recording", "second_script", "replay", "poses", "record_replay"]
    )]
    pub tour: bool,
    /// Pad input of a second player over time (RON), who takes over a character of the playground.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["replay", "poses", "record_replay"])]
    pub second_script: Option<PathBuf>,
    /// Record the input into this file, as a replay. It plays back with the same program on the same machine.
    #[arg(long, value_name = "FILE")]
    pub record_replay: Option<PathBuf>,
    /// Play a replay. It brings scene, physics, ground, characters, blend mode and seed, and stops with an error at the
    /// first state that differs from the recorded one.
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = [
            "script", "recording", "poses", "mode", "ghost", "physics", "terrain", "characters", "seed", "scene",
            "record_replay", "seconds",
        ]
    )]
    pub replay: Option<PathBuf>,
    /// Show a clip instead of a simulation: poses as `trainer view CLIP --poses FILE` writes them (JSON with
    /// format, clip, hz and qpos). Bodies are placed by forward kinematics and nothing is simulated; between two
    /// poses positions and rotations are interpolated.
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = [
            "script", "recording", "report", "character", "mode", "ghost", "physics", "terrain", "characters",
            "seed", "scene", "record_replay",
        ]
    )]
    pub poses: Option<PathBuf>,
    /// How long to simulate, up to 3600; by default as long as the script, recording or clip, or 10.
    #[arg(long, value_name = "SECONDS", requires = "headless", value_parser = values::seconds)]
    pub seconds: Option<f64>,
    /// Write what happened as JSON to this file.
    #[arg(long, value_name = "FILE", requires = "headless")]
    pub report: Option<PathBuf>,
    /// Write pictures (frame_00000.png, ...) into this folder, made when it is not there.
    #[arg(long, value_name = "DIR", requires = "headless")]
    pub frames: Option<PathBuf>,
    /// Pictures per second.
    #[arg(long, default_value_t = 30, value_name = "N", requires = "headless", value_parser = clap::value_parser!(u32).range(1..=240))]
    pub fps: u32,
    /// Size of the pictures or of the window, such as 1280x720.
    #[arg(long, default_value = "1280x720", value_name = "WxH", value_parser = values::size)]
    pub size: [u32; 2],
    /// Draw the panels into the pictures, or those of a list such as --panels=paths,analysis.
    #[arg(long, requires = "frames", value_name = "LIST", num_args = 0..=1, require_equals = true, default_missing_value = "", value_parser = values::panels)]
    pub panels: Option<PanelList>,
    /// Angle between the picture camera and the camera that the stick is relative to, degrees.
    #[arg(
        long,
        default_value_t = 35.0,
        value_name = "DEGREES",
        requires = "headless",
        allow_negative_numbers = true
    )]
    pub view_angle: f32,
    /// Distance of the camera, metres.
    #[arg(long, value_name = "METRES", value_parser = values::distance)]
    pub distance: Option<f32>,
    /// Character pack to open instead of the humanoid inside: any skeleton. Packs of version 2 bring their body; those
    /// of version 1 are humanoids.
    #[arg(long, value_name = "FILE", visible_alias = "pack")]
    pub character: Option<PathBuf>,
    /// Mesh to draw (.glb whose nodes carry the body names) instead of the pack's own. Characters without a mesh are
    /// drawn as their collision shapes.
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// Save and restore every controller through bytes at every tick: a check that changes no bit of the result.
    #[arg(long, requires = "headless")]
    pub renew_controllers: bool,
    /// How blends become actions: parameters, actions or switch.
    #[arg(long, default_value = "parameters", value_parser = values::mode)]
    pub mode: BlendMode,
    /// The physics engine: mujoco or rapier.
    #[arg(long, default_value = "mujoco", value_name = "ENGINE", value_parser = values::engine)]
    pub physics: Engine,
    /// Add a second character under the same input. WHAT is a blend mode or an engine; without it, the other engine.
    #[arg(long, value_name = "WHAT", num_args = 0..=1, default_missing_value = values::OTHER, value_parser = values::ghost)]
    pub ghost: Option<GhostChoice>,
    /// The ground: flat, wavy or steps.
    #[arg(long, default_value = "flat", value_parser = values::ground)]
    pub terrain: GroundKind,
    /// What stands on the floor: playground or empty. A window opens on the playground, unless another choice needs the
    /// empty floor; a run without a window is on the empty floor, unless it has a second
    /// player.
    #[arg(long, value_parser = values::scene)]
    pub scene: Option<SceneKind>,
    /// All blend modes beside each other in a split screen, under the same stick on the empty floor, with falls counted.
    #[arg(
        long,
        conflicts_with_all = ["mode", "ghost", "scene", "characters", "poses", "replay", "record_replay", "second_script"]
    )]
    pub compare: bool,
    /// Number of characters, 1 to 200; in the playground 1 to 5. By default 1, in the playground 5.
    #[arg(long, value_name = "N", value_parser = values::characters)]
    pub characters: Option<usize>,
    /// Places the hills and turns the crowd.
    #[arg(long, default_value_t = 1)]
    pub seed: u32,
    /// Do not look for gamepads.
    #[arg(long)]
    pub no_pad: bool,
    /// Do not read or write the layout of the panels.
    #[arg(long)]
    pub no_layout: bool,
    /// Print what the player's character does to standard error, twice a second.
    #[arg(long)]
    pub trace: bool,
}

impl Demo {
    /// What stands on the floor: what was asked for, or the playground for a second player and in a window where no other choice needs
    /// the empty floor.
    #[must_use]
    pub fn scene(&self) -> SceneKind {
        let needs_empty = self.headless
            || self.poses.is_some()
            || self.ghost.is_some()
            || self.compare
            || self.characters.is_some()
            || self.terrain != GroundKind::Flat
            || self.physics != Engine::Mujoco;
        // A second player has a character in the playground only.
        let needs_empty = needs_empty && self.second_script.is_none();
        self.scene.unwrap_or(if needs_empty { SceneKind::Empty } else { SceneKind::Playground })
    }
}

/// Longest run without a window, seconds.
const MOST_SECS: f64 = 3600.0;
/// Longest line of a trace, characters.
const LONGEST_LINE: usize = 200;

/// Writes one line of what the players do to standard error.
pub fn trace(app: &App) {
    let player = app.sim.player();
    let position = player.report().position;
    let nodes = app.sim.pack().graph().nodes();
    let at = player.state.root().position;
    let line = format!(
        "tick {} {} {} {:.2} at {:.3} {:.3} {:.3} speed {:.2}{}{}{}",
        app.sim.ticks(),
        nodes[position.from.index()].name,
        nodes[position.to.index()].name,
        position.t,
        at.x,
        at.y,
        at.z,
        player.speed(),
        if player.is_down() { " down" } else { "" },
        second(app),
        done(app),
    );
    remark(&line);
}

/// Where a second player is.
fn second(app: &App) -> String {
    if !app.sim.has_second_player() {
        return String::new();
    }
    let at = app.sim.characters()[SECOND_CHARACTER].state.root().position;
    format!(" second {:.3} {:.3} {:.3}", at.x, at.y, at.z)
}

/// What the player has done: first steps, and props that are in the world.
fn done(app: &App) -> String {
    let steps = FirstStep::ALL.into_iter().filter(|step| app.first_steps.is_done(*step));
    let steps: String = steps.map(|step| format!(" {}", step.title().replace(' ', "_"))).collect();
    let props = app.sim.shared().map_or(0, |shared| shared.pieces().len());
    format!(" props {props} did{steps}")
}

/// Writes a line to standard error.
fn remark(line: &str) {
    // Where standard error is closed there is no other place for it.
    let _ = writeln!(std::io::stderr(), "{}", text::printable(line, LONGEST_LINE));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(words: &[&str]) -> String {
        let line = std::iter::once("policy-space").chain(words.iter().copied());
        Cli::try_parse_from(line).expect_err("should be refused").to_string()
    }

    #[test]
    fn wrong_values_are_refused_and_say_what_is_expected() {
        assert!(error(&["--terrain", "lava"]).contains("flat, wavy, steps"));
        assert!(error(&["--scene", "moon"]).contains("empty, playground"));
        assert!(error(&["--mode", "add"]).contains("parameters, actions, switch"));
        assert!(error(&["--physics", "bullet"]).contains("mujoco, rapier"));
        assert!(error(&["--ghost", "bullet"]).contains("other"));
        assert!(error(&["--size", "12x"]).contains("1280x720"));
        assert!(error(&["--size", "8192x8192"]).contains("at most 8294400 pixels"));
        assert!(error(&["--characters", "0"]).contains("1 to 200"));
        assert!(error(&["--headless", "--seconds", "nan"]).contains("up to 3600"));
        assert!(error(&["--frobnicate"]).contains("--frobnicate"));
        assert!(error(&["--headless", "--frames", "x", "--panels=stove"]).contains("paths,graph"));
        assert!(error(&["--report", "x.json"]).contains("--headless"));
        for other in ["--script", "--recording", "--report", "--character"] {
            let said = error(&["--headless", "--poses", "a.json", other, "b"]);
            assert!(said.contains("--poses") && said.contains("cannot be used with"), "{said}");
        }
        assert!(error(&["--poses", "a.json", "--characters", "3"]).contains("cannot be used with"));
    }

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory as _;
        Cli::command().debug_assert();
    }
}
