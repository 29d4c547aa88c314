//! Pins for motors and servos: none of the debug port, which the chip pulls or drives from reset on.
//!
//! Some servos take a pulled-up input for an endless pulse, and a reset may happen on the pipe. The build script checks
//! its board's table, the tests all.

/// Debug port pins at reset: SWDIO, JTDI and NJTRST with a pull-up, SWCLK with a pull-down, JTDO (RM0090 §8.3.2, RM0410
/// §6.3.2, RM0433 §11.3.2).
const DEBUG_PORT: [&str; 5] = ["PA13", "PA14", "PA15", "PB3", "PB4"];

/// Checks that a board's table (`assign_resources!`) has `motor_1` to `motor_4` and `servo_1` to `servo_4`, none on a
/// debug port pin.
///
/// # Errors
/// One line: the field, its pin, and the pins not allowed.
pub fn check(table: &str) -> Result<(), String> {
    for output in ["motor", "servo"] {
        for number in 1..=4 {
            let field = format!("{output}_{number}");
            let pin = pin_of(table, &field).ok_or_else(|| {
                format!("names no pin `{field}`: the pins of motors and servos are looked at")
            })?;
            if DEBUG_PORT.contains(&pin) {
                return Err(format!(
                    "has {field} on {pin}, which the chip pulls or drives by itself from its reset on: allowed is any \
                     pin but {}",
                    DEBUG_PORT.join(", ")
                ));
            }
        }
    }
    Ok(())
}

/// The pin of a field: `servo_1: PB6,` has PB6.
fn pin_of<'a>(table: &'a str, field: &str) -> Option<&'a str> {
    table.lines().find_map(|line| {
        let pin = line.trim().strip_prefix(field)?.strip_prefix(':')?;
        Some(pin.trim().trim_end_matches(','))
    })
}

#[cfg(test)]
mod tests {
    use super::check;

    const BOARDS: [(&str, &str); 3] = [
        ("matek-h743", include_str!("matek_h743.rs")),
        ("cuav-v5", include_str!("cuav_v5.rs")),
        ("f405", include_str!("f405.rs")),
    ];

    #[test]
    fn no_motor_and_no_servo_is_on_a_pin_of_the_debug_port() {
        for (board, table) in BOARDS {
            assert_eq!(check(table), Ok(()), "{board}");
        }
    }

    /// Selects of what is or was at the CUAV's internal buses: inertial sensors and memory at SPI1, FRAM at SPI2, barometer
    /// and a second chip at SPI4 (PX4 `px4/fmu-v5`, ArduPilot `fmuv5`).
    const CUAV_SELECTS: [(&str, u32); 8] = [
        ("GPIOF", 2),
        ("GPIOF", 3),
        ("GPIOF", 4),
        ("GPIOG", 10),
        ("GPIOH", 5),
        ("GPIOF", 5),
        ("GPIOF", 10),
        ("GPIOF", 11),
    ];

    /// Pins of `port` that a board's first levels have high.
    fn first_high(table: &str, port: &str) -> Vec<u32> {
        let (_, levels) = table.split_once("FIRST_LEVELS:").expect("first levels");
        let (levels, _) = levels.split_once("];\n").expect("their end");
        let of_port = levels
            .split("PortLevels::new(")
            .filter(|entry| entry.starts_with(&format!("pac::{port},")));
        let high = of_port.filter_map(|entry| entry.rsplit_once("&[")?.1.split_once(']'));
        high.flat_map(|(pins, _)| pins.split(',').filter_map(|pin| pin.trim().parse().ok()))
            .collect()
    }

    #[test]
    fn every_chip_on_a_bus_of_the_cuav_is_deselected_from_the_first_instructions_on() {
        let (_, table) = BOARDS[1];
        for (port, pin) in CUAV_SELECTS {
            assert!(first_high(table, port).contains(&pin), "{port} {pin}");
            // Held by its port afterwards.
            let name = format!("P{}{pin}", &port[4..]);
            let held = table
                .lines()
                .filter(|line| line.trim_end().ends_with(&format!(": {name},")));
            assert_eq!(held.count(), 1, "{name}");
        }
        // The radio's CTS, low at its start, keeps it in its loader.
        assert_eq!(first_high(table, "GPIOD"), [4]);
    }

    #[test]
    fn a_servo_or_a_motor_on_such_a_pin_is_refused() {
        let (_, table) = BOARDS[2];
        for (field, pin, other) in [("servo_1", "PB6", "PB4"), ("motor_3", "PC8", "PA15")] {
            let moved = table.replace(&format!("{field}: {pin}"), &format!("{field}: {other}"));
            assert!(moved != table, "{field} is not on {pin}");
            let refused = check(&moved).unwrap_err();
            assert!(refused.contains(&format!("{field} on {other}")), "{refused}");
        }
        let nameless = table.replace("servo_2:", "second_servo:");
        assert!(check(&nameless).unwrap_err().contains("no pin `servo_2`"));
    }
}
