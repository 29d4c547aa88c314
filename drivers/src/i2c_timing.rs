//! Fast-mode times (400 kHz) of an STM32 I2C with a register `TIMINGR` (F7, H7), from its kernel clock (RM0433 §47.4.5
//! and §47.4.9, RM0410 §33.4.5 and §33.4.9; times of UM10204 table 10).
//!
//! At 100 MHz embassy-stm32 0.6 loses the upper bits of fields too large for the register: data would change 20 ns
//! before the clock's edge instead of the required 100 ns, from the slowest data edge.

/// Slowest edge, ns: largest pull-up and capacitance.
const EDGE_NS: u64 = 300;
/// Data valid before the clock rises, ns.
const SET_UP_NS: u64 = 100;
/// Data valid after the clock falls, edge included, ns.
const VALID_NS: u64 = 900;
/// Shortest and longest analog filter delay, ns.
const FILTER_NS: [u64; 2] = [50, 260];
/// Shortest low and high time of the clock, ns.
const LOW_NS: u64 = 1300;
const HIGH_NS: u64 = 600;
/// Shortest clock period, ns: 400 kHz.
const PERIOD_NS: u64 = 2500;
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
    /// Fast mode at a kernel clock of `clock_hz` with the shortest fitting ticks; `None` if none fit (some clocks below
    /// 23 MHz, those above some 600). No digital filter.
    pub const fn fast_mode(clock_hz: u32) -> Option<Self> {
        let hz = clock_hz as u64;
        let mut prescaler = 0;
        while prescaler < 16 {
            let tick = (prescaler as u64 + 1) * NS;
            let set_up = ((EDGE_NS + SET_UP_NS) * hz).div_ceil(tick);
            // The edge must have ended, less filter and synchroniser.
            let hold = ((EDGE_NS - FILTER_NS[0]) * hz)
                .saturating_sub(3 * NS)
                .div_ceil(tick);
            let latest = ((VALID_NS - EDGE_NS - FILTER_NS[1]) * hz).saturating_sub(4 * NS) / tick;
            let period = (PERIOD_NS * hz).saturating_sub(SYNC * NS).div_ceil(tick);
            // Two parts low, one high, unless the bus requires more.
            let low = longer((2 * period).div_ceil(3), (LOW_NS * hz).div_ceil(tick));
            let high = longer(period.saturating_sub(low), (HIGH_NS * hz).div_ceil(tick));
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
    const MATEK: Option<I2cTiming> = I2cTiming::fast_mode(100_000_000);
    const CUAV: Option<I2cTiming> = I2cTiming::fast_mode(54_000_000);

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
        for mhz in 23..=150 {
            let t = I2cTiming::fast_mode(mhz * 1_000_000).unwrap_or_else(|| panic!("{mhz} MHz"));
            let cycle = 1e3 / f64::from(mhz);
            let ns =
                |ticks: u8, more: f64| (f64::from(ticks) + more) * (f64::from(t.prescaler) + 1.0) * cycle;
            let (low, high) = (ns(t.low, 1.0), ns(t.high, 1.0));
            let near = 1e-6;
            assert!(
                low >= 1300.0 - near && high >= 600.0 - near,
                "{mhz}: {low} {high}"
            );
            let period = low + high + 4.0 * cycle;
            assert!((2500.0 - near..2800.0).contains(&period), "{mhz}: {period}");
            assert!(ns(t.set_up, 1.0) >= 400.0 - near, "{mhz}: {t:?}");
            let hold = ns(t.hold, 0.0);
            assert!(hold >= 300.0 - 50.0 - 3.0 * cycle - near, "{mhz}: {hold}");
            assert!(
                hold <= 900.0 - 300.0 - 260.0 - 4.0 * cycle + near,
                "{mhz}: {hold}"
            );
            assert!(t.prescaler < 16 && t.set_up < 16 && t.hold < 16, "{mhz}: {t:?}");
        }
        assert_eq!(I2cTiming::fast_mode(17_000_000), None);
    }
}
