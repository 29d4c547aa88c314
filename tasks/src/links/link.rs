//! One link: keeps the newest message with its time, and knows the age beyond which no reader may use it.

use embassy_time::{Duration, Instant};

use super::last_value::{LastValue, Receiver};

/// A value with its time of measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped<T> {
    /// Time of measurement.
    pub at: Instant,
    /// The measured value.
    pub value: T,
}

impl<T> Stamped<T> {
    /// The value, unless it is older than `limit` now.
    pub fn fresh(self, limit: Duration) -> Option<T> {
        self.fresh_at(Instant::now(), limit)
    }

    /// The value, unless it is older than `limit` at `now`.
    #[inline]
    pub fn fresh_at(self, now: Instant, limit: Duration) -> Option<T> {
        self.is_fresh(now, limit).then_some(self.value)
    }

    /// True unless it is older than `limit` at `now`.
    #[inline]
    pub fn is_fresh(&self, now: Instant, limit: Duration) -> bool {
        now.saturating_duration_since(self.at) <= limit
    }
}

/// The newest message of a link, for readers that also use stale ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Newest<T> {
    /// Measured within the link's limit.
    Fresh(Stamped<T>),
    /// Older than the link's limit: last known value.
    Held(Stamped<T>),
}

/// A link that keeps the newest message.
pub struct Link<T: Clone> {
    newest: LastValue<Stamped<T>>,
    /// Age beyond which a reader must not use the message.
    pub stale_after: Duration,
}

impl<T: Clone> Link<T> {
    pub(super) const fn new(stale_after: Duration) -> Self {
        Self {
            newest: LastValue::new(),
            stale_after,
        }
    }

    /// Publishes `value`, measured at `at`.
    pub fn send(&self, at: Instant, value: T) {
        self.newest.send(Stamped { at, value });
    }

    /// The newest message, however old.
    pub fn latest(&self) -> Option<Stamped<T>> {
        self.newest.look(Clone::clone)
    }

    /// Applies `f` to the newest message, however old.
    #[inline]
    pub fn look<R>(&self, f: impl FnOnce(&Stamped<T>) -> R) -> Option<R> {
        self.newest.look(f)
    }

    /// The newest message, unless it is stale.
    pub fn fresh(&self) -> Option<T> {
        self.fresh_to(Instant::now(), T::clone)
    }

    /// Applies `f` to the newest message, unless it is stale at `now`.
    #[inline]
    pub fn fresh_to<R>(&self, now: Instant, f: impl FnOnce(&T) -> R) -> Option<R> {
        self.look(|m| m.is_fresh(now, self.stale_after).then(|| f(&m.value)))
            .flatten()
    }

    /// The newest message, marked as fresh or held.
    pub fn newest(&self) -> Option<Newest<T>> {
        self.latest().map(|m| match m.clone().fresh(self.stale_after) {
            Some(_) => Newest::Fresh(m),
            None => Newest::Held(m),
        })
    }

    /// A receiver that can wait for the next message; `None` when all [`RECEIVERS`](super::last_value::RECEIVERS) are taken.
    pub fn receiver(&self) -> Option<Receiver<'_, Stamped<T>>> {
        self.newest.receiver()
    }
}
