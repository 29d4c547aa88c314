//! The two-channel timer TIM12 (RM0090 §19.4), which the emulator does not model.

use rigless::soc::st::tim::{Counter, Family, Kind, Part};
use rigless::soc::stm32f427::generated::tim9::Register;
use rigless::soc::stm32f427::peripherals::tim::{PART, Tim};

/// Clock on the slow bus, Hz; the emulator's clock tree does not reach the timer.
const CLOCK: u64 = 84_000_000;
/// Its bit in the slow bus's clock register.
pub const ENABLED: u64 = 1 << 6;

/// TIM9 and TIM12: two channels, counting up.
#[derive(Debug, Clone, Copy)]
pub struct TwoChannels;

impl Family for TwoChannels {
    type Register = Register;
    type Instance = Counter;
    const PART: &'static Part = &PART;
    const KINDS: &'static [Kind] = &[Kind::TwoChannelSlave];
}

pub fn tim12() -> Tim<TwoChannels> {
    Tim::with_clock(CLOCK, Counter::Narrow)
}
