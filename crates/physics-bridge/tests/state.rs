//! Saving, restoring, rewinding, replay files: all bit for bit.

mod common;

use common::{body, hash, humanoid, run};
use glam::Vec3;
use physics_bridge::{Character, HISTORY_SECS, ReplayFile, Settings, Terrain};
use policy_core::Heading;

/// A character in the middle of a fall, under a push, with everything that a state can hold.
fn busy() -> Character {
    let mut character = Character::new(&humanoid());
    run(&mut character, 20);
    character.push(body(character.model(), "torso"), Vec3::new(80.0, -30.0, 5.0), 0.5).unwrap();
    run(&mut character, 2);
    character.impulse(body(character.model(), "head"), Vec3::new(0.0, 3.0, 0.0)).unwrap();
    character
}

#[test]
fn a_restored_character_goes_on_bit_for_bit() {
    let mut first = busy();
    let saved = first.save();
    let mut second = Character::new(first.model());
    run(&mut second, 7);
    second.restore(&saved).unwrap();
    assert_eq!(hash(&first), hash(&second));
    for _ in 0..40 {
        run(&mut first, 1);
        run(&mut second, 1);
        assert_eq!(first.save(), second.save());
    }
    // And the first one again, from where it was.
    let end = hash(&first);
    first.restore(&saved).unwrap();
    run(&mut first, 40);
    assert_eq!(end, hash(&first));
}

#[test]
fn saving_changes_nothing() {
    let (mut first, mut second) = (busy(), busy());
    let mut buffer = second.save();
    for _ in 0..20 {
        second.save_into(&mut buffer);
        second.restore(&buffer).unwrap();
        run(&mut first, 1);
        run(&mut second, 1);
    }
    assert_eq!(hash(&first), hash(&second));
}

#[test]
fn the_history_holds_ten_seconds_and_goes_back_through_them() {
    let mut character = Character::new(&humanoid());
    assert_eq!((character.history_len(), character.rewind_to(0).is_err()), (0, true));
    character.record_history(HISTORY_SECS);
    assert_eq!(character.history_len(), 1);
    let mut hashes = vec![hash(&character)];
    for _ in 0..330 {
        run(&mut character, 1);
        hashes.push(hash(&character));
    }
    assert_eq!(character.history_len(), 301);
    for age in [0, 1, 150, 300, 7] {
        character.rewind_to(age).unwrap();
        assert_eq!(hash(&character), hashes[330 - age], "{age} ticks ago");
        assert_eq!((character.history_age(), character.tick()), (age, 330 - age as u64));
    }
    let error = character.rewind_to(301).unwrap_err();
    assert_eq!((error.asked, error.recorded), (301, 301));
    assert_eq!(hash(&character), hashes[323], "a refusal changes nothing");
}

#[test]
fn going_on_from_the_past_repeats_it_and_forgets_the_rest() {
    let mut character = busy();
    character.record_history(1.0);
    run(&mut character, 25);
    let end = hash(&character);
    character.rewind_to(20).unwrap();
    run(&mut character, 1);
    assert_eq!((character.history_age(), character.history_len()), (0, 7));
    run(&mut character, 19);
    assert_eq!(end, hash(&character));
    character.stand_at(0.0, 0.0, Heading::FORWARD, 0.0).unwrap();
    assert_eq!(character.history_len(), 1);
}

/// Whatever else lives in the process. Not pinned to a number: MuJoCo takes sines from the system's library,
/// which differs in the last bit between machines.
#[test]
fn the_same_run_gives_the_same_hash() {
    let end = |extra: usize| {
        let model = humanoid();
        let _others: Vec<Character> = (0..extra).map(|_| Character::new(&model)).collect();
        let mut character = Character::new(&model);
        run(&mut character, 100);
        hash(&character)
    };
    assert_eq!(end(0), end(3));
    assert_eq!(end(0), end(0));
}

#[test]
fn a_replay_file_continues_bit_for_bit() {
    let terrain = Terrain::Wavy { height_m: 0.2, wavelength_m: 3.0, seed: 5 };
    let settings = Settings { gravity: 0.9, friction: 0.7, strength: 1.1, mass: 0.9 };
    let model = humanoid().with_terrain(terrain).unwrap().with_settings(settings).unwrap();
    let mut character = Character::new(&model);
    run(&mut character, 20);
    character.push(body(character.model(), "torso"), Vec3::new(80.0, -30.1, 5.0), 0.5).unwrap();
    run(&mut character, 3);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("replay.json");
    character.replay_file().save(&path).unwrap();
    let replay = ReplayFile::load(&path).unwrap();
    assert_eq!(replay, character.replay_file());
    let mut replayed = replay.to_character().unwrap();
    assert_eq!((replayed.model().terrain(), replayed.model().settings()), (terrain, settings));
    for _ in 0..40 {
        run(&mut character, 1);
        run(&mut replayed, 1);
        assert_eq!(character.save(), replayed.save());
    }
}

/// The error for a replay file with one text replaced.
fn refused(from: &str, to: &str) -> String {
    let text = String::from_utf8(busy().replay_file().to_bytes()).unwrap();
    assert!(text.contains(from), "the file has no {from:?}");
    let result = ReplayFile::from_bytes(text.replacen(from, to, 1).as_bytes()).and_then(|d| d.to_character());
    result.unwrap_err().to_string()
}

#[test]
fn replay_files_that_are_none_are_refused() {
    assert!(refused("\"version\": 2", "\"version\": 3").contains("version 3"));
    assert!(refused("policy-space replay", "poem").contains("poem"));
    assert!(refused("\"tick\": 22", "\"tick\": 22, \"tock\": 1").contains("tock"));
    assert!(
        refused(
            "\"terrain\": \"flat\"",
            "\"terrain\": {\"wavy\": {\"height_m\": 9.0, \"wavelength_m\": 3.0, \"seed\": 1}}"
        )
        .contains("height_m")
    );
    assert!(refused("\"gravity\": 1.0", "\"gravity\": -1.0").contains("gravity"));
    assert!(refused("\"state\": \"", "\"state\": \"x").contains("character 0"));
    assert!(refused("\"state\": \"", "\"state\": \"7ff8000000000000").contains("number 0"));
    assert!(refused("\"state\": \"", "\"state\": \"0000000000000000").contains("found"));
    assert!(refused("80.0,", "1e30,").contains("pushes"));
    assert!(refused("\"control_hz\": 30.0", "\"control_hz\": 0.0").contains("control_hz"));
    assert!(refused("\"parent\": \"torso\"", "\"parent\": \"tail\"").contains("tail"));
    assert!(refused("\"name\": \"head\"", "\"name\": \"torso\"").contains("head"));
    assert!(refused("<mujoco ", "<mujaco ").contains("model"));
}

#[test]
fn every_truncated_replay_file_is_refused() {
    let bytes = busy().replay_file().to_bytes();
    for length in (0..bytes.len()).step_by(211) {
        assert!(ReplayFile::from_bytes(&bytes[..length]).is_err(), "cut off after {length} bytes");
    }
}
