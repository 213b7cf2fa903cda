//! One channel of a script over time: analog values interpolated linearly, buttons in edges.

use crate::{Button, Buttons};

/// One analog channel: from each key on it moves from its present value to the key's value.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Track(Vec<Key>);

#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    at_secs: f64,
    ramp_secs: f64,
    from: f32,
    to: f32,
}

impl Key {
    fn value_at(&self, time_secs: f64) -> f32 {
        let elapsed = time_secs - self.at_secs;
        if elapsed >= self.ramp_secs {
            return self.to;
        }
        let t = (elapsed / self.ramp_secs) as f32;
        (1.0 - t) * self.from + t * self.to
    }
}

impl Track {
    /// Appends a key; times are ascending (checked by the parser).
    pub(super) fn push(&mut self, at_secs: f64, ramp_secs: f64, to: f32) {
        let from = self.value_at(at_secs);
        self.0.push(Key { at_secs, ramp_secs, from, to });
    }

    /// Zero before the first key.
    pub(super) fn value_at(&self, time_secs: f64) -> f32 {
        let after = self.0.partition_point(|key| key.at_secs <= time_secs);
        after.checked_sub(1).map_or(0.0, |i| self.0[i].value_at(time_secs))
    }
}

/// All buttons: the set held from each edge on.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ButtonTrack {
    edges: Vec<(f64, Button, bool)>,
    /// Releases of taps that the next edge of their button may still replace, one for each button.
    pending: Vec<(f64, Button)>,
    held: Vec<(f64, Buttons)>,
}

impl ButtonTrack {
    /// Appends an edge; times are ascending (checked by the parser). A tap of the button that has not ended yet ends in this edge.
    pub(super) fn push(&mut self, at_secs: f64, button: Button, pressed: bool) {
        if let Some(tap) = self.pending.iter().position(|(_, tapped)| *tapped == button) {
            let (release_secs, _) = self.pending.swap_remove(tap);
            if release_secs <= at_secs {
                self.edges.push((release_secs, button, false));
            }
        }
        self.edges.push((at_secs, button, pressed));
    }

    /// Appends a press and the release after it, at `release_secs`.
    pub(super) fn push_tap(&mut self, at_secs: f64, release_secs: f64, button: Button) {
        self.push(at_secs, button, true);
        self.pending.push((release_secs, button));
    }

    /// Sorts the edges (taps release out of order) and accumulates them. Edges at one time keep their order.
    pub(super) fn finish(&mut self) {
        let mut edges = std::mem::take(&mut self.edges);
        edges.extend(self.pending.drain(..).map(|(release_secs, button)| (release_secs, button, false)));
        edges.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut held = Buttons::NONE;
        for (at_secs, button, pressed) in edges {
            held.set(button, pressed);
            self.held.push((at_secs, held));
        }
    }

    pub(super) fn value_at(&self, time_secs: f64) -> Buttons {
        let after = self.held.partition_point(|(at_secs, _)| *at_secs <= time_secs);
        after.checked_sub(1).map_or(Buttons::NONE, |i| self.held[i].1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_cut_short_goes_on_from_where_it_was() {
        let mut track = Track::default();
        track.push(1.0, 2.0, 1.0);
        track.push(2.0, 1.0, 0.0);
        assert_eq!(track.value_at(0.999), 0.0);
        assert_eq!(track.value_at(1.5), 0.25);
        assert_eq!(track.value_at(2.0), 0.5);
        assert_eq!(track.value_at(2.5), 0.25);
        assert_eq!(track.value_at(3.0), 0.0);
    }

    #[test]
    fn edges_are_summed_in_order_of_time() {
        let mut track = ButtonTrack::default();
        track.push(1.0, Button::South, true);
        track.push(3.0, Button::South, false);
        track.push(2.0, Button::East, true);
        track.finish();
        assert_eq!(track.value_at(0.9), Buttons::NONE);
        assert_eq!(track.value_at(1.0), Buttons::NONE.with(Button::South));
        assert_eq!(track.value_at(2.0), Buttons::NONE.with(Button::South).with(Button::East));
        assert_eq!(track.value_at(3.0), Buttons::NONE.with(Button::East));
    }
}
