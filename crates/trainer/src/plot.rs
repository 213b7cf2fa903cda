//! Training curves as SVG, drawn from a run's `metrics.csv`.

use std::path::Path;

use anyhow::{Context, Result};
use plotters::prelude::*;

use files::write_atomically;

/// Curves that are drawn: column of the metrics, and what it says.
const CURVES: [(&str, &str); 6] = [
    ("style", "style reward"),
    ("task", "task reward"),
    ("speed_error", "speed error, m/s"),
    ("episode_ticks", "episode, ticks"),
    ("discriminator_accuracy", "discriminator accuracy"),
    ("distance", "squared distance to the parent"),
];

/// Draws the curves of `metrics` to `svg`.
///
/// # Errors
/// When the metrics can't be read or the picture can't be written.
pub fn draw(metrics: &Path, svg: &Path) -> Result<()> {
    let text =
        std::fs::read_to_string(metrics).with_context(|| format!("cannot read {}", metrics.display()))?;
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|l| l.split(',').map(|v| v.parse().unwrap_or(f64::NAN)).collect()).collect();
    let mut drawn = String::new();
    draw_curves(&header, &rows, &mut drawn)?;
    write_atomically(svg, drawn.as_bytes()).with_context(|| format!("cannot write {}", svg.display()))
}

fn draw_curves(header: &[&str], rows: &[Vec<f64>], svg: &mut String) -> Result<()> {
    let root = SVGBackend::with_string(svg, (1000, 900)).into_drawing_area();
    root.fill(&WHITE)?;
    for ((name, caption), area) in CURVES.iter().zip(root.split_evenly((3, 2))) {
        let Some(column) = header.iter().position(|h| h == name) else { continue };
        let points = smoothed(rows, column);
        let most = points.iter().map(|p| p.1).fold(0.0, f64::max).max(1e-6) * 1.05;
        let end = points.last().map_or(1.0, |p| p.0).max(1e-6);
        let mut chart = ChartBuilder::on(&area)
            .caption(*caption, ("sans-serif", 18))
            .margin(8)
            .x_label_area_size(28)
            .y_label_area_size(48)
            .build_cartesian_2d(0.0..end, 0.0..most)?;
        chart.configure_mesh().x_desc("million samples").draw()?;
        chart.draw_series(LineSeries::new(points, &BLUE))?;
    }
    root.present()?;
    Ok(())
}

/// Million samples and the mean of a column over ten iterations.
fn smoothed(rows: &[Vec<f64>], column: usize) -> Vec<(f64, f64)> {
    let value = |row: &Vec<f64>, i: usize| row.get(i).copied().filter(|v| v.is_finite());
    rows.chunks(10)
        .filter_map(|chunk| {
            let x = value(chunk.last()?, 0)? / 1e6;
            let values: Vec<f64> = chunk.iter().filter_map(|r| value(r, column)).collect();
            (!values.is_empty()).then(|| (x, values.iter().sum::<f64>() / values.len() as f64))
        })
        .collect()
}
