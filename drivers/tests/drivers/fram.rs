//! The FRAM driver on a fake part.

use std::cell::RefCell;
use std::rc::Rc;

use super::fake::fram::{Answer, Bus, Chip};
use super::fake::run;
use embedded_storage_async::nor_flash::{NorFlash, ReadNorFlash};
use sequential_storage::cache::Cache;
use sequential_storage::map::{MapConfig, MapStorage};
use sophie_control::params::Params;
use sophie_drivers::fault::Fault;
use sophie_drivers::fram::{CAPACITY, Fram, FramFault};
use sophie_drivers::param_store::{BUFFER, ParamStore, hash};
use sophie_ports::storage::{Loaded, Storage, StorageError};

/// Identity and protection before the first access.
fn bring_up() -> Vec<Vec<u8>> {
    vec![
        vec![0x9F, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        vec![0x05, 0],
        vec![0x05, 0],
    ]
}

#[test]
fn every_transfer_is_what_the_datasheet_asks_for() {
    let chip = Chip::new();
    let bus = Bus(chip.clone());
    let read = run(async move {
        let mut fram = Fram::new(bus);
        let mut read = [0; 5];
        fram.write(0x1234, &[1, 2, 3]).await.unwrap();
        fram.read(0x1233, &mut read).await.unwrap();
        read
    });
    assert_eq!(read, [0xFF, 1, 2, 3, 0xFF]);
    let mut expected = bring_up();
    expected.push(vec![0x06]);
    expected.push(vec![0x02, 0x12, 0x34, 1, 2, 3]);
    expected.push(vec![0x03, 0x12, 0x33, 0, 0, 0, 0, 0]);
    let mut sent = chip.borrow().sent.clone();
    // Bytes sent while the part answers do not matter.
    sent.last_mut().unwrap()[3..].fill(0);
    assert_eq!(sent, expected);
    assert_eq!(chip.borrow().status, 0x40, "the latch has dropped");
}

#[test]
fn long_writes_go_in_pieces_each_with_its_own_enable() {
    let chip = Chip::new();
    let bus = Bus(chip.clone());
    let data: Vec<u8> = (0..150).collect();
    let written = data.clone();
    let read = run(async move {
        let mut fram = Fram::new(bus);
        fram.write(0x00F0, &written).await.unwrap();
        let mut read = vec![0; 150];
        fram.read(0x00F0, &mut read).await.unwrap();
        read
    });
    assert_eq!(read, data);
    assert_eq!(chip.borrow().cells[0x00F0..0x00F0 + 150], data);
    let heads: Vec<(u8, usize)> = chip.borrow().sent[3..].iter().map(|t| (t[0], t.len())).collect();
    assert_eq!(
        heads,
        [
            (6, 1),
            (2, 67),
            (6, 1),
            (2, 67),
            (6, 1),
            (2, 25),
            (3, 67),
            (3, 67),
            (3, 25)
        ]
    );
}

#[test]
fn an_erase_fills_whole_pages_and_no_more() {
    let chip = Chip::new();
    chip.borrow_mut().cells.fill(0x00);
    let bus = Bus(chip.clone());
    let results = run(async move {
        let mut fram = Fram::new(bus);
        let good = fram.erase(4096, 12288).await;
        let mut bad = Vec::new();
        for (from, to) in [(0, 100), (100, 4096), (8192, 4096), (0, CAPACITY + 4096)] {
            bad.push(fram.erase(from, to).await);
        }
        bad.push(fram.write(CAPACITY - 1, &[0; 2]).await);
        bad.push(fram.read(CAPACITY, &mut [0]).await);
        bad.push(fram.read(u32::MAX, &mut [0]).await);
        (good, bad)
    });
    assert_eq!(results.0, Ok(()));
    assert!(
        results.1.iter().all(|r| *r == Err(FramFault::OutOfBounds)),
        "{results:?}"
    );
    let chip = chip.borrow();
    let erased: Vec<usize> = (0..8).filter(|p| chip.cells[p * 4096] == 0xFF).collect();
    assert_eq!(erased, [1, 2]);
    assert_eq!(chip.cells.iter().filter(|c| **c == 0xFF).count(), 8192);
}

fn first_read(chip: &Rc<RefCell<Chip>>) -> Result<(), FramFault> {
    let bus = Bus(chip.clone());
    run(async move { Fram::new(bus).read(0, &mut [0; 4]).await })
}

#[test]
fn another_chip_or_none_is_named() {
    for (answer, found) in [(Answer::Only(0x00), 0x00), (Answer::Only(0xFF), 0xFF)] {
        let chip = Chip::new();
        chip.borrow_mut().answer = answer;
        let fault = Fault::Identity {
            expected: 0x7F,
            found,
        };
        assert_eq!(first_read(&chip), Err(FramFault::Chip(fault)));
        assert_eq!(fault.what(), "no answer");
    }
    // Another maker, half the size, three-byte addresses.
    let ramtron = Chip::new().borrow().identity;
    let fujitsu = [0x04, 0x7F, 0x25, 0x03, 0, 0, 0, 0, 0];
    for (identity, index, expected, found) in [
        (ramtron, 6, 0xC2, 0x01),
        (ramtron, 7, 0x22, 0x21),
        (ramtron, 7, 0x22, 0x24),
        (fujitsu, 1, 0x7F, 0x01),
        (fujitsu, 2, 0x25, 0x24),
        (fujitsu, 2, 0x25, 0x27),
    ] {
        let chip = Chip::new();
        chip.borrow_mut().identity = identity;
        chip.borrow_mut().identity[index] = found;
        let fault = Fault::Identity { expected, found };
        assert_eq!(first_read(&chip), Err(FramFault::Chip(fault)));
        assert_eq!(fault.what(), "wrong chip");
        assert_eq!(chip.borrow().sent.len(), 1, "nothing more is tried");
    }
    let chip = Chip::new();
    chip.borrow_mut().answer = Answer::Bus;
    assert_eq!(first_read(&chip), Err(FramFault::Chip(Fault::Bus)));
    let chip = Chip::new();
    chip.borrow_mut().identity[8] = 0x10;
    assert_eq!(first_read(&chip), Ok(()));
}

#[test]
fn every_part_that_boards_of_this_kind_carry_is_taken() {
    let ramtron = |product, revision| [0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0xC2, product, revision];
    let fujitsu = |first, second, rest| [0x04, 0x7F, first, second, rest, rest, rest, rest, rest];
    for identity in [
        // FM25V02, FM25V02A, FM25V05.
        ramtron(0x22, 0x00),
        ramtron(0x22, 0x08),
        ramtron(0x23, 0x00),
        // MB85RS256B, MB85RS256TY, MB85RS512T; only four bytes identify.
        fujitsu(0x05, 0x09, 0x00),
        fujitsu(0x25, 0x03, 0xFF),
        fujitsu(0x26, 0x03, 0x04),
    ] {
        let chip = Chip::new();
        chip.borrow_mut().identity = identity;
        let mut params = Params::default();
        params.set("infill", 8.0).unwrap();
        assert_eq!(
            store(&chip, params),
            (Loaded::default(), Ok(()), params),
            "{identity:02X?}"
        );
    }
}

#[test]
fn write_protection_is_taken_off_once() {
    let chip = Chip::new();
    chip.borrow_mut().status = 0x4C;
    assert_eq!(first_read(&chip), Ok(()));
    assert_eq!(chip.borrow().status, 0x40);
    let sent: Vec<Vec<u8>> = chip.borrow().sent[1..5].to_vec();
    assert_eq!(sent, [vec![0x05, 0], vec![0x06], vec![0x01, 0], vec![0x05, 0]]);
}

fn store(chip: &Rc<RefCell<Chip>>, params: Params) -> (Loaded, Result<(), StorageError>, Params) {
    let bus = Bus(chip.clone());
    run(async move {
        let mut store = ParamStore::new(Fram::new(bus), 0..CAPACITY);
        let loaded = store.load(&mut Params::default()).await;
        let saved = store.save(&params).await;
        let mut again = Params::default();
        let _ = store.load(&mut again).await;
        (loaded, saved, again)
    })
}

#[test]
fn it_keeps_parameters_and_a_missing_one_is_a_broken_storage() {
    let mut params = Params::default();
    params.set("infill", 8.0).unwrap();
    let chip = Chip::new();
    assert_eq!(store(&chip, params), (Loaded::default(), Ok(()), params));
    let loaded = store(&chip, params).0;
    assert_eq!((loaded.taken, loaded.unreadable), (1, false));

    for answer in [Answer::Only(0x00), Answer::Only(0xFF), Answer::Bus] {
        chip.borrow_mut().answer = answer;
        let (loaded, saved, again) = store(&chip, Params::default());
        assert!(
            loaded.unreadable && saved == Err(StorageError::Broken),
            "{answer:?}"
        );
        assert_eq!(again, Params::default());
    }
    // Reading back detects a part that ignores writes.
    chip.borrow_mut().answer = Answer::Deaf;
    let (_, saved, again) = store(&chip, Params::default());
    assert_eq!((saved, again), (Err(StorageError::Broken), params));
}

#[test]
fn a_set_of_old_names_and_units_is_read_and_the_next_save_has_the_new_ones() {
    let chip = Chip::new();
    let stored = include_bytes!("stored/fram-old-names.bin");
    chip.borrow_mut().cells[..stored.len()].copy_from_slice(stored);
    let mut params = Params::default();
    for (name, value) in [
        ("rc_protocol", 1.0),
        ("perch_thr_max", 0.5),
        ("setpoint_lpf_hz", 20.0 / std::f32::consts::TAU),
        ("infill", 8.0),
        ("motor_protocol", 600.0),
    ] {
        params.set(name, value).unwrap();
    }
    let taken = Loaded {
        taken: 5,
        ..Loaded::default()
    };
    assert_eq!(store(&chip, params), (taken, Ok(()), params));
    let cells = chip.borrow().cells.clone();
    let name = hash("setpoint_lpf_hz").to_le_bytes();
    assert!(cells.windows(4).any(|w| *w == name), "not written anew");
}

#[test]
fn sets_of_256_records_go_round_the_pages() {
    let chip = Chip::new();
    let mut item = b"SPH1".to_vec();
    for (i, row) in Params::TABLE.iter().enumerate() {
        let value = if i == 0 { 2.0 } else { row.default };
        item.extend(hash(row.name).to_le_bytes());
        item.extend(value.to_bits().to_le_bytes());
    }
    for i in Params::TABLE.len()..256 {
        item.extend(hash(&format!("another_{i}")).to_le_bytes());
        item.extend([0; 4]);
    }
    // One per page: twice round the eight pages.
    for round in 0..16 {
        let (bus, item) = (Bus(chip.clone()), item.clone());
        let (params, loaded) = run(async move {
            let mut fram = Fram::new(bus);
            let mut map =
                MapStorage::<(), _, _>::new(&mut fram, MapConfig::new(0..CAPACITY), Cache::new_uncached());
            map.store_item(&mut [0; BUFFER], &(), &item.as_slice())
                .await
                .unwrap();
            let mut params = Params::default();
            let loaded = ParamStore::new(fram, 0..CAPACITY).load(&mut params).await;
            (params, loaded)
        });
        let known = Params::TABLE.len() as u16;
        assert_eq!((loaded.taken, loaded.refused), (known, 256 - known), "{round}");
        assert!(!loaded.unreadable && params.mass == 2.0, "{round}");
    }
    let (_, saved, again) = store(&chip, Params::default());
    assert_eq!((saved, again), (Ok(()), Params::default()));
}
