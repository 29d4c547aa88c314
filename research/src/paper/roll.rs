//! Figs. 7 and 8, Table III: the 25° roll, its arms and sideways force.

mod compare;
mod figures;
mod manoeuvre;
mod printed;

use crate::study::rig::Flown;
use sophie_sim::mixers::Variant;
use sophie_sim::parallel;

use super::flights::lost_when;
use super::printed::Printed;
use crate::results::model::{Cell, Section, Table, num};
pub use manoeuvre::sideways;
use manoeuvre::{Arms, Command, Found, HELD, Job, fitted_damping, found, hard_gain, manoeuvre};

#[derive(Clone, Copy)]
struct Case {
    name: &'static str,
    mixer: Variant,
    command: Command,
}

const RIGID_HARD: usize = 0;
const FLEXIBLE_HARD: usize = 1;
const FLEXIBLE_SOFT: usize = 2;

struct Flights {
    cases: [Case; 3],
    infills: Vec<f64>,
    /// Massless, damped to Table III at ρ 8 %.
    fitted: Arms,
    /// Case, and flight.
    jobs: Vec<(usize, Job)>,
    flown: Vec<Flown>,
}

impl Flights {
    /// Flies the hard step with rate gain `gain` (1/s), and the stack's command to Table III's roll.
    fn fly(p: &Printed, gain: f64) -> Self {
        let angle = p.text.roll_deg.to_radians();
        let hard = Command::Hard(gain);
        let case = |name, mixer, command| Case { name, mixer, command };
        let cases = [
            case("rigid, hard step", Variant::Rigid, hard),
            case("flexible, hard step", Variant::Flexible, hard),
            case("flexible, prefiltered", Variant::Flexible, Command::Soft),
        ];
        let infills: Vec<f64> = p.table_3.iter().map(|r| r.infill_percent).collect();
        let fitted = Arms::Fitted(fitted_damping(p, angle, hard));
        let mut jobs: Vec<(usize, Job)> = vec![];
        for arms in [Arms::Static, fitted, Arms::Heavy] {
            for infill in &infills {
                let job = |c: &Case| Job {
                    infill: *infill,
                    mixer: c.mixer,
                    command: c.command,
                    arms,
                };
                jobs.extend(cases.iter().map(job).enumerate());
            }
        }
        let flown = parallel::each(&jobs, |(_, job)| manoeuvre(*job, angle));
        Self {
            cases,
            infills,
            fitted,
            jobs,
            flown,
        }
    }

    fn of(&self, case: usize, infill: f64, arms: Arms) -> Option<&Flown> {
        let same = |(i, j): &(usize, Job)| *i == case && j.infill == infill && j.arms == arms;
        self.jobs.iter().position(same).and_then(|i| self.flown.get(i))
    }

    fn found(&self, case: usize, infill: f64, arms: Arms) -> Option<Found> {
        self.of(case, infill, arms).and_then(found)
    }

    fn bent(&self, case: usize, infill: f64, arms: Arms) -> f64 {
        let found = self.found(case, infill, arms);
        found.map_or(f64::NAN, |f| f.delta_alpha.to_degrees())
    }
}

/// The roll manoeuvre.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("table3", "Figs. 7 and 8, Table III: the 25° roll");
    let angle = p.text.roll_deg.to_radians();
    let share = p.text.delta_thrust_share;
    printed::against_itself(&mut s, p);
    let gain = hard_gain(angle, share);
    let flights = Flights::fly(p, gain);
    s.text(format!(
        "Flown, with a step to 25° held for {HELD} s. \"Hard\" is what the paper's ΔT/T = 3/5 takes: an attitude gain of 12 \
         1/s and a rate gain of {gain:.1} 1/s, found by halving so that static arms reach 3/5 at ρ 8 %; the stack flies 4.5 and 10 behind a prefilter. ΔT/T is of one left and one right rotor: of all four, 3/5 would \
         be {:.1} N a side, beyond the rotor.",
        share * p.mass() * 9.806_65
    ));
    s.table(table(&flights, angle));
    compare::with_flights(&mut s, p, &flights);
    figures::columns(&mut s, p, &flights);
    figures::manoeuvres(&mut s, p, &flights);
    conclude(&mut s, p, &flights);
    s
}

fn table(flights: &Flights, angle: f64) -> Table {
    let mut t = Table::new(
        "The manoeuvre flown, configuration B; ratio: largest φ+Δα of the first of three over that of this one",
        &[
            "arms",
            "ρ %",
            "mixer, command",
            "φ_max °",
            "ΔT/T",
            "Δα_max °",
            "κ, Eq. 11",
            "κ, exact",
            "(φ+Δα)_max °",
            "ratio",
            "lost",
        ],
    );
    for arms in [Arms::Static, flights.fitted, Arms::Heavy] {
        for infill in &flights.infills {
            let first = flights.found(RIGID_HARD, *infill, arms);
            for (i, case) in flights.cases.iter().enumerate() {
                let lost = flights.of(i, *infill, arms).map_or("–".into(), lost_when);
                let numbers = match flights.found(i, *infill, arms) {
                    Some(f) => numbers(&f, first, angle),
                    None => std::array::from_fn(|_| num(f64::NAN, 0)),
                };
                let name = [arms.words().into(), num(*infill, 0), case.name.into()];
                t.row(name.into_iter().chain(numbers).chain([lost]));
            }
        }
    }
    t
}

fn numbers(f: &Found, first: Option<Found>, angle: f64) -> [Cell; 7] {
    [
        num(f.roll.to_degrees(), 1),
        num(f.thrust_share, 2),
        num(f.delta_alpha.to_degrees(), 1),
        num(printed::eq_11(f.delta_alpha, f.thrust_share, angle), 3),
        num(f.kappa, 3),
        num(f.effective.to_degrees(), 1),
        num(first.map_or(f64::NAN, |x| x.effective / f.effective), 2),
    ]
}

fn conclude(s: &mut Section, p: &Printed, flights: &Flights) {
    let fitted = flights.fitted;
    let rest = flights.bent(RIGID_HARD, 8.0, Arms::Static);
    let heavy = flights.bent(RIGID_HARD, 8.0, Arms::Heavy);
    let heavy_flexible = flights.bent(FLEXIBLE_HARD, 8.0, Arms::Heavy);
    let printed = p.table_3.get(1).map_or(f64::NAN, |r| r.delta_alpha_max_deg);
    s.text(format!(
        "What that says about K: the same command at ρ 8 % bends the arms by {rest:.1}° if they hardly swing (ζ 0.7: the \
         rotor's lag takes the rest of Eq. 1's static difference), by {heavy:.1}° (rigid mixer) and {heavy_flexible:.1}° (flexible) if \
         they carry {} kg at their tips, because the arm that is pushed up has to push its motor up, and swings; the printed {printed:.1}° take massless arms of ζ {:.2}. A table of Δα \
         in a fast roll does not identify the static gain K: mass and damping of the arm are in it too. A bench identifies \
         it (sophie fit-arm).",
        sophie_sim::plant::hinged::link::TIP_MASS,
        fitted.damping()
    ));
    let worst = p.table_3.iter().filter_map(|row| {
        let found = flights.found(RIGID_HARD, row.infill_percent, fitted)?;
        let bent = found.delta_alpha.to_degrees();
        Some(100.0 * (bent / row.delta_alpha_max_deg - 1.0).abs())
    });
    let worst = worst.fold(0.0, f64::max);
    s.finding = format!(
        "A step hard enough for ΔT/T = 3/5 bends massless, well damped arms by {rest:.1}° at ρ 8 % and arms that carry their \
         motors by {heavy:.1}° under the rigid and {heavy_flexible:.1}° under the flexible mixer (printed {printed:.1}°); massless arms of ζ {:.2} meet the whole column within {worst:.0} %. The mixer has no part in the ratio column: the roll lever of a hinged arm \
         does not depend on α, so only a softer command lowers φ + Δα. Two of the printed ratios are larger than the printed \
         Δα_max allows.",
        fitted.damping()
    );
}
