use super::*;

const GOOD: &str = "skill = \"a\"\nclips = [{ name = \"walk\" }]\n[[phases]]\nsamples = 10\n";

fn parse(text: &str) -> Result<Recipe, RecipeError> {
    Recipe::parse(Path::new("x.toml"), text)
}

/// The error of the good recipe with these lines in its phase.
fn error(lines: &str) -> String {
    parse(&format!("{GOOD}{lines}\n")).expect_err(lines).to_string()
}

/// The error of the good recipe for skills that are trained together.
fn error_together(lines: &str) -> String {
    parse(&format!("{}{lines}\n", together())).expect_err(lines).to_string()
}

fn together() -> String {
    GOOD.replace("clips = [{ name = \"walk\" }]", "paths = [[\"b\", \"c\"]]")
}

#[test]
fn a_phase_overlays_any_field_and_the_next_one_does_not_inherit_it() {
    let text = format!(
        "{GOOD}environment.exploration.deterministic_share = 0.25\nenvironment.reset = {{ other_clips_share = 0.5 }}\n\
         ppo.gamma = 0.5\ndiscriminator.noise_std = 0.7\n[[phases]]\nsamples = 5\n\
         [environment]\nexploration.deterministic_share = 0.125\nreset.clips = [\"idle\"]\n[ppo]\nepochs = 2\n"
    );
    let recipe = parse(&text).unwrap();
    assert_eq!([0, 9, 10, 14, 99].map(|samples| recipe.phase_at(samples)), [0, 0, 1, 1, 1]);
    assert_eq!(recipe.total_samples(), 15);
    let shares = |phase: &Phase| {
        let env = &phase.environment;
        (env.exploration.deterministic_share, env.reset.other_clips_share, phase.ppo.gamma)
    };
    assert_eq!(shares(recipe.first()), (0.25, 0.5, 0.5));
    assert_eq!(shares(recipe.last()), (0.125, 0.0, 0.98));
    assert_eq!([recipe.first(), recipe.last()].map(|p| p.discriminator.noise_std), [0.7, 0.1]);
    for phase in &recipe.phases {
        assert_eq!((phase.ppo.epochs, &phase.environment.reset.clips), (2, &vec!["idle".to_owned()]));
    }
}

#[test]
fn a_recipe_comes_back_from_what_is_kept_beside_its_run() {
    for text in [GOOD.to_owned(), together()] {
        let recipe = parse(&text).unwrap();
        assert_eq!(parse(&toml::to_string(&recipe).unwrap()).unwrap(), recipe);
    }
}

#[test]
fn a_recipe_can_stop_early() {
    let text = format!("{GOOD}[[phases]]\nsamples = 5\n[[phases]]\nsamples = 7\n");
    for (samples, left) in [(1, vec![1]), (10, vec![10]), (12, vec![10, 2]), (99, vec![10, 5, 7])] {
        let mut recipe = parse(&text).unwrap();
        recipe.stop_at(samples);
        assert_eq!(recipe.phases.iter().map(|p| p.samples).collect::<Vec<_>>(), left);
    }
}

#[test]
fn a_character_lies_below_the_recipe() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("characters")).unwrap();
    let character = "[environment.termination]\nlying_metres = 0.3\ndown_metres = 0.6\n";
    std::fs::write(folder.path().join("characters/dog.toml"), character).unwrap();
    let text = format!("character = \"dog\"\n{GOOD}environment.termination.down_metres = 0.7\n");
    let recipe = Recipe::parse(&folder.path().join("x.toml"), &text).unwrap();
    let termination = &recipe.first().environment.termination;
    assert_eq!((termination.lying_metres, termination.down_metres), (0.3, 0.7));
    for name in ["cat", "../dog"] {
        let text = text.replace("dog", name);
        assert!(Recipe::parse(&folder.path().join("x.toml"), &text).unwrap_err().to_string().contains(name));
    }
}

#[test]
fn every_number_has_a_range() {
    let mut recipe = parse(GOOD).unwrap();
    let reset = &mut recipe.phases[0].environment.reset;
    let start =
        crate::env::HandOverConfig { skill: "get_up".into(), share: 0.5, out_of: vec!["walk".into()] };
    reset.hand_over = vec![start];
    reset.in_play =
        Some(crate::env::InPlayConfig { share: 0.5, maximum_speed_mps: Some(0.7), ..Default::default() });
    recipe.phases[0].environment.termination.min_heights.insert("pelvis".into(), 0.5);
    recipe.check_ranges(Path::new("x.toml")).expect("a range for every field and defaults within them");
}

#[test]
fn values_out_of_range_are_named_with_their_range() {
    for (field, values) in [
        ("ppo.min_learning_rate", ["nan", "inf"]),
        ("ppo.max_learning_rate", ["nan", "-1.0"]),
        ("ppo.gamma", ["1.0", "-0.1"]),
        ("ppo.minibatch", ["0", "1000000000000"]),
        ("ppo.epochs", ["0", "1000000000000"]),
        ("ppo.critic_hidden", ["[0]", "[100000, 100000]"]),
        ("discriminator.hidden", ["[0]", "[100000, 100000]"]),
        ("discriminator.batch", ["0", "1000000000000"]),
        ("discriminator.updates", ["65", "1000000000000"]),
        ("discriminator.replay_size", ["0", "1000000000000"]),
        ("environment.reward.fall_cost", ["-1.0", "nan"]),
        ("environment.reward.speed_scale_mps", ["0.0", "inf"]),
        ("environment.command.stop_share", ["-0.1", "1.1"]),
        ("environment.command.slow_stop_share", ["-0.1", "nan"]),
        ("environment.command.fast_target_factor", ["0.0", "inf"]),
        ("environment.command.edge_sweep_secs", ["[0.0, 1.0]", "[1.0, nan]"]),
        ("environment.num_envs", ["0", "1000000000000"]),
        ("environment.termination.min_heights.pelvis", ["-1.0", "inf"]),
    ] {
        for value in values {
            let said = error(&format!("{field} = {value}"));
            assert!(said.contains(field) && said.contains(" to "), "{field} = {value}: {said}");
        }
    }
    let said = parse(&GOOD.replace("10", "0")).unwrap_err().to_string();
    assert!(said.contains("phases[0].samples") && said.contains("found 0"), "{said}");
    assert!(parse(&GOOD.replace("10", "10000000000000")).is_err());
    assert!(error("environment = { num_envs = 65536, horizon = 1024 }").contains("1048576 rows"));
}

#[test]
fn unknown_fields_are_named_with_their_section() {
    assert!(error("ppo.gama = 0.9").contains("phases[0].ppo") && error("ppo.gama = 0.9").contains("gama"));
    assert!(error("[ppo]\ngama = 0.9").contains("ppo: unknown field `gama`"));
    assert!(error("guide = 1.0").contains("guide"));
    assert!(error("environment.reward.task = \"dance\"").contains("dance"));
    assert!(parse("").unwrap_err().to_string().contains("skill"));
}

#[test]
fn fields_that_do_not_fit_together_are_named() {
    assert!(parse(GOOD).is_ok() && parse(&together()).is_ok());
    assert!(
        error("environment.reward = { task_weight = 0.6, tracking_weight = 0.5 }")
            .contains("sum to at most 1")
    );
    let tracking = "environment.reward.tracking_weight = 0.1\n";
    assert!(error_together(tracking).contains("tracking_share"));
    assert!(error("environment.reward.tracking_share = 0.1").contains("without paths"));
    assert!(error_together("ppo.behaviour_cloning = 0.1").contains("beside paths"));
    assert!(
        error(&format!("{tracking}environment.reset.pre_failure_share = 0.1")).contains("pre_failure_share")
    );
    let clock = "environment.command.clock_seconds = 1.5\n";
    assert!(error(clock).contains("clock_seconds"), "a clock without a clip that is tracked");
    assert!(error_together(clock).contains("clock_seconds"));
    assert!(parse(&format!("{GOOD}{tracking}{clock}")).is_ok());
    let alike = "ppo.symmetry = 1.0\n";
    assert!(parse(&format!("{GOOD}{tracking}{clock}{alike}")).is_ok());
    let later = format!("[[phases]]\nsamples = 1000\n{tracking}{clock}{alike}");
    assert!(error(&later).contains("ppo.symmetry"), "a clock that the first phase has not");
    let symmetrised = "ppo.symmetrise = true\n";
    assert!(error(symmetrised).contains("ppo.symmetrise"), "no symmetry loss");
    assert!(error_together(&format!("{symmetrised}{alike}")).contains("ppo.symmetrise"));
    assert!(parse(&format!("{GOOD}{symmetrised}{alike}")).is_ok());
    let in_play = "environment.reset.in_play = { share = 0.5, maximum_speed_mps = 0.7 }\n";
    assert!(error(in_play).contains("in_play") && error_together(in_play).contains("in_play"));
    assert!(parse(&format!("{GOOD}{tracking}{in_play}")).is_ok());
    let runs = "environment.reset.in_play = { share = 0.5, out_of = \"run\" }\n";
    assert!(error(runs).contains("out_of") && parse(&format!("{GOOD}{tracking}{runs}")).is_ok());
    let both = "environment.reset.in_play = { share = 0.5, maximum_speed_mps = 0.7, out_of = \"run\" }\n";
    assert!(error(&format!("{tracking}{both}")).contains("in_play"));
    let let_go = "environment.reset.in_play = { share = 0.5 }\n";
    assert!(parse(&format!("{GOOD}{let_go}")).is_ok());
    let pushed = "environment.reset.in_play = { share = 0.5, out_of = \"push\" }\nenvironment.command.stick_share = 1.0\n";
    assert!(error(pushed).contains("push_newton"));
    let hard = "environment.randomisation.push_newton = 300.0\n";
    assert!(parse(&format!("{GOOD}{pushed}{hard}")).is_ok());
    assert!(error(&format!("{pushed}{hard}environment.meetings.share = 0.2")).contains("meetings"));
    assert!(error(&format!("{tracking}{let_go}")).contains("maximum_speed_mps"));
    assert!(error(&format!("{tracking}{clock}environment.reset.limp_share = 0.1")).contains("limp_share"));
    let hand_over = "environment.reset.hand_over = [{ skill = \"get_up\", share = 0.1 }]";
    assert!(parse(&format!("{}{hand_over}\n", together())).is_ok());
    assert!(error(hand_over).contains("hand_over"));
    assert!(error("environment.command.target_secs = [3.0, 1.0]").contains("target_secs"));
    assert!(
        error("ppo = { min_learning_rate = 0.5, max_learning_rate = 0.1 }").contains("max_learning_rate")
    );
    assert!(error("ppo.critic_hidden = []").contains("hidden layers"));
    let other_size = "[[phases]]\nsamples = 1\nenvironment.num_envs = 7";
    assert!(error(other_size).contains("the same num_envs"));
}

#[test]
fn names_paths_and_edges_are_checked() {
    let refused = |from: &str, to: &str, said: &str| {
        for text in [GOOD.to_owned(), together()].iter().filter(|text| text.contains(from)) {
            let error = parse(&text.replacen(from, to, 1)).expect_err(to).to_string();
            assert!(error.contains(said), "{to}: {error}");
        }
    };
    refused("\"a\"", "\"../a\"", "skill");
    refused("skill = \"a\"", "skill = \"a\"\nedge = true", "edge");
    refused("skill = \"a\"", "skill = \"a\"\nparent = \"a\"", "other skills");
    refused("skill = \"a\"", "skill = \"a\"\nvariant_of = \"a\"", "other skills");
    refused("skill = \"a\"", "skill = \"a\"\nvariant_of = \"b\"\nparent = \"c\"", "variant_of");
    refused("[[\"b\", \"c\"]]", "[[\"a\", \"c\"]]", "other skills");
    refused("[[\"b\", \"c\"]]", "[[\"b\", \"b\"]]", "none of them twice");
    refused("[[\"b\", \"c\"]]", "[[\"b\"]]", "at least two");
    refused("[[\"b\", \"c\"]]", "[[\"b\", \"c\"]]\nhalfway = [[\"c\", \"d\"]]", "halfway");
    refused("[[phases]]\nsamples = 10\n", "phases = []\n", "phases");
}
