//! The committed header is what cbindgen makes of the source.
//!
//! `POLICY_SPACE_WRITE_HEADER=1 cargo test -p policy-capi --test header` writes it.

use std::path::Path;

fn generated(folder: &Path) -> String {
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let builder = cbindgen::Builder::new().with_config(config).with_src(folder.join("src/lib.rs"));
    let mut header = Vec::new();
    builder.generate().unwrap().write(&mut header);
    String::from_utf8(header).unwrap()
}

#[test]
fn the_header_is_up_to_date() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (path, generated) = (folder.join("include/policy_space.h"), generated(folder));
    if std::env::var_os("POLICY_SPACE_WRITE_HEADER").is_some() {
        std::fs::write(&path, &generated).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == generated,
        "{} is not what cbindgen makes of the source; write it with\n    \
         POLICY_SPACE_WRITE_HEADER=1 cargo test -p policy-capi --test header",
        path.display()
    );
}

#[test]
fn the_header_declares_every_exported_function_once() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let header = generated(folder);
    let mut count = 0;
    for file in std::fs::read_dir(folder.join("src")).unwrap() {
        let source = std::fs::read_to_string(file.unwrap().path()).unwrap();
        for line in source.split("#[unsafe(no_mangle)]").skip(1) {
            let name = line.split_once("fn ").unwrap().1.split_once('(').unwrap().0;
            assert_eq!(header.matches(&format!("{name}(")).count(), 1, "{name}");
            count += 1;
        }
    }
    assert!(count > 30, "{count}");
}
