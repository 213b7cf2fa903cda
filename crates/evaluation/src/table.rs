//! What a player feels as text tables, to read in a terminal.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::PlayerReport;
use super::press::PressReport;
use super::response::TURNS_DEGREES;
use super::stress::{FallReport, SidesReport};

/// Width of the first column, letters.
const NAME: usize = 22;

/// Text tables of what a player feels. Sections that were not measured are left out.
#[must_use]
pub fn table(report: &PlayerReport) -> String {
    let mut text = String::new();
    turns(&mut text, report);
    starts_and_stops(&mut text, report);
    straight(&mut text, report);
    strafe(&mut text, report);
    presses(&mut text, report);
    legs(&mut text, report);
    random_pad(&mut text, report);
    falls(&mut text, "falls a minute on uneven ground", &report.terrain);
    get_up(&mut text, report);
    falls(&mut text, "falls a minute, body and world changed", &report.robustness);
    pushes(&mut text, "push on the torso, newton", &report.push_torso);
    pushes(&mut text, "push on the pelvis, newton", &report.push_pelvis);
    encounters(&mut text, report);
    text
}

/// A line of a name and columns.
fn line(text: &mut String, name: &str, columns: impl IntoIterator<Item = String>) {
    write!(text, "{name:<NAME$}").expect("a string takes any text");
    columns.into_iter().for_each(|column| text.push_str(&column));
    text.push('\n');
}

/// A title with the names of the columns, after an empty line.
fn head<'a>(text: &mut String, title: &str, columns: impl IntoIterator<Item = &'a str>) {
    text.push('\n');
    let columns: Vec<String> = columns.into_iter().map(|name| format!("{:>12}", clip(name))).collect();
    if title.len() < NAME {
        line(text, title, columns);
    } else {
        line(text, title, []);
        line(text, "", columns);
    }
}

fn clip(name: &str) -> &str {
    name.get(..11).unwrap_or(name)
}

/// A number in a column, or a dash.
fn number(value: Option<f32>) -> String {
    value.map_or_else(|| format!("{:>12}", "-"), |value| format!("{value:12.2}"))
}

/// Some of all in a column.
fn share(some: usize, all: usize) -> String {
    format!("{:>12}", format!("{some}/{all}"))
}

fn turns(text: &mut String, report: &PlayerReport) {
    let turns = &report.response.turns;
    if turns.is_empty() {
        return;
    }
    head(
        text,
        "turn",
        ["median, s", "p90, s", "left, s", "right, s", "faces, s", "metres", "never", "falls"],
    );
    for (gait, turns) in turns {
        for degrees in TURNS_DEGREES {
            let Some(turn) = turns.get(&format!("turn_{degrees}")) else { continue };
            let numbers = [
                turn.median_s,
                turn.p90_s,
                turn.left_median_s,
                turn.right_median_s,
                turn.facing_median_s,
                turn.metres,
            ];
            let counts = [turn.never, turn.falls].map(|count| share(count, turn.trials));
            line(text, &format!("{gait} {degrees}"), numbers.map(number).into_iter().chain(counts));
        }
    }
}

fn starts_and_stops(text: &mut String, report: &PlayerReport) {
    if let Some(start) = &report.response.start {
        head(text, "start", ["0.9 m/s, s", "2 m/s, s", "step, s", "crouch, s"]);
        let numbers = [start.walk_s, start.run_s, start.first_step_s, start.crouch_run_s];
        line(text, "idle", numbers.map(number));
    }
    if !report.response.stop.is_empty() {
        head(text, "stop", ["seconds", "metres", "last, m/s", "never", "falls"]);
    }
    for (gait, stop) in &report.response.stop {
        let numbers = [stop.s, stop.m, stop.last_mps].map(number);
        let counts = [stop.never, stop.falls].map(|count| share(count, stop.trials));
        line(text, gait, numbers.into_iter().chain(counts));
    }
}

fn straight(text: &mut String, report: &PlayerReport) {
    for (path, points) in &report.straight {
        let columns = ["wanted, m/s", "is, m/s", "drift, deg", "left, deg", "heading", "falls"];
        head(text, &format!("ahead, {path}"), columns);
        for point in points {
            let numbers = [
                Some(point.commanded_mps),
                point.reached_mps,
                point.drift_degrees,
                point.drift_left_degrees,
                point.heading_degrees,
            ];
            let falls = [share(point.falls, point.trials)];
            line(text, &format!("{:.2}", point.coordinate), numbers.map(number).into_iter().chain(falls));
        }
    }
}

fn strafe(text: &mut String, report: &PlayerReport) {
    if !report.strafe.is_empty() {
        head(text, "strafe", ["is, m/s", "drift, deg", "heading", "camera, s", "falls"]);
    }
    for (way, strafe) in &report.strafe {
        let numbers =
            [strafe.reached_mps, strafe.drift_degrees, strafe.heading_degrees, strafe.camera_turn_s];
        let falls = [share(strafe.falls, strafe.trials)];
        line(text, way, numbers.map(number).into_iter().chain(falls));
    }
}

fn presses(text: &mut String, report: &PlayerReport) {
    if let Some(rise) = &report.crawl_to_upright {
        head(text, "crawl to upright", ["by itself", "by a skill", "median, s", "itself, s"]);
        let counts = [rise.by_itself, rise.by_skill].map(|count| share(count, rise.trials));
        line(text, "", counts.into_iter().chain([rise.median_s, rise.by_itself_median_s].map(number)));
    }
    if !report.button_presses.is_empty() {
        head(text, "press", ["started", "refused", "succeeded", "median, s", "low", "falls"]);
    }
    for (gait, buttons) in &report.button_presses {
        for press in buttons.values().filter(|press| press.skill.is_some()) {
            line(
                text,
                &format!("{gait} {}", press.skill.as_deref().unwrap_or_default()),
                press_columns(press),
            );
        }
    }
    if let Some(jump) = &report.joint_target_jump {
        head(text, "joint target jump, rad", ["at start", "at end", "otherwise"]);
        line(text, "", [jump.skill_start_rad, jump.skill_end_rad, jump.otherwise_rad].map(number));
    }
}

fn press_columns(press: &PressReport) -> [String; 6] {
    let count = |count| share(count, press.trials);
    let [started, refused, succeeded] = [press.started, press.refused, press.succeeded].map(count);
    [started, refused, succeeded, number(press.median_s), count(press.low), count(press.falls)]
}

fn legs(text: &mut String, report: &PlayerReport) {
    if report.foot_slide_mps.is_empty() {
        return;
    }
    head(text, "legs", ["slide, m/s", "overlap", "depth, m"]);
    let measures = [&report.foot_slide_mps, &report.self_overlap, &report.self_overlap_depth_m];
    for gait in report.foot_slide_mps.keys() {
        line(text, gait, measures.map(|measure| number(measure.get(gait).copied())));
    }
}

fn random_pad(text: &mut String, report: &PlayerReport) {
    if !report.random_pad.is_empty() {
        head(text, "pad at random", ["falls/min", "rises/min", "down"]);
    }
    for (kind, pad) in &report.random_pad {
        let numbers = [pad.falls_per_minute, pad.rises_by_skill_per_minute, pad.down];
        line(text, kind, numbers.map(|value| number(Some(value))));
    }
}

fn falls(text: &mut String, title: &str, cases: &BTreeMap<String, BTreeMap<String, FallReport>>) {
    let Some(first) = cases.values().next() else { return };
    head(text, title, first.keys().map(String::as_str));
    for (case, gaits) in cases {
        line(text, case, gaits.values().map(|falls| number(Some(falls.falls_per_minute))));
    }
}

fn get_up(text: &mut String, report: &PlayerReport) {
    if !report.terrain_get_up.is_empty() {
        head(text, "get up", ["success", "falls again", "median, s"]);
    }
    for (ground, get_up) in &report.terrain_get_up {
        line(text, ground, [Some(get_up.success), Some(get_up.falls_again), get_up.median_s].map(number));
    }
}

fn pushes(text: &mut String, title: &str, gaits: &BTreeMap<String, SidesReport>) {
    if !gaits.is_empty() {
        head(text, title, ["forward", "backward", "left", "right"]);
    }
    for (gait, sides) in gaits {
        let newtons = [sides.forward_newton, sides.backward_newton, sides.left_newton, sides.right_newton];
        line(text, gait, newtons.map(|newton| format!("{newton:12.0}")));
    }
}

fn encounters(text: &mut String, report: &PlayerReport) {
    if !report.encounters.is_empty() {
        head(text, "encounter", ["characters", "stays up", "gets up", "arrives"]);
    }
    for (name, met) in &report.encounters {
        let shares = [Some(met.stays_up), met.gets_up, met.arrives].map(number);
        line(text, name, [format!("{:>12}", met.characters)].into_iter().chain(shares));
    }
    if let Some(race) = &report.race {
        head(text, "race", ["no fall", "finished", "seconds"]);
        let counts = [race.without_a_fall, race.finished].map(|count| share(count, race.runs));
        line(text, "", counts.into_iter().chain([number(race.secs)]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::TurnReport;

    #[test]
    fn nothing_measured_is_no_text() {
        assert_eq!(table(&PlayerReport::default()), "");
    }

    #[test]
    fn a_turn_that_never_ends_is_a_dash() {
        let turn =
            TurnReport { median_s: None, p90_s: Some(2.5), never: 3, trials: 4, ..TurnReport::default() };
        let mut report = PlayerReport::default();
        report.response.turns.insert("walk".into(), [("turn_90".into(), turn)].into());
        let text = table(&report);
        let words: Vec<&str> = text.lines().last().unwrap().split_whitespace().collect();
        assert_eq!(words, ["walk", "90", "-", "2.50", "-", "-", "-", "-", "3/4", "0/4"]);
    }
}
