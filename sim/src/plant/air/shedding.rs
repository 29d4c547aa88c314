//! Eddies that a wind sheds behind the pipe: an air speed across the wind that swings at f = St U / D, U the wind's speed
//! across the pipe, D its diameter, St 0.2 of a circular cylinder at Reynolds numbers of 300 to 3e5.
//!
//! The speed falls off with the distance from the wake's middle by a bell curve one diameter wide, and downwind by 1/e in
//! six diameters; half a diameter upwind of the axis it ends (shape assumed).

use core::f64::consts::TAU;

use glam::DVec3;

use super::super::contact::Pipe;

/// Strouhal number of a circular cylinder.
const STROUHAL: f64 = 0.2;
/// Diameters downwind in which the eddies decay to 1/e (assumed).
const REACH: f64 = 6.0;

/// The eddies.
#[derive(Clone, Copy, Debug)]
pub struct Shedding {
    /// Amplitude over the wind's speed across the pipe.
    share: f64,
    /// rad.
    phase: f64,
    /// Wind across the pipe, m/s, east positive.
    across: f64,
}

impl Shedding {
    /// Eddies whose vertical speed in the wake's middle swings by `share` of the wind's speed across the pipe.
    #[must_use]
    pub fn new(share: f64) -> Self {
        Self {
            share,
            phase: 0.0,
            across: 0.0,
        }
    }

    /// Advances by `dt` s in a steady `wind`, m/s, NED.
    pub fn step(&mut self, dt: f64, wind: DVec3, pipe: &Pipe) {
        self.across = wind.y;
        let frequency = STROUHAL * self.across.abs() / (2.0 * pipe.radius);
        self.phase = (self.phase + TAU * frequency * dt) % TAU;
    }

    /// Air velocity of the eddies at `point` (m, NED), m/s, NED.
    #[must_use]
    pub fn at(&self, point: DVec3, pipe: &Pipe) -> DVec3 {
        if self.share == 0.0 || self.across == 0.0 || (point.x - pipe.north).abs() > pipe.half_length {
            return DVec3::ZERO;
        }
        let diameter = 2.0 * pipe.radius;
        let across = pipe.across(point);
        let downwind = across.x * self.across.signum() / diameter;
        let beside = across.y / diameter;
        let along = if downwind > 0.0 {
            libm::exp(-downwind / REACH)
        } else {
            (1.0 + 2.0 * downwind).max(0.0)
        };
        let speed = self.share * self.across.abs() * along * libm::exp(-beside * beside);
        DVec3::new(0.0, 0.0, speed * libm::sin(self.phase))
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::STEP;
    use super::super::tests::pipe;
    use super::*;

    /// 3 m/s over 0.3 m: 2 Hz.
    #[test]
    fn eddies_have_the_strouhal_frequency_and_lie_downwind() {
        let (mut eddies, pipe) = (Shedding::new(0.3), pipe());
        let wind = DVec3::new(0.0, 3.0, 0.0);
        let at = |downwind: f64| DVec3::new(pipe.north, pipe.east + downwind, pipe.down);
        let (mut crossings, mut last, mut most, mut upwind) = (0, 0.0, 0.0_f64, 0.0_f64);
        for _ in 0..(10.0 / STEP) as u32 {
            eddies.step(STEP, wind, &pipe);
            let speed = eddies.at(at(0.3), &pipe).z;
            crossings += u32::from(speed > 0.0 && last <= 0.0);
            last = speed;
            most = most.max(speed);
            upwind = upwind.max(eddies.at(at(-0.3), &pipe).length());
        }
        assert!((19..=21).contains(&crossings), "{crossings}");
        assert!((most - 0.9 * libm::exp(-1.0 / 6.0)).abs() < 1e-3, "{most}");
        assert_eq!(upwind, 0.0);
    }

    #[test]
    fn a_wind_along_the_pipe_sheds_nothing() {
        let mut eddies = Shedding::new(0.3);
        for _ in 0..500 {
            eddies.step(STEP, DVec3::new(6.0, 0.0, 0.0), &pipe());
        }
        assert_eq!(eddies.at(DVec3::new(3.0, 0.3, -1.35), &pipe()), DVec3::ZERO);
    }
}
