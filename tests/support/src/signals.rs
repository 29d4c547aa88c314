//! Signals and calls that wait.

use std::io::{ErrorKind, Result};

/// Repeats `call` while a signal interrupts it: the system does not restart one that waits on a socket with a time limit
/// (signal(7)).
///
/// # Errors
/// Any other of `call`.
pub fn uninterrupted<T>(mut call: impl FnMut() -> Result<T>) -> Result<T> {
    loop {
        match call() {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            other => return other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interrupted_call_is_made_again_and_another_failure_is_told() {
        let mut answers = vec![
            Err(ErrorKind::TimedOut.into()),
            Ok(7),
            Err(ErrorKind::Interrupted.into()),
        ];
        let mut call = || uninterrupted(|| answers.pop().unwrap());
        assert_eq!(call().unwrap(), 7);
        assert_eq!(call().unwrap_err().kind(), ErrorKind::TimedOut);
    }
}
