//! Every message of a bad scenario, word for word.

use std::path::Path;

use super::*;

#[test]
fn bad_values_name_file_line_key_value_and_allowed_range() {
    for (text, line) in [
        (
            "[vehicle]\n\ninfill = 3.5",
            "perch.toml:3: vehicle.infill = 3.5: allowed 4 to 10 %",
        ),
        (
            "[vehicle]\ninfill = nan",
            "perch.toml:2: vehicle.infill = nan: allowed 4 to 10 %",
        ),
        (
            "[vehicle]\ninfill = 'soft'",
            "perch.toml:2: vehicle.infill = 'soft': allowed 4 to 10 %",
        ),
        (
            "vehicle = 3",
            "perch.toml:1: vehicle = 3: allowed a table, written [vehicle]",
        ),
        (
            "mixer = 'best'",
            "perch.toml:1: mixer = 'best': allowed flexible, rigid, paper, frozen",
        ),
        ("arms = 4", "perch.toml:1: arms = 4: allowed all, front, rear"),
        (
            "seed = -1",
            "perch.toml:1: seed = -1: allowed a whole number from 0 to 9e15",
        ),
        (
            "seed = 9000000000000001",
            "perch.toml:1: seed = 9000000000000001: allowed a whole number from 0 to 9e15",
        ),
        (
            "seed = 1.5",
            "perch.toml:1: seed = 1.5: allowed a whole number from 0 to 9e15",
        ),
        (
            "name = \"a\\nb\"",
            "perch.toml:1: name = \"a\\nb\": allowed one line of text",
        ),
        (
            "[vehicle]\narm_gain = [1, 1, 1]",
            "perch.toml:2: vehicle.arm_gain = [1, 1, 1]: allowed four numbers, each 0.5 to 1.5",
        ),
        (
            "[vehicle]\narm_gain = [1, 1,\n 9, 1]",
            "perch.toml:3: vehicle.arm_gain = 9: allowed 0.5 to 1.5",
        ),
        (
            "[vehicle]\ninertia_kgm2 = [0.02, 0.04]",
            "perch.toml:2: vehicle.inertia_kgm2 = [0.02, 0.04]: allowed three numbers for roll, pitch and yaw: \
             0.012 to 0.1 kg m2, 0.012 to 0.1 kg m2, 0.024 to 0.2 kg m2",
        ),
        (
            "[vehicle]\ninertia_kgm2 = [0.02, 0.04, 0.02]",
            "perch.toml:2: vehicle.inertia_kgm2 = 0.02: allowed 0.024 to 0.2 kg m2",
        ),
        (
            "[vehicle]\ncoupled_arms = 1",
            "perch.toml:2: vehicle.coupled_arms = 1: allowed true or false",
        ),
        (
            "[faults]\ntilt = ['sound', 'sound', 'lost', 'sound']",
            "perch.toml:2: faults.tilt = 'lost': allowed sound, silent, stuck",
        ),
        (
            "[faults]\npressure = 'open'",
            "perch.toml:2: faults.pressure = 'open': allowed four words, each sound, open, short, stuck",
        ),
        (
            "[faults]\ntendon_slack_mm = [0, 0, 0, 21]",
            "perch.toml:2: faults.tendon_slack_mm = 21: allowed -10 to 20 mm",
        ),
        (
            "[pilot]\nbelieves_pipe_top_m = 0.2",
            "perch.toml:2: pilot.believes_pipe_top_m = 0.2: allowed 0.5 to 10 m",
        ),
        (
            "[params]\nrate_pitch_p = 99",
            "perch.toml:2: params.rate_pitch_p = 99: allowed 0 to 40 1/s",
        ),
        (
            "[params]\ngain_k = 0",
            "perch.toml:2: params.gain_k = 0: allowed 1 to 10",
        ),
        (
            "[params]\nrate_pitch_p = true",
            "perch.toml:2: params.rate_pitch_p = true: allowed 0 to 40 1/s",
        ),
        (
            "[params]\nrc_protocol = 0.4",
            "perch.toml:2: params.rc_protocol = 0.4: allowed one of 0 crsf, 1 sbus",
        ),
        (
            "[params]\nrc_protocol = 'sbos'",
            "perch.toml:2: params.rc_protocol = 'sbos': allowed one of 0 crsf, 1 sbus",
        ),
        (
            "[params]\nimu_rate = ''",
            "perch.toml:2: params.imu_rate = '': allowed one of 1000, 2000, 4000, 8000 Hz",
        ),
        (
            "[params]\nsetpoint_cutoff = 500",
            "perch.toml:2: params.setpoint_cutoff = 500: allowed 0.15 to 16 Hz as params.setpoint_lpf_hz",
        ),
        (
            "[params]\nperch_thr_max = 0.3\nperch_throttle_max = 0.4",
            "perch.toml:3: params.perch_throttle_max = 0.4: allowed one of the two, it is params.perch_thr_max now",
        ),
        (
            "[world]\npipe_top_m = 0.6\npipe_diameter_m = 0.5",
            "perch.toml:2: world.pipe_top_m = 0.6: \
             allowed pipe_top_m at least 0.2 m above pipe_diameter_m, here 0.700 m",
        ),
    ] {
        assert_eq!(complaint(text), line);
    }
}

#[test]
fn unknown_keys_name_the_nearest() {
    for (text, line) in [
        (
            "[vehicle]\ninfil = 6",
            "perch.toml:2: vehicle.infil = 6: unknown key: nearest allowed vehicle.infill",
        ),
        (
            "[world]\npipe_top = 2",
            "perch.toml:2: world.pipe_top = 2: unknown key: nearest allowed world.pipe_top_m",
        ),
        (
            "infill = 6",
            "perch.toml:1: infill = 6: unknown key: nearest allowed vehicle.infill",
        ),
        (
            "[vehicel]\n",
            "perch.toml:1: vehicel = [vehicel]: unknown key: nearest allowed vehicle",
        ),
        (
            "[params]\nrate_pp = 1",
            "perch.toml:2: params.rate_pp = 1: unknown key: nearest allowed params.rate_d, params.rate_max, \
             params.rate_yaw_p",
        ),
        (
            "steps = [{ do = 'arm' }, { do = 'take-off', height = 2 }]",
            "perch.toml:1: steps[1].height = 2: unknown key: nearest allowed steps[1].height_m",
        ),
    ] {
        assert_eq!(complaint(text), line);
    }
}

#[test]
fn steps_must_make_a_mission() {
    for (text, line) in [
        (
            "steps = []",
            "perch.toml:1: steps = []: allowed at least one step, such as arm",
        ),
        (
            "steps = 'arm'",
            "perch.toml:1: steps = 'arm': allowed a list such as [{ do = \"arm\" }]",
        ),
        (
            "steps = ['arm']",
            "perch.toml:1: steps[0] = 'arm': allowed a table such as { do = \"arm\" }",
        ),
        (
            "steps = [\n  { do = 'arm' },\n  { do = 'perch' },\n]",
            "perch.toml:3: steps[1] = perch: allowed only touching the pipe or closing its arms on the pipe, \
             but here the vehicle is on the ground, armed",
        ),
        (
            "steps = [{ do = 'hover' }]",
            "perch.toml:1: steps[0] = hover: allowed only in free flight or over the pipe \
             or sinking without a radio, but here the vehicle is on the ground, disarmed",
        ),
        (
            "steps = [{ do = 'arm' }, { do = 'take-off', height_m = 99 }]",
            "perch.toml:1: steps[1].height_m = 99: allowed 0.5 to 30 m",
        ),
        (
            "steps = [{ do = 'radio-off' }]",
            "perch.toml:1: steps[0] = radio-off: allowed only in free flight or closing its arms on the pipe \
             or clamped to the pipe, but here the vehicle is on the ground, disarmed",
        ),
        (
            "steps = [{ do = 'arm' }, { do = 'take-off' }, { do = 'radio-off', seconds = 2 }, { do = 'land' }]",
            "perch.toml:1: steps[3] = land: allowed only in free flight, \
             but here the vehicle is sinking without a radio",
        ),
    ] {
        assert_eq!(complaint(text), line);
    }
    assert!(
        complaint("steps = [{ height_m = 1 }]")
            .starts_with("perch.toml:1: steps[0].do is missing: allowed arm, ")
    );
    assert!(
        complaint("steps = [{ do = 'fly' }]").starts_with("perch.toml:1: steps[0].do = 'fly': allowed arm, ")
    );
}

#[test]
fn invalid_toml_is_refused_in_one_line() {
    for text in [
        "infill = ",
        "[vehicle",
        "a = 1\na = 2",
        "{",
        "steps = [",
        "\u{0}",
        "x = \"\n\"",
        "[vehicle]\n[vehicle]",
    ] {
        let error = parse(text).expect_err(text);
        assert!(matches!(error, ScenarioError::Syntax { .. }), "{text}: {error:?}");
        assert!(complaint(text).contains(": not valid TOML: "), "{text}");
    }
    assert!(complaint("seed = 1\nseed = 2").starts_with("perch.toml:2: not valid TOML: "));
}

#[test]
fn unreadable_files_are_refused_in_one_line() {
    let load = |path: &Path| Scenario::load(path, &Overrides::default()).expect_err("refused");
    let missing = load(Path::new("no/such/file.toml"));
    assert!(
        missing
            .to_string()
            .starts_with("no/such/file.toml: cannot be read: No such file"),
        "{missing}"
    );
    let directory = load(Path::new("."));
    assert_eq!(
        directory.to_string(),
        ".: cannot be read: it is a directory; allowed is a TOML file"
    );
    let file = std::env::temp_dir().join(format!("sophie-{}-latin1.toml", std::process::id()));
    std::fs::write(&file, b"seed = 1\nname = \"caf\xe9\"\n").unwrap();
    let latin = load(&file);
    std::fs::remove_file(&file).unwrap();
    assert_eq!(
        latin.to_string(),
        format!("{}:2: not UTF-8 text: allowed is a TOML file", file.display())
    );
}

#[test]
fn a_name_from_the_file_s_own_is_one_printable_line() {
    let name = format!("sophie-{}-\x1b[31mred\nline.toml", std::process::id());
    let file = std::env::temp_dir().join(name);
    std::fs::write(&file, "steps = [{ do = \"arm\" }, { do = \"disarm\" }]\n").unwrap();
    let scenario = Scenario::load(&file, &Overrides::default()).unwrap();
    std::fs::remove_file(&file).unwrap();
    assert_eq!(
        scenario.name,
        format!("sophie-{}- [31mred line", std::process::id())
    );
}

#[test]
fn long_and_odd_values_stay_on_one_line() {
    let line = complaint(&format!("[vehicle]\ninfill = \"{}\"", "x".repeat(5000)));
    assert!(line.len() < 200, "{line}");
    complaint("\"a\\nb\" = 1");
    complaint("steps = [{ do = \"\"\"arm\nland\"\"\" }]");
}

#[test]
fn no_damage_to_a_file_makes_more_than_one_line() {
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let (mut good, mut bad) = (0, 0);
    for _ in 0..3000 {
        let mut text: Vec<char> = MISSION.chars().collect();
        for _ in 0..=random(3) {
            let at = random(text.len());
            match random(3) {
                0 => text[at] = ['"', '[', '\n', '9', '-', '=', 'é', '\0', '.', '}'][random(10)],
                1 => drop(text.remove(at)),
                _ => drop(text.drain(at..(at + 1 + random(40)).min(text.len()))),
            }
        }
        match parse(&text.into_iter().collect::<String>()) {
            Ok(_) => good += 1,
            Err(error) => {
                bad += 1;
                let line = error.to_string();
                assert!(
                    line.starts_with("perch.toml:") && !line.contains('\n') && line.len() < 800,
                    "{line}"
                );
            }
        }
    }
    assert!(good > 100 && bad > 100, "{good} {bad}");
}

#[test]
fn coefficients_that_give_no_arm_are_refused_with_their_key() {
    let vehicle = |numbers: &str| complaint(&format!("[vehicle]\n{numbers}\n"));
    assert_eq!(
        vehicle("arm_coefficients = [-10, -10, -10, -10]"),
        "perch.toml:2: vehicle.arm_coefficients = [-10, -10, -10, -10]: allowed a tilt that rises without thrust by at \
         least 0.10 deg/N, here -612.250 at infill 6.9000 % and gain_k 7.7500"
    );
    // The same slope, whichever number spoils it: infill beyond the coefficients, soft arm, hover.
    let falls =
        "perch.toml:2: vehicle.arm_coefficients = [1, -0.14, 0, 0]: allowed a tilt that rises without thrust";
    let text = "[vehicle]\narm_coefficients = [1, -0.14, 0, 0]\n";
    assert!(parse(text).is_ok());
    let rho = |infill| Overrides {
        infill: Some(infill),
        ..Default::default()
    };
    let line = Scenario::parse(text, "perch.toml", &rho(8.0))
        .unwrap_err()
        .to_string();
    assert!(
        line.starts_with(falls) && line.contains("infill 8.0000 %"),
        "{line}"
    );
    let gain = Overrides {
        gain_k: Some(1.0),
        ..Default::default()
    };
    let line = Scenario::parse(text, "perch.toml", &gain)
        .unwrap_err()
        .to_string();
    assert!(
        line.starts_with(falls) && line.contains("here 0.034 at infill 6.9000 % and gain_k 1.0000"),
        "{line}"
    );
    let line = vehicle("arm_coefficients = [2, 0, -0.3, 0]");
    assert!(
        line.contains("still rises at hover, 4.43 N a rotor, here by -5.077"),
        "{line}"
    );
    let line = vehicle("arm_coefficients = [30, 0, 0, 0]");
    assert!(line.contains("within 90 deg from no thrust to 8.3 N"), "{line}");
    assert!(
        vehicle("arm_level_share = -0.5\nthrust_max_n = 20")
            .starts_with("perch.toml:2: vehicle.arm_level_share = -0.5")
    );
    let line = complaint("[params]\narm_a1 = -1\n");
    assert!(
        line.starts_with("perch.toml:2: params.arm_a1 = -1: allowed a tilt that rises without thrust"),
        "{line}"
    );
    for infill in [4.0, 6.9, 10.0] {
        for gain_k in [1.0, 7.75, 10.0] {
            let overrides = Overrides {
                infill: Some(infill),
                gain_k: Some(gain_k),
                ..Default::default()
            };
            assert!(
                Scenario::parse("", "perch.toml", &overrides).is_ok(),
                "{infill} {gain_k}"
            );
        }
    }
}
