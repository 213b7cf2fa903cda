//! The udev rules that let a local user read pads on Linux, as text to install.
//!
//! `TAG+="uaccess"` gives the local user access to the device; the file must sort before `73-seat-late.rules`.

use std::fmt::Write as _;

use crate::pads::{KNOWN, PadId};

/// File that the rules are installed to.
pub const RULES_PATH: &str = "/etc/udev/rules.d/70-policy-space-pads.rules";

/// The rules for one kind of pad, over USB and over Bluetooth.
#[must_use]
pub fn rules_for(id: PadId) -> String {
    let (vendor, product) = (id.vendor, id.product);
    format!(
        "KERNEL==\"hidraw*\", ATTRS{{idVendor}}==\"{vendor:04x}\", ATTRS{{idProduct}}==\"{product:04x}\", \
         TAG+=\"uaccess\"\n\
         KERNEL==\"hidraw*\", KERNELS==\"*:{vendor:04X}:{product:04X}.*\", TAG+=\"uaccess\"\n"
    )
}

/// The rules for every known pad: the whole file.
#[must_use]
pub fn rules() -> String {
    let mut text = String::from("# Gamepads for the local user.\n");
    for &(vendor, product, _, _, name) in KNOWN {
        let id = PadId { vendor, product, bus: crate::Bus::Usb };
        // Writing to a string does not fail.
        let _ = write!(text, "\n# {name}\n{}", rules_for(id));
    }
    text
}

/// Shell commands that install the rules for one kind of pad and reload them.
#[must_use]
pub fn install_commands(id: PadId) -> String {
    format!(
        "sudo tee -a {RULES_PATH} <<'RULES'\n{}RULES\nsudo udevadm control --reload && sudo udevadm trigger --subsystem-match=hidraw\n",
        rules_for(id)
    )
}
