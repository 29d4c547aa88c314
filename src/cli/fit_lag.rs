//! `sophie fit-lag`: the lag of a motor by the sound of a train of steps, as lines for the console of the board.

use sophie_control::params::Params;
use sophie_control::pilot::static_thrust_test::STEP_PLATEAU;
use sophie_fit::motor_lag;
use sophie_fit::rotor_sound::{self, Sound};
use sophie_terminal::console::{self, Console};

use super::args::FitLagArgs;

/// Fits the recording and prints the parameter.
pub fn run(args: &FitLagArgs) -> Result<bool, String> {
    let file = console::one_line(&args.sound.display().to_string());
    let sound = Sound::load(&args.sound)?;
    let found = rotor_sound::follow(&sound)
        .and_then(|track| motor_lag::fit(&track, f64::from(STEP_PLATEAU)))
        .map_err(|why| format!("{file}: {why}"))?;
    let lag = found.lag();
    let value = format!("{:.3}", lag.tau);
    let allowed = Params::row("motor_tau").filter(|row| !row.allows(lag.tau as f32));
    if let Some(row) = allowed {
        return Err(format!(
            "{file}: motor_tau = {value}: allowed are {} to {} {}",
            row.min, row.max, row.unit
        ));
    }
    let console = Console::new(false);
    console.say(&format!(
        "gains speed in {:.3} +- {:.3} s",
        found.up.tau, found.up.half
    ));
    console.say(&format!(
        "loses speed in {:.3} +- {:.3} s",
        found.down.tau, found.down.half
    ));
    console.say(&format!("motor_tau      {value} +- {:.3} s", lag.half));
    console.say(&format!(
        "95 % intervals, five steps each way to {:.2} times the speed; the law is within {:.1} % of a step",
        found.ratio,
        100.0 * found.misfit
    ));
    console.say("");
    console.say(&format!("set motor_tau {value}"));
    console.say("save");
    console.end()?;
    Ok(true)
}
