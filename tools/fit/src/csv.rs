//! Tables of numbers that somebody measured: CSV with a header that names the columns, in any order. Blank lines and text
//! after `#` are skipped.

use std::path::Path;

const MAX_BYTES: u64 = 16 * sophie_input::MIB;

/// A column of a table.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// As in the header.
    pub name: &'static str,
    /// Smallest and largest value allowed.
    pub range: (f64, f64),
    /// Unit of the value.
    pub unit: &'static str,
    /// Value where the column is missing; `None` if it must be there.
    pub default: Option<f64>,
}

/// A kind of table.
#[derive(Clone, Copy, Debug)]
pub struct Table<const N: usize> {
    /// Its columns.
    pub columns: [Column; N],
    /// The columns as a sentence has them.
    pub names: &'static str,
    /// Least number of rows, as the message about an empty table has it.
    pub min_rows: usize,
}

impl<const N: usize> Table<N> {
    /// Reads a file: the values of each row, in the order of the columns.
    ///
    /// # Errors
    /// One line: file, line, column, value, allowed values, and the other bad lines.
    pub fn load(&self, path: &Path) -> Result<Vec<[f64; N]>, String> {
        let file = path.display();
        let complaint = |why: String| format!("{file}: {why}");
        let bytes = sophie_input::read(path, MAX_BYTES)
            .map_err(|why| complaint(format!("cannot be read: {why}: allowed is a CSV file")))?;
        let text = String::from_utf8(bytes)
            .map_err(|_| complaint("is not text: allowed is a CSV file in UTF-8".to_owned()))?;
        self.parse(&text, &file.to_string())
    }

    /// Parses the text of `file`.
    ///
    /// # Errors
    /// See [`Table::load`].
    pub fn parse(&self, text: &str, file: &str) -> Result<Vec<[f64; N]>, String> {
        let content = |line: &str| line.split('#').next().unwrap_or_default().trim().to_owned();
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = text
            .lines()
            .enumerate()
            .map(|(i, l)| (i + 1, content(l)))
            .filter(|(_, l)| !l.is_empty());
        let Some((header_line, header)) = lines.next() else {
            return Err(format!(
                "{file}: holds no line: allowed is a header with {}",
                self.names
            ));
        };
        let order = self
            .order(&header)
            .map_err(|why| format!("{file}:{header_line}: {why}"))?;
        let (mut rows, mut bad): (Vec<[f64; N]>, Vec<BadLine>) = (vec![], vec![]);
        for (number, line) in lines {
            match self.row(&line, &order) {
                Ok(row) => rows.push(row),
                Err(why) => bad.push(BadLine { number, why }),
            }
        }
        if let Some((first, others)) = bad.split_first() {
            return Err(format!(
                "{file}:{}: {}{}",
                first.number,
                first.why,
                bad_as_well(others)
            ));
        }
        if rows.is_empty() {
            return Err(format!(
                "{file}:{header_line}: no row stands below the header: allowed are at least {}",
                self.min_rows
            ));
        }
        Ok(rows)
    }

    fn order(&self, header: &str) -> Result<Vec<usize>, String> {
        commas(header)?;
        let header: Vec<&str> = header.split(',').map(str::trim).collect();
        if header.iter().all(|cell| cell.parse::<f64>().is_ok()) {
            return Err(format!(
                "a row of numbers where the header should be: allowed is a header with {}",
                self.names
            ));
        }
        let mut order = vec![];
        for name in &header {
            let Some(column) = self.columns.iter().position(|c| c.name == *name) else {
                return Err(format!(
                    "column '{name}' is not known: allowed are {}",
                    self.names
                ));
            };
            if order.contains(&column) {
                return Err(format!("column '{name}' stands twice: allowed is once"));
            }
            order.push(column);
        }
        let missing = |(i, column): &(usize, &Column)| column.default.is_none() && !order.contains(i);
        if let Some((_, column)) = self.columns.iter().enumerate().find(missing) {
            return Err(format!(
                "column '{}' is missing: needed are {}",
                column.name, self.names
            ));
        }
        Ok(order)
    }

    fn row(&self, line: &str, order: &[usize]) -> Result<[f64; N], String> {
        commas(line)?;
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != order.len() {
            return Err(format!(
                "{} values: allowed are {}, as in the header",
                cells.len(),
                order.len()
            ));
        }
        let mut values = self.columns.map(|column| column.default.unwrap_or(f64::NAN));
        for (cell, column) in cells.iter().zip(order) {
            let Column {
                name,
                range: (low, high),
                unit,
                ..
            } = self.columns[*column];
            let value = cell.parse().ok().filter(|v| (low..=high).contains(v));
            let allowed = format!("{low} to {high} {unit}");
            values[*column] = value.ok_or_else(|| {
                format!(
                    "{name} = '{cell}': allowed is a number from {}",
                    allowed.trim_end()
                )
            })?;
        }
        Ok(values)
    }
}

struct BadLine {
    number: usize,
    why: String,
}

fn bad_as_well(others: &[BadLine]) -> String {
    if others.is_empty() {
        return String::new();
    }
    let numbers: Vec<String> = others.iter().take(8).map(|b| b.number.to_string()).collect();
    let dots = if others.len() > 8 { ", ..." } else { "" };
    format!(" (bad as well: lines {}{dots})", numbers.join(", "))
}

/// Refuses other separators, as spreadsheets write with a decimal comma.
fn commas(line: &str) -> Result<(), String> {
    let other = [(';', "';'"), ('\t', "a tab")];
    other
        .into_iter()
        .find(|(sign, _)| line.contains(*sign))
        .map_or(Ok(()), |(_, name)| {
            Err(format!(
                "{name} between the columns: allowed is ',', and '.' within numbers"
            ))
        })
}
