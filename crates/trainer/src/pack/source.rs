//! Which run a policy of a plan comes from.

use super::{PlannedPolicy, TrainedSkill};
use crate::checkpoint::CheckpointError;
use crate::workspace::CheckpointFile;

/// The policy of a plan, by its name there: of the first of the runs in `joint` that trained it together with others, or of the
/// run that the plan names, or of its skill's own run. `newest` finds the checkpoint of a run; `None` when there is none.
///
/// # Errors
/// When a checkpoint can't be read or lacks a network.
pub fn trained_policy(
    policy: &PlannedPolicy,
    joint: &[CheckpointFile],
    newest: &dyn Fn(&str) -> Result<Option<CheckpointFile>, CheckpointError>,
) -> Result<Option<TrainedSkill>, CheckpointError> {
    let PlannedPolicy { name, from, skill, .. } = policy;
    let skill = skill.as_ref().unwrap_or(name);
    let together = joint.iter().find(|(loaded, _)| TrainedSkill::is_in(skill, loaded));
    let trained = match (from, together) {
        (None, Some((loaded, path))) => Some(TrainedSkill::from_checkpoint(skill, loaded, path)?),
        _ => newest(from.as_ref().unwrap_or(skill))?
            .map(|(loaded, path)| TrainedSkill::from_checkpoint(skill, &loaded, &path))
            .transpose()?,
    };
    Ok(trained.map(|trained| TrainedSkill { skill: name.clone(), ..trained }))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use random::Rng;

    use super::*;
    use crate::checkpoint::{Checkpoint, Trained};
    use crate::nn::{Adam, Network};

    /// A checkpoint whose networks of these roles have this number as their first parameter.
    fn of(number: f32, roles: &[&str]) -> CheckpointFile {
        let mut network = Network::zeros(&[2, 1]);
        network.parameters[0] = number;
        let trained = Trained { adam: Adam::new(network.parameters.len()), network };
        let networks = roles.iter().map(|role| ((*role).to_owned(), trained.clone())).collect();
        (Checkpoint::new(networks, (1, 2, 3.0), 1e-4, Rng::new(1, 1)), PathBuf::from("x"))
    }

    #[test]
    fn a_policy_is_of_the_joint_run_unless_the_plan_names_another() {
        let joint = [of(1.0, &["walk.actor", "walk.discriminator"])];
        let newest = |run: &str| {
            let number = ["walk", "ground", "crawl"].iter().position(|known| *known == run);
            Ok(number.map(|number| of(10.0 + number as f32, &["actor", "discriminator"])))
        };
        let number = |text: &str, joint: &[CheckpointFile]| {
            let policy: PlannedPolicy = toml::from_str(text).unwrap();
            let trained = trained_policy(&policy, joint, &newest).unwrap()?;
            assert_eq!(trained.skill, policy.name);
            Some(trained.actor.parameters[0])
        };
        assert_eq!(number("name = \"walk\"", &joint), Some(1.0));
        assert_eq!(number("name = \"walk\"", &[]), Some(10.0));
        assert_eq!(number("name = \"walk\"\nfrom = \"ground\"", &joint), Some(11.0));
        assert_eq!(number("name = \"stroll\"\nskill = \"walk\"", &joint), Some(1.0));
        assert_eq!(number("name = \"creep\"\nskill = \"crawl\"", &joint), Some(12.0));
        assert_eq!(number("name = \"run\"", &joint), None);
    }
}
