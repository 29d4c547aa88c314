//! Instructions of the control path on the flashed image, by symbol. Inlined functions count where they were inlined: a
//! task's own share includes its links and records.

mod groups;

use std::collections::BTreeMap;
use std::fmt::Write;

use object::{Object, ObjectSymbol, SymbolKind};

use self::groups::{group_of, names};

/// Steps to count.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// First millisecond since power-on.
    pub from_ms: u64,
    /// Number of steps.
    pub steps: usize,
}

/// Functions of the image by address.
#[derive(Debug, Default)]
pub struct Functions {
    all: Vec<(u64, u64, String)>,
}

impl Functions {
    /// The functions of the ELF in `bytes`.
    ///
    /// # Errors
    /// Not an ELF file.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let file = object::File::parse(bytes).map_err(|e| format!("the image is no ELF file: {e}"))?;
        let functions = file
            .symbols()
            .filter(|s| s.kind() == SymbolKind::Text && s.size() > 0);
        let mut all: Vec<_> = functions
            .filter_map(|s| {
                // Without the Thumb bit.
                let begin = s.address() & !1;
                let name = format!("{:#}", rustc_demangle::demangle(s.name().ok()?));
                Some((begin, begin + s.size(), name))
            })
            .collect();
        all.sort();
        all.dedup_by_key(|(begin, ..)| *begin);
        Ok(Self { all })
    }

    /// Address of the function `name`.
    #[must_use]
    pub fn begin_of(&self, name: &str) -> Option<u64> {
        self.all
            .iter()
            .find(|(.., n)| n == name)
            .map(|(begin, ..)| *begin)
    }

    /// Every possible address.
    pub fn halfwords(&self) -> impl Iterator<Item = u64> {
        self.all
            .iter()
            .flat_map(|(begin, end, _)| (*begin..*end).step_by(2))
    }

    /// Number of the function at `address`.
    #[must_use]
    pub fn at(&self, address: u64) -> usize {
        self.all
            .partition_point(|(begin, ..)| *begin <= address)
            .saturating_sub(1)
    }

    /// Name of function `number`.
    #[must_use]
    pub fn name(&self, number: usize) -> &str {
        self.all.get(number).map_or("?", |(.., name)| name)
    }
}

/// Instructions by function.
pub type Counts = BTreeMap<usize, u64>;

/// A counted step.
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// Instructions from the data-ready handler to the transfer-end handler.
    pub reading: Counts,
    /// Instructions from there to the motor frame.
    pub acting: Counts,
    /// Instruction count at the end of the transfer.
    pub received: u64,
    /// Instructions from there to the frame: the sum of `acting`.
    pub passed: u64,
}

/// All counted steps.
#[derive(Clone, Debug, Default)]
pub struct Counted {
    /// Steps in order.
    pub steps: Vec<Step>,
}

/// Mean and maximum over the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Mean.
    pub mean: f64,
    /// Maximum.
    pub most: u64,
}

impl Share {
    fn of(numbers: impl Iterator<Item = u64> + Clone) -> Self {
        let count = numbers.clone().count().max(1);
        Self {
            mean: numbers.clone().sum::<u64>() as f64 / count as f64,
            most: numbers.max().unwrap_or(0),
        }
    }
}

impl Counted {
    /// From transfer to frame.
    #[must_use]
    pub fn acting(&self) -> Share {
        Share::of(self.steps.iter().map(|step| step.passed))
    }

    /// Tables by part and function after the transfer, by part before.
    #[must_use]
    pub fn tables(&self, functions: &Functions) -> String {
        let mut text = format!("{} steps, instructions of each\n\n", self.steps.len());
        type Part = fn(&Step) -> &Counts;
        let parts: [(&str, Part); 2] = [
            ("end of the sensor's transfer to start of the motor frame", |s| {
                &s.acting
            }),
            ("data-ready to end of the transfer", |s| &s.reading),
        ];
        for (title, counts) in parts {
            let of = |wanted: &dyn Fn(usize) -> bool| {
                let sum = |step: &Step| {
                    counts(step)
                        .iter()
                        .filter(|(f, _)| wanted(**f))
                        .map(|(_, n)| n)
                        .sum::<u64>()
                };
                Share::of(self.steps.iter().map(sum).collect::<Vec<u64>>().into_iter())
            };
            let _ = writeln!(text, "| {title} | mean | max |\n|---|---:|---:|");
            let mut row = |name: &str, share: Share| {
                let _ = writeln!(text, "| {name} | {:.1} | {} |", share.mean, share.most);
            };
            for name in names() {
                row(name, of(&|f| group_of(functions.name(f)) == name));
            }
            row("all", of(&|_| true));
            text.push('\n');
        }
        let mut all: Vec<usize> = self.steps.iter().flat_map(|s| s.acting.keys().copied()).collect();
        all.sort_unstable();
        all.dedup();
        let share = |f: usize| {
            Share::of(
                self.steps
                    .iter()
                    .map(move |s| s.acting.get(&f).copied().unwrap_or(0)),
            )
        };
        let mut rows: Vec<_> = all.into_iter().map(|f| (share(f), functions.name(f))).collect();
        rows.sort_by(|(a, _), (b, _)| b.mean.total_cmp(&a.mean));
        for (share, name) in rows {
            let _ = writeln!(
                text,
                "{:8.1} {:6}  {}: {name}",
                share.mean,
                share.most,
                group_of(name)
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn functions() -> Functions {
        Functions {
            all: vec![
                (
                    0x100,
                    0x180,
                    "sophie_control::attitude::rate_loop::step".to_owned(),
                ),
                (0x180, 0x200, "memcpy".to_owned()),
                (0x400, 0x402, "EXTI2".to_owned()),
            ],
        }
    }

    #[test]
    fn an_address_belongs_to_the_function_before_it() {
        let functions = functions();
        let names = [0x100, 0x17E, 0x180, 0x1FE, 0x400].map(|at| functions.name(functions.at(at)));
        assert_eq!(names[..2], ["sophie_control::attitude::rate_loop::step"; 2]);
        assert_eq!(names[2..], ["memcpy", "memcpy", "EXTI2"]);
        assert_eq!(functions.begin_of("EXTI2"), Some(0x400));
        assert_eq!(functions.halfwords().count(), 0x40 + 0x40 + 1);
    }

    #[test]
    fn the_parts_add_up_to_the_whole() {
        let step = |law, copy| Step {
            acting: Counts::from([(0, law), (1, copy)]),
            passed: law + copy,
            ..Step::default()
        };
        let counted = Counted {
            steps: vec![step(100, 20), step(104, 40)],
        };
        assert_eq!(
            counted.acting(),
            Share {
                mean: 132.0,
                most: 144
            }
        );
        let tables = counted.tables(&functions());
        for row in [
            "| laws | 102.0 | 104 |",
            "| copies | 30.0 | 40 |",
            "| all | 132.0 | 144 |",
        ] {
            assert!(tables.contains(row), "{row}: {tables}");
        }
    }
}
