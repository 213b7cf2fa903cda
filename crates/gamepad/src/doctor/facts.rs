//! Facts about pads from the system itself, independent of the back ends.

use std::path::Path;

/// What is known about the system.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SystemFacts {
    /// The system is Linux. The facts below apply to Linux only.
    pub is_linux: bool,
    /// This build has the hidapi back end.
    pub has_hidapi: bool,
    /// This build has the gilrs back end.
    pub has_gilrs: bool,
    /// Why back ends did not start.
    pub backend_errors: Vec<String>,
    /// Number of HID devices, readable or not.
    pub hidraw_nodes: usize,
    /// Pads that the kernel's own drivers provide.
    pub event_pads: Vec<EventPad>,
}

/// A pad in `/proc/bus/input/devices`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EventPad {
    /// Its name.
    pub name: String,
    /// USB vendor id.
    pub vendor: u16,
    /// USB product id.
    pub product: u16,
    /// Its event file under `/dev/input`.
    pub handler: String,
}

impl SystemFacts {
    /// Facts about this system.
    #[must_use]
    pub fn of_this_system(backend_errors: Vec<String>) -> Self {
        let nodes = std::fs::read_dir("/sys/class/hidraw").map_or(0, Iterator::count);
        let devices = std::fs::read(Path::new("/proc/bus/input/devices")).unwrap_or_default();
        Self {
            is_linux: cfg!(target_os = "linux"),
            has_hidapi: cfg!(feature = "hidapi"),
            has_gilrs: cfg!(feature = "gilrs"),
            backend_errors,
            hidraw_nodes: nodes,
            event_pads: EventPad::list(&String::from_utf8_lossy(&devices)),
        }
    }

    pub(super) fn backends(&self) -> &'static str {
        match (self.has_hidapi, self.has_gilrs) {
            (true, true) => "hidapi, gilrs",
            (true, false) => "hidapi (gilrs: not in this build)",
            (false, true) => "gilrs (hidapi: not in this build)",
            (false, false) => "none in this build: build with `--features hidapi`",
        }
    }
}

impl EventPad {
    /// The pads in the text of `/proc/bus/input/devices`: all blocks with a joystick handler.
    #[must_use]
    pub fn list(devices: &str) -> Vec<Self> {
        devices.split("\n\n").filter_map(Self::of_block).collect()
    }

    fn of_block(block: &str) -> Option<Self> {
        let line = |start: &str| block.lines().find_map(|line| line.strip_prefix(start));
        let handlers = line("H: Handlers=")?;
        let is_joystick =
            |name: &str| name.strip_prefix("js").is_some_and(|rest| rest.parse::<u32>().is_ok());
        if !handlers.split_whitespace().any(is_joystick) {
            return None;
        }
        let ids = line("I: ")?;
        let number = |name: &str| {
            let value = ids.split_whitespace().find_map(|word| word.strip_prefix(name))?;
            u16::from_str_radix(value, 16).ok()
        };
        Some(Self {
            name: line("N: Name=").unwrap_or_default().trim_matches('"').to_owned(),
            vendor: number("Vendor=")?,
            product: number("Product=")?,
            handler: handlers.split_whitespace().find(|name| name.starts_with("event"))?.to_owned(),
        })
    }
}
