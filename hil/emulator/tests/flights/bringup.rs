//! `sophie bringup` with the flashed image: its own code on the board's MAVLink line, a scripted builder's replies, and a
//! bench operator who handles the vehicle.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use sophie_board_link::port::PortName;
use sophie_board_link::vehicle::Vehicle;
use sophie_bringup::STEPS;
use sophie_control::params::{MotorMap, Params};
use sophie_emulator::bench_operator::BenchOperator;
use sophie_emulator::closed_loop::Setup;
use sophie_emulator::flight::Stood;
use sophie_emulator::terminal::Sockets;
use sophie_emulator::wires::BoardFault;
use sophie_sim::plant::rotor::NOMINAL_VOLTAGE;
use sophie_sim::sensors::fsr;
use sophie_tasks::schedule::{Level, TaskId};

use super::builder::{Builder, FRICTION};
use super::console::terminal;
use super::*;

/// Pressure sensors of the walk: conductance over the nominal one, turn-on force, N, and hysteresis.
const GAIN: [f64; 4] = [1.1, 0.85, 0.95, 1.0];
const TURN_ON: [f64; 4] = [0.3, 0.5, 0.15, 0.7];
const HYSTERESIS: f64 = 0.07;
/// Silence of an emulated board on a busy machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// Lag of the vehicle's motors, s.
const LAG: f64 = 0.08;
/// Stiffness of the vehicle's tendons, N/m.
const STIFFNESS: f64 = 4000.0;

/// A folder of its own for the protocol.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("sophie-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn protocol(&self) -> PathBuf {
        self.0.join("bringup.toml")
    }

    fn read(&self) -> toml::Table {
        std::fs::read_to_string(self.protocol()).unwrap().parse().unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Result of a bring-up.
struct Walked {
    stood: Stood,
    log: String,
    builder: Builder,
    all_passed: Result<bool, sophie_board_link::Failure>,
}

/// A new H743 board with `builder` at its MAVLink line.
fn walk(folder: &Folder, builder: impl FnOnce(BenchOperator) -> Builder) -> Walked {
    let operator = BenchOperator::default();
    // Motors 2 and 3 are swapped.
    operator.change(|held| held.wiring = MotorMap::of([0, 2, 1, 3]).unwrap());
    let mut builder = builder(operator.clone());
    let (port, line) = terminal("--mavlink");
    let protocol = folder.protocol();
    let walker = std::thread::spawn(move || {
        let port: PortName = format!("mavlink:tcp:127.0.0.1:{port}").parse().unwrap();
        let all_passed = Vehicle::open(&port, None, PATIENCE, Arc::default())
            .and_then(|mut vehicle| sophie_bringup::run(&mut vehicle, &mut builder, &protocol, &[]));
        (builder, all_passed)
    });
    let firmware = Firmware::read(image(), board_kind::find("matek-h743").unwrap()).unwrap();
    let setup = Setup {
        speed: 1.0,
        plan: Plan::new([(0, Trouble::Board(BoardFault::FactoryOptions))]),
        sockets: Sockets {
            mavlink: Some(line),
            ..Sockets::default()
        },
    };
    let mut vehicle = unmarked(scenario("hover.toml"));
    // Not what the parameters have.
    vehicle.vehicle.tendons.stiffness = [STIFFNESS; 4];
    vehicle.vehicle.tendons.friction = [0.3; 4];
    vehicle.vehicle.rotor.spin.up = LAG;
    vehicle.faults.pressure_gain = GAIN;
    vehicle.sensors.pressure.turn_on = TURN_ON;
    vehicle.sensors.pressure.hysteresis = HYSTERESIS;
    let mut log = String::new();
    let stood = flight::stand(
        &firmware,
        &vehicle,
        setup,
        Some(operator),
        |line| {
            if !line.text.starts_with("timing ") {
                println!("{line}");
            }
            log += &format!("{line}\n");
        },
        || walker.is_finished(),
    );
    let (builder, all_passed) = walker.join().unwrap_or_else(|_| panic!("{log}"));
    Walked {
        stood: stood.unwrap(),
        log,
        builder,
        all_passed,
    }
}

fn figures(step: &toml::Value) -> String {
    let lines = step["figures"].as_array().unwrap().iter();
    lines
        .map(|line| format!("{}\n", line.as_str().unwrap()))
        .collect()
}

#[test]
#[ignore = "minutes of an emulated board: .ci/campaign walks it"]
fn a_new_board_is_brought_up_through_all_steps() {
    let folder = Folder::new("bringup-whole");
    let Walked {
        stood,
        log,
        builder,
        all_passed,
    } = walk(&folder, |operator| Builder::new(operator, None));
    let said = builder.said();
    assert_eq!(all_passed, Ok(true), "{said}\n{log}");
    let protocol = folder.read();
    let left = "left out: tendon-2, tendon-3, tendon-4";
    assert!(protocol["state"].as_str().unwrap().ends_with(left), "{said}");
    assert!(protocol["firmware"].as_str().unwrap().ends_with(" on matek-h743"));
    assert!(
        protocol["build"].as_str().unwrap().starts_with("build "),
        "{said}"
    );
    assert_eq!(protocol["chip"].as_str(), Some("0x450 0x2003"));
    let steps = protocol["step"].as_array().unwrap();
    let ids: Vec<&str> = steps.iter().map(|step| step["id"].as_str().unwrap()).collect();
    assert!(
        ids.iter().copied().eq(STEPS.iter().map(|step| step.id)),
        "{ids:?}"
    );
    let step = |id: &str| steps.iter().find(|step| step["id"].as_str() == Some(id)).unwrap();
    let passed = |step: &&toml::Value| step["result"].as_str() == Some("passed");
    assert_eq!(steps.iter().filter(passed).count(), STEPS.len() - 3, "{said}");
    // The values found are those of the simulated parts.
    let parameter = |id: &str, name: &str| step(id)["parameters"][name].as_float().unwrap();
    for (arm, gain) in GAIN.into_iter().enumerate() {
        let (id, number) = (format!("fsr-{}", arm + 1), arm + 1);
        let trim = parameter(&id, &format!("fsr_trim_{number}"));
        let zero = parameter(&id, &format!("fsr_zero_{number}"));
        // What the sensor conducts at the grip pressure, as a pressure; what the board makes of it.
        let area = f64::from(Params::DEFAULT.fsr_area);
        let conducts = gain * (950.0 - TURN_ON[arm] / area);
        let reads = conducts / trim - zero;
        assert!(
            (reads / 950.0 - 1.0).abs() < fsr::LARGEST_ERROR,
            "{id}: {trim} {zero} {reads}"
        );
    }
    let twist = figures(step("twist"));
    let torsion = twist
        .split("vehicle.arm_torsion = ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let torsion: f64 = torsion.unwrap_or_default().parse().unwrap();
    assert!((torsion - 1.0).abs() < 0.05, "{twist}");
    assert!(figures(step("vibration")).starts_with("vibration 0."), "{said}");
    let stiffness = parameter("tendon-1", "tendon_stiffness");
    assert!((stiffness / STIFFNESS - 1.0).abs() < 0.15, "{stiffness}\n{said}");
    let lag = parameter("lag", "motor_tau");
    assert!((lag / LAG - 1.0).abs() < 0.15, "{lag}");
    let friction = parameter("friction", "pipe_friction");
    assert!((friction / FRICTION - 1.0).abs() < 0.03, "{friction}");
    assert!(
        figures(step("final")).contains("\nnothing forbids arming\n")
            && !figures(step("final")).contains("FAIL"),
        "{said}"
    );
    // The motors turn twice: to find the wiring, and to confirm it.
    let turned = [Some(0), Some(2), Some(1), Some(3)].repeat(2);
    assert_eq!(builder.turned(), turned, "{said}");
    assert_eq!(parameter("rotors", "motor_map"), 1324.0, "{said}");
    assert_eq!(builder.servo_marks(), [580.0, 2430.0].repeat(4), "{said}");
    assert_eq!(stood.gaps, []);
    // A store, at rest, holds up the tasks of its own level, without hard deadlines, and nothing above.
    for task in TaskId::ALL
        .into_iter()
        .filter(|task| task.level() != Level::Background)
    {
        let missed = stood.board.overruns.get(task.name()).copied().unwrap_or(0);
        assert_eq!(missed, 0, "{}: {:?}", task.name(), stood.board.overruns);
    }
}

/// Thrust of the simulated rotors at `command`, one of four alike, in the stack's law over what the plant gives.
fn law(parameter: impl Fn(&str) -> f64, command: f64) -> f64 {
    let (q, max) = (parameter("thrust_curve"), parameter("thrust_max"));
    let told = max * (q * command + 1.0 - q) * command;
    told / scenario("hover.toml")
        .vehicle
        .rotor
        .steady_thrust(command, NOMINAL_VOLTAGE)
}

#[test]
#[ignore = "minutes of an emulated board: .ci/campaign walks it"]
fn a_tied_vehicle_s_thrust_is_that_of_the_simulated_rotors() {
    let folder = Folder::new("bringup-thrust");
    let Walked {
        log, builder, stood, ..
    } = walk(&folder, |operator| Builder::at(operator, "thrust"));
    let said = builder.said();
    let protocol = folder.read();
    let steps = protocol["step"].as_array().unwrap();
    let step = steps
        .iter()
        .find(|step| step["id"].as_str() == Some("thrust"))
        .unwrap();
    assert_eq!(step["result"].as_str(), Some("passed"), "{said}\n{log}");
    let parameter = |name: &str| step["parameters"][name].as_float().unwrap();
    for command in [0.55, 0.7, 0.85] {
        let share = law(parameter, command);
        assert!((share - 1.0).abs() < 0.035, "{command}: {share}\n{said}");
    }
    // The winding's drop makes 1.6 to 1.7 of the power.
    assert!((parameter("thrust_volt_exp") - 1.66).abs() < 0.2, "{said}");
    for rotor in 1..=4 {
        let trim = parameter(&format!("thrust_trim_{rotor}"));
        assert!((trim - 1.0).abs() < 0.03, "{rotor}: {trim}\n{said}");
    }
    assert_eq!(stood.gaps, []);
}

/// The step `id` alone, of a tied vehicle, passed.
fn tied(name: &str, id: &'static str) -> (toml::Value, String) {
    let folder = Folder::new(name);
    let Walked {
        log, builder, stood, ..
    } = walk(&folder, |operator| Builder::at(operator, id));
    let said = builder.said().to_owned();
    let protocol = folder.read();
    let steps = protocol["step"].as_array().unwrap();
    let step = steps.iter().find(|step| step["id"].as_str() == Some(id)).unwrap();
    assert_eq!(step["result"].as_str(), Some("passed"), "{said}\n{log}");
    assert_eq!(stood.gaps, []);
    (step.clone(), said)
}

#[test]
#[ignore = "minutes of an emulated board: .ci/campaign walks it"]
fn a_tied_vehicle_s_arms_bend_as_the_simulated_ones() {
    let (step, said) = tied("bringup-arm-table", "arm-table");
    let parameter = |name: &str| step["parameters"][name].as_float().unwrap();
    let p = Params::DEFAULT;
    let rise = |t: f64| (parameter("arm_a1") + parameter("arm_b1") * t) * t;
    let level = parameter("arm_level_share") * f64::from(p.thrust_max);
    let spec = scenario("hover.toml").arm_spec(0);
    for newton in [3.0, 4.4, 6.0] {
        let (found, truth) = (rise(newton) - rise(level), spec.static_tilt(newton).to_degrees());
        // The default parameters have the thrust to 3 %.
        assert!((found - truth).abs() < 2.0, "{newton} N: {found} {truth}\n{said}");
    }
}

#[test]
#[ignore = "minutes of an emulated board: .ci/campaign walks it"]
fn a_tied_vehicle_s_motors_sound_as_slow_as_they_are() {
    let (step, said) = tied("bringup-lag", "lag");
    let lag = step["parameters"]["motor_tau"].as_float().unwrap();
    assert!((lag / LAG - 1.0).abs() < 0.15, "{lag}\n{said}");
}

#[test]
#[ignore = "minutes of an emulated board: .ci/campaign walks it"]
fn a_tied_vehicle_s_vibration_is_that_of_the_simulated_rotors() {
    let (step, said) = tied("bringup-vibration", "vibration");
    let figures = figures(&step);
    let mut words = figures.split(' ').skip(1);
    let mut axis = || words.next().unwrap().parse::<f64>().unwrap();
    // Four sines of 0.25 m/s2 at 600 rad/s, in hover 0.8 of that, in whatever phase.
    let (x, y) = (axis(), axis());
    assert!((0.1..0.6).contains(&x) && (0.1..0.5).contains(&y), "{said}");
}

#[test]
fn a_new_board_passes_its_first_steps_and_the_rest_is_left_for_later() {
    let folder = Folder::new("bringup-first");
    let Walked {
        stood,
        log,
        builder,
        all_passed,
    } = walk(&folder, |operator| Builder::new(operator, Some("live-imu")));
    let said = builder.said();
    assert_eq!(all_passed, Ok(false), "{said}\n{log}");
    let protocol = folder.read();
    assert!(
        protocol["state"]
            .as_str()
            .unwrap()
            .starts_with("not done: live-imu, "),
        "{said}"
    );
    let steps = protocol["step"].as_array().unwrap();
    for (step, id) in steps.iter().zip(["chip", "setup", "selftest", "live-air"]) {
        assert_eq!(
            (step["id"].as_str(), step["result"].as_str()),
            (Some(id), Some("passed")),
            "{said}"
        );
    }
    assert!(figures(&steps[0]).contains("brown-out level: 3; "), "{said}");
    assert_eq!(figures(&steps[2]).matches("FAIL").count(), 1, "{said}");
    // The driver converts the emulated part's counts to the true pressure.
    let air = figures(&steps[3]);
    let number = |begin: &str| {
        let line = air.lines().find_map(|line| line.strip_prefix(begin));
        let word = line.and_then(|line| line.split(' ').next());
        word.and_then(|word| word.parse::<f64>().ok())
            .unwrap_or_else(|| panic!("{begin}: {air}"))
    };
    assert!((number("pressure ") - 101_325.0).abs() < 110.0, "{air}");
    assert!((0.1..1.0).contains(&number("noise at rest ")), "{air}");
    assert!((number("up by hand ") + 12.0).abs() < 1.0, "{air}");
    // Two restarts: the brown-out level and the setup.
    assert_eq!(stood.board.resets.len(), 2, "{:?}", stood.board.resets);
    assert_eq!(stood.gaps, []);
}
