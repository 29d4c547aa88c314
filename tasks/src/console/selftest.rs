//! The self-test as a table of result, measured value and allowed range.

use embassy_time::Timer;

use super::Console;
use crate::supervision::self_test::{ROWS, SelfTest, TIME};
use sophie_mavlink::Row;
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    /// Runs all tests that need no motion.
    pub(super) async fn selftest(&mut self) {
        if let Err(why) = self.stopped() {
            return self.refuse("not tested", why).await;
        }
        let mut test = SelfTest::begin(self.links);
        Timer::after(TIME).await;
        test.is_ready(self.links);
        let (mut all, mut failed) = (0, 0);
        for number in 0..ROWS {
            let Some(Row {
                name, passed, found, ..
            }) = test.row(self.links, number)
            else {
                continue;
            };
            all += 1;
            failed += u8::from(!passed);
            let verdict = if passed { "pass" } else { "FAIL" };
            self.out.line(format_args!("{verdict}  {name:18} {found}")).await;
        }
        match failed {
            0 => self.out.line(format_args!("all {all} passed")).await,
            _ => self.out.line(format_args!("{failed} of {all} failed")).await,
        }
    }
}
