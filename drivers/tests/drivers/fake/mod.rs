//! Fake chips and buses in virtual time.

pub mod dps310;
pub mod fram;
pub mod i2c;
pub mod ms5611;
pub mod spi;

use std::cell::RefCell;
use std::future::Future;
use std::rc::Rc;

use sophie_clock::VirtualTime;

/// Runs `future` on its own clock, for at most ten minutes.
pub fn run<T: 'static>(future: impl Future<Output = T> + 'static) -> T {
    let time = VirtualTime::new();
    let result = Rc::new(RefCell::new(None));
    let slot = result.clone();
    time.spawn(async move {
        let value = future.await;
        *slot.borrow_mut() = Some(value);
    });
    for second in 1..=600 {
        time.run_until(second * 1_000_000);
        if result.borrow().is_some() {
            break;
        }
    }
    result.take().expect("the test did not end")
}
