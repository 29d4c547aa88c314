//! Rules by which a flight is judged.

/// What a grip must do for the mission to be accomplished.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rule {
    /// The paper's: 950 N/m² at each sensor, within the tolerance and the error of a simulated sensor.
    #[default]
    Paper,
    /// The grip holds a push from any side, at its proof and after a time on the pipe, and nothing is overloaded.
    Holding,
}

impl Rule {
    /// Words of a scenario file and of the command line.
    pub const WORDS: &'static [&'static str] = &["paper", "holding"];

    /// A word from [`Rule::WORDS`].
    #[must_use]
    pub fn from_word(word: &str) -> Self {
        if word == "holding" {
            Self::Holding
        } else {
            Self::Paper
        }
    }

    /// Its word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Holding => "holding",
        }
    }
}
