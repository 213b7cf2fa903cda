//! The thread of one open device: start-up requests, then input and output reports until it disconnects.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use hidapi::HidDevice;

use super::Outputs;
use super::queue::Queue;
use crate::descriptor::MAX_DESCRIPTOR_BYTES;
use crate::device::{DeviceEvent, DeviceInfo};
use crate::pads::{Model, Request};

/// How long a read waits. An output report may be this late.
const READ_MILLISECONDS: i32 = 8;
/// Time between two start-up requests: some pads lose requests that arrive faster.
const REQUEST_INTERVAL: Duration = Duration::from_millis(40);
/// Longest report read.
const REPORT_BYTES: usize = 1024;

pub(super) struct Reader {
    opened: HidDevice,
    device: DeviceInfo,
    events: Queue,
    outputs: Outputs,
    stop: Arc<AtomicBool>,
}

impl Reader {
    pub(super) fn new(
        opened: HidDevice,
        device: DeviceInfo,
        events: Queue,
        outputs: Outputs,
        stop: Arc<AtomicBool>,
    ) -> Self {
        Self { opened, device, events, outputs, stop }
    }

    pub(super) fn run(self) {
        let key = self.device.key;
        let (sender, output) = channel();
        self.outputs.lock().unwrap_or_else(PoisonError::into_inner).insert(key, sender);
        let mut descriptor = vec![0; MAX_DESCRIPTOR_BYTES];
        let len = self.opened.get_report_descriptor(&mut descriptor).unwrap_or(0);
        descriptor.truncate(len);
        self.tell(DeviceEvent::Connected { device: self.device.clone(), descriptor: Some(descriptor) });
        self.read(&output);
        self.outputs.lock().unwrap_or_else(PoisonError::into_inner).remove(&key);
        self.tell(DeviceEvent::Disconnected(key));
    }

    /// Reads until the device disconnects or the back end stops.
    fn read(&self, output: &Receiver<Box<[u8]>>) {
        let id = self.device.id;
        let mut requests: VecDeque<Request> =
            Model::of(id).map(|model| model.start_up(id.bus)).unwrap_or_default().into();
        let mut last_request = None;
        let mut buffer = [0; REPORT_BYTES];
        while !self.stop.load(Ordering::Relaxed) {
            let due = last_request.is_none_or(|sent: Instant| sent.elapsed() >= REQUEST_INTERVAL);
            if due && let Some(request) = requests.pop_front() {
                self.request(&request);
                last_request = Some(Instant::now());
            }
            // Only the newest output is sent.
            if let Some(report) = output.try_iter().last() {
                // The next read detects a disconnect. A pad without output remains usable.
                let _ = self.opened.write(&report);
            }
            match self.opened.read_timeout(&mut buffer, READ_MILLISECONDS) {
                Ok(0) => {}
                Ok(len) => self.tell(DeviceEvent::Report(self.device.key, buffer[..len].into())),
                Err(_) => return,
            }
        }
    }

    fn request(&self, request: &Request) {
        match request {
            Request::Output(report) => {
                let _ = self.opened.write(report);
            }
            Request::Feature { id, len } => {
                let mut report = vec![0; *len];
                report[0] = *id;
                if let Ok(len) = self.opened.get_feature_report(&mut report) {
                    report.truncate(len);
                    self.tell(DeviceEvent::Feature(self.device.key, report.into()));
                }
            }
        }
    }

    fn tell(&self, event: DeviceEvent) {
        self.events.push((Instant::now(), event));
    }
}
