//! Give of a servo's shaft under load.
//!
//! A servo's position loop without integrator stands off its target in proportion to its load, and its gears lie on one
//! flank as soon as the load exceeds their friction: φ = s M + b min(M/M0, 1), unwinding, with the sag s (rad/(N·m)) and
//! the backlash b (rad). A tendon only pulls, so that backlash costs b once, between the slack and the taut thread, and
//! has no hysteresis under load. 1.8 to 2.6° at 15 kgcm, backlash 1° (STS3215, TheRobotStudio/SO-ARM100 #134).
//! s = b = 0: none.

/// Load that presses the gears on one flank, N·m: gear friction of an unpowered servo's first stage (assumed).
const FLANK: f64 = 0.02;
/// Time constant of the position loop, s (assumed, 3 Hz).
const SETTLE: f64 = 0.05;

/// Give of one servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Give {
    /// Sag, rad/(N·m).
    sag: f64,
    /// Backlash, rad.
    backlash: f64,
    angle: f64,
}

impl Give {
    /// A servo without load of the `sag`, rad/(N·m), and the `backlash`, rad.
    #[must_use]
    pub const fn new(sag: f64, backlash: f64) -> Self {
        Self {
            sag,
            backlash,
            angle: 0.0,
        }
    }

    /// Angle by which the shaft gives way, rad, `dt` s later under `torque` N·m.
    pub fn step(&mut self, dt: f64, torque: f64) -> f64 {
        if self.sag == 0.0 && self.backlash == 0.0 {
            return 0.0;
        }
        let rest = self.sag * torque + self.backlash * (torque / FLANK).clamp(0.0, 1.0);
        self.angle += (rest - self.angle) * dt / SETTLE;
        self.angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled(give: &mut Give, torque: f64) -> f64 {
        (0..1000).fold(0.0, |_, _| give.step(1e-3, torque))
    }

    #[test]
    fn the_shaft_sags_by_its_load_and_lies_on_one_flank() {
        // 1.5 °/(N·m) and 1°: 1° at 0.02 N·m, and 1.81° at the grip's 0.54 N·m.
        let mut give = Give::new(1.5_f64.to_radians(), 1.0_f64.to_radians());
        assert!(settled(&mut give, 0.0) == 0.0);
        assert!((settled(&mut give, 0.54).to_degrees() - 1.81).abs() < 1e-6);
        assert!((settled(&mut give, 0.02).to_degrees() - 1.03).abs() < 1e-6);
        assert!(settled(&mut give, 0.0).abs() < 1e-6);
    }

    #[test]
    fn a_stiff_servo_does_not_give() {
        assert_eq!(Give::new(0.0, 0.0).step(1e-3, 2.0), 0.0);
    }
}
