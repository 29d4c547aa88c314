//! Servo pulses through a jumper. Servos unplugged.

#[embedded_test::tests]
mod tests {
    use embassy_time::Timer;
    use sophie_boards::WIRING;
    use sophie_ports::actuators::Servos;
    use sophie_rig::pads::joined;
    use sophie_rig::pulses::record;
    use sophie_rig::{absent, keep_alive};

    /// µs.
    const WIDTHS: [f32; 3] = [550.0, 1500.0, 2450.0];

    #[test]
    async fn pulses_are_as_long_as_asked_and_as_often() {
        let mut board = sophie_boards::take().await;
        keep_alive(board.watchdog);
        let [servo, listener] = WIRING.servo;
        assert!(servo.serves_a_peripheral(), "{} is no timer's", servo.name);
        if !joined(WIRING.servo) {
            return absent(format_args!("jumper from {} to {}", servo.name, listener.name));
        }
        let _listener = listener.take();
        let frame = 1e6 / board.params.servo_frame_rate;
        let us = |cycles: u32| cycles as f32 * (1e6 / WIRING.core_hz as f32);
        for width in WIDTHS {
            board.servos.write([width, 0.0, 0.0, 0.0]).await;
            // A new width starts with the next frame.
            Timer::after_micros(2 * frame as u64).await;
            let line = record(listener, 3 * frame as u32);
            let [first, second, ..] = line.as_slice() else {
                panic!("{} pulses in three frames", line.len());
            };
            let (high, between) = (us(first.high), us(second.rise - first.rise));
            defmt::info!("{=f32} us every {=f32} us", high, between);
            // 0.2 %, and an interrupt's time.
            let near = |found: f32, asked: f32| (found - asked).abs() <= 0.002 * asked + 5.0;
            assert!(near(high, width), "{high} us instead of {width}");
            assert!(near(between, frame), "every {between} us instead of {frame}");
        }
        board.servos.write([0.0; 4]).await;
        Timer::after_micros(2 * frame as u64).await;
        let line = record(listener, 2 * frame as u32);
        assert!(
            line.is_empty(),
            "{} pulses after the servo was switched off",
            line.len()
        );
    }
}
