//! Pads through gilrs, with SDL's mappings: those without HID, such as Xbox pads on USB (xpad, XInput).

use std::collections::BTreeMap;
use std::time::Instant;

use gilrs::{Axis, EventType, Gamepad, GamepadId, Gilrs, GilrsBuilder};

use super::{BackendError, PadBackend, new_key};
use crate::device::{DeviceEvent, DeviceInfo, DeviceKey, Source};
use crate::pads::{Bus, PadId};
use crate::{Button, GamepadState};

/// Reads pads through gilrs.
#[derive(Debug)]
pub struct GilrsBackend {
    gilrs: Gilrs,
    keys: BTreeMap<usize, DeviceKey>,
}

impl GilrsBackend {
    /// Starts the search for pads.
    ///
    /// # Errors
    /// [`BackendError::Gilrs`] when gilrs can't start.
    pub fn start() -> Result<Self, BackendError> {
        // This crate applies its own dead zones, so gilrs' filters are off and values are raw.
        let gilrs = GilrsBuilder::new()
            .with_default_filters(false)
            .build()
            .map_err(|error| BackendError::Gilrs { message: error.to_string() })?;
        Ok(Self { gilrs, keys: BTreeMap::new() })
    }

    fn connect(&mut self, id: GamepadId, events: &mut Vec<(Instant, DeviceEvent)>) -> DeviceKey {
        if let Some(key) = self.keys.get(&usize::from(id)) {
            return *key;
        }
        let key = new_key();
        self.keys.insert(usize::from(id), key);
        let pad = self.gilrs.gamepad(id);
        let pad_id = PadId {
            vendor: pad.vendor_id().unwrap_or(0),
            product: pad.product_id().unwrap_or(0),
            bus: Bus::Other,
        };
        let device = DeviceInfo {
            key,
            name: pad.name().to_owned(),
            id: pad_id,
            serial: None,
            path: format!("gilrs {id}"),
            source: Source::Gilrs,
        };
        events.push((Instant::now(), DeviceEvent::Connected { device, descriptor: None }));
        key
    }
}

impl PadBackend for GilrsBackend {
    fn poll_into(&mut self, events: &mut Vec<(Instant, DeviceEvent)>) {
        let present: Vec<GamepadId> = self.gilrs.gamepads().map(|(id, _)| id).collect();
        for id in present {
            if !self.keys.contains_key(&usize::from(id)) {
                let key = self.connect(id, events);
                events.push((Instant::now(), DeviceEvent::State(key, state_of(&self.gilrs.gamepad(id)))));
            }
        }
        while let Some(event) = self.gilrs.next_event() {
            if event.event == EventType::Disconnected {
                if let Some(key) = self.keys.remove(&usize::from(event.id)) {
                    events.push((Instant::now(), DeviceEvent::Disconnected(key)));
                }
                continue;
            }
            let key = self.connect(event.id, events);
            let state = state_of(&self.gilrs.gamepad(event.id));
            events.push((Instant::now(), DeviceEvent::State(key, state)));
        }
    }

    /// Always false: gilrs' rumble needs no reports and is not used.
    fn send(&mut self, _key: DeviceKey, _report: &[u8]) -> bool {
        false
    }
}

const BUTTONS: [(gilrs::Button, Button); 18] = [
    (gilrs::Button::South, Button::South),
    (gilrs::Button::East, Button::East),
    (gilrs::Button::West, Button::West),
    (gilrs::Button::North, Button::North),
    (gilrs::Button::LeftTrigger, Button::LeftShoulder),
    (gilrs::Button::RightTrigger, Button::RightShoulder),
    (gilrs::Button::LeftTrigger2, Button::LeftTrigger),
    (gilrs::Button::RightTrigger2, Button::RightTrigger),
    (gilrs::Button::LeftThumb, Button::LeftStick),
    (gilrs::Button::RightThumb, Button::RightStick),
    (gilrs::Button::Select, Button::Select),
    (gilrs::Button::Start, Button::Start),
    (gilrs::Button::Mode, Button::Guide),
    (gilrs::Button::DPadUp, Button::DpadUp),
    (gilrs::Button::DPadDown, Button::DpadDown),
    (gilrs::Button::DPadLeft, Button::DpadLeft),
    (gilrs::Button::DPadRight, Button::DpadRight),
    (gilrs::Button::C, Button::Misc),
];

fn state_of(pad: &Gamepad<'_>) -> GamepadState {
    let axis = |axis| pad.value(axis).clamp(-1.0, 1.0);
    let pull = |button| pad.button_data(button).map_or(0.0, |data| data.value().clamp(0.0, 1.0));
    let mut state = GamepadState {
        left_stick: [axis(Axis::LeftStickX), axis(Axis::LeftStickY)],
        right_stick: [axis(Axis::RightStickX), axis(Axis::RightStickY)],
        left_trigger: pull(gilrs::Button::LeftTrigger2),
        right_trigger: pull(gilrs::Button::RightTrigger2),
        ..GamepadState::default()
    };
    for (theirs, ours) in BUTTONS {
        state.buttons.set(ours, pad.is_pressed(theirs));
    }
    state
}
