//! Strips of stick figures, seen from the side: a skill beside its clip, as SVG.

use std::fmt::Write as _;

use glam::Vec3;
use policy_core::{BodyId, CharacterState, Heading, Skeleton};

/// Pixels of a metre.
const SCALE: f32 = 80.0;

/// Pixels from one figure to the next.
const PITCH: f32 = 78.0;

/// Height of a row, pixels.
const ROW: f32 = 170.0;

/// Tip of a foot in its frame, metres.
const TOES: Vec3 = Vec3::new(0.13, 0.0, -0.04);

/// One row of figures.
#[derive(Clone, Debug)]
pub struct Row {
    /// What it says beside it.
    pub caption: String,
    /// One figure for each state.
    pub states: Vec<CharacterState>,
    /// True to see all figures from the first one's right, false to see each from its own: a character that goes over its
    /// head has no heading half-way.
    pub fixed: bool,
}

/// Draws rows of figures. Each figure stands where its root is; the right side is drawn darker than the left.
#[must_use]
pub fn draw(skeleton: &Skeleton, rows: &[Row]) -> String {
    let columns = rows.iter().map(|r| r.states.len()).max().unwrap_or(0) as f32;
    let (width, height) = (40.0 + columns * PITCH, rows.len() as f32 * ROW);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" stroke-linecap=\"round\" stroke-linejoin=\"round\" fill=\"none\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    for (index, row) in rows.iter().enumerate() {
        let floor = (index as f32 + 1.0) * ROW - 12.0;
        let _ = writeln!(
            svg,
            "<path d=\"M0 {floor}H{width}\" stroke=\"#bbbbbb\"/>\n\
             <text x=\"6\" y=\"{}\" fill=\"#333333\" font-family=\"sans-serif\" font-size=\"13\">{}</text>",
            floor - ROW + 28.0,
            escaped(&row.caption),
        );
        for (column, state) in row.states.iter().enumerate() {
            let seen = if row.fixed { &row.states[0] } else { state };
            let heading = Heading::from_rotation(seen.root().rotation);
            figure(&mut svg, skeleton, (state, heading), 20.0 + (column as f32 + 0.5) * PITCH, floor);
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// Colour of a body by its side.
fn colour(name: &str) -> &'static str {
    match (name.contains("left"), name.contains("right")) {
        (true, _) => "#e0a060",
        (_, true) => "#3060a0",
        _ => "#444444",
    }
}

/// A line from each body to its parent, the left side first and the right side over the rest.
fn figure(
    svg: &mut String,
    skeleton: &Skeleton,
    (state, heading): (&CharacterState, Heading),
    x: f32,
    floor: f32,
) {
    let root = state.root();
    let point = |position: Vec3| {
        let local = heading.heading_from_world(position - root.position);
        (x + SCALE * local.x, floor - SCALE * (position.z - state.ground_height))
    };
    let mut line = |from: Vec3, to: Vec3, colour: &str| {
        let ((x0, y0), (x1, y1)) = (point(from), point(to));
        let _ = writeln!(
            svg,
            "<path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" stroke=\"{colour}\" stroke-width=\"4\"/>"
        );
    };
    let mut bodies: Vec<BodyId> = (0..skeleton.body_count()).map(BodyId::new).collect();
    let name = |id: BodyId| &skeleton.body(id).name;
    bodies.sort_by_key(|id| (name(*id).contains("right"), !name(*id).contains("left")));
    for id in bodies {
        let body = state.body(id);
        if let Some(parent) = skeleton.parent(id) {
            line(state.body(parent).position, body.position, colour(name(id)));
        }
        if skeleton.feet().contains(&id) {
            line(body.position, body.position + body.rotation * TOES, colour(name(id)));
        }
    }
    let head = skeleton.head().map_or(root.position, |head| state.body(head).position);
    let (hx, hy) = point(head);
    let _ = writeln!(svg, "<circle cx=\"{hx:.1}\" cy=\"{hy:.1}\" r=\"7.5\" fill=\"#444444\"/>");
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_state_is_a_figure() {
        let row = Row {
            caption: "a < b".into(),
            states: vec![CharacterState::new(&Skeleton::humanoid()); 3],
            fixed: false,
        };
        let svg = draw(&Skeleton::humanoid(), &[row.clone(), Row { fixed: true, ..row }]);
        assert_eq!(svg.matches("<circle").count(), 6);
        assert!(svg.contains("a &lt; b") && svg.ends_with("</svg>\n"));
    }
}
