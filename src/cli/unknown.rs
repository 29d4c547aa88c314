//! `sophie study unknown`: a campaign over builders, whole, in shards, and counted.

use std::path::Path;

use sophie_flight_report::terminal::tally::Tally;
use sophie_research::study::unknown::{self, Class, Request, Row, Shard, Shelf, folder, report};
use sophie_terminal::complain;
use sophie_terminal::console::{self, Console};

use super::PROGRAM;
use super::args::UnknownArgs;
use super::publish::Publisher;

const FILES: [&str; 2] = ["unknown.html", "unknown.json"];

/// Flies, counts or lists. False when a vehicle fell or does not hold; true for a shard, whose rows are counted later.
pub fn run(args: &UnknownArgs) -> Result<bool, String> {
    if let Some(folder) = &args.missing {
        let list = folder::missing(folder).map_err(|why| format!("--missing {why}"))?;
        if !list.is_empty() {
            console::print(&list)?;
        }
        return Ok(true);
    }
    if let Some(folder) = &args.summarise {
        let (request, rows) = folder::collect(folder).map_err(|why| format!("--summarise {why}"))?;
        let publisher = Publisher::new(folder, FILES, args.json)?;
        publisher.say(&request.text());
        return publish(publisher, &request, &rows);
    }
    let request = args.request();
    if let Some(shard) = args.shard {
        return fly_shard(&request, shard, args);
    }
    let publisher = Publisher::new(&args.out, FILES, args.json)?;
    let shelf = open(&request, Shard::WHOLE, &args.out)?;
    publisher.say(&request.text());
    let rows = fly(shelf, request.count, &Console::new(args.json))?;
    publish(publisher, &request, &rows)
}

fn fly_shard(request: &Request, shard: Shard, args: &UnknownArgs) -> Result<bool, String> {
    let console = Console::new(args.json);
    let shelf = open(request, shard, &args.out)?;
    console.say(&format!(
        "shard {}/{} of {}",
        shard.number,
        shard.of,
        request.text()
    ));
    let rows = fly(shelf, shard.vehicles(request.count).count() as u64, &console)?;
    let file = args.out.join(shard.file_name());
    console.say(&format!(
        "{} rows: {}",
        rows.len(),
        console::one_line(&file.display().to_string())
    ));
    if args.json {
        console::print(report::json(&rows, request).trim_end())?;
    }
    console.end()?;
    Ok(true)
}

/// Takes the rows that `folder` has of `shard`.
fn open(request: &Request, shard: Shard, folder: &Path) -> Result<Shelf, String> {
    Shelf::open(request, shard, folder).map_err(|why| format!("--out {why}"))
}

/// Flies the other ones of its `count` vehicles.
fn fly(shelf: Shelf, count: u64, console: &Console) -> Result<Vec<Row>, String> {
    let tally = Tally::new(console, count);
    let rows = unknown::fly(shelf, &|_| tally.one());
    tally.finish();
    rows.map_err(|why| format!("--out {why}"))
}

fn publish(publisher: Publisher, request: &Request, rows: &[Row]) -> Result<bool, String> {
    let section = report::section(rows, request);
    publisher.show(1, &section);
    publisher.write(
        "Unknown vehicles",
        &request.text(),
        &[section],
        report::json(rows, request),
    )?;
    let bad = rows.iter().filter(|row| row.class.is_bad()).count();
    if bad > 0 {
        let [fallen, not_holding] =
            [Class::Fallen, Class::NotHolding].map(|class| report::count(rows, class));
        complain(
            PROGRAM,
            &format!(
                "of {} vehicles {fallen} fallen, {not_holding} not holding",
                rows.len()
            ),
        );
    }
    Ok(bad == 0)
}
