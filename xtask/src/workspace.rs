//! The folders of the workspace, and how other programs are run from it.
//!
//! Everything that `xtask` itself says goes to stderr, so that stdout belongs to the program that it runs.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, ExitStatus, Stdio};

use anyhow::{Context, Result, ensure};

/// Marks the target folder of cargo in the environment.
const TARGET_VARIABLE: &str = "CARGO_TARGET_DIR";

/// The folders of the workspace.
#[derive(Debug, Clone)]
pub struct Workspace {
    root: PathBuf,
}

impl Workspace {
    /// The workspace that this program was built from.
    ///
    /// # Errors
    /// When that folder is gone, as after moving the checkout without building anew.
    pub fn find() -> Result<Self> {
        let manifest = std::env::var_os("CARGO_MANIFEST_DIR")
            .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
        let root = manifest.parent().unwrap_or(Path::new(".")).to_path_buf();
        ensure!(root.join("Cargo.lock").is_file(), "no workspace at {}; run `cargo xtask`", root.display());
        Ok(Self { root })
    }

    /// The folder of the root `Cargo.toml`.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The folder of what was fetched from elsewhere; not under version control.
    pub fn third_party(&self) -> PathBuf {
        self.root.join("third_party")
    }

    /// Where cargo puts what it builds.
    pub fn target(&self) -> PathBuf {
        std::env::var_os(TARGET_VARIABLE)
            .map_or_else(|| self.root.join("target"), |path| self.root.join(path))
    }

    /// A command that runs in the workspace's root.
    pub fn command(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root);
        if cfg!(windows) {
            // Windows has no rpath: a DLL is found through the search path.
            let mut folders = vec![self.root.join("third_party/mujoco/lib")];
            folders.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()));
            if let Ok(joined) = std::env::join_paths(folders) {
                command.env("PATH", joined);
            }
        }
        command
    }

    /// The cargo that runs this program, in the workspace's root.
    ///
    /// In a fresh clone it writes no incremental build data, which takes 3.6 of 12 GB and saves nothing there.
    pub fn cargo(&self) -> Command {
        let mut cargo = self.command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        if !has_entries(&self.target().join("debug/incremental")) {
            cargo.env("CARGO_INCREMENTAL", "0");
        }
        cargo
    }
}

/// True for a folder with anything in it. Cargo makes its folders before it has anything to put there.
fn has_entries(folder: &Path) -> bool {
    fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some())
}

/// Runs a command to its end.
///
/// # Errors
/// When it cannot be started or ends with another status than 0.
pub fn run(command: &mut Command) -> Result<()> {
    let status = status_of(command)?;
    ensure!(status.success(), "`{}` failed: {status}", shown(command));
    Ok(())
}

/// Runs a command to its end and returns its exit status.
///
/// # Errors
/// When it cannot be started.
pub fn status_of(command: &mut Command) -> Result<ExitStatus> {
    command.status().with_context(|| format!("start `{}`", shown(command)))
}

/// Runs a command to its end and returns its exit code, for commands that report their own errors.
///
/// # Errors
/// When it cannot be started.
pub fn exit_code_of(command: &mut Command) -> Result<ExitCode> {
    let code = status_of(command)?.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

/// Runs a command and returns what it wrote to stdout. Its stderr is passed through.
///
/// # Errors
/// When it cannot be started, ends with another status than 0 or writes something else than UTF-8.
pub fn output_of(command: &mut Command) -> Result<String> {
    let output = command
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .with_context(|| format!("start `{}`", shown(command)))?;
    ensure!(output.status.success(), "`{}` failed: {}", shown(command), output.status);
    String::from_utf8(output.stdout).with_context(|| format!("read what `{}` wrote", shown(command)))
}

/// Whether a program can be started and succeeds. Its output is dropped.
pub fn answers(command: &mut Command) -> bool {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// Copies a folder with all that is in it.
///
/// # Errors
/// When something can't be read or written.
pub fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| format!("make {}", to.display()))?;
    for entry in fs::read_dir(from).with_context(|| format!("list {}", from.display()))? {
        let from: PathBuf = entry?.path();
        let to = to.join(from.file_name().unwrap_or_default());
        if from.is_dir() {
            copy_folder(&from, &to)?;
        } else {
            fs::copy(&from, &to).with_context(|| format!("copy {}", from.display()))?;
        }
    }
    Ok(())
}

/// A command as one would type it.
pub fn shown(command: &Command) -> String {
    let program =
        Path::new(command.get_program()).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let arguments = command.get_args().map(|argument| argument.to_string_lossy().into_owned());
    std::iter::once(program).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// A folder for one test, removed at its end.
#[cfg(test)]
pub struct ScratchFolder(PathBuf);

#[cfg(test)]
impl ScratchFolder {
    /// Makes an empty folder that no other test uses.
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("policy-space-xtask-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

#[cfg(test)]
impl Drop for ScratchFolder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_shown_as_typed() {
        let mut command = Command::new("/usr/lib/cargo");
        command.args(["fmt", "--check"]);
        assert_eq!(shown(&command), "cargo fmt --check");
    }

    #[cfg(unix)]
    #[test]
    fn a_command_that_reports_its_own_errors_keeps_its_exit_code() {
        let code = exit_code_of(Command::new("sh").args(["-c", "exit 3"])).unwrap();
        assert_eq!(format!("{code:?}"), format!("{:?}", ExitCode::from(3)));
        assert!(exit_code_of(&mut Command::new("no-such-program-anywhere")).is_err());
    }

    #[test]
    fn a_failing_command_is_an_error_that_names_it() {
        let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.args(["no-such-subcommand-of-cargo"]).stderr(Stdio::null());
        let message = run(&mut command).unwrap_err().to_string();
        assert!(message.contains("no-such-subcommand-of-cargo"), "{message}");
        assert!(run(&mut Command::new("no-such-program-anywhere")).is_err());
    }

    #[test]
    fn a_folder_without_anything_in_it_has_no_entries() {
        let root = ScratchFolder::new("entries");
        assert!(!has_entries(root.path()) && !has_entries(&root.path().join("none")));
        fs::create_dir_all(root.path().join("viewer-1a2b")).unwrap();
        assert!(has_entries(root.path()));
    }

    #[test]
    fn a_folder_is_copied_whole() {
        let root = ScratchFolder::new("copy");
        let (from, to) = (root.path().join("from"), root.path().join("to"));
        fs::create_dir_all(from.join("src/deep")).unwrap();
        fs::write(from.join("src/deep/lib.rs"), "text").unwrap();
        copy_folder(&from, &to).unwrap();
        assert_eq!(fs::read_to_string(to.join("src/deep/lib.rs")).unwrap(), "text");
        assert!(copy_folder(&root.path().join("none"), &to).unwrap_err().to_string().contains("none"));
    }
}
