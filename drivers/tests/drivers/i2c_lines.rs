//! Frees a bus held by a chip cut off within a byte.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use super::fake::run;
use embassy_time::Instant;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use sophie_drivers::i2c_lines::{Lines, free};

#[derive(Default)]
struct Wires {
    master_clock_low: bool,
    master_data_low: bool,
    /// Bits still to send, the next one last.
    bits: Vec<bool>,
    /// Short to ground.
    clock_shorted: bool,
    data_shorted: bool,
    /// Clock reads for which the chip stretches each clock.
    stretch: u32,
    stretched: u32,
    clocks: u32,
    stops: u32,
}

impl Wires {
    fn clock(&self) -> bool {
        !self.master_clock_low && !self.clock_shorted
    }

    fn data(&self) -> bool {
        !self.master_data_low && !self.data_shorted && self.bits.last() != Some(&false)
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Which {
    Clock,
    Data,
}

struct Line(Rc<RefCell<Wires>>, Which);

impl ErrorType for Line {
    type Error = Infallible;
}

impl OutputPin for Line {
    fn set_low(&mut self) -> Result<(), Infallible> {
        let mut w = self.0.borrow_mut();
        match self.1 {
            Which::Clock => {
                if !w.master_clock_low {
                    // The chip changes its bit while the clock is low.
                    w.bits.pop();
                    w.clocks += 1;
                    w.stretched = 0;
                }
                w.master_clock_low = true;
            }
            Which::Data => w.master_data_low = true,
        }
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        let mut w = self.0.borrow_mut();
        match self.1 {
            Which::Clock => w.master_clock_low = false,
            Which::Data => {
                if w.master_data_low && w.clock() {
                    w.stops += 1;
                    w.bits.clear();
                }
                w.master_data_low = false;
            }
        }
        Ok(())
    }
}

impl InputPin for Line {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        let mut w = self.0.borrow_mut();
        if self.1 == Which::Data {
            return Ok(w.data());
        }
        w.stretched += 1;
        Ok(w.clock() && w.stretched > w.stretch)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}

/// Result, duration in µs, and final wires.
fn freed(wires: Wires) -> (Lines, u64, Rc<RefCell<Wires>>) {
    let wires = Rc::new(RefCell::new(wires));
    let kept = wires.clone();
    let (result, took) = run(async move {
        let start = Instant::now();
        let mut clock = Line(wires.clone(), Which::Clock);
        let mut data = Line(wires, Which::Data);
        let result = free(&mut clock, &mut data).await;
        (result, start.elapsed().as_micros())
    });
    (result, took, kept)
}

#[test]
fn an_idle_bus_is_left_alone() {
    let (result, _, wires) = freed(Wires::default());
    assert_eq!(result, Lines::Idle);
    assert_eq!((wires.borrow().clocks, wires.borrow().stops), (0, 0));
}

#[test]
fn whatever_is_left_of_a_byte_is_clocked_out_and_ended_with_a_stop() {
    // Every byte, at every bit that holds the line low.
    for byte in 0..=255u8 {
        for left in 1..=8 {
            let bits: Vec<bool> = (0..left).map(|bit| byte >> bit & 1 == 1).collect();
            if bits.last() == Some(&true) {
                continue;
            }
            let (result, took, wires) = freed(Wires {
                bits,
                ..Wires::default()
            });
            let Lines::Freed(clocks) = result else {
                panic!("{byte:#x}, {left} bits left: {result:?}")
            };
            assert!(clocks <= 9 && took < 300, "{clocks} clocks, {took} us");
            let wires = wires.borrow();
            assert_eq!(wires.stops, 1, "{byte:#x}, {left} bits left");
            assert!(wires.clock() && wires.data());
        }
    }
}

#[test]
fn a_line_on_ground_is_told_and_given_up_in_time() {
    let (result, took, wires) = freed(Wires {
        data_shorted: true,
        ..Wires::default()
    });
    assert_eq!((result, wires.borrow().clocks), (Lines::Held, 9));
    assert!(took < 300, "{took} us");
    let (result, took, _) = freed(Wires {
        clock_shorted: true,
        ..Wires::default()
    });
    assert_eq!(result, Lines::Held);
    assert!(took <= 1100, "{took} us");
}

#[test]
fn a_chip_that_stretches_its_clock_is_waited_for() {
    let (result, took, _) = freed(Wires {
        bits: vec![true, false, false, false],
        stretch: 50,
        ..Wires::default()
    });
    assert_eq!(result, Lines::Freed(3));
    assert!(took < 3000, "{took} us");
}
