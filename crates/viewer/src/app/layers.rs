//! The sliders of the layers: one for all, or one each (the paper's section 4.3).

use policy_core::{Blend, CharacterPack, NodeId};
use serde::{Deserialize, Serialize};

/// What replaces the position on the graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The sliders count; otherwise the triggers do.
    pub active: bool,
    /// One slider for all layers.
    pub automatic: bool,
    /// The policy where sliders are 0.
    pub from: NodeId,
    /// The policy where they are 1.
    pub to: NodeId,
    /// Hidden 1, hidden 2, output.
    pub t: [f32; 3],
    /// Name for the next preset.
    pub name: String,
}

/// Sliders that are remembered, by names of policies, so that they can be shared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Its name.
    pub name: String,
    /// Policy where sliders are 0.
    pub from: String,
    /// Policy where they are 1.
    pub to: String,
    /// Hidden 1, hidden 2, output.
    pub t: [f32; 3],
}

impl Layers {
    /// Between the ends of the pack's first edge.
    #[must_use]
    pub fn new(pack: &CharacterPack) -> Self {
        let [from, to] = pack.graph().edges().first().map_or([NodeId::default(); 2], |e| e.nodes);
        Self { active: false, automatic: true, from, to, t: [0.0; 3], name: "my blend".into() }
    }

    /// The blend that the sliders say, while they count.
    #[must_use]
    pub fn blend(&self) -> Option<Blend> {
        if !self.active {
            return None;
        }
        let [first, second, output] = if self.automatic { [self.t[0]; 3] } else { self.t };
        let mut t = [output; policy_core::training::MAX_LAYERS];
        (t[0], t[1]) = (first, second);
        Some(Blend::between_per_layer(self.from.into(), self.to.into(), t))
    }

    /// The sliders as a preset of `pack`.
    #[must_use]
    pub fn preset(&self, pack: &CharacterPack) -> Preset {
        let name = |node: NodeId| pack.graph().node(node).name.clone();
        let t = if self.automatic { [self.t[0]; 3] } else { self.t };
        Preset { name: self.name.clone(), from: name(self.from), to: name(self.to), t }
    }

    /// The sliders that a preset says; `None` when the pack lacks its policies or a number is out of range.
    #[must_use]
    pub fn of_preset(preset: &Preset, pack: &CharacterPack) -> Option<Self> {
        let from = pack.graph().node_named(&preset.from)?;
        let to = pack.graph().node_named(&preset.to)?;
        let sound = preset.t.iter().all(|t| (-1.0..=2.0).contains(t));
        let automatic = preset.t == [preset.t[0]; 3];
        let name = preset.name.clone();
        sound.then_some(Self { active: true, automatic, from, to, t: preset.t, name })
    }
}
