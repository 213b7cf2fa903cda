//! A map as a picture: the points of each policy, the edges between policies and a legend.

use std::path::Path;

use plotters::prelude::*;

use crate::plots::PlotError;

/// Draws the points of each policy in its own colour, and lines between policies.
pub(super) fn draw(
    path: &Path,
    title: &str,
    names: &[&str],
    points: &[Vec<[f64; 2]>],
    edges: &[[usize; 2]],
) -> Result<(), PlotError> {
    let range = |axis: usize| {
        let all = points.iter().flatten().map(|p| p[axis]);
        let (low, high) = all.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        let margin = 0.05 * (high - low).max(1e-3);
        // Room for the legend on the right, where it covers nothing.
        low - margin..high + if axis == 0 { 6.0 * margin } else { margin }
    };
    let root = SVGBackend::new(path, (800, 600)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 20))
        .margin(10)
        .x_label_area_size(30)
        .y_label_area_size(45)
        .build_cartesian_2d(range(0), range(1))?;
    chart.configure_mesh().disable_mesh().x_desc("first component").y_desc("second component").draw()?;
    let size = if edges.is_empty() { 2 } else { 6 };
    for edge in edges {
        let ends = edge.iter().filter_map(|node| points[*node].first()).map(|p| (p[0], p[1]));
        chart.draw_series(LineSeries::new(ends, BLACK.mix(0.4)))?;
    }
    for (i, (name, points)) in names.iter().zip(points).enumerate() {
        let colour = Palette99::pick(i).to_rgba();
        chart
            .draw_series(points.iter().map(|p| Circle::new((p[0], p[1]), size, colour.filled())))?
            .label(*name)
            .legend(move |(x, y)| Circle::new((x + 8, y), 5, colour.filled()));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    root.present()?;
    Ok(())
}
