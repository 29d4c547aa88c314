//! The files of `mavlink/files` are printed from the table of parameters.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::{env, fs};

use lzma_rust2::{CheckType, XzOptions, XzReader, XzWriter};
use serde_json::{Map, Number, Value, json};
use sophie_control::params::{NAME_MAX, ParamInfo, Params};
use sophie_mavlink::services::files::{FILES, GENERAL, PARAMETER, crc32};

/// COMP_METADATA_TYPE_PARAMETER.
const PARAMETER_TYPE: u32 = 1;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// As few digits as say the same 32 bits.
fn number(value: f32) -> Value {
    Value::Number(value.to_string().parse::<Number>().unwrap())
}

/// Parameters for which some board has its own default: they have none here, since the file is the same on all boards.
fn boards_own() -> Vec<String> {
    let boards = fs::read_dir(folder("../boards/src")).unwrap();
    let paths = boards
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file());
    let mut names = Vec::new();
    for text in paths.map(|path| fs::read_to_string(path).unwrap()) {
        let Some((_, rest)) = text.split_once("static DEFAULTS: Params = Params {") else {
            continue;
        };
        let (fields, _) = rest.split_once("..Params::DEFAULT").unwrap();
        let own = fields.lines().filter_map(|line| line.trim().split_once(':'));
        names.extend(own.map(|(name, _)| name.to_owned()));
    }
    assert!(names.iter().any(|name| name == "battery_divider"), "{names:?}");
    names
}

fn described(row: &ParamInfo, own: &[String]) -> Value {
    let words: Vec<_> = row.doc().split_whitespace().collect();
    let text = words.join(" ");
    let short = text
        .split_once(". ")
        .map_or(text.trim_end_matches('.'), |(first, _)| first);
    let group = row.name.split_once('_').map_or(row.name, |(group, _)| group);
    let mut entry = Map::from_iter([
        ("name".to_owned(), json!(row.name)),
        ("type".to_owned(), json!("Float")),
        ("group".to_owned(), json!(group)),
        ("shortDesc".to_owned(), json!(short)),
        ("min".to_owned(), number(row.min)),
        ("max".to_owned(), number(row.max)),
        ("rebootRequired".to_owned(), json!(true)),
    ]);
    if text.trim_end_matches('.') != short {
        entry.insert("longDesc".to_owned(), json!(text));
    }
    if row.unit != "1" {
        entry.insert("units".to_owned(), json!(row.unit));
    }
    if !own.iter().any(|name| name == row.name) {
        entry.insert("default".to_owned(), number(row.default));
    }
    if !row.choices.is_empty() {
        let values = row.choices.iter().map(|choice| {
            let named = !choice.name.is_empty();
            let text = if named {
                choice.name.to_owned()
            } else {
                choice.value.to_string()
            };
            json!({ "value": number(choice.value), "description": text })
        });
        entry.insert("values".to_owned(), values.collect());
    }
    Value::Object(entry)
}

fn parameter() -> String {
    let own = boards_own();
    let rows: Vec<_> = Params::TABLE.iter().map(|row| described(row, &own)).collect();
    json!({ "version": 3, "parameters": rows }).to_string()
}

fn general(parameter: &str) -> String {
    json!({
        "version": 1,
        "vendorName": "SOPHIE",
        "modelName": "soft quadrotor",
        "firmwareVersion": env!("CARGO_PKG_VERSION"),
        "metadataTypes": [{
            "type": PARAMETER_TYPE,
            "uri": format!("mftp:///{}", PARAMETER.path),
            "fileCrc": crc32(parameter.as_bytes()),
        }],
    })
    .to_string()
}

/// With the check that every unpacker knows.
fn packed(text: &str) -> Vec<u8> {
    let mut options = XzOptions::with_preset(9);
    options.set_check_sum_type(CheckType::Crc32);
    let mut writer = XzWriter::new(Vec::new(), options).unwrap();
    writer.write_all(text.as_bytes()).unwrap();
    writer.finish().unwrap()
}

fn unpacked(bytes: &[u8]) -> String {
    let mut text = String::new();
    let read = XzReader::new(bytes, false).read_to_string(&mut text);
    read.map(|_| text).unwrap_or_default()
}

#[test]
fn the_files_are_what_the_table_says() {
    let wanted = parameter();
    let about = general(&wanted);
    if env::var_os("WRITE_DOCS").is_some() {
        fs::write(folder("files").join(GENERAL.path), about).unwrap();
        fs::write(folder("files").join(PARAMETER.path), packed(&wanted)).unwrap();
        return;
    }
    assert!(
        unpacked(PARAMETER.bytes) == wanted && GENERAL.bytes == about.as_bytes(),
        "mavlink/files is old: WRITE_DOCS=1 cargo test --package sophie-mavlink --test mavlink metadata::"
    );
}

#[test]
fn the_files_are_small_enough_for_the_smallest_board() {
    let bytes: usize = FILES.iter().map(|file| file.bytes.len()).sum();
    // A row packs into 45 bytes.
    assert!(bytes <= 45 * Params::TABLE.len(), "{bytes} bytes");
}

/// What MAVLink's schema of the file wants (component_metadata/parameter.schema.json, version 3).
#[test]
fn the_parameters_file_keeps_to_mavlinks_schema() {
    const TEXTS: [&str; 6] = ["name", "type", "group", "shortDesc", "longDesc", "units"];
    let file: Value = serde_json::from_str(&unpacked(PARAMETER.bytes)).unwrap();
    assert!(file["version"].as_u64().unwrap() >= 3);
    let rows = file["parameters"].as_array().unwrap();
    assert_eq!(rows.len(), Params::TABLE.len());
    for row in rows {
        let name = row["name"].as_str().unwrap();
        assert!((1..=NAME_MAX).contains(&name.len()), "{name}");
        let known = |b: u8| b.is_ascii_alphanumeric() || b"._-".contains(&b);
        assert!(name.bytes().all(known), "{name}");
        for (key, value) in row.as_object().unwrap() {
            let fits = match key.as_str() {
                "default" | "min" | "max" => value.is_number(),
                "rebootRequired" => value.is_boolean(),
                "values" => {
                    let mut choices = value.as_array().unwrap().iter();
                    choices.all(|choice| choice["value"].is_number() && choice["description"].is_string())
                }
                key => TEXTS.contains(&key) && value.is_string(),
            };
            assert!(fits, "{name}: {key} is {value}");
        }
    }
}
