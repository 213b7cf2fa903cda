use std::collections::HashMap;

use random::Rng;

use super::*;
use crate::checkpoint::Trained;
use crate::nn::{Adam, Network};

fn checkpoint(samples: u64) -> Checkpoint {
    let mut rng = Rng::new(samples, 1);
    let network = Network::new(&[3, 4, 2], 1.0, &mut rng);
    let adam = Adam { steps: 7, ..Adam::new(network.parameters.len()) };
    let networks = HashMap::from([("actor".to_owned(), Trained { network, adam })]);
    Checkpoint::new(networks, (1, samples, 3.0), 1e-4, rng)
}

fn samples(folder: &RunFolder) -> u64 {
    folder.load().unwrap().unwrap().checkpoint.progress.samples
}

#[test]
fn the_previous_checkpoint_stands_in_for_a_torn_one_and_is_not_lost_by_it() {
    let root = tempfile::tempdir().unwrap();
    let folder = RunFolder::open(root.path().join("walk"), Existing::Refuse).unwrap();
    assert!(folder.load().unwrap().is_none());
    (1..=3).for_each(|samples| folder.save(&checkpoint(samples)).unwrap());
    assert_eq!(samples(&folder), 3);
    let newest = folder.path().join(CHECKPOINT);
    let whole = std::fs::read(&newest).unwrap();
    for len in [0, 7, 100, whole.len() - 1] {
        std::fs::write(&newest, &whole[..len]).unwrap();
        let loaded = folder.load().unwrap().unwrap();
        assert!(loaded.torn.is_some() && loaded.checkpoint.progress.samples == 2, "{len} bytes");
        assert!(!newest.exists(), "the torn file is set aside");
    }
    folder.save(&checkpoint(4)).unwrap();
    assert_eq!(samples(&folder), 4);
    assert_eq!(Checkpoint::load(&folder.path().join(PREVIOUS)).unwrap().progress.samples, 2);
}

#[test]
fn a_flipped_bit_is_a_torn_checkpoint() {
    let root = tempfile::tempdir().unwrap();
    let folder = RunFolder::open(root.path().join("walk"), Existing::Refuse).unwrap();
    (1..=2).for_each(|samples| folder.save(&checkpoint(samples)).unwrap());
    let newest = folder.path().join(CHECKPOINT);
    let mut bytes = std::fs::read(&newest).unwrap();
    let last = bytes.len() - 5;
    bytes[last] ^= 1;
    std::fs::write(&newest, bytes).unwrap();
    assert_eq!(samples(&folder), 1);
}

#[test]
fn an_existing_run_is_refused_unless_the_caller_says_what_to_do() {
    let root = tempfile::tempdir().unwrap();
    let open = |existing| RunFolder::open(root.path().join("walk"), existing);
    open(Existing::Refuse).unwrap().save(&checkpoint(5)).unwrap();
    let refused = open(Existing::Refuse).unwrap_err();
    assert!(matches!(refused, RunError::Exists { .. }), "{refused}");
    assert!(refused.to_string().contains("--resume") && refused.to_string().contains("--overwrite"));
    assert_eq!(samples(&open(Existing::Resume).unwrap()), 5);
    let overwritten = open(Existing::Overwrite).unwrap();
    assert_eq!(samples(&overwritten), 5, "nothing is deleted before the new run is ready");
    overwritten.clear().unwrap();
    assert!(overwritten.load().unwrap().is_none());
    assert!(!holds_a_run(&root.path().join("walk")));
}

#[test]
fn two_trainers_do_not_share_a_folder_and_leftovers_go() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("walk");
    std::fs::create_dir(&path).unwrap();
    std::fs::write(path.join("checkpoint.partial"), "x").unwrap();
    let held = RunFolder::open(path.clone(), Existing::Resume).unwrap();
    assert!(!path.join("checkpoint.partial").exists());
    for existing in [Existing::Refuse, Existing::Resume, Existing::Overwrite] {
        let refused = RunFolder::open(path.clone(), existing).unwrap_err();
        assert!(matches!(refused, RunError::Locked { .. }), "{refused}");
    }
    drop(held);
    assert!(RunFolder::open(path, Existing::Resume).is_ok());
}
