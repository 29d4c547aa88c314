//! Motor frames, read bit by bit through a jumper. ESCs unplugged.

#[embedded_test::tests]
mod tests {
    use embassy_futures::join::join;
    use embassy_time::Timer;
    use sophie_boards::WIRING;
    use sophie_drivers::dshot::{BITS, Frame, Speed};
    use sophie_drivers::dshot_decoder::Decoder;
    use sophie_drivers::esc_protocol::EscProtocol;
    use sophie_ports::actuators::Motors;
    use sophie_rig::pads::joined;
    use sophie_rig::pulses::{MOST, Pulse, record};
    use sophie_rig::{absent, keep_alive};

    /// Motor 1: stop, least throttle, patterns, full.
    const COMMANDS: [f32; 5] = [0.0, 0.001, 0.333, 0.667, 1.0];

    /// In cycles.
    async fn sent(motors: &mut sophie_boards::MotorsPort, command: f32) -> heapless::Vec<Pulse, MOST> {
        // Frame and lead-in of the slowest protocol take 120 µs. DMA sends the frame: interrupts may be off while the
        // line is read.
        let (_, line) = join(motors.write([command, 0.0, 0.0, 0.0]), async {
            critical_section::with(|_| record(WIRING.motor[1], 150))
        })
        .await;
        line
    }

    #[test]
    async fn a_controller_would_read_every_frame() {
        let mut board = sophie_boards::take().await;
        keep_alive(board.watchdog);
        let [motor, listener] = WIRING.motor;
        let EscProtocol::DShot(speed) = EscProtocol::from_params(&board.params) else {
            return absent(format_args!("DShot: set motor_protocol to 150, 300 or 600"));
        };
        assert!(motor.serves_a_peripheral(), "{} is no timer's", motor.name);
        if !joined(WIRING.motor) {
            return absent(format_args!("jumper from {} to {}", motor.name, listener.name));
        }
        let _listener = listener.take();
        for command in COMMANDS {
            let line = sent(&mut board.motors, command).await;
            check(&line, command, speed);
            Timer::after_millis(1).await;
        }
    }

    fn check(line: &[Pulse], command: f32, speed: Speed) {
        let bit = WIRING.core_hz / speed.bits_per_second();
        let mut decoder = Decoder::new(bit);
        let frames = line
            .iter()
            .filter_map(|pulse| decoder.pulse(u64::from(pulse.rise), pulse.high));
        let expected = Frame::from_command(command);
        let mut count = 0;
        for frame in frames {
            assert!(
                frame == Ok(expected),
                "{command}: {frame:?} instead of {expected:?}"
            );
            count += 1;
        }
        assert!(count == 1, "{command}: {count} frames in {} pulses", line.len());
        let [first, .., last] = line else {
            panic!("{command}: no pulses");
        };
        let length = (last.rise - first.rise) / (BITS as u32 - 1);
        defmt::info!(
            "command {=f32}: bits of {=u32} cycles, nominal {=u32}",
            command,
            length,
            bit
        );
        assert!(
            length.abs_diff(bit) <= bit / 50,
            "bits of {length} cycles instead of {bit}"
        );
    }
}
