//! The receiver's line looped back: telemetry at 420 kbaud comes in again. Receiver unplugged.

#[embedded_test::tests]
mod tests {
    use embassy_futures::join::join;
    use embassy_time::{Duration, with_timeout};
    use sophie_boards::WIRING;
    use sophie_control::params::RcProtocol;
    use sophie_ports::serial::{SerialInput, SerialOutput};
    use sophie_rig::pads::joined;
    use sophie_rig::{absent, keep_alive};

    /// A frame with sixteen channels.
    const LENGTH: usize = 26;
    const FRAMES: u8 = 100;
    /// A frame takes 0.6 ms.
    const LONGEST: Duration = Duration::from_millis(10);

    fn frame(number: u8) -> [u8; LENGTH] {
        core::array::from_fn(|place| (place as u8).wrapping_mul(37) ^ number)
    }

    async fn take(line: &mut sophie_boards::ReceiverLine) -> [u8; LENGTH] {
        let mut bytes = [0; LENGTH];
        let mut filled = 0;
        while let Some(room @ [_, ..]) = bytes.get_mut(filled..) {
            match line.read(room).await {
                Ok(count) => filled += count,
                Err(error) => panic!("{error:?} after {filled} bytes"),
            }
        }
        bytes
    }

    #[test]
    async fn what_is_sent_is_received() {
        let mut board = sophie_boards::take().await;
        keep_alive(board.watchdog);
        if board.params.rc_protocol != RcProtocol::Crsf {
            return absent(format_args!("CRSF: set rc_protocol to 0"));
        }
        let [out, into] = WIRING.receiver;
        for pad in [out, into] {
            assert!(pad.serves_a_peripheral(), "{} is no port's", pad.name);
        }
        if !joined(WIRING.receiver) {
            return absent(format_args!("jumper from {} to {}", out.name, into.name));
        }
        // Starts the ring, and discards what the jumper search left.
        let _ = with_timeout(LONGEST, board.receiver.read(&mut [0; LENGTH])).await;
        for number in 0..FRAMES {
            let sent = frame(number);
            let both = join(board.telemetry.write(&sent), take(&mut board.receiver));
            match with_timeout(LONGEST, both).await {
                Ok((Ok(()), received)) => assert!(received == sent, "frame {number}: {received:?}"),
                Ok((Err(error), _)) => panic!("frame {number}: {error:?}"),
                Err(_) => panic!("frame {number}: not received in time"),
            }
        }
    }
}
