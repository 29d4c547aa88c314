//! MAVLink to ground stations and companion computers, over any byte stream (docs/mavlink.md).
//!
//! Runs in the background: its traffic never delays the flight level. A missed deadline delays telemetry.

use core::cell::{Cell, RefCell};
use core::future::poll_fn;
use core::pin::pin;
use core::task::Poll;

use embassy_futures::join::{join, join_array};
use embassy_futures::select::{Either, select_array};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant, Timer};
use heapless::Vec;
use sophie_control::allocation::motor_pulses::MotorPulses;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::arming::ArmingInhibit;
use sophie_control::calibration::procedure::Procedure;
use sophie_control::gripper::tendon::Reel;
use sophie_control::params::Params;
use sophie_mavlink::inputs::Inputs;
use sophie_mavlink::wire::frame::LONGEST;
pub use sophie_mavlink::wire::signing;
use sophie_mavlink::{Answers, CommanderRequests, Condition, Order, Report, Row, Server, Signing, Vehicle};
use sophie_ports::signing::Stored;

use crate::deadline::{FixedRate, Tick};
use crate::ground_station::console_pipe::ConsolePipe;
use crate::links::Links;
use crate::links::mavlink_line::LineState;
use crate::schedule::TaskId;
use crate::storage::parameters::table_id;
use crate::storage::storing::{self, NotNow};
use crate::supervision::chip_rows;
use crate::supervision::self_test::{self, SelfTest};
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

/// Bytes per read.
const CHUNK: usize = 64;
/// Most non-empty reads between two checks of the period, so that continuous input cannot delay it. Four reads empty a
/// serial line's ring buffer.
const BURST: u32 = 8;
/// Pause after a line error or an empty read, so that a dead line cannot take the processor.
const PAUSE: Duration = Duration::from_millis(1);
/// Delay of the restart with a new brown-out level: the acknowledgement is sent first.
const RESTART_DELAY: Duration = Duration::from_millis(300);

/// The serial lines that carry MAVLink.
pub struct Lines<I, O, const N: usize> {
    /// Input of each line.
    pub inputs: [I; N],
    /// Output of each line.
    pub outputs: [O; N],
    /// Send budget of each server, bytes/s: less than its line's capacity.
    pub bytes_per_second: [u32; N],
}

/// An input and its last chunk.
struct Reader<I> {
    input: I,
    bytes: [u8; CHUNK],
}

/// The server of each line, and the state common to all lines.
struct Shared<const N: usize> {
    servers: [Server; N],
    common: Common,
}

/// State common to all lines.
struct Common {
    /// Snapshot of the vehicle for outgoing messages.
    vehicle: Vehicle,
    /// Signing state, common to all lines: a frame accepted on one is refused as a replay on another.
    signing: Signing,
    /// External measurements and commands; each input has one source, on any line.
    inputs: Inputs,
    /// The calibrations, of one line at a time.
    procedure: Procedure,
}

/// State shared by receiver and sender within one task; never borrowed across an await.
struct Link<'a, const N: usize> {
    shared: RefCell<Shared<N>>,
    /// Console reached over these lines, by one at a time.
    shell: &'a ConsolePipe,
    /// Line with the latest console input.
    at_the_shell: Cell<usize>,
    /// Wakes the sender of each line.
    due: [Signal<NoopRawMutex, ()>; N],
}

impl<'a, const N: usize> Link<'a, N> {
    /// Not inlined: the temporaries of the servers' construction, twice 3 KiB each, would enlarge the stack frame of
    /// every poll.
    #[inline(never)]
    fn new(params: &Params, bytes_per_second: [u32; N], shell: &'a ConsolePipe, signing: Stored) -> Self {
        let mut numbers = 0..;
        let servers = bytes_per_second.map(|bytes_per_second| {
            let number = numbers.next().unwrap_or_default();
            Server::new(*params, bytes_per_second).numbered(number)
        });
        Self {
            shared: RefCell::new(Shared {
                servers,
                common: Common {
                    vehicle: Vehicle::default(),
                    signing: Signing::new(signing),
                    inputs: Inputs::new(params),
                    procedure: Procedure::new(),
                },
            }),
            shell,
            at_the_shell: Cell::new(0),
            due: [const { Signal::new() }; N],
        }
    }

    /// Result of `work`; never `None`, since the state is not borrowed elsewhere.
    fn with<R>(&self, work: impl FnOnce(&mut Shared<N>) -> R) -> Option<R> {
        Some(work(&mut *self.shared.try_borrow_mut().ok()?))
    }

    /// The same with the server of line `at`.
    fn with_server<R>(&self, at: usize, work: impl FnOnce(&mut Server, &mut Common) -> R) -> Option<R> {
        self.with(|shared| {
            let Shared { servers, common } = shared;
            Some(work(servers.get_mut(at)?, common))
        })
        .flatten()
    }

    /// Passes console input of line `at` to the console. Input on another line takes the console over and aborts the
    /// running command.
    fn type_in(&self, at: usize) {
        let typed = self.with_server(at, |server, _| server.shell().typed());
        let typed = typed.unwrap_or_default();
        if typed.is_empty() {
            return;
        }
        let before = self.at_the_shell.replace(at);
        if before != at {
            let end = self.with_server(before, |server, _| {
                server.shell().hang_up();
                server.shell().typed()
            });
            self.shell.type_in(&end.unwrap_or_default());
            self.shell.drop_said();
        }
        self.shell.type_in(&typed);
    }

    /// Drops console output without a reader.
    fn forget_unheard(&self) {
        let used = self.with(|shared| shared.servers.iter_mut().any(|server| server.shell().used()));
        if used == Some(false) {
            self.shell.drop_said();
        }
    }

    /// Copies the parameters of line `at` to every other line, so that all hold the same working copy.
    fn share_parameters(&self, at: usize) {
        self.with(|shared| {
            let params = *shared.servers.get(at)?.params();
            for (n, server) in shared.servers.iter_mut().enumerate() {
                if n != at {
                    server.follow(&params);
                }
            }
            Some(())
        });
    }
}

/// Serves MAVLink on `lines`, and the console `shell` over them; never returns. `signing` is the key that was stored at the
/// start.
pub async fn run<I: SerialInput, O: SerialOutput, const N: usize>(
    links: &Links,
    lines: Lines<I, O, N>,
    shell: &ConsolePipe,
    mut storage: impl Storage,
    mut chip: impl Chip,
    signing: Stored,
) -> ! {
    let link = Link::new(&links.params, lines.bytes_per_second, shell, signing);
    let mut readers = lines.inputs.map(|input| Reader {
        input,
        bytes: [0; CHUNK],
    });
    let mut numbers = 0..;
    let senders = (lines.outputs).map(|output| send(&link, numbers.next().unwrap_or_default(), output));
    let serve = async {
        let reels = Reel::all(&links.params);
        // Read once: the image's identity is computed from all of its bytes, which takes milliseconds.
        let (board, revision) = (chip.board(), chip_rows::revision(&chip));
        let build = [chip.build(), table_id()];
        let mut self_tests = [None; N];
        let mut rate = FixedRate::of(links, TaskId::Mavlink);
        loop {
            let started = listen(links, &mut rate, &mut readers, &link).await.started;
            let now = started.as_micros();
            let seen = Vehicle {
                board,
                chip: revision,
                build,
                ..picture(links, &reels)
            };
            link.with(|shared| {
                let Common {
                    vehicle,
                    signing,
                    inputs,
                    ..
                } = &mut shared.common;
                *vehicle = seen;
                links
                    .mavlink
                    .send(started, LineState::of(signing, inputs.counts()));
            });
            for at in 0..N {
                let order = link.with_server(at, |server, common| {
                    let Common {
                        vehicle, procedure, ..
                    } = common;
                    // Read again for each line: the line before may have sent an order.
                    vehicle.answers = answers(links);
                    give(links, started, server.requests(now, vehicle));
                    server.order(now, vehicle, &links.params, procedure)
                });
                // A calibration may have set parameters.
                link.share_parameters(at);
                // Detects a ground station that has disconnected.
                link.type_in(at);
                match order.flatten() {
                    Some(Order::Row(report, number)) => {
                        let test = self_tests.get_mut(at);
                        if let Some((row, rows)) =
                            test.and_then(|test| row(links, &chip, test, report, number))
                        {
                            link.with_server(at, |server, _| server.row(row, rows));
                        }
                    }
                    order => obey(links, &link, at, &mut storage, &mut chip, order).await,
                }
            }
            link.forget_unheard();
            for due in &link.due {
                due.signal(());
            }
            renew(links, &link, &mut storage, now).await;
        }
    };
    join(serve, join_array(senders)).await.0
}

/// Executes the pending orders of the server of line `at`.
async fn obey<const N: usize>(
    links: &Links,
    link: &Link<'_, N>,
    at: usize,
    storage: &mut impl Storage,
    chip: &mut impl Chip,
    order: Option<Order>,
) {
    match order {
        Some(Order::Store) => {
            let Some(params) = link.with_server(at, |server, _| *server.params()) else {
                return;
            };
            let stored = store(links, storage, &params).await;
            link.with_server(at, |server, _| server.stored(stored));
        }
        Some(Order::Restart) if storing::inhibit_arming(links).await.is_ok() => chip.restart(),
        Some(Order::SetBrownOut) => {
            let set = set_brown_out(links, chip).await;
            link.with_server(at, |server, _| server.brown_out_done(set));
            if set.is_ok() {
                if let Some(due) = link.due.get(at) {
                    due.signal(());
                }
                Timer::after(RESTART_DELAY).await;
                chip.restart();
            }
        }
        Some(Order::Restart | Order::Row(..)) | None => (),
    }
}

/// Sets the chip's brown-out level. Arming is refused meanwhile, since the write may stall the processor, and after a
/// success until the restart.
async fn set_brown_out(links: &Links, chip: &mut impl Chip) -> Result<(), &'static str> {
    let mut checks = chip.checks().iter();
    let level = checks.find(|check| check.inhibits == Some(ArmingInhibit::BrownOutLevel));
    if level.is_none_or(|level| level.ok) {
        return Err("nothing to do");
    }
    storing::inhibit_arming(links).await.map_err(not_now)?;
    if chip.set_brown_out().await.is_err() {
        links.report(ArmingInhibit::Storing, false);
        return Err("the chip's option bytes did not take it");
    }
    Ok(())
}

/// Row `number` of `report`, and the number of its rows; the row is `None` behind the last, all is while the self-test
/// counts.
fn row(
    links: &Links,
    chip: &impl Chip,
    test: &mut Option<SelfTest>,
    report: Report,
    number: u8,
) -> Option<(Option<Row>, u8)> {
    match report {
        Report::Chip => {
            let check = chip_rows::check(chip, number);
            Some((check.as_ref().map(chip_rows::row), chip_rows::rows(chip)))
        }
        Report::SelfTest => {
            let running = test.get_or_insert_with(|| SelfTest::begin(links));
            if !running.is_ready(links) {
                return None;
            }
            let row = running.row(links, number);
            if row.is_none() {
                *test = None;
            }
            Some((row, self_test::ROWS))
        }
    }
}

/// Sends on line `at` at the line's own pace: a frame is built when there is room for it, from the newest data.
/// Waiting for the line is excluded from the task's measured run.
async fn send<const N: usize>(link: &Link<'_, N>, at: usize, mut output: impl SerialOutput) {
    let mut frame = Vec::<u8, LONGEST>::new();
    while let Some(due) = link.due.get(at) {
        due.wait().await;
        // No frames are built for a line without a listener.
        while output.listens() {
            let now = Instant::now().as_micros();
            frame.clear();
            let copied = link.with_server(at, |server, common| {
                let Common {
                    vehicle,
                    signing,
                    inputs,
                    ..
                } = common;
                if server.shell().takes() {
                    server.shell().say(&link.shell.said());
                }
                let bytes = server.send(now, vehicle, signing, inputs).unwrap_or_default();
                frame.extend_from_slice(bytes)
            });
            if !matches!(copied, Some(Ok(()))) || frame.is_empty() {
                break;
            }
            // A frame refused by the line is lost; the next one follows.
            let _ = output.write(&frame).await;
        }
    }
}

/// Passes received bytes to the servers until the next run is due.
async fn listen<I: SerialInput, const N: usize>(
    links: &Links,
    rate: &mut FixedRate<'_>,
    readers: &mut [Reader<I>; N],
    link: &Link<'_, N>,
) -> Tick {
    let mut next = pin!(rate.next());
    let mut taken = 0;
    loop {
        let event = {
            let reads = readers
                .each_mut()
                .map(|Reader { input, bytes }| input.read(bytes));
            let mut reads = pin!(select_array(reads));
            poll_fn(|cx| {
                // Polling the period makes embassy search its timers with interrupts masked: once per batch of input.
                if taken >= BURST
                    && let Poll::Ready(tick) = next.as_mut().poll(cx)
                {
                    return Poll::Ready(Either::First(tick));
                }
                match reads.as_mut().poll(cx) {
                    Poll::Ready(read) => Poll::Ready(Either::Second(read)),
                    Poll::Pending => next.as_mut().poll(cx).map(Either::First),
                }
            })
            .await
        };
        match event {
            Either::First(tick) => return tick,
            Either::Second((Ok(count), at)) if count > 0 => {
                taken = if taken >= BURST { 0 } else { taken + 1 };
                let arrived = readers.get(at).and_then(|reader| reader.bytes.get(..count));
                let now = Instant::now().as_micros();
                link.with_server(at, |server, common| {
                    let Common {
                        vehicle,
                        signing,
                        inputs,
                        procedure,
                    } = common;
                    server.receive(
                        arrived.unwrap_or_default(),
                        now,
                        vehicle,
                        signing,
                        inputs,
                        procedure,
                    );
                    publish(links, inputs, now);
                });
                link.type_in(at);
                link.share_parameters(at);
                // A line with continuous input must not starve the other tasks of this level.
                embassy_futures::yield_now().await;
            }
            Either::Second(_) => Timer::after(PAUSE).await,
        }
    }
}

/// Publishes external measurements and commands, stamped with their measurement time.
fn publish(links: &Links, inputs: &mut Inputs, now: u64) {
    if let Some(pose) = inputs.take_pose() {
        links
            .external_pose
            .send(Instant::from_micros(pose.measured_at), pose);
    }
    if let Some(target) = inputs.take_target() {
        links.pipe_target.send(Instant::from_micros(target.at_us), target);
    }
    if let Some(view) = inputs.take_ground() {
        links.ground.send(Instant::from_micros(now), view);
    }
}

/// Stores a new bound of the signing timestamps before the present one is reached; arming is refused meanwhile.
async fn renew<const N: usize>(links: &Links, link: &Link<'_, N>, storage: &mut impl Storage, now: u64) {
    // Another line is storing, or its saved data await a restart: do nothing.
    if storing::stopped(links).is_err() || links.hardware().contains(ArmingInhibit::Storing) {
        return;
    }
    let Some(record) = link.with(|shared| shared.common.signing.to_store(now)).flatten() else {
        return;
    };
    if storing::inhibit_arming(links).await.is_err() {
        return;
    }
    let stored = storing::save_signing(links, storage, Some(record)).await;
    links.report(ArmingInhibit::Storing, false);
    if stored.is_ok() {
        link.with(|shared| shared.common.signing.keep(record));
    }
}

/// Sends `requests` to the commander.
fn give(links: &Links, at: Instant, requests: CommanderRequests) {
    if let Some(request) = requests.remote {
        links.remote.send(at, request);
    }
    if let Some(request) = requests.actuator_test {
        links.actuator_test.send(at, request);
    }
}

/// Stores the server's parameters. Arming is refused meanwhile, and afterwards while they differ from those in force:
/// the vehicle must fly with the values that a ground station reads.
async fn store(links: &Links, storage: &mut impl Storage, params: &Params) -> Result<(), &'static str> {
    storing::inhibit_arming(links).await.map_err(not_now)?;
    storing::save(links, storage, params)
        .await
        .map_err(|error| error.text())?;
    links.report(ArmingInhibit::Stored, storing::differ(links, params));
    links.report(ArmingInhibit::Storing, false);
    Ok(())
}

const fn not_now(why: NotNow) -> &'static str {
    match why {
        NotNow::While(_) => "disarm first",
        NotNow::Silent => "the commander is silent",
        NotNow::Storing => "another line stores",
    }
}

/// Snapshot of the links; a stale message is treated as missing.
fn picture(links: &Links, reels: &PerArm<Reel>) -> Vehicle {
    let angles = links.reel_angle.fresh();
    let pulses = MotorPulses::shown(&links.params);
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
        servo_battery: links.servo_battery.fresh(),
        motors: links
            .mix
            .fresh()
            .filter(|_| pulses.is_some())
            .map(|mix| mix.commands),
        motor_pulses: pulses.unwrap_or(MotorPulses::DIGITAL),
        servos: angles.map(|angles| {
            let mut pulses = angles;
            for (servo, (pulse, reel)) in pulses.iter_mut().zip(reels).enumerate() {
                let marked = links.params.servo_marks.has(servo);
                *pulse = if marked { reel.pulse(*pulse) } else { 0.0 };
            }
            pulses
        }),
        tilt: links.tilts().values().map(|tilt| tilt.unwrap_or(f32::NAN)),
        reel: angles.unwrap_or([f32::NAN; 4]),
        grip: links.grip.fresh(),
        readings: links.readings(),
        air: links.air_pressure.fresh(),
        vibration: links.vibration.fresh(),
        load: load(links),
        answers: answers(links),
        ..Vehicle::default()
    }
}

/// Replies to the latest orders, of any line.
fn answers(links: &Links) -> Answers {
    Answers {
        actuator_test: links.actuator_test_view(),
        newest: links.remote.look(|m| m.value.number).unwrap_or(0),
        renewed: links.remote.fresh().is_some(),
        remote: links.remote_answer.fresh().unwrap_or_default(),
    }
}

/// Longest time from data-ready to the motor frame since the start, thousandths of its period.
fn load(links: &Links) -> u16 {
    let period = TaskId::Motors.period().as_micros().max(1);
    let worst = u64::from(links.timing.worst_response(TaskId::Motors));
    u16::try_from(worst * 1000 / period).unwrap_or(u16::MAX)
}
