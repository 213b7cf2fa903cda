use super::*;

fn node(name: &str, speed_mps: f32) -> CourseNode {
    CourseNode {
        name: name.into(),
        speed_mps,
        least_width_mps: 0.6,
        lost_metres: 0.35,
        fall: FallRule::Upright(1.0),
        share: 1.0,
        task: 1.0,
        pelvis_metres: 0.0,
        edge_secs: 0.0,
    }
}

fn course() -> Course {
    let nodes = vec![node("walk", 1.0), node("idle", 0.0), node("run", 3.0), node("crawl", 0.2)];
    Course::new(nodes, vec![vec![1, 0, 2], vec![1, 0, 3]])
}

#[test]
fn paths_share_their_edges() {
    let course = course();
    assert_eq!(course.edges(), [[1, 0], [0, 2], [0, 3]]);
    assert_eq!(course.place(0, 0.25), course.place(1, 0.25));
    assert_eq!(course.place(1, 9.0), Place { edge: 2, t: 1.0 });
    assert!((course.speed_mps(course.place(0, 1.5)) - 2.0).abs() < 1e-6);
    let nodes = [0.0, 0.5, 1.0, 1.5, 2.0].map(|coordinate| course.node_at(course.place(1, coordinate)));
    assert_eq!(nodes, [Some(1), None, Some(0), None, Some(3)]);
}

#[test]
fn weights_of_a_place_sum_to_one() {
    let course = course();
    let mut weights = vec![0.0; course.place_len()];
    for i in 0..=20 {
        course.place_into(course.place(1, i as f32 * 0.1), &mut weights);
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{weights:?}");
    }
    assert_eq!(weights, [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn a_path_of_one_node_is_that_node() {
    let course = Course::new(vec![node("walk", 1.0), node("roll", 0.5)], vec![vec![1]]);
    let place = course.place(0, 0.0);
    assert_eq!((course.edges()[place.edge], place.t), ([1, 1], 1.0));
    assert_eq!((course.speed_mps(place), course.weight(place, 0)), (0.5, 0.0));
    assert_eq!(course.draw(0, &mut Rng::new(1, 1)), 0.0);
}
