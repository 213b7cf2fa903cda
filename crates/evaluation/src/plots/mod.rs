//! One page of plots of what a player feels, as SVG.

mod panel;

use std::collections::BTreeMap;

use plotters::coord::Shift;
use plotters::prelude::*;

use self::panel::{Bars, Lines};
use super::PlayerReport;
use super::response::StraightPoint;
use super::stress::{FallReport, SidesReport};

/// Why a picture can't be drawn.
pub type PlotError = DrawingAreaErrorKind<std::io::Error>;

/// What a page is drawn on.
type Page<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Size of the page, pixels.
const PAGE: (u32, u32) = (1260, 1800);

/// A page of twelve plots as SVG; those that were not measured stay empty.
///
/// # Errors
/// When a plot can't be drawn.
pub fn draw(report: &PlayerReport) -> Result<String, PlotError> {
    let mut svg = String::new();
    draw_page(report, &SVGBackend::with_string(&mut svg, PAGE).into_drawing_area())?;
    Ok(svg)
}

fn draw_page(report: &PlayerReport, root: &Page<'_>) -> Result<(), PlotError> {
    root.fill(&WHITE)?;
    let areas = root.split_evenly((4, 3));
    let cases =
        pick(&report.robustness, &["latency_1_tick", "strength_x0.8", "timestep_x2", "action_noise_0.1"]);
    let bars = [
        turns(report),
        turn_metres(report),
        stops(report),
        falls("falls a minute on uneven ground", &report.terrain),
        falls("falls a minute, body and world changed", &cases),
        random_pad(report),
        sides("push on the torso, newton", &report.push_torso),
        sides("push on the pelvis, newton", &report.push_pelvis),
        one("foot slide under load, m/s", &report.foot_slide_mps),
        one("legs inside each other, share of ticks", &report.self_overlap),
    ];
    let (lines, others) = areas.split_at(2);
    straight(report, "off the asked direction, degrees", |point| point.drift_degrees).draw(&lines[0])?;
    let reached = |point: &StraightPoint| Some(point.reached_mps? / some_speed(point.commanded_mps)?);
    straight(report, "speed reached, share of the commanded", reached).draw(&lines[1])?;
    for (bars, area) in bars.iter().zip(others) {
        bars.draw(area)?;
    }
    root.present()?;
    Ok(())
}

/// A speed that is worth a share.
fn some_speed(mps: f32) -> Option<f32> {
    (mps > 0.1).then_some(mps)
}

fn turns(report: &PlayerReport) -> Bars {
    let (columns, half) = (["90 degrees", "180 degrees"], ["turn_90", "turn_180"]);
    let rows = report.response.turns.iter().map(|(gait, turns)| {
        (gait.clone(), half.map(|key| turns.get(key).and_then(|turn| turn.median_s)).to_vec())
    });
    Bars::new("turn, median seconds (none: never)", columns, rows)
}

fn turn_metres(report: &PlayerReport) -> Bars {
    let rows = report
        .response
        .turns
        .iter()
        .map(|(gait, turns)| (gait.clone(), vec![turns.get("turn_180").and_then(|turn| turn.metres)]));
    Bars::new("carried on in a turn of 180 degrees, metres", ["metres"], rows)
}

fn stops(report: &PlayerReport) -> Bars {
    let rows = report.response.stop.iter().map(|(gait, stop)| (gait.clone(), vec![stop.s, stop.m]));
    Bars::new("stop", ["seconds", "metres"], rows)
}

fn random_pad(report: &PlayerReport) -> Bars {
    let rows = report.random_pad.iter().map(|(kind, pad)| (kind.clone(), vec![Some(pad.falls_per_minute)]));
    Bars::new("pad at random, falls a minute", ["falls"], rows)
}

/// Some of the cases.
fn pick<T: Clone>(cases: &BTreeMap<String, T>, names: &[&str]) -> BTreeMap<String, T> {
    let chosen = cases.iter().filter(|(name, _)| names.contains(&name.as_str()));
    chosen.map(|(name, case)| (name.clone(), case.clone())).collect()
}

/// Cases as columns, gaits as rows.
fn falls(title: &'static str, cases: &BTreeMap<String, BTreeMap<String, FallReport>>) -> Bars {
    let gaits = cases.values().next().map(|gaits| gaits.keys().cloned().collect::<Vec<_>>());
    let rows = gaits.unwrap_or_default().into_iter().map(|gait| {
        let of_gait =
            |case: &BTreeMap<String, FallReport>| case.get(&gait).map(|falls| falls.falls_per_minute);
        let values = cases.values().map(of_gait).collect();
        (gait, values)
    });
    Bars::new(title, cases.keys().map(String::as_str), rows)
}

fn sides(title: &'static str, gaits: &BTreeMap<String, SidesReport>) -> Bars {
    let rows = gaits.iter().map(|(gait, sides)| {
        let newtons = [sides.forward_newton, sides.backward_newton, sides.left_newton, sides.right_newton];
        (gait.clone(), newtons.map(Some).to_vec())
    });
    Bars::new(title, ["forward", "backward", "left", "right"], rows)
}

fn one(title: &'static str, gaits: &BTreeMap<String, f32>) -> Bars {
    Bars::new(title, [""], gaits.iter().map(|(gait, value)| (gait.clone(), vec![Some(*value)])))
}

fn straight(
    report: &PlayerReport,
    title: &'static str,
    value: impl Fn(&StraightPoint) -> Option<f32>,
) -> Lines {
    let line = |points: &[StraightPoint]| {
        points.iter().filter_map(|point| Some((point.coordinate, value(point)?))).collect()
    };
    let lines = report.straight.iter().map(|(path, points)| (path.clone(), line(points))).collect();
    Lines { title, x_title: "coordinate", lines }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_drawn_of_whatever_was_measured() {
        let empty = draw(&PlayerReport::default()).unwrap();
        let mut report = PlayerReport::default();
        report.foot_slide_mps.insert("moonwalk".into(), 0.7);
        let page = draw(&report).unwrap();
        assert!(empty.contains("foot slide") && !empty.contains("moonwalk"));
        assert!(page.contains("moonwalk") && page.trim_end().ends_with("</svg>"));
    }
}
