//! The two-channel timer TIM12 (RM0090 §19.4), which the emulator's part has the registers of but no model.

use rigless::soc::st::tim::{Counter, Family, Kind, Part};
use rigless::soc::stm32f427::generated::tim9::Register;
use rigless::soc::stm32f427::peripherals::tim::{PART, Tim};

/// Clock of the timers on the slow bus, Hz, from the board's start on. The emulator's clock tree does not lead to it.
const CLOCK: u64 = 84_000_000;
/// In the register of the slow bus's clocks, the timer's.
pub const ENABLED: u64 = 1 << 6;

/// The layout of TIM9 and TIM12: two channels, counting up.
#[derive(Debug, Clone, Copy)]
pub struct TwoChannels;

impl Family for TwoChannels {
    type Register = Register;
    type Instance = Counter;
    const PART: &'static Part = &PART;
    const KINDS: &'static [Kind] = &[Kind::TwoChannelSlave];
}

/// The timer out of reset.
pub fn tim12() -> Tim<TwoChannels> {
    Tim::with_clock(CLOCK, Counter::Narrow)
}
