//! Tells the loader where libmujoco is, for the tests, examples and binaries of the package that uses it.
//!
//! Link arguments do not pass from a library to the binaries of other packages, so every package that
//! links MuJoCo into something that runs names this file in its manifest:
//! `build = "../physics-bridge/build.rs"`.

use std::env;

fn main() {
    const DIRECTORY: &str = "MUJOCO_DYNAMIC_LINK_DIR";
    println!("cargo::rerun-if-env-changed={DIRECTORY}");
    let beside_the_binary = match env::var("CARGO_CFG_TARGET_OS").as_deref() {
        Ok("macos") => "@loader_path/lib",
        Ok("windows") => return, // searched for beside the binary and on PATH
        _ => "$ORIGIN/lib",
    };
    if let Ok(directory) = env::var(DIRECTORY) {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{directory}");
    }
    println!("cargo::rustc-link-arg=-Wl,-rpath,{beside_the_binary}");
}
