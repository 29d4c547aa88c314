//! The check against flights of a hundred random vehicles. Takes minutes, so only on demand: `cargo test --release
//! --test sophie check_sweep:: -- --ignored --nocapture`.

use sophie_sim::check::Check;
use sophie_sim::flight::fly;
use sophie_sim::parallel;
use sophie_sim::record::Silent;
use sophie_sim::scenario::{Overrides, Scenario};

const VEHICLES: usize = 100;
const SEED: u64 = 13;

/// Table, share of vehicles that have the key, range.
struct Drawn {
    table: &'static str,
    key: &'static str,
    share: f64,
    range: [f64; 2],
}

const fn drawn(table: &'static str, key: &'static str, share: f64, range: [f64; 2]) -> Drawn {
    Drawn {
        table,
        key,
        share,
        range,
    }
}

const DRAWN: [Drawn; 8] = [
    drawn("vehicle", "mass_kg", 0.5, [1.2, 3.0]),
    drawn("vehicle", "thrust_max_n", 0.5, [5.0, 12.0]),
    drawn("vehicle", "infill", 0.5, [6.0, 10.0]),
    drawn("vehicle", "gain_k", 0.5, [3.0, 9.0]),
    drawn("vehicle", "motor_tau_s", 0.3, [0.03, 0.1]),
    drawn("world", "pipe_diameter_m", 0.5, [0.2, 0.45]),
    drawn("params", "rate_pitch_p", 0.5, [4.0, 30.0]),
    drawn("params", "attitude_p", 0.3, [2.0, 9.0]),
];

/// 0 to 1, Knuth's linear congruential generator.
struct Uniform(u64);

impl Uniform {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A random vehicle as a scenario file.
fn draw(random: &mut Uniform) -> String {
    let (mut text, mut table) = (String::new(), "");
    for drawn in &DRAWN {
        let (has, at) = (random.next(), random.next());
        if drawn.table != table {
            table = drawn.table;
            text += &format!("[{table}]\n");
        }
        if has < drawn.share {
            let [low, high] = drawn.range;
            text += &format!("{} = {:.3}\n", drawn.key, low + (high - low) * at);
        }
    }
    text
}

#[test]
#[ignore = "minutes of simulated flight: .ci/campaign flies it"]
fn the_check_and_the_flights_agree_where_it_matters() {
    let mut random = Uniform(SEED);
    let texts: Vec<String> = (0..VEHICLES).map(|_| draw(&mut random)).collect();
    let results = parallel::each(&texts, |text| {
        let scenario = Scenario::parse(text, "vehicle.toml", &Overrides::default()).unwrap();
        let check = Check::of(&scenario);
        (check, fly(&scenario, &mut Silent).outcome)
    });
    let mut table = [[0; 2]; 2];
    for (text, (check, outcome)) in texts.iter().zip(&results) {
        let (can, flew) = (check.can_fly(), outcome.accomplished);
        table[usize::from(!can)][usize::from(!flew)] += 1;
        if can != flew {
            let rows: Vec<String> = check.failing().map(|row| row.shortfall()).collect();
            let words = text.replace('\n', " ");
            println!("check {can}, flew {flew}: {words}: {rows:?}: {}", outcome.reason);
        }
    }
    let [[pass_flew, pass_failed], [refused_flew, refused_failed]] = table;
    println!("                flew  failed");
    println!("check passes   {pass_flew:5} {pass_failed:7}");
    println!("check refuses  {refused_flew:5} {refused_failed:7}");
    assert!(
        10 * pass_failed <= pass_flew,
        "{pass_failed} of {} fail",
        pass_flew + pass_failed
    );
}
