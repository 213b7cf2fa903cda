//! Values of the command line: each parser says what it expects.

use policy_core::BlendMode;

use super::MOST_SECS;
use crate::app::PanelKind;
use crate::sim::{Engine, GhostKind, GroundKind, MAX_CHARACTERS, SceneKind};

/// Most pixels of a picture: one takes about 45 bytes of memory.
const MOST_PIXELS: u32 = 3840 * 2160;

pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let parts = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    match parts {
        Some([w, h]) if (16..=8192).contains(&w) && (16..=8192).contains(&h) && w * h <= MOST_PIXELS => {
            Ok([w, h])
        }
        _ => Err(format!(
            "expected WIDTHxHEIGHT, such as 1280x720, each 16 to 8192 and at most {MOST_PIXELS} pixels (3840x2160)"
        )),
    }
}

pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if seconds > 0.0 && seconds <= MOST_SECS => Ok(seconds),
        _ => Err(format!("expected a number above 0 and up to {MOST_SECS}")),
    }
}

/// Panels to open; none named means those that open by themselves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PanelList(pub Vec<PanelKind>);

pub(super) fn panels(text: &str) -> Result<PanelList, String> {
    let expected = || {
        let titles = PanelKind::ALL.map(|kind| kind.title().to_lowercase()).join(",");
        format!("expected some of {titles}")
    };
    let named = text.split(',').filter(|title| !title.is_empty());
    named
        .map(|title| PanelKind::from_title(title).ok_or_else(expected))
        .collect::<Result<_, _>>()
        .map(PanelList)
}

pub(super) fn distance(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(metres) if (1.0..=60.0).contains(&metres) => Ok(metres),
        _ => Err("expected a number from 1 to 60".into()),
    }
}

pub(super) fn characters(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if (1..=MAX_CHARACTERS).contains(&count) => Ok(count),
        _ => Err(format!("expected a whole number from 1 to {MAX_CHARACTERS}")),
    }
}

pub(super) fn mode(text: &str) -> Result<BlendMode, String> {
    let names = BlendMode::ALL.map(BlendMode::name).join(", ");
    BlendMode::from_name(text).ok_or_else(|| format!("expected one of {names}"))
}

pub(super) fn ground(text: &str) -> Result<GroundKind, String> {
    let names = GroundKind::ALL.map(GroundKind::name).join(", ");
    GroundKind::from_name(text).ok_or_else(|| format!("expected one of {names}"))
}

pub(super) fn scene(text: &str) -> Result<SceneKind, String> {
    let names = SceneKind::ALL.map(SceneKind::name).join(", ");
    SceneKind::from_name(text).ok_or_else(|| format!("expected one of {names}"))
}

pub(super) fn engine(text: &str) -> Result<Engine, String> {
    let names = Engine::ALL.map(Engine::name).join(", ");
    Engine::from_name(text).ok_or_else(|| format!("expected one of {names}"))
}

/// What a ghost differs in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GhostChoice {
    /// The engine that the player is not in.
    OtherEngine,
    /// As named.
    Kind(GhostKind),
}

pub(super) fn ghost(text: &str) -> Result<GhostChoice, String> {
    let mode = || BlendMode::from_name(text).map(GhostKind::Mode);
    let kind = Engine::from_name(text).map(GhostKind::Engine).or_else(mode).map(GhostChoice::Kind);
    kind.or((text == OTHER).then_some(GhostChoice::OtherEngine)).ok_or_else(|| {
        let names = BlendMode::ALL.map(BlendMode::name).into_iter().chain(Engine::ALL.map(Engine::name));
        format!("expected {OTHER} or one of {}", names.collect::<Vec<_>>().join(", "))
    })
}

/// Name of the engine that the player is not in.
pub(super) const OTHER: &str = "other";
