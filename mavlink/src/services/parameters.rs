//! The parameter protocol on the one table: every value is a float, read and set by name or place.
//!
//! What is set goes into a copy, which is stored `SETTLE` after the last change and is in force after a restart, as at
//! the console: what flies is what was looked at on the ground.

use sophie_control::params::{ParamError, Params};

use crate::services::telemetry::text;
use sophie_dialect::{MavParamType, PARAM_VALUE_DATA};

/// Time from the last change to storing, µs.
const SETTLE: u64 = 1_000_000;

/// Which parameter is to be said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place(u16);

/// Why a parameter was not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// No parameter has this name or place.
    Unknown,
    /// Not while armed.
    Armed,
    /// A float is asked for.
    Type,
    /// Out of its range, none of its choices, or no number.
    NotAllowed(&'static str),
}

/// The copy that is read and set.
#[derive(Clone, Debug)]
pub struct Parameters {
    copy: Params,
    /// When the newest change came, µs; `None` where all is stored.
    changed_at: Option<u64>,
    /// The next of a list that was asked for, and how many are still to be said.
    next: u16,
    listed: u16,
}

impl Parameters {
    /// With `params` in force.
    pub const fn new(params: Params) -> Self {
        Self {
            copy: params,
            changed_at: None,
            next: 0,
            listed: 0,
        }
    }

    /// The place of the parameter named in `id`, or of the one at `index` where that is not negative.
    pub fn find(&self, id: &[u8; 16], index: i16) -> Result<Place, Refused> {
        let at = match usize::try_from(index) {
            Ok(at) => Some(at).filter(|&at| at < Params::TABLE.len()),
            Err(_) => {
                let name = id.split(|&byte| byte == 0).next().unwrap_or_default();
                // MAVProxy asks in capitals.
                Params::TABLE
                    .iter()
                    .position(|row| row.name.as_bytes().eq_ignore_ascii_case(name))
            }
        };
        at.map(|at| Place(at as u16)).ok_or(Refused::Unknown)
    }

    /// What is said of a parameter.
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
    /// Nothing is changed then.
    pub fn set(
        &mut self,
        Place(at): Place,
        value: f32,
        kind: u8,
        at_rest: bool,
        now: u64,
    ) -> Result<(), Refused> {
        let row = Params::TABLE.get(usize::from(at)).ok_or(Refused::Unknown)?;
        if !at_rest {
            return Err(Refused::Armed);
        }
        if kind != MavParamType::MAV_PARAM_TYPE_REAL32 as u8 {
            return Err(Refused::Type);
        }
        self.copy.set(row.name, value).map_err(|why| match why {
            ParamError::Unknown => Refused::Unknown,
            ParamError::NotAllowed(row) => Refused::NotAllowed(row.name),
        })?;
        self.changed_at = Some(now);
        Ok(())
    }

    /// Puts what was found into the parameter called `name`.
    pub fn put(&mut self, name: &str, value: f32, now: u64) -> Option<Place> {
        self.copy.set(name, value).ok()?;
        self.changed_at = Some(now);
        let at = Params::TABLE.iter().position(|row| row.name == name)?;
        Some(Place(at as u16))
    }

    /// Begins a list of all. What was said of one under way counts for who asked before: it goes on, once round, for all
    /// hear it, and begun again at each question it would never end.
    pub fn list(&mut self) {
        if self.listed == 0 {
            self.next = 0;
        }
        self.listed = Params::TABLE.len() as u16;
    }

    /// The next of the list.
    pub fn listed(&mut self) -> Option<Place> {
        self.listed = self.listed.checked_sub(1)?;
        let at = self.next;
        let following = at + 1;
        let more = usize::from(following) < Params::TABLE.len();
        self.next = if more { following } else { 0 };
        Some(Place(at))
    }

    /// The copy, where it is to be stored now: once for each change.
    pub fn to_store(&mut self, at_rest: bool, now: u64) -> bool {
        let settled = self
            .changed_at
            .is_some_and(|at| at_rest && now.saturating_sub(at) >= SETTLE);
        if settled {
            self.changed_at = None;
        }
        settled
    }

    /// Takes over what was set elsewhere, by whom it is stored.
    pub const fn follow(&mut self, params: &Params) {
        self.copy = *params;
    }

    /// The copy.
    pub const fn copy(&self) -> &Params {
        &self.copy
    }
}
