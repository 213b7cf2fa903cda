//! Events on their way from the reader threads to the program. It may poll late or never, so the reports of a device are bounded.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};

use super::Timed;
use crate::device::{DeviceEvent, DeviceKey};

/// Most reports of one device that wait: two seconds of a pad that reports every millisecond.
const MOST_REPORTS: usize = 2048;

/// Events in the order in which they came; clones share them.
#[derive(Clone, Debug, Default)]
pub(super) struct Queue(Arc<Mutex<Waiting>>);

#[derive(Debug, Default)]
struct Waiting {
    events: VecDeque<Timed>,
    /// Input reports of each device among them.
    reports: BTreeMap<DeviceKey, usize>,
}

impl Queue {
    /// Appends an event. Where a device has too many reports its oldest one is dropped; other events are kept.
    pub(super) fn push(&self, event: Timed) {
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Waiting { events, reports } = &mut *waiting;
        if let DeviceEvent::Report(key, _) = event.1 {
            let count = reports.entry(key).or_default();
            if *count < MOST_REPORTS {
                *count += 1;
            } else {
                let is_its = |(_, event): &Timed| matches!(event, DeviceEvent::Report(of, _) if *of == key);
                if let Some(oldest) = events.iter().position(is_its) {
                    events.remove(oldest);
                }
            }
        }
        events.push_back(event);
    }

    /// Moves all events to `out`.
    pub(super) fn drain_into(&self, out: &mut Vec<Timed>) {
        let mut waiting = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        out.extend(waiting.events.drain(..));
        waiting.reports.clear();
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    #[test]
    fn a_program_that_does_not_poll_keeps_the_newest_reports_and_every_other_event() {
        let (queue, now) = (Queue::default(), Instant::now());
        let [fast, slow] = [1, 2].map(DeviceKey);
        let report = |key, number: usize| DeviceEvent::Report(key, number.to_le_bytes().into());
        queue.push((now, report(slow, 7)));
        for number in 0..3 * MOST_REPORTS {
            queue.push((now, report(fast, number)));
            if number % MOST_REPORTS == 9 {
                queue.push((now, DeviceEvent::Disconnected(slow)));
            }
        }
        let mut found = Vec::new();
        queue.drain_into(&mut found);
        let of = |wanted: DeviceKey| {
            found
                .iter()
                .filter(move |(_, event)| matches!(event, DeviceEvent::Report(key, _) if *key == wanted))
        };
        assert_eq!((of(fast).count(), of(slow).count(), found.len()), (MOST_REPORTS, 1, MOST_REPORTS + 4));
        assert_eq!(of(fast).next().map(|(_, event)| event), Some(&report(fast, 2 * MOST_REPORTS)));
        assert_eq!(of(fast).next_back().map(|(_, event)| event), Some(&report(fast, 3 * MOST_REPORTS - 1)));
        found.clear();
        queue.push((now, report(fast, 1)));
        queue.drain_into(&mut found);
        assert_eq!(found.len(), 1, "what was taken counts no more");
    }
}
