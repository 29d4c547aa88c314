//! Checks the timing of an I2C interface against its mode. The emulator's chips answer at any timing.

use sophie_control::params::ArmBusSpeed;

/// Times of a `TIMINGR` at `hz` that breach the mode (UM10204 table 10, by RM0433 §47.4.5), or that are of another.
pub fn wrong(timing: u64, hz: f64, speed: ArmBusSpeed) -> Option<String> {
    // Slowest edge and set-up; valid less that edge; low; high; period, ns.
    let [set_up, valid, shortest_low, shortest_high, period] = match speed {
        ArmBusSpeed::Fast => [300.0 + 100.0, 900.0 - 300.0, 1300.0, 600.0, 2500.0],
        ArmBusSpeed::Standard => [1000.0 + 250.0, 3450.0 - 1000.0, 4700.0, 4000.0, 10_000.0],
    };
    let field = |shift: u32, bits: u32| (timing >> shift & ((1 << bits) - 1)) as f64;
    let cycle = 1e9 / hz;
    let tick = (field(28, 4) + 1.0) * cycle;
    let (low, high) = ((field(0, 8) + 1.0) * tick, (field(8, 8) + 1.0) * tick);
    let limits = [
        ("data set-up", (field(20, 4) + 1.0) * tick, set_up, f64::INFINITY),
        // Plus analog filter and synchroniser: 50 to 260 ns, 3 to 4 cycles.
        (
            "data hold",
            field(16, 4) * tick,
            250.0 - 3.0 * cycle,
            valid - 260.0 - 4.0 * cycle,
        ),
        ("clock low", low, shortest_low, f64::INFINITY),
        ("clock high", high, shortest_high, f64::INFINITY),
        // No slower than it may be by a quarter.
        ("clock period", low + high + 4.0 * cycle, period, 1.25 * period),
    ];
    let near = 1e-6;
    limits
        .into_iter()
        .find(|(_, time, least, most)| *time < least - near || *time > most + near)
        .map(|(what, time, least, most)| format!("{what} {time:.0} ns, wanted {least:.0} to {most:.0}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn register([prescaler, set_up, hold, high, low]: [u64; 5]) -> u64 {
        prescaler << 28 | set_up << 20 | hold << 16 | high << 8 | low
    }

    #[test]
    fn a_wrong_bus_timing_is_reported() {
        let wrong = |fields| wrong(register(fields), 100e6, ArmBusSpeed::Fast);
        assert_eq!(wrong([2, 13, 8, 26, 54]), None);
        for (fields, complaint) in [
            // What embassy-stm32 0.6 leaves of 49 and 25 at 100 MHz.
            ([0, 1, 9, 82, 165], "data set-up 20 ns, wanted 400 to inf"),
            ([2, 13, 3, 26, 54], "data hold 90 ns, wanted 220 to 300"),
            ([2, 13, 8, 40, 40], "clock low 1230 ns, wanted 1300 to inf"),
            ([2, 13, 8, 18, 62], "clock high 570 ns, wanted 600 to inf"),
            ([2, 13, 8, 22, 54], "clock period 2380 ns, wanted 2500 to 3125"),
        ] {
            assert_eq!(wrong(fields).as_deref(), Some(complaint));
        }
    }
}
