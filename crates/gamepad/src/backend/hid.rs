//! Pads through hidapi. One thread searches for devices once a second; each open device has a reader thread.

mod queue;
mod reader;

use std::collections::{BTreeMap, HashSet};
use std::ffi::CString;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use hidapi::{BusType, HidApi};

use queue::Queue;

use super::{BackendError, PadBackend, new_key};
use crate::device::{DeviceEvent, DeviceInfo, DeviceKey, Problem, Source};
use crate::pads::{Bus, Model, PadId};

const SCAN_INTERVAL: Duration = Duration::from_secs(1);
const STOP_INTERVAL: Duration = Duration::from_millis(20);

type Timed = (Instant, DeviceEvent);
/// Channels for the output reports of open devices.
type Outputs = Arc<Mutex<BTreeMap<DeviceKey, Sender<Box<[u8]>>>>>;

/// Reads pads through hidapi until dropped.
#[derive(Debug)]
pub struct HidBackend {
    events: Queue,
    outputs: Outputs,
    stop: Arc<AtomicBool>,
    scanner: Option<JoinHandle<()>>,
}

impl HidBackend {
    /// Starts the search for pads.
    ///
    /// # Errors
    /// [`BackendError`] when hidapi or the thread can't start.
    pub fn start() -> Result<Self, BackendError> {
        let api = HidApi::new().map_err(|error| BackendError::Hid { message: error.to_string() })?;
        let events = Queue::default();
        let outputs = Outputs::default();
        let stop = Arc::new(AtomicBool::new(false));
        let mut scanner = Scanner {
            api,
            events: events.clone(),
            outputs: Arc::clone(&outputs),
            stop: Arc::clone(&stop),
            open: BTreeMap::new(),
        };
        let thread = std::thread::Builder::new().name("pad-scanner".into()).spawn(move || scanner.run())?;
        Ok(Self { events, outputs, stop, scanner: Some(thread) })
    }
}

impl PadBackend for HidBackend {
    fn poll_into(&mut self, events: &mut Vec<Timed>) {
        self.events.drain_into(events);
    }

    fn send(&mut self, key: DeviceKey, report: &[u8]) -> bool {
        let outputs = self.outputs.lock().unwrap_or_else(PoisonError::into_inner);
        outputs.get(&key).is_some_and(|output| output.send(report.into()).is_ok())
    }
}

impl Drop for HidBackend {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(scanner) = self.scanner.take() {
            // A panic there was printed already; nothing remains to be undone.
            let _ = scanner.join();
        }
    }
}

/// A connected device: being read, or not readable.
enum Known {
    Read(JoinHandle<()>),
    Unusable(DeviceKey),
}

struct Scanner {
    api: HidApi,
    events: Queue,
    outputs: Outputs,
    stop: Arc<AtomicBool>,
    open: BTreeMap<CString, Known>,
}

impl Scanner {
    fn run(&mut self) {
        while !self.stop.load(Ordering::Relaxed) {
            self.scan();
            let next = Instant::now() + SCAN_INTERVAL;
            while Instant::now() < next && !self.stop.load(Ordering::Relaxed) {
                std::thread::sleep(STOP_INTERVAL);
            }
        }
        for known in std::mem::take(&mut self.open).into_values() {
            if let Known::Read(reader) = known {
                let _ = reader.join();
            }
        }
    }

    fn scan(&mut self) {
        // A failed search finds no device and closes none: readers detect a disconnect by themselves.
        if self.api.refresh_devices().is_err() {
            return;
        }
        let found: Vec<(CString, DeviceInfo)> = {
            let mut seen = HashSet::new();
            let pads = self.api.device_list().filter(|device| is_pad(device));
            pads.filter(|device| seen.insert(device.path().to_owned())).map(described).collect()
        };
        self.forget(&found.iter().map(|(path, _)| path).collect());
        for (path, device) in found {
            self.open(path, device);
        }
    }

    /// Drops unplugged devices and finished readers, so that a device is opened again when it returns.
    fn forget(&mut self, present: &HashSet<&CString>) {
        let events = &self.events;
        self.open.retain(|path, known| match known {
            Known::Read(reader) => !reader.is_finished(),
            Known::Unusable(key) => {
                let stays = present.contains(path);
                if !stays {
                    events.push((Instant::now(), DeviceEvent::Disconnected(*key)));
                }
                stays
            }
        });
    }

    fn open(&mut self, path: CString, device: DeviceInfo) {
        let before = match self.open.get(&path) {
            Some(Known::Read(_)) => return,
            Some(Known::Unusable(key)) => Some(*key),
            None => None,
        };
        let known = match self.api.open_path(&path) {
            Ok(opened) => {
                if let Some(key) = before {
                    self.events.push((Instant::now(), DeviceEvent::Disconnected(key)));
                }
                let reader = reader::Reader::new(
                    opened,
                    device,
                    self.events.clone(),
                    Arc::clone(&self.outputs),
                    Arc::clone(&self.stop),
                );
                match std::thread::Builder::new().name("pad-reader".into()).spawn(move || reader.run()) {
                    Ok(thread) => Known::Read(thread),
                    Err(_) => return,
                }
            }
            Err(_) if before.is_some() => return,
            Err(error) => {
                let key = device.key;
                let problem = open_problem(&device, &error);
                self.events.push((Instant::now(), DeviceEvent::Unusable { device, problem }));
                Known::Unusable(key)
            }
        };
        self.open.insert(path, known);
    }
}

/// True for a known pad, and for any device that declares itself a joystick, game pad or multi-axis controller.
fn is_pad(device: &hidapi::DeviceInfo) -> bool {
    let usage = (device.usage_page(), device.usage());
    let says_pad = matches!(usage, (0x01, 0x04 | 0x05 | 0x08));
    says_pad || usage == (0, 0) && Model::of(id_of(device)).is_some()
}

fn id_of(device: &hidapi::DeviceInfo) -> PadId {
    let bus = match device.bus_type() {
        BusType::Usb => Bus::Usb,
        BusType::Bluetooth => Bus::Bluetooth,
        _ => Bus::Other,
    };
    PadId { vendor: device.vendor_id(), product: device.product_id(), bus }
}

fn described(device: &hidapi::DeviceInfo) -> (CString, DeviceInfo) {
    let id = id_of(device);
    let name = device.product_string().filter(|name| !name.is_empty());
    let info = DeviceInfo {
        key: new_key(),
        name: name.map_or_else(|| format!("pad {:04x}:{:04x}", id.vendor, id.product), str::to_owned),
        id,
        serial: device.serial_number().filter(|serial| !serial.is_empty()).map(str::to_owned),
        path: device.path().to_string_lossy().into_owned(),
        source: Source::Hid,
    };
    (device.path().to_owned(), info)
}

/// hidapi returns text only, so the file is opened again to detect missing permission.
fn open_problem(device: &DeviceInfo, error: &hidapi::HidError) -> Problem {
    let denied = cfg!(target_os = "linux")
        && std::fs::OpenOptions::new()
            .read(true)
            .write(true)
            .open(&device.path)
            .is_err_and(|error| error.kind() == std::io::ErrorKind::PermissionDenied);
    let path = device.path.clone();
    if denied {
        Problem::Permission { path, id: device.id }
    } else {
        Problem::Open { path, message: error.to_string() }
    }
}
