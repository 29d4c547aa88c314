//! Allocation.

/// The allocation law in use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Variant {
    /// The arms are taken as stiff.
    Rigid,
    /// Algorithm 1 verbatim in the printed matrix (with its singular yaw row mended).
    Paper,
    /// The full effectiveness inverted at the frozen arm angle: for study, it limit-cycles.
    Frozen,
    /// The quasi-static Jacobian about the low-passed thrust: what flies.
    #[default]
    Flexible,
}
