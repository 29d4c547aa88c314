//! Rays that meet the pipe or the ground.

use glam::DVec3;

use super::Pipe;

/// Rounds that find the sagging axis under a ray: the second is within a thousandth of the sag.
const ROUNDS: u32 = 3;

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance, in lengths of the ray's direction.
    pub way: f64,
    /// It meets the pipe, not the ground.
    pub pipe: bool,
}

impl Pipe {
    /// Distance from `from` along `direction` (in its lengths) to the pipe or the ground, world axes; `None` for a ray
    /// into the sky.
    #[must_use]
    pub fn or_ground_along(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        self.or_ground_hit(from, direction).map(|hit| hit.way)
    }

    /// The same, with which of the two it is.
    #[must_use]
    pub fn or_ground_hit(&self, from: DVec3, direction: DVec3) -> Option<Hit> {
        let hit = |pipe| move |way| Hit { way, pipe };
        let ground = (direction.z > 1e-3).then(|| -from.z / direction.z);
        [self.along(from, direction).map(hit(true)), ground.map(hit(false))]
            .into_iter()
            .flatten()
            .filter(|hit| hit.way > 0.0)
            .min_by(|a, b| a.way.total_cmp(&b.way))
    }

    fn along(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        let middle = DVec3::new(self.north, self.east, self.down + self.shape.heave);
        let (from, direction) = (self.turned(from - middle), self.turned(direction));
        let bare = self.cylinder(self.radius, from, direction);
        let rise = self.shape.flange.rise();
        if rise == 0.0 {
            return bare;
        }
        let ring = self
            .cylinder(self.radius + rise, from, direction)
            .filter(|way| self.shape.flange.stands_at(from.x + direction.x * way));
        ring.or(bare)
    }

    /// Distance to the first crossing of a cylinder of `radius` m about the sagging axis, in axes of the pipe.
    fn cylinder(&self, radius: f64, from: DVec3, direction: DVec3) -> Option<f64> {
        let mut raised = 0.0;
        let mut found = None;
        let rounds = if self.shape.sag == 0.0 { 1 } else { ROUNDS };
        for _ in 0..rounds {
            let (y, z) = (from.y, from.z + raised);
            let (a, b, c) = (
                direction.y * direction.y + direction.z * direction.z,
                y * direction.y + z * direction.z,
                y * y + z * z - radius * radius,
            );
            let root = b * b - a * c;
            let way = (-b - root.max(0.0).sqrt()) / a;
            let along = from.x + direction.x * way;
            let share = along / self.half_length;
            raised = self.shape.sag * (share * share);
            found = (root >= 0.0 && way > 0.0 && along.abs() <= self.half_length).then_some(way);
        }
        found
    }
}
