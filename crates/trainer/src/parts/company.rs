//! Controllers of skills that are trained already, for what happens around a character that learns.

use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use policy_core::{CharacterPack, Controller, ControllerConfig};

use crate::env::WALK;
use crate::pack::{PackPlan, TrainedSkill, bind, trained_policy};
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

    /// A pack of the trained skills of a plan, each from the run that `trainer pack` takes it from, or from another that trained it
    /// where there is none. A run of parents that were trained together comes before the plan's joint run. A skill that is needed and
    /// not trained is an error, which names `needed_by`.
    pub(super) fn pack_of(
        &self,
        plan: PackPlan,
        needed_by: &str,
        is_needed: impl Fn(&str) -> bool,
    ) -> Result<Arc<CharacterPack>> {
        ensure!(!plan.policies.is_empty(), "{needed_by}: expected policies in {PLAN}, found none");
        let mut trained = Vec::new();
        let runs = self.parents.iter().chain(&plan.joint).map(|run| self.newest(run));
        let joint = runs.filter_map(Result::transpose).collect::<Result<Vec<_>, _>>()?;
        for policy in &plan.policies {
            let name = &policy.name;
            let mut skill = trained_policy(policy, &joint, &|run| self.newest(run))?;
            if skill.is_none()
                && let Some((checkpoint, path)) = self.trained(name)?
            {
                skill = Some(TrainedSkill::from_checkpoint(name, &checkpoint, &path)?);
            }
            ensure!(skill.is_some() || !is_needed(name), "{needed_by} need {name}, which is not trained yet");
            trained.extend(skill);
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
        // Walk comes from the joint run also where a run of its own lies beside it.
        let walk = || {
            let pack = workspace.company(&recipe).unwrap().unwrap().pack().clone();
            pack.policies()[pack.policy_named("walk").unwrap().index()].clone()
        };
        let together = walk();
        let other = assets().join("checkpoints/walk_0_1.safetensors");
        std::fs::copy(other, workspace.kept.join("walk.safetensors")).unwrap();
        assert_eq!(together.squared_distance(&walk()), 0.0, "the plan takes Walk from the joint run");
    }
}
