//! Faults that a run injects at set times.

use sophie_sim::sensors::fsr::FsrBreak;

use crate::sensors::Sensors;
use crate::wires::BoardFault;

/// A trouble or its repair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trouble {
    /// At the board.
    Board(BoardFault),
    /// Lead of an arm's pressure sensor (0 to 3) broken, shorted to its neighbour, or mended.
    Fsr(usize, Option<FsrBreak>),
    /// Silent (true) or sending.
    RadioSilent(bool),
    /// Bit errors in one of this many bytes from the receiver; 0: none.
    RadioBits(u32),
    /// Share of the battery voltage at its divider.
    BatteryShare(f64),
}

/// Troubles with their times, and the radio line's state.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    troubles: Vec<(u64, Trouble)>,
    next: usize,
    silent: bool,
    every: u32,
    bytes: u32,
}

impl Plan {
    /// `troubles` have times in ms since power-on.
    #[must_use]
    pub fn new(troubles: impl IntoIterator<Item = (u64, Trouble)>) -> Self {
        let mut troubles: Vec<_> = troubles.into_iter().collect();
        troubles.sort_by_key(|(at, _)| *at);
        Self {
            troubles,
            ..Self::default()
        }
    }

    /// Applies troubles due at `ms`.
    pub fn apply(&mut self, ms: u64, sensors: &mut Sensors, faults: &mut Vec<BoardFault>) {
        while let Some((at, trouble)) = self.troubles.get(self.next)
            && *at <= ms
        {
            self.next += 1;
            match *trouble {
                Trouble::Board(fault) => faults.push(fault),
                Trouble::Fsr(arm, broken) => sensors.break_fsr(arm, broken),
                Trouble::RadioSilent(silent) => self.silent = silent,
                Trouble::RadioBits(every) => self.every = every,
                Trouble::BatteryShare(share) => sensors.battery_share = share,
            }
        }
    }

    /// Appends to `line` what the receiver delivers of `words`.
    pub fn radio(&mut self, words: impl Iterator<Item = u16>, line: &mut Vec<u16>) {
        if self.silent {
            return;
        }
        for word in words {
            self.bytes = self.bytes.wrapping_add(1);
            let hit = self.every > 0 && self.bytes.is_multiple_of(self.every);
            line.push(word ^ if hit { 0x10 } else { 0 });
        }
    }
}
