//! Records of runs.

use embassy_time::{Duration, Instant};
use sophie_tasks::schedule::timing::{Quantity, Record, Run, Timing};

fn run(late: u64, end: u64, deadline: u64, skipped: u32) -> Run {
    let at = |us: u64| Instant::from_micros(1_000_000 + us);
    Run {
        released: at(0),
        started: at(late),
        ended: at(end),
        deadline: Duration::from_micros(deadline),
        skipped,
    }
}

#[test]
fn totals_count_runs_and_misses_and_keep_the_worst() {
    let mut record = Record::new();
    assert_eq!(record.totals(), Timing::default());
    assert!(!record.add(&run(30, 130, 200, 0)));
    // Just in time, and 1 µs late.
    assert!(!record.add(&run(10, 200, 200, 0)));
    assert!(record.add(&run(20, 201, 200, 0)));
    // Three periods skipped and the run late: four. Three alone.
    assert!(record.add(&run(0, 500, 400, 3)));
    assert!(record.add(&run(0, 100, 400, 3)));
    assert_eq!(
        record.totals(),
        Timing {
            runs: 5,
            overruns: 1 + 4 + 3,
            worst_lateness_us: 30,
            worst_response_us: 500,
            worst_execution_us: 500,
            deadline_us: 400,
        }
    );
    // A clock that seems to go backwards adds no time.
    assert!(!record.add(&Run {
        started: Instant::from_micros(0),
        ..run(0, 0, 100, 0)
    }));
    assert_eq!(record.totals().worst_lateness_us, 30);
}

#[test]
fn each_quantity_has_its_own_histogram_and_taking_it_empties_it() {
    let mut record = Record::default();
    record.add(&run(3, 10, 200, 0));
    record.add(&run(5, 25, 200, 0));
    for (quantity, least, most) in [
        (Quantity::Lateness, 3, 5),
        (Quantity::Execution, 7, 20),
        (Quantity::Response, 10, 25),
    ] {
        let taken = record.take(quantity);
        assert_eq!(
            (taken.count(), taken.min(), taken.max()),
            (2, least, most),
            "{quantity:?}"
        );
        assert_eq!(record.take(quantity).count(), 0, "{quantity:?}");
    }
    assert_eq!(record.totals().runs, 2);
}

#[test]
fn a_run_that_is_noted_is_seen_by_readers_and_lost_by_none() {
    let (mut added, mut noted) = (Record::new(), Record::new());
    let runs = [
        run(3, 10, 200, 0),
        run(5, 205, 200, 0),
        run(7, 30, 200, 2),
        run(0, 200, 200, 0),
    ];
    for (i, run) in runs.iter().enumerate() {
        assert_eq!(added.add(run), noted.note(run), "{run:?}");
        // Settled by sender, next run or reader.
        match i {
            0 => noted.settle(),
            1 => {}
            _ => assert_eq!(noted.totals(), added.totals(), "{run:?}"),
        }
    }
    noted.note(&runs[0]);
    added.add(&runs[0]);
    for quantity in [Quantity::Lateness, Quantity::Execution, Quantity::Response] {
        assert_eq!(noted.take(quantity), added.take(quantity), "{quantity:?}");
    }
    noted.settle();
    assert_eq!((noted.totals(), noted.totals().runs), (added.totals(), 5));
}
