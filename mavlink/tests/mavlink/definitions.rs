//! `generated/dialect.rs` is what the generator makes of `definitions/`:
//! `WRITE_DIALECT=1 cargo test --package sophie-mavlink --test mavlink definitions::` writes it.

use std::fs;
use std::path::{Path, PathBuf};

use mavlink_bindgen::{XmlDefinitions, format_generated_code, generate};

#[test]
fn the_messages_are_those_of_the_definitions() {
    let home = Path::new(env!("CARGO_MANIFEST_DIR"));
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("dialect");
    fs::create_dir_all(&out).unwrap();
    let made = generate(
        XmlDefinitions::Files(vec![home.join("definitions/sophie.xml")]),
        &out,
    )
    .unwrap();
    let rules = fs::read_to_string(home.join("../rustfmt.toml")).unwrap();
    fs::write(out.join("rustfmt.toml"), rules + "edition = \"2024\"\n").unwrap();
    format_generated_code(&made);
    // The boards have no std, and the generator does not say so.
    let made = "#![no_std]\n".to_owned() + &fs::read_to_string(out.join("sophie.rs")).unwrap();
    let kept = home.join("generated/dialect.rs");
    if std::env::var_os("WRITE_DIALECT").is_some() {
        fs::write(&kept, made).unwrap();
    } else {
        assert!(
            made == fs::read_to_string(kept).unwrap(),
            "run it with WRITE_DIALECT=1"
        );
    }
}
