//! `report.html`: a self-contained page.

use sophie_control::mode::Mode;
use sophie_sim::record::FlightRecord;
use sophie_sim::scenario::keys;

use super::approach;
use super::attitude_error::{Worst, attitude_errors};
use super::drawing::draw;
use super::figure::Figure;
use super::figures;
use super::moments::{KeyMoment, key_moments};
use super::tables;
use sophie_charts::STYLE;
use sophie_charts::svg::escape;
use sophie_charts::units::{deg, kgcm};

const SCRIPT: &str = include_str!("cursor.js");

/// The page.
pub fn html(record: &FlightRecord) -> String {
    let name = escape(&record.scenario.name);
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\
         <title>SOPHIE: {name}</title><style>{STYLE}</style></head><body><main>"
    );
    page += &headline(record);
    page += &key_figures(record);
    page += &scenes(record);
    page += &approach(record);
    let note = "Attitude error: largest angle between true and aimed-at roll or pitch, with the lag behind what the step \
                commands.";
    page += &section("Steps", note, &tables::phases(record));
    page += "<div class=\"pair\">";
    page += &section("Grip", "When it was proven.", &tables::grip(record));
    page += &section("Events", "", &tables::events(record));
    page += "</div>";
    let strikes = tables::strikes(record);
    if !strikes.is_empty() {
        page += &section(
            "Propeller strikes",
            "Turning propellers that met something. The verdict does not count them.",
            &strikes,
        );
    }
    let wrong = tables::differences(record);
    if !wrong.is_empty() {
        page += &section(
            "Truth and belief",
            "What the flight stack's parameters have wrong.",
            &wrong,
        );
    }
    page += &modes(record);
    for figure in figures::all(record) {
        page += &plot(&figure);
    }
    page += &footer(record);
    page + "</main><output id=\"time\"></output><script>" + SCRIPT + "</script></body></html>\n"
}

fn headline(record: &FlightRecord) -> String {
    let s = &record.scenario;
    let good = record.outcome.accomplished;
    let (class, word) = if good {
        ("verdict", "accomplished")
    } else {
        ("verdict bad", "not accomplished")
    };
    let reason = if good {
        String::new()
    } else {
        format!("<p class=\"reason\">{}</p>", escape(&record.outcome.reason))
    };
    format!(
        "<h1>{}<span class=\"{class}\">{word}</span></h1>{reason}<p class=\"sub\">Configuration {}, infill {} %, K {}, \
         {} mixer, arms closing: {}, {} servo, seed {}</p>",
        escape(&s.name),
        keys::configuration_word(s.vehicle.configuration),
        s.vehicle.infill,
        s.vehicle.gain_k,
        keys::mixer_word(s.mixer),
        keys::arms_word(s.arms),
        keys::servo_word(s.vehicle.servo),
        s.seed
    )
}

fn key_figures(record: &FlightRecord) -> String {
    let most = |f: fn(&sophie_sim::record::Grip) -> f64| record.grip.iter().map(f).reduce(f64::max);
    let done = record.phases.iter().filter(|p| p.done).count();
    let or_dash = |v: Option<f64>, digits: usize| v.map_or("–".to_owned(), |v| format!("{v:.digits$}"));
    let end = record.samples.last().map(|s| s.battery_voltage);
    let errors = attitude_errors(record);
    let angle = |w: Option<Worst<'_>>| or_dash(w.map(|w| deg(w.angle)), 1);
    let held = errors.held.map_or_else(
        || "attitude error, setpoint held".to_owned(),
        |w| format!("{} error, setpoint held{}", w.axis, step(w)),
    );
    let following = errors.following.map_or_else(
        || "lag behind a command".to_owned(),
        |w| format!("lag behind commanded {}{}", w.axis, step(w)),
    );
    let mut out = String::from("<div class=\"keys\">");
    for (value, unit, name) in [
        (
            format!("{done}/{}", record.scenario.steps.len()),
            "",
            "steps done",
        ),
        (format!("{:.1}", record.sim_seconds), "s", "flown"),
        (angle(errors.held), "°", &*held),
        (angle(errors.following), "°", &*following),
        (or_dash(most(|g| g.closure), 2), "s", "slowest closure"),
        (
            or_dash(most(|g| kgcm(g.torque)), 1),
            "kgcm",
            "largest steady force",
        ),
        (or_dash(end, 2), "V", "battery at the end"),
        (record.overruns.to_string(), "", "missed deadlines"),
    ] {
        let unit = if value == "–" { "" } else { unit };
        out += &format!("<div><b>{value} <i>{unit}</i></b><small>{name}</small></div>");
    }
    out + "</div>"
}

fn step(worst: Worst<'_>) -> String {
    worst
        .step
        .map_or_else(String::new, |(n, name)| format!(" ({n} {})", escape(name)))
}

fn scenes(record: &FlightRecord) -> String {
    let moments = key_moments(record);
    if moments.is_empty() {
        return String::new();
    }
    let class = if moments.len() == 4 {
        "scenes four"
    } else {
        "scenes"
    };
    let mut out = format!("<div class=\"{class}\">");
    for moment in &moments {
        let caption = caption(moment);
        out += &format!(
            "<figure>{}<figcaption>{caption}</figcaption></figure>",
            draw(record, moment)
        );
    }
    let note = "Seen from behind, along the pipe. Rear arms 2 and 4 in front, front arms 1 and 3 pale behind them; \
                grey arrows are thrust, dashed lines tendons under tension.";
    section("Key moments", note, &(out + "</div>"))
}

/// Caption of the approach's dots.
const RANGE_FELL: &str = "<li><svg viewBox=\"0 0 30 12\"><circle class=\"foot\" cx=\"9\" cy=\"6\" r=\"2\"/>\
    <circle class=\"foot\" cx=\"20\" cy=\"6\" r=\"2\"/></svg>where the range fell</li>";

fn approach(record: &FlightRecord) -> String {
    let Some((svg, caption)) = approach::draw(record) else {
        return String::new();
    };
    // A flight by pose has no range.
    let range = if svg.contains("class=\"foot\"") {
        RANGE_FELL
    } else {
        ""
    };
    let legend = format!(
        "<ul class=\"legend\">\
        <li><svg viewBox=\"0 0 30 12\"><path class=\"trace true\" d=\"M0 6L30 6\"/></svg>true way</li>\
        <li><svg viewBox=\"0 0 30 12\"><path class=\"trace estimate\" d=\"M0 6L30 6\"/></svg>estimated way</li>\
        {range}\
        <li><svg viewBox=\"0 0 30 12\"><circle class=\"begin\" cx=\"15\" cy=\"6\" r=\"4\"/></svg>begin</li>\
        <li><svg viewBox=\"0 0 30 12\"><path class=\"touch\" d=\"M10 1L20 11M10 11L20 1\"/></svg>touch</li></ul>"
    );
    let content = format!("{legend}<div class=\"scroll\">{svg}</div>");
    section("Approach by itself", &caption, &content)
}

fn caption(moment: &KeyMoment<'_>) -> String {
    let s = moment.sample;
    let tilts: Vec<String> = s.tilt.iter().map(|a| tables::signed(deg(*a))).collect();
    format!(
        "<b>{}</b> at {:.1} s, {}<br/>roll {}°, yaw {}°<br/>α {} °",
        escape(&moment.title),
        s.t,
        s.mode.name(),
        tables::signed(deg(s.attitude[0])),
        tables::signed(deg(s.attitude[2])),
        tilts.join(" ")
    )
}

fn modes(record: &FlightRecord) -> String {
    let mut out = String::from("<ul class=\"legend modes\">");
    for mode in Mode::ALL
        .into_iter()
        .filter(|m| record.samples.iter().any(|s| s.mode == *m))
    {
        let name = mode.name();
        out += &format!("<li><span class=\"m-{}\"></span>{name}</li>", name.to_lowercase());
    }
    let note = "Under each plot: the state of the stack, and the step with its number in the table above.";
    section("Modes", note, &(out + "</ul>"))
}

fn plot(figure: &Figure) -> String {
    let mut legend = String::from("<ul class=\"legend\">");
    for (class, meaning) in &figure.legend {
        let sample = if matches!(*class, "target" | "mark") {
            format!("<rect class=\"{class}\" x=\"0\" y=\"1\" width=\"30\" height=\"10\"/>")
        } else {
            format!("<path class=\"trace {class}\" d=\"M0 6L30 6\"/>")
        };
        legend += &format!(
            "<li><svg viewBox=\"0 0 30 12\">{sample}</svg>{}</li>",
            escape(meaning)
        );
    }
    let content = format!("{legend}</ul><div class=\"scroll\">{}</div>", figure.svg);
    section(figure.title, &escape(&figure.note), &content)
}

fn section(title: &str, note: &str, content: &str) -> String {
    let note = if note.is_empty() {
        String::new()
    } else {
        format!("<p class=\"note\">{note}</p>")
    };
    format!("<section><h2>{}</h2>{note}{content}</section>", escape(title))
}

fn footer(record: &FlightRecord) -> String {
    format!(
        "<footer>Simulated by sophie {} in {:.2} s of wall time; digest {:016x}: the same scenario and seed give the \
         same digest.</footer>",
        env!("CARGO_PKG_VERSION"),
        record.wall_seconds,
        record.digest
    )
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::synthetic;
    use super::*;

    /// Requires closed elements, in order, with nothing outside.
    pub fn well_formed(text: &str) {
        let mut open: Vec<&str> = vec![];
        let mut rest = text;
        while let Some(start) = rest.find('<') {
            assert!(
                !rest[..start].contains('>'),
                "stray > before {}",
                &rest[start..rest.len().min(start + 60)]
            );
            let end = start + rest[start..].find('>').expect("every < has its >");
            let tag = &rest[start + 1..end];
            assert!(!tag.contains('<'), "<{tag}>");
            assert_eq!(tag.matches('"').count() % 2, 0, "<{tag}>");
            let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap();
            if let Some(closed) = tag.strip_prefix('/') {
                assert_eq!(open.pop(), Some(closed), "{tag}");
            } else if !tag.ends_with('/') && !tag.starts_with('!') {
                open.push(name);
            }
            rest = &rest[end + 1..];
        }
        assert!(open.is_empty(), "{open:?}");
    }

    fn body(page: &str) -> &str {
        let start = page.find("<body>").unwrap();
        &page[start..page.find("<script>").unwrap()]
    }

    #[test]
    fn the_page_is_whole_and_small_and_needs_nothing_from_outside() {
        let page = html(&synthetic::record());
        well_formed(&(body(&page).to_owned() + "</body>"));
        assert!(page.len() < 1_500_000, "{}", page.len());
        for outside in ["http:", "https:", "src=", "@import", "url("] {
            assert!(!page.contains(outside), "{outside}");
        }
        assert!(!page.contains("NaN"), "a gap in a curve must break it");
        for part in [
            "Attitude",
            "Arm tilt",
            "Rotor thrust",
            "Tendons and grip",
            "Closing on the pipe",
            "Battery",
        ] {
            assert!(page.contains(&format!("<h2>{part}")), "{part}");
        }
        assert!(
            page.contains("&lt;&amp;&quot;&gt;"),
            "texts of events are escaped"
        );
    }

    #[test]
    fn the_legend_of_an_approach_names_the_range_where_there_was_one() {
        let mut record = approach::tests::flown();
        let ranged = |record: &FlightRecord| html(record).contains("where the range fell");
        assert!(ranged(&record));
        record.samples.iter_mut().for_each(|s| s.range_measured = None);
        let page = html(&record);
        assert!(page.contains("true way") && !ranged(&record));
        well_formed(&(body(&page).to_owned() + "</body>"));
    }

    #[test]
    fn every_mode_has_its_colour() {
        for mode in Mode::ALL {
            let class = format!(".m-{} {{", mode.name().to_lowercase());
            assert!(STYLE.contains(&class), "{class}");
        }
    }

    #[test]
    fn the_lag_of_a_commanded_roll_is_not_shown_as_an_error() {
        let mut record = synthetic::record();
        let roll = record.phases.iter().position(|p| p.name == "roll").unwrap();
        let (start, end) = (record.phases[roll].start, record.phases[roll].end);
        for s in &mut record.samples {
            let commanded = (start + 1.0..end - 0.5).contains(&s.t);
            s.thrust_asked = [4.0; 4];
            s.attitude_setpoint = [if commanded { 0.5 } else { 0.0 }, 0.0, 0.0];
            let late = (start + 1.2..end - 0.3).contains(&s.t);
            s.attitude = [if late { 0.52 } else { 0.02 }, 0.0, 0.0];
        }
        let page = html(&record);
        let tiles = &page[page.find("<div class=\"keys\">").unwrap()..page.find("<section>").unwrap()];
        for tile in [
            format!(
                "<b>29.8 <i>°</i></b><small>lag behind commanded roll ({} roll)</small>",
                roll + 1
            ),
            "<b>1.1 <i>°</i></b><small>roll error, setpoint held (".to_owned(),
        ] {
            assert!(tiles.contains(&tile), "{tile} not in {tiles}");
        }
        assert!(!tiles.contains("worst attitude error"), "{tiles}");
    }

    #[test]
    fn a_flight_that_never_began_makes_a_page() {
        let mut record = synthetic::record();
        record.samples.clear();
        record.phases.clear();
        record.events.clear();
        record.grip.clear();
        record.sim_seconds = 0.0;
        record.outcome.accomplished = false;
        record.outcome.reason = "calibration <failed>".to_owned();
        let page = html(&record);
        well_formed(&(body(&page).to_owned() + "</body>"));
        assert!(page.contains("calibration &lt;failed&gt;") && page.contains("not accomplished"));
    }
}
