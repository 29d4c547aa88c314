//! Draws, rows and folders of campaigns. Only the last test flies.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use sophie_sim::scenario::keys::{KEYS, Kind};

use super::*;

const REQUEST: Request = Request {
    known: Known::Calibrated,
    assist: Assist::None,
    sensors: PositionSensor::None,
    judge: Rule::Holding,
    wind: 3.0,
    seed: 1,
    count: 4,
};

/// A folder that is removed after its test.
struct Temp(PathBuf);

impl Temp {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("sophie-unknown-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Temp {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn what_is_known_exactly_are_pipe_and_pressure_sensors_too() {
    let exact = Request {
        known: Known::Exact,
        ..REQUEST
    };
    let (s, _) = exact.draw(7).unwrap();
    let told = [s.params.pipe_diameter, s.params.pipe_friction, s.params.mass].map(f64::from);
    let true_ones = [s.world.pipe_diameter, s.world.pipe_friction, s.vehicle.body.mass];
    for (told, truth) in told.into_iter().zip(true_ones) {
        assert!((told / truth - 1.0).abs() < 1e-5, "{told} {truth}");
    }
    let nominal = Scenario::default_mission();
    assert!(s.world.pipe_friction != nominal.world.pipe_friction);
    let gains = s
        .differences()
        .into_iter()
        .filter(|d| d.key.starts_with("faults.pressure_gain"));
    assert_eq!(gains.count(), 0, "trims as the gains are");
}

#[test]
fn a_seed_is_one_vehicle_and_seeds_differ() {
    let drawn = |seed| REQUEST.draw(seed).unwrap().1;
    assert_eq!(drawn(7), drawn(7));
    assert_ne!(drawn(7), drawn(8));
    let other = Request {
        known: Known::AsBuilt,
        wind: 0.0,
        ..REQUEST
    };
    assert_eq!(drawn(7), other.draw(7).unwrap().1, "the command does not draw");
}

/// First draws of a seed, which no further row of the table may change.
#[test]
fn the_draws_of_a_seed_stay() {
    let drawn = draw::draw(Streams::new(1));
    let number = |key: &str| drawn.iter().find(|drawn| drawn.key == key).unwrap().numbers()[0];
    for (key, within) in [
        (
            "vehicle.mass_kg",
            Streams::new(1).within("unknown vehicle.mass_kg all", 0.92, 1.08) * 1.805,
        ),
        (
            "vehicle.rotor_thrust",
            Streams::new(1).within("unknown vehicle.rotor_thrust 1", 0.95, 1.05),
        ),
    ] {
        assert!((number(key) - within).abs() < 1e-12, "{key}: {}", number(key));
    }
}

#[test]
fn every_vehicle_is_a_scenario_whose_parameters_follow_what_is_known() {
    for seed in 1..=100 {
        let (scenario, drawn) = REQUEST.draw(seed).unwrap();
        for drawn in &drawn {
            let key = KEYS.iter().find(|key| key.name == drawn.key).expect(drawn.key);
            let numbers = drawn.numbers();
            let ranges: Vec<_> = match &key.kind {
                Kind::Number(range, _) | Kind::Optional(range, _) => vec![*range],
                Kind::PerArm(range, _) => vec![*range; 4],
                Kind::PerAxis(ranges, _) => ranges.to_vec(),
                Kind::Flag(_) => continue,
                _ => panic!("{}: no number", drawn.key),
            };
            assert_eq!(ranges.len(), numbers.len(), "{}", drawn.key);
            let within = numbers
                .iter()
                .zip(&ranges)
                .all(|(n, r)| (r.min..=r.max).contains(n));
            assert!(within, "{seed}: {}: {numbers:?}", drawn.key);
        }
        let mass = scenario.vehicle.body.mass;
        assert!((f64::from(scenario.params.mass) / mass - 1.0).abs() < 0.010_01);
        assert_eq!(scenario.seed, seed);
        assert!((scenario.world.air.wind.gust - 0.6).abs() < 1e-12);
    }
    let exact = Request {
        known: Known::Exact,
        ..REQUEST
    };
    let (scenario, _) = exact.draw(3).unwrap();
    assert!((scenario.vehicle.body.mass - f64::from(scenario.params.mass)).abs() < 1e-6);
    assert!(
        (scenario.vehicle.arm_level_thrust()
            - f64::from(scenario.params.arm_level_share * scenario.params.thrust_max))
        .abs()
            < 1e-5
    );
}

#[test]
fn every_spread_of_the_table_is_drawn_and_a_level_arm_by_its_thrust() {
    let drawn = draw::draw(Streams::new(2));
    for quantity in QUANTITIES {
        let spread = quantity.all.is_some() || quantity.each.is_some();
        let wanted = spread && quantity.key != "vehicle.arm_level_share";
        let is = drawn.iter().any(|drawn| drawn.key == quantity.key);
        assert_eq!(is, wanted, "{}", quantity.key);
    }
    for chance in CHANCES {
        assert!(
            drawn.iter().any(|drawn| drawn.key == chance.key),
            "{}",
            chance.key
        );
    }
}

#[test]
fn parts_are_as_frequent_as_the_table_says_and_a_brake_slows_as_fast_as_the_motor_gains() {
    let mut braked = 0;
    let mut flanged = 0;
    for seed in 0..1000 {
        let (scenario, _) = REQUEST.draw(seed).unwrap();
        let spin = scenario.vehicle.rotor.spin;
        braked += u32::from(spin.brakes);
        flanged += u32::from(scenario.world.pipe_shape.flange.spacing > 0.0);
        assert_eq!(spin.brakes, spin.down == Some(spin.up), "{seed}");
        assert!(scenario.vehicle.rotor.reaction && scenario.vehicle.air.drag.on_rotors);
    }
    // Four sigma: 58 and 63 of 1000.
    assert!(
        (642..=758).contains(&braked) && (437..=563).contains(&flanged),
        "{braked} {flanged}"
    );
}

#[test]
fn a_builder_checks_the_vehicle_that_he_takes_it_for() {
    let of = |known| {
        let request = Request { known, ..REQUEST };
        request.draw(5).unwrap().0
    };
    let nominal = Scenario::default_mission();
    let built = of(Known::AsBuilt).assumed();
    assert!((built.vehicle.body.mass - nominal.vehicle.body.mass).abs() < 1e-6);
    assert!((built.vehicle.arm_gain[2] - 1.0).abs() < 1e-5);
    let truth = of(Known::Calibrated);
    let checked = truth.assumed();
    assert!((checked.vehicle.body.mass - f64::from(truth.params.mass)).abs() < 1e-6);
    assert!((checked.world.pipe_diameter - f64::from(truth.params.pipe_diameter)).abs() < 1e-6);
    assert!((checked.vehicle.rotor.thrust_max - f64::from(truth.params.thrust_max)).abs() < 1e-4);
    assert_eq!(checked.world.air.wind, truth.world.air.wind);
    // He knows that air damps rotors and their inertia turns the body, not how much.
    assert!((checked.vehicle.air.inflow - 1.0).abs() < 0.2 && checked.vehicle.rotor.reaction);
    assert_eq!(nominal.assumed().vehicle.air, nominal.vehicle.air);
}

/// A row without a flight.
fn row(request: &Request, vehicle: u64) -> Row {
    let seed = request.seed_of(vehicle);
    let (scenario, drawn) = request.draw(seed).unwrap();
    let mut row = Row::grounded(vehicle, seed, &scenario, &drawn);
    row.reason = format!("check: too heavy, \"{vehicle}\"");
    row
}

#[test]
fn a_row_is_read_as_it_was_written_and_a_torn_one_is_left_out() {
    let rows: Vec<Row> = (1..=3).map(|vehicle| row(&REQUEST, vehicle)).collect();
    let header = row::header(&REQUEST);
    let mut text = header.clone();
    text.extend(rows.iter().map(|row| row.line(&REQUEST)));
    let columns = header.split(',').count();
    assert_eq!(columns, REQUEST.words().len() + 7 + rows[0].numbers.len());
    let (read, end) = row::read(&text, &header).unwrap();
    assert!(read.iter().map(|(_, row)| row).eq(&rows));
    assert_eq!(end, text.len());
    let torn = &text[..text.len() - 5];
    let (read, end) = row::read(torn, &header).unwrap();
    assert_eq!(read.len(), 2);
    assert!(torn[..end].ends_with('\n'));
    assert!(
        row::read("a,b\n", &header)
            .unwrap_err()
            .starts_with("1: its columns")
    );
    let bad = text.replace(",refused,", ",refusing,");
    assert_eq!(row::read(&bad, &header).unwrap_err(), "2: no row of a flight");
}

#[test]
fn the_classes_of_the_object_sum_to_its_vehicles() {
    let mut rows: Vec<Row> = (1..=9).map(|vehicle| row(&REQUEST, vehicle)).collect();
    for (row, class) in rows.iter_mut().zip(Class::ALL.into_iter().cycle()) {
        row.class = class;
    }
    let object: serde_json::Value = serde_json::from_str(&report::json(&rows, &REQUEST)).unwrap();
    let integers: u64 = Class::ALL
        .iter()
        .map(|class| object[class.word()].as_u64().unwrap())
        .sum();
    assert_eq!((integers, object["vehicles"].as_u64()), (9, Some(9)));
    assert_eq!(object["perched"], 2);
    assert_eq!(object["fallen"], 1);
    assert_eq!(object["command"]["known"], "calibrated");
    let section = report::section(&rows, &REQUEST);
    assert!(section.finding.contains("2 of 9 vehicles"), "{}", section.finding);
}

/// Flies the shard in `folder`.
fn fly(
    request: &Request,
    shard: Shard,
    folder: &std::path::Path,
    done: &(dyn Fn(&Row) + Sync),
) -> Result<Vec<Row>, String> {
    super::fly(Shelf::open(request, shard, folder)?, done)
}

/// Writes the shard without a flight.
fn write(request: &Request, shard: Shard, folder: &std::path::Path) {
    let mut shelf = Shelf::open(request, shard, folder).unwrap();
    let rows = shelf.missing().into_iter().map(|vehicle| row(request, vehicle));
    shelf.extend(rows.collect());
    shelf.write().unwrap();
}

#[test]
fn shards_that_are_missing_are_named_and_all_of_them_are_the_whole() {
    let temp = Temp::new("missing");
    let request = Request { count: 11, ..REQUEST };
    let shard = |number| Shard { number, of: 9 };
    for number in [1, 2, 4, 5, 6] {
        write(&request, shard(number), &temp.0);
    }
    assert_eq!(folder::missing(&temp.0).unwrap(), "3,7-9");
    let line = folder::collect(&temp.0).unwrap_err();
    assert!(line.ends_with("shards 3,7-9 of 9 are missing"), "{line}");
    for number in [3, 7, 8, 9] {
        write(&request, shard(number), &temp.0);
    }
    assert_eq!(folder::missing(&temp.0).unwrap(), "");
    let (of_files, rows) = folder::collect(&temp.0).unwrap();
    assert_eq!(of_files, request);
    let whole = Temp::new("whole");
    write(&request, Shard::WHOLE, &whole.0);
    assert_eq!(folder::collect(&whole.0).unwrap(), (request, rows));
    assert_eq!(whole.names(), ["unknown-1-of-1.csv"]);
}

#[test]
fn folders_of_other_commands_and_without_rows_are_refused() {
    let temp = Temp::new("mixed");
    let [one, two] = [1, 2].map(|number| Shard { number, of: 2 });
    assert!(
        folder::missing(&temp.0)
            .unwrap_err()
            .contains("no file of a shard")
    );
    assert!(
        folder::missing(&temp.0.join("none"))
            .unwrap_err()
            .contains("cannot be read")
    );
    write(&REQUEST, one, &temp.0);
    let other = Request { wind: 2.0, ..REQUEST };
    write(&other, two, &temp.0);
    let line = folder::collect(&temp.0).unwrap_err();
    assert!(
        line.contains("rows of another command: wind_m_s 2, here 3"),
        "{line}"
    );
    let line = fly(&REQUEST, two, &temp.0, &|_| ()).unwrap_err();
    assert!(
        line.contains("wind_m_s 2, here 3") && !line.contains('\n'),
        "{line}"
    );
    // The same command with more vehicles takes over what it can, but is not counted with fewer.
    let more = Request { count: 6, ..REQUEST };
    fs::create_dir(temp.0.join("more")).unwrap();
    write(&more, two, &temp.0.join("more"));
    fs::rename(
        temp.0.join("more").join(two.file_name()),
        temp.0.join(two.file_name()),
    )
    .unwrap();
    let line = folder::collect(&temp.0).unwrap_err();
    assert!(line.contains("vehicles 6, here 4"), "{line}");
    fs::remove_dir_all(temp.0.join("more")).unwrap();
    write(&REQUEST, Shard::WHOLE, &temp.0);
    assert!(
        folder::missing(&temp.0)
            .unwrap_err()
            .contains("shards of 1 and of 2")
    );
    // Another version's.
    let file = temp.0.join(one.file_name());
    let text = fs::read_to_string(&file).unwrap();
    fs::write(
        &file,
        text.replacen(&format!("\n{},", env!("CARGO_PKG_VERSION")), "\n0.0.1,", 1),
    )
    .unwrap();
    let line = fly(&REQUEST, one, &temp.0, &|_| ()).unwrap_err();
    assert!(line.contains("sophie 0.0.1, here"), "{line}");
}

#[test]
fn a_shard_that_is_stopped_flies_what_is_missing_and_ends_with_the_same_file() {
    let (whole, resumed) = (Temp::new("one-go"), Temp::new("resumed"));
    // As built, the design check lets all pass.
    let request = Request {
        known: Known::AsBuilt,
        wind: 0.0,
        count: 2,
        ..REQUEST
    };
    let flown = AtomicUsize::new(0);
    let count = |_: &Row| {
        flown.fetch_add(1, Ordering::Relaxed);
    };
    let rows = fly(&request, Shard::WHOLE, &whole.0, &count).unwrap();
    assert_eq!((rows.len(), flown.load(Ordering::Relaxed)), (2, 2));
    assert!(
        rows.iter()
            .all(|row| row.seconds > 10.0 && row.digest.len() == 16),
        "{rows:?}"
    );
    assert_eq!(whole.names(), ["unknown-1-of-1.csv"]);
    let file = fs::read_to_string(whole.0.join("unknown-1-of-1.csv")).unwrap();

    // The second row under way, the third line torn: as a kill leaves it. The row that is there is marked, to see that it
    // is taken and not flown.
    let lines: Vec<&str> = file.split_inclusive('\n').collect();
    let marked = Row {
        reason: "taken, not flown".to_owned(),
        ..rows[1].clone()
    };
    let kept = marked.line(&request);
    let torn = &lines[1][..lines[1].len() / 2];
    fs::write(
        resumed.0.join(".unknown-1-of-1.csv.partial"),
        format!("{}{kept}{torn}", lines[0]),
    )
    .unwrap();
    let again = fly(&request, Shard::WHOLE, &resumed.0, &|_| ()).unwrap();
    assert_eq!(again[0], rows[0]);
    assert_eq!(again[1], marked);
    assert_eq!(resumed.names(), ["unknown-1-of-1.csv"]);
    let end = fs::read_to_string(resumed.0.join("unknown-1-of-1.csv")).unwrap();
    assert_eq!(end, format!("{}{}{kept}", lines[0], lines[1]));

    // Shards fly the same vehicles, and a campaign that is complete flies none.
    let second = Shard { number: 2, of: 2 };
    let shards = Temp::new("shards");
    assert_eq!(fly(&request, second, &shards.0, &|_| ()).unwrap(), rows[1..]);
    fs::write(whole.0.join("unknown-1-of-1.csv"), &end).unwrap();
    assert_eq!(fly(&request, Shard::WHOLE, &whole.0, &|_| ()).unwrap(), again);
}
