//! MAVLink to ground stations and companion computers, over any byte stream (docs/mavlink.md).
//!
//! Background: whatever arrives, or stays away, delays nothing that flies. A miss costs a late picture.

use core::pin::pin;

use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer};
use sophie_control::arming::ArmingInhibit;
use sophie_control::tendon::Reel;
use sophie_control::wrench::PerArm;
use sophie_mavlink::{Condition, Order, Server, Vehicle};

use crate::deadline::{FixedRate, TaskId, Tick};
use crate::links::Links;
use crate::ports::{SerialInput, SerialOutput, Storage};
use crate::storing;

/// Bytes taken at once.
const CHUNK: usize = 64;
/// Pause after a line error or an empty read, so that a dead line cannot take the processor.
const PAUSE: Duration = Duration::from_millis(1);

/// What is known of the line under a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// What the server may send, bytes each second: less than the line carries.
    pub bytes_per_second: u32,
}

/// Serves MAVLink on one line; never returns. `restart` restarts the board.
pub async fn run(
    links: &Links,
    mut input: impl SerialInput,
    mut output: impl SerialOutput,
    mut storage: impl Storage,
    mut restart: impl FnMut(),
    line: Line,
) -> ! {
    let mut server = Server::new(links.params, line.bytes_per_second);
    let reels = Reel::all(&links.params);
    let mut rate = FixedRate::of(links, TaskId::Mavlink);
    let mut vehicle = Vehicle::default();
    loop {
        let tick = listen(&mut rate, &mut input, &mut server, &vehicle).await;
        let now = tick.started.as_micros();
        vehicle = picture(links, &reels);
        while let Some(frame) = server.send(now, &vehicle) {
            // A frame that the line does not take is lost; the next one follows.
            let _ = output.write(frame).await;
        }
        match server.order(now, &vehicle) {
            Some(Order::Store) => {
                let stored = store(links, &mut storage, &server).await;
                server.stored(stored);
            }
            Some(Order::Restart) if storing::hold_arming(links).await.is_ok() => restart(),
            Some(Order::Restart) | None => (),
        }
    }
}

/// Hands what arrives to the server until the next run is due.
async fn listen(
    rate: &mut FixedRate<'_>,
    input: &mut impl SerialInput,
    server: &mut Server,
    vehicle: &Vehicle,
) -> Tick {
    let mut bytes = [0; CHUNK];
    let mut next = pin!(rate.next());
    loop {
        match select(next.as_mut(), input.read(&mut bytes)).await {
            Either::First(tick) => return tick,
            Either::Second(Ok(count)) if count > 0 => {
                let arrived = bytes.get(..count).unwrap_or_default();
                server.receive(arrived, Instant::now().as_micros(), vehicle);
                // A line that is never silent must not starve the others of this level.
                embassy_futures::yield_now().await;
            }
            Either::Second(_) => Timer::after(PAUSE).await,
        }
    }
}

/// Stores the server's parameters; arming is refused meanwhile.
async fn store(links: &Links, storage: &mut impl Storage, server: &Server) -> Result<(), &'static str> {
    storing::hold_arming(links).await.map_err(|_| "disarm first")?;
    storing::save(links, storage, server.params())
        .await
        .map_err(|error| error.text())?;
    // What flies are the old ones until a restart, which the text asks for.
    links.report(ArmingInhibit::Storing, false);
    Ok(())
}

/// What the links say now; a stale message counts as none.
fn picture(links: &Links, reels: &PerArm<Reel>) -> Vehicle {
    let angles = links.reel_angle.fresh();
    Vehicle {
        condition: links.status.fresh().map(|status| Condition {
            mode: status.mode,
            reason: status.reason,
            warning: status.warning,
            inhibits: status.inhibits,
        }),
        attitude: links.attitude.fresh(),
        sticks: links.rc.fresh().map(|rc| rc.sticks),
        battery: links.battery.fresh(),
        capacity: links.params.battery_capacity,
        motors: links.mix.fresh().map(|mix| mix.commands),
        servos: angles.map(|angles| {
            let mut pulses = angles;
            for (pulse, reel) in pulses.iter_mut().zip(reels) {
                *pulse = reel.pulse(*pulse);
            }
            pulses
        }),
        tilt: links.tilts().values().map(|tilt| tilt.unwrap_or(f32::NAN)),
        reel: angles.unwrap_or([f32::NAN; 4]),
        grip: links.grip.fresh(),
    }
}
