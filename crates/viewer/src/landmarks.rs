//! Posts that stand about far apart, so that speed and hills can be read. They are drawn only: nothing meets them.

use glam::{Mat4, Quat, Vec2, Vec3};

use crate::render::{Marker, Scene, Solid};

/// From one to the next, metres. The first ones are half as far from the origin, out of the playground.
const APART_M: f32 = 40.0;
/// Farther away there are none, metres: haze hides them there.
const FAR_M: f32 = 80.0;
/// So far from the origin the ground ends for every character, metres.
const END_M: f32 = 1e6;
/// Marks of the things that carry them.
const EDGES: f32 = 1.0;
const OCTANTS: f32 = 0.5;
const COLOURS: [[f32; 3]; 4] =
    [[0.62, 0.12, 0.08], [0.70, 0.48, 0.08], [0.10, 0.32, 0.50], [0.62, 0.62, 0.60]];

/// Adds the posts around a point, metres, on ground of the height that `height_at` says.
pub fn posts(scene: &mut Scene, around: Vec2, height_at: impl Fn(Vec2) -> f32) {
    if !around.is_finite() || around.length() > END_M {
        return;
    }
    let reach = (FAR_M / APART_M).ceil() as i32;
    let cell = (around / APART_M).floor().as_ivec2();
    for x in cell.x - reach..=cell.x + reach {
        for y in cell.y - reach..=cell.y + reach {
            let at = (glam::IVec2::new(x, y).as_vec2() + 0.5) * APART_M;
            if at.distance(around) > FAR_M {
                continue;
            }
            // Each cell always has the same post.
            let mixed = (x as u32).wrapping_mul(0x9e37_79b9) ^ (y as u32).wrapping_mul(0x85eb_ca6b);
            let mixed = mixed.wrapping_mul(0xc2b2_ae35) >> 16;
            post(
                scene,
                at.extend(height_at(at)),
                2.4 + 0.6 * (mixed & 3) as f32,
                COLOURS[(mixed >> 2 & 3) as usize],
            );
        }
    }
}

/// A post of a height, with a ball on top.
fn post(scene: &mut Scene, foot: Vec3, height: f32, [r, g, b]: [f32; 3]) {
    let mut add = |solid, scale: Vec3, up: f32, marks: f32| {
        let place = Mat4::from_scale_rotation_translation(scale, Quat::IDENTITY, foot + Vec3::Z * up);
        scene.things.push(Marker { solid, place, colour: [r, g, b, marks] });
    };
    add(Solid::Drum, Vec3::new(0.1, 0.1, 0.5 * height), 0.5 * height, EDGES);
    add(Solid::Ball, Vec3::splat(0.4), height + 0.35, OCTANTS);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(at: Vec2) -> Vec<Vec3> {
        let mut scene = Scene::default();
        posts(&mut scene, at, |_| 0.25);
        scene.things.iter().map(|thing| thing.place.w_axis.truncate()).collect()
    }

    #[test]
    fn posts_keep_their_place_while_one_walks_by_and_stand_on_the_ground() {
        let (here, there) = (around(Vec2::ZERO), around(Vec2::new(7.0, -3.0)));
        let near = |at: &&Vec3| at.truncate().length() < 60.0;
        assert!(here.iter().filter(near).count() >= 8);
        assert!(here.iter().filter(near).all(|at| there.contains(at)));
        // The lower half of a post is above the ground below it.
        assert!(here.iter().all(|at| at.z > 0.25 + 1.0), "{here:?}");
        // None within the walls of the playground.
        assert!(here.iter().all(|at| at.y.abs() > 12.0));
        assert!(around(Vec2::NAN).is_empty());
    }
}
