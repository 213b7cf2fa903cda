//! A small disk of this process's own, filled to its last page, and made read-only half-way. Needs a mount namespace.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;
use std::process::Command;

use crate::writers::{Writer, let_go};
use crate::{unfinished, whole};

/// Said at the end.
pub const DONE: &str = "disk filled and forbidden";

/// Sizes of the disk and of its pages, bytes.
const DISK: u64 = 4 << 20;
const PAGE: u64 = 4096;

/// Pages that are left free, one after the other.
const MOST_FREE: u64 = 64;

fn mount(options: &str, folder: &Path) {
    let output = Command::new("mount").args(["-t", "tmpfs", "-o", options, "none"]).arg(folder).output();
    let output = output.expect("NOT CHECKED: there is no `mount`");
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
