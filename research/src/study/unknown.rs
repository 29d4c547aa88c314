//! A campaign over builders: vehicles, days and pipes drawn from the table of uncertain quantities, each flown through the
//! default mission, one row a flight.
//!
//! The folder of a campaign holds a file of rows a shard. A stopped shard continues with the next vehicle.

pub mod class;
pub mod explain;
pub mod folder;
pub mod report;
pub mod row;

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use sophie_sim::check::Check;
use sophie_sim::flight;
use sophie_sim::parallel;
use sophie_sim::record::Silent;
use sophie_sim::scenario::draw::{self, CHANCES, Drawn};
use sophie_sim::scenario::uncertain::QUANTITIES;
use sophie_sim::scenario::{Assist, Known, MISSION, Overrides, PositionSensor, Rule, Scenario, Step, keys};
use sophie_sim::streams::Streams;
use sophie_terminal::console::one_line;

pub use self::class::Class;
pub use self::folder::Shelf;
pub use self::row::Row;

/// RMS of the gusts on each horizontal axis over the mean wind.
const TURBULENCE: f64 = 0.2;

/// Reach of the range with `--sensors flow`, m: the part that docs/position-sources.md asks for over the ground of the table,
/// whose reflectivity of 0.1 leaves a third of it.
const RANGE_REACH: f64 = 8.0;

/// Time on the pipe after the hold, s, within one minute: creep, heat and drift.
pub const LAPSE: f64 = 30.0 * 60.0;

/// A campaign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// What the stack knows of each vehicle.
    pub known: Known,
    /// Steps that the pilot leaves to the vehicle.
    pub assist: Assist,
    /// Sensor of the position.
    pub sensors: PositionSensor,
    /// Rule of the judge; that of holding adds [`LAPSE`] to the hold.
    pub judge: Rule,
    /// Mean wind, m/s.
    pub wind: f64,
    /// Seed of the first vehicle; the next have the numbers after it.
    pub seed: u64,
    /// Vehicles.
    pub count: u64,
}

impl Request {
    /// Seed of vehicle `number`, from 1.
    #[must_use]
    pub const fn seed_of(&self, number: u64) -> u64 {
        self.seed.saturating_add(number.saturating_sub(1))
    }

    /// Names and values of what the rows of one campaign share. The number of vehicles is the last.
    #[must_use]
    pub fn words(&self) -> [(&'static str, String); 9] {
        [
            ("sophie", env!("CARGO_PKG_VERSION").to_owned()),
            ("table", table()),
            ("known", self.known.word().to_owned()),
            ("assist", keys::assist_word(self.assist).to_owned()),
            ("sensors", keys::position_sensor_word(self.sensors).to_owned()),
            ("judge", self.judge.word().to_owned()),
            ("wind_m_s", self.wind.to_string()),
            ("first_seed", self.seed.to_string()),
            ("vehicles", self.count.to_string()),
        ]
    }

    /// A line for people.
    #[must_use]
    pub fn text(&self) -> String {
        let [_, _, known, assist, sensors, ..] = self.words().map(|(_, word)| word);
        format!(
            "{} vehicles from seed {}: known {known}, assist {assist}, sensors {sensors}, judge {}, wind {} m/s",
            self.count,
            self.seed,
            self.judge.word(),
            self.wind
        )
    }

    /// The scenario file of the vehicle with `seed`, of which `drawn` was drawn.
    #[must_use]
    pub fn scenario_text(&self, seed: u64, drawn: &[Drawn]) -> String {
        let [_, _, known, assist, sensors, ..] = self.words().map(|(_, word)| word);
        let (wind, gust) = (self.wind, TURBULENCE * self.wind);
        let mut text = format!(
            "name = \"unknown vehicle {seed}\"\nseed = {seed}\njudge = \"{}\"\nvehicle.known = \"{known}\"\npilot.assist = \"{assist}\"\n\
             sensors.position = \"{sensors}\"\nworld.wind_m_s = {wind}\nworld.wind_gust_m_s = {gust}\n",
            self.judge.word()
        );
        if self.sensors == PositionSensor::Flow {
            let _ = writeln!(text, "sensors.range_reach_m = {RANGE_REACH}");
        }
        for drawn in drawn {
            // A String takes every line.
            let _ = writeln!(text, "{}", drawn.line());
        }
        text
    }

    /// Draws the vehicle with `seed`. The parameters follow its truth as far as `known` says.
    ///
    /// # Errors
    /// One line: a value that no scenario takes.
    pub fn draw(&self, seed: u64) -> Result<(Scenario, Vec<Drawn>), String> {
        let drawn = draw::draw(Streams::new(seed));
        let text = self.scenario_text(seed, &drawn);
        let mut scenario = Scenario::parse(&text, &format!("vehicle {seed}"), &Overrides::default())
            .map_err(|error| error.to_string())?;
        if self.known == Known::Exact {
            scenario.tell_all();
        }
        if self.judge == Rule::Holding {
            for step in &mut scenario.steps {
                if let Step::Hold { lapse, .. } = step {
                    *lapse = LAPSE;
                }
            }
        }
        Ok((scenario, drawn))
    }

    /// Flies vehicle `number`, from 1.
    ///
    /// # Errors
    /// As [`Request::draw`].
    pub fn fly(&self, number: u64) -> Result<Row, String> {
        let seed = self.seed_of(number);
        let (scenario, drawn) = self.draw(seed)?;
        let mut row = Row::grounded(number, seed, &scenario, &drawn);
        // The builder checks the vehicle that he takes it for.
        let short: Vec<String> = Check::of(&scenario.assumed())
            .failing()
            .map(|row| row.shortfall())
            .collect();
        if !short.is_empty() {
            row.reason = one_line(&format!("check: {}", short.join("; ")));
            return Ok(row);
        }
        let record = flight::fly(&scenario, &mut Silent);
        row.class = Class::of(&record);
        row.accomplished = record.outcome.accomplished;
        row.reason = one_line(&record.outcome.reason);
        // Steps are of a millisecond.
        row.seconds = (1e3 * record.sim_seconds).round() / 1e3;
        row.digest = format!("{:016x}", record.digest);
        Ok(row)
    }
}

/// Digits that differ if tables or mission do: rows of different ones are not counted together.
fn table() -> String {
    let mut text = format!("{MISSION}{RANGE_REACH}");
    for quantity in QUANTITIES {
        let _ = write!(text, "{} {:?} {:?}", quantity.key, quantity.all, quantity.each);
    }
    for chance in CHANCES {
        let _ = write!(text, "{} {}", chance.key, chance.share);
    }
    format!(
        "{:08x}",
        (Streams::new(0).unit(&text) * f64::from(u32::MAX)) as u32
    )
}

/// Share `number` of `of` of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub number: u64,
    /// Shares.
    pub of: u64,
}

impl Shard {
    /// The whole campaign.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Its vehicles of `count`, from 1: consecutive ones, as many as in any other share or one less.
    #[must_use]
    pub fn vehicles(self, count: u64) -> RangeInclusive<u64> {
        let end = |share: u64| (u128::from(share) * u128::from(count) / u128::from(self.of.max(1))) as u64;
        end(self.number.saturating_sub(1)) + 1..=end(self.number)
    }
}

/// Flies the missing vehicles of `shelf`, and writes its file. `done` hears of each vehicle, also of those that were flown
/// before.
///
/// # Errors
/// One line: a file that cannot be written.
pub fn fly(mut shelf: Shelf, done: &(dyn Fn(&Row) + Sync)) -> Result<Vec<Row>, String> {
    let request = shelf.request();
    let missing = shelf.missing();
    shelf.rows().for_each(done);
    if !missing.is_empty() {
        let notes = shelf.notes()?;
        let flown = parallel::each(&missing, |number| {
            let row = request.fly(*number)?;
            notes.add(&row)?;
            done(&row);
            Ok(row)
        });
        shelf.extend(flown.into_iter().collect::<Result<Vec<_>, String>>()?);
        shelf.write()?;
        notes.remove();
    }
    Ok(shelf.into_rows())
}

#[cfg(test)]
mod tests;
