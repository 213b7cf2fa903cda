//! Files dropped on the window: packs and meshes are opened, others are refused in words that fit.

mod common;

use viewer::assets::{HUMANOID_GLB, HUMANOID_PACK};
use viewer::dropped::Dropped;

fn rig() -> viewer::mesh::Rig {
    viewer::appearance::rig(common::simulation().model())
}

fn dropped(name: &str, bytes: &[u8]) -> Result<Dropped, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    Dropped::load(&path, &rig()).map_err(|error| error.to_string())
}

#[test]
fn a_pack_and_a_mesh_are_told_apart_by_their_bytes() {
    assert!(matches!(dropped("a.bin", HUMANOID_PACK), Ok(Dropped::Pack(_))));
    assert!(matches!(dropped("b.bin", HUMANOID_GLB), Ok(Dropped::Mesh(_))));
}

#[test]
fn what_is_neither_is_refused_by_name() {
    for (name, bytes, part) in [
        (
            "notes.txt",
            &b"hello, this is a text"[..],
            "expected a character pack (.safetensors) or a mesh (.glb)",
        ),
        ("empty", b"", "expected a character pack"),
        ("cut.safetensors", &HUMANOID_PACK[..5000], "pack "),
        ("cut.glb", &HUMANOID_GLB[..5000], "mesh "),
    ] {
        let said = dropped(name, bytes).unwrap_err();
        assert!(said.contains(name) && said.contains(part), "{said}");
    }
    let folder = tempfile::tempdir().unwrap();
    let said = Dropped::load(folder.path(), &rig()).unwrap_err().to_string();
    assert!(said.contains("found a folder"), "{said}");
}
