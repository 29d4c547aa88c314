//! Times of an STM32 I2C with a register `TIMINGR` (F7, H7) in fast mode (400 kHz) and standard mode (100 kHz), from its
//! kernel clock (RM0433 §47.4.5 and §47.4.9, RM0410 §33.4.5 and §33.4.9; times of UM10204 table 10).
//!
//! At 100 MHz embassy-stm32 0.6 loses the upper bits of fields too large for the register: data would change 20 ns
//! before the clock's edge instead of the required 100 ns, from the slowest data edge.

use sophie_control::params::ArmBusSpeed;

/// Slowest falling edge, ns, in both modes.
const FALL_NS: u64 = 300;
/// Shortest and longest analog filter delay, ns.
const FILTER_NS: [u64; 2] = [50, 260];

/// What a mode of the bus wants, ns (UM10204 table 10).
struct Mode {
    /// Slowest rising edge: largest pull-up and capacitance.
    rise: u64,
    /// Data valid before the clock rises.
    set_up: u64,
    /// Data valid after the clock falls, edge included.
    valid: u64,
    /// Shortest low and high time of the clock.
    low: u64,
    high: u64,
    /// Shortest clock period.
    period: u64,
    /// Share of the period that the clock is low, unless the bus wants more.
    low_share: [u64; 2],
}

const FAST: Mode = Mode {
    rise: 300,
    set_up: 100,
    valid: 900,
    low: 1300,
    high: 600,
    period: 2500,
    low_share: [2, 3],
};
const STANDARD: Mode = Mode {
    rise: 1000,
    set_up: 250,
    valid: 3450,
    low: 4700,
    high: 4000,
    period: 10_000,
    low_share: [1, 2],
};

/// Kernel clock cycles to detect both edges of the own clock.
const SYNC: u64 = 4;

/// Times are cycles times this, rounded at the end.
const NS: u64 = 1_000_000_000;

/// Register fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct I2cTiming {
    /// Kernel clock cycles per tick, less one: 0 to 15.
    pub prescaler: u8,
    /// Ticks from data to clock rise, less one: 0 to 15.
    pub set_up: u8,
    /// Ticks from clock fall to data: 0 to 15.
    pub hold: u8,
    /// Ticks of clock high time, less one.
    pub high: u8,
    /// Ticks of clock low time, less one.
    pub low: u8,
}

impl I2cTiming {
    /// Times at a kernel clock of `clock_hz` with the shortest fitting ticks; `None` if none fit (fast mode: some clocks
    /// below 23 MHz, those above some 600). No digital filter.
    pub const fn at(clock_hz: u32, speed: ArmBusSpeed) -> Option<Self> {
        let mode = match speed {
            ArmBusSpeed::Standard => STANDARD,
            ArmBusSpeed::Fast => FAST,
        };
        let hz = clock_hz as u64;
        let mut prescaler = 0;
        while prescaler < 16 {
            let tick = (prescaler as u64 + 1) * NS;
            let set_up = ((mode.rise + mode.set_up) * hz).div_ceil(tick);
            // The edge must have ended, less filter and synchroniser.
            let hold = ((FALL_NS - FILTER_NS[0]) * hz)
                .saturating_sub(3 * NS)
                .div_ceil(tick);
            let latest = ((mode.valid - mode.rise - FILTER_NS[1]) * hz).saturating_sub(4 * NS) / tick;
            let period = (mode.period * hz).saturating_sub(SYNC * NS).div_ceil(tick);
            let [part, parts] = mode.low_share;
            let low = longer((part * period).div_ceil(parts), (mode.low * hz).div_ceil(tick));
            let high = longer(period.saturating_sub(low), (mode.high * hz).div_ceil(tick));
            if set_up <= 16 && hold <= latest && hold <= 15 && low <= 256 && high <= 256 {
                return Some(Self {
                    prescaler,
                    set_up: (set_up - 1) as u8,
                    hold: hold as u8,
                    high: (high - 1) as u8,
                    low: (low - 1) as u8,
                });
            }
            prescaler += 1;
        }
        None
    }
}

const fn longer(a: u64, b: u64) -> u64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the kernel clocks of the Matek H743 and CUAV V5, evaluated at compile time.
    const MATEK: Option<I2cTiming> = I2cTiming::at(100_000_000, ArmBusSpeed::Fast);
    const CUAV: Option<I2cTiming> = I2cTiming::at(54_000_000, ArmBusSpeed::Fast);

    #[test]
    fn the_boards_have_the_shortest_ticks_that_fit() {
        let matek = I2cTiming {
            prescaler: 2,
            set_up: 13,
            hold: 8,
            high: 26,
            low: 54,
        };
        let cuav = I2cTiming {
            prescaler: 1,
            set_up: 10,
            hold: 6,
            high: 21,
            low: 43,
        };
        assert_eq!((MATEK, CUAV), (Some(matek), Some(cuav)));
    }

    #[test]
    fn every_clock_gets_what_the_bus_wants() {
        let modes = [
            (ArmBusSpeed::Fast, 300.0, [1300.0, 600.0, 2500.0], 100.0, 900.0),
            (
                ArmBusSpeed::Standard,
                1000.0,
                [4700.0, 4000.0, 10_000.0],
                250.0,
                3450.0,
            ),
        ];
        for (speed, rise, [low_min, high_min, period_min], set_up, valid) in modes {
            for mhz in 23..=150 {
                let t =
                    I2cTiming::at(mhz * 1_000_000, speed).unwrap_or_else(|| panic!("{speed:?} at {mhz} MHz"));
                let cycle = 1e3 / f64::from(mhz);
                let ns =
                    |ticks: u8, more: f64| (f64::from(ticks) + more) * (f64::from(t.prescaler) + 1.0) * cycle;
                let (low, high) = (ns(t.low, 1.0), ns(t.high, 1.0));
                let near = 1e-6;
                assert!(
                    low >= low_min - near && high >= high_min - near,
                    "{speed:?} at {mhz} MHz: {low} {high}"
                );
                let period = low + high + 4.0 * cycle;
                assert!(
                    (period_min - near..1.12 * period_min).contains(&period),
                    "{speed:?} at {mhz} MHz: {period}"
                );
                assert!(
                    ns(t.set_up, 1.0) >= rise + set_up - near,
                    "{speed:?} at {mhz} MHz: {t:?}"
                );
                let hold = ns(t.hold, 0.0);
                assert!(
                    hold >= 300.0 - 50.0 - 3.0 * cycle - near,
                    "{speed:?} at {mhz} MHz: {hold}"
                );
                assert!(
                    hold <= valid - rise - 260.0 - 4.0 * cycle + near,
                    "{speed:?} at {mhz} MHz: {hold}"
                );
                assert!(
                    t.prescaler < 16 && t.set_up < 16 && t.hold < 16,
                    "{speed:?} at {mhz} MHz: {t:?}"
                );
            }
        }
        assert_eq!(I2cTiming::at(17_000_000, ArmBusSpeed::Fast), None);
    }
}
