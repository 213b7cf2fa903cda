//! Which pads are known, by vendor and product, and one parser for each.
//!
//! Pure: bytes in, [`PadInput`] out. Source of the numbers: Linux `drivers/hid/hid-ids.h`, SDL
//! `src/joystick/usb_ids.h`.

mod bytes;
mod dualsense;
mod dualshock4;
mod eightbitdo;
mod generic;
mod output;
mod sony;
mod start_up;
mod switch_pro;
mod xbox;

pub use dualsense::DualSense;
pub use dualshock4::DualShock4;
pub use eightbitdo::EightBitDo;
pub use generic::{ButtonOrder, GenericPad, NoGamepad};
pub use output::{MAX_OUTPUT_LEN, OutputEncoder, PadOutput};
pub use sony::MotionScale;
pub use start_up::Request;
pub use switch_pro::SwitchPro;
pub use xbox::XboxWireless;

use crate::{PadInput, ReportError, Update};

/// How a pad is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Bus {
    /// A cable, or a USB receiver.
    Usb,
    /// Bluetooth, classic or low energy.
    Bluetooth,
    /// Anything else, or not known.
    Other,
}

/// What identifies a kind of pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PadId {
    /// USB vendor id.
    pub vendor: u16,
    /// USB product id.
    pub product: u16,
    /// How it is connected.
    pub bus: Bus,
}

/// A kind of pad whose reports are known without their descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Model {
    /// Sony DualShock 4.
    DualShock4,
    /// Sony's USB wireless adaptor for the DualShock 4.
    DualShock4Receiver,
    /// Sony DualSense and DualSense Edge.
    DualSense,
    /// Nintendo Switch Pro.
    SwitchPro,
    /// Xbox One S, Elite 2 and the like over Bluetooth.
    XboxWireless,
    /// Xbox Series over Bluetooth: has a share button.
    XboxSeries,
    /// 8BitDo in an HID mode, face buttons as on Nintendo's pads.
    EightBitDo,
    /// 8BitDo in an HID mode, face buttons as on Xbox pads.
    EightBitDoUltimate,
}

/// One line for each known product: vendor, product, bus it is known on (`None`: any), model, name.
pub(crate) const KNOWN: &[(u16, u16, Option<Bus>, Model, &str)] = &[
    (0x054c, 0x05c4, None, Model::DualShock4, "DualShock 4"),
    (0x054c, 0x09cc, None, Model::DualShock4, "DualShock 4 (second version)"),
    (0x054c, 0x0ba0, Some(Bus::Usb), Model::DualShock4Receiver, "DualShock 4 USB wireless adaptor"),
    (0x054c, 0x0ce6, None, Model::DualSense, "DualSense"),
    (0x054c, 0x0df2, None, Model::DualSense, "DualSense Edge"),
    (0x057e, 0x2009, None, Model::SwitchPro, "Switch Pro"),
    (0x045e, 0x02e0, Some(Bus::Bluetooth), Model::XboxWireless, "Xbox One S"),
    (0x045e, 0x02fd, Some(Bus::Bluetooth), Model::XboxWireless, "Xbox One S (new firmware)"),
    (0x045e, 0x0b20, Some(Bus::Bluetooth), Model::XboxWireless, "Xbox One S (low energy)"),
    (0x045e, 0x0b05, Some(Bus::Bluetooth), Model::XboxWireless, "Xbox Elite 2"),
    (0x045e, 0x0b22, Some(Bus::Bluetooth), Model::XboxWireless, "Xbox Elite 2 (low energy)"),
    (0x045e, 0x0b13, Some(Bus::Bluetooth), Model::XboxSeries, "Xbox Series"),
    (0x2dc8, 0x6000, None, Model::EightBitDo, "8BitDo SF30 Pro"),
    (0x2dc8, 0x6100, None, Model::EightBitDo, "8BitDo SF30 Pro (Bluetooth)"),
    (0x2dc8, 0x6001, None, Model::EightBitDo, "8BitDo SN30 Pro"),
    (0x2dc8, 0x6101, None, Model::EightBitDo, "8BitDo SN30 Pro (Bluetooth)"),
    (0x2dc8, 0x6003, None, Model::EightBitDo, "8BitDo Pro 2"),
    (0x2dc8, 0x6006, None, Model::EightBitDo, "8BitDo Pro 2 (Bluetooth)"),
    (0x2dc8, 0x6012, None, Model::EightBitDoUltimate, "8BitDo Ultimate 2 Wireless"),
];

impl Model {
    /// The model of a pad, if its reports are known.
    #[must_use]
    pub fn of(id: PadId) -> Option<Self> {
        KNOWN
            .iter()
            .find(|(vendor, product, bus, ..)| {
                (*vendor, *product) == (id.vendor, id.product) && bus.is_none_or(|bus| bus == id.bus)
            })
            .map(|line| line.3)
    }
}

/// The parser of one connected pad, whatever its kind.
#[derive(Clone, Debug)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the types say it all")]
pub enum Parser {
    DualShock4(DualShock4),
    DualSense(DualSense),
    SwitchPro(SwitchPro),
    Xbox(XboxWireless),
    EightBitDo(EightBitDo),
    Generic(Box<GenericPad>),
}

impl Parser {
    /// The parser for a pad: by its model if known, else by its report descriptor.
    ///
    /// # Errors
    /// [`NoGamepad`] when the pad is unknown and its descriptor is invalid or describes no gamepad.
    pub fn new(id: PadId, descriptor: &[u8]) -> Result<Self, NoGamepad> {
        match Model::of(id) {
            Some(model) => Ok(Self::of_model(model, id.bus)),
            None => GenericPad::from_descriptor(id, descriptor).map(|pad| Self::Generic(Box::new(pad))),
        }
    }

    /// The parser for a known model.
    #[must_use]
    pub fn of_model(model: Model, bus: Bus) -> Self {
        match model {
            Model::DualShock4 => Self::DualShock4(DualShock4::new(bus, false)),
            Model::DualShock4Receiver => Self::DualShock4(DualShock4::new(bus, true)),
            Model::DualSense => Self::DualSense(DualSense::new(bus)),
            Model::SwitchPro => Self::SwitchPro(SwitchPro::default()),
            Model::XboxWireless => Self::Xbox(XboxWireless::new(false)),
            Model::XboxSeries => Self::Xbox(XboxWireless::new(true)),
            Model::EightBitDo => Self::EightBitDo(EightBitDo::new(true)),
            Model::EightBitDoUltimate => Self::EightBitDo(EightBitDo::new(false)),
        }
    }

    /// Reads one input report, its id first where the pad uses ids. Does not allocate.
    ///
    /// # Errors
    /// [`ReportError`] for short, unknown and corrupted reports; `input` is unchanged.
    pub fn parse_into(&mut self, report: &[u8], input: &mut PadInput) -> Result<Update, ReportError> {
        match self {
            Self::DualShock4(pad) => pad.parse_into(report, input),
            Self::DualSense(pad) => pad.parse_into(report, input),
            Self::SwitchPro(pad) => pad.parse_into(report, input),
            Self::Xbox(pad) => pad.parse_into(report, input),
            Self::EightBitDo(pad) => pad.parse_into(report, input),
            Self::Generic(pad) => pad.parse_into(report, input),
        }
    }

    /// Processes a feature report requested by [`Request::Feature`]. Ignores other reports.
    pub fn accept_feature(&mut self, report: &[u8]) {
        match self {
            Self::DualShock4(pad) => pad.accept_feature(report),
            Self::DualSense(pad) => pad.accept_feature(report),
            Self::SwitchPro(_) | Self::Xbox(_) | Self::EightBitDo(_) | Self::Generic(_) => {}
        }
    }
}
