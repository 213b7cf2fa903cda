//! Medians and quantiles of trials, some of which never came to an end.

/// The smallest value that at least `share` of the trials reach, in (0, 1]; `None`, a trial that never came to an end, counts as
/// longer than any other. `None` when a share of `1 - share` of the trials or more never came to an end, or when there are none.
#[must_use]
pub fn quantile(values: impl IntoIterator<Item = Option<f32>>, share: f32) -> Option<f32> {
    let mut values: Vec<f32> = values.into_iter().map(|value| value.unwrap_or(f32::INFINITY)).collect();
    values.sort_by(f32::total_cmp);
    let reached = share * values.len() as f32;
    let ended = values.iter().filter(|value| value.is_finite()).count();
    let rank = (reached - 1e-4).ceil().max(1.0) as usize;
    let all = ended == values.len();
    values.get(rank - 1).copied().filter(|_| all || ended as f32 > reached + 1e-4)
}

/// The value that half of the trials reach; see [`quantile`].
#[must_use]
pub fn median(values: impl IntoIterator<Item = Option<f32>>) -> Option<f32> {
    quantile(values, 0.5)
}

/// Mean, or `None` of nothing.
#[must_use]
pub fn mean(values: impl IntoIterator<Item = f32>) -> Option<f32> {
    let (sum, count) = values.into_iter().fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trials_that_never_end_are_the_longest() {
        let trials = [Some(3.0), None, Some(1.0), Some(2.0), None];
        assert_eq!(median(trials), Some(3.0));
        assert_eq!(quantile(trials, 0.9), None);
        assert_eq!(median([None, None, Some(1.0)]), None);
        // Half never end; one more that does, and the median is of those that end.
        assert_eq!(median([Some(1.0), Some(2.0), None, None]), None);
        assert_eq!(median([Some(1.0), Some(2.0), Some(3.0), None, None]), Some(3.0));
        let tenth_never = |never: usize| (0..40).map(move |i| (i >= never).then_some(i as f32));
        assert_eq!(quantile(tenth_never(4), 0.9), None);
        assert_eq!(quantile(tenth_never(3), 0.9), Some(38.0));
        assert_eq!(median([]), None);
    }

    #[test]
    fn the_ninth_of_ten_is_the_90_percent_quantile() {
        let trials = (1..=10).map(|i| Some(i as f32));
        assert_eq!(quantile(trials.clone(), 0.9), Some(9.0));
        assert_eq!(quantile(trials, 1.0), Some(10.0));
        assert_eq!(mean([1.0, 2.0, 6.0]), Some(3.0));
        assert_eq!(mean([]), None);
    }
}
