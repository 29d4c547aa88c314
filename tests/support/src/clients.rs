//! MAVLink clients that others wrote, as programs of their own.

use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

/// Longest wait for a message, s of wall time: an emulated board runs at half of real time, on a machine that is busy.
const SECONDS: &str = "120";

/// What pymavlink has heard on `connection` once each of `messages` came `count` times.
pub fn listen(connection: &str, count: usize, messages: &[&str]) -> serde_json::Value {
    let count = count.to_string();
    run("listen.py", &[&[connection, SECONDS, &count], messages].concat())
}

/// What the vehicle has answered to `steps` on `connection`: lists of command, parameters and the result that ends a step.
pub fn obey(connection: &str, steps: &serde_json::Value) -> serde_json::Value {
    run("obey.py", &[connection, SECONDS, &steps.to_string()])
}

/// The interpreter that has the clients. The first call may install them: before a flight that must not wait for it.
pub fn python() -> &'static str {
    static PYTHON: OnceLock<String> = OnceLock::new();
    PYTHON.get_or_init(|| {
        let installed = Command::new(root().join(".ci/mavlink-clients")).output().unwrap();
        assert!(
            installed.status.success(),
            "{}",
            String::from_utf8_lossy(&installed.stderr)
        );
        let lines = String::from_utf8(installed.stdout).unwrap();
        lines.lines().last().unwrap().to_owned()
    })
}

/// The JSON that `script` of tests/mavlink prints with these arguments.
pub fn run(script: &str, arguments: &[&str]) -> serde_json::Value {
    let heard = Command::new(python())
        .arg(root().join("tests/mavlink").join(script))
        .args(arguments)
        .output()
        .unwrap();
    assert!(
        heard.status.success(),
        "{}",
        String::from_utf8_lossy(&heard.stderr)
    );
    serde_json::from_slice(&heard.stdout).unwrap()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .find(|folder| folder.join(".ci").is_dir())
        .unwrap()
}
