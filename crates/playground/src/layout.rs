//! Fixtures made of cuboids, and how high the ground of a scene is.

use glam::{Quat, Vec2, Vec3};
use policy_core::contract::{Fixture, FixtureShape, Solid};

use super::{Paint, PaintedFixture, Playground};

/// Fixtures as they are put together.
#[derive(Default)]
pub(super) struct Blocks(pub(super) Vec<PaintedFixture>);

impl Blocks {
    /// A cuboid of a size about a point.
    pub(super) fn cuboid(&mut self, middle: Vec3, size: Vec3, rotation: Quat, paint: Paint) {
        let solid = Solid::Cuboid { half_extents: 0.5 * size };
        let fixture = Fixture { rotation, ..Fixture::new(solid, middle) };
        self.0.push(PaintedFixture { fixture, paint });
    }

    /// So many steps up from a foot, each as deep, wide and high as `size`. Each is solid down to the foot.
    pub(super) fn stairs(&mut self, (foot, turn): (Vec3, Quat), steps: usize, size: Vec3, paint: Paint) {
        for step in 0..steps {
            let height = (step + 1) as f32 * size.z;
            let middle = foot + turn * Vec3::new((step as f32 + 0.5) * size.x, 0.0, 0.5 * height);
            self.cuboid(middle, size.with_z(height), turn, paint);
        }
    }

    /// A slope up from a foot, as long, wide and high as `size`: a turned slab whose lower parts are in the ground.
    pub(super) fn ramp(&mut self, (foot, turn): (Vec3, Quat), size: Vec3, paint: Paint) {
        let slope = libm::atan2f(size.z, size.x);
        let rotation = turn * Quat::from_rotation_y(-slope);
        let slab = Vec3::new(libm::hypotf(size.x, size.z), size.y, size.z.max(0.1));
        let top = foot + turn * Vec3::new(0.5 * size.x, 0.0, 0.5 * size.z);
        self.cuboid(top - rotation * Vec3::Z * (0.5 * slab.z), slab, rotation, paint);
    }
}

impl Playground {
    /// Height of the highest cuboid of the scene at a point and not above `below`, or 0 for the ground. Metres.
    #[must_use]
    pub fn height_at(&self, at: Vec2, below: f32) -> f32 {
        let tops = self.fixtures.iter().filter_map(|painted| top_of(&painted.fixture, at));
        tops.filter(|&top| top <= below).fold(0.0, f32::max)
    }
}

/// Where a line down at a point enters a cuboid.
fn top_of(fixture: &Fixture, at: Vec2) -> Option<f32> {
    let FixtureShape::Solid(Solid::Cuboid { half_extents }) = fixture.shape else { return None };
    let into = fixture.rotation.inverse();
    let (from, along) = (into * (at.extend(0.0) - fixture.position), into * Vec3::Z);
    // A line along z, in the frame of the cuboid: it is inside from `low` to `high`.
    let (mut low, mut high) = (f32::NEG_INFINITY, f32::INFINITY);
    for axis in 0..3 {
        let (start, step, half) = (from[axis], along[axis], half_extents[axis]);
        if step.abs() < 1e-6 {
            if start.abs() > half {
                return None;
            }
            continue;
        }
        let (one, other) = ((-half - start) / step, (half - start) / step);
        (low, high) = (low.max(one.min(other)), high.min(one.max(other)));
    }
    (low <= high).then_some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(add: impl FnOnce(&mut Blocks)) -> Playground {
        let mut blocks = Blocks::default();
        add(&mut blocks);
        Playground {
            name: String::new(),
            area: [Vec2::splat(-9.0), Vec2::splat(9.0)],
            starts: Vec::new(),
            fixtures: blocks.0,
            props: Vec::new(),
            checkpoints: Vec::new(),
            way: Vec::new(),
        }
    }

    #[test]
    fn stairs_rise_step_by_step() {
        let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2);
        let size = Vec3::new(0.3, 2.0, 0.1);
        let scene = made(|blocks| blocks.stairs((Vec3::new(1.0, 2.0, 0.0), turn), 3, size, Paint::Wood));
        for (ahead, height) in [(-0.1, 0.0), (0.1, 0.1), (0.4, 0.2), (0.8, 0.3), (1.0, 0.0)] {
            let found = scene.height_at(Vec2::new(1.5, 2.0 + ahead), 5.0);
            assert!((found - height).abs() < 1e-5, "{ahead}: {found}");
        }
        assert_eq!(scene.height_at(Vec2::new(2.5, 2.5), 5.0), 0.0, "beside them");
    }

    #[test]
    fn a_ramp_rises_evenly_and_what_is_above_does_not_count() {
        let size = Vec3::new(4.0, 2.0, 0.8);
        let scene = made(|blocks| {
            blocks.ramp((Vec3::ZERO, Quat::IDENTITY), size, Paint::Wood);
            blocks.cuboid(Vec3::new(2.0, 0.0, 3.0), Vec3::splat(0.5), Quat::IDENTITY, Paint::Red);
        });
        for ahead in [0.2, 1.0, 2.0, 3.8] {
            let found = scene.height_at(Vec2::new(ahead, 0.5), 2.0);
            assert!((found - 0.2 * ahead).abs() < 1e-4, "{ahead}: {found}");
        }
        assert!((scene.height_at(Vec2::new(2.0, 0.0), 5.0) - 3.25).abs() < 1e-5);
    }
}
