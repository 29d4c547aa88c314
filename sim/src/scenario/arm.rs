//! Checks that a scenario's numbers give valid arms for the plant and for the stack's model.
//!
//! Eq. 1 is a parabola in the thrust; the spring is its inverse, which needs a rising tilt, and the allocation
//! divides by the slope.

use toml::Spanned;
use toml::de::DeTable;

use super::Scenario;
use super::error::{Place, ScenarioError};
use super::source::{Result, Source, Value};
use crate::plant::GRAVITY;

/// Slope without thrust, rad/N (0.1 deg/N): at 0.02 the lightest vehicle's bending mode is too fast for the plant's
/// step of 0.5 ms.
const LEAST_RISE: f64 = 0.1 * DEGREE;
/// Largest tilt of a free arm at zero or full thrust, rad: beyond it the rotor pushes more inward than up.
const LARGEST_TILT: f64 = 90.0 * DEGREE;
const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// Keys of the simulated arm, in the order in which errors name them.
const BUILT: [&str; 8] = [
    "arm_coefficients",
    "arm_level_share",
    "gain_k",
    "infill",
    "arm_gain",
    "arm_offset_deg",
    "thrust_max_n",
    "mass_kg",
];
/// Parameters of the stack's arm model.
const STACK_PARAMS: [&str; 7] = ["arm_a1", "arm_a2", "arm_b1", "arm_b2", "gain_k", "infill", "mass"];

struct Slope {
    infill: f64,
    gain_k: f64,
    /// dα/dT without thrust, rad/N.
    linear: f64,
    /// Half of its change with thrust, rad/N².
    quadratic: f64,
    /// Thrust of a rotor in hover, N.
    hover: f64,
}

impl Slope {
    fn new([a1, a2, b1, b2]: [f64; 4], infill: f64, gain_k: f64, mass: f64) -> Self {
        Self {
            infill,
            gain_k,
            linear: gain_k * (a1 + a2 * infill) * DEGREE,
            quadratic: gain_k * (b1 + b2 * infill) * DEGREE,
            hover: 0.25 * mass * GRAVITY,
        }
    }

    /// Fault with `gain` times the nominal elastic term, and the allowed range.
    fn fault(&self, gain: f64) -> Option<String> {
        let at = |thrust: f64| gain * (self.linear + 2.0 * self.quadratic * thrust);
        let (still, hover) = (at(0.0), at(self.hover));
        let here = format!("infill {:.4} % and gain_k {:.4}", self.infill, self.gain_k);
        if still.is_nan() || still < LEAST_RISE {
            return Some(format!(
                "a tilt that rises without thrust by at least {:.2} deg/N, here {:.3} at {here}",
                LEAST_RISE / DEGREE,
                still / DEGREE
            ));
        }
        (hover.is_nan() || hover <= 0.0).then(|| {
            format!(
                "a tilt that still rises at hover, {:.2} N a rotor, here by {:.3} deg/N at {here}",
                self.hover,
                hover / DEGREE
            )
        })
    }
}

fn unbuilt(scenario: &Scenario) -> Option<String> {
    let v = &scenario.vehicle;
    let slope = Slope::new(v.arm_coefficients, v.infill, v.gain_k, v.body.mass);
    let thrust_max = v.rotor.thrust_max;
    (0..4).find_map(|arm| {
        if let Some(fault) = slope.fault(scenario.arm_softness(arm)) {
            return Some(fault);
        }
        let spec = scenario.arm_spec(arm);
        let tilt = [0.0, thrust_max].map(|thrust| spec.static_tilt(thrust));
        let far = tilt.into_iter().find(|t| t.is_nan() || t.abs() > LARGEST_TILT)?;
        Some(format!(
            "a tilt within {:.0} deg from no thrust to {thrust_max} N, here {:.0} deg at infill {:.4} % and gain_k {:.4}",
            LARGEST_TILT / DEGREE,
            far / DEGREE,
            v.infill,
            v.gain_k
        ))
    })
}

impl Source<'_> {
    /// Refuses numbers that are each allowed but give no arm.
    pub(super) fn arms(&self, root: &Spanned<DeTable<'_>>, scenario: &Scenario) -> Result<()> {
        if let Some(allowed) = unbuilt(scenario) {
            // The defaults are valid at every infill and gain of the command line: the file has a key.
            let (key, value) = named(root, "vehicle", &BUILT).ok_or_else(|| self.no_key(&allowed))?;
            return Err(self.bad(&key, value, allowed));
        }
        let p = &scenario.params;
        let coefficients = [p.arm_a1, p.arm_a2, p.arm_b1, p.arm_b2].map(f64::from);
        let slope = Slope::new(coefficients, p.infill.into(), p.gain_k.into(), p.mass.into());
        match (slope.fault(1.0), named(root, "params", &STACK_PARAMS)) {
            (Some(allowed), Some((key, value))) => Err(self.bad(&key, value, allowed)),
            _ => Ok(()),
        }
    }

    fn no_key(&self, allowed: &str) -> ScenarioError {
        ScenarioError::MissingKey {
            at: Place {
                file: self.file.to_owned(),
                line: 1,
            },
            key: "vehicle.arm_coefficients".to_owned(),
            allowed: allowed.to_owned(),
        }
    }
}

/// The first of `keys` in the file's `table`, by its full name.
fn named<'t, 'i>(
    root: &'t Spanned<DeTable<'i>>,
    table: &str,
    keys: &[&str],
) -> Option<(String, &'t Value<'i>)> {
    let content = super::source::table(root, table)?;
    keys.iter().find_map(|name| {
        let (_, value) = content.iter().find(|(key, _)| key.get_ref() == *name)?;
        Some((format!("{table}.{name}"), value))
    })
}
