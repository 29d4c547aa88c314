//! The analog inputs: conversion time, and a known voltage.

#[embedded_test::tests]
mod tests {
    use embassy_time::{Duration, Instant};
    use sophie_boards::{Pupdr, WIRING};
    use sophie_ports::sensors::Analog;
    use sophie_rig::pads::settle;
    use sophie_rig::{absent, keep_alive};

    /// Longest conversion of all inputs: a quarter of the 2 ms period.
    const LONGEST: Duration = Duration::from_micros(500);
    /// Half of full scale, and 2 % of it, counts.
    const HALF: u16 = 2048;
    const TOLERANCE: u16 = 41;

    async fn input(analog: &mut sophie_boards::AnalogPort) -> u16 {
        match analog.read().await {
            Ok(frame) => frame.fsr[WIRING.divider.1],
            Err(error) => panic!("{error:?}"),
        }
    }

    #[test]
    async fn every_conversion_is_in_time() {
        let mut board = sophie_boards::take().await;
        keep_alive(board.watchdog);
        let mut worst = Duration::MIN;
        for _ in 0..500 {
            let start = Instant::now();
            input(&mut board.analog).await;
            worst = worst.max(start.elapsed());
        }
        defmt::info!("conversions: {=u64} us at worst", worst.as_micros());
        assert!(worst <= LONGEST, "{} us", worst.as_micros());
    }

    /// Divider of two equal resistors, 1 to 10 kOhm, from 3.3 V to ground, its middle at the pad.
    #[test]
    async fn half_the_supply_is_half_the_scale() {
        let mut board = sophie_boards::take().await;
        keep_alive(board.watchdog);
        let (pad, _) = WIRING.divider;
        // Without a divider the pad keeps its charge.
        let mut counts = [0; 2];
        for (counts, high) in counts.iter_mut().zip([false, true]) {
            let taken = pad.take();
            taken.drive(high);
            settle(100);
            taken.listen(Pupdr::FLOATING);
            settle(100);
            drop(taken);
            *counts = input(&mut board.analog).await;
        }
        let [low, high] = counts;
        defmt::info!("{=str}: {=u16} and {=u16} counts", pad.name, low, high);
        if low.abs_diff(high) > TOLERANCE {
            return absent(format_args!("divider of two equal resistors at {}", pad.name));
        }
        assert!(low.abs_diff(HALF) <= TOLERANCE, "{low} counts instead of {HALF}");
    }
}
