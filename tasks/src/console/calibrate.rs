//! Guided calibration: instruction, key when done, measured values, resulting parameter changes.
//!
//! Results go into the working copy, as `set` does; `save` stores them.

use core::fmt;

use embassy_time::{Duration, Timer};
use sophie_control::allocation::motor_pulses::{MotorPulses, by_pulses};
use sophie_control::attitude::mounting::{Direction, Mounting};
use sophie_control::calibration::flow::{FlowFit, FlowTurns, Round, flow_fit};
use sophie_control::calibration::{self, AccelFit, BIAS, Face, FsrFit, SCALES, Samples, Unfit, thousandths};
use sophie_control::gripper::tendon::{Reel, SPAN_MIN_US};
use sophie_control::maths::scalar::{clamp, to_deg};
use sophie_control::maths::vector::Vec3;
use sophie_control::params::Params;
use sophie_control::pilot::bench_orders::{BenchOrder, Place, SPIN_DRIVE, SPIN_DRIVE_MAX, Spin};

use super::Console;
use super::bench::End;
use crate::links::Links;
use sophie_control::maths::decimal::{self, Decimal};
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

/// Samples of one rest, and the time between two: 2 s, in which a breath of wind is over.
const SAMPLES: u16 = 200;
const SAMPLING: Duration = Duration::from_millis(10);
/// Samples of one rotation measurement, 8 s, and between two progress lines.
const TURNS: u16 = 800;
const TURNS_SHOWN: u16 = 200;
/// Step of a servo under the keys, µs: 1.4 degrees; and of a motor's pulse.
const STEP_US: f32 = 10.0;
/// First pulse of a motor above its stop, µs: less than any dead zone, and the bench's least drive of every range.
const FIRST_US: f32 = 30.0;
/// Initial pulse of a servo without calibrated marks, µs: mid-travel of every servo, far from its end stops.
const MIDDLE_US: f32 = 1500.0;

/// Calibrations and their benefit.
const WHAT: [(&str, &str); 10] = [
    (
        "gyro",
        "what it reads at rest; taken anew at each start, nothing to store",
    ),
    (
        "level",
        "accelerometer's bias on a level table; a lean of the table goes in with it",
    ),
    ("accel", "bias and scale by six sides; needs no level table"),
    ("mounting", "how the inertial sensor sits, by tilting"),
    ("battery", "its voltage by a meter: calibrate battery VOLTS"),
    ("servo", "release and full mark of one servo: calibrate servo N"),
    (
        "fsr",
        "zero and gain of one pressure sensor by a weight: calibrate fsr N NEWTON",
    ),
    ("arm", "zero and sign of one arm's tilt sensor: calibrate arm N"),
    (
        "flow",
        "scale and mounting of the flow module, by turning it over a floor",
    ),
    (
        "esc",
        "whether controllers take the protocol; esc idle: pulse that turns all",
    ),
];

const RELEASE: [&str; 4] = [
    "servo_release_1",
    "servo_release_2",
    "servo_release_3",
    "servo_release_4",
];
const TRIM: [&str; 4] = ["servo_trim_1", "servo_trim_2", "servo_trim_3", "servo_trim_4"];
const FULL: [&str; 4] = ["servo_full_1", "servo_full_2", "servo_full_3", "servo_full_4"];

/// Conductance and zero of each pressure sensor, sign and zero of each arm's.
const FSR: [[&str; 2]; 4] = [
    ["fsr_trim_1", "fsr_zero_1"],
    ["fsr_trim_2", "fsr_zero_2"],
    ["fsr_trim_3", "fsr_zero_3"],
    ["fsr_trim_4", "fsr_zero_4"],
];
const ARM: [[&str; 2]; 4] = [
    ["arm_sign_1", "arm_zero_1"],
    ["arm_sign_2", "arm_zero_2"],
    ["arm_sign_3", "arm_zero_3"],
    ["arm_sign_4", "arm_zero_4"],
];

/// Reads one sample of the calibrated sensor; `None` if stale.
type Read<'a> = &'a dyn Fn(&Links) -> Option<Vec3>;

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    pub(super) async fn calibrate(&mut self, what: &str, arguments: [Option<&str>; 2]) {
        if let Err(why) = self.stopped() {
            return self.refuse("not calibrated", why).await;
        }
        match (what, arguments) {
            ("gyro", [None, _]) => self.calibrate_gyro().await,
            ("level", [None, _]) => self.calibrate_level().await,
            ("accel", [None, _]) => self.calibrate_accel().await,
            ("mounting", [None, _]) => self.calibrate_mounting().await,
            ("battery", [Some(volts), None]) => self.calibrate_battery(volts).await,
            ("servo", [Some(number), None]) => self.calibrate_servo(number).await,
            ("flow", [None, _]) => self.calibrate_flow().await,
            ("esc", [None, _]) => self.calibrate_esc().await,
            ("esc", [Some("idle"), None]) => self.calibrate_esc_idle().await,
            ("fsr", [Some(number), Some(newton)]) => self.calibrate_fsr(number, newton).await,
            ("arm", [Some(number), None]) => self.calibrate_arm(number).await,
            _ => {
                for (name, text) in WHAT {
                    self.out.line(format_args!("calibrate {name:8} {text}")).await;
                }
            }
        }
    }

    async fn calibrate_gyro(&mut self) {
        let rate: Read<'_> = &|links| links.attitude.fresh().map(|a| a.rate + a.gyro_bias);
        let Some(samples) = self.rest("Leave the vehicle at rest.", rate).await else {
            return;
        };
        match calibration::rest_rate(&samples) {
            Ok(mean) => {
                let [x, y, z] = mean.to_array().map(|rate| Decimal(to_deg(rate)));
                let noise = Decimal(to_deg(samples.spread()));
                self.out
                    .line(format_args!(
                        "at rest {x:.2} {y:.2} {z:.2} deg/s, noise {noise:.2}; nothing to store"
                    ))
                    .await;
            }
            Err(unfit) => self.unfit(unfit).await,
        }
    }

    async fn calibrate_level(&mut self) {
        let text = "Put the vehicle on a level table, by a spirit level on its body.";
        let Some(samples) = self.rest(text, &force).await else {
            return;
        };
        match calibration::level(&samples, &AccelFit::of(&self.links.params)) {
            Ok(bias) => self.put_all(&BIAS, bias.to_array()).await,
            Err(unfit) => self.unfit(unfit).await,
        }
    }

    async fn calibrate_accel(&mut self) {
        let mut means = [Vec3::ZERO; 6];
        for (mean, side) in means.iter_mut().zip(Face::ALL) {
            loop {
                let Some(samples) = self.rest(side.text(), &force).await else {
                    return;
                };
                match calibration::face(&samples, side) {
                    Ok(found) => {
                        *mean = found;
                        break;
                    }
                    Err(unfit) => self.unfit(unfit).await,
                }
            }
        }
        match calibration::six_faces(&means, &AccelFit::of(&self.links.params)) {
            Ok(found) => {
                let [x, y, z] = found.scale.to_array().map(Decimal);
                self.out.line(format_args!("scale {x:.3} {y:.3} {z:.3}")).await;
                self.put_all(&BIAS, found.bias.to_array()).await;
                self.put_all(&SCALES, found.scale.to_array()).await;
            }
            Err(unfit) => self.unfit(unfit).await,
        }
    }

    async fn calibrate_mounting(&mut self) {
        let mut below = [Direction::Down; 3];
        for (found, side) in below.iter_mut().zip([Face::Belly, Face::Nose, Face::Right]) {
            let Some(samples) = self.rest(side.text(), &force).await else {
                return;
            };
            match calibration::below(&samples) {
                Ok(direction) => *found = direction,
                Err(unfit) => return self.unfit(unfit).await,
            }
        }
        let [belly, nose, right] = below;
        let found = Mounting { nose, right, belly };
        let now = Mounting::from(self.links.params.imu_mounting);
        let Some(value) = found.after(&now).and_then(|both| both.parameter()) else {
            return self
                .out
                .line(format_args!("not taken: these are no three sides of one vehicle"))
                .await;
        };
        if found == Mounting::AS_BUILT {
            self.out
                .line(format_args!("mounted as the firmware has it"))
                .await;
        } else {
            let [belly, nose, right] = below.map(Direction::name);
            self.out
                .line(format_args!(
                    "nose is where the firmware has {nose}, right side {right}, belly {belly}"
                ))
                .await;
        }
        self.put_all(&["imu_mounting"], [value.number()]).await;
    }

    async fn calibrate_battery(&mut self, volts: &str) {
        let Some(meter) = decimal::parse(volts) else {
            return self
                .out
                .line(format_args!("'{volts}' is not a number of volts"))
                .await;
        };
        let battery: Read<'_> = &|links| links.battery.fresh().map(|b| Vec3::new(b.voltage, 0.0, 0.0));
        let text = "Leave the battery connected as it was measured.";
        let Some(samples) = self.rest(text, battery).await else {
            return;
        };
        match calibration::divider(&samples, self.links.params.battery_divider, meter) {
            Ok(divider) => self.put_all(&["battery_divider"], [divider]).await,
            Err(unfit) => self.unfit(unfit).await,
        }
    }

    async fn calibrate_fsr(&mut self, number: &str, newton: &str) {
        let Some(arm) = self.one_of_four("pressure sensor", number).await else {
            return;
        };
        let Some(weight) = decimal::parse(newton) else {
            return self
                .out
                .line(format_args!("'{newton}' is not a number of newtons"))
                .await;
        };
        let Some([trim, zero]) = FSR.get(arm) else {
            return;
        };
        let pressure: Read<'_> = &|links| {
            let contact = links.contact.fresh()?;
            let pressure = contact.arms.get(arm).copied()?.ok()?;
            Some(Vec3::new(pressure, 0.0, 0.0))
        };
        let Some(empty) = self.rest("Nothing may touch the sensor.", pressure).await else {
            return;
        };
        let Some(loaded) = self.rest("Put the weight on its pad, all of it.", pressure).await else {
            return;
        };
        let now = FsrFit {
            trim: self.in_force(trim),
            zero: self.in_force(zero),
        };
        let area = self.links.params.fsr_area;
        match calibration::pressure_sensor(&empty, &loaded, weight / area, now) {
            Ok(fit) => self.put_all(&[*trim, *zero], [fit.trim, fit.zero]).await,
            Err(unfit) => self.unfit(unfit).await,
        }
    }

    async fn calibrate_arm(&mut self, number: &str) {
        let Some(arm) = self.one_of_four("arm", number).await else {
            return;
        };
        let (Some([sign, zero]), Some(now)) = (
            ARM.get(arm),
            Some(calibration::ArmFit::of(&self.links.params, arm)),
        ) else {
            return;
        };
        let tilt: Read<'_> = &|links| {
            let tilt = links.tilts().values().get(arm).copied()?;
            tilt.map(|tilt| Vec3::new(tilt, 0.0, 0.0))
        };
        let Some(straight) = self
            .rest("Hold the arm straight, by a ruler along it.", tilt)
            .await
        else {
            return;
        };
        let Some(up) = self
            .rest("Bend its tip up by a hand's breadth, and hold.", tilt)
            .await
        else {
            return;
        };
        match calibration::arm_sensor(&straight, &up, now) {
            Ok(fit) => self.put_all(&[*sign, *zero], [fit.sign, fit.zero]).await,
            Err(unfit) => self.unfit(unfit).await,
        }
    }

    /// Calibrates the flow module by rotating it near a floor and far from it.
    async fn calibrate_flow(&mut self) {
        let near = "Hold it 0.5 m over a floor with a pattern. From Enter on, for 8 s: roll it to both sides, then pitch it.";
        let far = "Now 1.5 m over it, and the same again.";
        let Some(near) = self.turned(near, false).await else {
            return;
        };
        let Some(far) = self.turned(far, true).await else {
            return;
        };
        let p = &self.links.params;
        let now = FlowFit {
            scale: p.flow_scale,
            mounting: p.flow_mounting,
        };
        match flow_fit(&near, &far, now) {
            Ok((fit, pivot)) => {
                let pivot = Decimal(pivot * 100.0);
                self.out
                    .line(format_args!("turned about a point {pivot:.0} cm over the lens"))
                    .await;
                let values = [fit.scale, fit.mounting.number()];
                self.put_all(&["flow_scale", "flow_mounting"], values).await;
            }
            Err(unfit) => self.unfit(unfit).await,
        }
    }

    /// Measures one rotation; `None` if aborted or unusable.
    async fn turned(&mut self, text: &str, far: bool) -> Option<Round> {
        if !self.confirmed(text).await {
            return None;
        }
        let mut turns = FlowTurns::default();
        for left in (0..TURNS).rev() {
            Timer::after(SAMPLING).await;
            if left > 0 && left.is_multiple_of(TURNS_SHOWN) {
                let seconds = left / 100;
                self.out.line(format_args!("{seconds} s more")).await;
            }
            let attitude = self.links.attitude.look(|m| (m.at, m.value.q));
            let view = self.links.ground.fresh().unwrap_or_default();
            if let Some((at, q)) = attitude {
                turns.add(at.as_micros(), q, &view);
            }
            if self.keys.pressed() {
                self.out.line(format_args!("ended: nothing is changed")).await;
                return None;
            }
        }
        match turns.round(far) {
            Ok(round) => Some(round),
            Err(unfit) => {
                self.unfit(unfit).await;
                None
            }
        }
    }

    /// Prints the instruction; true if Enter confirms it.
    async fn confirmed(&mut self, text: &str) -> bool {
        self.out.line(format_args!("{text}")).await;
        let key = self.ask("Enter when it is so, any other key ends: ").await;
        let done = matches!(key, Some(b'\r' | b'\n'));
        if !done {
            self.out.line(format_args!("ended: nothing is changed")).await;
        }
        done
    }

    fn in_force(&self, name: &str) -> f32 {
        self.links.params.get(name).unwrap_or_default()
    }

    async fn calibrate_servo(&mut self, number: &str) {
        let Some(servo) = self.one_of_four("servo", number).await else {
            return;
        };
        let Some((release, full)) = RELEASE.get(servo).zip(FULL.get(servo)) else {
            return;
        };
        let trim = TRIM
            .get(servo)
            .and_then(|name| self.links.params.get(name))
            .unwrap_or_default();
        let Some(row) = Params::row(release) else {
            return;
        };
        let allowed = [row.min + trim, row.max + trim];
        let reel = Reel::from_params(&self.links.params, servo);
        let marked = self.links.params.servo_marks.has(servo);
        let mut marks = if marked {
            [reel.pulse(0.0), reel.pulse(self.links.params.servo_range)]
        } else {
            [MIDDLE_US; 2]
        };
        let mut from = None;
        for (mark, name) in marks.iter_mut().zip(["release", "full"]) {
            if !marked {
                // Starts at the pulse accepted last.
                *mark = from.unwrap_or(*mark);
            }
            self.out
                .line(format_args!(
                    "{name} mark: + and - move the servo, Enter takes it, any other key ends"
                ))
                .await;
            match self.move_servo(servo, *mark, allowed).await {
                Some(pulse) => {
                    *mark = pulse;
                    from = Some(pulse);
                }
                None => return self.out.line(format_args!("ended: nothing is changed")).await,
            }
        }
        let [at_release, at_full] = marks.map(|mark| mark - trim);
        let travel = (at_full - at_release).abs();
        if travel < SPAN_MIN_US {
            let [travel, least] = [travel, SPAN_MIN_US].map(Decimal);
            return self
                .out
                .line(format_args!(
                    "not taken: travel is {travel:.0} us; {least:.0} at least"
                ))
                .await;
        }
        let marks = self.params.servo_marks.with(servo).number();
        self.put_all(&[*release, *full, "servo_marks"], [at_release, at_full, marks])
            .await;
    }

    /// Moves `servo` from `pulse_us` by keys; returns the pulse that the builder accepts, µs.
    async fn move_servo(&mut self, servo: usize, mut pulse_us: f32, allowed: [f32; 2]) -> Option<f32> {
        let [least, most] = allowed;
        loop {
            let shown = Decimal(pulse_us);
            let order = BenchOrder::Place(Place { servo, pulse_us });
            let key = match self.order_until_key(order, format_args!("{shown:.0} us")).await {
                Ok(key) => key,
                Err(end) => {
                    self.say_end(format_args!("servo {}", self.goes(servo)), end)
                        .await;
                    return None;
                }
            };
            let step = match key {
                b'+' => STEP_US,
                b'-' => -STEP_US,
                b'\r' | b'\n' => return Some(pulse_us),
                _ => return None,
            };
            pulse_us = clamp(pulse_us + step, least, most);
        }
    }

    /// Tests each speed controller in turn; the builder confirms that the motor responds to the protocol.
    async fn calibrate_esc(&mut self) {
        let name = self.motor_protocol();
        let pulses = by_pulses(&self.links.params);
        if pulses {
            self.out
                .line(format_args!(
                    "it teaches no ends: BLHeli, AM32, Afro by their makers' procedure, DJI never"
                ))
                .await;
        }
        for rotor in 0..4 {
            let number = rotor + 1;
            let begun = format_args!("motor {number} by {name}");
            match self.turns(Spin::at(rotor, SPIN_DRIVE), begun).await {
                Some(true) => (),
                Some(false) => {
                    self.out
                        .line(format_args!(
                            "controller {number} does not take {name}, or has no power"
                        ))
                        .await;
                    let next = if pulses {
                        "or turns later: 'calibrate esc idle'; motor_pulse_min and _max are its ends"
                    } else {
                        "another: 'set motor_protocol pwm', 'save', and again"
                    };
                    return self.out.line(format_args!("{next}")).await;
                }
                None => return,
            }
        }
        self.out
            .line(format_args!("all four controllers take {name}; nothing to store"))
            .await;
    }

    /// Raises each motor's pulse until the builder sees it turn. Friction is largest at rest, so that pulse also keeps
    /// the motor turning. The largest of the four pulses is used.
    async fn calibrate_esc_idle(&mut self) {
        if !by_pulses(&self.links.params) {
            let name = self.motor_protocol();
            return self
                .out
                .line(format_args!("{name} has no idle pulse; nothing to store"))
                .await;
        }
        // With invalid pulse parameters the commander refuses the first order.
        let pulses = MotorPulses::from_params(&self.links.params).unwrap_or(MotorPulses::DIGITAL);
        let mut pulse_us = pulses.pulse_us(0.0) + FIRST_US;
        for rotor in 0..4 {
            let number = rotor + 1;
            loop {
                let (drive, shown) = (pulses.command(pulse_us), Decimal(pulse_us));
                if drive > SPIN_DRIVE_MAX {
                    return self
                        .out
                        .line(format_args!(
                            "not taken: motor {number} does not turn: power? motor_pulse_min, motor_pulse_max?"
                        ))
                        .await;
                }
                let spin = Spin {
                    probes: true,
                    ..Spin::at(rotor, drive)
                };
                match self
                    .turns(spin, format_args!("motor {number} at {shown:.0} us"))
                    .await
                {
                    Some(true) => break,
                    Some(false) => pulse_us += STEP_US,
                    None => return,
                }
            }
        }
        self.put_all(&["motor_pulse_idle"], [pulse_us]).await;
    }

    /// Name of the protocol in force.
    fn motor_protocol(&self) -> &'static str {
        let value = self.in_force("motor_protocol");
        let row = Params::row("motor_protocol");
        row.and_then(|row| row.choice(value))
            .map_or("", |choice| choice.name)
    }

    /// Spins a motor and asks whether it turns; `None` if aborted.
    async fn turns(&mut self, spin: Spin, begun: fmt::Arguments<'_>) -> Option<bool> {
        let number = spin.rotor + 1;
        match self.order(BenchOrder::Spin(spin), begun).await {
            End::Done => (),
            end => {
                self.say_end(format_args!("motor {number} stopped"), end).await;
                return None;
            }
        }
        match self.ask("did it turn, evenly, and beep no more? y or n: ").await {
            Some(b'y') => Some(true),
            Some(b'n') => Some(false),
            _ => {
                self.out.line(format_args!("ended")).await;
                None
            }
        }
    }

    /// Prints the instruction, waits for a key, and samples two seconds at rest; `None` if aborted.
    async fn rest(&mut self, text: &str, read: Read<'_>) -> Option<Samples> {
        if !self.confirmed(text).await {
            return None;
        }
        let mut samples = Samples::default();
        for _ in 0..SAMPLES {
            Timer::after(SAMPLING).await;
            if let Some(sample) = read(self.links) {
                samples.add(sample);
            }
            if self.keys.pressed() {
                self.out.line(format_args!("ended: nothing is changed")).await;
                return None;
            }
        }
        Some(samples)
    }

    /// Puts all of `values` into the working copy, or none.
    async fn put_all<const N: usize>(&mut self, names: &[&str; N], values: [f32; N]) {
        for (name, value) in names.iter().zip(values) {
            if let Some(row) = Params::row(name) {
                self.put(row, thousandths(value)).await;
            }
        }
    }

    async fn unfit(&mut self, unfit: Unfit) {
        let Unfit {
            what, value, unit, ..
        } = unfit;
        let [value, least, most] = [value, unfit.allowed[0], unfit.allowed[1]].map(Decimal);
        let unit = crate::storage::parameters::Unit(if unit.is_empty() { "1" } else { unit });
        self.out
            .line(format_args!(
                "not taken: {what} is {value:.2}; {least:.2} to {most:.2}{unit} allowed"
            ))
            .await;
    }
}

/// Specific force, m/s².
fn force(links: &Links) -> Option<Vec3> {
    links.attitude.fresh().map(|a| a.accel)
}
