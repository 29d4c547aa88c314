//! Two consoles at lines of their own: one actuator test, one storage.

use sophie_control::arming::ArmingInhibit;
use sophie_control::mode::Mode;
use sophie_fakes::FakeLine;
use sophie_tasks::console;

use crate::bench::Table;
use crate::console::{Bench, Screen};

#[test]
fn two_links_do_not_run_actuator_tests_at_once() {
    let mut table = Table::set();
    let (line, screen) = table.another();
    table.says("propellers off", 200);
    // In the same moment, so that both look at the same newest order.
    line.put(b"motor 2\r");
    let first = table.says("motor 1", 1000);
    let both = [first.join("\n"), screen.0.take()];
    let refused = "refused: another link runs an actuator test";
    let begun = both.iter().filter(|said| said.contains("for 2 s")).count();
    assert_eq!(begun, 1, "{both:?}");
    assert_eq!(
        both.iter().filter(|said| said.contains(refused)).count(),
        1,
        "{both:?}"
    );
    table.run(2000);
    assert_eq!(
        table.turned.iter().filter(|ms| **ms > 0).count(),
        1,
        "{:?}",
        table.turned
    );
    // Once it has ended, the other has its turn.
    screen.0.take();
    line.put(b"motor 3\r");
    table.run(500);
    assert!(screen.0.take().contains("motor 3 at 8 % for 2 s"));
    assert_eq!(table.says("servo 1 release", 300).last().unwrap(), refused);
}

#[test]
fn what_one_line_stores_the_other_waits_for() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    let (line, screen) = (FakeLine::default(), Screen::default());
    let board = bench.board.clone();
    let second = console::run(
        bench.rig.links,
        line.clone(),
        screen.clone(),
        board.clone(),
        board,
    );
    bench.rig.time.spawn(second);
    bench.run(20);
    line.put(b"set infill 7\r");
    bench.line.put(b"set infill 8\r");
    bench.run(100);
    bench.line.put(b"save\r");
    line.put(b"save\r");
    bench.run(600);
    let both = [bench.screen.0.take(), screen.0.take()];
    let refused = "not saved: another line stores, or waits for its restart";
    assert_eq!(
        both.iter().filter(|said| said.contains(refused)).count(),
        1,
        "{both:?}"
    );
    assert_eq!(
        both.iter()
            .filter(|said| said.contains("saved; restarting"))
            .count(),
        1,
        "{both:?}"
    );
    assert_eq!(bench.board.restarts.get(), 1);
    assert!(bench.board.stored.get().is_some());
    // The other's refusal has not let arming go.
    assert!(bench.rig.links.hardware().contains(ArmingInhibit::Storing));
}
