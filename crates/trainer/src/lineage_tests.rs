use super::execute::{check_stamp, stamp};
use super::*;

fn parse(steps: &str) -> Result<Lineage, LineageError> {
    Lineage::parse(Path::new("x.toml"), &format!("steps = [{steps}]"))
}

#[test]
fn steps_read_what_earlier_steps_make() {
    let good = "{ train = { recipe = \"walk\" } }, { train = { recipe = \"walk\", run = \"more\", continues = \"walk\" } }, \
                { average = { run = \"mean\", of = [\"walk\", \"more\"] } }";
    let lineage = parse(good).unwrap();
    assert_eq!(lineage.seed, 1);
    assert_eq!(lineage.steps.iter().map(Step::run).collect::<Vec<_>>(), ["walk", "more", "mean"]);
    let said = |steps: &str| parse(steps).expect_err(steps).to_string();
    assert!(said("{ average = { run = \"mean\", of = [\"walk\", \"more\"] } }").contains("steps[0]"));
    assert!(said(&good.replacen("run = \"more\"", "run = \"walk\"", 1)).contains("no other step"));
    assert!(said(&good.replace("[\"walk\", \"more\"]", "[\"walk\"]")).contains("at least two"));
    let weighed = |weights: &str| {
        good.replace("of = [\"walk\", \"more\"]", &format!("of = [\"walk\", \"more\"], {weights}"))
    };
    assert!(parse(&weighed("weights = [1.2, -0.2], policy = \"walk\"")).is_ok());
    assert!(said(&weighed("weights = [1.2]")).contains("2 weights that add up to 1"));
    assert!(said(&good.replace("continues", "from = \"walk\", continues")).contains("both"));
    assert!(said(&good.replace("continues", "from_samples = 5, continues")).contains("beside"));
    assert!(said("{ train = { recipe = \"../x\" } }").contains("lower-case"));
    assert!(said("{ train = { recipe = \"x\", samples = 0 } }").contains("at least one"));
    let kept =
        "kept = [\"old\"]\nsteps = [{ train = { recipe = \"walk\", from = \"old\", from_samples = 5 } }]";
    assert!(Lineage::parse(Path::new("x.toml"), kept).is_ok());
    assert!(said("{ train = { recipe = \"walk\", from = \"old\" } }").contains("a kept one"));
    assert!(said("{ dance = { } }").contains("dance"));
}

#[test]
fn the_stamp_of_a_step_tells_another_one() {
    let folder = tempfile::tempdir().unwrap();
    let lineage = parse("{ train = { recipe = \"walk\" } }, { train = { recipe = \"idle\" } }").unwrap();
    let stamps: Vec<_> = lineage.steps.iter().map(|s| stamp(s, None).unwrap()).collect();
    std::fs::write(folder.path().join(STEP_FILE), &stamps[0]).unwrap();
    assert!(check_stamp(folder.path(), &stamps[0]).is_ok());
    assert!(check_stamp(folder.path(), &stamps[1]).unwrap_err().to_string().contains(STEP_FILE));
}
