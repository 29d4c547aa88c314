//! A parameter survives a reset and is restored. A power cut in between leaves the trim of servo 4 off by 1 µs.

use embassy_executor::Executor;
use sophie_control::params::Params;
use sophie_ports::storage::Storage;
use sophie_rig::keep_alive;
use static_cell::StaticCell;

async fn stored(storage: &mut impl Storage) -> Params {
    let mut params = *storage.defaults();
    let loaded = storage.load(&mut params).await;
    assert!(!loaded.unreadable && loaded.refused == 0, "{loaded:?}");
    params
}

async fn store(storage: &mut impl Storage, params: &Params) {
    if let Err(error) = storage.save(params).await {
        panic!("{error:?}");
    }
    assert!(
        stored(storage).await == *params,
        "what is read is not what was stored"
    );
}

fn next_to(trim: f32) -> f32 {
    if trim > 0.0 { trim - 1.0 } else { trim + 1.0 }
}

/// After the reset: restores the trim `was`.
pub fn restarted(was: f32) -> ! {
    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    let executor = EXECUTOR.init(Executor::new());
    executor.run(|background| {
        // Called once after a reset.
        if let Ok(task) = put_back(was) {
            background.spawn(task);
        }
    })
}

#[embassy_executor::task]
async fn put_back(was: f32) {
    let mut board = sophie_boards::take().await;
    keep_alive(board.watchdog);
    let found = board.params.servo_trim_4;
    let original = Params {
        servo_trim_4: was,
        ..board.params
    };
    store(&mut board.storage, &original).await;
    let changed = next_to(was);
    assert!(
        found == changed,
        "{found} us after the reset instead of {changed}"
    );
    defmt::info!(
        "servo_trim_4: {=f32} us outlived the reset, {=f32} us is back",
        found,
        was
    );
    sophie_rig::passed()
}

#[embedded_test::tests]
mod tests {
    use sophie_control::params::Params;
    use sophie_ports::chip::Chip;
    use sophie_rig::keep_alive;
    use sophie_rig::resumable_test::{ResumableTest, leave};

    #[test]
    async fn a_parameter_outlives_a_reset() {
        let mut board = sophie_boards::take().await;
        keep_alive(board.watchdog);
        let original = super::stored(&mut board.storage).await;
        let changed = Params {
            servo_trim_4: super::next_to(original.servo_trim_4),
            ..original
        };
        super::store(&mut board.storage, &changed).await;
        leave(ResumableTest::Stored(original.servo_trim_4));
        board.chip.restart();
    }
}
