//! A replay comes back as it went, as bytes and as a link, and what is broken is refused with a reason.
#![allow(missing_docs, reason = "tests")]

use proptest::prelude::*;
use replay::{
    Header, MOST_BYTES, MOST_TICKS, Mismatch, Pad, Playback, Recorder, Replay, ReplayError, checksum,
};

fn header(players: u8) -> Header {
    Header { pack_hash: 0x0123_4567_89ab_cdef, seed: 9, hash_every: 30, players, scene: "arena/2.a-b".into() }
}

fn recorded(players: u8, ticks: u32, pad: impl Fn(u32, u8) -> Pad) -> Replay {
    let mut recorder = Recorder::new(header(players)).unwrap();
    for tick in 0..ticks {
        let pads: Vec<Pad> = (0..players).map(|player| pad(tick, player)).collect();
        recorder.push(&pads, u64::from(tick) * 3).unwrap();
    }
    recorder.finish()
}

/// Bytes with a change, and the checksum of what they are now.
fn changed(replay: &Replay, change: impl Fn(&mut Vec<u8>)) -> Result<Replay, ReplayError> {
    let mut bytes = replay.to_bytes();
    bytes.truncate(bytes.len() - 4);
    change(&mut bytes);
    bytes.extend(checksum(&bytes).to_le_bytes());
    Replay::from_bytes(&bytes)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_is_read_and_played(
        players in 1u8..=8,
        pads in prop::collection::vec((any::<[u8; 10]>(), 1u32..50), 0..20),
    ) {
        let all: Vec<Pad> = pads
            .iter()
            .flat_map(|&(bytes, ticks)| std::iter::repeat_n(Pad::from_bytes(bytes), ticks as usize))
            .collect();
        let of = |tick: u32, player: u8| all[(tick as usize + usize::from(player)) % all.len()];
        let replay = recorded(players, all.len() as u32, of);
        let again = Replay::from_bytes(&replay.to_bytes()).unwrap();
        prop_assert_eq!(&again, &replay);
        if let Ok(link) = replay.to_link() {
            prop_assert_eq!(&Replay::from_link(&link).unwrap(), &replay);
        }
        let mut playback = Playback::new(&again);
        let mut tick = 0;
        while let Some(found) = playback.next_pads() {
            let expected: Vec<Pad> = (0..players).map(|player| of(tick, player)).collect();
            prop_assert_eq!(found, &expected[..]);
            prop_assert_eq!(playback.check(u64::from(tick) * 3), Ok(()));
            tick += 1;
        }
        prop_assert_eq!(tick, replay.ticks());
    }

    #[test]
    fn any_bytes_are_refused_or_a_replay(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let replay = recorded(1, 3, |_, _| Pad::default());
        let read = changed(&replay, |out| {
            out.truncate(6);
            out.extend(&bytes);
        });
        if let Ok(read) = read {
            prop_assert_eq!(&Replay::from_bytes(&read.to_bytes()).unwrap(), &read);
        }
    }
}

#[test]
fn every_damaged_byte_is_found() {
    let bytes =
        recorded(2, 70, |tick, player| Pad { triggers: [tick as u8, player], ..Pad::default() }).to_bytes();
    for at in 0..bytes.len() {
        let mut broken = bytes.clone();
        broken[at] ^= 0x10;
        assert!(Replay::from_bytes(&broken).is_err(), "byte {at}");
        assert!(Replay::from_bytes(&bytes[..at]).is_err(), "cut at {at}");
    }
}

#[test]
fn errors_say_what_was_expected_and_found() {
    let replay = recorded(1, 60, |_, _| Pad::default());
    let said = |result: Result<Replay, ReplayError>| result.unwrap_err().to_string();
    assert!(said(Replay::from_bytes(b"RIFF....")).contains("expected a replay"));
    assert_eq!(said(Replay::from_bytes(b"PSRP\x07\0")), "expected a replay of format version 1, found 7");
    let long = said(Replay::from_bytes(&vec![0; MOST_BYTES + 1]));
    assert!(long.contains("at most 8388608 bytes, found 8388609"), "{long}");
    assert!(said(changed(&replay, |b| b[20] = 9)).contains("players"));
    assert!(said(changed(&replay, |b| b[20] = 0)).contains("1 to 8, found 0"));
    assert!(said(changed(&replay, |b| b[21] = 200)).contains("scene"));
    assert!(said(changed(&replay, |b| b[22] = b'\x1b')).contains("a-z"));
    assert!(said(changed(&replay, |b| b[6..8].fill(0))).contains("hash_every"));
    let ticks = 22 + "arena/2.a-b".len();
    let most = (MOST_TICKS + 1).to_le_bytes();
    assert!(said(changed(&replay, |b| b[ticks..ticks + 4].copy_from_slice(&most))).contains("432000"));
    // One run says that it lasts for an hour, and the hashes of that hour are not there.
    let claimed = said(changed(&replay, |b| {
        b[ticks..ticks + 4].copy_from_slice(&MOST_TICKS.to_le_bytes());
        b.splice(ticks + 4..ticks + 6, [0x80, 0xaf, 0x1a, 0]);
    }));
    assert!(claimed.contains("the hashes") && claimed.contains("expected 115208 more bytes"), "{claimed}");
    assert!(said(changed(&replay, |b| b.push(0))).contains("found 1 more bytes"));
    assert!(said(changed(&replay, |b| b[ticks + 4] = 61)).contains("as are left"));
    assert!(said(changed(&replay, |b| b[ticks + 5] = 64)).contains("six fields"));
    assert!(said(Replay::from_link("AAA?")).contains("at character 3"));
}

#[test]
fn headers_and_pads_are_checked_when_recording_starts() {
    for scene in ["", "A", "a b", "ä", &"a".repeat(65)] {
        let wrong = Header { scene: scene.into(), ..header(1) };
        assert!(matches!(Recorder::new(wrong), Err(ReplayError::Field { field: "scene", .. })), "{scene}");
    }
    assert!(Recorder::new(header(0)).is_err() && Recorder::new(header(9)).is_err());
    assert!(Recorder::new(header(2)).unwrap().push(&[Pad::default()], 0).is_err());
    let other = Header { pack_hash: 1, ..header(1) };
    let said = header(1).expect(&other).unwrap_err().to_string();
    assert!(said.contains("pack") && said.contains("0000000000000001"), "{said}");
    assert_eq!(header(1).expect(&header(1)), Ok(()));
}

#[test]
fn playing_stops_at_the_first_hash_that_differs() {
    let replay = recorded(1, 100, |_, _| Pad::default());
    let mut playback = Playback::new(&replay);
    let mut mismatch = None;
    while mismatch.is_none() && playback.next_pads().is_some() {
        let tick = u64::from(playback.tick()) - 1;
        // The state goes astray in tick 45 of 100.
        mismatch = playback.check(if tick < 45 { tick * 3 } else { 1 }).err();
    }
    let expected = Mismatch { tick: 60, equal: 30, expected: 59 * 3, found: 1 };
    assert_eq!(mismatch, Some(expected));
    assert!(expected.to_string().contains("after tick 60"));
}

#[test]
fn a_held_stick_takes_few_bytes_and_a_stick_that_moves_fits_a_link() {
    let held = recorded(1, 18_000, |_, _| Pad { left_stick: [0, 127], ..Pad::default() });
    assert!(held.to_bytes().len() < 4900, "mostly hashes");
    let moved =
        recorded(1, 600, |tick, _| Pad { left_stick: [tick as i8, 100], camera: 77, ..Pad::default() });
    assert!(moved.to_link().unwrap().len() < 3000);
    let long = recorded(1, 9000, |tick, _| Pad { left_stick: [tick as i8, 100], ..Pad::default() });
    assert!(matches!(long.to_link(), Err(ReplayError::LongLink { .. })));
}

#[test]
fn eight_sticks_that_move_for_an_hour_fit() {
    let stick = |tick: u32, player: u8| Pad { left_stick: [tick as i8, player as i8], ..Pad::default() };
    let hour = recorded(8, 30 * 3600, stick);
    let bytes = hour.to_bytes();
    assert!(bytes.len() <= MOST_BYTES);
    assert_eq!(Replay::from_bytes(&bytes).unwrap(), hour);
}

/// The recorder counts the bytes as they are written, to the last one.
#[test]
fn a_recorder_is_full_when_its_bytes_are() {
    let mut recorder = Recorder::new(header(3)).unwrap();
    let mut seed = 5u32;
    let mut pads = [Pad::default(); 3];
    let error = loop {
        for pad in &mut pads {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            match seed >> 29 {
                0..=1 => {}
                2 => pad.left_stick[1] = (seed >> 8) as i8,
                _ => {
                    *pad = Pad::from_bytes(std::array::from_fn(|i| (seed >> i) as u8));
                    pad.buttons >>= seed >> 27;
                }
            }
        }
        if let Err(error) = recorder.push(&pads, 7) {
            break error;
        }
    };
    let replay = recorder.finish();
    assert!(replay.ticks() < MOST_TICKS, "the bytes end first");
    let bytes = replay.to_bytes();
    assert_eq!(Replay::from_bytes(&bytes).unwrap(), replay);
    assert!((MOST_BYTES - 3 * 13 - 8..=MOST_BYTES).contains(&bytes.len()), "{}", bytes.len());
    let ReplayError::Field { field: "the pads", found, .. } = &error else { panic!("{error}") };
    assert!(found.parse::<usize>().unwrap() > MOST_BYTES, "{error}");
}

#[test]
fn the_seeds_of_the_fuzzer_are_replays() {
    for (file, link) in [
        (
            &include_bytes!("../../../fuzz/seeds/pad_replay/one.replay")[..],
            include_str!("../../../fuzz/seeds/replay_link/one.txt"),
        ),
        (
            &include_bytes!("../../../fuzz/seeds/pad_replay/two.replay")[..],
            include_str!("../../../fuzz/seeds/replay_link/two.txt"),
        ),
    ] {
        let replay = Replay::from_bytes(file).unwrap();
        assert_eq!(replay.to_bytes(), file, "the format has not changed");
        assert_eq!(replay.to_link().unwrap(), link);
    }
}
