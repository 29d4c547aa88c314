//! The paper's tables and figures, computed and flown beside the printed numbers (`paper/printed.toml`). One file per section.

mod arm;
mod beyond;
mod clamp;
mod endurance;
mod fatigue;
mod flights;
mod inspection;
mod mass;
mod mixer;
pub mod printed;
mod roll;
mod stability;
mod statics;
mod translation;

use self::printed::Printed;
use crate::results::model::Section;

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
