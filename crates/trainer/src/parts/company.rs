//! Controllers of skills that are trained already, for what happens around a character that learns.

use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use policy_core::{CharacterPack, Controller, ControllerConfig};

use crate::env::WALK;
use crate::pack::{PackPlan, TrainedSkill, bind};
use crate::recipe::Recipe;
use crate::workspace::Workspace;

/// Plan of the pack, in the folder of recipes.
pub(super) const PLAN: &str = "pack/humanoid.toml";

impl Workspace {
    /// What drives the characters that are met in a recipe's phases, and a character until a skill starts in play; `None` where
    /// there is neither.
    pub(super) fn company(&self, recipe: &Recipe) -> Result<Option<Controller>> {
        let Some((needed_by, names)) = recipe.driven_by() else { return Ok(None) };
        let mut played = Vec::new();
        for name in names.iter().filter(|name| **name != recipe.skill) {
            if recipe.needs_trained().contains(name) || self.trained(name)?.is_some() {
                played.push(*name);
            }
        }
        let plan = PackPlan::load(&self.recipes.join(PLAN))?.only(|name| played.contains(&name));
        let pack = self.pack_of(&plan, needed_by)?;
        let start = pack.graph().node_named(WALK);
        let start = start.with_context(|| format!("expected a node {WALK} in {PLAN}, found none"))?;
        let config = ControllerConfig { start, auto_recover: false, ..ControllerConfig::default() };
        Ok(Some(Controller::with_config(pack, config)))
    }

    /// A pack of the trained skills of a plan. `needed_by` is what an error names.
    pub(super) fn pack_of(&self, plan: &PackPlan, needed_by: &str) -> Result<Arc<CharacterPack>> {
        ensure!(!plan.policies.is_empty(), "{needed_by}: expected policies in {PLAN}, found none");
        let mut trained = Vec::new();
        for policy in &plan.policies {
            let (checkpoint, path) = self
                .trained(&policy.name)?
                .with_context(|| format!("{needed_by} need {}, which is not trained yet", policy.name))?;
            trained.push(TrainedSkill::from_checkpoint(&policy.name, &checkpoint, &path)?);
        }
        Ok(Arc::new(bind(plan, &trained, &self.normalisers, &self.model, None)?))
    }
}
