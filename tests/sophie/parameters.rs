//! docs/parameters.md is printed from the table.

use std::fmt::Write;

use sophie_control::params::{Params, RENAMED};
use sophie_tasks::storage::parameters::Allowed;

fn page() -> String {
    let mut page = String::from(
        "# Parameters\n\n\
         The table of `control/inner_loop/src/params/table.rs`, as this firmware has it; a board may have other defaults for what is\n\
         soldered to it. They are set at the [console](console.md), by `sophie params load FILE`\n\
         ([a file of them](console.md#parameters-as-a-file)) and in the `[params]` of a scenario file. What has names takes the\n\
         name or the number in front of it.\n\n\
         | name | takes | default | what it is |\n|---|---|---|---|\n",
    );
    for row in Params::TABLE {
        let (name, allowed, default, doc) = (row.name, Allowed(row), row.default, row.doc().trim());
        let _ = writeln!(page, "| `{name}` | {allowed} | {default} | {doc} |");
    }
    page += "\n## Earlier names\n\n\
             Stored sets, the console and scenario files still take them; numbers are in the old unit and are converted. Of a\n\
             stored set that has both, the new name counts, since only firmware that knows it can have written it.\n\n\
             | was | unit | is | unit |\n|---|---|---|---|\n";
    for renamed in RENAMED {
        let unit = Params::row(renamed.new).map_or("", |row| row.unit);
        let _ = writeln!(
            page,
            "| `{}` | {} | `{}` | {unit} |",
            renamed.old, renamed.unit, renamed.new
        );
    }
    page
}

#[test]
fn the_page_is_the_table() {
    sophie_pages::is("parameters.md", &page(), "--test sophie parameters::");
}

#[test]
fn the_page_of_calibration_has_every_mounting() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/calibration.md");
    let page = std::fs::read_to_string(page).unwrap();
    let row = Params::row("imu_mounting").unwrap();
    for choice in row.choices {
        let named = format!("{} `{}`", choice.value, choice.name);
        assert!(page.contains(&named), "docs/calibration.md has no {named}");
    }
    assert_eq!(row.choices.len(), 24);
}
