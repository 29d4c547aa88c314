//! Loading of the parameters at start-up.

use sophie_clock::VirtualTime;
use sophie_control::arming::ArmingInhibit;
use sophie_control::params::Params;
use sophie_ports::signing::Record;
use sophie_ports::storage::{Loaded, Storage, StorageError};
use sophie_tasks::storage::parameters::{load, report};

use crate::rig::Rig;

/// A board with its own battery divider; its storage holds another infill.
struct Stored;

static DEFAULTS: Params = Params {
    battery_divider: 18.0,
    ..Params::DEFAULT
};

impl Storage for Stored {
    fn defaults(&self) -> &'static Params {
        &DEFAULTS
    }

    async fn load(&mut self, params: &mut Params) -> Loaded {
        params.infill = 8.0;
        Loaded {
            taken: 1,
            ..Loaded::default()
        }
    }

    async fn save(&mut self, _: &Params) -> Result<(), StorageError> {
        Err(StorageError::Broken)
    }

    async fn save_signing(&mut self, _: Option<Record>) -> Result<(), StorageError> {
        Err(StorageError::Broken)
    }
}

#[test]
fn what_is_stored_lies_over_the_board_s_defaults() {
    let (sender, receiver) = std::sync::mpsc::channel();
    let time = VirtualTime::new();
    time.spawn(async move { sender.send(load(&mut Stored).await).unwrap_or_default() });
    time.run_until(1000);
    let (params, loaded) = receiver.try_recv().unwrap();
    let wanted = Params {
        infill: 8.0,
        ..DEFAULTS
    };
    assert_eq!((params, loaded.taken), (wanted, 1));
}

#[test]
fn storage_that_cannot_be_read_refuses_arming_with_its_reason_and_refused_values_do_not() {
    let sound = Loaded {
        taken: 3,
        refused: 2,
        ..Loaded::default()
    };
    let damaged = Loaded {
        unreadable: true,
        ..Loaded::default()
    };
    let foreign = Loaded {
        foreign: Some("ArduPilot"),
        ..damaged
    };
    for (loaded, unreadable, other) in [
        (sound, false, false),
        (damaged, true, false),
        (foreign, false, true),
    ] {
        let rig = Rig::new();
        report(rig.links, loaded);
        let inhibits = rig.links.hardware();
        let contains = |inhibit| inhibits.contains(inhibit);
        assert_eq!(
            (
                contains(ArmingInhibit::StorageUnreadable),
                contains(ArmingInhibit::StorageForeign)
            ),
            (unreadable, other),
            "{loaded:?}"
        );
    }
}
