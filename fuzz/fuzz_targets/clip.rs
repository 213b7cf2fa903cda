//! A clip made of anything, in each of the three formats: refused, or one that can be sampled anywhere.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use clips::from_bytes;

fuzz_target!(|bytes: &[u8]| {
    for file in ["fuzz.json", "fuzz.txt", "fuzz.npy"] {
        let Ok(clip) = from_bytes(Path::new(file), bytes) else { continue };
        for time in [-1.0, 0.0, clip.duration() * 0.5, clip.duration(), f32::INFINITY] {
            let (position, rotations) = clip.sample(time);
            assert!(position.is_finite() && rotations.len() == clip.bodies.len());
        }
        assert_eq!(clip.mirrored().times.len(), clip.times.len());
    }
});
