//! Writes the mannequin: `cargo run -p viewer --bin mannequin -- assets/humanoid.glb`.

use std::path::PathBuf;

use anyhow::Context as _;

fn main() -> anyhow::Result<()> {
    let path =
        std::env::args_os().nth(1).map(PathBuf::from).context("expected the path of the file to write")?;
    let bytes = viewer::mannequin::generate();
    viewer::files::write(&path, &bytes).with_context(|| format!("cannot write {}", path.display()))?;
    println!("{}: {} bytes", path.display(), bytes.len());
    Ok(())
}
