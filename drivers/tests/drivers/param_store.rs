//! The parameter store on three kinds of flash, with power loss and damaged contents.

use std::f32::consts::TAU;
use std::ops::Range;

use super::fake::run;
use proptest::prelude::{ProptestConfig, any};
use proptest::{prop_assert, prop_assert_eq, proptest};
use sequential_storage::cache::Cache;
use sequential_storage::map::{MapConfig, MapStorage};
use sophie_control::params::Params;
use sophie_drivers::param_store::{BUFFER, ParamStore, hash};
use sophie_fakes::Flash;
use sophie_ports::signing::{Key, Record, Stored};
use sophie_ports::storage::{Loaded, Storage, StorageError};

/// Small, so that a short log rotates often.
const SMALL: usize = 512;

fn load<const W: usize, const P: usize>(flash: &Flash<W, P>) -> (Params, Loaded) {
    let (flash, range) = (flash.clone(), flash.range());
    run(async move {
        let mut params = Params::default();
        let loaded = ParamStore::new(flash, range).load(&mut params).await;
        (params, loaded)
    })
}

fn save<const W: usize, const P: usize>(flash: &Flash<W, P>, params: Params) -> Result<(), StorageError> {
    let (flash, range) = (flash.clone(), flash.range());
    run(async move { ParamStore::new(flash, range).save(&params).await })
}

fn sound(taken: u16) -> Loaded {
    Loaded {
        taken,
        ..Loaded::default()
    }
}

/// What a load gives after a save over storage of which `signing` was known.
fn after(signing: Stored, taken: u16) -> Loaded {
    let signing = match signing {
        Stored::Unreadable => Stored::Lost,
        known => known,
    };
    Loaded {
        signing,
        ..sound(taken)
    }
}

fn set(values: &[(&str, f32)]) -> Params {
    let mut params = Params::default();
    for (name, value) in values {
        params.set(name, *value).unwrap();
    }
    params
}

fn all_changed() -> Params {
    let mut params = Params::default();
    for row in Params::TABLE {
        let other = if row.default == row.max { row.min } else { row.max };
        params.set(row.name, other).unwrap();
    }
    params
}

fn keeps_what_differs<const W: usize, const P: usize>() {
    let flash = Flash::<W, P>::blank(2);
    assert_eq!(load(&flash), (Params::default(), sound(0)));
    assert_eq!(save(&flash, Params::default()), Ok(()));
    assert_eq!(flash.0.borrow().steps, 0, "nothing differs, nothing is written");

    let first = set(&[("infill", 8.0), ("rate_pitch_p", 12.5), ("accel_bias_z", -0.25)]);
    assert_eq!(save(&flash, first), Ok(()));
    assert_eq!(load(&flash), (first, sound(3)));
    let steps = flash.0.borrow().steps;
    assert_eq!(save(&flash, first), Ok(()));
    assert_eq!(flash.0.borrow().steps, steps, "the same again costs nothing");

    let second = set(&[("infill", 5.0)]);
    assert_eq!(save(&flash, second), Ok(()));
    assert_eq!(load(&flash), (second, sound(1)), "what is default again is gone");
    assert_eq!(save(&flash, Params::default()), Ok(()));
    assert_eq!(load(&flash), (Params::default(), sound(0)));

    assert_eq!(save(&flash, all_changed()), Ok(()));
    assert_eq!(load(&flash), (all_changed(), sound(Params::TABLE.len() as u16)));
    assert_eq!(flash.0.borrow().violations, [""; 0]);
}

#[test]
fn every_kind_of_flash_keeps_what_differs_from_the_defaults() {
    keeps_what_differs::<32, { 128 * 1024 }>();
    keeps_what_differs::<1, { 16 * 1024 }>();
    keeps_what_differs::<4, 4096>();
    keeps_what_differs::<8, 2048>();
}

fn goes_round<const W: usize, const P: usize>(pages: usize, saves: u32) -> usize {
    let flash = Flash::<W, P>::blank(pages);
    for i in 0..saves {
        let params = set(&[("infill", 4.0 + (i % 600) as f32 * 0.01), ("rate_pitch_p", 5.0)]);
        assert_eq!(save(&flash, params), Ok(()), "save {i}");
        assert_eq!(load(&flash).0, params, "save {i}");
        assert!(!load(&flash).1.unreadable, "save {i}");
    }
    assert_eq!(flash.0.borrow().violations, [""; 0]);
    flash.0.borrow().erases
}

#[test]
fn the_log_goes_round_and_spares_the_flash() {
    // 20 bytes in items of 64 (32 + 32), 28 (8 + 20) and 28 bytes; a page holds 14, 18 and 145.
    assert!(goes_round::<32, 1024>(2, 300) <= 300 / 13);
    assert!(goes_round::<1, SMALL>(2, 300) <= 300 / 16);
    // Eleven pages are begun; the next one must be blank.
    assert_eq!(goes_round::<1, 4096>(8, 1500), 4);
}

/// Saves the sets in turn on flash that loses power at each step.
fn survives_cuts<const W: usize, const P: usize>(pages: usize, before: &[Params], new: Params) -> usize {
    let start = Flash::<W, P>::blank(pages);
    for params in before {
        assert_eq!(save(&start, *params), Ok(()));
    }
    let old = before.last().copied().unwrap_or_default();
    let whole = start.copy();
    assert_eq!(save(&whole, new), Ok(()));
    let (first, last) = (start.0.borrow().steps, whole.0.borrow().steps);
    for cut in first..last {
        let flash = start.copy();
        flash.0.borrow_mut().cut_at = Some(cut);
        assert_eq!(save(&flash, new), Err(StorageError::Broken), "cut {cut}");
        let flash = flash.copy();
        let contents = flash.0.borrow().bytes.clone();
        let (found, loaded) = load(&flash);
        assert!(found == old || found == new, "cut {cut}: neither old nor new");
        assert_eq!(loaded.refused, 0, "cut {cut}");
        assert_eq!(contents, flash.0.borrow().bytes, "loading wrote");
        let again = flash.copy();
        let steps = again.0.borrow().steps;
        again.0.borrow_mut().cut_at = Some(steps + cut - first);
        let _ = save(&again, new);
        let again = again.copy();
        let (found, _) = load(&again);
        assert!(found == old || found == new, "cut {cut} twice");
        for flash in [flash, again] {
            assert_eq!(save(&flash, new), Ok(()), "cut {cut}");
            let (found, loaded) = load(&flash);
            assert!(found == new && !loaded.unreadable, "cut {cut}: {loaded:?}");
            assert_eq!(flash.0.borrow().violations, [""; 0], "cut {cut}");
        }
    }
    last - first
}

#[test]
fn power_may_go_at_every_step_of_every_save() {
    let at = |i: usize| {
        set(&[
            ("infill", 4.0 + 0.1 * i as f32),
            ("rate_pitch_p", 5.0),
            ("rate_pitch_i", 3.0),
        ])
    };
    let mut cuts = 0;
    // Twice round the log: appends, new pages, moves of a page's last item, erases.
    for saves in 0..40 {
        let before: Vec<Params> = (0..saves).map(at).collect();
        cuts += survives_cuts::<32, 512>(2, &before, at(saves));
        cuts += survives_cuts::<32, 512>(3, &before, at(saves));
        cuts += survives_cuts::<4, 256>(2, &before, at(saves));
        if saves % 5 < 2 {
            cuts += survives_cuts::<1, 128>(2, &before, at(saves));
            cuts += survives_cuts::<1, 128>(4, &before, at(saves));
        }
    }
    println!("{cuts} cuts");
    assert!(cuts > 1000);
}

fn save_key<const W: usize, const P: usize>(
    flash: &Flash<W, P>,
    signing: Option<Record>,
) -> Result<(), StorageError> {
    let (flash, range) = (flash.clone(), flash.range());
    run(async move { ParamStore::new(flash, range).save_signing(signing).await })
}

fn record(bound: u64) -> Record {
    Record {
        key: Key::new(std::array::from_fn(|n| 7 * n as u8)),
        bound,
    }
}

#[test]
fn a_key_lies_beside_the_parameters_and_neither_changes_the_other() {
    let flash = Flash::<32, SMALL>::blank(2);
    assert_eq!(save_key(&flash, None), Ok(()));
    assert_eq!(flash.0.borrow().steps, 0, "nothing differs, nothing is written");
    // Without a parameter, with all of them, and with fewer again.
    for params in [
        Params::default(),
        set(&[("infill", 8.0)]),
        all_changed_small(),
        Params::default(),
    ] {
        for bound in [0, 5, (1 << 48) - 1] {
            assert_eq!(save_key(&flash, Some(record(bound))), Ok(()));
            assert_eq!(save(&flash, params), Ok(()));
            let (found, loaded) = load(&flash);
            assert_eq!((found, loaded.signing), (params, Stored::Key(record(bound))));
            assert_eq!((loaded.refused, loaded.unreadable), (0, false));
        }
    }
    assert_eq!(save(&flash, set(&[("infill", 8.0)])), Ok(()));
    assert_eq!(save_key(&flash, None), Ok(()));
    assert_eq!(load(&flash), (set(&[("infill", 8.0)]), sound(1)));
    assert_eq!(flash.0.borrow().violations, [""; 0]);
}

/// As many as a page of [`SMALL`] bytes holds beside the key.
fn all_changed_small() -> Params {
    set(&[
        ("infill", 8.0),
        ("rate_pitch_p", 5.0),
        ("rate_pitch_i", 3.0),
        ("gain_k", 5.0),
    ])
}

#[test]
fn power_may_go_at_every_step_of_storing_a_key() {
    let params = set(&[("infill", 8.0)]);
    let mut cuts = 0;
    // Twice round the log.
    for saves in 0..20 {
        let start = Flash::<32, 512>::blank(2);
        assert_eq!(save(&start, params), Ok(()));
        for n in 0..saves {
            assert_eq!(save_key(&start, Some(record(n))), Ok(()));
        }
        let old = saves
            .checked_sub(1)
            .map_or(Stored::None, |n| Stored::Key(record(n)));
        let new = record(saves);
        let whole = start.copy();
        assert_eq!(save_key(&whole, Some(new)), Ok(()));
        let (first, last) = (start.0.borrow().steps, whole.0.borrow().steps);
        for cut in first..last {
            let flash = start.copy();
            flash.0.borrow_mut().cut_at = Some(cut);
            assert_eq!(
                save_key(&flash, Some(new)),
                Err(StorageError::Broken),
                "cut {cut}"
            );
            let flash = flash.copy();
            let (found, loaded) = load(&flash);
            assert!(found == params, "cut {cut}: parameters lost");
            assert!(
                [old, Stored::Key(new)].contains(&loaded.signing),
                "cut {cut}: {loaded:?}"
            );
            assert_eq!(save_key(&flash, Some(new)), Ok(()), "cut {cut}");
            assert_eq!(load(&flash).1.signing, Stored::Key(new), "cut {cut}");
        }
        cuts += last - first;
    }
    assert!(cuts > 100, "{cuts}");
}

#[test]
fn a_key_is_no_reason_to_erase_what_cannot_be_read() {
    let flash = with_item::<32, SMALL>(b"neither parameters nor a key");
    let before = flash.0.borrow().bytes.clone();
    assert_eq!(load(&flash).1.signing, Stored::Unreadable);
    assert_eq!(save_key(&flash, Some(record(1))), Err(StorageError::Broken));
    assert_eq!(flash.0.borrow().bytes, before);
    // A save of parameters clears it, and keeps that there may have been a key, through the next ones.
    for params in [Params::default(), set(&[("infill", 8.0)]), Params::default()] {
        assert_eq!(save(&flash, params), Ok(()));
        let (found, loaded) = load(&flash);
        assert_eq!((found, loaded.signing), (params, Stored::Lost));
        assert_eq!((loaded.refused, loaded.unreadable), (0, false));
    }
    // Until one is set, or none.
    for (key, then) in [(Some(record(1)), Stored::Key(record(1))), (None, Stored::None)] {
        let flash = flash.copy();
        assert_eq!(save_key(&flash, key), Ok(()));
        assert_eq!(load(&flash).1.signing, then);
    }
}

fn with_item<const W: usize, const P: usize>(item: &'static [u8]) -> Flash<W, P> {
    let flash = Flash::<W, P>::blank(2);
    let (device, range) = (flash.clone(), flash.range());
    run(async move {
        let mut map = MapStorage::<(), _, _>::new(device, MapConfig::new(range), Cache::new_uncached());
        map.store_item(&mut [0; 2048], &(), &item).await.unwrap();
    });
    flash
}

#[test]
fn what_firmware_with_other_parameters_stored_is_read_as_far_as_it_is_known() {
    let record = |name, value: f32| [hash(name).to_le_bytes(), value.to_bits().to_le_bytes()].concat();
    let item = [
        b"SPH1".to_vec(),
        record("infill", 7.5),
        record("a_parameter_of_old", 1.0),
        record("mass", 500.0),
        record("rate_pitch_p", f32::NAN),
        record("motor_protocol", 151.0),
        record("gain_k", 5.0),
    ]
    .concat();
    let flash = with_item::<32, SMALL>(item.leak());
    let known = set(&[("infill", 7.5), ("gain_k", 5.0)]);
    let loaded = Loaded {
        taken: 2,
        refused: 4,
        ..Loaded::default()
    };
    assert_eq!(load(&flash), (known, loaded));
    // A save removes refused records.
    assert_eq!(save(&flash, known), Ok(()));
    assert_eq!(load(&flash), (known, sound(2)));
}

/// Two sectors after two saves by firmware with the old names, then erased.
fn of_old<const W: usize, const P: usize>(stored: &[u8]) -> Flash<W, P> {
    let mut bytes = stored.to_vec();
    bytes.resize(2 * P, 0xFF);
    Flash::holding(bytes)
}

/// Settings of that firmware: receiver_protocol 1, perch_throttle_max 0.5, setpoint_cutoff 20 rad/s, infill 8 %,
/// motor_protocol 600.
fn as_of_old() -> Params {
    set(&[
        ("rc_protocol", 1.0),
        ("perch_thr_max", 0.5),
        ("setpoint_lpf_hz", 20.0 / TAU),
        ("infill", 8.0),
        ("motor_protocol", 600.0),
    ])
}

fn reads_old_names<const W: usize, const P: usize>(stored: &[u8]) {
    let flash = of_old::<W, P>(stored);
    let before = flash.0.borrow().bytes.clone();
    assert_eq!(load(&flash), (as_of_old(), sound(5)));
    assert!(flash.0.borrow().bytes == before, "a load wrote");
    // A save writes the present names, once.
    for written in [true, false] {
        let steps = flash.0.borrow().steps;
        assert_eq!(save(&flash, as_of_old()), Ok(()));
        assert_eq!(flash.0.borrow().steps > steps, written);
        assert_eq!(load(&flash), (as_of_old(), sound(5)));
    }
    let bytes = flash.0.borrow().bytes.clone();
    let found = |name| {
        bytes
            .windows(4)
            .filter(|w| **w == hash(name).to_le_bytes())
            .count()
    };
    assert_eq!((found("setpoint_cutoff"), found("setpoint_lpf_hz")), (1, 1));
    assert_eq!(flash.0.borrow().violations, [""; 0]);
}

#[test]
fn a_set_of_old_names_and_units_is_read_and_the_next_save_has_the_new_ones() {
    reads_old_names::<32, { 128 * 1024 }>(include_bytes!("stored/h743-old-names.bin"));
    reads_old_names::<4, { 16 * 1024 }>(include_bytes!("stored/f405-old-names.bin"));
}

#[test]
fn of_an_old_and_a_new_name_in_one_set_the_new_one_counts() {
    let record = |name, value: f32| [hash(name).to_le_bytes(), value.to_bits().to_le_bytes()].concat();
    let (old, new) = (record("setpoint_cutoff", 20.0), record("setpoint_lpf_hz", 2.5));
    for records in [[old.clone(), new.clone()], [new, old]] {
        let item = [b"SPH1".to_vec(), records.concat()].concat();
        let flash = with_item::<4, SMALL>(item.leak());
        assert_eq!(load(&flash), (set(&[("setpoint_lpf_hz", 2.5)]), sound(1)));
    }
    let item = [b"SPH1".to_vec(), record("setpoint_cutoff", 500.0)].concat();
    let (params, loaded) = load(&with_item::<4, SMALL>(item.leak()));
    assert_eq!((params, loaded.taken, loaded.refused), (Params::default(), 0, 1));
}

const FULL: usize = 256;

/// [`FULL`] records of firmware with more parameters.
fn full_set(params: &Params) -> Vec<u8> {
    let known = Params::TABLE
        .iter()
        .map(|row| (hash(row.name), params.get(row.name).unwrap()));
    let others = (0..).map(|i| (hash(&format!("another_{i}")), i as f32));
    let mut item = b"SPH1".to_vec();
    for (name, value) in known.chain(others).take(FULL) {
        item.extend(name.to_le_bytes());
        item.extend(value.to_bits().to_le_bytes());
    }
    assert_eq!(item.len(), 4 + 8 * FULL);
    item
}

/// Stores and reads back `saves` sets of [`FULL`] records; returns the erases.
fn keeps_full_sets<const W: usize, const P: usize>(saves: usize) -> usize {
    let flash = Flash::<W, P>::blank(2);
    for i in 0..saves {
        let wanted = Params {
            infill: 4.0 + 0.01 * i as f32,
            ..all_changed()
        };
        let (device, range, item) = (flash.clone(), flash.range(), full_set(&wanted));
        run(async move {
            let mut map = MapStorage::<(), _, _>::new(device, MapConfig::new(range), Cache::new_uncached());
            map.store_item(&mut [0; BUFFER], &(), &item.as_slice())
                .await
                .unwrap();
        });
        let known = Params::TABLE.len();
        let loaded = Loaded {
            taken: known as u16,
            refused: (FULL - known) as u16,
            ..Loaded::default()
        };
        assert_eq!(load(&flash), (wanted, loaded), "save {i}");
    }
    assert_eq!(save(&flash, all_changed()), Ok(()));
    assert_eq!(load(&flash), (all_changed(), sound(Params::TABLE.len() as u16)));
    assert_eq!(flash.0.borrow().violations, [""; 0]);
    flash.0.borrow().erases
}

#[test]
fn sets_of_256_records_are_kept_on_the_boards_sectors_and_spare_them() {
    // Items of 2052 bytes: 62 in an H743 sector (words of 32 bytes), 7 in an F405 sector, one of them the last sector's
    // newest.
    let (large, small) = (
        keeps_full_sets::<32, { 128 * 1024 }>(140),
        keeps_full_sets::<4, { 16 * 1024 }>(60),
    );
    assert!(large <= 140 / 60 && small <= 60 / 6, "{large}, {small} erases");
}

/// F405 sectors of another stack: the second page begins with `head`.
fn used_before(head: &[u8]) -> Flash<4, 0x4000> {
    let mut bytes: Vec<u8> = (0..0x8000)
        .map(|n: u32| (n.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    bytes[0x4000..0x4000 + head.len()].copy_from_slice(head);
    Flash::holding(bytes)
}

#[test]
fn what_another_flight_stack_left_is_named_and_a_save_takes_its_place() {
    let left: [(&[u8], Option<&str>); 3] = [
        (&[0xFC, 0x5B, 0x68, 0x51, 0, 0], Some("ArduPilot")),
        (&[0xB0, 0xBE, 0x2A, 0x00, 0x0B, 0x00], Some("Betaflight")),
        (b"noise", None),
    ];
    for (head, owner) in left {
        let flash = used_before(head);
        let before = flash.0.borrow().bytes.clone();
        let (params, loaded) = load(&flash);
        let wanted = Loaded {
            unreadable: true,
            foreign: owner,
            // What is noise may have been a key.
            signing: match owner {
                Some(_) => Stored::None,
                None => Stored::Unreadable,
            },
            ..Loaded::default()
        };
        assert_eq!((params, loaded), (Params::default(), wanted), "{owner:?}");
        assert!(flash.0.borrow().bytes == before, "a load wrote");
        assert_eq!(save(&flash, Params::default()), Ok(()));
        let wanted = (Params::default(), after(loaded.signing, 0));
        assert_eq!(load(&flash), wanted, "{owner:?}");
    }
}

#[test]
fn what_other_programs_stored_is_not_taken_for_parameters() {
    let items: [&[u8]; 6] = [b"", b"x", b"SPH", b"SPH1 and 9", b"SPH2abcdefgh", &[0x55; 1500]];
    for item in items {
        let flash = with_item::<8, 2048>(item);
        let (params, loaded) = load(&flash);
        assert!(
            params == Params::default() && loaded.unreadable,
            "{item:?}: {loaded:?}"
        );
        assert_eq!(save(&flash, set(&[("infill", 5.0)])), Ok(()), "{item:?}");
        let wanted = (set(&[("infill", 5.0)]), after(Stored::Unreadable, 1));
        assert_eq!(load(&flash), wanted, "{item:?}");
    }
}

#[test]
fn damage_to_the_newest_set_is_noticed_and_the_one_before_is_kept() {
    let (old, new) = (set(&[("infill", 5.0)]), set(&[("infill", 8.0)]));
    let mut noticed = 0;
    let flash = Flash::<4, SMALL>::blank(2);
    assert_eq!((save(&flash, old), save(&flash, new)), (Ok(()), Ok(())));
    // Mark 4 bytes, then two items of 8 + 12.
    for bit in 24 * 8..44 * 8 {
        let flash = flash.copy();
        flash.0.borrow_mut().bytes[bit / 8] ^= 1 << (bit % 8);
        let (params, loaded) = load(&flash);
        assert!(loaded.unreadable && params == old, "bit {bit}: {loaded:?}");
        noticed += 1;
        assert_eq!(save(&flash, new), Ok(()), "bit {bit}");
        assert_eq!(load(&flash), (new, sound(1)), "bit {bit}");
    }
    assert_eq!(noticed, 160);
}

#[test]
fn a_flash_that_is_too_small_or_broken_says_so() {
    // 256 bytes cannot hold every parameter.
    let flash = Flash::<1, 256>::blank(2);
    let few = set(&[("infill", 5.0)]);
    assert_eq!(save(&flash, few), Ok(()));
    assert_eq!(save(&flash, all_changed()), Err(StorageError::Full));
    assert_eq!(load(&flash).0, few);

    // A cell stuck at 1, in mark, head and values of the first item.
    for cell in [0, 4, 8, 12, 20] {
        let flash = Flash::<4, SMALL>::blank(2);
        flash.0.borrow_mut().stuck = Some(cell);
        let saved = save(&flash, few);
        assert!(saved.is_err() || load(&flash) == (few, sound(1)), "cell {cell}");
        assert!(
            saved.is_ok() || saved == Err(StorageError::Broken),
            "cell {cell}: {saved:?}"
        );
    }

    let dead = Flash::<4, SMALL>::blank(2);
    dead.0.borrow_mut().dead = true;
    assert!(load(&dead).1.unreadable);
    assert_eq!(save(&dead, few), Err(StorageError::Broken));
}

#[test]
fn a_range_that_does_not_suit_is_a_broken_storage() {
    for (start, end) in [(0, 512), (0, 2048), (100, 1124), (1024, 0), (512, 512)] {
        let range = Range { start, end };
        let flash = Flash::<4, SMALL>::blank(2);
        let watched = flash.clone();
        let what = format!("{range:?}");
        let (loaded, saved) = run(async move {
            let mut store = ParamStore::new(flash, range);
            let loaded = store.load(&mut Params::default()).await;
            (loaded, store.save(&all_changed()).await)
        });
        assert!(loaded.unreadable && saved == Err(StorageError::Broken), "{what}");
        assert_eq!(watched.0.borrow().steps, 0, "{what}: touched");
    }
}

fn lives_with<const W: usize, const P: usize>(bytes: Vec<u8>) -> (Params, Loaded) {
    let flash = Flash::<W, P>::holding(bytes.clone());
    let (params, loaded) = load(&flash);
    assert!(flash.0.borrow().bytes == bytes, "loading wrote");
    assert!(
        flash.0.borrow().reads <= 20_010,
        "{} reads",
        flash.0.borrow().reads
    );
    let wanted = set(&[("infill", 5.5), ("rate_pitch_i", 2.0)]);
    assert_eq!(save(&flash, wanted), Ok(()));
    assert_eq!(load(&flash), (wanted, after(loaded.signing, 2)));
    (params, loaded)
}

fn noise(seed: u32, length: usize) -> Vec<u8> {
    let mut state = seed | 1;
    let next = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        (state >> 11) as u8
    };
    std::iter::repeat_with(next).take(length).collect()
}

#[test]
fn pages_full_of_one_byte_are_no_parameters() {
    for byte in 0..=0xFE {
        for (params, loaded) in [
            lives_with::<32, 1024>(vec![byte; 3072]),
            lives_with::<1, 1024>(vec![byte; 2048]),
        ] {
            assert!(
                params == Params::default() && loaded.unreadable,
                "{byte}: {loaded:?}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn noise_boots_with_the_defaults_and_takes_a_save(seed in any::<u32>(), marks in any::<[u8; 8]>()) {
        for (params, loaded) in [
            // F405 sectors, pages with and without the map's marks.
            lives_with::<1, { 16 * 1024 }>(noise(seed, 32 * 1024)),
            lives_with::<32, 2048>(noise(seed, 8192)),
            lives_with::<1, 1024>({
                let mut bytes = noise(seed, 4096);
                for (page, pair) in bytes.chunks_mut(1024).zip(marks.chunks(2)) {
                    page[0] = if pair[0] % 2 == 0 { 0xFF } else { 0x00 };
                    page[1023] = if pair[1] % 2 == 0 { 0xFF } else { 0x00 };
                }
                bytes
            }),
        ] {
            prop_assert_eq!(params, Params::default());
            prop_assert!(loaded.unreadable);
        }
    }

    #[test]
    fn flipped_bits_never_give_a_value_that_was_not_stored(
        saves in 1usize..60, flips in proptest::collection::vec(0usize..2048 * 8, 1..20),
    ) {
        let flash = Flash::<4, SMALL>::blank(4);
        let at = |i: usize| set(&[("infill", 4.0 + 0.1 * i as f32), ("rate_pitch_p", 5.0)]);
        for i in 0..saves {
            assert_eq!(save(&flash, at(i)), Ok(()));
        }
        let mut bytes = flash.0.borrow().bytes.clone();
        for flip in flips {
            bytes[flip / 8] ^= 1 << (flip % 8);
        }
        let (params, _) = lives_with::<4, SMALL>(bytes);
        prop_assert!(params == Params::default() || (0..saves).any(|i| params == at(i)));
    }
}

#[test]
fn a_board_with_defaults_of_its_own_stores_what_differs_from_those() {
    static CUAV: Params = Params {
        battery_divider: 18.0,
        battery_a_per_v: 24.0,
        ..Params::DEFAULT
    };
    let flash = Flash::<4, 4096>::blank(2);
    let (bytes, range) = (flash.clone(), flash.range());
    run(async move {
        let mut store = ParamStore::new(bytes.clone(), range).with_defaults(&CUAV);
        assert_eq!(*store.defaults(), CUAV);
        let mut params = CUAV;
        assert_eq!(store.load(&mut params).await, sound(0));
        assert_eq!(params, CUAV);
        assert_eq!(store.save(&CUAV).await, Ok(()));
        assert_eq!(bytes.0.borrow().steps, 0);
        // The table's defaults differ from the board's.
        let other = Params {
            infill: 8.0,
            battery_a_per_v: 40.0,
            ..CUAV
        };
        assert_eq!(store.save(&other).await, Ok(()));
        assert_eq!(store.load(&mut params).await, sound(2));
        assert_eq!(params, other);
        let steps = bytes.0.borrow().steps;
        assert_eq!(store.save(&other).await, Ok(()));
        assert_eq!(bytes.0.borrow().steps, steps, "the same again costs nothing");
        assert_eq!(store.save(&CUAV).await, Ok(()));
        assert_eq!(store.load(&mut params).await, sound(0));
        assert_eq!(params, CUAV);
    });
}
