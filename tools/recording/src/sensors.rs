//! Sensors' lines: one measurement a line, or a table with named columns.

use std::collections::VecDeque;
use std::path::Path;

use crate::event::{Cells, Event};
use crate::lines::{Lines, short, time};
use crate::table::Head;

/// Columns of an inertial sample, and optional columns.
const INERTIAL: [&str; 7] = ["t_us", "gx", "gy", "gz", "ax", "ay", "az"];
const FLOW: [&str; 4] = ["flow_x", "flow_y", "flow_s", "flow_quality"];
/// Values of a line after its letter, in order.
const OF_FLOW: [&str; 6] = ["t_us", "flow_t_us", "flow_s", "flow_x", "flow_y", "flow_quality"];
const OF_RANGE: [&str; 5] = ["t_us", "range_t_us", "range_m", "range_min_m", "range_max_m"];
const OF_LIFT: [&str; 2] = ["t_us", "lift_n"];

/// A recording of sensors, in the order of time.
pub struct Sensors {
    lines: Lines,
    /// The names of a table; `None` for lines with letters.
    head: Option<Head>,
    /// Time of the last line, µs; `None` before the first.
    last_us: Option<u64>,
    waiting: VecDeque<Event>,
}

impl Sensors {
    /// Opens a file and detects its format.
    ///
    /// # Errors
    /// One line about the file.
    pub fn open(path: &Path) -> Result<Self, String> {
        let mut lines = Lines::open(path)?;
        let line = lines.next()?.map(str::to_owned);
        let Some(line) = line else {
            return Err(lines.whole("empty, allowed are sensors' lines"));
        };
        let named = line.split(',').any(|name| name.trim() == "t_us");
        let head = if named {
            let head = Head::of(&line).map_err(|why| lines.bad(&why))?;
            head.require(&INERTIAL).map_err(|why| lines.bad(&why))?;
            if FLOW.iter().any(|name| head.has(name)) {
                head.require(&FLOW).map_err(|why| lines.bad(&why))?;
            }
            Some(head)
        } else {
            // A measurement already: a pipe cannot be read from its beginning again.
            lines.again();
            None
        };
        Ok(Self {
            lines,
            head,
            last_us: None,
            waiting: VecDeque::new(),
        })
    }

    /// The next measurement and its time, µs; `None` at the end.
    ///
    /// # Errors
    /// One line: place, value, allowed values.
    pub fn next(&mut self) -> Result<Option<(u64, Event)>, String> {
        loop {
            if let (Some(event), Some(at)) = (self.waiting.pop_front(), self.last_us) {
                return Ok(Some((at, event)));
            }
            let Some(line) = self.lines.next()? else {
                return Ok(None);
            };
            let read = match &self.head {
                Some(head) => row(head, line),
                None => letter(line),
            };
            let (at, events) = read.map_err(|why| self.lines.bad(&why))?;
            if let Some(last) = self.last_us.filter(|last| at < *last) {
                let why = format!("time {at}, allowed {last} us or later, as the line before it");
                return Err(self.lines.bad(&why));
            }
            self.last_us = Some(at);
            self.waiting.extend(events);
        }
    }

    /// A complaint about the file.
    pub fn whole(&self, what: &str) -> String {
        self.lines.whole(what)
    }
}

/// A line that begins with the letter of its sensor.
fn letter(line: &str) -> Result<(u64, Vec<Event>), String> {
    let mut cells = line.split(',').map(str::trim);
    let letter = cells.next().unwrap_or_default();
    let names: &[&str] = match letter {
        "I" => &INERTIAL,
        "F" => &OF_FLOW,
        "R" => &OF_RANGE,
        "L" => &OF_LIFT,
        _ => {
            let what = "allowed I, F, R or L, or a table whose first line names t_us and others";
            return Err(format!("a line of '{}', {what}", short(letter)));
        }
    };
    // Further values are ignored.
    let values: Vec<&str> = cells.take(names.len()).collect();
    let cell = |name: &'static str| {
        let at = names.iter().position(|known| *known == name)?;
        values.get(at).copied()
    };
    let cells = Cells(&cell);
    let at = time("t_us", cell("t_us").unwrap_or_default())?;
    let event = match letter {
        "I" => cells.inertial(),
        "F" => cells.flow(at),
        "R" => cells.range(at),
        _ => cells.lift(),
    };
    Ok((at, vec![event?]))
}

/// A line of a table: its values for each sensor.
fn row(head: &Head, line: &str) -> Result<(u64, Vec<Event>), String> {
    let values = head.cells(line)?;
    let cell = |name: &'static str| head.cell(&values, name);
    let cells = Cells(&cell);
    let at = time("t_us", cell("t_us").unwrap_or_default())?;
    let mut events = vec![];
    if cell("lift_n").is_some() {
        events.push(cells.lift()?);
    }
    if cell("flow_x").is_some() {
        events.push(cells.flow(at)?);
    }
    if cell("range_m").is_some() {
        events.push(cells.range(at)?);
    }
    // The inertial sample goes last, after the other values of its line.
    if cell("gx").is_some() {
        events.push(cells.inertial()?);
    }
    Ok((at, events))
}
