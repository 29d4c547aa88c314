//! A table whose first line names its columns.

use crate::lines::Lines;

/// Most columns.
const COLUMNS_MAX: usize = 200;

/// Its head.
pub struct Head(Vec<String>);

impl Head {
    /// The head of a first line.
    ///
    /// # Errors
    /// One line: too many columns, or one twice.
    pub fn of(line: &str) -> Result<Self, String> {
        let names: Vec<String> = line.split(',').map(|name| name.trim().to_owned()).collect();
        if names.len() > COLUMNS_MAX {
            return Err(format!("{} columns, allowed are {COLUMNS_MAX}", names.len()));
        }
        let twice = names
            .iter()
            .enumerate()
            .find(|(i, name)| names[..*i].contains(name));
        twice.map_or(Ok(()), |(_, name)| {
            Err(format!("column '{name}' twice, allowed is once"))
        })?;
        Ok(Self(names))
    }

    /// True if there is a column of this name.
    pub fn has(&self, name: &str) -> bool {
        self.0.iter().any(|known| known == name)
    }

    /// Requires the columns `wanted`.
    ///
    /// # Errors
    /// One line with the first missing one.
    pub fn require(&self, wanted: &[&str]) -> Result<(), String> {
        let missing = wanted.iter().find(|name| !self.has(name));
        missing.map_or(Ok(()), |name| {
            Err(format!(
                "no column '{name}', allowed is a table with {}",
                wanted.join(", ")
            ))
        })
    }

    /// The cell under `name` of a line of cells; `None` if it is empty or missing.
    pub fn cell<'a>(&self, cells: &[&'a str], name: &str) -> Option<&'a str> {
        let at = self.0.iter().position(|known| known == name)?;
        cells.get(at).copied().filter(|cell| !cell.is_empty())
    }

    /// The cells of `line`.
    ///
    /// # Errors
    /// One line, if it has another number of cells than the head.
    pub fn cells<'a>(&self, line: &'a str) -> Result<Vec<&'a str>, String> {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() == self.0.len() {
            Ok(cells)
        } else {
            Err(format!(
                "{} values, allowed are {}, as the first line has",
                cells.len(),
                self.0.len()
            ))
        }
    }
}

/// The head of `lines`.
///
/// # Errors
/// One line: no head, or a bad one.
pub fn head(lines: &mut Lines) -> Result<Head, String> {
    let Some(line) = lines.next()?.map(str::to_owned) else {
        return Err(lines.whole("empty, allowed is a table with a first line of names"));
    };
    Head::of(&line).map_err(|why| lines.bad(&why))
}
