//! `paper.html`: a self-contained page.

use super::chart;
use super::model::{Block, Cell, Class, Comparison, Section, Table};
use sophie_charts::svg::escape;

/// Style of all reports, and additions.
const STYLE: [&str; 2] = [sophie_charts::STYLE, include_str!("style.css")];

const CLASSES: [(Class, &str); 3] = [
    (
        Class::Prediction,
        "nothing in the model was set with this number in view",
    ),
    (
        Class::Calibrated,
        "a parameter was set so that this number comes out; the text says which",
    ),
    (
        Class::Inconsistent,
        "the paper contradicts itself or physics; the reason stands beside it",
    ),
];

/// The page titled `title` with `lead` under it.
pub fn html(title: &str, lead: &str, sections: &[Section]) -> String {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\
         <title>{0}</title><style>{1}{2}</style></head><body><main><h1>{0}</h1><p class=\"sub\">{3}</p>",
        escape(title),
        STYLE[0],
        STYLE[1],
        escape(lead)
    );
    let compares = |s: &Section| s.blocks.iter().any(|b| matches!(b, Block::Comparisons(..)));
    if sections.iter().any(compares) {
        page += "<ul class=\"legend\">";
        for (class, meaning) in CLASSES {
            page += &format!("<li>{} {}</li>", badge(class), escape(meaning));
        }
        page += "<li><svg viewBox=\"0 0 30 14\"><path class=\"printed\" d=\"M15 7m-6 0l6 -6l6 6l-6 6z\"/></svg>printed in \
                 the paper</li></ul>";
    }
    if sections.len() > 1 {
        page += "<nav>";
        for (i, s) in sections.iter().enumerate() {
            page += &format!("<a href=\"#{}\">{}. {}</a>", s.id, i + 1, escape(s.title));
        }
        page += "</nav>";
    }
    for (i, s) in sections.iter().enumerate() {
        page += &section(i + 1, s);
    }
    page + &format!(
        "<footer>Computed by sophie {}.</footer></main></body></html>\n",
        env!("CARGO_PKG_VERSION")
    )
}

fn section(number: usize, s: &Section) -> String {
    let mut out = format!(
        "<section id=\"{}\"><h2>{number}. {}</h2><p class=\"finding\">{}</p>",
        s.id,
        escape(s.title),
        escape(&s.finding)
    );
    for block in &s.blocks {
        out += &match block {
            Block::Text(text) => format!("<p>{}</p>", escape(text)),
            Block::Comparisons(caption, rows) => comparisons(caption, rows),
            Block::Table(t) => table(t),
            Block::Figure(f) => {
                let charts: String = f
                    .charts
                    .iter()
                    .map(|c| format!("<div>{}</div>", chart::draw(c)))
                    .collect();
                format!(
                    "<div class=\"charts\">{charts}</div><p class=\"note\">{}</p>",
                    escape(&f.caption)
                )
            }
        };
    }
    out + "</section>"
}

fn badge(class: Class) -> String {
    format!("<span class=\"class {0}\">{0}</span>", class.word())
}

fn comparisons(caption: &str, rows: &[Comparison]) -> String {
    let mut out = format!(
        "<h3>{}</h3><div class=\"scroll\"><table><thead><tr><th class=\"w\"></th><th>printed</th><th>here</th>\
         <th>deviation</th><th class=\"w\"></th><th class=\"w\">why</th></tr></thead><tbody>",
        escape(caption)
    );
    for r in rows {
        let unit = if r.unit.is_empty() {
            String::new()
        } else {
            format!(" {}", escape(r.unit))
        };
        out += &format!(
            "<tr><td class=\"w\">{}</td><td>{}{unit}</td><td>{}{unit}</td><td>{}</td><td class=\"w\">{}</td>\
             <td class=\"why\">{}</td></tr>",
            escape(&r.what),
            value(r.printed),
            value(r.here),
            deviation(r),
            badge(r.class),
            escape(&r.why)
        );
    }
    out + "</tbody></table></div>"
}

fn table(t: &Table) -> String {
    let words = |i: usize| t.rows.iter().any(|r| matches!(r.get(i), Some(Cell::Text(_))));
    let class = |i: usize| if words(i) { " class=\"w\"" } else { "" };
    let mut out = format!(
        "<h3>{}</h3><div class=\"scroll\"><table><thead><tr>",
        escape(&t.caption)
    );
    for (i, title) in t.columns.iter().enumerate() {
        out += &format!("<th{}>{}</th>", class(i), escape(title));
    }
    out += "</tr></thead><tbody>";
    for row in &t.rows {
        out += "<tr>";
        for (i, cell) in row.iter().enumerate() {
            out += &format!("<td{}>{}</td>", class(i), escape(&cell.shown()));
        }
        out += "</tr>";
    }
    out + "</tbody></table></div>"
}

/// A number with three or four digits.
pub fn value(v: f64) -> String {
    let digits = match v.abs() {
        a if !a.is_finite() => return "–".to_owned(),
        a if a >= 100.0 => 0,
        a if a >= 10.0 => 1,
        a if a >= 1.0 => 2,
        a if a >= 0.1 => 3,
        _ => 4,
    };
    format!("{v:.digits$}")
}

/// Deviation in percent, or a dash.
pub fn deviation(r: &Comparison) -> String {
    let d = 100.0 * r.deviation();
    if d.is_finite() {
        format!("{d:+.1} %")
    } else {
        "–".to_owned()
    }
}
