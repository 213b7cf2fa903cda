use super::super::config::Fall;
use super::super::course::CourseNode;
use super::*;

fn edge() -> Course {
    let node = |name: &str, speed_mps, share| {
        let config = EnvironmentConfig { speed_mps, ..EnvironmentConfig::default() };
        CourseNode::new(name, &config, share)
    };
    Course::new(vec![node("walk", 1.25, 0.3), node("idle", 0.0, 0.7)], vec![vec![0, 1]])
}

#[test]
fn on_a_single_node_the_blend_stays() {
    let config = EnvironmentConfig::default();
    let course = Course::new(edge().nodes().to_vec(), vec![vec![1]]);
    let mut rng = Rng::new(1, 1);
    let mut command = Command::start(&config, &course, false, &mut rng);
    command.aim(&config, &course, (Vec2::ZERO, 0.0), &mut rng);
    for _ in 0..1000 {
        command.advance(&config, &course, Vec2::ZERO, |_| false, &mut rng);
        assert_eq!(command.place, Place { edge: 0, t: 1.0 });
    }
}

#[test]
fn alone_it_stays_at_the_end_of_an_edge() {
    let config = EnvironmentConfig { alone: true, ..EnvironmentConfig::default() };
    let (course, mut rng) = (edge(), Rng::new(5, 1));
    for _ in 0..20 {
        let mut command = Command::start(&config, &course, false, &mut rng);
        command.aim(&config, &course, (Vec2::ZERO, 0.0), &mut rng);
        for _ in 0..100 {
            command.advance(&config, &course, Vec2::ZERO, |_| false, &mut rng);
            assert_eq!(command.place, Place { edge: 0, t: 1.0 });
        }
    }
}

#[test]
fn blends_and_targets_stay_in_range_and_are_renewed() {
    let (config, course, mut rng) = (EnvironmentConfig::default(), edge(), Rng::new(2, 1));
    let (mut at_child, mut targets, mut count) = (0, 0, 0);
    for _ in 0..200 {
        let mut command = Command::start(&config, &course, false, &mut rng);
        command.aim(&config, &course, (Vec2::ONE, 0.0), &mut rng);
        for _ in 0..150 {
            let before = command.target;
            command.advance(&config, &course, Vec2::ONE, |_| false, &mut rng);
            assert!((0.0..=1.0).contains(&command.place.t));
            assert!(command.target.distance(Vec2::ONE) <= 10.001);
            targets += usize::from(command.target != before);
            at_child += usize::from(command.place.t == 1.0);
            count += 1;
        }
    }
    assert!(targets > 100 && (0.2..0.5).contains(&(at_child as f32 / count as f32)));
}

#[test]
fn a_moving_coordinate_rests_where_it_came_to() {
    let config = EnvironmentConfig {
        edge_sweep_secs: [0.1, 0.1],
        edge_rest_secs: [2.0, 2.0],
        jump: 0.0,
        ..Default::default()
    };
    let (course, mut rng) = (edge(), Rng::new(4, 1));
    let (mut rests, mut moves) = (0, 0);
    for _ in 0..50 {
        let mut command = Command::start(&config, &course, false, &mut rng);
        command.aim(&config, &course, (Vec2::ZERO, 0.0), &mut rng);
        let mut still = 60;
        for _ in 0..300 {
            let before = command.place.t;
            command.advance(&config, &course, Vec2::ZERO, |_| false, &mut rng);
            if command.place.t == before {
                still += 1;
            } else {
                moves += 1;
                // Either on its way, a tenth of a second at most, or after a rest of two seconds.
                assert!(still == 0 || still >= 58, "{still}");
                rests += usize::from(still > 0);
                still = 0;
            }
        }
    }
    assert!(rests > 50 && moves > rests, "{rests} {moves}");
}

#[test]
fn who_comes_from_where_low_is_right_rises_first() {
    let node = |name: &str, fall| {
        CourseNode::new(name, &EnvironmentConfig { fall, ..EnvironmentConfig::default() }, 1.0)
    };
    let nodes = vec![node("crouch", Fall::Upright), node("crawl", Fall::Lying)];
    let course = Course::new(nodes, vec![vec![0, 1]]);
    let config = EnvironmentConfig { sweep: 1.0, sweep_secs: [2.0, 2.0], ..EnvironmentConfig::default() };
    let mut rng = Rng::new(6, 1);
    let mut command = Command::start(&config, &course, false, &mut rng);
    while command.place.t > 0.0 {
        command.advance(&config, &course, Vec2::ZERO, |_| false, &mut rng);
    }
    let mut held = 0;
    for _ in 0..60 {
        command.advance(&config, &course, Vec2::ZERO, |_| true, &mut rng);
        assert!(command.place.t > 0.0 || held == 0);
        held = held.max(command.rising_ticks);
    }
    assert!((1..90).contains(&held) && !command.stuck(), "{held}");
    // Asked to stay up, it is late after a second and stuck after three.
    (command.sweeps, command.rate, command.asked) = (false, 0.0, 0.0);
    (command.coordinate, command.place, command.rising_ticks) = (0.01, course.place(0, 0.01), 0);
    for tick in 1..=95 {
        command.advance(&config, &course, Vec2::ZERO, |_| true, &mut rng);
        assert_eq!((command.is_late(), command.stuck()), (tick >= 30, tick >= 90), "{tick}");
    }
}

#[test]
fn a_sweep_goes_to_both_ends_and_does_not_rest() {
    let config = EnvironmentConfig { sweep: 1.0, sweep_secs: [4.0, 4.0], ..EnvironmentConfig::default() };
    let (course, mut rng) = (edge(), Rng::new(5, 1));
    for _ in 0..20 {
        let mut command = Command::start(&config, &course, false, &mut rng);
        command.aim(&config, &course, (Vec2::ZERO, 0.0), &mut rng);
        let (mut ends, mut still) = ([false; 2], 0);
        for _ in 0..130 {
            let before = command.place.t;
            command.advance(&config, &course, Vec2::ZERO, |_| false, &mut rng);
            ends = [ends[0] || command.place.t == 0.0, ends[1] || command.place.t == 1.0];
            still += usize::from(command.place.t == before);
        }
        assert!(ends == [true; 2] && still <= 4, "{ends:?} {still}");
    }
}

#[test]
fn the_place_follows_what_is_asked_no_faster_than_an_edge_allows() {
    let config = EnvironmentConfig { edge_secs: 1.0, jump: 1.0, stick: 1.0, ..EnvironmentConfig::default() };
    let nodes = [("walk", 1.25), ("idle", 0.0)].map(|(name, speed_mps)| {
        CourseNode::new(name, &EnvironmentConfig { speed_mps, ..config.clone() }, 1.0)
    });
    let (course, mut rng) = (Course::new(nodes.to_vec(), vec![vec![0, 1]]), Rng::new(3, 1));
    let mut moved = 0.0;
    for _ in 0..50 {
        let mut command = Command::start(&config, &course, false, &mut rng);
        command.aim(&config, &course, (Vec2::ZERO, 0.0), &mut rng);
        for tick in 0..300 {
            let (before, position) = (command.place.t, Vec2::splat(tick as f32));
            command.advance(&config, &course, position, |_| false, &mut rng);
            let step = (command.place.t - before).abs();
            assert!(step <= DT_SECS + 1e-6, "{step}");
            moved += step;
            let away = command.target.distance(position);
            assert!(away < 1e-3 || (away - TARGET_RANGE_METRES).abs() < 1e-3, "{away}");
        }
    }
    assert!(moved > 50.0, "{moved}");
}

#[test]
fn who_starts_at_a_node_rests_there_or_goes_to_others() {
    let config = EnvironmentConfig { sweep: 1.0, jump: 0.0, ..EnvironmentConfig::default() };
    let (course, mut rng) = (edge(), Rng::new(9, 1));
    let (mut resting, mut at) = (0, [0; 2]);
    for _ in 0..200 {
        let mut command = Command::start(&config, &course, true, &mut rng);
        at[course.node_at(command.place).expect("at a node")] += 1;
        let before = command.place;
        (0..30).for_each(|_| command.advance(&config, &course, Vec2::ZERO, |_| false, &mut rng));
        resting += usize::from(command.place == before);
        assert!(!command.sweeps);
    }
    assert!((100..180).contains(&resting) && at.iter().all(|count| *count > 30), "{resting} {at:?}");
}
