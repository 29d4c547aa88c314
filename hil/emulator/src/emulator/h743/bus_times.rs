//! Checks an I2C's times against fast mode: the emulator's chips answer at any.

/// Times of a `TIMINGR` at `hz` that breach fast mode (UM10204 table 10, by RM0433 §47.4.5).
pub fn wrong(timing: u64, hz: f64) -> Option<String> {
    let field = |shift: u32, bits: u32| (timing >> shift & ((1 << bits) - 1)) as f64;
    let cycle = 1e9 / hz;
    let tick = (field(28, 4) + 1.0) * cycle;
    let (low, high) = ((field(0, 8) + 1.0) * tick, (field(8, 8) + 1.0) * tick);
    let limits = [
        // Slowest edge, 300 ns, plus 100 ns.
        ("data set-up", (field(20, 4) + 1.0) * tick, 400.0, f64::INFINITY),
        // Plus analog filter and synchroniser: 50 to 260 ns, 3 to 4 cycles.
        (
            "data hold",
            field(16, 4) * tick,
            250.0 - 3.0 * cycle,
            340.0 - 4.0 * cycle,
        ),
        ("clock low", low, 1300.0, f64::INFINITY),
        ("clock high", high, 600.0, f64::INFINITY),
        ("clock period", low + high + 4.0 * cycle, 2500.0, f64::INFINITY),
    ];
    let near = 1e-6;
    limits
        .into_iter()
        .find(|(_, time, least, most)| *time < least - near || *time > most + near)
        .map(|(what, time, least, most)| format!("{what} {time:.0} ns, wanted {least:.0} to {most:.0}"))
}

#[cfg(test)]
mod tests {
    use super::wrong;

    fn register([prescaler, set_up, hold, high, low]: [u64; 5]) -> u64 {
        prescaler << 28 | set_up << 20 | hold << 16 | high << 8 | low
    }

    #[test]
    fn a_time_that_a_bus_does_not_want_is_told() {
        assert_eq!(wrong(register([2, 13, 8, 26, 54]), 100e6), None);
        for (fields, complaint) in [
            // What embassy-stm32 0.6 leaves of 49 and 25 at 100 MHz.
            ([0, 1, 9, 82, 165], "data set-up 20 ns, wanted 400 to inf"),
            ([2, 13, 3, 26, 54], "data hold 90 ns, wanted 220 to 300"),
            ([2, 13, 8, 40, 40], "clock low 1230 ns, wanted 1300 to inf"),
            ([2, 13, 8, 18, 62], "clock high 570 ns, wanted 600 to inf"),
            ([2, 13, 8, 22, 54], "clock period 2380 ns, wanted 2500 to inf"),
        ] {
            assert_eq!(wrong(register(fields), 100e6).as_deref(), Some(complaint));
        }
    }
}
