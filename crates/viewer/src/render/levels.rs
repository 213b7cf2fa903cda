//! Level of detail: which mesh each figure is drawn with, by its size on the screen, and which figures are in the picture.

use std::ops::Range;

use glam::{Mat4, Vec3, Vec4Swizzles};

use super::config::RenderConfig;
use super::scene::{Figure, Scene};

/// Finest level that shadows are drawn with. A shadow's edge is softer than the mesh of that level is coarse.
const FINEST_OF_SHADOWS: usize = 2;

/// Figures side by side by their level.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Arranged {
    /// Indices of the figures that are drawn: those in the picture from the finest level on, then those that only throw shadows.
    pub(super) order: Vec<usize>,
    /// Where in the order each level lies.
    pub(super) levels: Vec<Range<u32>>,
    /// Where those lie that only throw shadows.
    pub(super) hidden: Range<u32>,
}

impl Arranged {
    /// The figures of a scene, for a mesh of so many levels and this size in metres, and a picture so many pixels wide and high.
    pub(super) fn new(
        scene: &Scene,
        [width, height]: [u32; 2],
        config: &RenderConfig,
        (levels, metres): (usize, f32),
    ) -> Self {
        let aspect = width as f32 / height.max(1) as f32;
        let planes = planes(scene.view.clip_from_world(aspect));
        let pixels_at_a_metre = metres * height as f32 / (2.0 * (0.5 * scene.view.fov).tan());
        let bucket = |figure: &Figure| {
            let centre = figure.positions[0];
            let shown = !scene.hide_figures && planes.iter().all(|plane| is_inside(*plane, centre, metres));
            if !shown {
                return (centre.distance(scene.focus) < config.shadow_reach_m + metres).then_some(levels);
            }
            let pixels = pixels_at_a_metre / centre.distance(scene.view.eye).max(0.1);
            let level = config.level_pixels.iter().take_while(|least| pixels < **least).count();
            Some(level.min(levels.saturating_sub(1)))
        };
        let buckets: Vec<Option<usize>> = scene.figures.iter().map(bucket).collect();
        let mut order = Vec::with_capacity(scene.figures.len());
        let mut of = |bucket: usize| {
            let begin = order.len() as u32;
            order.extend((0..buckets.len()).filter(|index| buckets[*index] == Some(bucket)));
            begin..order.len() as u32
        };
        let (ranges, hidden) = ((0..levels).map(&mut of).collect(), of(levels));
        Self { order, levels: ranges, hidden }
    }

    /// Level of the shadows and figures that throw them, for a mesh of so many levels.
    pub(super) fn shadows(&self, levels: usize) -> impl Iterator<Item = (usize, Range<u32>)> {
        let last = levels.saturating_sub(1);
        let of_shown = move |(level, range): (usize, &Range<u32>)| {
            ((level + 1).max(FINEST_OF_SHADOWS).min(last), range.clone())
        };
        let shown = self.levels.iter().enumerate().map(of_shown);
        shown.chain([(last, self.hidden.clone())]).filter(|(_, figures)| !figures.is_empty())
    }
}

/// The sides of what a picture shows; each is positive inside.
fn planes(clip_from_world: Mat4) -> [glam::Vec4; 5] {
    let [x, y, z, w] = [0, 1, 2, 3].map(|row| clip_from_world.row(row));
    [w + x, w - x, w + y, w - y, z]
}

fn is_inside(plane: glam::Vec4, centre: Vec3, radius: f32) -> bool {
    let normal = plane.xyz();
    normal.dot(centre) + plane.w > -radius * normal.length()
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::render::View;

    fn figure(x: f32, y: f32) -> Figure {
        Figure {
            positions: vec![Vec3::new(x, y, 0.9)],
            rotations: vec![Quat::IDENTITY],
            tint: [0.0; 4],
            ground: 0.0,
            slope: [0.0; 2],
        }
    }

    fn scene(figures: Vec<Figure>) -> Scene {
        let view = View { eye: Vec3::new(0.0, 0.0, 0.9), target: Vec3::new(10.0, 0.0, 0.9), fov: 0.7 };
        Scene { view, focus: view.eye, figures, ..Scene::default() }
    }

    fn arranged(scene: &Scene) -> Arranged {
        let config = RenderConfig { level_pixels: [400.0, 100.0, 50.0], ..RenderConfig::default() };
        Arranged::new(scene, [1280, 720], &config, (4, 1.8))
    }

    #[test]
    fn near_figures_are_fine_and_far_ones_coarse() {
        // 1.8 m at 0.7 radians and 720 pixels: 1775 pixels a metre away.
        let found =
            arranged(&scene(vec![figure(40.0, 0.0), figure(3.0, 0.0), figure(10.0, 0.0), figure(20.0, 1.0)]));
        assert_eq!(found.order, [1, 2, 3, 0]);
        assert_eq!(found.levels, [0..1, 1..2, 2..3, 3..4]);
        assert_eq!(found.hidden, 4..4);
        assert_eq!(found.shadows(4).collect::<Vec<_>>(), [(2, 0..1), (2, 1..2), (3, 2..3), (3, 3..4)]);
    }

    #[test]
    fn figures_beside_the_picture_throw_shadows_where_these_reach() {
        let found =
            arranged(&scene(vec![figure(-5.0, 0.0), figure(5.0, 0.0), figure(-50.0, 0.0), figure(5.0, 2.5)]));
        assert_eq!(found.order, [1, 3, 0], "the last one is half in the picture");
        assert_eq!((found.levels[1].clone(), found.hidden.clone()), (0..2, 2..3));
        assert_eq!(found.shadows(4).last(), Some((3, 2..3)));
    }

    #[test]
    fn hidden_figures_keep_their_shadows_and_a_mesh_of_one_level_is_enough() {
        let mut scene = scene(vec![figure(5.0, 0.0)]);
        let config = RenderConfig::default();
        let found = Arranged::new(&scene, [640, 360], &config, (1, 1.8));
        assert_eq!(found.shadows(1).collect::<Vec<_>>(), [(0, 0..1)]);
        assert_eq!((found.levels[0].len(), found.hidden.len()), (1, 0));
        scene.hide_figures = true;
        let found = Arranged::new(&scene, [640, 360], &config, (1, 1.8));
        assert_eq!((found.levels[0].len(), found.hidden.len()), (0, 1));
        assert_eq!(found.shadows(1).collect::<Vec<_>>(), [(0, 0..1)]);
    }
}
