//! Packs: what is written is read again, and nothing bad is.

mod common;

use common::{manifest, pack, tensors};
use policy_core::format::{MAX_HEADER_BYTES, Manifest};
use policy_core::training::PackTensors;
use policy_core::{CharacterPack, PackError};
use proptest::prelude::*;

fn refused(change: impl FnOnce(&mut Manifest, &mut PackTensors)) -> String {
    let (mut m, mut t) = (manifest(), tensors(0.0));
    change(&mut m, &mut t);
    CharacterPack::from_parts(m, t).expect_err("the pack is bad").to_string()
}

#[test]
fn a_pack_survives_its_bytes() {
    let first = pack(1.0);
    let bytes = first.to_bytes();
    let second = CharacterPack::from_bytes(&bytes).unwrap();
    let unsigned = |p: &CharacterPack| Manifest { checksum: None, ..p.manifest().clone() };
    assert_eq!(unsigned(&first), unsigned(&second));
    assert!(second.is_verified() && !first.is_verified());
    assert_eq!(first.tensors(), second.tensors());
    assert_eq!(bytes, second.to_bytes(), "the same pack gives the same bytes");
    let changed = PackTensors { mesh: Some(vec![7]), ..second.tensors().clone() };
    let changed = CharacterPack::from_parts(second.manifest().clone(), changed).unwrap();
    assert!(!changed.is_verified(), "the checksum is one of other bytes");
}

#[test]
fn messages_name_field_expected_and_found() {
    let says = |message: String, parts: &[&str]| {
        assert!(parts.iter().all(|p| message.contains(p)), "{message}");
    };
    says(refused(|m, _| m.version = 3), &["version", "2", "3"]);
    says(refused(|m, _| m.format = "x".into()), &["format", "policy-space character pack", "x"]);
    says(refused(|m, _| m.skeleton.bodies.swap(0, 1)), &["skeleton", "parent of body \"torso\""]);
    says(refused(|m, _| m.skeleton.joints[2].body = "tail".into()), &["body", "joints", "tail"]);
    says(refused(|m, _| m.skeleton.roles.head = Some("tail".into())), &["body", "roles", "tail"]);
    says(refused(|m, _| drop(m.skeleton.joints.pop())), &["124 means", "discriminator", "125"]);
    says(refused(|m, _| m.policies = vec![m.policies[0].clone(); 65]), &["64 policies", "65"]);
    says(refused(|m, _| m.skills[0].entry = vec!["roll".into()]), &["way", "skill \"roll\"", "idle"]);
    says(refused(|m, _| m.paths[0].name = "x".repeat(65)), &["path name", "64", "65"]);
    says(refused(|m, _| m.policies[1].name = "idle".into()), &["policy name", "unique", "idle"]);
    says(refused(|m, _| m.skills[1].name = "roll".into()), &["skill name", "roll"]);
    says(refused(|m, _| m.paths[0].nodes[2] = "gallop".into()), &["path \"speed\"", "gallop"]);
    says(refused(|m, _| m.paths[0].nodes.swap(0, 2)), &["path \"speed\"", "edges"]);
    says(refused(|m, _| m.edges[0].nodes[1] = "gallop".into()), &["edges", "gallop"]);
    says(refused(|m, _| m.edges[0].seconds = 0.0), &["edge 0", "above 0"]);
    says(refused(|m, _| m.edges[0].seconds = f32::NAN), &["edge 0"]);
    says(refused(|m, _| m.edges[0].nodes[1] = "idle".into()), &["edge 0", "different"]);
    says(refused(|m, _| m.skills[0].end.threshold = 1.5), &["threshold", "skill \"roll\"", "0 to 1", "1.5"]);
    says(refused(|m, _| m.skills[0].end.hold_seconds = 0.0), &["hold_seconds", "above 0"]);
    says(refused(|m, _| m.skills[0].discriminator = Some("jog".into())), &["discriminator", "jog"]);
    says(refused(|m, _| m.skills[0].returns_to = "jgo".into()), &["policy", "jgo"]);
    says(refused(|m, _| m.recovery = Some("fly".into())), &["recovery", "fly"]);
    says(refused(|m, _| m.control_hz = f32::NAN), &["control_hz", "1 to 1000", "NaN"]);
    says(refused(|m, _| m.action_gain[3] = -1.0), &["joint 3", "positive", "-1"]);
    says(refused(|m, _| m.action_gain[3] = 3e38), &["joint 3", "action_gain", "1000", "300000"]);
    says(refused(|m, _| m.action_centre[3] = -3e38), &["joint 3", "action_centre", "1000", "-300000"]);
    says(refused(|m, _| m.action_gain.truncate(5)), &["28 action_gain", "5"]);
    says(refused(|m, _| m.policies[2].fall_height = Some(-1.0)), &["fall_height", "jog", "-1"]);
    says(refused(|_, t| drop(t.policies.pop())), &["7 policies", "6"]);
    says(refused(|_, t| t.policies[3] = common::mlp(&[225, 64, 32, 28], 1)), &["run", "[225, 64, 32, 28]"]);
    says(refused(|_, t| t.discriminators[0] = common::mlp(&[625, 8, 2], 1)), &["walk", "625 .. 1"]);
    says(refused(|_, t| t.observation_normaliser = common::normaliser(5)), &["223", "5"]);
    says(refused(|m, t| (m.policies.clear(), t.policies.clear()).1), &["1 to 64", "0"]);
}

/// Lists that are looked up in each other are bounded before that, so that a small file can't take minutes.
#[test]
fn long_lists_are_refused_before_they_are_looked_up() {
    let most = |change: fn(&mut Manifest)| {
        let (mut m, t) = (manifest(), tensors(0.0));
        change(&mut m);
        match CharacterPack::from_parts(m, t) {
            Err(PackError::TooMany { what, most, found }) => (what, most, found),
            other => panic!("expected too many, found {other:?}"),
        }
    };
    assert_eq!(most(|m| m.skeleton.bodies = vec![m.skeleton.bodies[1].clone(); 257]), ("bodies", 256, 257));
    assert_eq!(most(|m| m.skeleton.joints = vec![m.skeleton.joints[0].clone(); 257]), ("joints", 256, 257));
    assert_eq!(most(|m| m.skeleton.roles.hands = vec!["head".into(); 257]), ("hands", 256, 257));
    assert_eq!(most(|m| m.skeleton.roles.feet = vec!["head".into(); 257]), ("feet", 256, 257));
    let to_and_fro = |m: &mut Manifest| {
        m.paths[0].nodes = ["idle", "walk"].into_iter().cycle().take(65).map(Into::into).collect();
    };
    assert_eq!(most(to_and_fro), ("policies of a path", 64, 65));
    assert_eq!(most(|m| m.skills[0].entry = vec!["walk".into(); 65]), ("entries of a skill", 64, 65));
    let in_stride = |m: &mut Manifest| m.skills[0].in_stride = vec!["roll".into(); 9];
    assert_eq!(most(in_stride), ("skills in_stride of one", 8, 9));
}

/// Bytes of a pack without a checksum and with its header's text changed.
fn with_header(change: impl Fn(String) -> String) -> Vec<u8> {
    let bytes = pack(0.0).to_bytes();
    let change = |header: String| {
        let from = header.find("\\\"checksum\\\"").expect("written with a checksum");
        let to = from + header[from..].find(',').expect("another field follows") + 1;
        change(format!("{}{}", &header[..from], &header[to..]))
    };
    let length = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
    let header = change(String::from_utf8(bytes[8..8 + length].to_vec()).unwrap());
    let mut out = (header.len() as u64).to_le_bytes().to_vec();
    out.extend(header.as_bytes());
    out.extend(&bytes[8 + length..]);
    out
}

fn message(bytes: &[u8]) -> String {
    CharacterPack::from_bytes(bytes).expect_err("the pack is bad").to_string()
}

#[test]
fn bad_files_are_refused() {
    let bytes = pack(0.0).to_bytes();
    for length in [0, 7, 8, 100, bytes.len() / 2, bytes.len() - 1] {
        assert!(
            matches!(CharacterPack::from_bytes(&bytes[..length]), Err(PackError::Container { .. })),
            "{length}"
        );
    }
    assert!(message(&with_header(|h| h.replace("policy_space", "policy_spice"))).contains("policy_space"));
    assert!(
        message(&with_header(|h| h.replace("\\\"recovery\\\"", "\\\"recovary\\\""))).contains("recovary")
    );
    let renamed = with_header(|h| h.replace("policy.run.layer1.bias", "policy.ran.layer1.bias"));
    assert!(message(&renamed).contains("policy.run.layer1.bias"));
    let shape = with_header(|h| h.replacen("\"shape\":[225,128]", "\"shape\":[128,225]", 1));
    assert!(message(&shape).contains("[225, 128]"));
    let same = with_header(|h| h.replace("policy.run.layer1.bias", "policy.jog.layer1.bias"));
    assert!(CharacterPack::from_bytes(&same).is_err(), "a tensor named twice");
    let mut nan = with_header(|h| h);
    assert!(!CharacterPack::from_bytes(&nan).unwrap().is_verified(), "a pack without a checksum loads");
    let at = nan.len() - 4;
    nan[at..].copy_from_slice(&f32::NAN.to_le_bytes());
    let found = message(&nan);
    assert!(found.contains("NaN") && found.contains("finite"), "{found}");
}

#[test]
fn an_extra_tensor_is_refused() {
    // The manifest forgets a policy whose tensors stay.
    let bytes = with_header(|h| {
        let from = h.find("{\\\"name\\\":\\\"roll\\\",\\\"layers\\\"").unwrap();
        let to = h[from..].find('}').unwrap() + from + 1;
        let mut h = h;
        h.replace_range(from - 1..to, "");
        h.replace("\\\"policy\\\":\\\"roll\\\"", "\\\"policy\\\":\\\"walk\\\"")
    });
    let found = message(&bytes);
    assert!(found.contains("policy.roll."), "{found}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_flipped_bit_is_noticed(at in 0.0f64..1.0, bit in 0u8..8, in_header in any::<bool>()) {
        let mut bytes = pack(0.0).to_bytes();
        let header = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize + 8;
        let range = if in_header { header } else { bytes.len() };
        bytes[(at * range as f64) as usize] ^= 1 << bit;
        prop_assert!(CharacterPack::from_bytes(&bytes).is_err());
    }

    #[test]
    fn a_flipped_bit_without_a_checksum_never_panics(at in 0.0f64..1.0, bit in 0u8..8) {
        let mut bytes = with_header(|h| h);
        let header = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize + 8;
        bytes[(at * header as f64) as usize] ^= 1 << bit;
        if let Ok(pack) = CharacterPack::from_bytes(&bytes) {
            let finite = |m: &policy_core::Mlp| m.layers().iter().all(|l| l.weight().all(f32::is_finite));
            prop_assert!(pack.policies().iter().all(finite), "what loads is sound");
        }
    }
}

/// The reference pack of the golden tests stays one of version 1.
#[test]
fn a_pack_of_version_1_loads_and_is_written_as_version_2() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/reference.pack.safetensors");
    let old = CharacterPack::from_bytes(&std::fs::read(path).unwrap()).unwrap();
    assert_eq!((old.skeleton().body_count(), old.skeleton().joint_count()), (15, 28));
    assert!(old.mjcf().is_none() && old.actuation().is_none() && !old.is_verified());
    let new = CharacterPack::from_bytes(&old.to_bytes()).unwrap();
    assert!(new.is_verified());
    assert_eq!(new.tensors(), old.tensors());
    assert_eq!(new.skills(), old.skills());
}

#[test]
fn body_text_motors_credits_and_mesh_survive() {
    use policy_core::format::CreditEntry;
    use policy_core::{ActuationContract, JointActuation};
    let (mut manifest, mut tensors) = (manifest(), tensors(0.0));
    manifest.mjcf = Some("<mujoco>\n  \"quoted\"\n</mujoco>".into());
    let motor = JointActuation { gain: 300.0, damping: 30.0, force_limit: 200.0, armature: 0.02 };
    manifest.actuation =
        Some(ActuationContract { physics_hz: 120.0, mass_kg: 48.9, joints: vec![motor; 28] });
    let credit = CreditEntry { work: "walk".into(), source: "somebody".into(), licence: "CC0".into() };
    manifest.credits = vec![credit];
    tensors.mesh = Some(vec![1, 2, 3]);
    let pack = CharacterPack::from_parts(manifest.clone(), tensors.clone()).unwrap();
    let read = CharacterPack::from_bytes(&pack.to_bytes()).unwrap();
    assert_eq!((read.mjcf(), read.mesh()), (pack.mjcf(), Some(&[1u8, 2, 3][..])));
    assert_eq!((read.actuation(), read.credits()), (pack.actuation(), pack.credits()));
    manifest.actuation.as_mut().unwrap().joints[3].gain = f32::NAN;
    let error = CharacterPack::from_parts(manifest.clone(), tensors.clone()).unwrap_err().to_string();
    assert!(error.contains("gain") && error.contains("actuation"), "{error}");
    manifest.actuation.as_mut().unwrap().joints.pop();
    let error = CharacterPack::from_parts(manifest, tensors).unwrap_err().to_string();
    assert!(error.contains("28 actuation.joints") && error.contains("27"), "{error}");
}

#[test]
fn messages_are_short_and_safe_for_a_terminal() {
    let long = with_header(|h| {
        h.replace(
            "\\\"recovery\\\":\\\"get_up\\\"",
            &format!("\\\"recovery\\\":\\\"{}\\\"", "x".repeat(9000)),
        )
    });
    assert!(message(&long).len() < 400, "{}", message(&long).len());
    let escape = refused(|m, _| m.policies[1].name = "idle\u{1b}[2J".into());
    assert!(!escape.contains('\u{1b}'), "{escape:?}");
    let twice = refused(|m, _| {
        m.skills[1].name = "\u{1b}[2J".into();
        m.skills[0].name = m.skills[1].name.clone();
    });
    assert!(twice.contains("skill name") && !twice.contains('\u{1b}'), "{twice:?}");
}

#[test]
fn a_header_that_would_fill_the_memory_is_refused_unread() {
    let length = MAX_HEADER_BYTES + 1;
    let mut bytes = (length as u64).to_le_bytes().to_vec();
    bytes.resize(8 + length, b'[');
    let error = CharacterPack::from_bytes(&bytes).unwrap_err();
    assert!(matches!(error, PackError::TooMany { what: "bytes in the header", .. }), "{error}");
}
