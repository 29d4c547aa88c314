//! The parameter protocol on the one table: every value is a float, read and set by name or index.
//!
//! A new value goes into a working copy. The copy is stored `SETTLE` after the last change and is in force after a
//! restart, as at the console: the vehicle flies only with parameters that were in force when it was checked on the
//! ground.

use sophie_control::params::{ParamError, Params};

use crate::services::telemetry::text;
use sophie_dialect::{MavParamType, PARAM_VALUE_DATA};

/// Time from the last change to storing, µs.
const SETTLE: u64 = 1_000_000;

/// Index of a parameter in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place(u16);

/// Reason for not setting a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetError {
    /// No parameter has this name or index.
    Unknown,
    /// Not while armed.
    Armed,
    /// The value is not a float.
    Type,
    /// Out of its range, not one of its choices, or not a number.
    NotAllowed(&'static str),
}

/// The working copy, which is read and set.
#[derive(Clone, Debug)]
pub struct Parameters {
    copy: Params,
    /// Time of the newest change, µs; `None` once it is stored.
    changed_at: Option<u64>,
    /// The next parameter of the running list, and the number still to send.
    next: u16,
    listed: u16,
}

impl Parameters {
    /// A copy of `params`, which are in force.
    pub const fn new(params: Params) -> Self {
        Self {
            copy: params,
            changed_at: None,
            next: 0,
            listed: 0,
        }
    }

    /// The place of the parameter at `index`, or of the one named in `id` if `index` is negative.
    pub fn find(&self, id: &[u8; 16], index: i16) -> Result<Place, SetError> {
        let at = match usize::try_from(index) {
            Ok(at) => Some(at).filter(|&at| at < Params::TABLE.len()),
            Err(_) => {
                let name = id.split(|&byte| byte == 0).next().unwrap_or_default();
                // MAVProxy sends names in capitals.
                Params::TABLE
                    .iter()
                    .position(|row| row.name.as_bytes().eq_ignore_ascii_case(name))
            }
        };
        at.map(|at| Place(at as u16)).ok_or(SetError::Unknown)
    }

    /// The message with a parameter's value.
    pub fn value(&self, Place(at): Place) -> Option<PARAM_VALUE_DATA> {
        let row = Params::TABLE.get(usize::from(at))?;
        Some(PARAM_VALUE_DATA {
            param_value: self.copy.get(row.name)?,
            param_count: Params::TABLE.len() as u16,
            param_index: at,
            param_id: text::<16>(row.name).into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32 as u8,
        })
    }

    /// Sets a parameter while the vehicle is `at_rest`.
    ///
    /// # Errors
    /// The reason; the copy is unchanged.
    pub fn set(
        &mut self,
        Place(at): Place,
        value: f32,
        kind: u8,
        at_rest: bool,
        now: u64,
    ) -> Result<(), SetError> {
        let row = Params::TABLE.get(usize::from(at)).ok_or(SetError::Unknown)?;
        if !at_rest {
            return Err(SetError::Armed);
        }
        if kind != MavParamType::MAV_PARAM_TYPE_REAL32 as u8 {
            return Err(SetError::Type);
        }
        self.copy.set(row.name, value).map_err(|why| match why {
            ParamError::Unknown => SetError::Unknown,
            ParamError::NotAllowed(row) => SetError::NotAllowed(row.name),
        })?;
        self.changed_at = Some(now);
        Ok(())
    }

    /// Sets the parameter called `name` to a calibrated value; `None` if the value is not allowed.
    pub fn put(&mut self, name: &str, value: f32, now: u64) -> Option<Place> {
        self.copy.set(name, value).ok()?;
        self.changed_at = Some(now);
        let at = Params::TABLE.iter().position(|row| row.name == name)?;
        Some(Place(at as u16))
    }

    /// Begins a list of all parameters. A list that is already being sent continues to its end and then once round: all
    /// stations hear it, and a restart at each request would never end.
    pub fn list(&mut self) {
        if self.listed == 0 {
            self.next = 0;
        }
        self.listed = Params::TABLE.len() as u16;
    }

    /// The next parameter of the list.
    pub fn listed(&mut self) -> Option<Place> {
        self.listed = self.listed.checked_sub(1)?;
        let at = self.next;
        let following = at + 1;
        let more = usize::from(following) < Params::TABLE.len();
        self.next = if more { following } else { 0 };
        Some(Place(at))
    }

    /// True if the copy must be stored now: once for each change.
    pub fn to_store(&mut self, at_rest: bool, now: u64) -> bool {
        let settled = self
            .changed_at
            .is_some_and(|at| at_rest && now.saturating_sub(at) >= SETTLE);
        if settled {
            self.changed_at = None;
        }
        settled
    }

    /// Takes over parameters that another line set and stores.
    pub const fn follow(&mut self, params: &Params) {
        self.copy = *params;
    }

    /// The working copy.
    pub const fn copy(&self) -> &Params {
        &self.copy
    }
}
