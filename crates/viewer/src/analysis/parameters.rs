//! Policies as points: their parameters on three axes, and where a blend of them lies.

use glam::Vec3;
use policy_core::{Blend, CharacterPack, Mlp};

use super::components::Components;

/// Policies on the axes of their parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterMap {
    /// Where each policy lies, about [-1, 1].
    pub nodes: Vec<Vec3>,
    /// What each layer of each policy adds to its place: `[node][layer]`.
    layers: Vec<Vec<Vec3>>,
    mean: Vec3,
}

impl ParameterMap {
    /// Of the policies of a pack.
    #[must_use]
    pub fn of(pack: &CharacterPack) -> Self {
        let rows: Vec<Vec<Vec<f32>>> = pack.policies().iter().map(parameters).collect();
        let flat: Vec<Vec<f32>> = rows.iter().map(|layers| layers.concat()).collect();
        let borrowed: Vec<&[f32]> = flat.iter().map(|row| &row[..]).collect();
        let components = Components::of(&borrowed);
        let layers = rows
            .iter()
            .map(|layers| {
                let mut start = 0;
                layers
                    .iter()
                    .map(|layer| {
                        let at = components.project_part(start, layer);
                        start += layer.len();
                        at
                    })
                    .collect()
            })
            .collect();
        let nodes = borrowed.iter().map(|row| components.project(row)).collect();
        Self { nodes, layers, mean: components.mean_on_axes() }
    }

    /// Where a blend lies: exact, as blending is linear in the parameters.
    #[must_use]
    pub fn blend(&self, blend: &Blend) -> Vec3 {
        let mut at = -self.mean;
        for term in blend.terms() {
            let Some(layers) = self.layers.get(term.policy.index()) else { continue };
            at += layers.iter().zip(term.weights).map(|(layer, weight)| *layer * weight).sum::<Vec3>();
        }
        at
    }
}

/// Parameters of every layer, rows of the matrix and then the biases.
fn parameters(mlp: &Mlp) -> Vec<Vec<f32>> {
    mlp.layers().iter().map(|layer| layer.weight().chain(layer.bias()).collect()).collect()
}
