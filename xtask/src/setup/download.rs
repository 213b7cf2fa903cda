//! Brings a pinned wheel to this machine: through pip, or from a file that the user names.
//!
//! A wheel gets its final name after its hash was checked. An interrupted download leaves a scratch folder, which
//! the next run removes. Refuses any file whose hash is not the pinned one.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use sha2::{Digest, Sha256};

use super::pins::{Build, NativeLibrary};

/// The lower-case hexadecimal sha256 of a file.
///
/// # Errors
/// When the file cannot be read.
pub fn sha256_of(path: &Path) -> Result<String> {
    let mut file = File::open(path).with_context(|| format!("open {}", path.display()))?;
    let mut hasher = Sha256::new();
    let mut chunk = vec![0; 1 << 16];
    loop {
        let read = file.read(&mut chunk).with_context(|| format!("read {}", path.display()))?;
        if read == 0 {
            return Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect());
        }
        hasher.update(&chunk[..read]);
    }
}

/// Checks a file against the hash it is pinned to.
///
/// # Errors
/// When the file cannot be read or hashes to something else; the message names both hashes.
pub fn check_sha256(path: &Path, expected: &str) -> Result<()> {
    let found = sha256_of(path)?;
    ensure!(
        found == expected,
        "{} is not the pinned file: expected sha256 {expected}, found {found}",
        path.display()
    );
    Ok(())
}

/// The checked wheel of a library: the user's file, the one an earlier run kept, or a fresh download.
///
/// # Errors
/// When the user's file is wrong, Python or pip is missing, the index cannot be reached, or the wheel that
/// came hashes to something else.
pub fn fetch_wheel(library: &NativeLibrary, build: &Build, downloads: &Path) -> Result<PathBuf> {
    if let Some(file) = std::env::var_os(library.wheel_variable) {
        let file = PathBuf::from(file);
        check_sha256(&file, build.wheel_sha256)
            .with_context(|| format!("{} names an unusable wheel", library.wheel_variable))?;
        return Ok(file);
    }
    let kept =
        downloads.join(format!("{}-{}-{}-{}.whl", library.package, library.version, build.os, build.arch));
    if kept.is_file() && check_sha256(&kept, build.wheel_sha256).is_ok() {
        return Ok(kept);
    }
    let scratch = downloads.join("partial");
    remove_folder(&scratch)?;
    fs::create_dir_all(&scratch).with_context(|| format!("create {}", scratch.display()))?;
    eprintln!("xtask: fetching {} {} for {} {}", library.package, library.version, build.os, build.arch);
    pip_download(library, build, &scratch)?;
    let wheel = only_wheel_in(&scratch)?;
    check_sha256(&wheel, build.wheel_sha256)
        .context("the package index served another file; it was not used")?;
    fs::rename(&wheel, &kept).with_context(|| format!("move the wheel to {}", kept.display()))?;
    remove_folder(&scratch)?;
    Ok(kept)
}

/// Removes a folder with all that is in it; one that is not there is fine.
///
/// # Errors
/// When it is there and cannot be removed.
pub fn remove_folder(path: &Path) -> Result<()> {
    match fs::remove_dir_all(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(error).with_context(|| format!("remove {}", path.display()))
        }
        _ => Ok(()),
    }
}

/// A Python 3 on this machine that has pip, as the words that start it.
///
/// Tries `python3`, `python` and `py -3`, then the system's own one: a version manager may put a Python without pip
/// first in the search path.
pub fn python_with_pip() -> Option<Vec<OsString>> {
    let candidates: [&[&str]; 4] = [&["python3"], &["python"], &["py", "-3"], &["/usr/bin/python3"]];
    candidates
        .iter()
        .find(|words| {
            Command::new(words[0])
                .args(&words[1..])
                .args(["-m", "pip", "--version"])
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status()
                .is_ok_and(|status| status.success())
        })
        .map(|words| words.iter().map(OsString::from).collect())
}

/// The arguments with which pip fetches one wheel, whatever Python runs it.
fn pip_arguments(library: &NativeLibrary, build: &Build) -> Vec<String> {
    let fixed = "-m pip download --no-deps --only-binary=:all: --python-version 3.12 --implementation cp \
                 --abi cp312 --disable-pip-version-check --no-input --retries 2";
    let mut arguments: Vec<String> = fixed.split_whitespace().map(String::from).collect();
    for tag in build.tags {
        arguments.extend(["--platform".to_owned(), (*tag).to_owned()]);
    }
    arguments.push(format!("{}=={}", library.package, library.version));
    arguments
}

fn pip_download(library: &NativeLibrary, build: &Build, into: &Path) -> Result<()> {
    let by_hand = format!(
        "a wheel fetched elsewhere can be named with {}=FILE; this is how pip fetches it:\n    python3 {}",
        library.wheel_variable,
        pip_arguments(library, build).join(" ")
    );
    let Some(python) = python_with_pip() else {
        bail!(
            "{} {} comes from a Python wheel and no Python 3 with pip was found (Debian, Ubuntu: \
             apt-get install python3-pip); {by_hand}",
            library.package,
            library.version
        );
    };
    let output = Command::new(&python[0])
        .args(&python[1..])
        .args(pip_arguments(library, build))
        .arg("--dest")
        .arg(into)
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("start {}", python[0].display()))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        bail!(
            "pip could not fetch {} {} ({}); is there a network, or a proxy that pip does not know of?\n\
             pip said:\n{}\n{by_hand}",
            library.package,
            library.version,
            output.status,
            essence(&said)
        );
    }
    Ok(())
}

fn only_wheel_in(folder: &Path) -> Result<PathBuf> {
    let mut wheels = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("list {}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "whl") {
            wheels.push(path);
        }
    }
    ensure!(wheels.len() == 1, "expected one wheel in {}, found {}", folder.display(), wheels.len());
    Ok(wheels.remove(0))
}

/// The errors in pip's output, or its last lines when it names none. Indented.
fn essence(text: &str) -> String {
    let errors: Vec<&str> = text.lines().filter(|line| line.starts_with("ERROR")).collect();
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    let chosen = if errors.is_empty() { &lines[lines.len().saturating_sub(4)..] } else { &errors };
    chosen.iter().map(|line| format!("    {line}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::pins::MUJOCO;
    use crate::workspace::ScratchFolder;

    #[test]
    fn the_hash_is_that_of_the_standard() {
        let folder = ScratchFolder::new("sha256");
        let path = folder.path().join("abc");
        fs::write(&path, "abc").unwrap();
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        check_sha256(&path, expected).unwrap();
        fs::write(&path, "abd").unwrap();
        let message = check_sha256(&path, expected).unwrap_err().to_string();
        assert!(message.contains(expected) && message.contains("found"), "{message}");
    }

    #[test]
    fn pip_is_asked_for_exactly_the_pinned_version_and_platform() {
        let build = MUJOCO.build("linux", "x86_64").unwrap();
        let arguments = pip_arguments(&MUJOCO, build).join(" ");
        assert!(arguments.contains("--no-deps --only-binary=:all: --python-version 3.12"), "{arguments}");
        assert!(arguments.contains("--platform manylinux_2_28_x86_64 --platform manylinux_2_27_x86_64"));
        assert!(arguments.ends_with("mujoco==3.17.0"));
    }

    #[test]
    fn one_wheel_is_expected_no_more_no_less() {
        let folder = ScratchFolder::new("wheels");
        assert!(only_wheel_in(folder.path()).is_err());
        fs::write(folder.path().join("a.whl"), "").unwrap();
        assert_eq!(only_wheel_in(folder.path()).unwrap(), folder.path().join("a.whl"));
        fs::write(folder.path().join("b.whl"), "").unwrap();
        assert!(only_wheel_in(folder.path()).is_err());
    }

    #[test]
    fn of_a_long_message_the_errors_are_quoted_or_the_end() {
        assert_eq!(essence("WARNING: again\nERROR: none found\n\n"), "    ERROR: none found\n");
        assert_eq!(essence("a\nb\n\nc\nd\ne\n"), "    b\n    c\n    d\n    e\n");
    }
}
