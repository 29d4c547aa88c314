//! The folder of a campaign: a file of rows a shard, complete or not there.
//!
//! While a shard flies, its rows go line by line into a hidden file, from which the next run of the same shard continues.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use sophie_sim::scenario::{Assist, Known, PositionSensor, Rule, keys};

use super::row::{self, Labelled, Row};
use super::{Request, Shard};

/// Largest file that is read, bytes: a hundred thousand rows.
const LARGEST: u64 = 512 * sophie_input::MIB;
const BEGIN: &str = "unknown-";
const END: &str = ".csv";
/// A hidden file of rows under way begins with a dot and ends with it.
const NOTES: &str = ".partial";

impl Shard {
    /// Name of its file.
    #[must_use]
    pub fn file_name(self) -> String {
        let width = self.of.to_string().len();
        format!("{BEGIN}{:0width$}-of-{}{END}", self.number, self.of)
    }

    fn notes_name(self) -> String {
        format!(".{}{NOTES}", self.file_name())
    }

    /// Of a file's name; the second value is false for one under way.
    fn from_name(name: &str) -> Option<(Self, bool)> {
        let under_way = name.strip_prefix('.').and_then(|name| name.strip_suffix(NOTES));
        let numbers = under_way.unwrap_or(name).strip_prefix(BEGIN)?.strip_suffix(END)?;
        let (number, of) = numbers.split_once("-of-")?;
        let shard = Self {
            number: number.parse().ok()?,
            of: of.parse().ok()?,
        };
        let sound = (1..=shard.of).contains(&shard.number);
        sound.then_some((shard, under_way.is_none()))
    }
}

/// Shards with a file in `folder`, each with whether it is complete.
fn shards(folder: &Path) -> Result<Vec<(Shard, bool)>, String> {
    let unreadable = |error: std::io::Error| format!("{}: cannot be read: {error}", folder.display());
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let name = entry.map_err(unreadable)?.file_name();
        found.extend(name.to_str().and_then(Shard::from_name));
    }
    found.sort_by_key(|(shard, complete)| (shard.of, shard.number, *complete));
    Ok(found)
}

/// Rows of a file, each with the words of its command, and the bytes up to the end of the last whole one.
type Read = (Vec<Labelled>, usize);

fn read(path: &Path, header: &str) -> Result<Read, String> {
    let file = path.display();
    let bytes = sophie_input::read(path, LARGEST).map_err(|why| format!("{file}: {why}"))?;
    let text = String::from_utf8(bytes).map_err(|_| format!("{file}: no text"))?;
    row::read(&text, header).map_err(|why| format!("{file}:{why}"))
}

/// The file ends within its first line: its process ended there.
fn is_torn(path: &Path, header: &str) -> bool {
    fs::read_to_string(path).is_ok_and(|text| header.starts_with(&text))
}

/// Refuses the first row of another command; `count`: also one of another number of vehicles.
fn same(path: &Path, rows: &[Labelled], request: &Request, count: bool) -> Result<(), String> {
    let words = request.words();
    let compared = words.len() - usize::from(!count);
    for (command, _) in rows {
        let differs = words
            .iter()
            .zip(command)
            .take(compared)
            .find(|((_, wanted), is)| wanted != *is);
        if let Some(((name, wanted), is)) = differs {
            return Err(format!(
                "{}: rows of another command: {name} {is}, here {wanted}: allowed are rows of one command",
                path.display()
            ));
        }
    }
    Ok(())
}

/// The rows of a shard, flown and to fly.
pub struct Shelf {
    request: Request,
    shard: Shard,
    folder: PathBuf,
    rows: BTreeMap<u64, Row>,
}

impl Shelf {
    /// Takes the rows of `shard` that are in `folder`.
    ///
    /// # Errors
    /// One line: a file that cannot be read, or that another command wrote.
    pub fn open(request: &Request, shard: Shard, folder: &Path) -> Result<Self, String> {
        let header = row::header(request);
        let wanted = shard.vehicles(request.count);
        // A shard among many reads its own files alone.
        let names: Vec<String> = if shard == Shard::WHOLE && folder.is_dir() {
            let found = shards(folder)?.into_iter();
            found
                .map(|(shard, complete)| {
                    if complete {
                        shard.file_name()
                    } else {
                        shard.notes_name()
                    }
                })
                .collect()
        } else {
            vec![shard.file_name(), shard.notes_name()]
        };
        let mut rows = BTreeMap::new();
        for path in names
            .iter()
            .map(|name| folder.join(name))
            .filter(|path| path.exists())
        {
            let found = match read(&path, &header) {
                Ok((found, _)) => found,
                Err(_) if is_torn(&path, &header) => continue,
                Err(why) => return Err(why),
            };
            same(&path, &found, request, false)?;
            let of_shard = found.into_iter().map(|(_, row)| (row.vehicle, row));
            rows.extend(of_shard.filter(|(vehicle, _)| wanted.contains(vehicle)));
        }
        Ok(Self {
            request: *request,
            shard,
            folder: folder.to_owned(),
            rows,
        })
    }

    /// The campaign.
    #[must_use]
    pub const fn request(&self) -> Request {
        self.request
    }

    /// Vehicles to fly.
    #[must_use]
    pub fn missing(&self) -> Vec<u64> {
        let all = self.shard.vehicles(self.request.count);
        all.filter(|vehicle| !self.rows.contains_key(vehicle)).collect()
    }

    /// The rows, in order.
    pub fn rows(&self) -> impl Iterator<Item = &Row> {
        self.rows.values()
    }

    /// The same.
    #[must_use]
    pub fn into_rows(self) -> Vec<Row> {
        self.rows.into_values().collect()
    }

    /// Adds flown rows.
    pub fn extend(&mut self, rows: Vec<Row>) {
        self.rows.extend(rows.into_iter().map(|row| (row.vehicle, row)));
    }

    fn failed(&self, error: &std::io::Error) -> String {
        let file = self.folder.join(self.shard.file_name());
        format!("{}: cannot be written: {error}", file.display())
    }

    /// The hidden file, to which flown rows are added. It has those of an earlier run.
    ///
    /// # Errors
    /// One line: it cannot be written, or another process writes it.
    pub fn notes(&self) -> Result<Notes, String> {
        let failed = |error: std::io::Error| self.failed(&error);
        fs::create_dir_all(&self.folder).map_err(failed)?;
        let path = self.folder.join(self.shard.notes_name());
        let mut options = OpenOptions::new();
        let file = options.append(true).create(true).open(&path).map_err(failed)?;
        // File systems without locks let two runs of one shard write the same rows twice.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(format!("{}: another process flies this shard", path.display()));
        }
        let header = row::header(&self.request);
        let kept = read(&path, &header).map_or(0, |(_, end)| end);
        file.set_len(kept as u64).map_err(failed)?;
        let mut notes = &file;
        if kept == 0 {
            notes.write_all(header.as_bytes()).map_err(failed)?;
        }
        Ok(Notes {
            request: self.request,
            file: Mutex::new(file),
            path,
        })
    }

    /// Writes the file of the shard: a temporary file that is renamed once it is on disk.
    ///
    /// # Errors
    /// One line: it cannot be written.
    pub fn write(&self) -> Result<(), String> {
        let temporary = format!(".{}.{}", self.shard.file_name(), std::process::id());
        let temporary = self.folder.join(temporary);
        let mut text = row::header(&self.request);
        text.extend(self.rows.values().map(|row| row.line(&self.request)));
        let written = File::create(&temporary)
            .and_then(|mut file| file.write_all(text.as_bytes()).and_then(|()| file.sync_all()))
            .and_then(|()| fs::rename(&temporary, self.folder.join(self.shard.file_name())));
        written.map_err(|error| {
            let _ = fs::remove_file(&temporary);
            self.failed(&error)
        })
    }
}

/// The hidden file of a shard under way.
pub struct Notes {
    request: Request,
    file: Mutex<File>,
    path: PathBuf,
}

impl Notes {
    /// Adds a row.
    ///
    /// # Errors
    /// One line: it cannot be written.
    pub fn add(&self, row: &Row) -> Result<(), String> {
        let failed = |why: String| format!("{}: cannot be written: {why}", self.path.display());
        let mut file = self.file.lock().map_err(|error| failed(error.to_string()))?;
        let line = row.line(&self.request);
        file.write_all(line.as_bytes())
            .map_err(|error| failed(error.to_string()))
    }

    /// Removes it.
    pub fn remove(self) {
        // The next run reads a file that stays, and takes nothing new from it.
        let _ = fs::remove_file(&self.path);
    }
}

/// Shards of the campaign in `folder` that have no complete file, as an array list of Slurm: `3,7-9`; empty if none.
///
/// # Errors
/// One line: the folder cannot be read, has no file of a shard, or files of campaigns cut differently.
pub fn missing(folder: &Path) -> Result<String, String> {
    let (of, complete) = complete(folder)?;
    Ok(list((1..=of).filter(|number| !complete.contains(number))))
}

/// How many shards the campaign in `folder` has, and which are complete.
fn complete(folder: &Path) -> Result<(u64, BTreeSet<u64>), String> {
    let found = shards(folder)?;
    let cuts: BTreeSet<u64> = found.iter().map(|(shard, _)| shard.of).collect();
    let cuts: Vec<String> = cuts.iter().map(u64::to_string).collect();
    let [of] = cuts.as_slice() else {
        let what = if cuts.is_empty() {
            "no file of a shard".to_owned()
        } else {
            format!("shards of {}", cuts.join(" and of "))
        };
        return Err(format!(
            "{}: {what}: allowed is the folder of one campaign",
            folder.display()
        ));
    };
    let whole = found.iter().filter(|(_, complete)| *complete);
    let numbers = whole.map(|(shard, _)| shard.number).collect();
    Ok((of.parse().unwrap_or_default(), numbers))
}

/// Numbers in rising order as ranges: `3,7-9`.
fn list(numbers: impl Iterator<Item = u64>) -> String {
    let mut ranges: Vec<(u64, u64)> = Vec::new();
    for number in numbers {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => ranges.push((number, number)),
        }
    }
    let text = |(first, last): &(u64, u64)| {
        if first == last {
            first.to_string()
        } else {
            format!("{first}-{last}")
        }
    };
    ranges.iter().map(text).collect::<Vec<_>>().join(",")
}

/// The campaign in `folder`: its command and all of its rows.
///
/// # Errors
/// One line: as [`missing`], a shard that is missing, a file that is no table of rows, or rows of several commands.
pub fn collect(folder: &Path) -> Result<(Request, Vec<Row>), String> {
    let (of, numbers) = complete(folder)?;
    let absent = list((1..=of).filter(|number| !numbers.contains(number)));
    if !absent.is_empty() {
        return Err(format!(
            "{}: shards {absent} of {of} are missing",
            folder.display()
        ));
    }
    let header = row::header(&ANY);
    let mut request: Option<Request> = None;
    let mut rows = Vec::new();
    for number in numbers {
        let shard = Shard { number, of };
        let path = folder.join(shard.file_name());
        let (found, _) = read(&path, &header)?;
        let first = || found.first().and_then(|(command, _)| command_of(command));
        let of_file = request
            .or_else(first)
            .ok_or_else(|| format!("{}: no row of a flight", path.display()))?;
        request = Some(of_file);
        same(&path, &found, &of_file, true)?;
        let wanted = shard.vehicles(of_file.count);
        if !wanted.clone().eq(found.iter().map(|(_, row)| row.vehicle)) {
            return Err(format!(
                "{}: its rows are not the vehicles {} to {}",
                path.display(),
                wanted.start(),
                wanted.end()
            ));
        }
        rows.extend(found.into_iter().map(|(_, row)| row));
    }
    let request = request.ok_or_else(|| format!("{}: no row of a flight", folder.display()))?;
    Ok((request, rows))
}

/// A command whose columns are those of all.
const ANY: Request = Request {
    known: Known::Exact,
    assist: Assist::None,
    sensors: PositionSensor::None,
    judge: Rule::Holding,
    wind: 0.0,
    seed: 1,
    count: 1,
};

/// Reads a row's command; version and table are compared elsewhere.
fn command_of(words: &[String]) -> Option<Request> {
    let [_, _, known, assist, sensors, judge, wind, seed, count] = words else {
        return None;
    };
    Some(Request {
        known: Known::from_word(known),
        assist: keys::assist(assist),
        sensors: keys::position_sensor(sensors),
        judge: Rule::from_word(judge),
        wind: wind.parse().ok()?,
        seed: seed.parse().ok()?,
        count: count.parse().ok()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_numbers_are_an_array_list() {
        let text = |numbers: &[u64]| list(numbers.iter().copied());
        assert_eq!(text(&[3, 7, 8, 9, 11, 12]), "3,7-9,11-12");
        assert_eq!(text(&[]), "");
    }

    #[test]
    fn shards_share_the_vehicles_and_are_known_by_their_files() {
        for (count, of) in [(12, 5), (7, 7), (100_000, 999), (1, 1)] {
            let shards = (1..=of).map(|number| Shard { number, of });
            let all: Vec<u64> = shards.clone().flat_map(|shard| shard.vehicles(count)).collect();
            assert!(all.iter().copied().eq(1..=count), "{count} in {of}");
            for shard in shards {
                let size = shard.vehicles(count).count() as u64;
                assert!(size == count / of || size == count / of + 1);
                assert_eq!(Shard::from_name(&shard.file_name()), Some((shard, true)));
                assert_eq!(Shard::from_name(&shard.notes_name()), Some((shard, false)));
            }
        }
        assert_eq!(Shard { number: 3, of: 40 }.file_name(), "unknown-03-of-40.csv");
        for name in [
            "unknown-0-of-4.csv",
            "unknown-5-of-4.csv",
            "unknown-1.csv",
            "unknown.html",
        ] {
            assert_eq!(Shard::from_name(name), None, "{name}");
        }
    }
}
