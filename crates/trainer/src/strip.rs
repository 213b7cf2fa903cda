//! Strips of stick figures, seen from the side: a skill beside its clip, as SVG.

use std::fmt::Write as _;

use glam::Vec3;
use policy_core::{Body, CharacterState, Heading};

/// Pixels of a metre.
const SCALE: f32 = 80.0;

/// Pixels from one figure to the next.
const PITCH: f32 = 78.0;

/// Height of a row, pixels.
const ROW: f32 = 170.0;

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

/// Draws rows of figures. Each figure stands where its pelvis is; the right side is drawn darker than the left.
#[must_use]
pub fn draw(rows: &[Row]) -> String {
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
            let heading = Heading::from_rotation(seen.body(Body::Pelvis).rotation);
            figure(&mut svg, (state, heading), 20.0 + (column as f32 + 0.5) * PITCH, floor);
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// Chains of bodies: left side, trunk, right side, the near one last.
const CHAINS: [(&[Body], &str); 5] = [
    (&[Body::Torso, Body::LeftUpperArm, Body::LeftLowerArm, Body::LeftHand], "#e0a060"),
    (&[Body::Pelvis, Body::LeftThigh, Body::LeftShin, Body::LeftFoot], "#e0a060"),
    (&[Body::Pelvis, Body::Torso, Body::Head], "#444444"),
    (&[Body::Pelvis, Body::RightThigh, Body::RightShin, Body::RightFoot], "#3060a0"),
    (&[Body::Torso, Body::RightUpperArm, Body::RightLowerArm, Body::RightHand], "#3060a0"),
];

fn figure(svg: &mut String, (state, heading): (&CharacterState, Heading), x: f32, floor: f32) {
    let pelvis = state.body(Body::Pelvis);
    let place = |point: Vec3| {
        let local = heading.heading_from_world(point - pelvis.position);
        (x + SCALE * local.x, floor - SCALE * (point.z - state.ground_height))
    };
    let on = |body: Body, offset: Vec3| {
        let b = state.body(body);
        place(b.position + b.rotation * offset)
    };
    for (chain, colour) in CHAINS {
        let mut points: Vec<(f32, f32)> = chain.iter().map(|b| on(*b, Vec3::ZERO)).collect();
        // Arms hang on the shoulders, feet have toes.
        if matches!(chain[1], Body::LeftUpperArm | Body::RightUpperArm) {
            points[0] = on(Body::Torso, Vec3::new(0.0, 0.0, 0.23));
        }
        if let Some(foot @ (Body::LeftFoot | Body::RightFoot)) = chain.last() {
            points.push(on(*foot, Vec3::new(0.0, 0.0, -0.04)));
            points.push(on(*foot, Vec3::new(0.13, 0.0, -0.04)));
        }
        let path: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
        let _ = writeln!(svg, "<path d=\"M{}\" stroke=\"{colour}\" stroke-width=\"4\"/>", path.join("L"));
    }
    let (hx, hy) = on(Body::Head, Vec3::new(0.0, 0.0, 0.175));
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
        let row = Row { caption: "a < b".into(), states: vec![CharacterState::default(); 3], fixed: false };
        let svg = draw(&[row.clone(), Row { fixed: true, ..row }]);
        assert_eq!(svg.matches("<circle").count(), 6);
        assert!(svg.contains("a &lt; b") && svg.ends_with("</svg>\n"));
    }
}
