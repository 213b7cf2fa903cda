//! Tests of the installation from a wheel, with a made-up wheel.

use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::*;
use crate::setup::download::sha256_of;
use crate::workspace::ScratchFolder;

/// A wheel with the library `content`, one header and one file that is of no use.
fn wheel(folder: &Path, content: &str) -> PathBuf {
    let path = folder.join("made-up.whl");
    let mut archive = ZipWriter::new(File::create(&path).unwrap());
    for (name, text) in [
        ("thing/libthing.so.1.2.3", content),
        ("thing/include/thing/thing.h", "int thing(void);"),
        ("thing/__init__.py", "raise SystemExit"),
    ] {
        archive.start_file(name, SimpleFileOptions::default()).unwrap();
        archive.write_all(text.as_bytes()).unwrap();
    }
    archive.finish().unwrap();
    path
}

/// An installation of the made-up library whose pins are those of `wheel` and of a library `content`.
fn installation(folder: &Path, wheel: &Path, content: &str) -> Installation<'static> {
    let sample = folder.join("sample");
    fs::write(&sample, content).unwrap();
    let leak = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
    let build: &'static Build = Box::leak(Box::new(Build {
        os: "linux",
        arch: "x86_64",
        tags: &[],
        wheel_sha256: leak(sha256_of(wheel).unwrap()),
        library: "thing/libthing.so.1.2.3",
        library_sha256: leak(sha256_of(&sample).unwrap()),
        links: &["libthing.so", "thing.framework/Versions/A/libthing.so.1.2.3"],
    }));
    let library: &'static NativeLibrary = Box::leak(Box::new(NativeLibrary {
        package: "thing",
        version: "1.2.3",
        headers: Some("thing/include/"),
        wheel_variable: "POLICY_SPACE_NO_SUCH_WHEEL",
        builds: std::slice::from_ref(build),
    }));
    Installation { library, build, third_party: folder.join("third_party") }
}

/// Puts the wheel where an earlier download would have left it.
fn keep(installation: &Installation<'_>, wheel: &Path) {
    let downloads = installation.third_party.join("downloads");
    fs::create_dir_all(&downloads).unwrap();
    fs::copy(wheel, downloads.join("thing-1.2.3-linux-x86_64.whl")).unwrap();
}

#[test]
fn an_installed_library_is_ready_under_all_its_names() {
    let folder = ScratchFolder::new("install");
    let wheel = wheel(folder.path(), "machine code");
    let installation = installation(folder.path(), &wheel, "machine code");
    keep(&installation, &wheel);
    assert!(!installation.is_ready());
    installation.ensure().unwrap();
    assert!(installation.is_ready());
    let lib = installation.folder().join("lib");
    for name in ["libthing.so.1.2.3", "libthing.so", "thing.framework/Versions/A/libthing.so.1.2.3"] {
        assert_eq!(fs::read_to_string(lib.join(name)).unwrap(), "machine code", "{name}");
    }
    assert!(installation.folder().join("include/thing/thing.h").is_file());
    assert!(!installation.folder().join("lib/__init__.py").exists());
}

#[test]
fn a_second_run_changes_nothing() {
    let folder = ScratchFolder::new("idempotent");
    let wheel = wheel(folder.path(), "machine code");
    let installation = installation(folder.path(), &wheel, "machine code");
    keep(&installation, &wheel);
    installation.ensure().unwrap();
    let marker = installation.folder().join("marker");
    fs::write(&marker, "").unwrap();
    installation.ensure().unwrap();
    assert!(marker.exists(), "the folder was made anew though it was ready");
}

#[test]
fn a_damaged_or_half_extracted_folder_is_made_anew() {
    let folder = ScratchFolder::new("damaged");
    let wheel = wheel(folder.path(), "machine code");
    let installation = installation(folder.path(), &wheel, "machine code");
    keep(&installation, &wheel);
    fs::create_dir_all(installation.folder().join("include")).unwrap();
    fs::create_dir_all(installation.third_party.join("thing.partial/lib")).unwrap();
    assert!(!installation.is_ready());
    installation.ensure().unwrap();
    fs::write(installation.library_file(), "machine c").unwrap();
    assert!(!installation.is_ready(), "a cut library counts as done");
    installation.ensure().unwrap();
    fs::remove_file(installation.folder().join("lib/libthing.so")).unwrap();
    assert!(!installation.is_ready(), "a missing link counts as done");
    installation.ensure().unwrap();
    assert!(installation.is_ready());
    assert!(!installation.third_party.join("thing.partial").exists());
}

#[test]
fn a_stamp_of_another_version_is_not_ready() {
    let folder = ScratchFolder::new("stamp");
    let wheel = wheel(folder.path(), "machine code");
    let installation = installation(folder.path(), &wheel, "machine code");
    keep(&installation, &wheel);
    installation.ensure().unwrap();
    let path = installation.folder().join(STAMP);
    let stamp = fs::read_to_string(&path).unwrap();
    fs::write(&path, stamp.replace("1.2.3", "1.2.2")).unwrap();
    assert!(!installation.is_ready());
    fs::write(&path, &stamp[..stamp.len() / 2]).unwrap();
    assert!(!installation.is_ready(), "half a stamp counts as one");
    installation.ensure().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), stamp);
}

#[test]
fn a_wheel_with_another_library_installs_nothing() {
    let folder = ScratchFolder::new("other-library");
    let wheel = wheel(folder.path(), "something else");
    let installation = installation(folder.path(), &wheel, "machine code");
    keep(&installation, &wheel);
    let message = installation.ensure().unwrap_err().to_string();
    assert!(message.contains("libthing.so.1.2.3") && message.contains("sha256"), "{message}");
    assert!(!installation.folder().exists());
}

#[test]
fn entries_that_leave_the_folder_are_refused() {
    assert!(safe("mujoco/mujoco.h").is_ok());
    for name in ["../mujoco.h", "/etc/passwd", "a/../../b"] {
        assert!(safe(name).is_err(), "{name}");
    }
}
