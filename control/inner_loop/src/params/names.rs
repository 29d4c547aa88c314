//! Rules for names, and the renamed parameters.

use core::f32::consts::TAU;

/// Longest name, as in telemetry protocols (MAVLink's `param_id`).
pub const NAME_MAX: usize = 16;

/// A parameter that had another name, and perhaps another unit.
///
/// The parameter store, the console and scenario files accept the old name and convert its value. Of both names the new
/// one wins: only newer firmware can have written it.
#[derive(Clone, Copy, Debug)]
pub struct Renamed {
    /// Old name.
    pub old: &'static str,
    /// Old unit.
    pub unit: &'static str,
    /// Name in the table.
    pub new: &'static str,
    /// Old units in one of the new.
    ratio: f32,
}

/// All renamed parameters.
pub const RENAMED: &[Renamed] = &[
    Renamed {
        old: "receiver_protocol",
        unit: "1",
        new: "rc_protocol",
        ratio: 1.0,
    },
    Renamed {
        old: "perch_throttle_max",
        unit: "1",
        new: "perch_thr_max",
        ratio: 1.0,
    },
    Renamed {
        old: "setpoint_cutoff",
        unit: "rad/s",
        new: "setpoint_lpf_hz",
        ratio: TAU,
    },
];

impl Renamed {
    /// Finds the entry with the old name `old`.
    pub fn find(old: &str) -> Option<&'static Self> {
        RENAMED.iter().find(|renamed| renamed.old == old)
    }

    /// Converts a value from the old unit.
    pub fn convert(&self, old: f32) -> f32 {
        old / self.ratio
    }
}

/// Compiles only if each name has 1 to [`NAME_MAX`] characters and is unique.
///
/// ```
/// const _: () = sophie_control::params::check_names(&["sixteen_letters_", "another"]);
/// ```
/// ```compile_fail,E0080
/// const _: () = sophie_control::params::check_names(&["seventeen_letters"]);
/// ```
/// ```compile_fail,E0080
/// const _: () = sophie_control::params::check_names(&["twice", "once", "twice"]);
/// ```
/// ```compile_fail,E0080
/// const _: () = sophie_control::params::check_names(&["once", ""]);
/// ```
pub const fn check_names(names: &[&str]) {
    let mut rest = names;
    while let [name, others @ ..] = rest {
        assert!(!name.is_empty(), "a parameter has no name");
        assert!(
            name.len() <= NAME_MAX,
            "a parameter's name is longer than 16 characters"
        );
        let mut others_left = others;
        while let [other, tail @ ..] = others_left {
            assert!(!same(name, other), "two parameters have the same name");
            others_left = tail;
        }
        rest = others;
    }
}

const fn same(a: &str, b: &str) -> bool {
    let (mut a, mut b) = (a.as_bytes(), b.as_bytes());
    while let ([first, a_rest @ ..], [other, b_rest @ ..]) = (a, b) {
        if *first != *other {
            return false;
        }
        (a, b) = (a_rest, b_rest);
    }
    a.is_empty() && b.is_empty()
}

#[cfg(test)]
mod tests {
    use super::super::Params;
    use super::*;

    #[test]
    fn every_old_name_is_gone_from_the_table_and_its_new_one_is_there() {
        for renamed in RENAMED {
            assert!(Params::row(renamed.old).is_none(), "{}", renamed.old);
            assert!(Params::row(renamed.new).is_some(), "{}", renamed.new);
            assert_eq!(Renamed::find(renamed.old).unwrap().new, renamed.new);
        }
        assert!(Renamed::find("infill").is_none());
    }

    #[test]
    fn old_defaults_and_old_limits_are_allowed_and_the_default_flies_to_the_bit() {
        // Default, minimum and maximum under the old names.
        for (old, values) in [
            ("receiver_protocol", [0.0f32, 0.0, 1.0]),
            ("perch_throttle_max", [0.42, 0.1, 0.6]),
            ("setpoint_cutoff", [10.0, 1.0, 100.0]),
        ] {
            let renamed = Renamed::find(old).unwrap();
            let row = Params::row(renamed.new).unwrap();
            let [default, ..] = values.map(|value| {
                let new = renamed.convert(value);
                assert!(row.allows(new), "{old} {value} is {new}");
                new
            });
            assert!(default.to_bits() == row.default.to_bits(), "{old}: {default}");
        }
        // The law's cut-off, rad/s.
        const { assert!(TAU * Params::DEFAULT.setpoint_lpf_hz == 10.0) };
    }
}
