//! `sophie recording`: runs recorded sensors or bytes through this stack.

use sophie_control::params::Params;
use sophie_recording::bytes::{self, Protocol};
use sophie_recording::replay::{self, Options};
use sophie_recording::report;
use sophie_recording::truth::Truth;
use sophie_terminal::complain;
use sophie_terminal::console::{self, Console};

use super::PROGRAM;
use super::args::{Kind, RecordingArgs};

/// Runs the recording and prints the results.
pub fn run(args: &RecordingArgs) -> Result<(), String> {
    let mut params = Params::default();
    for (row, value) in &args.params {
        params
            .set(row.name, *value)
            .map_err(|_| format!("--param {}: {value} is not allowed", row.name))?;
    }
    let protocol = match args.kind {
        Kind::Sensors => None,
        Kind::Sbus => Some(Protocol::Sbus),
        Kind::Crsf => Some(Protocol::Crsf),
        Kind::Msp => Some(Protocol::Msp),
    };
    if protocol.is_some() && (args.truth.is_some() || args.from > 0.0) {
        return Err(
            "--truth and --from are for sensors, allowed without --as or with --as sensors".to_owned(),
        );
    }
    let name = args.file.display().to_string();
    let console = Console::new(args.json);
    let object = match protocol {
        Some(protocol) => {
            let decoded = bytes::decode(&args.file, protocol, &params)?;
            console.say(&report::bytes_line(&name, &decoded));
            report::bytes_object(&decoded)
        }
        None => {
            let truth = args.truth.as_deref().map(Truth::read).transpose()?;
            let options = Options {
                params,
                from_s: args.from,
            };
            let outcome = replay::replay(&args.file, &options, truth)?;
            if let Some(warning) = report::warning(&outcome) {
                complain(PROGRAM, &format!("warning: {name}: {warning}"));
            }
            for line in report::lines(&name, &outcome) {
                console.say(&line);
            }
            report::object(&outcome)
        }
    };
    if args.json {
        console::print(&object.to_string())?;
    }
    console.end()
}
