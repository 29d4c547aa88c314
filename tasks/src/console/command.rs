//! Console commands: syntax and parser.

use core::fmt;

use super::nearest::nearest;

/// A parsed command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command<'a> {
    Help,
    Status,
    List(&'a str),
    Get(&'a str),
    Set(&'a str, &'a str),
    Reset(&'a str),
    Defaults,
    Changes,
    Save,
    Restart,
    Dfu,
    Timing,
    Version,
    Silicon,
    BrownOut,
    SetBrownOut,
    Calibrate(&'a str, [Option<&'a str>; 3]),
    Watch(&'a str),
    SelfTest,
    Mavlink,
    MavlinkKey(&'a str),
    PropellersOff,
    TiedDown,
    Thrust(&'a str, &'a str, Option<&'a str>),
    Motor(&'a str, Option<&'a str>),
    MotorPulse(&'a str, &'a str),
    Servo {
        number: &'a str,
        to: &'a str,
        at: Option<&'a str>,
    },
}

/// Name with arguments, and description.
pub(super) const HELP: [(&str, &str); 26] = [
    ("help", "this list"),
    ("status", "mode, what forbids arming, battery, receiver"),
    (
        "list [PART]",
        "parameters, or those with PART in their name; * is not the default",
    ),
    ("get NAME", "one parameter and what it is"),
    ("set NAME VALUE", "changes it; in force after save"),
    ("reset NAME", "back to its default; in force after save"),
    ("defaults", "all back to their defaults; in force after save"),
    ("changes", "what save would change"),
    ("save", "stores the parameters and restarts; only while disarmed"),
    ("restart", "restarts without storing; only while disarmed"),
    ("dfu", "leaves for the chip's USB loader; only while disarmed"),
    ("timing", "rate and worst times of every task"),
    ("version", "the firmware and its board"),
    ("silicon", "what the start looked at in the chip"),
    (
        "brownout [set]",
        "the level below which the chip stops, and what set does",
    ),
    (
        "watch [GROUP]",
        "live numbers, or the groups of them; a key ends it",
    ),
    ("selftest", "tests all that can be tested without moving anything"),
    ("propellers off", "says that they are: motors may be tried"),
    ("motor N [%]", "spins motor N for 2 s; a key stops it"),
    (
        "motor N US us",
        "the same by a pulse, to find the one that turns it",
    ),
    (
        "tied down",
        "says that the vehicle is, propellers on: thrust may be run",
    ),
    ("thrust N %", "runs rotor N, or all, for 5 s; a key stops it"),
    ("thrust N % to %", "five steps up and down, to time the motors"),
    (
        "servo N TO [AT]",
        "TO is release, pulse (AT us) or angle (AT deg); a key ends it",
    ),
    ("calibrate WHAT", "one step of a calibration; alone it lists them"),
    (
        "mavlink [key K]",
        "the MAVLink line; K signs it: 64 hex digits, or off",
    ),
];

/// Parse error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Misunderstood<'a> {
    Unknown(&'a str),
    /// Wrong arguments; carries those that the command takes.
    Arguments(&'static str),
}

impl fmt::Display for Misunderstood<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(word) => {
                write!(f, "no command '{word}'; ")?;
                match nearest(word, HELP.iter().map(|(usage, _)| name(usage))) {
                    Some(name) => write!(f, "did you mean '{name}'?"),
                    None => f.write_str("try 'help'"),
                }
            }
            Self::Arguments(usage) => write!(f, "say '{usage}'"),
        }
    }
}

fn name(usage: &'static str) -> &'static str {
    usage.split_once(' ').map_or(usage, |(name, _)| name)
}

/// Parses a line; `None` if empty.
pub(super) fn parse(line: &str) -> Option<Result<Command<'_>, Misunderstood<'_>>> {
    let mut words = line.split_ascii_whitespace();
    let word = words.next()?;
    // One more than any command takes, so that too many are noticed.
    let arguments = [words.next(), words.next(), words.next(), words.next()];
    let command = match (word, arguments) {
        ("help", [None, ..]) => Command::Help,
        ("status", [None, ..]) => Command::Status,
        ("list", [part, None, ..]) => Command::List(part.unwrap_or_default()),
        ("get", [Some(name), None, ..]) => Command::Get(name),
        ("set", [Some(name), Some(value), None, _]) => Command::Set(name, value),
        ("reset", [Some(name), None, ..]) => Command::Reset(name),
        ("defaults", [None, ..]) => Command::Defaults,
        ("changes", [None, ..]) => Command::Changes,
        ("save", [None, ..]) => Command::Save,
        ("restart", [None, ..]) => Command::Restart,
        ("dfu", [None, ..]) => Command::Dfu,
        ("timing", [None, ..]) => Command::Timing,
        ("version", [None, ..]) => Command::Version,
        ("silicon", [None, ..]) => Command::Silicon,
        ("brownout", [None, ..]) => Command::BrownOut,
        ("brownout", [Some("set"), None, ..]) => Command::SetBrownOut,
        ("calibrate", [what, first, second, third]) if words.next().is_none() => {
            Command::Calibrate(what.unwrap_or_default(), [first, second, third])
        }
        ("watch", [group, None, ..]) => Command::Watch(group.unwrap_or_default()),
        ("selftest", [None, ..]) => Command::SelfTest,
        ("mavlink", [None, ..]) => Command::Mavlink,
        ("mavlink", [Some("key"), Some(key), None, _]) => Command::MavlinkKey(key),
        ("propellers", [Some("off"), None, ..]) => Command::PropellersOff,
        ("tied", [Some("down"), None, ..]) => Command::TiedDown,
        ("thrust", [Some(which), Some(percent), None, _]) => Command::Thrust(which, percent, None),
        ("thrust", [Some(which), Some(percent), Some("to"), Some(to)]) if words.next().is_none() => {
            Command::Thrust(which, percent, Some(to))
        }
        ("motor", [Some(number), percent, None, _]) => Command::Motor(number, percent),
        ("motor", [Some(number), Some(pulse), Some("us"), None]) => Command::MotorPulse(number, pulse),
        ("servo", [Some(number), Some(to), at, None]) => Command::Servo { number, to, at },
        _ => {
            let usage = HELP.iter().find(|(usage, _)| name(usage) == word);
            return Some(Err(usage.map_or(Misunderstood::Unknown(word), |(usage, _)| {
                Misunderstood::Arguments(usage)
            })));
        }
    };
    Some(Ok(command))
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;

    #[test]
    fn every_command_in_the_help_is_understood() {
        for (usage, _) in HELP {
            // With what may be left out, and without.
            let whole: std::string::String = usage.chars().filter(|c| !"[]".contains(*c)).collect();
            assert!(matches!(parse(&whole), Some(Ok(_))), "{usage}");
            let (needed, _) = usage.split_once(" [").unwrap_or((usage, ""));
            assert!(matches!(parse(needed), Some(Ok(_))), "{usage}");
        }
        assert_eq!(parse("  set\tinfill  8 "), Some(Ok(Command::Set("infill", "8"))));
        assert_eq!(parse("list"), Some(Ok(Command::List(""))));
        assert_eq!(parse("brownout"), Some(Ok(Command::BrownOut)));
        assert_eq!(parse("brownout set"), Some(Ok(Command::SetBrownOut)));
        assert_eq!(parse("   "), None);
    }

    #[test]
    fn a_command_with_the_wrong_arguments_is_not_guessed() {
        for line in [
            "set infill",
            "set infill 8 9",
            "save now",
            "get",
            "list a b",
            "restart 5",
            "dfu now",
            "brownout reset",
            "brownout set now",
            "silicon all",
        ] {
            assert!(
                matches!(parse(line), Some(Err(Misunderstood::Arguments(_)))),
                "{line}"
            );
        }
        assert_eq!(parse("SAVE"), Some(Err(Misunderstood::Unknown("SAVE"))));
    }
}
