//! Says which system packages are missing and installs them where that is possible.
//!
//! Knows Debian and Ubuntu. Elsewhere it names what is needed and changes nothing. A package counts as there
//! when dpkg says so, or when what it is needed for works already (a compiler or a pip from another source).

use std::collections::HashSet;
use std::process::{Command, Stdio};

use anyhow::Result;

use super::download::python_with_pip;
use crate::workspace::{answers, run};

/// A Debian package and what it is needed for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Package {
    /// Its name in Debian 12 and later and in Ubuntu 22.04 and later.
    pub name: &'static str,
    /// What fails without it.
    pub needed_for: &'static str,
}

const fn package(name: &'static str, needed_for: &'static str) -> Package {
    Package { name, needed_for }
}

/// What building, the demo and the tests need.
const BASE: [Package; 12] = [
    package("gcc", "linking"),
    package("libc6-dev", "linking"),
    package("python3-pip", "fetching libmujoco"),
    package("libvulkan1", "drawing"),
    package("mesa-vulkan-drivers", "drawing without a graphics card"),
    package("libx11-6", "the window"),
    package("libx11-xcb1", "the window"),
    package("libxcursor1", "the window"),
    package("libxi6", "the window"),
    package("libxkbcommon-x11-0", "the window"),
    package("pkg-config", "finding ALSA; the check of the C interface"),
    package("libasound2-dev", "the demo's sounds, silent without; their check"),
];

/// What the tests use beyond that. A check that lacks one of them fails.
const TESTS: [Package; 3] = [
    package("xvfb", "the tests in a real window"),
    package("xdotool", "the tests in a real window"),
    package("clang", "the check of the C interface"),
];

/// What the check of the page uses beyond the base.
const BROWSER: [Package; 2] =
    [package("chromium", "the check of the page"), package("chromium-driver", "the check of the page")];

/// What a verb is about to do, which decides what it needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Build and run.
    Demo,
    /// Build, run and test in a real window.
    Tests,
    /// Build, run and play the page in a browser.
    Browser,
}

/// Says what is missing, and installs it when `install` is set, this is Debian or Ubuntu, and the user is root.
///
/// Missing packages are no error, nor is an installation that fails: what cannot be done without them fails with its own
/// message.
pub fn prepare(purpose: Purpose, install: bool) {
    if !cfg!(target_os = "linux") {
        return;
    }
    let needed: Vec<Package> = match purpose {
        Purpose::Demo => BASE.to_vec(),
        Purpose::Tests => BASE.iter().chain(&TESTS).copied().collect(),
        Purpose::Browser => BASE.iter().chain(&BROWSER).copied().collect(),
    };
    let Some(listing) = dpkg_listing(&needed) else {
        if !has_vulkan_loader() {
            eprintln!(
                "xtask: not Debian or Ubuntu; this is needed, under Debian's names: {}",
                names(&needed)
            );
        }
        return;
    };
    let missing: Vec<Package> =
        missing(&needed, &listing).into_iter().filter(|package| !works_without(package)).collect();
    if missing.is_empty() {
        return;
    }
    eprintln!("xtask: missing system packages:");
    for package in &missing {
        eprintln!("    {:24}{}", package.name, package.needed_for);
    }
    if !install || !is_root() {
        let why = if install { "only root can install them" } else { "not installing them (--no-install)" };
        eprintln!("xtask: {why}:\n    sudo apt-get update && sudo apt-get install {}", names(&missing));
        return;
    }
    if let Err(error) = apt_install(&missing) {
        eprintln!("xtask: {error:#}; going on without {}", names(&missing));
    }
}

/// What dpkg says about the packages, `None` where there is no dpkg.
fn dpkg_listing(packages: &[Package]) -> Option<String> {
    let output = Command::new("dpkg-query")
        .args(["--show", "--showformat", "${Package} ${db:Status-Status}\\n"])
        .args(packages.iter().map(|package| package.name))
        .stdin(Stdio::null())
        .output()
        .ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The packages that a listing of lines `name status` does not call installed.
fn missing(needed: &[Package], listing: &str) -> Vec<Package> {
    let installed: HashSet<&str> = listing
        .lines()
        .filter_map(|line| line.split_once(' '))
        .filter(|(_, status)| status.trim() == "installed")
        .map(|(name, _)| name)
        .collect();
    needed.iter().filter(|package| !installed.contains(package.name)).copied().collect()
}

/// Whether the thing that a package is needed for is there from another source.
fn works_without(package: &Package) -> bool {
    match package.name {
        "gcc" => answers(Command::new("cc").arg("--version")),
        "python3-pip" => python_with_pip().is_some(),
        "chromium-driver" => answers(Command::new("chromedriver").arg("--version")),
        "libasound2-dev" => has_alsa(),
        "chromium" | "clang" | "pkg-config" => answers(Command::new(package.name).arg("--version")),
        _ => false,
    }
}

/// Whether the demo builds with its feature `sound` here: on Linux it links ALSA.
pub fn has_sound() -> bool {
    if cfg!(target_os = "linux") { has_alsa() } else { cfg!(any(windows, target_os = "macos")) }
}

/// Whether the tests in a real window can run here: a display without a screen, keys and mouse, and something that draws.
pub fn has_window() -> bool {
    let there = |program: &str| answers(Command::new("which").arg(program));
    cfg!(target_os = "linux") && there("Xvfb") && there("xdotool") && has_vulkan_loader()
}

fn has_alsa() -> bool {
    answers(Command::new("pkg-config").args(["--exists", "alsa"]))
}

fn has_vulkan_loader() -> bool {
    let output = Command::new("ldconfig").arg("-p").stdin(Stdio::null()).output();
    output.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains("libvulkan.so.1"))
}

fn is_root() -> bool {
    let output = Command::new("id").arg("-u").stdin(Stdio::null()).output();
    output.is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

fn apt_install(packages: &[Package]) -> Result<()> {
    let apt = || {
        let mut command = Command::new("apt-get");
        command
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdin(Stdio::null())
            .stdout(Stdio::from(std::io::stderr()));
        command
    };
    eprintln!("xtask: installing {}", names(packages));
    run(apt().args(["update", "--quiet=2"]))?;
    let arguments = ["install", "--yes", "--quiet=2", "--no-install-recommends"];
    run(apt().args(arguments).args(packages.iter().map(|package| package.name)))
}

fn names(packages: &[Package]) -> String {
    packages.iter().map(|package| package.name).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_dpkg_calls_installed_is_there() {
        let needed = [package("gcc", ""), package("libxi6", ""), package("xvfb", ""), package("xdotool", "")];
        let listing = "gcc installed\nxvfb config-files\nxdotool not-installed\nlibxi6 installed\n";
        let missing = missing(&needed, listing);
        assert_eq!(names(&missing), "xvfb xdotool");
    }

    #[test]
    fn a_package_of_two_architectures_is_there_when_one_is() {
        let needed = [package("libx11-6", "")];
        assert!(missing(&needed, "libx11-6 installed\nlibx11-6 not-installed\n").is_empty());
        assert!(missing(&needed, "libx11-6 not-installed\nlibx11-6 installed\n").is_empty());
    }

    #[test]
    fn an_empty_or_odd_listing_means_that_all_is_missing() {
        assert_eq!(missing(&BASE, "").len(), BASE.len());
        assert_eq!(missing(&BASE, "gcc\n\ngcc-12 installed\n").len(), BASE.len());
    }
}
