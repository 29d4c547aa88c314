//! Uncertain numbers of a vehicle, its day and its pipe: spread over builders, error after a calibration, and the
//! parameters that assume them.

use sophie_control::gripper::tendon::Reel;
use sophie_control::params::Params;

use super::{ROOM, Scenario};
use crate::plant::contact::ARM_LENGTH;
use crate::plant::tendon::{ServoSpec, TendonSpec};
use crate::sensors::fsr::FsrErrors;

/// How a number differs from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spread {
    /// Evenly between two multiples of it.
    Times(f64, f64),
    /// Evenly between two numbers added to it, in the key's unit.
    Plus(f64, f64),
    /// Evenly between two numbers, whatever it is, in the key's unit.
    Within(f64, f64),
    /// The same with its logarithm: each decade as often as another. Both positive.
    Decades(f64, f64),
}

impl Spread {
    /// The number that differs from `from` by `share`, 0 to 1, of the way from one end to the other.
    #[must_use]
    pub fn apply(self, from: f64, share: f64) -> f64 {
        let between = |low: f64, high: f64| low + share * (high - low);
        match self {
            Self::Times(low, high) => from * between(low, high),
            Self::Plus(low, high) => from + between(low, high),
            Self::Within(low, high) => between(low, high),
            Self::Decades(low, high) => low * libm::pow(high / low, share),
        }
    }

    /// For tables: `0.92 to 1.08 times`.
    #[must_use]
    pub fn text(self) -> String {
        match self {
            Self::Times(low, high) => format!("{low} to {high} times"),
            Self::Plus(low, high) if low == -high => format!("± {high}"),
            Self::Plus(low, high) => format!("{low:+} to {high:+}"),
            Self::Within(low, high) => format!("{low} to {high}"),
            Self::Decades(low, high) => format!("{low} to {high}, each decade as often"),
        }
    }
}

/// A measurement that a builder makes.
#[derive(Clone, Copy, Debug)]
pub struct Calibration {
    /// Command, or page of the handbook.
    pub by: &'static str,
    /// Difference of the result from the truth.
    pub error: Spread,
    /// Each of the key's numbers has an error of its own.
    pub apart: bool,
    /// Arming is refused without it.
    pub demanded: bool,
}

/// A quantity of the table.
pub struct Quantity {
    /// Scenario key of the truth; its unit is that of all numbers here.
    pub key: &'static str,
    /// Over builders and days: of the nominal value, the same for all of the key's numbers.
    pub all: Option<Spread>,
    /// In addition, of each of them.
    pub each: Option<Spread>,
    /// Its measurement; `None` if there is none.
    pub calibration: Option<Calibration>,
    /// The parameters follow it where everything is known.
    pub exact: bool,
    /// Source of the spread.
    pub source: &'static str,
    /// The truth; no numbers where the vehicle has no such part.
    pub truth: fn(&Scenario) -> Vec<f64>,
    /// What the parameters assume of each number; no numbers where nothing assumes it.
    pub assumed: fn(&Scenario) -> Vec<f64>,
    /// Sets the parameters by a measurement of each number.
    pub learn: fn(&mut Scenario, &[f64]),
}

/// Place of the lens, m.
const RULER: Calibration = Calibration {
    by: "ruler ([flow module](calibration.md#flow-module))",
    error: Spread::Plus(-0.005, 0.005),
    apart: false,
    demanded: false,
};
const DEGREE: f64 = core::f64::consts::PI / 180.0;
const PERCENT: f64 = 0.01;

/// What hands leave of a servo's mark, µs: half a degree of 270°.
const SERVO_MARK: Calibration = Calibration {
    by: "`calibrate servo` ([servos](calibration.md#servos))",
    error: Spread::Plus(-4.0, 4.0),
    apart: true,
    demanded: true,
};

/// Neither spread nor measured nor assumed.
const FIXED: Quantity = Quantity {
    key: "",
    all: None,
    each: None,
    calibration: None,
    exact: false,
    source: "",
    truth: |_| Vec::new(),
    assumed: |_| Vec::new(),
    learn: |_, _| (),
};

/// Sets parameters to numbers, one each.
fn set<const N: usize>(rows: [&mut f32; N], numbers: &[f64]) {
    for (row, number) in rows.into_iter().zip(numbers) {
        *row = *number as f32;
    }
}

/// The quantities, vehicle first, then sensors and pipe.
pub const QUANTITIES: &[Quantity] = &[
    Quantity {
        key: "vehicle.mass_kg",
        all: Some(Spread::Times(0.92, 1.08)),
        calibration: Some(Calibration {
            by: "kitchen scale ([tuning](tuning.md), 1)",
            error: Spread::Times(0.99, 1.01),
            apart: false,
            demanded: false,
        }),
        exact: true,
        source: "4S batteries differ by 0.1 kg, prints by 5 % (assumed)",
        truth: |s| vec![s.vehicle.body.mass],
        assumed: |s| vec![s.params.mass.into()],
        learn: |s, n| set([&mut s.params.mass], n),
        ..FIXED
    },
    Quantity {
        key: "vehicle.inertia_kgm2",
        each: Some(Spread::Times(0.7, 1.3)),
        exact: true,
        source: "derived from the parts ([physics](design/physics.md)), 30 %",
        truth: |s| s.vehicle.body.inertia.to_vec(),
        assumed: |s| {
            let p = &s.params;
            [p.inertia_roll, p.inertia_pitch, p.inertia_yaw]
                .map(f64::from)
                .to_vec()
        },
        learn: |s, n| {
            let p = &mut s.params;
            set([&mut p.inertia_roll, &mut p.inertia_pitch, &mut p.inertia_yaw], n);
        },
        ..FIXED
    },
    Quantity {
        key: "vehicle.thrust_max_n",
        all: Some(Spread::Times(0.9, 1.12)),
        calibration: Some(Calibration {
            by: "`bringup`'s step `thrust` ([static thrust](calibration.md#static-thrust)), with the day's air and the four \
                 rotors' mean; by the throttle in hover alone ([tuning](tuning.md), 1) 5 %",
            error: Spread::Times(0.98, 1.02),
            apart: false,
            demanded: false,
        }),
        exact: true,
        source: "motors, propellers and their controllers 10 % (assumed of published tables)",
        truth: |s| vec![s.vehicle.rotor.thrust_max],
        assumed: |s| vec![f64::from(s.params.thrust_max) / received(s)],
        learn: |s, n| {
            let received = received(s);
            set(
                [&mut s.params.thrust_max],
                &n.iter().map(|n| n * received).collect::<Vec<_>>(),
            );
        },
        ..FIXED
    },
    Quantity {
        key: "vehicle.rotor_thrust",
        each: Some(Spread::Times(0.95, 1.05)),
        calibration: Some(Calibration {
            by: "`bringup`'s step `thrust`",
            error: Spread::Times(0.985, 1.015),
            apart: true,
            demanded: false,
        }),
        exact: true,
        source: "propellers and motors of one kind (assumed)",
        truth: |s| s.vehicle.rotor_thrust.to_vec(),
        assumed: |s| {
            // What is common to the four is part of `thrust_max`.
            let (p, mean) = (&s.params, mean(&s.vehicle.rotor_thrust));
            [p.thrust_trim_1, p.thrust_trim_2, p.thrust_trim_3, p.thrust_trim_4]
                .map(|trim| f64::from(trim) * mean)
                .to_vec()
        },
        learn: |s, n| {
            let mean = mean(n);
            let (p, shares) = (&mut s.params, n.iter().map(|n| n / mean).collect::<Vec<_>>());
            set(
                [
                    &mut p.thrust_trim_1,
                    &mut p.thrust_trim_2,
                    &mut p.thrust_trim_3,
                    &mut p.thrust_trim_4,
                ],
                &shares,
            );
        },
        ..FIXED
    },
    Quantity {
        key: "world.air_density_kg_m3",
        all: Some(Spread::Within(1.02, 1.34)),
        source: "35 °C at 1,000 m to -10 °C at sea level; in the hover's throttle",
        truth: |s| vec![s.world.air.density],
        ..FIXED
    },
    Quantity {
        key: "vehicle.thrust_voltage_power",
        all: Some(Spread::Within(1.5, 2.0)),
        calibration: Some(Calibration {
            by: "`bringup`'s step `thrust`, with a fresh battery and a used one",
            error: Spread::Plus(-0.11, 0.11),
            apart: false,
            demanded: false,
        }),
        exact: true,
        source: "1.7 in recordings of others' flights; the stack takes 2",
        truth: |s| s.vehicle.rotor.voltage_power.into_iter().collect(),
        assumed: |s| vec![s.params.thrust_volt_exp.into()],
        learn: |s, n| set([&mut s.params.thrust_volt_exp], n),
        ..FIXED
    },
    Quantity {
        key: "vehicle.heat_fade_percent",
        all: Some(Spread::Within(0.0, 5.0)),
        source: "3 to 5 % in long hover are usual",
        truth: |s| vec![100.0 * s.vehicle.rotor.heat_fade],
        ..FIXED
    },
    Quantity {
        key: "vehicle.battery_age",
        all: Some(Spread::Within(1.0, 2.0)),
        source: "cells of 5 to 12 mΩ, twice as much at 0 °C or after 200 cycles (assumed)",
        truth: |s| vec![s.vehicle.battery_age],
        ..FIXED
    },
    Quantity {
        key: "vehicle.battery_sag_ohm",
        all: Some(Spread::Within(0.005, 0.03)),
        source: "as large as the resistance itself (assumed), within 10 to 30 s",
        truth: |s| vec![s.vehicle.battery_sag],
        ..FIXED
    },
    Quantity {
        key: "vehicle.motor_tau_s",
        all: Some(Spread::Within(0.04, 0.10)),
        calibration: Some(Calibration {
            by: "`bringup`'s step `lag`, by sound ([lag](calibration.md#lag-of-the-motors)), the mean of rise and fall",
            error: Spread::Times(0.87, 1.13),
            apart: false,
            demanded: false,
        }),
        exact: true,
        source: "0.0125 up and 0.025 s down (RotorS, a small one) to 0.17 s (2212-920, 9450, 30 A on PWM: \
                 CrissCCL/DIY_UAV_Motor_System_Identification)",
        truth: |s| vec![s.vehicle.rotor.spin.up],
        assumed: |s| vec![f64::from(s.params.motor_tau) / mean_over_rise(s)],
        learn: |s, n| {
            let mean = mean_over_rise(s);
            set(
                [&mut s.params.motor_tau],
                &n.iter().map(|n| n * mean).collect::<Vec<_>>(),
            );
        },
        ..FIXED
    },
    Quantity {
        key: "vehicle.motor_tau_down_s",
        all: Some(Spread::Within(0.04, 0.17)),
        source: "0.12 s up and 0.17 s down (the same); as fast as up where the controller brakes",
        truth: |s| s.vehicle.rotor.spin.down.into_iter().collect(),
        assumed: |s| vec![s.params.motor_tau.into()],
        ..FIXED
    },
    Quantity {
        key: "vehicle.motor_delay_s",
        all: Some(Spread::Within(0.0, 0.008)),
        source: "3 to 8 ms of controllers on pulses (assumed)",
        truth: |s| vec![s.vehicle.rotor.delay],
        ..FIXED
    },
    Quantity {
        key: "vehicle.torque_ratio_m",
        all: Some(Spread::Times(0.88, 1.12)),
        exact: true,
        source: "0.0164 m of an APC SF 10x4.7 (UIUC propeller data), 12 % from type to type",
        truth: |s| vec![s.vehicle.rotor.torque_ratio],
        assumed: |s| vec![s.params.torque_ratio.into()],
        learn: |s, n| set([&mut s.params.torque_ratio], n),
        ..FIXED
    },
    Quantity {
        key: "vehicle.gain_k",
        exact: true,
        source: "Table III of the paper needs 5.0 to 8.4; `arm_gain` varies it",
        truth: |s| vec![s.vehicle.gain_k],
        learn: |s, n| set([&mut s.params.gain_k], n),
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_coefficients",
        exact: true,
        source: "Table I of the paper; `arm_gain` varies it",
        truth: |s| s.vehicle.arm_coefficients.to_vec(),
        learn: |s, n| {
            let p = &mut s.params;
            set([&mut p.arm_a1, &mut p.arm_a2, &mut p.arm_b1, &mut p.arm_b2], n);
        },
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_level_share",
        all: Some(Spread::Plus(-0.05, 0.05)),
        calibration: Some(Calibration {
            by: "`bringup`'s step `arm-table`, `sophie fit-arm` ([arms](calibration.md#arms))",
            error: Spread::Plus(-0.02, 0.02),
            apart: false,
            demanded: false,
        }),
        exact: true,
        source: "an arm printed 1.5° off level at rest (assumed)",
        truth: |s| {
            let by_share = s.vehicle.arm_level.is_none();
            by_share
                .then_some(s.vehicle.arm_level_share)
                .into_iter()
                .collect()
        },
        assumed: |s| vec![s.params.arm_level_share.into()],
        learn: |s, n| set([&mut s.params.arm_level_share], n),
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_level_n",
        all: Some(Spread::Within(3.7, 4.6)),
        calibration: Some(Calibration {
            by: "`bringup`'s step `arm-table`, `sophie fit-arm` ([arms](calibration.md#arms))",
            error: Spread::Plus(-0.17, 0.17),
            apart: false,
            demanded: false,
        }),
        exact: true,
        source: "an arm printed 1.5° off level at rest (assumed); without the key `arm_level_share` times the largest thrust",
        truth: |s| s.vehicle.arm_level.into_iter().collect(),
        assumed: |s| vec![f64::from(s.params.arm_level_share * s.params.thrust_max)],
        learn: |s, n| {
            let p = &mut s.params;
            let thrust_max = f64::from(p.thrust_max);
            set(
                [&mut p.arm_level_share],
                &n.iter().map(|n| n / thrust_max).collect::<Vec<_>>(),
            );
        },
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_gain",
        all: Some(Spread::Times(0.7, 1.4)),
        each: Some(Spread::Times(0.93, 1.07)),
        calibration: Some(Calibration {
            by: "`bringup`'s step `arm-table`, `sophie fit-arm` ([arms](calibration.md#arms)): one equation for four arms",
            error: Spread::Times(0.95, 1.05),
            apart: false,
            demanded: false,
        }),
        source: "TPU at 24 to 247 MPa by rate and batch (Haid 2023), 1.25 at 5 °C to 0.7 at 40 °C (Covestro Texin 245); print \
                 to print 7 % (assumed)",
        truth: |s| s.vehicle.arm_gain.to_vec(),
        learn: |s, gains| {
            // Into the coefficients: gain_k has less room.
            let mean = mean(gains);
            let (v, p) = (&s.vehicle, &mut s.params);
            let scale = mean * v.gain_k / f64::from(p.gain_k);
            let found = v.arm_coefficients.map(|c| c * scale);
            set(
                [&mut p.arm_a1, &mut p.arm_a2, &mut p.arm_b1, &mut p.arm_b2],
                &found,
            );
        },
        assumed: |s| vec![assumed_gain(s); 4],
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_offset_deg",
        each: Some(Spread::Plus(-3.0, 3.0)),
        source: "print and glue (assumed); `arm-table` shows each arm's to 1.9°, the parameters are common to the four; the arms' \
                 sensors see it in flight",
        truth: |s| s.vehicle.arm_offset.map(|offset| offset / DEGREE).to_vec(),
        assumed: |_| vec![0.0; 4],
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_damping",
        all: Some(Spread::Within(0.05, 0.15)),
        source: "TPU's loss factor of 0.1 to 0.3 (assumed); the notch is set by hand",
        truth: |s| vec![s.vehicle.arm_damping],
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_torsion",
        all: Some(Spread::Within(0.5, 2.0)),
        calibration: Some(Calibration {
            by: "`sophie bringup`, step `twist` ([arms](calibration.md#arms)), for `sophie check`; no parameter has it",
            error: Spread::Times(0.96, 1.04),
            apart: false,
            demanded: false,
        }),
        exact: true,
        source: "derived of a square section; infill and skin share it differently (assumed)",
        truth: |s| vec![s.vehicle.arm_torsion],
        assumed: |s| vec![s.measured.arm_torsion],
        learn: |s, n| {
            if let [torsion] = n {
                s.measured.arm_torsion = *torsion;
            }
        },
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_temperature_percent_k",
        all: Some(Spread::Within(1.0, 1.7)),
        source: "1.25 times the stiffness at 5 °C, 0.7 to 0.8 at 40 °C (Covestro Texin 245)",
        truth: |s| vec![s.vehicle.arm_warming / PERCENT],
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_stiffening",
        all: Some(Spread::Within(0.2, 0.8)),
        source: "up to 2.8 times from 0.006 to 16 1/s (Haid 2023): 1.5 to 2 at 5 Hz over a bench's minutes",
        truth: |s| vec![s.vehicle.arm_material.stiffening],
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_relaxation_percent",
        all: Some(Spread::Within(2.0, 6.0)),
        source: "5 % per decade; compression set 18 % in 22 h (Covestro Texin 245)",
        truth: |s| vec![s.vehicle.arm_material.relaxation / PERCENT],
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_first_cycles_percent",
        all: Some(Spread::Within(0.0, 20.0)),
        source: "10 to 20 % in the first five to ten closings of a new arm (Eng. Proc. 85, 18), none later",
        truth: |s| vec![s.vehicle.arm_material.first_cycles / PERCENT],
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_in_plane_hz",
        all: Some(Spread::Within(4.0, 7.5)),
        source: "3.5 Hz of EI 0.11 N m², more with a wider root (estimated; Fig. 4 of the paper shows the bend)",
        truth: |s| s.vehicle.arm_in_plane.into_iter().collect(),
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_in_plane_damping",
        all: Some(Spread::Within(0.05, 0.15)),
        source: "as `arm_damping`",
        truth: |s| vec![s.vehicle.arm_in_plane_damping],
        ..FIXED
    },
    Quantity {
        key: "vehicle.servo_release_us",
        each: Some(Spread::Plus(0.0, 100.0)),
        calibration: Some(SERVO_MARK),
        exact: true,
        source: "a tooth of the horn's spline: 14° of 270°, 100 µs",
        truth: |s| s.vehicle.servo_release.to_vec(),
        assumed: |s| servo_pulses(s, 0.0),
        learn: |s, n| {
            let p = &mut s.params;
            set(
                [
                    &mut p.servo_release_1,
                    &mut p.servo_release_2,
                    &mut p.servo_release_3,
                    &mut p.servo_release_4,
                ],
                &servo_marks(n),
            );
        },
        ..FIXED
    },
    Quantity {
        key: "vehicle.servo_full_us",
        each: Some(Spread::Plus(-100.0, 0.0)),
        calibration: Some(SERVO_MARK),
        exact: true,
        source: "travel of one type differs by 5 % (assumed)",
        truth: |s| s.vehicle.servo_full.to_vec(),
        assumed: |s| servo_pulses(s, s.params.servo_range),
        learn: |s, n| {
            let p = &mut s.params;
            set(
                [
                    &mut p.servo_full_1,
                    &mut p.servo_full_2,
                    &mut p.servo_full_3,
                    &mut p.servo_full_4,
                ],
                &servo_marks(n),
            );
        },
        ..FIXED
    },
    Quantity {
        key: "vehicle.pad_restitution",
        all: Some(Spread::Within(0.65, 0.75)),
        source: "TPU: resilience 45 % (Covestro Texin 245), foamed 65 to 74 %; damping ratio 0.05 to 0.13",
        truth: |s| vec![s.vehicle.pad_restitution],
        ..FIXED
    },
    Quantity {
        key: "vehicle.servo_stop_deg",
        all: Some(Spread::Within(0.5, 2.5)),
        source: "1.8 to 2.6° at 15 kgcm, backlash included (STS3215, TheRobotStudio/SO-ARM100 #134); a dead band of 2 to \
                 10 µs with stiction",
        truth: |s| vec![s.vehicle.servos.stop / DEGREE],
        assumed: |_| vec![0.0],
        ..FIXED
    },
    Quantity {
        key: "vehicle.servo_backlash_deg",
        all: Some(Spread::Within(0.2, 1.0)),
        source: "about 1° (STS3215, TheRobotStudio/SO-ARM100 #134)",
        truth: |s| vec![s.vehicle.servos.backlash / DEGREE],
        assumed: |_| vec![0.0],
        ..FIXED
    },
    Quantity {
        key: "vehicle.servo_sag_deg_n_m",
        all: Some(Spread::Within(0.5, 2.0)),
        source: "1.8 to 2.6° at 1.47 N m, backlash included (STS3215, TheRobotStudio/SO-ARM100 #134)",
        truth: |s| vec![s.vehicle.servos.sag / DEGREE],
        assumed: |_| vec![0.0],
        ..FIXED
    },
    Quantity {
        key: "vehicle.servo_drift_deg_10k",
        each: Some(Spread::Plus(-1.0, 1.0)),
        source: "assumed; up to 30° at -5 °C is reported of an analog servo (roboternetz)",
        truth: |s| {
            s.vehicle
                .servos
                .drift
                .map(|drift| drift / (0.1 * DEGREE))
                .to_vec()
        },
        assumed: |_| vec![0.0; 4],
        ..FIXED
    },
    Quantity {
        key: "vehicle.servo_stall_share",
        all: Some(Spread::Within(0.65, 1.0)),
        each: Some(Spread::Times(0.95, 1.05)),
        source: "6 to 7.5 kgcm held of 9.4 to 11 on the label (MG995, MG996R at 6 V: three forum measurements)",
        truth: |s| s.vehicle.servos.stall.to_vec(),
        assumed: |s| vec![f64::from(s.params.servo_stall) / ServoSpec::from(s.vehicle.servo).stall; 4],
        ..FIXED
    },
    Quantity {
        key: "vehicle.servo_heat_k",
        all: Some(Spread::Within(100.0, 400.0)),
        source: "an MG996R burns in 10 to 15 min under load (robotics.stackexchange 8103): 350 K; better cooled ones less \
                 (assumed)",
        truth: |s| vec![s.vehicle.servos.heat],
        assumed: |_| vec![0.0],
        ..FIXED
    },
    Quantity {
        key: "vehicle.tendon_stiffness_n_m",
        all: Some(Spread::Within(2000.0, 8000.0)),
        each: Some(Spread::Times(0.9, 1.1)),
        calibration: Some(Calibration {
            by: "steps of the servo with and without a weight ([tendons](calibration.md#tendons)): one for four arms",
            error: Spread::Times(0.95, 1.2),
            apart: false,
            demanded: false,
        }),
        exact: true,
        source: "1 mm of nylon, 0.25 m: 7,900 dry (E 2.5 GPa), 3,100 to 3,800 conditioned; knots, anchor in TPU and mount: \
                 2,000 to 4,000 (estimated)",
        truth: |s| s.vehicle.tendons.stiffness.to_vec(),
        assumed: |s| vec![s.params.tendon_stiffness.into(); 4],
        learn: |s, n| set([&mut s.params.tendon_stiffness], &[mean(n)]),
    },
    Quantity {
        key: "vehicle.tendon_friction",
        all: Some(Spread::Within(0.1, 0.6)),
        each: Some(Spread::Times(0.8, 1.2)),
        source: "0.1 to 0.3 lined with PTFE, 0.3 to 0.6 in TPU (handbooks)",
        truth: |s| s.vehicle.tendons.friction.to_vec(),
        assumed: |_| vec![0.0; 4],
        ..FIXED
    },
    Quantity {
        key: "vehicle.tendon_creep_percent",
        all: Some(Spread::Within(2.0, 5.0)),
        source: "nylon: 2 to 5 % of its strain per decade (handbooks)",
        truth: |s| vec![s.vehicle.tendons.creep / PERCENT],
        assumed: |_| vec![0.0],
        ..FIXED
    },
    Quantity {
        key: "vehicle.tendon_lever_share",
        each: Some(Spread::Times(0.95, 1.05)),
        source: "a channel printed 0.75 mm off (assumed)",
        truth: |s| s.vehicle.tendons.lever.to_vec(),
        assumed: |s| {
            let nominal = TendonSpec::of(s.vehicle.arm_bending).lever;
            vec![f64::from(s.params.tendon_lever) / nominal; 4]
        },
        ..FIXED
    },
    Quantity {
        key: "vehicle.reel_radius_share",
        each: Some(Spread::Times(0.96, 1.04)),
        source: "printed ± 0.3 mm, thread on thread ± 0.5 mm (assumed)",
        truth: |s| s.vehicle.tendons.reel_radius.to_vec(),
        assumed: |s| {
            let nominal = TendonSpec::default().reel_radius;
            vec![f64::from(s.params.reel_radius) / nominal; 4]
        },
        ..FIXED
    },
    Quantity {
        key: "faults.tendon_slack_mm",
        each: Some(Spread::Plus(-0.5, 2.0)),
        calibration: Some(Calibration {
            by: "steps of the servo ([tendons](calibration.md#tendons)), its play and backlash included",
            error: Spread::Plus(-0.4, 1.5),
            apart: true,
            demanded: false,
        }),
        source: "a knot by hand; 1 to 2 mm a day by creep (assumed)",
        truth: |s| s.faults.tendon_slack.map(|slack| slack / 1e-3).to_vec(),
        assumed: |s| {
            let wound = trims(&s.params).into_iter().zip(thread_per_us(&s.params));
            wound
                .map(|(trim, thread)| f64::from(trim) * thread / 1e-3)
                .collect()
        },
        learn: |s, n| {
            let most = Params::row("servo_trim_1").map_or(0.0, |row| f64::from(row.max));
            let wound = n.iter().zip(thread_per_us(&s.params));
            let trims: Vec<f64> = wound
                .map(|(slack, thread)| (1e-3 * slack / thread).clamp(-most, most))
                .collect();
            let p = &mut s.params;
            set(
                [
                    &mut p.servo_trim_1,
                    &mut p.servo_trim_2,
                    &mut p.servo_trim_3,
                    &mut p.servo_trim_4,
                ],
                &trims,
            );
        },
        ..FIXED
    },
    Quantity {
        key: "faults.pressure_gain",
        each: Some(Spread::Times(0.8, 1.2)),
        calibration: Some(Calibration {
            by: "`calibrate fsr` ([pressure sensors](calibration.md#pressure-sensors)): slope of the line",
            error: Spread::Times(1.04, 1.12),
            apart: true,
            demanded: false,
        }),
        source: "Interlink's guide: 15 to 25 % from part to part; repeatability 12 to 16 % (J. Sensors 6561901)",
        truth: |s| s.faults.pressure_gain.to_vec(),
        assumed: |s| fsr_trims(s).to_vec(),
        learn: |s, n| {
            let p = &mut s.params;
            set(
                [
                    &mut p.fsr_trim_1,
                    &mut p.fsr_trim_2,
                    &mut p.fsr_trim_3,
                    &mut p.fsr_trim_4,
                ],
                n,
            );
        },
        ..FIXED
    },
    Quantity {
        key: "vehicle.vibration_m_s2",
        all: Some(Spread::Within(0.5, 4.0)),
        source: "up to 15 m/s² of all rotors on three axes are normal (ArduPilot, measuring vibration; 3DR's Iris); `bringup`'s step \
                 `vibration` passes all of these: its mark is at 7",
        truth: |s| vec![s.vehicle.vibration.once],
        ..FIXED
    },
    Quantity {
        key: "vehicle.vibration_twice",
        all: Some(Spread::Within(0.2, 0.8)),
        source: "two blades over an arm (assumed)",
        truth: |s| vec![s.vehicle.vibration.twice],
        ..FIXED
    },
    Quantity {
        key: "vehicle.platform_hz",
        all: Some(Spread::Within(25.0, 60.0)),
        source: "270 g of printed TPU that carry flight controller and battery (estimated)",
        truth: |s| s.vehicle.vibration.platform.into_iter().collect(),
        ..FIXED
    },
    Quantity {
        key: "sensors.fsr_turn_on_n",
        each: Some(Spread::Within(0.1, 0.8)),
        calibration: Some(Calibration {
            by: "`calibrate fsr` ([pressure sensors](calibration.md#pressure-sensors)): the line at the grip pressure, \
                 which it reads 0.5 to 4.6 % low",
            error: Spread::Plus(-0.063, -0.007),
            apart: true,
            demanded: false,
        }),
        source: "0.2 N (Interlink's data sheet), break force 20 to 100 g (guide)",
        truth: |s| s.sensors.pressure.turn_on.to_vec(),
        assumed: |s| {
            let arms = zeros(s).into_iter().zip(s.sensors.pressure.preload);
            arms.map(|(zero, preload)| (preload * pipe_bend(s) - zero).max(0.0))
                .collect()
        },
        learn: |s, n| {
            let found = lines_through_the_grip(s, n);
            let p = &mut s.params;
            set(
                [
                    &mut p.fsr_zero_1,
                    &mut p.fsr_zero_2,
                    &mut p.fsr_zero_3,
                    &mut p.fsr_zero_4,
                ],
                &found,
            );
        },
        ..FIXED
    },
    Quantity {
        key: "sensors.fsr_preload_n",
        each: Some(Spread::Within(0.0, 0.3)),
        source: "curvature, compliance and shear shift the calibration (Schofield, PMC5903557; Swanson, PMC6808001); number \
                 assumed. An arm bent as on the pipe has it in the turn-on force that `calibrate fsr` finds",
        truth: |s| s.sensors.pressure.preload.to_vec(),
        // In the same parameter as the turn-on force.
        assumed: |s| {
            let arms = zeros(s).into_iter().zip(s.sensors.pressure.turn_on);
            arms.map(|(zero, turn_on)| ((zero + turn_on) / pipe_bend(s)).max(0.0))
                .collect()
        },
        ..FIXED
    },
    Quantity {
        key: "sensors.fsr_hysteresis_percent",
        all: Some(Spread::Within(5.0, 10.0)),
        calibration: Some(Calibration {
            by: "`calibrate fsr` shows it; the line is between rising and falling pressure",
            error: Spread::Plus(0.6, 3.2),
            apart: false,
            demanded: false,
        }),
        source: "10 % on average (Interlink's data sheet), Preisach-like (Paredes-Madrid 2018)",
        truth: |s| vec![s.sensors.pressure.hysteresis / PERCENT],
        assumed: |_| vec![FsrErrors::default().hysteresis / PERCENT],
        ..FIXED
    },
    Quantity {
        key: "sensors.fsr_drift_percent",
        all: Some(Spread::Within(3.0, 5.0)),
        source: "below 5 % per decade (Interlink's data sheet, 1 kg for 35 days)",
        truth: |s| vec![s.sensors.pressure.drift / PERCENT],
        assumed: |_| vec![0.0],
        ..FIXED
    },
    Quantity {
        key: "sensors.fsr_temperature_percent_k",
        all: Some(Spread::Within(-0.15, 0.25)),
        source: "15 % less resistance at 85 °C, 10 % more at 85 °C and humid (Interlink's data sheet), over 62 K",
        truth: |s| vec![s.sensors.pressure.temperature / PERCENT],
        assumed: |_| vec![0.0],
        ..FIXED
    },
    Quantity {
        key: "sensors.fsr_pad_share",
        each: Some(Spread::Times(0.85, 1.15)),
        source: "12 % from perch to perch by how the pad lies (estimated); the guide calls it very sensitive to the force's \
                 distribution",
        truth: |s| s.sensors.pressure.pad_share.to_vec(),
        assumed: |_| vec![1.0; 4],
        ..FIXED
    },
    Quantity {
        key: "sensors.tilt_dead_zone_deg_s",
        all: Some(Spread::Within(0.0, 5.0)),
        source: "stands still at 3 °/s, follows from 5 to 10 °/s on (boschsensortec/BNO055_SensorAPI #12)",
        truth: |s| vec![s.sensors.tilt.dead_zone / DEGREE],
        assumed: |_| vec![0.0],
        ..FIXED
    },
    Quantity {
        key: "sensors.tilt_step_deg",
        all: Some(Spread::Within(0.0, 1.0)),
        source: "jumps of about a degree are reported of its running calibration (assumed)",
        truth: |s| vec![s.sensors.tilt.step / DEGREE],
        assumed: |_| vec![0.0],
        ..FIXED
    },
    Quantity {
        key: "sensors.tilt_vibration_m_s2",
        all: Some(Spread::Within(1.0, 9.0)),
        source: "at an arm's tip, by its rotor's imbalance at 600 rad/s: 8.6 by 0.3 mm at 12 g (estimated)",
        truth: |s| vec![s.sensors.tilt.vibration],
        assumed: |_| vec![0.0],
        ..FIXED
    },
    Quantity {
        key: "sensors.flow_x_m",
        calibration: Some(RULER),
        exact: true,
        source: "as mounted",
        truth: |s| lens(s, 0),
        assumed: |s| vec![s.params.flow_x.into()],
        learn: |s, n| set([&mut s.params.flow_x], n),
        ..FIXED
    },
    Quantity {
        key: "sensors.flow_y_m",
        calibration: Some(RULER),
        exact: true,
        source: "as mounted",
        truth: |s| lens(s, 1),
        assumed: |s| vec![s.params.flow_y.into()],
        learn: |s, n| set([&mut s.params.flow_y], n),
        ..FIXED
    },
    Quantity {
        key: "sensors.flow_z_m",
        calibration: Some(RULER),
        exact: true,
        source: "as mounted",
        truth: |s| lens(s, 2),
        assumed: |s| vec![s.params.flow_z.into()],
        learn: |s, n| set([&mut s.params.flow_z], n),
        ..FIXED
    },
    Quantity {
        key: "vehicle.inflow_share",
        all: Some(Spread::Within(0.7, 1.3)),
        source: "0.22 N per m/s and rotor of an APC SF 10x4.7 (UIUC propeller data), 30 % from type to type (assumed)",
        truth: |s| vec![s.vehicle.air.inflow],
        ..FIXED
    },
    Quantity {
        key: "vehicle.drag_n_s_m",
        all: Some(Spread::Within(0.17, 0.38)),
        source: "0.175 (RotorS), 0.33 (Faessler), 0.38 N s/m (PX4's Iris)",
        truth: |s| vec![s.vehicle.air.drag.linear],
        ..FIXED
    },
    Quantity {
        key: "vehicle.drag_area_m2",
        all: Some(Spread::Within(0.03, 0.05)),
        source: "platform, battery and arms (assumed)",
        truth: |s| vec![s.vehicle.air.drag.area],
        ..FIXED
    },
    Quantity {
        key: "vehicle.flapping_deg_s_m",
        all: Some(Spread::Within(0.0, 0.3)),
        source: "0.3° per m/s of a hinged blade, stiff ones less",
        truth: |s| vec![s.vehicle.air.drag.flapping / DEGREE],
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_wash_percent",
        all: Some(Spread::Within(1.7, 5.0)),
        source: "arms of 6 to 22 mm under a 5-inch propeller (a bench of shendrones); in the hover's throttle",
        truth: |s| vec![100.0 * s.vehicle.air.wash.loss],
        ..FIXED
    },
    Quantity {
        key: "vehicle.arm_buffet_percent",
        all: Some(Spread::Within(0.5, 2.0)),
        source: "assumed (arXiv 2502.12716 names it)",
        truth: |s| vec![100.0 * s.vehicle.air.wash.buffet],
        ..FIXED
    },
    Quantity {
        key: "world.ground_effect",
        all: Some(Spread::Within(0.8, 1.2)),
        source: "Sanchez-Cuevas 2017, and its scatter",
        truth: |s| vec![s.world.air.ground_effect],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_ground_effect",
        all: Some(Spread::Within(0.2, 1.5)),
        source: "between an image of the pipe and the disc's share over it; rough surfaces raise it (estimated)",
        truth: |s| vec![s.world.air.pipe_ground_effect],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_shedding",
        all: Some(Spread::Within(0.0, 0.3)),
        source: "lift of a cylinder's wake (assumed): 0.1 to 0.3 N at 2 Hz in 3 m/s",
        truth: |s| vec![s.world.air.wind.shedding],
        ..FIXED
    },
    Quantity {
        key: "sensors.flow_noise_mrad",
        all: Some(Spread::Within(2.4, 4.8)),
        source: "2.65 to 4.84 mrad in 20 ms, 2.5 to 4.1 in 10 ms of a PMW3901 (flights of a Crazyflie, Bitcraze's positioning data set)",
        truth: |s| {
            s.sensors
                .flow_noise
                .map(|noise| 1e3 * noise)
                .into_iter()
                .collect()
        },
        ..FIXED
    },
    Quantity {
        key: "sensors.pose_dropout_share",
        all: Some(Spread::Within(0.0, 0.3)),
        source: "markers covered or blurred (assumed)",
        truth: |s| vec![s.sensors.pose_dropout_share],
        ..FIXED
    },
    Quantity {
        key: "sensors.pose_tag_size_m",
        all: Some(Spread::Within(0.1, 0.2)),
        source: "a tag that a pipe has room for (assumed); with it 20 to 50 mm at 2.5 to 4 m",
        truth: |s| s.sensors.pose_tag_size.into_iter().collect(),
        ..FIXED
    },
    Quantity {
        key: "sensors.pose_outlier_share",
        all: Some(Spread::Within(0.0, 0.05)),
        source: "the other pose of a planar tag (Schweighofer and Pinz 2006; the share is assumed)",
        truth: |s| vec![s.sensors.pose_outlier_share],
        ..FIXED
    },
    Quantity {
        key: "world.temperature_c",
        all: Some(Spread::Within(5.0, 35.0)),
        source: "days on which it flies",
        truth: |s| vec![s.world.temperature],
        assumed: |_| vec![ROOM],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_friction",
        all: Some(Spread::Within(0.2, 0.8)),
        calibration: Some(Calibration {
            by: "`sophie bringup`, friction, or `sophie fit-arm --friction`: pads on the pipe, by a luggage scale \
                 ([friction](calibration.md#friction-on-the-pipe))",
            error: Spread::Times(0.935, 1.065),
            apart: false,
            demanded: false,
        }),
        source: "urethane on steel 0.2 to 2.5, wet or dusty 0.15 to 0.4 (Polydrive, Gallagher: tables)",
        truth: |s| vec![s.world.pipe_friction],
        assumed: |s| vec![s.params.pipe_friction.into()],
        learn: |s, n| set([&mut s.params.pipe_friction], n),
        ..FIXED
    },
    Quantity {
        key: "world.pipe_diameter_m",
        all: Some(Spread::Within(0.2, 0.4)),
        calibration: Some(Calibration {
            by: "tape measure ([parameters](parameters.md), `pipe_diameter`)",
            error: Spread::Plus(-0.003, 0.003),
            apart: false,
            demanded: false,
        }),
        source: "pipes that the arms close on",
        truth: |s| vec![s.world.pipe_diameter],
        assumed: |s| vec![s.params.pipe_diameter.into()],
        learn: |s, n| set([&mut s.params.pipe_diameter], n),
        ..FIXED
    },
    Quantity {
        key: "world.pipe_friction_static_share",
        all: Some(Spread::Within(1.0, 1.5)),
        source: "1.3 to 1.5 dry, near 1 wet (assumed from tables of elastomers)",
        truth: |s| vec![s.world.pipe_shape.static_share],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_slope_deg",
        all: Some(Spread::Within(-3.0, 3.0)),
        source: "drained pipes fall by 0.2 to 1 % (0.6°), a rack's supports and threaded rods leave more (assumed)",
        truth: |s| vec![s.world.pipe_shape.slope / DEGREE],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_sag_m",
        all: Some(Spread::Within(0.0, 0.012)),
        source: "spans of ASME B31.1 sag by 2.5 mm, others by more (assumed)",
        truth: |s| vec![s.world.pipe_shape.sag],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_vibration_mm",
        all: Some(Spread::Within(0.0, 0.1)),
        source: "0.1 mm at 15 Hz are 9 mm/s; ASME OM-3 screens piping at 13 mm/s, Wood at 25",
        truth: |s| vec![1e3 * s.world.pipe_vibration],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_vibration_hz",
        all: Some(Spread::Within(5.0, 25.0)),
        source: "spans of pipe racks, first mode (assumed)",
        truth: |s| vec![s.world.pipe_vibration_rate],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_flange_spacing_m",
        all: Some(Spread::Within(1.0, 6.0)),
        source: "a flange each length of pipe, or none (below)",
        truth: |s| vec![s.world.pipe_shape.flange.spacing],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_flange_at_m",
        all: Some(Spread::Within(-1.0, 1.0)),
        source: "a perch spot is not chosen to the centimetre",
        truth: |s| vec![s.world.pipe_shape.flange.at],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_flange_height_m",
        all: Some(Spread::Within(0.003, 0.07)),
        source: "a weld of 3 mm to DN 300, PN 16 of EN 1092-1: 68 mm",
        truth: |s| vec![s.world.pipe_shape.flange.height],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_softness_mm_n",
        all: Some(Spread::Within(0.0, 0.05)),
        source: "sheet over mineral wool gives 1 to 5 mm under a hand's 100 N (assumed)",
        truth: |s| vec![1e3 * s.world.pipe_shape.softness],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_contrast",
        all: Some(Spread::Within(0.05, 1.0)),
        source: "paint and bare steel to rust (assumed)",
        truth: |s| vec![s.world.optics.pipe.contrast],
        ..FIXED
    },
    Quantity {
        key: "world.ground_contrast",
        all: Some(Spread::Within(0.05, 1.0)),
        source: "screed and asphalt to gravel (assumed)",
        truth: |s| vec![s.world.optics.ground.contrast],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_reflectivity",
        all: Some(Spread::Within(0.1, 0.9)),
        source: "black paint to white or galvanised at 940 nm (assumed)",
        truth: |s| vec![s.world.optics.pipe.reflectivity],
        ..FIXED
    },
    Quantity {
        key: "world.ground_reflectivity",
        all: Some(Spread::Within(0.1, 0.6)),
        source: "asphalt to grass at 940 nm (assumed)",
        truth: |s| vec![s.world.optics.ground.reflectivity],
        ..FIXED
    },
    Quantity {
        key: "world.pipe_gloss",
        all: Some(Spread::Within(0.0, 0.9)),
        source: "rust to gloss paint and polished cladding (assumed)",
        truth: |s| vec![s.world.optics.pipe.gloss],
        ..FIXED
    },
    Quantity {
        key: "world.light_klux",
        all: Some(Spread::Decades(0.1, 100.0)),
        source: "a hall at 0.1 to 1, overcast at 10, noon at 100: range 2.5 m to 1.0 to 1.2 m (INAV, issues 10487 and 7622)",
        truth: |s| s.world.optics.light.map(|lux| 1e-3 * lux).into_iter().collect(),
        ..FIXED
    },
];

/// Mean of an arm's numbers each.
fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len().max(1) as f64
}

/// Mean of a motor's lags up and down over the one up; at least 1, as `sophie_fit::motor_lag` takes it.
fn mean_over_rise(s: &Scenario) -> f64 {
    let spin = s.vehicle.rotor.spin;
    0.5 * (1.0 + spin.down.map_or(1.0, |down| (down / spin.up).max(1.0)))
}

/// Thrust at full drive that the arms receive on the scenario's day over that of the nominal rotor in the standard's air.
fn received(s: &Scenario) -> f64 {
    let v = &s.vehicle;
    v.rotor.air_ratio(s.world.air.density) * mean(&v.rotor_thrust) * (1.0 - v.air.wash.loss)
}

/// Tilt of an arm on the pipe, rad.
fn pipe_bend(s: &Scenario) -> f64 {
    2.0 * ARM_LENGTH / s.world.pipe_diameter
}

fn fsr_trims(s: &Scenario) -> [f64; 4] {
    let p = &s.params;
    [p.fsr_trim_1, p.fsr_trim_2, p.fsr_trim_3, p.fsr_trim_4].map(f64::from)
}

/// Zeros of the pressure sensors that the stack takes off, N.
fn zeros(s: &Scenario) -> [f64; 4] {
    let p = &s.params;
    [p.fsr_zero_1, p.fsr_zero_2, p.fsr_zero_3, p.fsr_zero_4].map(|zero| f64::from(zero * p.fsr_area))
}

/// Zeros with which the trims in force read the grip pressure of sensors that begin at `turn_on`, N, as the parameter
/// takes them, Pa.
fn lines_through_the_grip(s: &Scenario, turn_on: &[f64]) -> Vec<f64> {
    let (grip, area) = (f64::from(s.params.grip_pressure), f64::from(s.params.fsr_area));
    let parts = s.faults.pressure_gain.into_iter().zip(s.sensors.pressure.preload);
    let lines = parts.zip(fsr_trims(s)).zip(turn_on);
    lines
        .map(|(((gain, preload), trim), turn_on)| {
            let true_zero = (preload * pipe_bend(s) - turn_on) / area;
            let zero = gain * (grip + true_zero) / trim - grip;
            let range = Params::row("fsr_zero_1").map_or((-650.0, 300.0), |row| (row.min, row.max));
            zero.clamp(f64::from(range.0), f64::from(range.1))
        })
        .collect()
}

/// Elastic slope of the stack's arm without thrust over that of the nominal one.
fn assumed_gain(s: &Scenario) -> f64 {
    let ([a1, a2, ..], p) = (s.vehicle.arm_coefficients, &s.params);
    let built = s.vehicle.gain_k * (a1 + a2 * s.vehicle.infill);
    let assumed = f64::from(p.gain_k) * f64::from(p.arm_a1 + p.arm_a2 * p.infill);
    assumed / built
}

/// Pulses at which the stack takes its servos to be at `angle`, rad from the release mark, without their trims: these
/// take up the thread's slack.
fn servo_pulses(s: &Scenario, angle: f32) -> Vec<f64> {
    let pulse = |(arm, trim)| Reel::from_params(&s.params, arm).pulse(angle) - trim;
    trims(&s.params)
        .into_iter()
        .enumerate()
        .map(pulse)
        .map(f64::from)
        .collect()
}

/// Trims of the servos, µs.
fn trims(p: &Params) -> [f32; 4] {
    [p.servo_trim_1, p.servo_trim_2, p.servo_trim_3, p.servo_trim_4]
}

/// Thread that a microsecond of each servo's pulse winds, m.
fn thread_per_us(p: &Params) -> [f64; 4] {
    [0, 1, 2, 3].map(|arm| {
        let reel = Reel::from_params(p, arm);
        let span = f64::from(reel.pulse(p.servo_range) - reel.pulse(0.0));
        f64::from(p.reel_radius * p.servo_range) / span
    })
}

/// Marks within what their parameters take, µs.
fn servo_marks(found: &[f64]) -> Vec<f64> {
    let (least, most) = Params::row("servo_release_1").map_or((550.0, 2450.0), |row| (row.min, row.max));
    let within = |pulse: &f64| pulse.clamp(f64::from(least), f64::from(most));
    found.iter().map(within).collect()
}

/// Place of the lens in the file, m; without a key it is near the centre and needs no measuring.
fn lens(s: &Scenario, axis: usize) -> Vec<f64> {
    s.sensors
        .flow_place
        .get(axis)
        .copied()
        .flatten()
        .into_iter()
        .collect()
}
