//! Eqs. 5 to 8: translational dynamics, printed and derived, against a flight.

use std::f32::consts::TAU;

use crate::study::rig::{Demand, Flown, Moment, fly};
use glam::DVec3;
use sophie_control::allocation::wrench::Configuration;
use sophie_sim::mixers::Variant;
use sophie_sim::plant::GRAVITY;

use super::flights::{delta_alpha, delta_thrust, vehicle};
use super::printed::Printed;
use super::roll::sideways;
use crate::results::model::{Axis, Chart, Section, Series, SeriesStyle, Table, num};
use sophie_sim::parallel;
use sophie_sim::plant::DRAG;

/// Thrust along the body's -z, N.
fn lift(m: &Moment) -> f64 {
    m.thrust.iter().zip(m.tilt).map(|(t, a)| t * a.cos()).sum()
}

/// Printed f_x, sign included: -α1T1 - α2T2 + α3T3 + α4T4, N.
fn printed_f_x(m: &Moment) -> f64 {
    -m.tilt[0] * m.thrust[0] - m.tilt[1] * m.thrust[1] + m.tilt[2] * m.thrust[2] + m.tilt[3] * m.thrust[3]
}

/// Printed Eqs. 5 to 7: force along x (east), y (north), z (down), N; T is the sum of the thrusts.
fn printed(m: &Moment) -> DVec3 {
    let [(sp, cp), (st, ct), (ss, cs)] = m.attitude.map(f64::sin_cos);
    let (t, f) = (m.thrust.iter().sum::<f64>(), printed_f_x(m));
    DVec3::new(
        -(ss * st * cp - cs * sp) * t + ct * ss * f,
        -(cs * st * cp + ss * sp) * t + ct * cs * f,
        -(cs * st * cp + ss * sp) * t - st * f,
    )
}

/// Thrusts along -z, their sideways part along body y, gravity.
fn derived(m: &Moment, mass: f64) -> DVec3 {
    let [(sp, cp), (st, ct), (ss, cs)] = m.attitude.map(f64::sin_cos);
    let (t, f) = (lift(m), sideways(m));
    DVec3::new(
        -(ss * st * cp - cs * sp) * t + (ss * st * sp + cs * cp) * f,
        -(cs * st * cp + ss * sp) * t + (cs * st * sp - ss * cp) * f,
        -ct * cp * t + ct * sp * f + mass * GRAVITY,
    )
}

/// Thrust alone.
fn rigid(m: &Moment, mass: f64) -> DVec3 {
    let [(sp, cp), (st, ct), (ss, cs)] = m.attitude.map(f64::sin_cos);
    let t = m.thrust.iter().sum::<f64>();
    DVec3::new(
        -(ss * st * cp - cs * sp) * t,
        -(cs * st * cp + ss * sp) * t,
        -ct * cp * t + mass * GRAVITY,
    )
}

/// Mass times acceleration less drag, N, over a centred window of 10 ms.
fn truth(flown: &Flown, mass: f64) -> Vec<(Moment, DVec3)> {
    let m = &flown.moments;
    (5..m.len().saturating_sub(5))
        .map(|i| {
            let a = (m[i + 5].velocity - m[i - 5].velocity) / (m[i + 5].t - m[i - 5].t);
            // The plant's drag is subtracted, so that only the equations differ.
            let force = a * mass + m[i].velocity * DRAG;
            (m[i], DVec3::new(force.y, force.x, force.z))
        })
        .collect()
}

/// Turns to a heading (rad), then rolls by 25° to either side.
fn manoeuvre(coupled: bool, heading: f64, angle: f64) -> Flown {
    let mut s = vehicle(Configuration::B, 7.75, 6.9, Variant::Flexible);
    s.vehicle.coupled_arms = coupled;
    s.params.setpoint_lpf_hz = 30.0 / TAU;
    let turn = heading / 0.5;
    let mut flown = fly(&s, None, turn + 5.0, |t| Demand {
        yaw_rate: if t < turn { 0.5 } else { 0.0 },
        roll: match t - turn - 2.0 {
            x if x < 0.0 => 0.0,
            x if x < 1.0 => angle,
            x if x < 2.0 => -angle,
            _ => 0.0,
        },
        ..Demand::default()
    });
    flown.moments.retain(|m| m.t > turn + 1.8);
    flown
}

struct Rolled {
    coupled: bool,
    heading: f64,
    truth: Vec<(Moment, DVec3)>,
}

/// Eqs. 5 to 8.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("eq5", "Eqs. 5 to 8: translational dynamics");
    let (mass, angle) = (p.mass(), p.text.roll_deg.to_radians());
    let east = 90f64.to_radians();
    let jobs = [(false, 0.0), (false, east), (true, 0.0), (true, east)];
    let flights = parallel::each(&jobs, |(coupled, heading)| Rolled {
        coupled: *coupled,
        heading: *heading,
        truth: truth(&manoeuvre(*coupled, *heading, angle), mass),
    });
    s.table(errors(&flights, mass));
    s.text(
        "The paper's axes read as x east, y north, z down (its rigid terms are then right for x and y). Its flexible terms \
         use the body's forward axis: (cθ sψ, cθ cψ, -sθ) instead of the sideways one (sψ sθ sφ + cψ cφ, cψ sθ sφ - sψ cφ, \
         cθ sφ). So they vanish at ψ = 0, where Eq. 8 has them, and push along the nose at ψ = 90°. Eq. 7 repeats the rigid \
         term of Eq. 6 and lacks gravity. Going from f_x to Eq. 8 the sign changes: f_x = -α1T1 - α2T2 + α3T3 + α4T4 is \
         negative where Eq. 8 says +Δα ΔT, and the first-order part (T1+T3) Δα is lost on the way.",
    );
    s.figure(
        "Arms that follow their thrust alone, roll to 25° and -25°. Flown and derived lie on each other.",
        vec![
            forces("Sideways (x) at heading 0°", &flights[0], 0, mass),
            forces("Sideways (y) at heading 90°", &flights[1], 1, mass),
            forces("Downwards (z) at heading 0°", &flights[0], 2, mass),
            flexible_term(&flights[0]),
        ],
    );
    let massless = flights.iter().filter(|f| !f.coupled);
    let worst_derived = massless
        .flat_map(|f| [0, 1, 2].map(|axis| f.rms(axis, |m| derived(m, mass))))
        .fold(0.0, f64::max);
    s.finding = format!(
        "As derived, the equations give the flown force within {worst_derived:.3} N RMS. As printed, Eqs. 5 and 6 have the \
         flexible force along the nose, Eq. 7 lacks gravity, and Eq. 8 keeps the smaller of two terms."
    );
    s
}

impl Rolled {
    /// N.
    fn rms(&self, axis: usize, equation: impl Fn(&Moment) -> DVec3) -> f64 {
        let square = |(m, force): &(Moment, DVec3)| (equation(m)[axis] - force[axis]).powi(2);
        let sum = self.truth.iter().map(square).sum::<f64>();
        (sum / self.truth.len().max(1) as f64).sqrt()
    }

    /// A value every 5 ms.
    fn curve(&self, value: impl Fn(&Moment, &DVec3) -> f64) -> Vec<(f64, f64)> {
        let start = self.truth.first().map_or(0.0, |(m, _)| m.t);
        let shown = self.truth.iter().step_by(5);
        shown.map(|(m, force)| (m.t - start, value(m, force))).collect()
    }
}

fn errors(flights: &[Rolled], mass: f64) -> Table {
    let mut t = Table::new(
        "Error of the force, RMS over a roll to 25° on either side, N",
        &[
            "arms",
            "heading",
            "axis",
            "printed",
            "derived",
            "rigid",
            "largest true force",
        ],
    );
    for flight in flights {
        let arms = if flight.coupled {
            "carry their tip mass"
        } else {
            "follow thrust alone"
        };
        for (axis, name) in ["x (east), Eq. 5", "y (north), Eq. 6", "z (down), Eq. 7"]
            .into_iter()
            .enumerate()
        {
            let forces = flight.truth.iter().map(|(_, f)| f[axis].abs());
            t.row([
                arms.into(),
                format!("{:.0}°", flight.heading.to_degrees()).into(),
                name.into(),
                num(flight.rms(axis, printed), 3),
                num(flight.rms(axis, |m| derived(m, mass)), 3),
                num(flight.rms(axis, |m| rigid(m, mass)), 3),
                num(forces.fold(0.0, f64::max), 2),
            ]);
        }
    }
    t
}

fn forces(title: &str, flight: &Rolled, axis: usize, mass: f64) -> Chart {
    let by = |equation: &dyn Fn(&Moment) -> DVec3| flight.curve(|m, _| equation(m)[axis]);
    Chart {
        title: title.to_owned(),
        x: Axis::new("time (s)"),
        y: Axis::new("force (N)"),
        series: vec![
            Series::new(
                "flown: mass times acceleration",
                7,
                SeriesStyle::Line,
                flight.curve(|_, f| f[axis]),
            ),
            Series::new("derived", 0, SeriesStyle::Dashed, by(&|m| derived(m, mass))),
            Series::new("printed", 1, SeriesStyle::Line, by(&printed)),
            Series::new("rigid", 2, SeriesStyle::Dashed, by(&|m| rigid(m, mass))),
        ],
        ..Chart::default()
    }
}

fn flexible_term(flight: &Rolled) -> Chart {
    let of = |value: &dyn Fn(&Moment) -> f64| flight.curve(|m, _| value(m));
    Chart {
        title: "The flexible term alone, heading 0°".to_owned(),
        x: Axis::new("time (s)"),
        y: Axis::new("sideways force (N)"),
        series: vec![
            Series::new("true: Σ ± T sin α", 0, SeriesStyle::Line, of(&sideways)),
            Series::new(
                "Eq. 8: Δα ΔT, two pairs",
                1,
                SeriesStyle::Line,
                of(&|m| 2.0 * delta_alpha(m) * delta_thrust(m)),
            ),
            Series::new(
                "first order: (T1+T3) Δα",
                2,
                SeriesStyle::Dashed,
                of(&|m| 0.5 * m.thrust.iter().sum::<f64>() * delta_alpha(m)),
            ),
        ],
        ..Chart::default()
    }
}
