//! MAVLink to ground stations and companion computers, over any byte stream (docs/mavlink.md).
//!
//! Background: whatever arrives, or stays away, delays nothing that flies. A miss costs a late picture.

use core::cell::RefCell;
use core::pin::pin;

use embassy_futures::join::join;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant, Timer};
use heapless::Vec;
use sophie_control::arming::ArmingInhibit;
use sophie_control::calibration::AccelFit;
use sophie_control::params::Params;
use sophie_control::tendon::Reel;
use sophie_control::wrench::PerArm;
use sophie_mavlink::inputs::Inputs;
use sophie_mavlink::parser::LONGEST;
pub use sophie_mavlink::signing;
use sophie_mavlink::signing::Stored;
use sophie_mavlink::{Answers, Condition, Order, Requests, Server, Signing, Vehicle};

use crate::deadline::{FixedRate, TaskId, Tick};
use crate::links::{LineState, Links};
use crate::ports::{SerialInput, SerialOutput, Storage};
use crate::shell::Shell;
use crate::storing::{self, NotNow};

/// Bytes taken at once.
const CHUNK: usize = 64;
/// Pause after a line error or an empty read, so that a dead line cannot take the processor.
const PAUSE: Duration = Duration::from_millis(1);

/// What is known of the line under a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// What the server may send, bytes each second: less than the line carries.
    pub bytes_per_second: u32,
    /// The key that was stored at the start.
    pub signing: Stored,
}

/// The server of a line, the picture that it speaks of, and the key.
struct Shared {
    server: Server,
    vehicle: Vehicle,
    signing: Signing,
}

/// What takes and what sends share, in one task and never over an await.
struct Link<'a> {
    shared: RefCell<Shared>,
    /// The console that is reached over this line.
    shell: &'a Shell,
    /// There may be something to send.
    due: Signal<NoopRawMutex, ()>,
}

impl Link<'_> {
    /// What `work` gives; `None` never comes, since no one else has it then.
    fn with<R>(&self, work: impl FnOnce(&mut Shared) -> R) -> Option<R> {
        Some(work(&mut *self.shared.try_borrow_mut().ok()?))
    }
}

/// Serves MAVLink on one line, and a console over it; never returns. `restart` restarts the board.
pub async fn run(
    links: &Links,
    mut input: impl SerialInput,
    output: impl SerialOutput,
    shell: &Shell,
    mut storage: impl Storage,
    mut restart: impl FnMut(),
    line: Line,
) -> ! {
    let link = Link {
        shared: RefCell::new(Shared {
            server: Server::new(links.params, line.bytes_per_second),
            vehicle: Vehicle::default(),
            signing: Signing::new(line.signing),
        }),
        shell,
        due: Signal::new(),
    };
    let serve = async {
        let reels = Reel::all(&links.params);
        let mut rate = FixedRate::of(links, TaskId::Mavlink);
        loop {
            let started = listen(links, &mut rate, &mut input, &link).await.started;
            let now = started.as_micros();
            let seen = picture(links, &reels);
            let order = link.with(|shared| {
                shared.vehicle = seen;
                links.mavlink.send(
                    started,
                    LineState::of(&shared.signing, shared.server.inputs().counts()),
                );
                give(links, started, shared.server.requests(now, &shared.vehicle));
                let order = shared.server.order(now, &shared.vehicle);
                // A station that has gone is noticed here.
                link.shell.type_in(&shared.server.shell().typed());
                if !shared.server.shell().used() {
                    link.shell.drop_said();
                }
                order
            });
            link.due.signal(());
            renew(links, &link, &mut storage, now).await;
            match order.flatten() {
                Some(Order::Store) => {
                    let Some(params) = link.with(|shared| *shared.server.params()) else {
                        continue;
                    };
                    let stored = store(links, &mut storage, &params).await;
                    link.with(|shared| shared.server.stored(stored));
                }
                Some(Order::Restart) if storing::hold_arming(links).await.is_ok() => restart(),
                Some(Order::Restart) | None => (),
            }
        }
    };
    join(serve, send(&link, output)).await.1
}

/// Sends as fast as the line takes it: a frame is made when there is room for it, of what is known then. The wait for
/// the line is no part of the task's run.
async fn send(link: &Link<'_>, mut output: impl SerialOutput) -> ! {
    let mut frame = Vec::<u8, LONGEST>::new();
    loop {
        link.due.wait().await;
        loop {
            let now = Instant::now().as_micros();
            frame.clear();
            let copied = link.with(|shared| {
                let Shared {
                    server,
                    vehicle,
                    signing,
                } = shared;
                if server.shell().takes() {
                    server.shell().say(&link.shell.said());
                }
                let bytes = server.send(now, vehicle, signing).unwrap_or_default();
                frame.extend_from_slice(bytes)
            });
            if !matches!(copied, Some(Ok(()))) || frame.is_empty() {
                break;
            }
            // A frame that the line does not take is lost; the next one follows.
            let _ = output.write(&frame).await;
        }
    }
}

/// Hands what arrives to the server until the next run is due.
async fn listen(
    links: &Links,
    rate: &mut FixedRate<'_>,
    input: &mut impl SerialInput,
    link: &Link<'_>,
) -> Tick {
    let mut bytes = [0; CHUNK];
    let mut next = pin!(rate.next());
    loop {
        match select(next.as_mut(), input.read(&mut bytes)).await {
            Either::First(tick) => return tick,
            Either::Second(Ok(count)) if count > 0 => {
                let arrived = bytes.get(..count).unwrap_or_default();
                let now = Instant::now().as_micros();
                link.with(|shared| {
                    let Shared {
                        server,
                        vehicle,
                        signing,
                    } = shared;
                    server.receive(arrived, now, vehicle, signing);
                    publish(links, server.inputs(), now);
                    link.shell.type_in(&server.shell().typed());
                });
                // A line that is never silent must not starve the others of this level.
                embassy_futures::yield_now().await;
            }
            Either::Second(_) => Timer::after(PAUSE).await,
        }
    }
}

/// Publishes what others have measured and wished, at the time of its measurement.
fn publish(links: &Links, inputs: &mut Inputs, now: u64) {
    if let Some(pose) = inputs.take_pose() {
        links
            .external_pose
            .send(Instant::from_micros(pose.measured_at), pose);
    }
    if let Some(attitude) = inputs.take_attitude() {
        links.offboard.send(Instant::from_micros(now), attitude);
    }
}

/// Stores the bound of signing's times again where little is left of it; arming is refused meanwhile.
async fn renew(links: &Links, link: &Link<'_>, storage: &mut impl Storage, now: u64) {
    // Another is storing, or what it has stored waits for a restart: nothing comes after that.
    if storing::stopped(links).is_err() || links.hardware().contains(ArmingInhibit::Storing) {
        return;
    }
    let Some(record) = link.with(|shared| shared.signing.to_store(now)).flatten() else {
        return;
    };
    if storing::hold_arming(links).await.is_err() {
        return;
    }
    let stored = storing::save_signing(links, storage, Some(record)).await;
    links.report(ArmingInhibit::Storing, false);
    if stored.is_ok() {
        link.with(|shared| shared.signing.keep(record));
    }
}

/// Sends what the commander is to do.
fn give(links: &Links, at: Instant, requests: Requests) {
    if let Some(request) = requests.remote {
        links.remote.send(at, request);
    }
    if let Some(request) = requests.bench {
        links.bench.send(at, request);
    }
}

/// Stores the server's parameters. Arming is refused meanwhile, and from then on as long as others are in force: what
/// flies must be what a ground station reads.
async fn store(links: &Links, storage: &mut impl Storage, params: &Params) -> Result<(), &'static str> {
    storing::hold_arming(links).await.map_err(|why| match why {
        NotNow::While(_) => "disarm first",
        NotNow::Silent => "the commander is silent",
        NotNow::Storing => "another line stores",
    })?;
    storing::save(links, storage, params)
        .await
        .map_err(|error| error.text())?;
    links.report(ArmingInhibit::Stored, storing::differ(links, params));
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
        accel_fit: AccelFit::of(&links.params),
        load: load(links),
        answers: Answers {
            bench: links.bench_view(),
            newest: links.remote.look(|m| m.value.number).unwrap_or(0),
            remote: links.remote_answer.fresh().unwrap_or_default(),
        },
    }
}

/// Longest time from data-ready to the motor frame since the start, thousandths of its period.
fn load(links: &Links) -> u16 {
    let period = TaskId::Motors.period().as_micros().max(1);
    let worst = u64::from(links.worst_response(TaskId::Motors));
    u16::try_from(worst * 1000 / period).unwrap_or(u16::MAX)
}
