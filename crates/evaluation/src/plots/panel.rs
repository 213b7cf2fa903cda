//! The two kinds of plots on the page: grouped bars, and lines over a path.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::PlotError;

/// Where plots are drawn.
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Colours of columns and lines, in their order.
const COLOURS: [RGBColor; 6] = [
    RGBColor(31, 119, 180),
    RGBColor(255, 127, 14),
    RGBColor(44, 160, 44),
    RGBColor(214, 39, 40),
    RGBColor(148, 103, 189),
    RGBColor(140, 86, 75),
];

/// Share of a row that its bars fill.
const FILL: f64 = 0.8;

/// Horizontal bars: a row for each name, in it a bar for each column.
pub(super) struct Bars {
    title: &'static str,
    columns: Vec<String>,
    rows: Vec<(String, Vec<Option<f32>>)>,
}

impl Bars {
    pub(super) fn new<'a>(
        title: &'static str,
        columns: impl IntoIterator<Item = &'a str>,
        rows: impl IntoIterator<Item = (String, Vec<Option<f32>>)>,
    ) -> Self {
        let columns = columns.into_iter().map(Into::into).collect();
        // The first row is drawn at the bottom.
        let mut rows: Vec<_> = rows.into_iter().collect();
        rows.reverse();
        Self { title, columns, rows }
    }

    /// Each bar: its column, its lower and upper edge, and its length.
    fn bars(&self) -> impl Iterator<Item = (usize, f64, f64, f64)> {
        let height = FILL / self.columns.len().max(1) as f64;
        self.rows.iter().enumerate().flat_map(move |(row, (_, values))| {
            let top = row as f64 + 0.5 * (1.0 + FILL);
            let bar = move |(column, value): (usize, &Option<f32>)| {
                let upper = top - column as f64 * height;
                value.map(|value| (column, upper - height, upper, f64::from(value)))
            };
            values.iter().enumerate().filter_map(bar)
        })
    }

    pub(super) fn draw(&self, area: &Area<'_>) -> Result<(), PlotError> {
        let longest = self.bars().map(|bar| bar.3).fold(0.0, f64::max);
        let end = if longest > 0.0 { 1.05 * longest } else { 1.0 };
        let mut chart = ChartBuilder::on(area)
            .caption(self.title, ("sans-serif", 16))
            .margin(10)
            .x_label_area_size(24)
            .y_label_area_size(110)
            .build_cartesian_2d(0.0..end, 0.0..self.rows.len().max(1) as f64)?;
        // Labels stand at whole numbers, names half-way between them: they are drawn by hand.
        chart
            .configure_mesh()
            .disable_y_mesh()
            .light_line_style(TRANSPARENT)
            .y_labels(0)
            .x_labels(6)
            .draw()?;
        for (row, (name, _)) in self.rows.iter().enumerate() {
            let style = ("sans-serif", 12).into_text_style(area).pos(right_aligned());
            let (x, y) = chart.backend_coord(&(0.0, row as f64 + 0.5));
            let (left, top) = area.get_base_pixel();
            area.draw(&Text::new(name.as_str(), (x - left - 6, y - top), style))?;
        }
        for (column, name) in self.columns.iter().enumerate() {
            let colour = COLOURS[column % COLOURS.len()];
            let bars = self.bars().filter(|bar| bar.0 == column);
            let series = bars.map(|(_, lower, upper, length)| {
                Rectangle::new([(0.0, lower), (length, upper)], colour.filled())
            });
            let drawn = chart.draw_series(series)?;
            if self.columns.len() > 1 {
                let key = move |(x, y)| Rectangle::new([(x, y - 4), (x + 10, y + 4)], colour.filled());
                drawn.label(name.as_str()).legend(key);
            }
        }
        if self.columns.len() > 1 && !self.rows.is_empty() {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.7))
                .draw()?;
        }
        Ok(())
    }
}

fn right_aligned() -> plotters::style::text_anchor::Pos {
    use plotters::style::text_anchor::{HPos, Pos, VPos};
    Pos::new(HPos::Right, VPos::Center)
}

/// Lines with a name.
pub(super) struct Lines {
    pub title: &'static str,
    pub x_title: &'static str,
    pub lines: Vec<(String, Vec<(f32, f32)>)>,
}

impl Lines {
    pub(super) fn draw(&self, area: &Area<'_>) -> Result<(), PlotError> {
        let points = || self.lines.iter().flat_map(|(_, points)| points);
        let end = points().map(|point| point.0).fold(1.0, f32::max);
        let top = 1.05 * points().map(|point| point.1).fold(1.0, f32::max);
        let mut chart = ChartBuilder::on(area)
            .caption(self.title, ("sans-serif", 16))
            .margin(10)
            .x_label_area_size(34)
            .y_label_area_size(40)
            .build_cartesian_2d(0.0..end, 0.0..top)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .x_desc(self.x_title)
            .x_labels(7)
            .y_labels(6)
            .draw()?;
        for (index, (name, points)) in self.lines.iter().enumerate() {
            let colour = COLOURS[index % COLOURS.len()];
            let series =
                chart.draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))?;
            let key = move |(x, y)| Rectangle::new([(x, y - 1), (x + 10, y + 1)], colour.filled());
            series.label(name.as_str()).legend(key);
        }
        if !self.lines.is_empty() {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.7))
                .draw()?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_of_a_row_lie_side_by_side_and_missing_ones_leave_a_gap() {
        let rows = [("a".into(), vec![Some(1.0), None]), ("b".into(), vec![Some(2.0), Some(3.0)])];
        let bars: Vec<_> = Bars::new("", ["x", "y"], rows).bars().collect();
        // Row b is at the bottom.
        assert_eq!(bars.iter().map(|bar| (bar.0, bar.3)).collect::<Vec<_>>(), [(0, 2.0), (1, 3.0), (0, 1.0)]);
        assert!((bars[0].1 - bars[1].2).abs() < 1e-9, "the second begins where the first ends");
        assert!(bars.iter().all(|bar| bar.2 > bar.1) && bars[0].2 < 1.0 && bars[2].1 > 1.0);
    }
}
