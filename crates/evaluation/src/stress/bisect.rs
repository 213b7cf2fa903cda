//! The largest number that passes a test, by halving.

/// The largest number from 0 to `most`, within `step`, that passes; numbers that pass are taken to lie below those that do not.
/// Returns 0 when 0 itself does not pass, and `most` when everything does.
pub fn largest(most: f32, step: f32, mut passes: impl FnMut(f32) -> bool) -> f32 {
    if !passes(0.0) {
        return 0.0;
    }
    if passes(most) {
        return most;
    }
    let (mut low, mut high) = (0.0, most);
    while high - low > step {
        let middle = 0.5 * (low + high);
        if passes(middle) { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_threshold_is_found_to_within_a_step() {
        for threshold in [0.0, 3.0, 77.7, 512.0, 999.0] {
            let found = largest(1000.0, 10.0, |force| force <= threshold);
            assert!((threshold - 10.0..=threshold).contains(&found), "{found} for {threshold}");
        }
    }

    #[test]
    fn all_and_nothing() {
        assert_eq!(largest(1000.0, 10.0, |_| true), 1000.0);
        assert_eq!(largest(1000.0, 10.0, |_| false), 0.0);
    }

    #[test]
    fn it_tries_no_more_than_it_must() {
        let mut tries = 0;
        largest(1000.0, 10.0, |force| {
            tries += 1;
            force < 123.0
        });
        assert_eq!(tries, 9);
    }
}
