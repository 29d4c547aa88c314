//! A row of the check: value, limit and advice.

/// Required range of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Minimum.
    AtLeast(f64),
    /// Maximum.
    AtMost(f64),
}

impl Limit {
    /// The limit's number.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::AtLeast(value) | Self::AtMost(value) => value,
        }
    }

    /// `least` or `most`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::AtLeast(_) => "least",
            Self::AtMost(_) => "most",
        }
    }

    /// NaN keeps no limit.
    fn kept_by(self, value: f64) -> bool {
        match self {
            Self::AtLeast(least) => value >= least,
            Self::AtMost(most) => value <= most,
        }
    }
}

/// One row.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Quantity.
    pub name: String,
    /// Not finite if the value does not exist.
    pub value: f64,
    /// Unit of value and limit; empty for a pure number.
    pub unit: &'static str,
    /// Required range.
    pub limit: Limit,
    /// The value keeps the limit.
    pub pass: bool,
    /// Advice if the row fails.
    pub advice: String,
}

impl Row {
    /// A row that passes if `value` keeps `limit`.
    #[must_use]
    pub fn new(name: impl Into<String>, value: f64, unit: &'static str, limit: Limit) -> Self {
        Self {
            name: name.into(),
            value,
            unit,
            limit,
            pass: limit.kept_by(value),
            advice: String::new(),
        }
    }

    /// Adds the advice for a failure.
    #[must_use]
    pub fn advise(self, advice: impl Into<String>) -> Self {
        Self {
            advice: advice.into(),
            ..self
        }
    }

    /// Value with unit.
    #[must_use]
    pub fn shown(&self) -> String {
        with_unit(self.value, self.unit)
    }

    /// Limit with unit: `at least 1.38`.
    #[must_use]
    pub fn limit_shown(&self) -> String {
        format!(
            "at {} {}",
            self.limit.word(),
            with_unit(self.limit.value(), self.unit)
        )
    }

    /// Text of a failed row: `thrust to weight 1.13, at least 1.38 needed`.
    #[must_use]
    pub fn shortfall(&self) -> String {
        let word = match self.limit {
            Limit::AtLeast(_) => "needed",
            Limit::AtMost(_) => "allowed",
        };
        format!("{} {}, {} {word}", self.name, self.shown(), self.limit_shown())
    }
}

/// Three digits.
fn with_unit(value: f64, unit: &str) -> String {
    let number = match value.abs() {
        v if !v.is_finite() => "none".to_owned(),
        v if v >= 99.95 => format!("{value:.0}"),
        v if v >= 9.995 => format!("{value:.1}"),
        v if !(5e-4..0.1).contains(&v) => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    };
    format!("{number} {unit}").trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failing_row_names_its_shortfall() {
        let row = Row::new("thrust to weight", 1.128, "", Limit::AtLeast(1.38));
        assert!(!row.pass);
        assert_eq!(row.shortfall(), "thrust to weight 1.13, at least 1.38 needed");
        let row = Row::new("grip force arm 2", 171.0, "N", Limit::AtMost(157.1));
        assert_eq!(row.shortfall(), "grip force arm 2 171 N, at most 157 N allowed");
        assert!(
            Row::new("x", 2.0, "", Limit::AtMost(2.0)).pass
                && Row::new("x", 2.0, "", Limit::AtLeast(2.0)).pass
        );
    }

    #[test]
    fn a_nan_keeps_no_limit() {
        for limit in [Limit::AtLeast(0.0), Limit::AtMost(0.0)] {
            let row = Row::new("x", f64::NAN, "N", limit);
            assert!(!row.pass && row.shown() == "none N");
        }
    }
}
