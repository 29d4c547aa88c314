//! The newest value, and those waiting for the next.

use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::task::{Wake, Waker};

use embassy_futures::poll_once;
use sophie_tasks::links::last_value::{LastValue, RECEIVERS};

#[test]
fn each_value_is_seen_once_and_the_newest_of_several() {
    let link = LastValue::new();
    let mut receiver = link.receiver().unwrap();
    assert!(poll_once(receiver.changed()).is_pending() && link.look(|_: &u32| ()).is_none());
    link.send(1);
    link.send(2);
    assert_eq!(poll_once(receiver.changed()), Poll::Ready(2));
    assert!(poll_once(receiver.changed()).is_pending());
    assert_eq!(link.look(|value| *value), Some(2));
    // An earlier value is new to a receiver.
    assert_eq!(
        poll_once(link.receiver().unwrap().changed_to(|v| v + 1)),
        Poll::Ready(3)
    );
}

#[test]
fn receivers_are_limited_and_given_back() {
    let link = LastValue::<u8>::new();
    let all: [_; RECEIVERS] = core::array::from_fn(|_| link.receiver());
    assert!(all.iter().all(Option::is_some) && link.receiver().is_none());
    drop(all);
    assert!(link.receiver().is_some());
}

#[derive(Default)]
struct Woken(AtomicUsize);

impl Wake for Woken {
    fn wake(self: Arc<Self>) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

impl Woken {
    fn times(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }
}

fn poll_as<F: Future>(of: &Arc<Woken>, future: F) -> Poll<F::Output> {
    pin!(future).poll(&mut Context::from_waker(&Waker::from(of.clone())))
}

#[test]
fn a_value_wakes_all_who_wait_and_no_other() {
    let link = LastValue::new();
    let tasks: [Arc<Woken>; RECEIVERS] = core::array::from_fn(|_| Arc::default());
    let mut receivers: [_; RECEIVERS] = core::array::from_fn(|_| link.receiver().unwrap());
    for (task, receiver) in tasks.iter().zip(&mut receivers).skip(1) {
        // Twice, as a task polled for another reason.
        assert!(poll_as(task, receiver.changed()).is_pending());
        assert!(poll_as(task, receiver.changed()).is_pending());
    }
    link.send(5);
    // The second value wakes those that have asked again.
    assert_eq!(poll_as(&tasks[1], receivers[1].changed()), Poll::Ready(5));
    assert!(poll_as(&tasks[1], receivers[1].changed()).is_pending());
    link.send(6);
    let times: [usize; RECEIVERS] = core::array::from_fn(|i| tasks[i].times());
    assert_eq!(times[..2], [0, 2]);
    assert!(times[2..].iter().all(|n| *n == 1), "{times:?}");
    assert_eq!(poll_as(&tasks[0], receivers[0].changed()), Poll::Ready(6));
}

#[test]
fn who_waits_is_woken_even_when_more_tasks_have_asked_than_there_is_room() {
    let link = LastValue::<u8>::new();
    let waiting = Arc::<Woken>::default();
    let mut receiver = link.receiver().unwrap();
    assert!(poll_as(&waiting, receiver.changed()).is_pending());
    // Abandoned waits leave their tasks behind.
    for _ in 0..RECEIVERS {
        let given_up = Arc::<Woken>::default();
        assert!(poll_as(&given_up, link.receiver().unwrap().changed()).is_pending());
    }
    // Evicted for lack of room, it was woken to ask again.
    assert_eq!(waiting.times(), 1);
    assert!(poll_as(&waiting, receiver.changed()).is_pending());
    link.send(1);
    assert_eq!(waiting.times(), 2);
}

#[test]
fn a_wait_that_is_given_up_loses_no_value() {
    let link = LastValue::new();
    let mut receiver = link.receiver().unwrap();
    assert!(poll_once(receiver.changed()).is_pending());
    link.send(3);
    // A future dropped before it is polled has seen nothing.
    drop(receiver.changed());
    assert_eq!(poll_once(receiver.changed()), Poll::Ready(3));
}
