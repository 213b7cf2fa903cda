//! Controllers of skills that are trained already, for what happens around a character that learns.

use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use policy_core::{CharacterPack, Controller, ControllerConfig};

use crate::env::WALK;
use crate::pack::{PackPlan, PlannedPolicy, TrainedSkill, bind};
use crate::recipe::Recipe;
use crate::workspace::Workspace;

/// Plan of the pack, in the folder of recipes.
pub(super) const PLAN: &str = "pack/humanoid.toml";

impl Workspace {
    /// What drives the characters that are met in a recipe's phases, and a character until a skill starts in play; `None` where
    /// there is neither.
    pub(super) fn company(&self, recipe: &Recipe) -> Result<Option<Controller>> {
        let Some((needed_by, names)) = recipe.driven_by() else { return Ok(None) };
        let plan = PackPlan::load(&self.recipes.join(PLAN))?
            .only(|name| names.contains(&name) && name != recipe.skill);
        let pack = self.pack_of(plan, needed_by, |name| recipe.needs_trained().contains(&name))?;
        let start = pack.graph().node_named(WALK);
        let start = start.with_context(|| format!("expected a node {WALK} in {PLAN}, found none"))?;
        let config = ControllerConfig { start, auto_recover: false, ..ControllerConfig::default() };
        Ok(Some(Controller::with_config(pack, config)))
    }

    /// A pack of the trained skills of a plan, each from the run that the plan takes it from, or from its own where that one is not trained;
    /// one that is needed and not trained is an error, which names `needed_by`.
    pub(super) fn pack_of(
        &self,
        plan: PackPlan,
        needed_by: &str,
        is_needed: impl Fn(&str) -> bool,
    ) -> Result<Arc<CharacterPack>> {
        ensure!(!plan.policies.is_empty(), "{needed_by}: expected policies in {PLAN}, found none");
        let mut trained = Vec::new();
        for PlannedPolicy { name, from, .. } in &plan.policies {
            let mut runs = from.iter().chain([name]).map(|run| self.trained(run));
            match runs.find_map(Result::transpose).transpose()? {
                Some((checkpoint, path)) => {
                    trained.push(TrainedSkill::from_checkpoint(name, &checkpoint, &path)?);
                }
                None => ensure!(!is_needed(name), "{needed_by} need {name}, which is not trained yet"),
            }
        }
        let plan = plan.only(|name| trained.iter().any(|skill| skill.skill == name));
        Ok(Arc::new(bind(&plan, &trained, &self.normalisers, &self.model, None)?))
    }
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use clips::ClipFolder;
    use physics_bridge::Model;

    use super::*;
    use crate::normaliser_file;

    fn assets() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets")
    }

    fn workspace(folder: &Path) -> Workspace {
        let model = Model::load(assets().join("humanoid.xml")).unwrap();
        let normaliser = assets().join("checkpoints/normaliser.safetensors");
        Workspace {
            recipes: assets().join("recipes"),
            runs: folder.join("runs"),
            kept: folder.join("kept"),
            clips: ClipFolder::from_argument(Some(folder.to_owned())).unwrap(),
            normalisers: normaliser_file::load(&normaliser, model.skeleton()).unwrap(),
            model,
            parents: None,
        }
    }

    #[test]
    fn the_run_that_is_met_is_that_of_the_pack() {
        let folder = tempfile::tempdir().unwrap();
        let workspace = workspace(folder.path());
        std::fs::create_dir(&workspace.kept).unwrap();
        let copy = |name: &str| {
            let file = format!("{name}.safetensors");
            std::fs::copy(assets().join("checkpoints").join(&file), workspace.kept.join(&file)).unwrap();
        };
        let recipe = workspace.recipe("walk_catch").unwrap();
        let run = || {
            let pack = workspace.company(&recipe).unwrap().unwrap().pack().clone();
            pack.policies()[pack.policy_named("run").unwrap().index()].clone()
        };
        copy("locomotion");
        let together = run();
        copy("run_steady");
        let of_pack = run();
        assert!(together.squared_distance(&of_pack) > 0.0, "the plan takes Run from elsewhere");
    }
}
