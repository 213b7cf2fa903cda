//! What a scene file may hold, and what is said of one that is wrong.

use super::*;

fn scene(checkpoints: &str, props: &str) -> Result<Playground, SceneFileError> {
    Playground::from_ron(&format!(
        "(name: \"a\", area: ((-5, -5), (5, 5)), characters: [(at: (0, 0))], fixtures: [], props: [{props}], \
         checkpoints: [{checkpoints}])"
    ))
}

const TWO: &str = "(at: (1, 0), radius: 1), (at: (3, 0), radius: 1)";

#[test]
fn what_is_wrong_is_named() {
    let said = |result: Result<Playground, SceneFileError>| result.unwrap_err().to_string();
    let one = "(name: \"b\", shape: Ball(0.1), mass: 1, at: (0, 0, 1), paint: Red)";
    assert!(scene(TWO, one).is_ok());
    assert!(said(scene(TWO, &format!("{one}, {one}"))).contains("\"b\" twice"));
    assert!(said(scene("(at: (1, 0), radius: 1)", "")).contains("2 to 64 checkpoints, found 1"));
    assert!(said(scene("(at: (9, 0), radius: 1), (at: (1, 0), radius: 1)", "")).contains("within the area"));
    assert!(said(scene(TWO, &one.replace("mass: 1", "mass: -1"))).contains("a mass"));
    assert!(said(scene(TWO, &one.replace("Ball(0.1)", "Ball(NaN)"))).contains("a size"));
    assert!(said(scene(TWO, &one.replace("paint", "taste"))).contains("taste"));
    let past = format!("{TWO}], way: [(at: (1, 0), near: 0.5, past: \"b\")");
    assert!(said(scene(&past, one)).contains("swings, for the way to lead past it, found \"b\""));
    let far = format!("{TWO}], way: [(at: (9, 0), near: 0.5)");
    assert!(said(scene(&far, one)).contains("a point of the way within the area"));
    assert!(said(Playground::from_ron(&" ".repeat(MOST_BYTES + 1))).contains("bytes"));
}

#[test]
fn the_scene_that_ships_has_what_a_playground_needs() {
    let scene = Playground::shipped().unwrap();
    for name in ["crate_1", "door", "see_saw", "pendulum"] {
        assert!(scene.props.iter().any(|prop| prop.name == name), "{name}");
    }
    assert!(scene.checkpoints.len() >= 5 && (4..=6).contains(&scene.starts.len()));
    for (index, start) in scene.starts.iter().enumerate() {
        assert!(scene.height_at(start.at, 10.0) == 0.0, "start {index} is on the ground");
    }
}
