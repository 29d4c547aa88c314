//! Actuator tests: drives motors or one servo, within the limits of the commander.
//!
//! The console renews an order periodically. The commander ends it independently of the console: at its time limit, on
//! its own conditions, or when renewals stop.

use core::fmt;

use embassy_time::{Duration, Instant};
use sophie_control::allocation::motor_pulses::{MotorPulses, least_command};
use sophie_control::gripper::tendon::Reel;
use sophie_control::maths::scalar::{deg, to_deg};
use sophie_control::pilot::actuator_test::{
    ActuatorTest, ActuatorTestRefusal, ActuatorTestRequest, ActuatorTestState, PULSE_MAX_US, PULSE_MIN_US,
    Place, SPIN_DRIVE, SPIN_DRIVE_MAX, SPIN_DRIVE_MIN, SPIN_TIME, Spin,
};
use sophie_control::pilot::static_thrust_test::{DRIVE_MAX, DRIVE_MIN, Rotors, STEP_MAX, StaticThrustTest};

use super::Console;
use crate::deadline::FixedRate;
use crate::schedule::TaskId;
use sophie_control::maths::decimal::{self, Decimal};
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

/// Time that the commander has to answer: fifty of its periods.
const COMMANDER: Duration = Duration::from_millis(500);

/// How an order has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// Ran to its end.
    Done,
    /// Aborted by a key.
    Key,
    /// Refused before its start.
    Refused(ActuatorTestRefusal),
    /// Ended early by the commander.
    Ended(ActuatorTestRefusal),
    /// The commander does not answer.
    Silent,
}

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    pub(super) async fn propellers_off(&mut self) {
        let confirmed = "propellers off: motors may be tried until the next arming or restart";
        self.confirm(ActuatorTest::PropellersOff, confirmed).await;
    }

    pub(super) async fn tied_down(&mut self) {
        let confirmed = "tied down, propellers on: 'thrust' runs them until the next arming or restart";
        self.confirm(ActuatorTest::TiedDown, confirmed).await;
    }

    async fn confirm(&mut self, order: ActuatorTest, confirmed: &str) {
        match self.order(order, format_args!("")).await {
            End::Done | End::Key => self.out.line(format_args!("{confirmed}")).await,
            end => self.not_begun(end).await,
        }
    }

    /// Runs rotor `which`, or `all`, with propellers on at `percent` of full drive; with `to` in a train of steps between
    /// both.
    pub(super) async fn thrust(&mut self, which: &str, percent: &str, to: Option<&str>) {
        let rotors = if which == "all" {
            Rotors::All
        } else {
            match self.one_of_four("rotor", which).await {
                Some(rotor) => Rotors::One(rotor),
                None => return,
            }
        };
        let drive = |text| decimal::parse(text).map(|percent| percent / 100.0);
        let test = match (drive(percent), to.map(drive)) {
            (Some(drive), None) => Some(StaticThrustTest::steady(rotors, drive)),
            (Some(drive), Some(Some(to))) => Some(StaticThrustTest::train(rotors, drive, to)),
            _ => None,
        };
        let Some(test) = test.filter(StaticThrustTest::is_allowed) else {
            let [least, most, step] = [DRIVE_MIN, DRIVE_MAX, STEP_MAX].map(|drive| Decimal(drive * 100.0));
            return self
                .out
                .line(format_args!(
                    "thrust takes {least:.0} to {most:.0} %, and steps of at most {step:.0} %"
                ))
                .await;
        };
        let seconds = Decimal(test.longest());
        let begun = format_args!("rotor {which}: {seconds:.0} s; any key stops it");
        let end = self.order(ActuatorTest::StaticThrust(test), begun).await;
        self.say_end(format_args!("rotor {which} stopped"), end).await;
    }

    /// Spins motor `number` at `percent` of full drive for two seconds.
    pub(super) async fn motor(&mut self, number: &str, percent: Option<&str>) {
        let Some(rotor) = self.one_of_four("motor", number).await else {
            return;
        };
        let drive = percent.map_or(Some(SPIN_DRIVE), |text| {
            decimal::parse(text).map(|percent| percent / 100.0)
        });
        let allowed = |drive: &f32| (SPIN_DRIVE_MIN..=SPIN_DRIVE_MAX).contains(drive);
        let Some(drive) = drive.filter(allowed) else {
            let [least, most] = [SPIN_DRIVE_MIN, SPIN_DRIVE_MAX].map(|drive| Decimal(drive * 100.0));
            let text = percent.unwrap_or_default();
            return self
                .out
                .line(format_args!(
                    "a motor cannot be tried at '{text}'; {least:.0} to {most:.0} %"
                ))
                .await;
        };
        let spin = Spin::at(rotor, drive);
        let drive = spin.drive(least_command(&self.links.params));
        let (percent, seconds) = (Decimal(drive * 100.0), Decimal(SPIN_TIME));
        let begun = format_args!("motor {number} at {percent:.0} % for {seconds} s; any key stops it");
        let end = self.order(ActuatorTest::Spin(spin), begun).await;
        self.say_end(format_args!("motor {number} stopped"), end).await;
    }

    /// Spins motor `number` by a pulse, µs, which may be below the least that turns every motor.
    pub(super) async fn motor_by_pulse(&mut self, number: &str, pulse: &str) {
        let Some(rotor) = self.one_of_four("motor", number).await else {
            return;
        };
        let pulses = MotorPulses::shown(&self.links.params).unwrap_or(MotorPulses::DIGITAL);
        let drive = decimal::parse(pulse).map(|pulse_us| pulses.command(pulse_us));
        let Some(drive) = drive.filter(|drive| (SPIN_DRIVE_MIN..=SPIN_DRIVE_MAX).contains(drive)) else {
            let [least, most] = [SPIN_DRIVE_MIN, SPIN_DRIVE_MAX].map(|drive| Decimal(pulses.pulse_us(drive)));
            return self
                .out
                .line(format_args!(
                    "a motor cannot be tried at '{pulse}'; {least:.0} to {most:.0} us"
                ))
                .await;
        };
        let spin = Spin {
            probes: true,
            ..Spin::at(rotor, drive)
        };
        let seconds = Decimal(SPIN_TIME);
        let begun = format_args!("motor {number} at {pulse} us for {seconds} s; any key stops it");
        let end = self.order(ActuatorTest::Spin(spin), begun).await;
        self.say_end(format_args!("motor {number} stopped"), end).await;
    }

    /// Sends servo `number` to a pulse (µs), an angle (degrees from release) or its release mark.
    pub(super) async fn servo(&mut self, number: &str, to: &str, at: Option<&str>) {
        let Some(servo) = self.one_of_four("servo", number).await else {
            return;
        };
        let marked = self.links.params.servo_marks.has(servo);
        if !marked && to != "pulse" {
            return self
                .out
                .line(format_args!(
                    "servo {number} has no marks yet: find them by 'servo {number} pulse', then 'calibrate servo'"
                ))
                .await;
        }
        let reel = Reel::from_params(&self.links.params, servo);
        let most = to_deg(self.links.params.servo_range);
        let value = at.and_then(decimal::parse);
        let pulse_us = match (to, at, value) {
            ("release", None, _) => reel.pulse(0.0),
            ("pulse", _, Some(us)) if (PULSE_MIN_US..=PULSE_MAX_US).contains(&us) => us,
            ("angle", _, Some(angle)) if (0.0..=most).contains(&angle) => reel.pulse(deg(angle)),
            _ => {
                let [short, long, most] = [PULSE_MIN_US, PULSE_MAX_US, most].map(Decimal);
                return self
                    .out
                    .line(format_args!(
                        "a servo takes 'release', 'pulse' {short:.0} to {long:.0} us, 'angle' 0 to {most:.0} deg"
                    ))
                    .await;
            }
        };
        let (pulse, angle) = (Decimal(pulse_us), Decimal(to_deg(reel.angle_of(pulse_us))));
        let order = ActuatorTest::Place(Place { servo, pulse_us });
        let end = if marked {
            let begun =
                format_args!("servo {number} to {pulse:.0} us, {angle:.0} deg from release; any key ends it");
            self.order(order, begun).await
        } else {
            let begun = format_args!("servo {number} to {pulse:.0} us; any key ends it");
            self.order(order, begun).await
        };
        self.say_end(format_args!("servo {number} {}", self.goes(servo)), end)
            .await;
    }

    /// State of `servo` after an order, as text.
    pub(super) fn goes(&self, servo: usize) -> &'static str {
        if self.links.params.servo_marks.has(servo) {
            "back to its release mark"
        } else {
            "without pulse again"
        }
    }

    /// Index of motor or servo `number`, 1 to 4; any other number is refused with a line.
    pub(super) async fn one_of_four(&mut self, what: &str, number: &str) -> Option<usize> {
        let index = ["1", "2", "3", "4"].iter().position(|name| *name == number);
        if index.is_none() {
            self.out
                .line(format_args!(
                    "no {what} '{number}'; 1 front-left, 2 rear-left, 3 front-right, 4 rear-right"
                ))
                .await;
        }
        index
    }

    pub(super) async fn say_end(&mut self, what: fmt::Arguments<'_>, end: End) {
        match end {
            End::Done => self.out.line(what).await,
            End::Key => self.out.line(format_args!("{what} by a key")).await,
            End::Ended(why) => self.out.line(format_args!("{what}: {}", why.text())).await,
            End::Refused(_) | End::Silent => self.not_begun(end).await,
        }
    }

    async fn not_begun(&mut self, end: End) {
        match end {
            End::Refused(why) | End::Ended(why) => {
                self.out.line(format_args!("refused: {}", why.text())).await;
            }
            _ => {
                self.out
                    .line(format_args!("refused: the commander is silent"))
                    .await
            }
        }
    }

    /// Sends `order` and renews it until it ends or a key aborts it; prints `begun` once the commander has accepted
    /// it.
    pub(super) async fn order(&mut self, order: ActuatorTest, begun: fmt::Arguments<'_>) -> End {
        let number = match self.next_order() {
            Ok(number) => number,
            Err(why) => return End::Refused(why),
        };
        let asked = Instant::now();
        let request = ActuatorTestRequest { number, order };
        // Sent immediately: another console waiting for its next run must not use the same number.
        self.links.actuator_test.send(asked, request);
        let mut rate = FixedRate::of(self.links, TaskId::Console);
        let mut said = false;
        loop {
            let at = rate.next().await.started;
            self.links.actuator_test.send(at, request);
            let answer = self.links.actuator_test_answer.fresh();
            match answer
                .filter(|answer| answer.number == number)
                .map(|answer| answer.state)
            {
                Some(ActuatorTestState::Done) => return End::Done,
                Some(ActuatorTestState::Refused(why)) => return End::Refused(why),
                Some(ActuatorTestState::Ended(why)) => return End::Ended(why),
                Some(ActuatorTestState::Running) if !said => {
                    said = true;
                    self.out.line(begun).await;
                }
                Some(ActuatorTestState::Running) => (),
                None if asked.elapsed() > COMMANDER => return End::Silent,
                None => (),
            }
            if self.keys.pressed() {
                let order = ActuatorTest::End;
                if let Ok(number) = self.next_order() {
                    self.links
                        .actuator_test
                        .send(Instant::now(), ActuatorTestRequest { number, order });
                }
                return End::Key;
            }
        }
    }

    /// The number of the next order.
    fn next_order(&mut self) -> Result<u32, ActuatorTestRefusal> {
        self.order = self.links.actuator_test_view().next(self.order)?;
        Ok(self.order)
    }
}
