//! A script of pad input made of anything: it is refused, or every state it gives is one that a pad could give.
#![no_main]

use gamepad::Script;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(script) = Script::from_ron(text) else { return };
    for time_secs in [-1.0, 0.0, 0.01, 1.0, script.duration() * 0.5, script.duration(), f64::NAN, f64::INFINITY] {
        let state = script.state_at(time_secs);
        let sticks = state.left_stick.into_iter().chain(state.right_stick);
        assert!(sticks.into_iter().all(|axis| (-1.0..=1.0).contains(&axis)));
        for trigger in [state.left_trigger, state.right_trigger] {
            assert!((0.0..=1.0).contains(&trigger));
        }
    }
});
