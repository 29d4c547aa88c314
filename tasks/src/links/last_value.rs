//! Newest value for readers at every level, read in place: the lock masks interrupts, so readers copy only the fields
//! that they need.

use core::cell::RefCell;
use core::future::poll_fn;
use core::task::{Context, Poll};

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::waitqueue::MultiWakerRegistration;

/// Mutex of every link, shared by tasks of different priority.
pub type Raw = CriticalSectionRawMutex;

/// Most receivers of one link.
pub const RECEIVERS: usize = 8;

/// A value and the wakers of its receivers. A closure that runs on the value in place holds the lock; a nested access
/// to the same `LastValue` finds it empty.
pub struct LastValue<T> {
    state: Mutex<Raw, RefCell<State<T>>>,
}

struct State<T> {
    value: Option<T>,
    /// Values sent, modulo 2^32.
    sent: u32,
    receivers: usize,
    wakers: MultiWakerRegistration<RECEIVERS>,
}

impl<T> Default for LastValue<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> LastValue<T> {
    /// Without a value.
    pub const fn new() -> Self {
        Self {
            state: Mutex::new(RefCell::new(State {
                value: None,
                sent: 0,
                receivers: 0,
                wakers: MultiWakerRegistration::new(),
            })),
        }
    }

    /// Replaces the value and wakes waiting receivers.
    #[inline]
    pub fn send(&self, value: T) {
        self.with(|state| {
            state.value = Some(value);
            state.sent = state.sent.wrapping_add(1);
            state.wakers.wake();
        });
    }

    /// Applies `f` to the value; `None` before the first.
    #[inline]
    pub fn look<R>(&self, f: impl FnOnce(&T) -> R) -> Option<R> {
        self.with(|state| state.value.as_ref().map(f)).flatten()
    }

    /// A receiver; `None` when all [`RECEIVERS`] are taken.
    pub fn receiver(&self) -> Option<Receiver<'_, T>> {
        self.with(|state| {
            let free = state.receivers < RECEIVERS;
            state.receivers += usize::from(free);
            free.then_some(Receiver {
                newest: self,
                // A value already there is new to it.
                seen: state.sent.wrapping_sub(1),
            })
        })
        .flatten()
    }

    #[inline]
    fn with<R>(&self, f: impl FnOnce(&mut State<T>) -> R) -> Option<R> {
        // Borrowed nowhere else while the lock is held.
        self.state
            .lock(|state| state.try_borrow_mut().ok().map(|mut state| f(&mut state)))
    }
}

/// Waits for unseen values.
pub struct Receiver<'a, T> {
    newest: &'a LastValue<T>,
    /// `sent` at the last value seen.
    seen: u32,
}

impl<T> Receiver<'_, T> {
    /// Next unseen value; of several, the newest.
    pub async fn changed(&mut self) -> T
    where
        T: Clone,
    {
        self.changed_to(T::clone).await
    }

    /// Applies `f` to the next unseen value.
    #[inline]
    pub async fn changed_to<R>(&mut self, mut f: impl FnMut(&T) -> R) -> R {
        poll_fn(|cx| self.poll(cx, &mut f)).await
    }

    #[inline]
    fn poll<R>(&mut self, cx: &Context<'_>, f: &mut impl FnMut(&T) -> R) -> Poll<R> {
        let seen = &mut self.seen;
        let found = self.newest.with(|state| match &state.value {
            Some(value) if state.sent != *seen => {
                *seen = state.sent;
                Some(f(value))
            }
            _ => {
                state.wakers.register(cx.waker());
                None
            }
        });
        found.flatten().map_or(Poll::Pending, Poll::Ready)
    }
}

impl<T> Drop for Receiver<'_, T> {
    fn drop(&mut self) {
        self.newest
            .with(|state| state.receivers = state.receivers.saturating_sub(1));
    }
}

#[cfg(test)]
mod tests {
    use embassy_futures::poll_once;
    // Critical section of host tests.
    use sophie_clock as _;

    use super::*;

    /// After 2^32 - 1 messages: 49 days at 1 kHz.
    fn about_to_wrap() -> LastValue<u32> {
        let link = LastValue::new();
        link.with(|state: &mut State<u32>| state.sent = u32::MAX);
        link
    }

    #[test]
    fn every_value_is_seen_when_the_number_of_values_wraps() {
        let link = about_to_wrap();
        let mut receiver = link.receiver().unwrap();
        assert!(poll_once(receiver.changed()).is_pending());
        for value in 0..3 {
            link.send(value);
            assert_eq!(poll_once(receiver.changed()), Poll::Ready(value));
            assert!(poll_once(receiver.changed()).is_pending());
        }
    }

    #[test]
    fn a_new_receiver_sees_the_value_whose_number_is_zero() {
        let link = about_to_wrap();
        link.send(7);
        assert_eq!(poll_once(link.receiver().unwrap().changed()), Poll::Ready(7));
    }
}
