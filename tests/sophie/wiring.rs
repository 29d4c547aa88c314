//! The pads in docs/wiring.md are those of the boards' files.

use std::collections::BTreeMap;
use std::fmt::Write;

const BOARDS: [&str; 3] = ["matek-h743", "cuav-v5", "f405"];

/// What hangs on the board, and the resources of its file that carry it.
const SIGNALS: [(&str, &[&str]); 18] = [
    (
        "motors 1 to 4",
        &[
            "motors.motor_1",
            "motors.motor_2",
            "motors.motor_3",
            "motors.motor_4",
        ],
    ),
    (
        "tendon servos 1 to 4",
        &[
            "servos.servo_1",
            "servos.servo_2",
            "servos.servo_3",
            "servos.servo_4",
        ],
    ),
    ("pressure sensor 1", &["analog.fsr_1"]),
    ("pressure sensor 2", &["analog.fsr_2"]),
    ("pressure sensor 3", &["analog.fsr_3"]),
    ("pressure sensor 4", &["analog.fsr_4"]),
    ("arm sensors 1 and 2: clock", &["left_arms.clock"]),
    ("arm sensors 1 and 2: data", &["left_arms.data"]),
    ("arm sensors 3 and 4: clock", &["right_arms.clock"]),
    ("arm sensors 3 and 4: data", &["right_arms.data"]),
    ("receiver: its output, its input", &["receiver.rx", "receiver.tx"]),
    ("console: adapter's TX, its RX", &["console.rx", "console.tx"]),
    ("MAVLink: other end's TX, its RX", &["mavlink.rx", "mavlink.tx"]),
    ("flow and range: module's TX", &["ground.rx"]),
    ("USB: D+, D-", &["usb.dp", "usb.dm"]),
    (
        "battery: voltage, current",
        &["analog.battery_voltage", "analog.battery_current"],
    ),
    ("servo battery: voltage", &["analog.servo_battery"]),
    ("buzzer", &["lights.buzzer"]),
];

/// How a board's maker names the pads of pins; elsewhere the pin's name is all that there is.
fn pad(board: &str, pin: &str) -> Option<&'static str> {
    Some(match (board, pin) {
        ("matek-h743", "PD12") => "S7",
        ("matek-h743", "PD13") => "S8",
        ("matek-h743", "PD14") => "S9",
        ("matek-h743", "PD15") => "S10",
        ("matek-h743", "PA0") => "S3",
        ("matek-h743", "PA1") => "S4",
        ("matek-h743", "PA2") => "S5",
        ("matek-h743", "PA3") => "S6",
        ("matek-h743", "PB0") => "S1",
        ("matek-h743", "PB1") => "S2",
        ("matek-h743", "PD9") => "RX3",
        ("matek-h743", "PC5") => "RSSI",
        ("matek-h743", "PA7") => "CU2",
        ("matek-h743", "PB6") => "CL1",
        ("matek-h743", "PB7") => "DA1",
        ("matek-h743", "PB10") => "CL2",
        ("matek-h743", "PB11") => "DA2",
        ("matek-h743", "PC7") => "RX6",
        ("matek-h743", "PC6") => "TX6",
        ("matek-h743", "PE7") => "RX7",
        ("matek-h743", "PE8") => "TX7",
        ("matek-h743", "PA10") => "RX1",
        ("matek-h743", "PA9") => "TX1",
        ("matek-h743", "PC0" | "PC1" | "PA11" | "PA12") => "on board",
        ("matek-h743", "PA4") => "VB2",
        ("matek-h743", "PA15") => "BZ-",
        ("cuav-v5", "PE9") => "AUX 4",
        ("cuav-v5", "PE11") => "AUX 3",
        ("cuav-v5", "PA10") => "AUX 2",
        ("cuav-v5", "PE14") => "AUX 1",
        ("cuav-v5", "PD13") => "AUX 5",
        ("cuav-v5", "PD14") => "AUX 6",
        ("cuav-v5", "PH6") => "AUX 7",
        ("cuav-v5", "PH9") => "AUX 8",
        ("cuav-v5", "PC4") => "ADC",
        ("cuav-v5", "PA5") => "CAP1",
        ("cuav-v5", "PB0") => "RSSI",
        ("cuav-v5", "PA2") => "POWER2 voltage",
        ("cuav-v5", "PA3") => "POWER2 current",
        ("cuav-v5", "PB8" | "PB9") => "GPS",
        ("cuav-v5", "PF1" | "PF0") => "I2C2",
        ("cuav-v5", "PD0") => "UART4 RX",
        ("cuav-v5", "PD9") => "TELEM2 RX",
        ("cuav-v5", "PD8") => "TELEM2 TX",
        ("cuav-v5", "PF6") => "FMU debug RX",
        ("cuav-v5", "PE8") => "FMU debug TX",
        ("cuav-v5", "PD6") => "TELEM1 RX",
        ("cuav-v5", "PD5") => "TELEM1 TX",
        ("cuav-v5", "PA0" | "PA1") => "POWER1",
        ("cuav-v5", "PE5" | "PA11" | "PA12") => "on board",
        _ => return None,
    })
}

/// The pins of a board's `assign_resources!`, by `group.name`.
fn pins(board: &str) -> BTreeMap<String, String> {
    let path = format!(
        "{}/boards/src/{}.rs",
        env!("CARGO_MANIFEST_DIR"),
        board.replace('-', "_")
    );
    let source = std::fs::read_to_string(&path).unwrap();
    let (_, rest) = source.split_once("\nassign_resources! {\n").unwrap();
    let (block, _) = rest.split_once("\n}\n").unwrap();
    let mut group = "";
    let mut pins = BTreeMap::new();
    for line in block.lines().map(str::trim) {
        let Some((name, value)) = line.split_once(": ") else {
            continue;
        };
        if value.ends_with('{') {
            group = name;
        } else {
            pins.insert(format!("{group}.{name}"), value.trim_end_matches(',').to_owned());
        }
    }
    pins
}

fn cell(board: &str, pins: &BTreeMap<String, String>, names: &[&str]) -> String {
    let pins = names
        .iter()
        .map(|name| pins.get(*name).unwrap_or_else(|| panic!("{board} has no {name}")));
    let shown = pins.map(|pin| match pad(board, pin) {
        Some(pad) => format!("{pad} ({pin})"),
        None => pin.clone(),
    });
    shown.collect::<Vec<_>>().join(", ")
}

#[test]
fn the_pads_of_the_page_are_those_of_the_boards_files() {
    let mut table = String::from("| what | `matek-h743` | `cuav-v5` | `f405` |\n|---|---|---|---|\n");
    let boards = BOARDS.map(|board| (board, pins(board)));
    for (what, names) in SIGNALS {
        let cells = boards.each_ref().map(|(board, pins)| cell(board, pins, names));
        writeln!(table, "| {what} | {} |", cells.join(" | ")).unwrap();
    }
    sophie_pages::hold("wiring", &[("pads", table)], "--test sophie wiring::");
}
