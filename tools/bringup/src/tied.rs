//! Runs of rotors with propellers on, the vehicle tied down: ordered, renewed, and measured at their end.

use std::time::{Duration, Instant};

use mavlink_core::MessageData;
use sophie_control::params::Params;
use sophie_control::pilot::static_thrust_test::{Rotors, StaticThrustTest};
use sophie_dialect::{MavCmd, MavMessage, MavResult, SOPHIE_ARMS_DATA, SYS_STATUS_DATA, VIBRATION_DATA};

use super::walk::{Stop, Walk};

/// Period of voltage and tilts, µs.
const PERIOD_US: f32 = 100_000.0;
/// Time between two commands of a run, of the board's and of the wall's: a third of what ends it.
const RENEWAL: Duration = Duration::from_millis(500);
/// Share of the time at the drive, at its end, that counts: filters and battery have settled.
const COUNTED: f32 = 0.5;
/// Time before the end at which the run is left to itself, ms.
const MARGIN_MS: u32 = 300;
/// The vehicle's reply to the renewal of a run that has ended.
const OVER: &str = "refused: this run has ended";

/// What came within the counted end of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct Measured {
    /// Battery, V.
    pub volts: Vec<f64>,
    /// Tilts of the arms by their sensors, rad; not a number for a silent one.
    pub tilts: Vec<[f64; 4]>,
    /// RMS of each axis over a second, m/s².
    pub vibration: Vec<[f64; 3]>,
    /// Readings at full scale since the start.
    pub clipped: u32,
}

impl Measured {
    /// Mean voltage, V.
    pub fn voltage(&self) -> f64 {
        self.volts.iter().sum::<f64>() / self.volts.len().max(1) as f64
    }

    /// Mean tilt of `arm`, 0 to 3, rad; `None` for a silent sensor.
    pub fn tilt(&self, arm: usize) -> Option<f64> {
        let all: Vec<f64> = self
            .tilts
            .iter()
            .filter_map(|arms| arms.get(arm).copied())
            .collect();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        mean.is_finite().then_some(mean)
    }
}

/// What the builder has to know before a rotor turns.
pub(super) fn warn(walk: &mut Walk<'_>) {
    walk.say("  | Upright, the body screwed to a stand with 5 kg of ballast, discs 0.5 m above it.");
    walk.say("  | Nothing within 0.5 m of a disc. Stand 3 m away, out of their planes; goggles.");
    walk.say("  | The arm switch, Enter and Ctrl-C stop the rotors, and so does a turn by 15 deg.");
}

/// The builder's word that the vehicle is tied down; the vehicle's reason if it refuses.
pub(super) fn tied_down(walk: &mut Walk<'_>) -> Result<Option<String>, Stop> {
    while walk.ask("Type tied once it is tied down, propellers on, everyone away:")? != "tied" {}
    walk.order(MavCmd::MAV_CMD_USER_1, &[2.0])
}

/// A number that no earlier run has had: ten a second since 1970, within what a float counts.
pub(super) fn number() -> u32 {
    let since = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .unwrap_or_default();
    (since.as_millis() / 100 % 8_000_000) as u32 + 1
}

/// Runs `rotor` (0 to 3), or all, at `percent` of full drive for `plateau` s as run `number`; why it ended early, or what was
/// measured.
pub(super) fn run(
    walk: &mut Walk<'_>,
    rotor: Option<usize>,
    percent: f64,
    plateau: f32,
    number: u32,
) -> Result<Result<Measured, String>, Stop> {
    let rotors = rotor.map_or(Rotors::All, Rotors::One);
    let test = StaticThrustTest {
        plateau,
        ..StaticThrustTest::steady(rotors, (0.01 * percent) as f32)
    };
    run_test(walk, &test, number)
}

/// Runs `test` as run `number`; as [`run`].
pub(super) fn run_test(
    walk: &mut Walk<'_>,
    test: &StaticThrustTest,
    number: u32,
) -> Result<Result<Measured, String>, Stop> {
    let turning = match test.rotors {
        Rotors::All => 0.0,
        Rotors::One(rotor) => (rotor + 1) as f32,
    };
    let step_to = 100.0 * test.step_to.unwrap_or_default();
    let order = [turning, 100.0 * test.drive, step_to, test.plateau, number as f32];
    let streams = [SYS_STATUS_DATA::ID, SOPHIE_ARMS_DATA::ID];
    walk.vehicle.stream(&streams, PERIOD_US)?;
    let ended = renewed(walk, &order, test);
    // Nothing turns on while a question is open, whatever came.
    let stopped = matches!(ended, Ok(Err(_)) | Err(_));
    if stopped && !matches!(ended, Err(Stop::Failed(_))) {
        walk.vehicle
            .command(MavCmd::MAV_CMD_SOPHIE_STATIC_THRUST, &[0.0, 0.0])?;
    }
    walk.vehicle.stream(&streams, 0.0)?;
    ended
}

/// Renews the run until its time is over, and measures at its end.
fn renewed(
    walk: &mut Walk<'_>,
    order: &[f32],
    test: &StaticThrustTest,
) -> Result<Result<Measured, String>, Stop> {
    let (length, counted) = (
        (1e3 * test.longest()) as u32,
        (1e3 * COUNTED * test.plateau) as u32,
    );
    let mut measured = Measured::default();
    let command = MavCmd::MAV_CMD_SOPHIE_STATIC_THRUST;
    if let Some(refused) = walk.order(command, order)? {
        return Ok(Err(refused));
    }
    let begun = walk.vehicle.up_ms();
    let mut sent = (begun, Instant::now());
    loop {
        let passed = walk.vehicle.up_ms().saturating_sub(begun);
        if passed + MARGIN_MS >= length {
            return Ok(if measured.volts.is_empty() {
                Err("no voltage came: is the battery measured?".to_owned())
            } else {
                Ok(measured)
            });
        }
        let counts = passed + counted >= length;
        let mut take = |message: &MavMessage| match message {
            MavMessage::SYS_STATUS(status) if counts && status.voltage_battery != u16::MAX => {
                measured.volts.push(f64::from(status.voltage_battery) * 1e-3);
            }
            MavMessage::SOPHIE_ARMS(arms) if counts => measured.tilts.push(arms.tilt.map(f64::from)),
            MavMessage::VIBRATION(VIBRATION_DATA {
                vibration_x,
                vibration_y,
                vibration_z,
                clipping_0,
                ..
            }) if counts => {
                let axes = [vibration_x, vibration_y, vibration_z];
                measured.vibration.push(axes.map(|axis| f64::from(*axis)));
                measured.clipped = *clipping_0;
            }
            _ => (),
        };
        walk.vehicle.wait(Duration::from_millis(20), |message| {
            take(message);
            None::<()>
        })?;
        let since = walk.vehicle.up_ms().saturating_sub(sent.0);
        if u128::from(since) >= RENEWAL.as_millis() || sent.1.elapsed() >= RENEWAL {
            sent = (walk.vehicle.up_ms(), Instant::now());
            let result = walk.vehicle.command_with(command, order, take)?;
            if result != MavResult::MAV_RESULT_ACCEPTED {
                return Ok(Err(ended(walk)?));
            }
        }
        if walk.user.answered().is_some() {
            return Ok(Err("stopped".to_owned()));
        }
        let [passed, length] = [passed, length].map(|ms| f64::from(ms) * 1e-3);
        let volts = measured.volts.last();
        let volts = volts.map_or("-".to_owned(), |volts| format!("{volts:.2}"));
        walk.user
            .live(&format!("  | {passed:.1} s of {length:.1} s, {volts} V"));
    }
}

/// Why the vehicle has ended a run: it said so before it refused the renewal.
fn ended(walk: &mut Walk<'_>) -> Result<String, Stop> {
    let mut texts = walk.vehicle.texts().into_iter();
    match texts.find(|text| text.starts_with("refused: ") && text != OVER) {
        Some(why) => Ok(why),
        None => Ok(walk.vehicle.reason()?),
    }
}

/// Thrust of rotor `rotor` (0 to 3), or of a mean one, at `command` by the parameters in force, N, at `voltage`, V.
pub(super) fn thrust(params: &Params, rotor: Option<usize>, command: f64, voltage: f64) -> f64 {
    let trims = [
        params.thrust_trim_1,
        params.thrust_trim_2,
        params.thrust_trim_3,
        params.thrust_trim_4,
    ];
    let trim = rotor.and_then(|rotor| trims.get(rotor)).copied().unwrap_or(1.0);
    let q = f64::from(params.thrust_curve);
    let ratio = (voltage / f64::from(params.battery_nominal)).powf(f64::from(params.thrust_volt_exp));
    f64::from(trim) * f64::from(params.thrust_max) * ratio * (q * command + 1.0 - q) * command
}

/// Command at which a mean rotor gives `newton` N at `voltage` V by the parameters, share of full drive, to a percent;
/// `None` beyond it.
pub(super) fn command(params: &Params, newton: f64, voltage: f64) -> Option<f64> {
    let mut commands = (1..=100).map(|percent| 0.01 * f64::from(percent));
    commands.find(|command| thrust(params, None, *command, voltage) >= newton)
}
