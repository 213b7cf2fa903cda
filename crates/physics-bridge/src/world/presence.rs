//! Lets things touch others or not, without building the world anew.

use super::World;
use super::scene::JointRecord;

/// Length of a rope that holds nothing, metres.
const SLACK_M: f64 = 1e6;

impl World {
    /// Lets a prop touch others, or not, and tightens or slackens its ropes.
    pub(super) fn show_prop(&mut self, index: usize, present: bool) {
        self.show_body(self.places.prop(index).body, present);
        for joint in 0..self.scene.joints.end() {
            let Some(slot) = self.scene.joints.slot(joint) else { continue };
            let (JointRecord::Rope(rope), Some(tendon)) = (&slot.value, self.places.ropes[joint]) else {
                continue;
            };
            if !rope.props.contains(&Some(index)) {
                continue;
            }
            let is_there = |prop: usize| self.scene.props.slot(prop).is_some_and(|slot| slot.present);
            let holds = rope.props.iter().flatten().all(|&prop| is_there(prop));
            let length = if holds { rope.length } else { SLACK_M };
            // SAFETY: one number of the model is written; no size, index or address changes.
            unsafe { self.data.model_mut() }.tendon_range_mut()[tendon][1] = length;
        }
    }

    /// Lets a character touch others, or not.
    pub(super) fn show_character(&mut self, index: usize, present: bool) {
        for body in self.places.character(index).span.bodies.clone() {
            self.show_body(body, present);
        }
    }

    /// Lets a body touch others, or not.
    fn show_body(&mut self, body: usize, present: bool) {
        // SAFETY: only contact bits are written; no size, index or address changes.
        let model = unsafe { self.data.model_mut() };
        let keep = |bits: [i32; 2]| if present { bits } else { [0; 2] };
        let [contype, conaffinity] = keep(self.places.body_bits[body]);
        model.body_contype_mut()[body] = contype;
        model.body_conaffinity_mut()[body] = conaffinity;
        let first = model.body_geomadr()[body];
        let geoms = model.body_geomnum()[body];
        for geom in first..first + geoms {
            // MuJoCo has compiled the model: a body with geoms has a first one.
            let geom = geom as usize;
            let [contype, conaffinity] = keep(self.places.geom_bits[geom]);
            model.geom_contype_mut()[geom] = contype;
            model.geom_conaffinity_mut()[geom] = conaffinity;
        }
    }
}
