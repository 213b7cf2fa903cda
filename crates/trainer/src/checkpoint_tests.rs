use super::*;

fn checkpoint() -> Checkpoint {
    let mut rng = Rng::new(1, 1);
    let network = Network::new(&[3, 4, 2], 1.0, &mut rng);
    let adam = Adam { steps: 7, ..Adam::new(network.parameters.len()) };
    let networks = HashMap::from([("actor".to_owned(), Trained { network, adam })]);
    Checkpoint::new(networks, (1, 2, 3.0), 1e-4, rng)
}

#[test]
fn a_checkpoint_comes_back_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.safetensors");
    checkpoint().save(&path).unwrap();
    assert_eq!(Checkpoint::load(&path).unwrap(), checkpoint());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_slim_checkpoint_keeps_the_parameters_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.safetensors");
    let mut with_mean = checkpoint();
    let mean = Network::new(&[3, 4, 2], 1.0, &mut Rng::new(9, 9));
    let trained = Trained { network: mean.clone(), adam: Adam::new(26) };
    with_mean.networks.insert("average".into(), trained);
    with_mean.slim().save(&path).unwrap();
    let back = Checkpoint::load(&path).unwrap();
    assert_eq!(back.networks["actor"].network, mean);
    assert_eq!(back.networks["actor"].adam, Adam::new(26));
    assert_eq!(back.networks.len(), 1);
}

#[test]
fn a_cut_or_foreign_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.safetensors");
    checkpoint().save(&path).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for len in [0, 7, 100, whole.len() - 1] {
        std::fs::write(&path, &whole[..len]).unwrap();
        assert!(Checkpoint::load(&path).is_err(), "{len} bytes");
    }
    assert!(matches!(Checkpoint::load(&folder.path().join("b")), Err(CheckpointError::Io { .. })));
}
