//! A mission flown live, and the wait after it.

use sophie_control::mode::Mode;

use super::World;
use super::aircraft::Aircraft;
use super::stack::Stack;
use crate::live::Live;
use crate::record::{FlightRecord, Observer};
use crate::scenario::Scenario;

/// A vehicle that runs until the user stops it.
pub struct LiveFlight<'a> {
    scenario: &'a Scenario,
    world: World<Stack>,
    /// The pilot's transmitter is on while the vehicle waits.
    transmitter: bool,
}

impl<'a> LiveFlight<'a> {
    /// The vehicle of `scenario` on the ground, at the pace and with the clients of `live`.
    #[must_use]
    pub fn new(scenario: &'a Scenario, live: Live) -> Self {
        Self {
            scenario,
            world: World::new(scenario, || Stack::live(scenario, live)),
            transmitter: false,
        }
    }

    /// Flies the mission.
    pub fn fly(&mut self, observer: &mut dyn Observer) -> FlightRecord {
        let record = self.world.fly(self.scenario, observer);
        // The sticks are unattended now: with the transmitter off, the failsafe lands a flying vehicle.
        self.transmitter = record.outcome.accomplished && self.world.stack.mode() == Mode::Disarmed;
        record
    }

    /// Keeps the vehicle running until the user stops it; returns at once after a simulation that diverged.
    pub fn wait(&mut self) {
        self.world.leave_alone();
        while self.world.is_finite() && self.world.step(self.transmitter).is_ok() {}
    }
}

#[cfg(test)]
mod tests {
    use std::net::{Ipv4Addr, UdpSocket};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::{Duration, Instant};

    use super::*;
    use crate::live::{Pace, Udp};
    use crate::record::Silent;
    use crate::scenario::Step;

    fn live(speed: f64, stop: &Arc<AtomicBool>) -> Live {
        let station = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let udp = Udp::open(station.local_addr().unwrap()).unwrap();
        Live::new(Pace::new(speed), udp, Arc::clone(stop), |_| ())
    }

    fn hop() -> Scenario {
        Scenario {
            steps: vec![Step::Arm, Step::TakeOff { height: 1.0 }, Step::Land, Step::Disarm],
            ..Scenario::default_mission()
        }
    }

    #[test]
    fn a_mission_flown_live_is_the_same_flight_at_its_pace() {
        let scenario = hop();
        let stop = Arc::new(AtomicBool::new(false));
        let mut flight = LiveFlight::new(&scenario, live(20.0, &stop));
        let began = Instant::now();
        let record = flight.fly(&mut Silent);
        let took = began.elapsed().as_secs_f64();
        assert!(
            took >= 0.999 * record.sim_seconds / 20.0,
            "{took} s for {} s",
            record.sim_seconds
        );
        let alone = crate::flight::fly(&scenario, &mut Silent);
        assert_eq!((record.digest, record.outcome), (alone.digest, alone.outcome));
        assert!(flight.transmitter);
        stop.store(true, Ordering::Relaxed);
        flight.wait();
    }

    #[test]
    fn stopped_in_the_air_the_mission_has_failed_and_says_when() {
        let scenario = hop();
        let stop = Arc::new(AtomicBool::new(false));
        let mut flight = LiveFlight::new(&scenario, live(20.0, &stop));
        let stopping = Arc::clone(&stop);
        let stopper = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(400));
            stopping.store(true, Ordering::Relaxed);
        });
        let record = flight.fly(&mut Silent);
        stopper.join().unwrap();
        let reason = &record.outcome.reason;
        assert!(
            !record.outcome.accomplished && reason.starts_with("stopped from outside (at "),
            "{reason}"
        );
        assert!(!flight.transmitter);
        flight.wait();
    }

    #[test]
    fn a_mission_that_ends_in_the_air_lands_autonomously_while_it_waits() {
        let mut scenario = hop();
        scenario.steps.truncate(2);
        let stop = Arc::new(AtomicBool::new(false));
        // As fast as the host can.
        let mut flight = LiveFlight::new(&scenario, live(1000.0, &stop));
        assert!(flight.fly(&mut Silent).outcome.accomplished);
        assert!(!flight.transmitter);
        flight.world.leave_alone();
        for _ in 0..60_000 {
            flight.world.step(flight.transmitter).unwrap();
        }
        assert_eq!(flight.world.stack.mode(), Mode::Disarmed);
    }
}
