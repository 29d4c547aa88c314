//! Every table and figure of the paper, computed and flown beside the printed numbers (`printed.toml`). One file per
//! section.

mod arm;
pub mod bench_data;
mod beyond;
mod chart;
mod clamp;
mod csv;
mod endurance;
mod fatigue;
pub mod fit;
pub mod fit_report;
mod flights;
mod inspection;
pub mod json;
mod least_squares;
mod mass;
mod mixer;
pub mod model;
pub mod page;
pub mod printed;
mod roll;
mod stability;
mod statics;
pub mod study;
pub mod tendon_data;
pub mod tendon_fit;
pub mod text;
mod translation;

use self::model::Section;
use self::printed::Printed;

type Work = fn(&Printed) -> Section;

/// The sections, in the order of the paper.
pub const SECTIONS: &[Work] = &[
    arm::section,
    mass::section,
    mixer::section,
    stability::section,
    roll::section,
    clamp::section,
    translation::section,
    endurance::section,
    fatigue::section,
    beyond::section,
];

/// Title of the page.
pub const TITLE: &str = "SOPHIE: the paper's results, reproduced and corrected";
/// What stands under it.
pub const LEAD: &str = "Every table and figure of Ruiz, Arrue and Ollero (IEEE RA-L 2022), computed or flown with this \
                        flight stack on a simulated vehicle. No hardware was involved. The model, its parameters and \
                        their sources are in docs/paper.md.";
