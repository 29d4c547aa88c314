//! Identifies the rotor and its direction of rotation at each output: spins the outputs in turn and asks the builder.
//! The resulting order goes into `motor_map`.

use embassy_time::Duration;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::params::{MotorMap, Params};
use sophie_control::pilot::bench_orders::{BenchOrder, SPIN_DRIVE, SPIN_TIME, Spin};

use super::Console;
use super::bench::End;
use sophie_control::maths::decimal::Decimal;
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

/// Time-out of the builder's answer.
pub(super) const ANSWER: Duration = Duration::from_secs(60);

/// Position of each rotor, and whether it turns clockwise seen from above.
const ROTORS: [(&str, bool); 4] = [
    ("front-left", false),
    ("rear-left", true),
    ("front-right", true),
    ("rear-right", false),
];

/// The builder's answer about one output.
#[derive(Clone, Copy)]
struct Seen {
    /// Rotor that turned, 0 to 3; `None` for none.
    rotor: Option<usize>,
    clockwise: bool,
}

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    /// Spins each motor in turn, asks for rotor and direction, puts the order into the working copy, and lists the
    /// motors whose wires must be swapped.
    pub(super) async fn rotors(&mut self) {
        self.out
            .line(format_args!(
                "1 front-left, 2 rear-left, 3 front-right, 4 rear-right; r once more, any other key ends"
            ))
            .await;
        let mut seen = [Seen {
            rotor: None,
            clockwise: false,
        }; 4];
        let in_force = self.links.params.motor_map.rotors();
        for (output, (slot, rotor)) in seen.iter_mut().zip(in_force).enumerate() {
            match self.look_at(output, rotor).await {
                Some(answer) => *slot = answer,
                None => return self.out.line(format_args!("ended: nothing is changed")).await,
            }
        }
        self.judge(&seen).await;
    }

    /// Spins the motor at `output` (`rotor` in the map in force) until the builder answers; `None` aborts the
    /// procedure.
    async fn look_at(&mut self, output: usize, rotor: usize) -> Option<Seen> {
        let (number, seconds) = (output + 1, Decimal(SPIN_TIME));
        loop {
            let spin = Spin::at(rotor, SPIN_DRIVE);
            let begun = format_args!("output {number} turns for {seconds} s");
            match self.order(BenchOrder::Spin(spin), begun).await {
                End::Done => (),
                end => {
                    self.say_end(format_args!("output {number} stopped"), end).await;
                    return None;
                }
            }
            let rotor = match self.ask("which rotor turned, 1 to 4, or 0 for none? ").await? {
                b'r' => continue,
                b'0' => None,
                key @ b'1'..=b'4' => Some(usize::from(key - b'1')),
                _ => return None,
            };
            let clockwise = match rotor {
                None => false,
                Some(_) => match self
                    .ask("from above, clockwise (c) or anticlockwise (a)? ")
                    .await?
                {
                    b'r' => continue,
                    b'c' => true,
                    b'a' => false,
                    _ => return None,
                },
            };
            return Some(Seen { rotor, clockwise });
        }
    }

    async fn judge(&mut self, seen: &PerArm<Seen>) {
        let in_force = self.links.params.motor_map;
        let mut wrong = 0;
        for (output, (answer, wanted)) in seen.iter().zip(in_force.rotors()).enumerate() {
            wrong += u8::from(!self.judge_one(output + 1, answer, wanted, seen).await);
        }
        // An output without a rotor gets an index out of range, which makes the order invalid.
        let found = seen.map(|answer| answer.rotor.unwrap_or(seen.len()));
        let map = MotorMap::of(found).filter(|map| *map != in_force || *map != self.params.motor_map);
        if let Some((map, row)) = map.zip(Params::row("motor_map")) {
            self.put(row, map.number()).await;
        }
        let last = match (wrong, map) {
            (0, _) => "all rotors as they should",
            (_, Some(_)) => "after 'save', and any swap with the battery off, say 'rotors' again",
            (_, None) => "after the change, battery off meanwhile, say 'rotors' again",
        };
        self.out.line(format_args!("{last}")).await;
    }

    /// Prints the answer about output `number`; true if it is the rotor `wanted` with the correct direction.
    async fn judge_one(&mut self, number: usize, answer: &Seen, wanted: usize, seen: &PerArm<Seen>) -> bool {
        let Seen {
            rotor: Some(rotor),
            clockwise,
        } = *answer
        else {
            self.out
                .line(format_args!(
                    "output {number}: nothing turned; see 'calibrate esc'"
                ))
                .await;
            return false;
        };
        let (turned, (place, turns_clockwise)) = (rotor + 1, ROTORS.get(rotor).copied().unwrap_or_default());
        let twice = seen.iter().filter(|other| other.rotor == Some(rotor)).count() > 1;
        let reversed = clockwise != turns_clockwise;
        let right = rotor == wanted && !reversed && !twice;
        if twice {
            self.out
                .line(format_args!(
                    "output {number}: rotor {turned} was named twice; say 'rotors' again"
                ))
                .await;
        } else {
            let verdict = if right { ", as it should" } else { "" };
            self.out
                .line(format_args!("output {number}: rotor {turned}, {place}{verdict}"))
                .await;
        }
        if reversed {
            let way = if turns_clockwise {
                "clockwise"
            } else {
                "anticlockwise"
            };
            self.out
                .line(format_args!(
                    "output {number}: rotor {turned} must turn {way}; swap two of its motor's three wires"
                ))
                .await;
        }
        right
    }

    /// Asks `question` and returns the key; `None` on time-out.
    pub(super) async fn ask(&mut self, question: &str) -> Option<u8> {
        self.out.resume();
        self.out.bytes(question.as_bytes()).await;
        let key = self.keys.key(ANSWER).await;
        let shown = key.filter(u8::is_ascii_graphic).map_or(' ', char::from);
        self.out.line(format_args!("{shown}")).await;
        key
    }
}
