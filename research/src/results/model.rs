//! Parts of a section: text, tables, comparisons with printed numbers, charts.

/// Relation of a computed number to the printed one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// No parameter was set for this number.
    Prediction,
    /// A parameter was set for this number.
    Calibrated,
    /// The paper contradicts itself or physics, for the given reason.
    Inconsistent,
}

impl Class {
    /// Name.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Prediction => "prediction",
            Self::Calibrated => "calibrated",
            Self::Inconsistent => "inconsistent",
        }
    }
}

/// A printed and a computed number.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Quantity.
    pub what: String,
    /// Unit; may be empty.
    pub unit: &'static str,
    /// Printed value.
    pub printed: f64,
    /// Computed value.
    pub here: f64,
    /// Standing.
    pub class: Class,
    /// One line.
    pub why: String,
}

impl Comparison {
    /// Deviation over the printed number.
    pub fn deviation(&self) -> f64 {
        self.here / self.printed - 1.0
    }
}

/// A cell of a table.
#[derive(Clone, Debug)]
pub enum Cell {
    /// Words.
    Text(String),
    /// Number and decimals; a dash if not finite.
    Number(f64, usize),
}

impl Cell {
    /// Text shown.
    pub fn shown(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(v, _) if !v.is_finite() => "–".to_owned(),
            Self::Number(v, digits) => {
                let text = format!("{v:.digits$}");
                // No "-0".
                let zero = text
                    .trim_start_matches('-')
                    .chars()
                    .all(|c| matches!(c, '0' | '.'));
                if zero {
                    text.trim_start_matches('-').to_owned()
                } else {
                    text
                }
            }
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

/// A number with `digits` decimals.
pub const fn num(value: f64, digits: usize) -> Cell {
    Cell::Number(value, digits)
}

/// A table.
#[derive(Clone, Debug)]
pub struct Table {
    /// Its caption.
    pub caption: String,
    /// Column titles with units.
    pub columns: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// An empty table.
    pub fn new(caption: &str, columns: &[&str]) -> Self {
        Self {
            caption: caption.to_owned(),
            columns: columns.iter().map(|c| (*c).to_owned()).collect(),
            rows: vec![],
        }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = Cell>) {
        self.rows.push(cells.into_iter().collect());
    }
}

/// Line style of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeriesStyle {
    /// A line.
    Line,
    /// A dashed line.
    Dashed,
    /// Dots.
    Dots,
    /// The paper's values: open diamonds in every figure.
    Printed,
}

/// One series of a chart.
#[derive(Clone, Debug)]
pub struct Series {
    /// In the legend; may be empty.
    pub name: String,
    /// Colour, 0 to 7.
    pub colour: usize,
    /// Style.
    pub look: SeriesStyle,
    /// Points; a non-finite one breaks the line.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// A series.
    pub fn new(name: impl Into<String>, colour: usize, look: SeriesStyle, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            colour,
            look,
            points,
        }
    }
}

/// A coloured cell.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Middle, axis units.
    pub at: (f64, f64),
    /// Width and height, axis units.
    pub size: (f64, f64),
    /// 0 (bad) to 1 (good); below 0: lost.
    pub shade: f64,
    /// Text in the cell.
    pub text: String,
}

/// An axis.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// Title with its unit.
    pub title: String,
    /// Values to include.
    pub include: Vec<f64>,
    /// Fixed limits, whatever the data.
    pub limits: Option<(f64, f64)>,
    /// Names at 0, 1, 2, … instead of numbers.
    pub names: Vec<String>,
}

impl Axis {
    /// Scaled to its data.
    pub fn new(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            ..Self::default()
        }
    }

    /// With fixed limits.
    pub fn between(title: &str, low: f64, high: f64) -> Self {
        Self {
            title: title.to_owned(),
            limits: Some((low, high)),
            ..Self::default()
        }
    }

    /// Of named cells.
    pub fn of_cells(title: &str, names: Vec<String>) -> Self {
        Self {
            names: names.clone(),
            ..Self::between(title, -0.5, names.len() as f64 - 0.5)
        }
    }

    /// Includes `values`.
    pub fn with(mut self, values: &[f64]) -> Self {
        self.include.extend(values);
        self
    }
}

/// One drawing.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    /// Its title.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves and points.
    pub series: Vec<Series>,
    /// Dashed horizontal lines with labels.
    pub levels: Vec<(f64, String)>,
    /// Dashed vertical lines with labels.
    pub uprights: Vec<(f64, String)>,
    /// Cells of a map, drawn first.
    pub tiles: Vec<Tile>,
}

/// Charts side by side.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The caption, which names the printed part.
    pub caption: String,
    /// The drawings.
    pub charts: Vec<Chart>,
}

/// A part of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// Printed numbers beside the computed.
    Comparisons(String, Vec<Comparison>),
    /// A table.
    Table(Table),
    /// A figure.
    Figure(Figure),
}

/// A section of the results.
#[derive(Clone, Debug)]
pub struct Section {
    /// For links and JSON.
    pub id: &'static str,
    /// Heading.
    pub title: &'static str,
    /// In a sentence or two.
    pub finding: String,
    /// Parts.
    pub blocks: Vec<Block>,
}

impl Section {
    /// An empty section.
    pub fn new(id: &'static str, title: &'static str) -> Self {
        Self {
            id,
            title,
            finding: String::new(),
            blocks: vec![],
        }
    }

    /// Adds a paragraph.
    pub fn text(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Text(text.into()));
    }

    /// Adds a comparison.
    pub fn compare(&mut self, caption: &str, rows: Vec<Comparison>) {
        self.blocks.push(Block::Comparisons(caption.to_owned(), rows));
    }

    /// Adds a table.
    pub fn table(&mut self, table: Table) {
        self.blocks.push(Block::Table(table));
    }

    /// Adds a figure.
    pub fn figure(&mut self, caption: &str, charts: Vec<Chart>) {
        self.blocks.push(Block::Figure(Figure {
            caption: caption.to_owned(),
            charts,
        }));
    }
}
