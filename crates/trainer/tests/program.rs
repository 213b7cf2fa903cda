//! The program from outside: signals, locks, refusals and exit codes.
#![cfg(unix)]

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use policy_core::Skeleton;

const RECIPE: &str = r#"
skill = "walk"
clips = [{ name = "walk" }]
phases = [{ samples = 1_000_000_000 }]
environment = { num_envs = 4, horizon = 4 }
ppo = { epochs = 1, minibatch = 8, critic_hidden = [8] }
discriminator = { hidden = [8], batch = 4, updates = 1, replay_size = 32 }
"#;

/// A folder with all that a training needs.
struct ScratchFolder(tempfile::TempDir);

impl ScratchFolder {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        for folder in ["motions", "recipes"] {
            std::fs::create_dir(place.path(folder)).unwrap();
        }
        std::fs::write(place.path("recipes/walk.toml"), RECIPE).unwrap();
        let time = |i: usize| i as f32 / 24.0;
        let bodies: Vec<_> = Skeleton::humanoid().bodies().iter().map(|body| body.name.clone()).collect();
        let bend = |i: usize| (0.1 * (std::f32::consts::TAU * time(i)).sin()).sin_cos();
        let rotations = |i: usize| {
            let mut all = vec![[0.0, 0.0, 0.0, 1.0]; bodies.len()];
            all[1] = [0.0, bend(i).0, 0.0, bend(i).1];
            all
        };
        let clip = serde_json::json!({
            "loop": "wrap", "bodies": bodies, "times": (0..25).map(time).collect::<Vec<_>>(),
            "root_pos": (0..25).map(|i| [0.5 * time(i), 0.0, 0.9]).collect::<Vec<_>>(),
            "local_rot": (0..25).map(rotations).collect::<Vec<_>>(),
        });
        std::fs::write(place.path("motions/walk.json"), clip.to_string()).unwrap();
        assert!(place.run(&["normaliser"]).status.success());
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/humanoid.xml");
        let mut command = Command::new(env!("CARGO_BIN_EXE_trainer"));
        for (flag, value) in
            [("--motions", "motions"), ("--recipes", "recipes"), ("--runs", "runs"), ("--kept", "kept")]
        {
            command.arg(flag).arg(self.path(value));
        }
        command.arg("--model").arg(model).args(arguments);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Starts a training and waits for its first iterations.
    fn start(&self, arguments: &[&str]) -> Child {
        let child = self.command(arguments).spawn().unwrap();
        let (start, metrics) = (Instant::now(), self.path("runs/walk/metrics.csv"));
        let before = lines(&metrics);
        while lines(&metrics) < before.max(1) + 2 {
            assert!(start.elapsed() < Duration::from_secs(120), "no iteration within two minutes");
            std::thread::sleep(Duration::from_millis(50));
        }
        child
    }
}

fn lines(path: &Path) -> usize {
    std::fs::read_to_string(path).map_or(0, |text| text.lines().count())
}

fn kill(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_signal_saves_the_run_and_nothing_else_touches_it() {
    let place = ScratchFolder::new();
    let checkpoint = place.path("runs/walk/checkpoint.safetensors");
    for (signal, code, arguments) in [
        ("-INT", 130, &["train", "walk"][..]),
        ("-TERM", 143, &["train", "walk", "--resume"]),
        ("-HUP", 129, &["train", "walk", "--overwrite"]),
    ] {
        let child = place.start(arguments);
        let second = place.run(&["train", "walk", "--resume"]);
        assert_eq!(second.status.code(), Some(1));
        assert!(said(&second).contains(&format!("process {}", child.id())), "{}", said(&second));
        kill(signal, &child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{}", said(&output));
        assert!(said(&output).contains(" train walk --resume`"), "{}", said(&output));
        assert!(said(&output).contains(" --kept "), "the whole command: {}", said(&output));
        assert!(trainer::checkpoint::Checkpoint::load(&checkpoint).unwrap().progress.samples > 0);
    }
    let refused = place.run(&["train", "walk"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(said(&refused).contains("--overwrite"), "{}", said(&refused));
}

#[test]
fn a_killed_run_is_continued_and_its_end_is_told() {
    let place = ScratchFolder::new();
    let child = place.start(&["train", "walk"]);
    kill("-INT", &child);
    child.wait_with_output().unwrap();
    let child = place.start(&["train", "walk", "--resume"]);
    let id = child.id();
    kill("-KILL", &child);
    child.wait_with_output().unwrap();
    let resumed = place.run(&["train", "walk", "--resume", "--iterations", "1"]);
    assert_eq!(resumed.status.code(), Some(0), "{}", said(&resumed));
    assert!(said(&resumed).contains(&format!("ended without finishing: process {id}")), "{}", said(&resumed));
}

#[test]
fn a_lineage_is_run_resumed_and_averaged() {
    let place = ScratchFolder::new();
    let plan = "steps = [{ train = { recipe = \"walk\", run = \"first\", samples = 32 } }, \
                { train = { recipe = \"walk\", run = \"second\", continues = \"first\", samples = 64 } }, \
                { average = { run = \"walk\", of = [\"second\", \"first\"] } }]";
    std::fs::write(place.path("plan.toml"), plan).unwrap();
    let path = place.path("plan.toml");
    let train = |more: &[&str]| {
        let arguments = [&["train", "--plan", path.to_str().unwrap()], more].concat();
        place.run(&arguments)
    };
    let one = train(&["--iterations", "1"]);
    assert_eq!(one.status.code(), Some(0), "{}", said(&one));
    assert!(!place.path("runs/second").exists(), "it stops where a run is not done");
    assert_eq!(train(&[]).status.code(), Some(1), "runs are there");
    let rest = train(&["--resume"]);
    assert_eq!(rest.status.code(), Some(0), "{}", said(&rest));
    let load = |run: &str| {
        let path = place.path("runs").join(run).join("checkpoint.safetensors");
        trainer::checkpoint::Checkpoint::load(&path).unwrap()
    };
    assert_eq!(["first", "second", "walk"].map(|run| load(run).progress.samples), [32, 64, 64]);
    let [first, second, mean] =
        ["first", "second", "walk"].map(|run| load(run).networks["ema"].network.parameters[7]);
    assert!((mean - 0.5 * (first + second)).abs() < 1e-6, "{first} {second} {mean}");
    let again = train(&["--resume"]);
    assert_eq!(again.status.code(), Some(0), "{}", said(&again));
    std::fs::write(&path, plan.replace("samples = 32", "samples = 48")).unwrap();
    let changed = train(&["--resume"]);
    assert_eq!(changed.status.code(), Some(1));
    assert!(said(&changed).contains("lineage.toml"), "{}", said(&changed));
}

#[test]
fn a_lineage_that_is_overwritten_and_interrupted_keeps_nothing_of_an_earlier_one() {
    let place = ScratchFolder::new();
    let plan = "steps = [{ train = { recipe = \"walk\", run = \"first\", samples = 32 } }, \
                { train = { recipe = \"walk\", run = \"second\", from = \"first\", samples = 32 } }]";
    std::fs::write(place.path("plan.toml"), plan).unwrap();
    let path = place.path("plan.toml");
    let train = |more: &[&str]| {
        let arguments = [&["train", "--plan", path.to_str().unwrap()], more].concat();
        let output = place.run(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    };
    train(&[]);
    let second = place.path("runs/second/checkpoint.safetensors");
    assert!(second.exists());
    train(&["--overwrite", "--iterations", "1"]);
    assert!(!second.exists(), "it started from the networks of the run that was overwritten");
    train(&["--resume"]);
    assert!(second.exists());
}

#[test]
fn a_lineage_averages_kept_checkpoints() {
    let place = ScratchFolder::new();
    let trained = place.run(&["train", "walk", "--iterations", "1"]);
    assert_eq!(trained.status.code(), Some(0), "{}", said(&trained));
    std::fs::create_dir(place.path("kept")).unwrap();
    let from = place.path("runs/walk/checkpoint.safetensors");
    for name in ["old", "older"] {
        std::fs::copy(&from, place.path("kept").join(format!("{name}.safetensors"))).unwrap();
    }
    let plan = "kept = [\"old\", \"older\"]\n\
                steps = [{ average = { run = \"mean\", of = [\"old\", \"older\"] } }]";
    std::fs::write(place.path("plan.toml"), plan).unwrap();
    let averaged = place.run(&["train", "--plan", place.path("plan.toml").to_str().unwrap()]);
    assert_eq!(averaged.status.code(), Some(0), "{}", said(&averaged));
    assert!(place.path("runs/mean/checkpoint.safetensors").exists());
}

#[test]
fn an_average_with_weights_goes_beyond_what_was_learned() {
    let place = ScratchFolder::new();
    let checkpoints = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/checkpoints");
    let [gait, rough] =
        ["strafe", "strafe_rough"].map(|name| checkpoints.join(format!("{name}.safetensors")));
    let out = place.path("mean.safetensors");
    let [gait, rough, out] = [&gait, &rough, &out].map(|path| path.to_str().unwrap());
    let average = |weights: &str| place.run(&["average", gait, rough, "--out", out, "--weights", weights]);
    assert!(average("-0.15,1.15").status.success());
    assert!(trainer::checkpoint::Checkpoint::load(Path::new(out)).is_ok());
    let refused = average("0.5,0.6");
    assert_eq!(refused.status.code(), Some(1));
    assert!(said(&refused).contains("expected 2 weights that add up to 1"), "{}", said(&refused));
}

#[test]
fn a_folder_without_recipes_is_named() {
    let place = ScratchFolder::new();
    std::fs::remove_file(place.path("recipes/walk.toml")).unwrap();
    for arguments in [&["train", "--all"][..], &["normaliser"]] {
        let output = place.run(arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let said = said(&output);
        assert!(said.contains("expected recipes") && said.contains("recipes, found none"), "{said}");
    }
}

#[test]
fn a_full_disk_under_the_output_is_an_error_and_no_panic() {
    let place = ScratchFolder::new();
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    let output = place.command(&["compare", "--repeats", "1"]).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("cannot write to the standard output"), "{}", said(&output));
}

#[test]
fn a_search_keeps_its_best_pack_and_goes_on_where_it_stopped() {
    let place = ScratchFolder::new();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets");
    std::fs::create_dir(place.path("kept")).unwrap();
    for name in ["strafe", "strafe_rough"] {
        let file = format!("{name}.safetensors");
        std::fs::copy(assets.join("checkpoints").join(&file), place.path("kept").join(&file)).unwrap();
    }
    let text = "replaces = \"strafe\"\nof = [\"strafe\", \"strafe_rough\"]\nweights = [1.0, 0.0]\n\
                gaits = [\"strafe\"]\ncharacters = 1\naims = [{ section = \"legs\", \
                measure = \"foot_slide_mps.strafe\", at_most = 0.0, scale = 0.1 }]";
    let file = place.path("search.toml");
    std::fs::write(&file, text).unwrap();
    let (file, out, pack) = (file, place.path("out"), assets.join("humanoid.pack.safetensors"));
    let [file, out, pack] = [&file, &out, &pack].map(|path| path.to_str().unwrap());
    let search = |trials: &str, seed: &str| {
        place.run(&["search", file, "--out", out, "--pack", pack, "--trials", trials, "--seed", seed])
    };
    let lines = || std::fs::read_to_string(Path::new(out).join("trials.jsonl")).unwrap().lines().count();
    let first = search("2", "1");
    assert_eq!((first.status.code(), lines()), (Some(0), 2), "{}", said(&first));
    let best = std::fs::read(Path::new(out).join("best.pack.safetensors")).unwrap();
    assert!(policy_core::CharacterPack::from_bytes(&best).is_ok());
    let more = search("3", "1");
    assert_eq!((more.status.code(), lines()), (Some(0), 3), "{}", said(&more));
    let other = search("4", "2");
    assert_eq!((other.status.code(), lines()), (Some(1), 3));
    assert!(said(&other).contains("line 2: expected weights"), "{}", said(&other));
    std::fs::remove_file(place.path("kept/strafe_rough.safetensors")).unwrap();
    let missing = search("4", "1");
    assert!(said(&missing).contains("named strafe_rough, found none"), "{}", said(&missing));
}
