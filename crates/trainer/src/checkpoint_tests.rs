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
    with_mean.networks.insert("ema".into(), trained);
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

/// A file with this metadata, in the layout of version 1, and one tensor of four numbers.
fn with_metadata(folder: &Path, sizes: &str, role: &str) -> PathBuf {
    let data = bytes(&[1.0, 2.0, 3.0, 4.0]);
    let view = TensorView::new(Dtype::F32, vec![4], &data).unwrap();
    let progress = format!(
        r#"{{"format":1,"seed":1,"samples":2,"secs":3.0,"actor_rate":0.1,"rng":{{"state":1,"stream":1}},"sizes":{sizes}}}"#
    );
    let meta = [("progress".to_owned(), progress)].into_iter().collect();
    let written = safetensors::serialize([(format!("{role}.parameters"), view)], Some(meta)).unwrap();
    let path = folder.join("a.safetensors");
    std::fs::write(&path, written).unwrap();
    path
}

#[test]
fn version_1_loads_with_the_roles_of_today() {
    let folder = tempfile::tempdir().unwrap();
    let path = with_metadata(folder.path(), r#"{"walk.average":[[3,1],0]}"#, "walk.average");
    let loaded = Checkpoint::load(&path).unwrap();
    assert_eq!(loaded.networks["walk.ema"].network.parameters, [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(loaded.progress.learning_rate, 0.1);
}

#[test]
fn sizes_are_compared_with_the_tensors_before_anything_is_allocated() {
    let folder = tempfile::tempdir().unwrap();
    // 20 GB and far beyond: allocating this would end the process.
    for sizes in [
        "[16384,16384,16384]",
        "[1,16384,16384,16384,16384,16384,1]",
        "[18446744073709551615,2]",
        "[3]",
        "[]",
    ] {
        let path = with_metadata(folder.path(), &format!(r#"{{"actor":[{sizes},0]}}"#), "actor");
        let error = Checkpoint::load(&path).unwrap_err();
        assert!(matches!(error, CheckpointError::Content { .. }), "{sizes}: {error}");
    }
    let many: Vec<String> = (0..300).map(|i| format!(r#""a{i}":[[3,1],0]"#)).collect();
    let path = with_metadata(folder.path(), &format!("{{{}}}", many.join(",")), "actor");
    assert!(Checkpoint::load(&path).unwrap_err().to_string().contains("256 networks"));
}

#[test]
fn a_flipped_bit_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.safetensors");
    checkpoint().save(&path).unwrap();
    let mut data = std::fs::read(&path).unwrap();
    let last = data.len() - 1;
    data[last] ^= 1;
    std::fs::write(&path, data).unwrap();
    assert!(Checkpoint::load(&path).unwrap_err().to_string().contains("written bytes"));
}

#[test]
fn a_slim_checkpoint_holds_discriminators_in_half_precision() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.safetensors");
    let mut with_discriminator = checkpoint();
    let network = Network::new(&[40, 30, 1], 1.0, &mut Rng::new(9, 9));
    let count = network.parameters.len();
    let trained = Trained { network: network.clone(), adam: Adam::new(count) };
    with_discriminator.networks.insert("walk.discriminator".into(), trained);
    let with_discriminator = Checkpoint::new(with_discriminator.networks, (1, 2, 3.0), 1e-4, Rng::new(1, 1));
    let [whole, slim] = [with_discriminator.clone(), with_discriminator.slim()].map(|checkpoint| {
        checkpoint.save(&path).unwrap();
        (std::fs::metadata(&path).unwrap().len(), Checkpoint::load(&path).unwrap())
    });
    assert_eq!(whole.1.networks["walk.discriminator"].network, network);
    let halved = &slim.1.networks["walk.discriminator"].network;
    let worst =
        halved.parameters.iter().zip(&network.parameters).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(worst > 0.0 && worst < 1e-3, "{worst}");
    assert!(slim.0 + 2 * (count as u64) < whole.0, "{} after {}", slim.0, whole.0);
}

#[test]
fn the_kept_checkpoints_load() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/checkpoints");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.file_stem().is_some_and(|name| name != "normaliser") {
            let checkpoint = Checkpoint::load(&path).unwrap();
            assert!(checkpoint.networks.keys().any(|role| role.ends_with(ACTOR)), "{}", path.display());
            count += 1;
        }
    }
    assert!(count > 0);
}

#[test]
fn a_header_that_would_fill_the_memory_is_refused_unread() {
    let path = Path::new("a.safetensors");
    let length = 5 << 20;
    let mut file = (length as u64).to_le_bytes().to_vec();
    file.resize(8 + length, b'[');
    let error = Checkpoint::from_bytes(path, &file).unwrap_err().to_string();
    assert!(error.contains("a header of at most"), "{error}");
}

#[test]
fn networks_that_would_fill_the_memory_are_neither_written_nor_read() {
    let side = 1 + MOST_PARAMETERS / 10_001;
    let network = Network::zeros(&[10_000, side]);
    let adam = Adam { mean: Vec::new(), square: Vec::new(), steps: 0 };
    let found = network.parameters.len().to_string();
    let networks = [(ACTOR.to_owned(), Trained { network, adam })].into_iter().collect();
    let checkpoint = Checkpoint::new(networks, (1, 0, 0.0), 1e-4, Rng::new(1, 1));
    let error = checkpoint.to_bytes().unwrap_err().to_string();
    assert!(error.contains("expected at most 20000000 parameters") && error.contains(&found), "{error}");

    // The sizes alone are enough: no tensor is looked at.
    let progress = serde_json::to_string(&checkpoint.progress).unwrap();
    let meta = [("progress".to_owned(), progress)].into_iter().collect();
    let none: [(&str, TensorView<'_>); 0] = [];
    let file = safetensors::serialize(none, Some(meta)).unwrap();
    let error = Checkpoint::from_bytes(Path::new("a.safetensors"), &file).unwrap_err().to_string();
    assert!(error.contains("expected at most 20000000 parameters") && error.contains(&found), "{error}");
}
