//! A pack file that is written anew while a character walks: Bevy's file watcher sees it, and nobody is asked.

mod common;

use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy_policy_space::RapierArticulation;
use bevy_policy_space::prelude::*;
use policy_core::CharacterPack;

use common::{game_that_watches, heard, pack_bytes, place, report, root_height, run, walk_to};

/// Waits, in real time, for what the watcher and the asset server do.
fn wait_until(app: &mut App, what: &str, done: impl Fn(&App) -> bool) {
    let start = Instant::now();
    while !done(app) {
        assert!(start.elapsed() < Duration::from_secs(30), "{what} within 30 s: {:?}", heard(app));
        app.update();
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn pack_of(app: &App, character: Entity) -> Arc<CharacterPack> {
    app.world().get::<PolicyController>(character).expect("a controller").controller.pack().clone()
}

/// The shipped pack with a character of another name.
fn renamed(name: &str) -> Vec<u8> {
    let sound = CharacterPack::from_bytes(&pack_bytes()).expect("the shipped pack");
    let mut manifest = sound.manifest().clone();
    manifest.character = name.into();
    CharacterPack::from_parts(manifest, sound.tensors().clone()).expect("a pack").to_bytes()
}

#[test]
fn a_file_that_is_written_anew_takes_over_in_mid_walk() {
    let folder = std::env::temp_dir().join(format!("bevy_policy_space_watch_{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("hero.pack.safetensors");
    std::fs::write(&file, pack_bytes()).expect("a file");
    let mut app = game_that_watches(64.0, folder.to_str().expect("a plain path"));
    let handle = app.world().resource::<AssetServer>().load("hero.pack.safetensors");
    let walk = walk_to(Vec3::new(0.0, 0.0, -1000.0));
    let character = app.world_mut().spawn((PolicyCharacter::new(handle), walk)).id();
    wait_until(&mut app, "a body", |app| app.world().get::<RapierArticulation>(character).is_some());
    run(&mut app, 2.0);

    for name in ["hero two", "hero three"] {
        let (before, at, ticks) =
            (pack_of(&app, character), place(&app, character).z, report(&app, character).ticks);
        std::fs::write(&file, renamed(name)).expect("a file");
        wait_until(&mut app, "the new pack", |app| !Arc::ptr_eq(&before, &pack_of(app, character)));
        assert_eq!(pack_of(&app, character).manifest().character, name);
        run(&mut app, 2.0);
        assert!(report(&app, character).ticks > ticks + 55 && place(&app, character).z < at - 1.0);
    }
    assert_eq!((heard(&app).fell, heard(&app).errors.len()), (0, 0), "{:?}", heard(&app).errors);

    // A file that is broken is reported, and the character keeps what it has.
    let before = pack_of(&app, character);
    std::fs::write(&file, b"half a fi").expect("a file");
    wait_until(&mut app, "a report", |app| !heard(app).errors.is_empty());
    run(&mut app, 1.0);
    assert!(heard(&app).errors[0].contains("hero.pack.safetensors"), "{:?}", heard(&app).errors);
    assert!(Arc::ptr_eq(&before, &pack_of(&app, character)) && root_height(&app, character) > 0.7);
    std::fs::remove_dir_all(&folder).expect("the folder is ours");
}
