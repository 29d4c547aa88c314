use super::*;

#[test]
fn the_image_perches_at_half_an_instruction_a_cycle() {
    let flight = fly(&scenario("perch-short.toml"), 0.5, &[]);
    assert!(
        flight.passed(),
        "{:?} {:?}\n{}",
        flight.record.outcome,
        flight.gaps,
        log(&flight)
    );
    for task in FLIGHT_LEVEL {
        assert_eq!(flight.board.overruns.get(task), None, "{task}\n{}", log(&flight));
    }
    for esc in flight.board.run.escs {
        assert!(esc.frames > 50_000 && esc.bad == 0, "{esc:?}");
    }
    let latency = flight.board.run.latency_us;
    assert!(latency.count > 20_000 && latency.worst < 250.0, "{latency:?}");
    assert_eq!(flight.record.grip.len(), 4);
    assert!(flight.board.resets.is_empty() && flight.board.malformed == 0);
}
