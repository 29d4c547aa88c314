//! Vibration with propellers on, the vehicle tied down: all rotors at about hover.

use sophie_control::vibration::MARK;

use super::tied;
use super::walk::{Verdict, Walk};
use super::{Judged, Step};

/// Time at the drive, s: rotors beat against each other.
const HOLD: f32 = 10.0;
/// Standard gravity, m/s².
const GRAVITY: f64 = 9.806_65;
/// Least number of seconds that count.
const SECONDS: usize = 3;

pub(super) fn vibration(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    let params = walk.vehicle.values()?.params();
    tied::warn(walk);
    walk.say("  | On foam or cords: a stiff stand holds still what shakes in flight.");
    let hover = 0.25 * f64::from(params.mass) * GRAVITY;
    let Some(command) = tied::command(&params, hover, f64::from(params.battery_nominal)) else {
        return Ok(Verdict::of(
            false,
            vec!["by the parameters four rotors do not lift it".to_owned()],
        ));
    };
    let percent = 100.0 * command;
    if let Some(refused) = tied::tied_down(walk)? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    walk.ask(&format!(
        "Enter runs all rotors at {percent:.0} % for {HOLD:.0} s:"
    ))?;
    let measured = match tied::run(walk, None, percent, HOLD, tied::number())? {
        Ok(measured) => measured,
        Err(why) => return Ok(Verdict::of(false, vec![why])),
    };
    Ok(judged(&measured))
}

fn judged(measured: &tied::Measured) -> Verdict {
    let seconds = measured.vibration.len();
    if seconds < SECONDS {
        let few = format!("{seconds} seconds of vibration came, {SECONDS} at least: another image?");
        return Verdict::of(false, vec![few]);
    }
    let rms: [f64; 3] = std::array::from_fn(|axis| {
        let squares: f64 = measured.vibration.iter().map(|second| second[axis].powi(2)).sum();
        (squares / seconds as f64).sqrt()
    });
    let [x, y, z] = rms;
    let sound = rms.iter().all(|axis| *axis <= f64::from(MARK));
    let mut figures = vec![format!("vibration {x:.1} {y:.1} {z:.1} m/s2 ({MARK} at most)")];
    if measured.clipped > 0 {
        figures.push(format!("{} readings at full scale", measured.clipped));
    }
    if !sound || measured.clipped > 0 {
        figures.push("balance each propeller; a bent shaft, a loose motor or board?".to_owned());
    }
    Verdict::of(sound && measured.clipped == 0, figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_square_of_the_seconds_passes_up_to_the_mark() {
        let of = |seconds: &[[f64; 3]], clipped| {
            judged(&tied::Measured {
                vibration: seconds.to_vec(),
                clipped,
                ..tied::Measured::default()
            })
        };
        let sound = of(&[[3.0, 1.0, 2.0], [9.0, 1.0, 2.0], [6.0, 1.0, 2.0]], 0);
        // √(126 / 3).
        assert_eq!(
            sound,
            Verdict::of(true, vec!["vibration 6.5 1.0 2.0 m/s2 (7 at most)".to_owned()])
        );
        assert!(!of(&[[3.0, 7.2, 2.0]; 3], 0).passed);
        assert!(!of(&[[1.0; 3]; 3], 1).passed, "one reading clipped");
        assert!(of(&[[1.0; 3]; 2], 0).figures[0].contains("2 seconds"));
    }
}
