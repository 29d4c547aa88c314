//! Aligned text tables.

/// How a column is aligned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// A table of text.
pub struct Table {
    columns: Vec<(String, Align)>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table with its columns.
    pub fn new(columns: &[(&str, Align)]) -> Self {
        Self {
            columns: columns
                .iter()
                .map(|(title, align)| ((*title).to_owned(), *align))
                .collect(),
            rows: vec![],
        }
    }

    /// Adds a row; missing cells stay empty.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Titles, a rule, the rows; two blanks between columns, none at the end.
    pub fn lines(&self) -> Vec<String> {
        let titles: Vec<String> = self.columns.iter().map(|(title, _)| title.clone()).collect();
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|i| {
                self.rows
                    .iter()
                    .chain([&titles])
                    .filter_map(|r| r.get(i))
                    .map(|c| width(c))
                    .max()
                    .unwrap_or(0)
            })
            .collect();
        let rule = widths
            .iter()
            .map(|w| "─".repeat(*w))
            .collect::<Vec<_>>()
            .join("──");
        let mut lines = vec![self.line(&titles, &widths), rule];
        lines.extend(self.rows.iter().map(|row| self.line(row, &widths)));
        lines
    }

    fn line(&self, cells: &[String], widths: &[usize]) -> String {
        let mut line = String::new();
        for (i, ((_, align), w)) in self.columns.iter().zip(widths).enumerate() {
            let cell = cells.get(i).map_or("", String::as_str);
            let pad = " ".repeat(w.saturating_sub(width(cell)));
            let gap = if i == 0 { "" } else { "  " };
            line += gap;
            line += &match align {
                Align::Left => format!("{cell}{pad}"),
                Align::Right => format!("{pad}{cell}"),
            };
        }
        line.trim_end().to_owned()
    }
}

/// Width on a terminal; every character printed is one cell wide.
fn width(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let mut table = Table::new(&[
            ("step", Align::Left),
            ("α, deg", Align::Right),
            ("note", Align::Left),
        ]);
        table.row(["arm", "0.1", ""].map(str::to_owned));
        table.row(["fly-to-pipe", "-12.34", "é"].map(str::to_owned));
        table.row(["x".to_owned()]);
        assert_eq!(
            table.lines(),
            [
                "step         α, deg  note",
                "─────────────────────────",
                "arm             0.1",
                "fly-to-pipe  -12.34  é",
                "x",
            ]
        );
    }

    #[test]
    fn an_empty_table_still_has_its_titles() {
        let table = Table::new(&[("a", Align::Right), ("bb", Align::Left)]);
        assert_eq!(table.lines(), ["a  bb", "─────"]);
    }
}
