//! One figure of the page, and the curves and legends that figures share.

use sophie_sim::record::{FlightRecord, Sample};

/// CSS class and meaning per kind of line.
pub type Legend = Vec<(&'static str, String)>;

/// One figure of the page.
pub struct Figure {
    /// Heading.
    pub title: &'static str,
    /// Note in one sentence.
    pub note: String,
    /// CSS class and meaning per kind of line.
    pub legend: Legend,
    /// The drawing.
    pub svg: String,
}

/// CSS classes of the four arms.
pub const ARM: [&str; 4] = ["a1", "a2", "a3", "a4"];
/// Names of the four arms.
pub const ARM_NAMES: [&str; 4] = ["1 front left", "2 rear left", "3 front right", "4 rear right"];

/// A value of each sample.
pub fn series(record: &FlightRecord, f: impl Fn(&Sample) -> f64) -> Vec<f64> {
    record.samples.iter().map(f).collect()
}

/// A curve per arm, converted from SI by `unit`.
pub fn arm_series(
    record: &FlightRecord,
    f: impl Fn(&Sample) -> &[f64; 4],
    si: impl Fn(f64) -> f64,
) -> Vec<Vec<f64>> {
    (0..4)
        .map(|i| series(record, |s| f(s).get(i).map_or(f64::NAN, |v| si(*v))))
        .collect()
}

/// A legend from its entries.
pub fn legend(keys: &[(&'static str, &str)]) -> Legend {
    keys.iter()
        .map(|(class, meaning)| (*class, (*meaning).to_owned()))
        .collect()
}

/// The four arms.
pub fn arm_legend() -> Legend {
    ARM.into_iter().zip(ARM_NAMES.map(str::to_owned)).collect()
}
