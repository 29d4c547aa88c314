//! Step that measures the skin's friction on the pipe: numbers that the builder reads off two scales, and a fit.

use sophie_control::maths::scalar::GRAVITY;
use sophie_fit::friction::{self, Surface};
use sophie_fit::friction_data::Pull;

use super::walk::{Stop, Verdict, Walk};
use super::{Judged, Step};

/// Loads, g, the sled counted: 5 to 15 N, which the belly presses with.
const LOADS: &str = "500 1000 1500";
/// Pulls at each load.
const PULLS: usize = 2;

pub(super) fn friction(walk: &mut Walk<'_>, _: &Step) -> Judged {
    let loads = walk.numbers::<3>(
        &format!("Three loads in g by a kitchen scale, the sled counted; Enter for {LOADS}:"),
        Some(LOADS),
    )?;
    let mut pulls = Vec::new();
    pulled(walk, &loads, false, &mut pulls)?;
    if walk.one_of("The same on the wet pipe? y or n:", "yn")? == "y" {
        walk.say("  | Wet the pipe and the pads.");
        pulled(walk, &loads, true, &mut pulls)?;
    }
    let fitted = friction::fit(&pulls).and_then(|surfaces| {
        let least = friction::parameter(&surfaces)?;
        Ok((surfaces, least))
    });
    let (surfaces, least) = match fitted {
        Ok((surfaces, Some(least))) => (surfaces, least),
        Ok((_, None)) => return Ok(Verdict::of(false, vec!["no pulls".to_owned()])),
        Err(why) => return Ok(Verdict::of(false, vec![why])),
    };
    let mut figures: Vec<String> = surfaces.iter().map(figure).collect();
    let rounded = (least.value * 1e3).round() * 1e-3;
    match walk.set("pipe_friction", rounded as f32)? {
        Ok(change) => figures.push(change),
        Err(why) => return Ok(Verdict::of(false, vec![why])),
    }
    let mut verdict = Verdict::of(true, figures);
    verdict.parameters = walk.keep()?;
    Ok(verdict)
}

/// Asks for the pulls at each load.
fn pulled(walk: &mut Walk<'_>, loads: &[f32], wet: bool, pulls: &mut Vec<Pull>) -> Result<(), Stop> {
    for grams in loads {
        for _ in 0..PULLS {
            let question =
                format!("{grams} g: kg that start it, and kg that keep it sliding, such as 0.55 0.48:");
            let [starting, sliding] = walk
                .numbers::<2>(&question, None)?
                .map(|kg| f64::from(kg * GRAVITY));
            pulls.push(Pull {
                load: f64::from(grams * 1e-3 * GRAVITY),
                sliding,
                starting: (starting > 0.0).then_some(starting),
                wet,
            });
        }
    }
    Ok(())
}

/// What was found of one surface.
fn figure(surface: &Surface) -> String {
    let [sliding, adhesion] = [surface.sliding, surface.adhesion];
    let sticking = surface.sticking.map_or_else(String::new, |sticking| {
        format!(", to start {:.2} ± {:.2}", sticking.value, sticking.half)
    });
    format!(
        "{} pipe: sliding {:.3} ± {:.3}{sticking}, adhesion {:.1} ± {:.1} N",
        surface.name(),
        sliding.value,
        sliding.half,
        adhesion.value,
        adhesion.half
    )
}
