//! Response-time analysis: bounds for tasks under fixed priorities.
//!
//! Recurrence of Joseph and Pandya (1986) and Audsley et al. (1993) with release jitter (Tindell 1994):
//!
//! w = C + S + B + Σ ceil((w + J_k) / T_k) C_k over every k that may go first
//!
//! Tasks of one level do not preempt each other and have no order: each counts as more urgent, which also bounds the
//! wait for a running one. S is the task's wait for a bus, B the time for which lower levels mask interrupts.

/// A task or an interrupt; times in µs.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Name.
    pub name: String,
    /// Level; a smaller one preempts.
    pub level: u8,
    /// Longest execution of a release.
    pub execution: f64,
    /// Mean time between releases.
    pub period: f64,
    /// Largest deviation of a release from its period.
    pub jitter: f64,
    /// Longest wait off the processor.
    pub waited: f64,
}

/// Iterations after which no bound is assumed to exist.
const ROUNDS: usize = 10_000;

/// Largest response of `loads[index]`, µs after release, with `blocking` from below; `None` beyond the period, after
/// which the next release would wait too.
#[must_use]
pub fn response(loads: &[Load], index: usize, blocking: f64) -> Option<f64> {
    let own = loads.get(index)?;
    let first = || {
        let others = loads.iter().enumerate().filter(move |(n, _)| *n != index);
        others.filter(|(_, l)| l.level <= own.level).map(|(_, l)| l)
    };
    let mut window = own.execution + own.waited + blocking;
    for _ in 0..ROUNDS {
        let before: f64 = first()
            .map(|l| ((window + l.jitter) / l.period).ceil().max(1.0) * l.execution)
            .sum();
        let next = own.execution + own.waited + blocking + before;
        if next > own.period {
            return None;
        }
        if next <= window {
            return Some(next);
        }
        window = next;
    }
    None
}

/// Utilisation of the processor.
#[must_use]
pub fn utilisation(loads: &[Load]) -> f64 {
    loads.iter().map(|l| l.execution / l.period).sum()
}

/// Utilisation up to which any `count` independent rate-monotonic tasks meet deadlines equal to their periods (Liu and
/// Layland 1973).
#[must_use]
pub fn rate_monotonic_bound(count: usize) -> f64 {
    let n = count.max(1) as f64;
    n * ((1.0 / n).exp2() - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(level: u8, execution: f64, period: f64) -> Load {
        Load {
            name: String::new(),
            level,
            execution,
            period,
            jitter: 0.0,
            waited: 0.0,
        }
    }

    /// Burns and Wellings, Real-Time Systems and Programming Languages: task set of the worked recurrence.
    fn burns_wellings() -> Vec<Load> {
        vec![load(0, 3.0, 7.0), load(1, 3.0, 12.0), load(2, 5.0, 20.0)]
    }

    #[test]
    fn the_example_of_burns_and_wellings_comes_out() {
        let loads = burns_wellings();
        let bounds = [0, 1, 2].map(|n| response(&loads, n, 0.0));
        assert_eq!(bounds, [Some(3.0), Some(6.0), Some(20.0)]);
    }

    #[test]
    fn blocking_waiting_and_jitter_lengthen_it() {
        let mut loads = burns_wellings();
        // w = 3 + 1 + ceil((w + 0) / 7) 3 = 7; a jitter of 1 adds the second release: 10.
        assert_eq!(response(&loads, 1, 1.0), Some(7.0));
        loads[0].jitter = 1.0;
        assert_eq!(response(&loads, 1, 1.0), Some(10.0));
        loads[1].waited = 2.0;
        assert_eq!(response(&loads, 1, 1.0), Some(12.0));
    }

    #[test]
    fn tasks_of_one_level_each_wait_for_the_other() {
        let loads = vec![load(0, 3.0, 20.0), load(0, 4.0, 20.0)];
        assert_eq!(response(&loads, 0, 0.0), Some(7.0));
        assert_eq!(response(&loads, 1, 0.0), Some(7.0));
    }

    #[test]
    fn an_overloaded_processor_has_no_bound() {
        let loads = vec![load(0, 4.0, 5.0), load(1, 3.0, 10.0)];
        assert_eq!(response(&loads, 1, 0.0), None);
        assert!(utilisation(&loads) > 1.0);
    }

    #[test]
    fn the_bound_of_liu_and_layland() {
        assert!((rate_monotonic_bound(1) - 1.0).abs() < 1e-12);
        assert!((rate_monotonic_bound(2) - 0.828_427).abs() < 1e-6);
        assert!((rate_monotonic_bound(1000) - 2f64.ln()).abs() < 1e-3);
    }
}
