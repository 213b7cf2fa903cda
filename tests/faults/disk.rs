//! A small disk of this process's own, filled to its last page, and made read-only half-way. Needs a mount namespace.
//! Where there is none, a folder is forbidden by its mode; writes that end too early are then those of the write limits.

use std::fs::{File, Permissions};
use std::io::Write as _;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::Command;

use crate::writers::{Writer, let_go};
use crate::{unfinished, whole};

/// Said at the ends.
pub const DONE: &str = "disk filled and forbidden";
pub const FORBIDDEN: &str = "folder forbidden";

/// Said when nothing holds this process back from writing, as it is for root.
pub const NOT_HELD_BACK: &str = "writes into a folder of mode 555 succeed";

/// Sizes of the disk and of its pages, bytes.
const DISK: u64 = 4 << 20;
const PAGE: u64 = 4096;

/// Pages that are left free, one after the other.
const MOST_FREE: u64 = 64;

fn mount(options: &str, folder: &Path) {
    let output = Command::new("mount").args(["-t", "tmpfs", "-o", options, "none"]).arg(folder).output();
    let output = output.expect("`mount` is part of util-linux");
    if !output.status.success() {
        // No panic: whoever runs this without the right to mount is told, and that is all.
        println!("cannot mount: {}", String::from_utf8_lossy(&output.stderr));
        std::process::exit(3);
    }
}

pub fn fill_and_forbid(writer: &Writer, folder: &Path) {
    mount(&format!("size={DISK}"), folder);
    (writer.write)(folder, 1).expect("there is room");
    let filler = folder.join("filler");
    let (mut failed, mut done, mut version) = (0, 0, 1);
    for free in 0..MOST_FREE {
        fill(&filler, free);
        let written = (writer.write)(folder, version + 1);
        let found = whole(writer, folder, "a full disk");
        assert!(unfinished(folder).is_empty(), "{:?} with {free} pages free", unfinished(folder));
        match written {
            Ok(()) => (version, done) = (version + 1, done + 1),
            Err(_) => failed += 1,
        }
        assert_eq!(found, Some(version), "{} with {free} pages free", writer.name);
    }
    std::fs::remove_file(&filler).unwrap();
    assert!(failed > 0 && done > 0, "{}: {failed} failed, {done} did not", writer.name);

    // A lock that is held keeps the disk from being made read-only.
    let_go();
    mount(&format!("remount,ro,size={DISK}"), folder);
    (writer.write)(folder, version + 1).expect_err("the disk is read-only");
    assert_eq!(whole(writer, folder, "a read-only folder"), Some(version));
    mount(&format!("remount,rw,size={DISK}"), folder);
    (writer.write)(folder, version + 1).expect("it can be written again");
    assert_eq!(whole(writer, folder, "a folder that can be written again"), Some(version + 1));
    let_go();
    println!("{}: {DONE}: {failed} writes failed, {done} did not", writer.name);
}

/// A folder made read-only half-way, by its mode.
pub fn forbid(writer: &Writer, folder: &Path) {
    (writer.write)(folder, 1).expect("the folder can be written");
    let_go();
    set_modes(folder, 0o555);
    let probe = folder.join("probe");
    if File::create(&probe).is_ok() {
        std::fs::remove_file(probe).unwrap();
        set_modes(folder, 0o755);
        println!("{NOT_HELD_BACK}");
        std::process::exit(3);
    }
    (writer.write)(folder, 2).expect_err("the folder is read-only");
    assert_eq!(whole(writer, folder, "a read-only folder"), Some(1));
    set_modes(folder, 0o755);
    (writer.write)(folder, 2).expect("it can be written again");
    assert_eq!(whole(writer, folder, "a folder that can be written again"), Some(2));
    let_go();
    println!("{}: {FORBIDDEN}", writer.name);
}

/// Sets the modes of a folder and of those in it.
fn set_modes(folder: &Path, mode: u32) {
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        if entry.path().is_dir() {
            set_modes(&entry.path(), mode);
        }
    }
    std::fs::set_permissions(folder, Permissions::from_mode(mode)).unwrap();
}

/// Fills the disk but for some pages.
fn fill(filler: &Path, free: u64) {
    let mut file = File::create(filler).unwrap();
    let page = [1; PAGE as usize];
    let mut pages = 0;
    while file.write_all(&page).is_ok() {
        pages += 1;
    }
    file.set_len(PAGE * (pages - free.min(pages))).unwrap();
}
