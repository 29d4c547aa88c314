//! Speed of a rotor over time by its sound: a phone beside it records blades, motor and controller, whose tones are all
//! multiples of the turning rate.
//!
//! Spectra of 64 ms on a logarithmic axis, on which a change of speed shifts all tones alike; the turning rate whose
//! multiples are the strongest, followed by dynamic programming (Viterbi). A whole number of times the true rate serves as
//! well: only ratios count.

use std::f64::consts::{LN_2, TAU};
use std::path::Path;

/// Largest recording, s.
const LONGEST: f64 = 60.0;
/// Largest file, bytes: a minute in stereo at 192 kHz of 32 bits.
const MAX_BYTES: u64 = 92_200_000;
/// Rate to which a recording is reduced, Hz, at least: its tones end at 2.5 kHz.
const RATE: f64 = 6_000.0;
/// Length of a window, s: half of it is a tenth of a slow motor's lag; and between two, s.
pub const WINDOW: f64 = 0.064;
/// Time between two windows, s.
pub const HOP: f64 = 0.008;
/// Bins an octave.
const OCTAVE: usize = 48;
/// Lowest tone, Hz, and octaves of the spectrum: to 2.56 kHz.
const LOWEST: f64 = 40.0;
const OCTAVES: usize = 6;
/// Octaves in which the rate lies, from [`LOWEST`]: a hovering rotor of 8 to 12 inches turns 50 to 110 times a second, and
/// its blades pass twice as often.
const RATE_OCTAVES: usize = 3;
/// Multiples that count.
const MULTIPLES: usize = 10;
/// Bins about a tone whose mean is its background.
const BACKGROUND: usize = 9;
/// Largest change in a hop, bins: from 1 to 1.9 with 0.03 s, at its steepest.
const CHANGE: usize = 18;
/// Cost of a change by one bin, share of the mean strength.
const CHANGE_COST: f64 = 0.02;

/// A recording, mean of its channels.
#[derive(Clone, Debug)]
pub struct Sound {
    /// Samples a second, Hz.
    pub rate: f64,
    /// Samples, -1 to 1.
    pub samples: Vec<f64>,
}

impl Sound {
    /// Reads a WAV file of whole numbers or floats.
    ///
    /// # Errors
    /// One line: file, what is wrong, what is allowed.
    pub fn load(path: &Path) -> Result<Self, String> {
        let complaint = |why: String| format!("{}: {why}", path.display());
        let bytes = sophie_input::read(path, MAX_BYTES)
            .map_err(|why| complaint(format!("cannot be read: {why}: allowed is a WAV file")))?;
        Self::of_wav(&bytes).map_err(complaint)
    }

    /// A recording in the bytes of a WAV file.
    ///
    /// # Errors
    /// As [`Sound::load`], without the file's name.
    pub fn of_wav(bytes: &[u8]) -> Result<Self, String> {
        let refused = |error: hound::Error| format!("is no WAV file that can be read: {error}");
        let mut reader = hound::WavReader::new(bytes).map_err(refused)?;
        let spec = reader.spec();
        let all: Result<Vec<f64>, hound::Error> = match spec.sample_format {
            hound::SampleFormat::Float => reader.samples::<f32>().map(|s| s.map(f64::from)).collect(),
            hound::SampleFormat::Int => {
                let full = 2f64.powi(i32::from(spec.bits_per_sample) - 1);
                reader
                    .samples::<i32>()
                    .map(|s| s.map(|s| f64::from(s) / full))
                    .collect()
            }
        };
        let all = all.map_err(refused)?;
        let rate = f64::from(spec.sample_rate);
        if !(RATE..=200_000.0).contains(&rate) {
            return Err(format!("{rate:.0} samples a second: allowed are 6000 to 200000"));
        }
        let channels = usize::from(spec.channels.max(1));
        let samples: Vec<f64> = all
            .chunks_exact(channels)
            .map(|frame| frame.iter().sum::<f64>() / channels as f64)
            .collect();
        let seconds = samples.len() as f64 / rate;
        if seconds > LONGEST {
            return Err(format!(
                "lasts {seconds:.0} s: allowed are at most {LONGEST:.0}, the steps alone"
            ));
        }
        if let Some(bad) = samples.iter().find(|s| !s.is_finite()) {
            return Err(format!("holds a sample {bad}: allowed are finite ones"));
        }
        Ok(Self { rate, samples })
    }

    /// The same at a lower rate: means over whole numbers of samples, twice, so that higher tones do not fold in.
    fn reduced(&self) -> Self {
        let factor = (self.rate / RATE).floor().max(1.0) as usize;
        let mean = |samples: &[f64], step: usize| -> Vec<f64> {
            samples
                .windows(factor)
                .step_by(step)
                .map(|w| w.iter().sum::<f64>() / factor as f64)
                .collect()
        };
        Self {
            rate: self.rate / factor as f64,
            samples: mean(&mean(&self.samples, 1), factor),
        }
    }
}

/// The turning rate, or a multiple of it, over time.
#[derive(Clone, Debug)]
pub struct Track {
    /// Time of the first value, s after the recording's begin; one follows each [`HOP`].
    pub begin: f64,
    /// Rates, Hz.
    pub rates: Vec<f64>,
}

/// Follows the rate through a recording.
///
/// # Errors
/// One line: the recording is too short.
pub fn follow(sound: &Sound) -> Result<Track, String> {
    let sound = sound.reduced();
    let spectra = spectra(&sound);
    if spectra.len() < 100 {
        return Err("lasts less than a second: allowed is a train of steps".to_owned());
    }
    let strengths: Vec<Vec<f64>> = spectra.iter().map(|s| comb(s)).collect();
    let path = viterbi(&strengths);
    let rates = path
        .iter()
        .zip(&strengths)
        .map(|(&bin, strength)| LOWEST * ((bin as f64 + vertex(strength, bin)) / OCTAVE as f64 * LN_2).exp());
    Ok(Track {
        begin: 0.5 * WINDOW,
        rates: rates.collect(),
    })
}

/// Tones over their background, on the logarithmic axis, for each window.
fn spectra(sound: &Sound) -> Vec<Vec<f64>> {
    let (length, hop) = ((WINDOW * sound.rate) as usize, HOP * sound.rate);
    let window: Vec<f64> = (0..length)
        .map(|i| (0.5 * TAU * (i as f64 + 0.5) / length as f64).sin().powi(2))
        .collect();
    let turns: Vec<(f64, f64)> = (0..OCTAVES * OCTAVE)
        .map(|bin| {
            let turn = TAU * LOWEST * (bin as f64 / OCTAVE as f64 * LN_2).exp() / sound.rate;
            (turn.cos(), turn.sin())
        })
        .collect();
    let count = sound.samples.len().saturating_sub(length) as f64 / hop;
    (0..count as usize)
        .map(|i| {
            let at = (i as f64 * hop) as usize;
            let windowed: Vec<f64> = sound.samples[at..at + length]
                .iter()
                .zip(&window)
                .map(|(s, w)| s * w)
                .collect();
            let levels: Vec<f64> = turns.iter().map(|turn| level(&windowed, *turn)).collect();
            tones(&levels)
        })
        .collect()
}

/// Amplitude of one frequency, as its logarithm (Goertzel).
fn level(samples: &[f64], (cos, sin): (f64, f64)) -> f64 {
    let (mut a, mut b) = (0.0, 0.0);
    for s in samples {
        (a, b) = (s + 2.0 * cos * a - b, a);
    }
    let (real, imaginary) = (a - cos * b, sin * b);
    0.5 * (real * real + imaginary * imaginary + 1e-12).ln()
}

/// What rises over the mean of its neighbourhood.
fn tones(levels: &[f64]) -> Vec<f64> {
    (0..levels.len())
        .map(|i| {
            let near = &levels[i.saturating_sub(BACKGROUND)..(i + BACKGROUND + 1).min(levels.len())];
            (levels[i] - near.iter().sum::<f64>() / near.len() as f64).max(0.0)
        })
        .collect()
}

/// Strength of each rate: of its multiples, the lower the more.
fn comb(tones: &[f64]) -> Vec<f64> {
    (0..RATE_OCTAVES * OCTAVE)
        .map(|bin| {
            (1..=MULTIPLES)
                .map(|multiple| {
                    let at = bin as f64 + OCTAVE as f64 * (multiple as f64).log2();
                    let (below, share) = (at as usize, at.fract());
                    let tone = |i: usize| tones.get(i).copied().unwrap_or_default();
                    (tone(below) * (1.0 - share) + tone(below + 1) * share) / (multiple as f64).sqrt()
                })
                .sum()
        })
        .collect()
}

/// The path with the largest sum of strengths less the cost of its changes.
fn viterbi(strengths: &[Vec<f64>]) -> Vec<usize> {
    let bins = RATE_OCTAVES * OCTAVE;
    let mean = strengths.iter().flatten().sum::<f64>() / (strengths.len() * bins) as f64;
    let cost = CHANGE_COST * mean;
    let mut best = vec![0.0; bins];
    let mut came: Vec<Vec<usize>> = Vec::with_capacity(strengths.len());
    for strength in strengths {
        let mut next = vec![0.0; bins];
        let mut from = vec![0; bins];
        for bin in 0..bins {
            let near = bin.saturating_sub(CHANGE)..(bin + CHANGE + 1).min(bins);
            let value = |i: &usize| best[*i] - cost * i.abs_diff(bin) as f64;
            let source = near.max_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or(bin);
            next[bin] = value(&source) + strength[bin];
            from[bin] = source;
        }
        best = next;
        came.push(from);
    }
    let mut bin = (0..bins)
        .max_by(|a, b| best[*a].total_cmp(&best[*b]))
        .unwrap_or(0);
    let mut path: Vec<usize> = came
        .iter()
        .rev()
        .map(|from| {
            let before = from[bin];
            std::mem::replace(&mut bin, before)
        })
        .collect();
    path.reverse();
    path
}

/// Offset of the parabola's vertex through a bin and its neighbours, bins.
fn vertex(strength: &[f64], bin: usize) -> f64 {
    if bin == 0 || bin + 1 >= strength.len() {
        return 0.0;
    }
    let (left, mid, right) = (strength[bin - 1], strength[bin], strength[bin + 1]);
    let bend = left - 2.0 * mid + right;
    if bend < 0.0 {
        (0.5 * (left - right) / bend).clamp(-0.5, 0.5)
    } else {
        0.0
    }
}
