//! The newest value, and who waits for the next.

use core::task::Poll;

use embassy_futures::poll_once;
use sophie_tasks::last_value::LastValue;
use sophie_tasks::links::RECEIVERS;

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
    // A value that was there before it is new to a receiver.
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
