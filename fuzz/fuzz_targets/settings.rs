//! What the demo remembers, made of anything: refused, or a layout that panels can be moved in, or a best time, that is read
//! back as it was written.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use viewer::app::{PanelKind, PanelLayout};
use viewer::best_time::BestTime;

fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("best-playground.ron");
    if let Ok(best) = BestTime::from_bytes(path, bytes) {
        let again = BestTime::from_bytes(path, best.to_text().as_bytes());
        assert_eq!(again.expect("what was written can be read"), best);
    }
    let path = Path::new("layout.ron");
    let Ok(mut layout) = PanelLayout::from_bytes(path, bytes) else { return };
    layout.toggle(PanelKind::Paths);
    layout.swap_side(PanelKind::Graph);
    let written = layout.to_text().expect("a layout can be written");
    let again = PanelLayout::from_bytes(path, written.as_bytes()).expect("what was written can be read");
    assert_eq!(again.to_text().expect("a layout can be written"), written);
});
