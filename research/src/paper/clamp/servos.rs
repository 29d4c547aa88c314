//! Which servo suffices.

use sophie_charts::units::KGCM;
use sophie_sim::parallel;
use sophie_sim::plant::tendon::ServoProfile;
use sophie_sim::plant::tendon::ServoSpec;

use super::super::printed::Printed;
use super::bench::{OnBench, closing_thrust, holds, once};
use crate::results::model::{Section, Table, num};

struct Tried {
    name: &'static str,
    servo: ServoSpec,
}

fn servos() -> [Tried; 4] {
    let made = |stall: f64, range: f64| ServoSpec {
        stall: stall * KGCM,
        range,
        ..ServoSpec::from(ServoProfile::Paper)
    };
    let tried = |name, servo| Tried { name, servo };
    [
        tried(
            "MG996R, 4.8 V (datasheet: 9.4 kgcm, 180°)",
            ServoProfile::Mg996r.into(),
        ),
        tried(
            "MG996R, 6 V (datasheet: 11 kgcm, 180°)",
            made(11.0, std::f64::consts::PI),
        ),
        tried("20 kgcm, 270° (class of digital servos)", made(20.0, 4.71)),
        tried("35 kgcm, 270° (the paper's claim)", ServoProfile::Paper.into()),
    ]
}

/// Closes the grid with each servo.
pub fn compare(s: &mut Section, p: &Printed, all: &[OnBench]) {
    let mut t = Table::new(
        "Which servo can do it: closings of the grid that hold",
        &[
            "servo",
            "stall kgcm",
            "closings that hold",
            "of them, U(∞) below a third of stall",
        ],
    );
    for Tried { name, servo } in servos() {
        let held = parallel::each(all, |c| {
            holds(&once(c.infill, c.diameter, servo, closing_thrust(p), 1))
        });
        let held: Vec<&OnBench> = all.iter().zip(held).filter(|(_, h)| *h).map(|(c, _)| c).collect();
        let cool = held
            .iter()
            .filter(|c| c.closed.steady < servo.stall / 3.0)
            .count();
        t.row([
            name.into(),
            num(servo.stall / KGCM, 1),
            format!("{} of {}", held.len(), all.len()).into(),
            cool.to_string().into(),
        ]);
    }
    s.table(t);
    let most = p.table_4.force_kgcm.iter().copied().fold(0.0, f64::max);
    s.text(format!(
        "The text names an MG996R and gives it {:.0} kgcm; the datasheet says 9.4 kgcm at 4.8 V and 11 at 6 V. Even the \
         paper's own largest steady force of {most} kgcm would hold such a servo at stall, and F_max = {:.0} kgcm is beyond \
         it. A servo that holds {most} kgcm for minutes wants about three times that (a third of stall as a continuous load \
         is a rule of thumb, not a measurement): a 30 to 35 kgcm servo, which the printed 35 may well have been.",
        p.text.servo_stall_kgcm, p.text.force_max_kgcm
    ));
}
