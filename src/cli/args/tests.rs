use sophie_control::allocation::wrench::Configuration;
use sophie_control::pilot::rc::ArmChoice;
use sophie_sim::mixers::Variant;

use super::*;

fn args(line: &str) -> Result<FlyArgs, String> {
    match parse_from(["sophie"].into_iter().chain(line.split_whitespace())).map_err(|m| m.line())? {
        Task::Fly(fly) => Ok(fly),
        other => Err(format!("{other:?}")),
    }
}

#[test]
fn clap_agrees_with_the_definition() {
    use clap::CommandFactory;
    Cli::command().debug_assert();
}

#[test]
fn fly_may_be_left_out() {
    for line in [
        "--infill 8 --arms 2 x.toml",
        "fly x.toml --rho 8 --arms front",
        "fly --arms 2 --infill=8 x.toml",
    ] {
        let fly = args(line).unwrap();
        assert_eq!(fly.mission.scenario, Some(PathBuf::from("x.toml")), "{line}");
        let o = fly.mission.overrides();
        assert_eq!(
            (o.infill, o.arms, o.seed),
            (Some(8.0), Some(ArmChoice::Front), None),
            "{line}"
        );
    }
    let fly = args("").unwrap();
    assert!(fly.mission.scenario.is_none() && !fly.json && fly.out.as_os_str() == "out");
    assert!(!fly.no_files && args("--no-files --json").unwrap().no_files);
    let o = args("--config a --mixer paper --gain-k 1 --seed 9 --json")
        .unwrap()
        .mission
        .overrides();
    assert_eq!(
        (o.configuration, o.mixer),
        (Some(Configuration::A), Some(Variant::Paper))
    );
    assert_eq!((o.gain_k, o.seed), (Some(1.0), Some(9)));
}

#[test]
fn refusals_are_one_line_that_says_what_is_allowed() {
    for (line, message) in [
        (
            "--infill 3.5",
            "invalid value '3.5' for '--rho <PERCENT>': allowed 4 to 10 %",
        ),
        (
            "--rho -1",
            "invalid value '-1' for '--rho <PERCENT>': allowed 4 to 10 %",
        ),
        (
            "--seed -1",
            "invalid value '-1' for '--seed <N>': allowed a whole number from 0 to 9e15",
        ),
        (
            "--seed 18446744073709551615",
            "invalid value '18446744073709551615' for '--seed <N>': allowed a whole number from 0 to 9e15",
        ),
        (
            "study vehicles --seed 9e15 --count 2",
            "invalid value '9000000000000000' for '--seed <N>': the last of 2 vehicles has seed 9000000000000001: allowed a whole number from 0 to 9e15",
        ),
        (
            "capture --seed 8999999999999991 --touches 11",
            "invalid value '8999999999999991' for '--seed <N>': the last of 11 touches has seed 9000000000000001: allowed a whole number from 0 to 9e15",
        ),
        (
            "a.toml b.toml",
            "unexpected argument 'b.toml': allowed is one scenario file",
        ),
        (
            "fly a.toml b.toml",
            "unexpected argument 'b.toml': allowed is one scenario file",
        ),
        (
            "--gain-k NaN",
            "invalid value 'NaN' for '--gain-k <K>': allowed 1 to 10",
        ),
        (
            "--config C",
            "invalid value 'C' for '--config <A|B>': allowed A, B",
        ),
        (
            "--mixer best",
            "invalid value 'best' for '--mixer <NAME>': allowed flexible, rigid, paper, frozen",
        ),
        (
            "--live --speed 0",
            "invalid value '0' for '--speed <X>': allowed 0.01 to 1000",
        ),
        (
            "--live --speed nan",
            "invalid value 'nan' for '--speed <X>': allowed 0.01 to 1000",
        ),
        (
            "--live --mavlink 127.0.0.1",
            "invalid value '127.0.0.1' for '--mavlink <ADDR:PORT>': allowed the address of one machine and its port, \
             such as 127.0.0.1:14550",
        ),
        (
            "--live --mavlink 255.255.255.255:14550",
            "invalid value '255.255.255.255:14550' for '--mavlink <ADDR:PORT>': allowed the address of one machine \
             and its port, such as 127.0.0.1:14550",
        ),
        (
            "--live --pilot me",
            "invalid value 'me' for '--pilot <none>': allowed none",
        ),
        (
            "--arms 3",
            "invalid value '3' for '--arms <2|4|rear>': allowed 4 or all, 2 or front, rear",
        ),
    ] {
        assert_eq!(args(line).unwrap_err(), message);
    }
    for line in [
        "--seed x",
        "--seed 1.5",
        "--seed nan",
        "--infil 6",
        "--out",
        "--infill 6 --infill 7",
        "--speed 2",
        "--mavlink 127.0.0.1:14550",
        "--pilot none",
        "--live --pilot none --json",
        "--no-files --out x",
        "--live --mavlink 127.0.0.1:0",
        "--live --mavlink 0.0.0.0:14550",
        "--live --mavlink 224.0.0.1:14550",
    ] {
        let message = args(line).unwrap_err();
        assert!(
            !message.contains('\n') && message.len() < 200 && !message.contains("Usage"),
            "{message}"
        );
    }
}
