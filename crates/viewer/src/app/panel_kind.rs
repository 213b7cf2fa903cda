//! Which panels there are, and where they can be.

use serde::{Deserialize, Serialize};

/// A panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum PanelKind {
    Paths,
    Graph,
    Layers,
    BlendMode,
    Skills,
    Pad,
    Analysis,
    Physics,
    View,
    Profiler,
    Record,
}

impl PanelKind {
    /// All panels, in the order of the bar.
    pub const ALL: [PanelKind; 11] = [
        PanelKind::Paths,
        PanelKind::Graph,
        PanelKind::Layers,
        PanelKind::BlendMode,
        PanelKind::Skills,
        PanelKind::Pad,
        PanelKind::Analysis,
        PanelKind::Physics,
        PanelKind::View,
        PanelKind::Profiler,
        PanelKind::Record,
    ];

    /// The panel with this title, whatever its case.
    #[must_use]
    pub fn from_title(title: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.title().eq_ignore_ascii_case(title))
    }

    /// What it is for, in a sentence.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            PanelKind::Paths => "How fast and how low it goes, as rulers",
            PanelKind::Graph => "All policies, and which may be blended",
            PanelKind::Layers => "Blend by hand, layer by layer",
            PanelKind::BlendMode => "How blends become actions, and a ghost to compare",
            PanelKind::Skills => "Roll, get up and the like, and when they end",
            PanelKind::Pad => "What the gamepad reports",
            PanelKind::Analysis => "Policies and states as clouds of points",
            PanelKind::Physics => "Time, gravity, ground, engine, number of characters",
            PanelKind::View => "Camera, and what is drawn besides the character",
            PanelKind::Profiler => "Where the computing time goes",
            PanelKind::Record => "Screenshots and films",
        }
    }

    /// Title.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            PanelKind::Paths => "Paths",
            PanelKind::Graph => "Graph",
            PanelKind::Layers => "Layers",
            PanelKind::BlendMode => "Blend mode",
            PanelKind::Skills => "Skills",
            PanelKind::Pad => "Pad",
            PanelKind::Analysis => "Analysis",
            PanelKind::Physics => "Physics",
            PanelKind::View => "View",
            PanelKind::Profiler => "Profiler",
            PanelKind::Record => "Record",
        }
    }
}

/// Where a panel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Side {
    Left,
    Right,
}
