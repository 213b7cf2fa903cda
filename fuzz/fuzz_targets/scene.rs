//! A scene made of anything: refused, or one whose numbers lie in their ranges.
#![no_main]

use libfuzzer_sys::fuzz_target;
use playground::Playground;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(scene) = Playground::from_ron(text) else { return };
    let [least, most] = scene.area;
    assert!(least.is_finite() && most.is_finite() && least.cmplt(most).all(), "area {least} {most}");
    assert!(!scene.starts.is_empty() && scene.checkpoints.len() >= 2);
    for start in &scene.starts {
        assert!(start.at.cmpge(least).all() && start.at.cmple(most).all() && start.heading.is_finite());
    }
    for checkpoint in &scene.checkpoints {
        assert!(checkpoint.radius.is_finite() && checkpoint.at.is_finite());
    }
});
