//! Footing: gaits are blended with their variants for rough ground as far as the ground is uneven, and act alone on level ground.

mod common;

use std::sync::Arc;

use common::{acted, hand_over, p, policy, standing, weight};
use policy_core::{
    CharacterPack, CharacterState, Command, Controller, ControllerConfig, Goal, PathId, Skeleton,
};

const DT: f32 = 1.0 / 30.0;

/// The made-up pack, whose walk has the roll's policy as its variant.
fn pack() -> Arc<CharacterPack> {
    let mut manifest = common::manifest();
    manifest.policies[1].rough_ground = Some("roll".into());
    Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap())
}

fn controller(footing: bool) -> Controller {
    let mut controller =
        Controller::with_config(pack(), ControllerConfig { footing, ..ControllerConfig::default() });
    for _ in 0..90 {
        tick(&mut controller, &standing());
    }
    controller
}

/// One tick towards the second node of the first path. Returns the policies and their weights in the first layer.
fn tick(controller: &mut Controller, state: &CharacterState) -> Vec<(usize, f32)> {
    let goal = Goal::Path { path: PathId::new(0), coordinate: 1.0 };
    controller.tick(state, &Command { goal, ..Command::default() }, DT);
    acted(controller)
}

fn before_a_step() -> CharacterState {
    let mut state = standing();
    let foot = Skeleton::humanoid().feet()[0];
    state.ground_rises[foot.index()] = 0.1;
    state
}

fn roll() -> usize {
    policy("roll")
}

#[test]
fn a_gait_acts_alone_on_level_ground_and_as_its_variant_on_rough_ground() {
    let mut controller = controller(true);
    assert_eq!(tick(&mut controller, &standing()), [(1, 1.0)]);
    let shares: Vec<f32> = (0..4).map(|_| weight(&tick(&mut controller, &before_a_step()), roll())).collect();
    assert!((shares[0] - 1.0 / 3.0).abs() < 1e-5, "a tenth of a second to cross: {shares:?}");
    assert_eq!(shares[3], 1.0);
    let back = tick(&mut controller, &standing());
    assert_eq!(back.len(), 2, "on level ground it returns slowly: {back:?}");
    assert!(
        (weight(&back, 1) - DT / 3.0).abs() < 1e-5
            && (back.iter().map(|b| b.1).sum::<f32>() - 1.0).abs() < 1e-6
    );
    for _ in 0..90 {
        tick(&mut controller, &standing());
    }
    assert_eq!(tick(&mut controller, &standing()), [(1, 1.0)]);
}

#[test]
fn a_gait_that_stands_rests_on_rough_ground_and_half_way_to_a_walk_its_family_acts() {
    let mut manifest = common::gaits(|_| {});
    (manifest.policies[0].rough_ground, manifest.policies[0].resting) =
        (Some("crawl".into()), Some("roll".into()));
    let pack = Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap());
    let config = ControllerConfig { agility: false, ..ControllerConfig::default() };
    let shares = |coordinate: f32, state: &CharacterState| {
        let mut controller = Controller::with_config(pack.clone(), config);
        let goal = Goal::Path { path: PathId::new(0), coordinate };
        for _ in 0..90 {
            controller.tick(state, &Command { goal, ..Command::default() }, DT);
        }
        let acted = acted(&controller);
        ["idle", "crawl", "roll"].map(|name| weight(&acted, policy(name)))
    };
    let near = |is: [f32; 3], wanted: [f32; 3]| {
        assert!(is.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-5), "{is:?} {wanted:?}");
    };
    near(shares(0.0, &standing()), [1.0, 0.0, 0.0]);
    near(shares(0.0, &before_a_step()), [0.0, 0.0, 1.0]);
    near(shares(0.5, &before_a_step()), [0.0, 0.5, 0.0]);
    near(shares(0.25, &before_a_step()), [0.0, 0.0, 0.75]);
    near(shares(0.375, &before_a_step()), [0.0, 0.3125, 0.3125]);
}

#[test]
fn on_the_way_over_an_edge_that_is_only_crossed_the_ground_counts_as_level_unless_both_ends_have_a_variant() {
    let roll_shares = |transit: bool, both: bool| {
        let mut manifest = common::manifest();
        manifest.policies[1].rough_ground = Some("roll".into());
        manifest.policies[0].rough_ground = both.then(|| "roll".into());
        manifest.policies[0].fall_height = Some(0.2);
        manifest.edges[0].transit = transit;
        let pack = Arc::new(CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap());
        let mut controller = Controller::new(pack);
        let mut towards = |coordinate: f32, ticks: usize| -> Vec<f32> {
            let goal = Goal::Path { path: PathId::new(0), coordinate };
            let command = Command { goal, ..Command::default() };
            let share = |_| {
                controller.tick(&before_a_step(), &command, DT);
                let walks = controller.report().position.blend();
                let of_walk: f32 =
                    walks.terms().iter().filter(|t| t.policy.index() == 1).map(|t| t.weights[0]).sum();
                weight(&acted(&controller), roll()) / of_walk.max(1e-6)
            };
            (0..ticks).map(share).collect()
        };
        assert_eq!(*towards(1.0, 120).last().unwrap(), 1.0, "it walks on rough ground");
        towards(0.0, 18)
    };
    let (rested_on, crossed) = (roll_shares(false, false), roll_shares(true, false));
    assert!((rested_on[2] - 1.0).abs() < 1e-5, "{rested_on:?}");
    assert!(crossed[2] > 0.5 && crossed[2] < 0.95, "it leaves off within half a second: {crossed:?}");
    assert_eq!(crossed[17], 0.0);
    let known = roll_shares(true, true);
    assert!(known.iter().all(|share| *share >= 1.0), "both ends act as their variant all the way: {known:?}");
}

#[test]
fn without_footing_or_without_a_variant_nothing_changes() {
    let mut off = controller(false);
    let mut without = Controller::new(Arc::new(common::pack(0.0)));
    for _ in 0..90 {
        tick(&mut without, &standing());
    }
    for _ in 0..10 {
        assert_eq!(tick(&mut off, &before_a_step()), [(1, 1.0)]);
        assert_eq!(tick(&mut without, &before_a_step()), [(1, 1.0)]);
    }
}

#[test]
fn a_state_saved_half_way_goes_on_with_the_same_blend() {
    let mut run = controller(true);
    tick(&mut run, &before_a_step());
    let mut other = controller(true);
    hand_over(&run, &mut other);
    for _ in 0..20 {
        assert_eq!(tick(&mut other, &standing()), tick(&mut run, &standing()));
    }
    assert!(run.report().blend.terms().iter().any(|term| term.policy == p(roll())), "still on its way back");
}

#[test]
fn an_unknown_variant_is_refused_by_name() {
    let mut manifest = common::manifest();
    manifest.policies[1].rough_ground = Some("walk on gravel".into());
    let error = CharacterPack::from_parts(manifest, common::tensors(0.0)).unwrap_err().to_string();
    assert!(error.contains("walk on gravel") && error.contains("policy"), "{error}");
}
