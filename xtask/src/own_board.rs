//! The custom board of docs/porting.md: a copy of the reference board in a scratch folder, built and checked.
//!
//! It touches only the files named there, uses shared code by chip, and has what no board here has: motors on two
//! timers in another order, a pin that switches the sensors' supply. It fits no real board.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::boards::{self, Board};
use crate::build::Recipe;
use crate::toolchain::{self, TARGET};
use crate::{Error, build};

const NAME: &str = "own-h743";
/// Has a feature that names no chip: must not build.
const CHIPLESS: &str = "chipless-h743";
/// Version of the workspace, without the closing quote, and the copy's suffix.
const VERSION: &str = concat!("version = \"", env!("CARGO_PKG_VERSION"));
const OF_THE_COPY: &str = "-copy";
const ORIGINAL: &str = "matek-h743";

/// In the board file: old and new.
const CHANGES: [(&str, &str); 9] = [
    ("    name: \"matek-h743\";", "    name: \"own-h743\";"),
    (
        "BusErrors, EscTimer, Lamp,",
        "BusErrors, EscTimer, EscTimers, hold, Lamp,",
    ),
    (
        "        DMA2_STREAM0 =>",
        "        DMA1_STREAM5 => dma::InterruptHandler<peripherals::DMA1_CH5>;\n        DMA2_STREAM0 =>",
    ),
    (
        "        timer: TIM4,\n        motor_1: PD12,\n        motor_2: PD13,\n        motor_3: PD14,\n        motor_4: PD15,\n",
        "        timer: TIM4,\n        motor_1: PD15,\n        motor_4: PD12,\n        second: TIM3,\n        motor_2: PC9,\n        \
         motor_3: PC8,\n        more_dma: DMA1_CH5,\n",
    ),
    (
        "    motors: EscTimer<peripherals::TIM4, peripherals::DMA1_CH0, Irqs>;\n",
        "    motors: EscTimers<EscTimer<peripherals::TIM4, peripherals::DMA1_CH0, Irqs>, \
         EscTimer<peripherals::TIM3, peripherals::DMA1_CH5, Irqs>> = {\n        let m = parts.motors;\n        \
         let protocol = sophie_drivers::esc_protocol::EscProtocol::from_params(params);\n        EscTimers::new(\n            \
         EscTimer::first(m.timer, m.dma, Irqs, protocol).motor(0, m.motor_1).motor(3, m.motor_4),\n            \
         EscTimer::second(m.second, m.more_dma, Irqs, protocol).motor(1, m.motor_2).motor(2, m.motor_3),\n        )\n    };\n",
    ),
    (
        "pub const MOTORS_LOW: [PortLevels; 1] = [PortLevels::new(pac::GPIOD, &[12, 13, 14, 15], &[])];\n",
        "pub const MOTORS_LOW: [PortLevels; 2] = [\n    PortLevels::new(pac::GPIOD, &[12, 15], &[]),\n    \
         PortLevels::new(pac::GPIOC, &[8, 9], &[]),\n];\n",
    ),
    (
        "pub const FIRST_LEVELS: [PortLevels; 3] = [\n    MOTORS_LOW[0],\n",
        "pub const FIRST_LEVELS: [PortLevels; 4] = [\n    MOTORS_LOW[0],\n    MOTORS_LOW[1],\n",
    ),
    (
        "    motors: MotorParts {",
        "    supply: SupplyParts {\n        sensors: PE5,\n    }\n    motors: MotorParts {",
    ),
    (
        "    storage: ParamFlash<0x2_0000> =",
        "    first: {\n        hold(parts.supply.sensors.into(), Level::High);\n        \
         embassy_time::Timer::after_millis(100).await;\n    };\n    storage: ParamFlash<0x2_0000> =",
    ),
];

/// Builds and checks the copy, and that one without chip is refused.
///
/// # Errors
/// The copy does not build, its image is wrong, or a board that names no chip builds.
pub fn own_board() -> Result<(), Error> {
    let scratch = build::root().join("target/own-board");
    copy(build::root(), &scratch)?;
    write(&scratch)?;

    let original = boards::find(ORIGINAL).ok_or("no reference board")?;
    let board = Board {
        name: NAME,
        ..*original
    };
    let recipe = Recipe {
        package: "sophie",
        arguments: &["--features", NAME],
        variables: &[],
        core: board.core,
        kept: NAME,
    };
    let elf = build::image_in(&scratch, &recipe)?;
    crate::check(&board, &elf)?;

    let toolchain = toolchain::find()?;
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .current_dir(&scratch)
        .args(["check", "--locked", "--package", "sophie", "--target", TARGET]);
    cargo
        .args(["--profile", "firmware", "--features", CHIPLESS])
        .args(toolchain.arguments);
    cargo
        .envs(toolchain.variables)
        .env("CARGO_TARGET_DIR", build::target_dir());
    let output = cargo.output()?;
    let complaint = String::from_utf8_lossy(&output.stderr);
    let wanted = format!("the feature {CHIPLESS} of boards/Cargo.toml names 0 chips");
    if output.status.success() || !complaint.contains(&wanted) {
        return Err(
            format!("a board whose feature names no chip is not refused for that:\n{complaint}").into(),
        );
    }
    eprintln!("{NAME}: builds with what its chip needs; a board that names no chip does not");
    Ok(())
}

fn write(scratch: &Path) -> Result<(), Error> {
    let folder = scratch.join("boards");
    let mut file = fs::read_to_string(folder.join("src/matek_h743.rs"))?;
    for (old, new) in CHANGES {
        replace(&mut file, old, new)?;
    }
    let map = fs::read(folder.join(format!("memory/{ORIGINAL}.x")))?;
    let mut image = fs::read_to_string(scratch.join("Cargo.toml"))?;
    let mut features = fs::read_to_string(folder.join("Cargo.toml"))?;
    let mut list = fs::read_to_string(folder.join("src/board.rs"))?;
    for (name, chip) in [(NAME, "stm32h743vi"), (CHIPLESS, "embassy-stm32/stm32h743vi")] {
        put(
            &folder.join(format!("src/{}.rs", name.replace('-', "_"))),
            file.as_bytes(),
        )?;
        put(&folder.join(format!("memory/{name}.x")), &map)?;
        let anchor = "# Every event of the executors";
        let line = format!("{name} = [\"sophie-boards/{name}\"]\n{anchor}");
        replace(&mut image, anchor, &line)?;
        let anchor = "# A chip, one for each board";
        let line = format!("{name} = [\"{chip}\", \"embassy-stm32/time-driver-tim2\"]\n{anchor}");
        replace(&mut features, anchor, &line)?;
        let anchor = "#[cfg_attr(feature = \"f405\"";
        let path = name.replace('-', "_");
        let line = format!("#[cfg_attr(feature = \"{name}\", path = \"{path}.rs\")]\n{anchor}");
        replace(&mut list, anchor, &line)?;
    }
    // A version of its own: both workspaces build into one folder to share external crates, and cargo would mix up
    // their artefacts.
    replace(&mut image, VERSION, &format!("{VERSION}{OF_THE_COPY}"))?;
    let lock = fs::read_to_string(scratch.join("Cargo.lock"))?;
    put(&scratch.join("Cargo.lock"), locked(&lock).as_bytes())?;
    put(&scratch.join("Cargo.toml"), image.as_bytes())?;
    put(&folder.join("Cargo.toml"), features.as_bytes())?;
    put(&folder.join("src/board.rs"), list.as_bytes())?;
    Ok(())
}

/// The lock file with the copy's version at the workspace's packages, which alone have no source.
fn locked(lock: &str) -> String {
    let packages = lock.split("\n\n").map(|package| {
        if package.contains("\nsource = ") {
            return package.to_string();
        }
        package.replace(VERSION, &format!("{VERSION}{OF_THE_COPY}"))
    });
    packages.collect::<Vec<_>>().join("\n\n")
}

fn replace(text: &mut String, old: &str, new: &str) -> Result<(), Error> {
    if text.matches(old).count() != 1 {
        return Err(
            format!("the copy of a board looks for this once and does not find it so:\n{old}").into(),
        );
    }
    *text = text.replace(old, new);
    Ok(())
}

/// Leaves out build results and hidden files; unchanged files keep their times, and so their build results.
fn copy(from: &Path, to: &Path) -> Result<(), Error> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let name = entry.file_name();
        if name == "target" || name.to_string_lossy().starts_with('.') {
            continue;
        }
        let target: PathBuf = to.join(&name);
        if entry.file_type()?.is_dir() {
            copy(&entry.path(), &target)?;
        } else {
            put(&target, &fs::read(entry.path())?)?;
        }
    }
    Ok(())
}

fn put(path: &Path, content: &[u8]) -> Result<(), Error> {
    if fs::read(path).is_ok_and(|old| old == content) {
        return Ok(());
    }
    fs::write(path, content)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_package_of_the_copy_and_no_other_has_the_copys_version() {
        let lock = fs::read_to_string(build::root().join("Cargo.lock")).unwrap();
        let ours = |text: &str| text.matches(&format!("{VERSION}{OF_THE_COPY}\"")).count();
        let crates = lock.split("\n\n").filter(|package| {
            !package.contains("\nsource = ") && package.contains(&format!("\n{VERSION}\""))
        });
        let count = crates.count();
        assert!(count > 10 && ours(&lock) == 0 && ours(&locked(&lock)) == count);
        assert_eq!(locked(&lock).replace(OF_THE_COPY, ""), lock);
    }
}
