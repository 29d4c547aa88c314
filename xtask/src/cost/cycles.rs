//! Bounds of a Cortex-M4's cycles for the control path: the manual's times of every instruction that QEMU executes, and
//! the worst case of a flash with wait states.

use std::collections::{HashMap, HashSet};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

use super::instruction::Instruction;
use super::{CORES, Core, qemu};
use crate::image::Image;
use crate::{Error, build};

/// Functions of the counting image, in order.
const STAGES: [&str; 4] = ["filter", "estimator", "control", "mixing"];
/// Uncounted steps of calibration (`hil/qemu/cost/src/inputs.rs`), and counted steps.
const REST: u32 = 2500;
const STEPS: u32 = 1000;
/// Bytes per access to the F405's flash; wait cycles at 168 MHz (RM0090 §3.5).
const LINE: u64 = 16;
const WAIT: u64 = 5;
/// Bytes, M7.
const CACHE_LINE: u64 = 32;

#[derive(Default)]
struct Sum {
    instructions: u64,
    least: u64,
    most: u64,
    /// Entries into another flash line.
    lines: u64,
    constants: u64,
    /// Cache lines with executed code.
    code: HashSet<u64>,
}

/// Single-steps the counting images; prints their flash reads and the bounds of an M4F.
///
/// # Errors
/// No toolchain or QEMU, or an image did not reach the counted steps.
pub fn cycles() -> Result<(), Error> {
    for core in &CORES {
        let elf = core.image()?;
        let sum = execute(core, &elf)?;
        println!("{STEPS} steps on an {}: a step, and an instruction", core.name);
        let row = |what: &str, n: u64| {
            let (step, instruction) = (n as f64 / f64::from(STEPS), n as f64 / sum.instructions as f64);
            println!("{what:24}{step:8.1}  {instruction:5.2}");
        };
        row("instructions", sum.instructions);
        row("constants from flash", sum.constants);
        row("lines of 16 bytes", sum.lines);
        let code = sum.code.len() as u64 * CACHE_LINE;
        println!("code: {code} bytes, in lines of {CACHE_LINE}");
        // An M7 executes at most two at a time, and its caches hold the code.
        if core.name == "M4F" {
            let missed = sum.most + WAIT * (sum.lines + sum.constants);
            row("cycles, at least", sum.least);
            row("cycles, flash at once", sum.most);
            row("cycles, flash never kept", missed);
            let share = |cycles: u64| sum.instructions as f64 / cycles as f64;
            println!(
                "instructions a cycle: {:.2} to {:.2}; {:.2} with no line of the flash ever kept",
                share(sum.most),
                share(sum.least),
                share(missed)
            );
        }
    }
    Ok(())
}

fn execute(core: &Core, elf: &Path) -> Result<Sum, Error> {
    let image = Image::read(elf)?;
    let stages = stages(&image)?;
    let mut command = qemu::command(core, elf);
    command.args(["-singlestep", "-d", "exec,nochain"]);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    eprintln!("{}", build::shown(&command));
    let mut child = qemu::started(&mut command)?;
    let trace = BufReader::new(child.stderr.take().ok_or("QEMU has no stderr")?);

    let mut decoded = HashMap::new();
    let mut sum = Sum::default();
    let mut steps = 0;
    let mut before: Option<(u64, Instruction)> = None;
    let mut inside: Option<u64> = None;
    for line in trace.split(b'\n') {
        let Some(at) = address(&line?) else { continue };
        let instruction = *decoded
            .entry(at)
            .or_insert_with(|| Instruction::of(image.halfword(at), image.halfword(at + 2)));
        if let Some((from, earlier)) = before {
            let next = from + earlier.bytes;
            if inside.is_some() && steps > REST {
                let [least, most] = earlier.cycles(at != next);
                sum.instructions += 1;
                sum.code.insert(from / CACHE_LINE);
                sum.least += u64::from(least);
                sum.most += u64::from(most);
                // An instruction may cross lines.
                let last = (next - 1) / LINE;
                sum.lines += u64::from(from / LINE != last) + u64::from(at / LINE != last);
                sum.constants += u64::from(earlier.constant);
            }
            if inside == Some(at) {
                inside = None;
            } else if inside.is_none() && stages.contains(&at) {
                // The call's cycles are its caller's.
                inside = Some(next);
                steps += u32::from(stages.first() == Some(&at));
                if steps > REST + STEPS {
                    break;
                }
            }
        }
        before = Some((at, instruction));
    }
    child.kill()?;
    child.wait()?;
    if steps <= REST + STEPS {
        return Err(format!("{} steps were executed, {} are wanted", steps, REST + STEPS).into());
    }
    Ok(sum)
}

fn stages(image: &Image) -> Result<Vec<u64>, Error> {
    let names = image.functions.iter().map(|f| {
        let name = format!("{:#}", rustc_demangle::demangle(&f.name));
        (name, f.address)
    });
    let begins: HashMap<String, u64> = names.collect();
    let begin = |stage: &&str| {
        let begin = begins.get(&format!("sophie_cost::chain::{stage}")).copied();
        begin.ok_or_else(|| format!("the counting image has no stage `{stage}`").into())
    };
    STAGES.iter().map(begin).collect()
}

/// Address in a line of QEMU's log: `Trace 0: HOST [BASE/ADDRESS/FLAGS/...] SYMBOL`.
fn address(line: &[u8]) -> Option<u64> {
    let text = std::str::from_utf8(line).ok()?.strip_prefix("Trace ")?;
    let (_, parts) = text.split_once('[')?;
    u64::from_str_radix(parts.split('/').nth(1)?, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_executed_instructions_have_an_address() {
        let line = b"Trace 0: 0x7fa4880081c0 [00800408/00002f2c/00000010/ff020201] known_loop";
        assert_eq!(address(line), Some(0x2F2C));
        assert_eq!(address(b"overhead 8"), None);
        assert_eq!(address(b"Trace 0: nothing"), None);
    }
}
