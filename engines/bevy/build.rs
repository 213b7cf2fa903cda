//! Tells the loader where libmujoco is, for the tests and examples of this crate. A game with the feature `mujoco` does the
//! same for its own programs, or puts libmujoco where its system looks.

use std::env;

fn main() {
    const DIRECTORY: &str = "MUJOCO_DYNAMIC_LINK_DIR";
    println!("cargo::rerun-if-env-changed={DIRECTORY}");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("windows")
        && let Ok(directory) = env::var(DIRECTORY)
    {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{directory}");
    }
}
