//! A phone beside a rotor that records a train of steps: tones of blades, bell and controller over the noise of the air,
//! in a room that answers.

use std::f64::consts::TAU;

use rand::distr::Distribution;
use sophie_control::pilot::static_thrust_test::StaticThrustTest;

use crate::normal::StandardNormal;
use crate::plant::STEP;
use crate::plant::rotor::Rotor;
use crate::scenario::Scenario;
use crate::streams::Streams;

/// Samples a second of a recording, Hz.
pub const RATE: f64 = 16_000.0;
/// Multiples of the turning rate that sound, with their strength: imbalance, two blades and their harmonics, seven pole
/// pairs of the motor (assumed of published spectra of multirotor propellers).
const TONES: [(f64, f64); 9] = [
    (1.0, 0.15),
    (2.0, 1.0),
    (4.0, 0.5),
    (6.0, 0.3),
    (7.0, 0.35),
    (8.0, 0.2),
    (10.0, 0.12),
    (12.0, 0.1),
    (14.0, 0.25),
];
/// Noise of blades and air over the tones of full speed, and of the room, RMS.
const AIR: f64 = 0.35;
const ROOM: f64 = 0.02;
/// Echo of the room over the direct sound, and time in which it fades to a thousandth, s.
const ECHO: f64 = 0.3;
const REVERBERATION: f64 = 0.4;
/// Delays of the room's four strongest echoes, s.
const WALLS: [f64; 4] = [0.011, 0.019, 0.031, 0.043];

/// The sound (-1 to 1, [`RATE`]) of rotor 1 of the scenario's vehicle in `test`, from `before` s ahead of it to 1 s after
/// it, at `voltage` V.
#[must_use]
pub fn record(
    scenario: &Scenario,
    test: &StaticThrustTest,
    before: f64,
    voltage: f64,
    streams: Streams,
) -> Vec<f64> {
    let mut rng = streams.of("phone");
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let v = &scenario.vehicle;
    let mut rotor = Rotor::new(0, 1.0, v.rotor).in_air(v.rotor_thrust[0], scenario.world.air.density);
    let full = rotor.full_speed();
    let each = (RATE * STEP).round() as usize;
    let time = before + f64::from(test.longest()) + 1.0;
    let mut phases = TONES.map(|_| TAU * streams.unit("phone phase"));
    let mut sound = Vec::new();
    let mut t = 0.0;
    while t < time {
        let of_test = t - before;
        let running = (0.0..f64::from(test.longest())).contains(&of_test);
        let drive = if running {
            f64::from(test.at(of_test as f32).drive)
        } else {
            0.0
        };
        rotor.step(STEP, drive, voltage);
        let speed = rotor.speed();
        let loud = (speed / full).powi(2);
        for _ in 0..each {
            let mut sample = ROOM * normal() + AIR * loud * normal();
            for ((multiple, strength), phase) in TONES.iter().zip(&mut phases) {
                *phase = (*phase + multiple * speed / RATE) % TAU;
                sample += strength * loud * libm::sin(*phase);
            }
            sound.push(sample);
        }
        t += STEP;
    }
    let keep = WALLS.map(|delay| libm::exp(-6.9 * delay / REVERBERATION));
    let lags = WALLS.map(|delay| (delay * RATE) as usize);
    let mut walls = WALLS.map(|_| vec![0.0; sound.len()]);
    for i in 0..sound.len() {
        for ((wall, lag), keep) in walls.iter_mut().zip(lags).zip(keep) {
            let back = |s: &[f64]| if i >= lag { s[i - lag] } else { 0.0 };
            wall[i] = back(&sound) + keep * back(wall);
        }
    }
    let echo = ECHO / WALLS.len() as f64;
    (0..sound.len())
        .map(|i| 0.2 * (sound[i] + echo * walls.iter().map(|wall| wall[i]).sum::<f64>()))
        .collect()
}
