//! What a press of a button does, in every gait; the way from a crawl to its feet; jumps of joint targets.

mod buttons;
mod jump;
mod rise;

pub use buttons::{PressReport, button_name, measure_buttons};
pub use jump::{JumpReport, measure_jumps};
pub use rise::{RiseReport, measure_rise};

pub(super) use buttons::bound_buttons;
