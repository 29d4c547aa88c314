//! `sophie recording` on small files that are written here.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// A folder that is gone afterwards.
struct Temp(PathBuf);

impl Temp {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("sophie-recording-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        fs::write(self.0.join(name), text).unwrap();
    }
}

impl Drop for Temp {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn sophie(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sophie"));
    command.current_dir(folder).arg("recording").args(args);
    command.output().unwrap()
}

fn json(folder: &Path, args: &[&str]) -> Value {
    let output = sophie(folder, &[args, &["--json"]].concat());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The one line of a refusal.
fn refused(folder: &Path, args: &[&str]) -> String {
    let output = sophie(folder, args);
    let line = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{args:?}: {line}");
    assert!(output.stdout.is_empty(), "{args:?}");
    assert_eq!(line.trim_end().lines().count(), 1, "{line}");
    line
}

const BEGIN: u64 = 5_000_000;

/// It stands for 3 s, rises to 1.2 m and swings by 0.3 m along north for as long as is said, nose to the north.
struct Flight {
    seconds: u64,
    /// Of what its module makes of a flow.
    flow: f64,
    /// From here on its range stands still, s.
    stuck: f64,
}

impl Flight {
    fn place(t: f64) -> [f64; 2] {
        let rise = ((t - 3.0) / 2.0).clamp(0.0, 1.0);
        let smooth = rise * rise * (3.0 - 2.0 * rise);
        let swing = (t - 6.0).clamp(0.0, 1e3);
        [0.3 * (1.0 - (PI * swing).cos()) / 2.0, 0.03 + 1.17 * smooth]
    }

    /// Second difference.
    fn acceleration(t: f64) -> [f64; 2] {
        let h = 1e-3;
        let [a, b, c] = [t - h, t, t + h].map(Self::place);
        [0, 1].map(|i| (a[i] - 2.0 * b[i] + c[i]) / (h * h))
    }

    fn lines(&self) -> String {
        let mut out = format!("# made by a test\nL,{BEGIN},0\n");
        let mut held = None;
        for ms in 1..self.seconds * 1000 {
            let (at, t) = (BEGIN + 1000 * ms, ms as f64 * 1e-3);
            if ms == 3000 {
                writeln!(out, "L,{at},17.7").unwrap();
            }
            if ms % 20 == 7 && ms > 100 {
                let measured = ms - 25;
                let (from, to) = (
                    Self::place((measured - 20) as f64 * 1e-3),
                    Self::place(measured as f64 * 1e-3),
                );
                // By a view of 42 degrees, calibrated by turning.
                let flow = self.flow * (to[0] - from[0]) / (1.049 * to[1]);
                // Noise of some millimetres, the same each time.
                let noise = 0.001 * ((ms * 7919 % 11) as f64 - 5.0);
                let mut range = ((to[1] + noise) * 1000.0).round() / 1000.0;
                if t > self.stuck {
                    range = *held.get_or_insert(range);
                }
                let us = BEGIN + 1000 * measured;
                writeln!(out, "F,{at},{us},0.02,{:.6},{flow:.6},100,more", 1e-4 * noise).unwrap();
                writeln!(out, "R,{at},{us},{range:.3},0.02,8.0").unwrap();
            }
            let [north, up] = Self::acceleration(t);
            writeln!(
                out,
                "I,{at},0.001,-0.002,0.0005,{north:.4},0.0,{:.4}",
                -9.80665 - up
            )
            .unwrap();
        }
        out
    }

    fn truth(&self) -> String {
        let mut out = "t_us,north,east,down,vn,ve,vd,roll_deg,pitch_deg,yaw_deg\n".to_owned();
        // The camera's north is the vehicle's east, and its origin elsewhere.
        for ms in (0..self.seconds * 1000).step_by(20) {
            let t = ms as f64 * 1e-3;
            let ([a, _], [north, up], [b, _]) =
                (Self::place(t - 0.01), Self::place(t), Self::place(t + 0.01));
            let at = BEGIN + 1000 * ms;
            writeln!(
                out,
                "{at},4,{:.4},{:.4},0,{:.4},0,0.5,0,90",
                2.0 + north,
                -up,
                (b - a) / 0.02
            )
            .unwrap();
        }
        out
    }
}

const SOUND: Flight = Flight {
    seconds: 20,
    flow: 1.0,
    stuck: f64::MAX,
};

fn faults(object: &Value) -> Vec<(&str, f64, f64)> {
    let list = object["faults"].as_array().unwrap();
    let fault = |f: &'_ Value| (f["from_s"].as_f64().unwrap(), f["to_s"].as_f64().unwrap());
    list.iter()
        .map(|f| (f["name"].as_str().unwrap(), fault(f).0, fault(f).1))
        .collect()
}

#[test]
fn a_sound_flight_is_estimated_and_compared_in_the_axes_of_its_truth() {
    let temp = Temp::new("sound");
    temp.write("flight.csv", SOUND.lines());
    temp.write("truth.csv", SOUND.truth());
    let found = json(&temp.0, &["flight.csv", "--truth", "truth.csv"]);
    let number = |key: &str| found[key].as_f64().unwrap();
    assert!(faults(&found).is_empty(), "{found}");
    assert!((number("seconds") - 20.0).abs() < 0.01, "{found}");
    assert!((0.9..=1.0).contains(&number("estimate_share")), "{found}");
    assert!(
        number("velocity_rms_m_s") < 0.05 && number("height_rms_m") < 0.02,
        "{found}"
    );
    assert!(
        number("place_end_m") < 0.2 && number("attitude_rms_deg") < 0.5,
        "{found}"
    );
    // Without a truth there is nothing to compare with.
    let alone = json(&temp.0, &["flight.csv", "--as", "sensors"]);
    for key in [
        "velocity_rms_m_s",
        "height_rms_m",
        "place_end_m",
        "attitude_rms_deg",
    ] {
        assert!(alone[key].is_null(), "{alone}");
    }
    assert_eq!(alone["estimate_share"], found["estimate_share"]);
    // In words it is the same.
    let words = sophie(&temp.0, &["flight.csv"]);
    let words = String::from_utf8(words.stdout).unwrap();
    assert!(
        words.contains("faults: none") && words.contains("1000 Hz"),
        "{words}"
    );
    // Of a vehicle of 5 kg the thrust carries less than half.
    let heavy = json(&temp.0, &["flight.csv", "--param", "mass=5"]);
    assert_ne!(heavy["estimate_share"], alone["estimate_share"]);
}

#[test]
fn faults_have_their_names_and_times_and_from_cuts_what_came_before() {
    let temp = Temp::new("faults");
    let stuck = Flight { stuck: 15.0, ..SOUND };
    temp.write("stuck.csv", stuck.lines());
    let found = json(&temp.0, &["stuck.csv"]);
    let named = faults(&found);
    assert!(
        matches!(named[..], [("range frozen", from, to)] if (15.3..16.2).contains(&from) && to > 19.9),
        "{found}"
    );
    temp.write("mirrored.csv", Flight { flow: -1.0, ..SOUND }.lines());
    let found = json(&temp.0, &["mirrored.csv"]);
    assert!(
        faults(&found)
            .iter()
            .any(|f| f.0 == "flow mirrored or scaled" && f.1 < 15.0),
        "{found}"
    );
    // Cut, it begins in the air, and its times still count from the first line.
    let found = json(&temp.0, &["stuck.csv", "--from", "12"]);
    assert!(faults(&found).iter().all(|f| f.1 > 15.0), "{found}");
    assert!(found["estimate_share"].as_f64().unwrap() > 0.9, "{found}");
    assert!(refused(&temp.0, &["stuck.csv", "--from", "21"]).contains("allowed 0 to 19.99"));
}

#[test]
fn a_table_with_named_columns_and_a_gzipped_file_are_read_alike() {
    let temp = Temp::new("alike");
    let lines = SOUND.lines();
    temp.write("lines.csv", &lines);
    let mut table = "t_us,gx,gy,gz,ax,ay,az,lift_n,flow_t_us,flow_s,flow_x,flow_y,flow_quality,range_t_us,range_m,range_min_m,range_max_m,else\n".to_owned();
    for line in lines.lines().filter(|line| !line.starts_with('#')) {
        let c: Vec<&str> = line.split(',').collect();
        let row = match c[0] {
            "I" => format!("{},{},,,,,,,,,,,x", c[1], c[2..8].join(",")),
            "F" => format!(
                "{},,,,,,,,{},{},{},{},{},,,,,",
                c[1], c[2], c[3], c[4], c[5], c[6]
            ),
            "R" => format!("{},,,,,,,,,,,,,{},{},{},{},", c[1], c[2], c[3], c[4], c[5]),
            _ => format!("{},,,,,,,{},,,,,,,,,,", c[1], c[2]),
        };
        writeln!(table, "{row}").unwrap();
    }
    temp.write("table.csv", table);
    let packed = Command::new("gzip")
        .arg("-k")
        .arg(temp.0.join("lines.csv"))
        .status();
    let plain = json(&temp.0, &["lines.csv"]);
    assert_eq!(json(&temp.0, &["table.csv"]), plain);
    if packed.is_ok_and(|status| status.success()) {
        assert_eq!(json(&temp.0, &["lines.csv.gz"]), plain);
        let whole = fs::read(temp.0.join("lines.csv.gz")).unwrap();
        temp.write("cut.gz", &whole[..whole.len() / 2]);
        assert!(refused(&temp.0, &["cut.gz"]).contains("cannot be read on"));
    }
}

/// A frame of SBUS with its channels in the middle, each 15 ms.
fn sbus(frames: u64, without: std::ops::Range<u64>) -> String {
    let mut out = String::new();
    for i in (0..frames).filter(|i| !without.contains(i)) {
        let mut bits = [0u8; 22];
        for bit in 0..16 * 11 {
            if (992u32 >> (bit % 11)) & 1 == 1 {
                bits[bit / 8] |= 1 << (bit % 8);
            }
        }
        let bytes = [0x0F].into_iter().chain(bits).chain([0, 0]);
        for (n, byte) in bytes.enumerate() {
            writeln!(out, "{} {}", 1_000 + 15_000 * i + 120 * n as u64, byte).unwrap();
        }
    }
    out
}

#[test]
fn bytes_go_through_the_decoder_of_their_line() {
    let temp = Temp::new("bytes");
    temp.write("sbus.txt", sbus(20, 0..0));
    let found = json(&temp.0, &["sbus.txt", "--as", "sbus"]);
    // The first frame, after no silence, shows where the second is; sticks count from the third in a row.
    assert_eq!((&found["frames"], &found["published"]), (&19.into(), &17.into()));
    let pause = found["longest_pause_ms"].as_f64().unwrap();
    assert!((47.0..49.0).contains(&pause), "{found}");
    temp.write("pause.txt", sbus(20, 10..14));
    let pause = json(&temp.0, &["pause.txt", "--as", "sbus"])["longest_pause_ms"].clone();
    assert!((74.9..76.0).contains(&pause.as_f64().unwrap()), "{pause}");
    // Another line's bytes are no frames.
    let found = json(&temp.0, &["sbus.txt", "--as", "crsf"]);
    assert_eq!(found["published"], 0);
    // A range of 1.234 m by MSP.
    let mut text = String::new();
    let frame: [u8; 14] = [b'$', b'X', b'<', 0, 0x01, 0x1F, 5, 0, 255, 0xD2, 0x04, 0, 0, 0];
    let crc = frame[3..13].iter().fold(0u8, |crc, byte| {
        (0..8).fold(crc ^ byte, |crc, _| {
            if crc & 0x80 != 0 {
                (crc << 1) ^ 0xD5
            } else {
                crc << 1
            }
        })
    });
    for (n, byte) in frame[..13].iter().chain([&crc]).enumerate() {
        writeln!(text, "{},0x{byte:02x}", 1_000_000 + 87 * n).unwrap();
    }
    temp.write("msp.txt", text);
    let found = json(&temp.0, &["msp.txt", "--as", "msp"]);
    assert_eq!((&found["frames"], &found["published"]), (&1.into(), &1.into()));
}

#[test]
fn bad_input_is_refused_in_a_line_with_its_place_and_what_is_allowed() {
    let temp = Temp::new("bad");
    let sensors = [
        ("I,5,0,0,0,0,0,nan", ":2: az 'nan', allowed -1000 to 1000 m/s2"),
        ("I,5,0,0,inf,0,0,0", ":2: gz 'inf', allowed -100 to 100 rad/s"),
        ("I,5,0,0,0,0,0", ":2: no az"),
        ("I,-5,0,0,0,0,0,0", ":2: t_us '-5', allowed 0 to"),
        ("I,3,0,0,0,0,0,-9.8", ":2: time 3, allowed 4 us or later"),
        ("F,9,11,0.01,0,0,9", ":2: flow_t_us 11, allowed 0 to 9 us"),
        ("F,9,8,0,0,0,9", ":2: flow_s '0', allowed 0.0001 to 1 s"),
        ("F,9,8,0.01,0,0,256", ":2: flow_quality '256', allowed 0 to 255"),
        ("R,9,8,far,0,8", ":2: range_m 'far', allowed"),
        ("L,9,-1", ":2: lift_n '-1', allowed 0 to 10000 N"),
        ("X,9", ":2: a line of 'X', allowed I, F, R or L"),
    ];
    for (line, wanted) in sensors {
        temp.write("x.csv", format!("I,4,0,0,0,0,0,-9.8\n{line}\n"));
        let said = refused(&temp.0, &["x.csv"]);
        assert!(said.contains(&format!("x.csv{wanted}")), "{line}: {said}");
    }
    let files: [(&str, &[u8], &str); 6] = [
        ("empty.csv", b"", "empty, allowed are"),
        (
            "one.csv",
            b"I,4,0,0,0,0,0,-9.8\n",
            "fewer than two inertial samples",
        ),
        (
            "slow.csv",
            b"I,0,0,0,0,0,0,-9.8\nI,100000,0,0,0,0,0,-9.8\n",
            "allowed 200 to 8000 Hz",
        ),
        (
            "head.csv",
            b"t_us,gx,gy\n",
            ":1: no column 'gz', allowed is a table with t_us",
        ),
        ("binary", &[0xFF, 0xFE, 0, 1, b'\n'], ":1: no text"),
        ("long.csv", &[b'1'; 10_000], ":1: a line of 2048 bytes"),
    ];
    for (name, text, wanted) in files {
        temp.write(name, text);
        let said = refused(&temp.0, &[name]);
        assert!(said.contains(name) && said.contains(wanted), "{name}: {said}");
    }
    temp.write("ok.csv", SOUND.lines());
    temp.write("truth.csv", "t_us,vn,ve,vd\n5,0,0,0\n5,0,0,0\n");
    temp.write("none.csv", "t_us,x\n");
    temp.write("bytes.txt", "5 256\n");
    temp.write("back.txt", "5 1\n4 1\n");
    let calls: [(&[&str], &str); 12] = [
        (
            &["ok.csv", "--truth", "truth.csv"],
            "truth.csv:3: t_us 5, allowed is after 5",
        ),
        (
            &["ok.csv", "--truth", "none.csv"],
            "none.csv:1: no truth, allowed is",
        ),
        (&["nowhere.csv"], "nowhere.csv: cannot be read"),
        (
            &["ok.csv", "ok.csv"],
            "unexpected argument 'ok.csv': allowed is one recording",
        ),
        (&["."], "allowed is a file"),
        (
            &["bytes.txt", "--as", "sbus"],
            "bytes.txt:1: byte '256', allowed 0 to 255",
        ),
        (
            &["back.txt", "--as", "crsf"],
            "back.txt:2: time 4, allowed 5 us or later",
        ),
        (
            &["ok.csv", "--as", "sbus", "--from", "3"],
            "--truth and --from are for sensors",
        ),
        (&["ok.csv", "--from", "-1"], "allowed 0 to 1000000 s"),
        (&["ok.csv", "--from", "nan"], "allowed 0 to 1000000 s"),
        (&["ok.csv", "--param", "mass=0"], "allowed"),
        (&["ok.csv", "--param", "no=1"], "no parameter 'no'"),
    ];
    for (args, wanted) in calls {
        let said = refused(&temp.0, args);
        assert!(said.contains(wanted), "{args:?}: {said}");
    }
}
