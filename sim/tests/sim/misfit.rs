//! An inertial sensor with another mounting and scale than its board's file states: calibrated, then flown.

use std::cell::RefCell;
use std::rc::Rc;

use embassy_time::Timer;
use sophie_control::allocation::wrench::Configuration;
use sophie_control::attitude::mounting::{Direction, Mounting};
use sophie_control::calibration::Face;
use sophie_control::chain::ImuReading;
use sophie_control::maths::vector::Vec3;
use sophie_control::params::Params;
use sophie_drivers::param_store::ParamStore;
use sophie_fakes::{FakeChip, FakeImu, FakeLine, Flash};
use sophie_ports::error::PortError;
use sophie_ports::serial::SerialOutput;
use sophie_sim::clock::VirtualTime;
use sophie_sim::mixers::Variant;
use sophie_sim::sensors::imu::Misfit;
use sophie_sim::test_stands::flight_level::{Errors, Rig, level, vehicle};
use sophie_tasks::console;
use sophie_tasks::flight::{estimator, imu};
use sophie_tasks::links::Links;
use sophie_tasks::pilot::commander;
use sophie_tasks::storage::parameters;

/// Turned by 90 degrees to the left.
const TURNED: Mounting = Mounting {
    nose: Direction::Right,
    right: Direction::Back,
    belly: Direction::Down,
};

/// Turned, and 3 % off along two axes.
fn misfit() -> Misfit {
    Misfit {
        mounting: TURNED,
        scale: Vec3::new(1.03, 0.97, 1.03),
    }
}

#[derive(Clone, Default)]
struct Screen(Rc<RefCell<String>>);

impl SerialOutput for Screen {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        Timer::after_micros(87 * bytes.len() as u64).await;
        self.0.borrow_mut().push_str(str::from_utf8(bytes).unwrap());
        Ok(())
    }
}

type Memory = Flash<32, 2048>;

fn store(flash: &Memory) -> ParamStore<Memory> {
    ParamStore::new(flash.clone(), flash.range())
}

/// Parameters that a start loads.
fn stored(flash: &Memory) -> Params {
    let time = VirtualTime::new();
    let found = Rc::new(RefCell::new(None));
    let (slot, mut storage) = (found.clone(), store(flash));
    time.spawn(async move { *slot.borrow_mut() = Some(parameters::load(&mut storage).await.0) });
    time.run_until(1);
    found.take().unwrap()
}

/// A builder with the vehicle in hand and a terminal.
struct Builder {
    time: VirtualTime,
    ms: u64,
    part: FakeImu,
    line: FakeLine,
    screen: Screen,
}

impl Builder {
    /// The vehicle with `flash`, started.
    fn with(flash: &Memory) -> Self {
        let time = VirtualTime::new();
        let links: &'static Links = Box::leak(Box::new(Links::new(stored(flash))));
        let mut hands = Self {
            time,
            ms: 0,
            part: FakeImu::default(),
            line: FakeLine::default(),
            screen: Screen::default(),
        };
        hands.lies(Face::Belly);
        hands.time.spawn(imu::run(links, hands.part.clone()));
        hands.time.spawn(estimator::run(links));
        hands.time.spawn(commander::run(links));
        let (line, screen) = (hands.line.clone(), hands.screen.clone());
        let console = console::run(links, line, screen, store(flash), FakeChip::default());
        hands.time.spawn(console);
        hands.run(4000);
        hands
    }

    fn run(&mut self, ms: u64) {
        self.ms += ms;
        self.time.run_until(self.ms * 1000);
    }

    fn lies(&mut self, side: Face) {
        let read = misfit().reads(ImuReading {
            gyro: Vec3::ZERO,
            accel: side.force(),
        });
        // The part adds level gravity.
        self.part.2.set(ImuReading {
            accel: read.accel - Face::Belly.force(),
            ..read
        });
        self.run(500);
    }

    fn types(&mut self, text: &str, ms: u64) -> String {
        self.screen.0.take();
        self.line.put(format!("{text}\r").as_bytes());
        self.run(ms);
        self.screen.0.take()
    }

    /// `calibrate WHAT SIDE` on these sides, then `save`; the answer to the last side.
    fn calibrates(&mut self, what: &str, sides: &[Face]) -> String {
        let mut said = String::new();
        for side in sides {
            self.lies(*side);
            said = self.types(&format!("calibrate {what} {}", side.name()), 2800);
        }
        self.lies(Face::Belly);
        assert!(self.types("save", 1500).contains("saved; restarting"), "{said}");
        said
    }
}

fn hover(params: Params) -> Errors {
    let mut scenario = vehicle(Configuration::default(), 7.75, 6.9, Variant::Flexible);
    scenario.params = params;
    Rig::misfitted(&scenario, misfit()).fly(12.0, level)
}

#[test]
fn a_sensor_built_in_wrong_is_calibrated_at_the_console_and_then_hovers() {
    let flash = Memory::blank(2);
    let said = Builder::with(&flash).calibrates("mounting", &[Face::Belly, Face::Nose, Face::Right]);
    let turned = "imu_mounting 0 forward_down -> 8 right_down, in force after save";
    assert!(said.contains(turned), "{said}");
    // After the restart the mounting is the stored one, and the sides are the vehicle's.
    let said = Builder::with(&flash).calibrates("accel", &Face::ALL);
    for scale in ["x 1 -> 1.03,", "y 1 -> 0.97,", "z 1 -> 1.03,"] {
        assert!(
            said.contains(&format!("accel_scale_{scale} in force after save")),
            "{said}"
        );
    }
    let again = Builder::with(&flash).calibrates("mounting", &[Face::Belly, Face::Nose, Face::Right]);
    assert!(
        again.contains("imu_mounting 8 right_down -> 8 right_down, as in force"),
        "{again}"
    );

    let found = stored(&flash);
    assert_eq!(Mounting::from(found.imu_mounting), TURNED);
    let calibrated = hover(found);
    println!("{calibrated:?}");
    assert!(
        calibrated.worst_roll < 3.0 && calibrated.worst_pitch < 3.0,
        "{calibrated:?}"
    );
    let not = hover(Params::DEFAULT);
    println!("not calibrated: {not:?}");
    assert!(
        not.worst_roll.max(not.worst_pitch) > 15.0 && not.worst_yaw > 90.0,
        "{not:?}"
    );
}
