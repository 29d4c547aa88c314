//! A phone beside a rotor that records a train of steps: tones of blades, bell and controller over the noise of the air,
//! in a room that answers.

use std::f64::consts::TAU;

use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;
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
/// Amplitude of the tones of full speed in the file: a phone keeps away from its end.
const LOUDNESS: f64 = 0.2;
/// Delays of the room's four strongest echoes, s.
const WALLS: [f64; 4] = [0.011, 0.019, 0.031, 0.043];

/// A phone while it records.
pub struct Phone {
    noise: Pcg64Mcg,
    phases: [f64; TONES.len()],
    /// Direct sound.
    direct: Vec<f64>,
    /// Time that has not become a sample yet, s.
    rest: f64,
}

impl Phone {
    /// A phone that begins to record.
    #[must_use]
    pub fn new(streams: Streams) -> Self {
        Self {
            noise: streams.of("phone"),
            phases: TONES.map(|(multiple, _)| TAU * streams.unit(&format!("phone tone {multiple}"))),
            direct: Vec::new(),
            rest: 0.0,
        }
    }

    /// Records a rotor that turns at `speed` for `dt` s; `full` is its full speed (both rad/s).
    pub fn hear(&mut self, speed: f64, full: f64, dt: f64) {
        let share = speed / full;
        let loud = share * share;
        self.rest += dt;
        while self.rest >= 1.0 / RATE {
            self.rest -= 1.0 / RATE;
            let mut normal = || -> f64 { StandardNormal.sample(&mut self.noise) };
            let mut sample = ROOM * normal() + AIR * loud * normal();
            for ((multiple, strength), phase) in TONES.iter().zip(&mut self.phases) {
                *phase = (*phase + multiple * speed / RATE) % TAU;
                sample += strength * loud * libm::sin(*phase);
            }
            self.direct.push(sample);
        }
    }

    /// The recording, -1 to 1, [`RATE`] samples a second: the direct sound with the room's echoes.
    #[must_use]
    pub fn sound(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self.direct.iter().map(|sample| LOUDNESS * sample).collect();
        for delay in WALLS {
            let (lag, keep) = ((delay * RATE) as usize, libm::exp(-6.9 * delay / REVERBERATION));
            let mut wall = vec![0.0; self.direct.len()];
            for i in lag..wall.len() {
                wall[i] = self.direct[i - lag] + keep * wall[i - lag];
                all[i] += LOUDNESS * ECHO / WALLS.len() as f64 * wall[i];
            }
        }
        all
    }

    /// The recording as a WAV file of 16 bits.
    #[must_use]
    pub fn wav(&self) -> Vec<u8> {
        let sound = self.sound();
        let (bytes, rate) = (2 * sound.len() as u32, RATE as u32);
        let mut file = Vec::with_capacity(44 + bytes as usize);
        file.extend(b"RIFF");
        file.extend((36 + bytes).to_le_bytes());
        file.extend(b"WAVEfmt ");
        file.extend(16u32.to_le_bytes());
        for word in [1u16, 1] {
            file.extend(word.to_le_bytes());
        }
        for word in [rate, 2 * rate] {
            file.extend(word.to_le_bytes());
        }
        for word in [2u16, 16] {
            file.extend(word.to_le_bytes());
        }
        file.extend(b"data");
        file.extend(bytes.to_le_bytes());
        for sample in sound {
            file.extend(((sample.clamp(-1.0, 1.0) * 32_767.0) as i16).to_le_bytes());
        }
        file
    }
}

/// A phone that has recorded rotor 1 of the scenario's vehicle in `test`, from `before` s ahead of it to 1 s after it, at
/// `voltage` V.
#[must_use]
pub fn beside(
    scenario: &Scenario,
    test: &StaticThrustTest,
    before: f64,
    voltage: f64,
    streams: Streams,
) -> Phone {
    let v = &scenario.vehicle;
    let mut rotor = Rotor::new(0, 1.0, v.rotor).in_air(v.rotor_thrust[0], scenario.world.air.density);
    let (full, length) = (rotor.full_speed(), f64::from(test.longest()));
    let mut phone = Phone::new(streams);
    for i in 0..((before + length + 1.0) / STEP) as u32 {
        let t = f64::from(i) * STEP - before;
        let runs = (0.0..length).contains(&t);
        let drive = if runs {
            f64::from(test.at(t as f32).drive)
        } else {
            0.0
        };
        rotor.step(STEP, drive, voltage);
        phone.hear(rotor.speed(), full, STEP);
    }
    phone
}
