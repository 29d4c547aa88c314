//! The microcontroller: checks of the start-up, its boot loader, and its brown-out level.

use sophie_control::arming::ArmingInhibit;

use super::Console;
use crate::supervision::chip_rows;
use sophie_control::maths::decimal::Decimal;
use sophie_ports::chip::Chip;
use sophie_ports::chip_check::ChipCheck;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    /// Lists the start-up's checks (name, value read, value expected) and the greatest stack depth.
    pub(super) async fn silicon(&mut self) {
        for number in 0..chip_rows::rows(&self.chip) {
            let Some(check) = chip_rows::check(&self.chip, number) else {
                continue;
            };
            let ChipCheck {
                name,
                read,
                expected,
                ok,
                ..
            } = check;
            let mark = if ok { ' ' } else { '*' };
            self.out
                .line(format_args!("{mark} {name:20} {read:28} expected: {expected}"))
                .await;
        }
    }

    /// Restarts into the chip's boot loader; arming is refused until then.
    pub(super) async fn enter_loader(&mut self) {
        if let Err(status) = crate::storage::storing::inhibit_arming(self.links).await {
            return self.refuse("not left", status).await;
        }
        self.out
            .last(format_args!(
                "leaving for the chip's USB loader; a power cycle comes back"
            ))
            .await;
        self.chip.enter_loader();
    }

    /// Brown-out level read at start-up.
    fn brown_out_level(&self) -> Option<&ChipCheck> {
        let mut checks = self.chip.checks().iter();
        checks.find(|look| look.inhibits == Some(ArmingInhibit::BrownOutLevel))
    }

    /// Explains the present level and the effect of setting it.
    pub(super) async fn brown_out(&mut self) {
        let volts = Decimal(self.chip.brown_out_volts());
        let Some(ChipCheck {
            read, expected, ok, ..
        }) = self.brown_out_level()
        else {
            return self.out.line(format_args!("this chip has no level to set")).await;
        };
        let (read, expected, ok) = (read.clone(), *expected, *ok);
        self.out
            .line(format_args!("brown-out level {read}, expected {expected}"))
            .await;
        if ok {
            return self.out.line(format_args!("nothing to do")).await;
        }
        for text in [
            format_args!("Until it is set, a supply that breaks down lets the chip execute garbage."),
            format_args!(
                "'brownout set' writes it into the chip's option bytes and restarts. From then on the chip"
            ),
            format_args!(
                "stands in reset below about {volts:.1} V, with this firmware and every other, until a tool for"
            ),
            format_args!(
                "option bytes takes it back. Do it once, on a steady supply; nothing else is changed."
            ),
        ] {
            self.out.line(text).await;
        }
    }

    /// Sets the level and restarts. Arming is refused meanwhile: the write may stall the processor.
    pub(super) async fn set_brown_out(&mut self) {
        if self.brown_out_level().is_none_or(|look| look.ok) {
            return self.out.line(format_args!("not set: nothing to do")).await;
        }
        if let Err(why) = crate::storage::storing::inhibit_arming(self.links).await {
            return self.refuse("not set", why).await;
        }
        match self.chip.set_brown_out().await {
            Ok(()) => {
                self.out.last(format_args!("set; restarting")).await;
                self.chip.restart();
            }
            Err(_) => {
                self.links.report(ArmingInhibit::Storing, false);
                self.out
                    .line(format_args!("not set: the chip's option bytes did not take it"))
                    .await;
            }
        }
    }
}
