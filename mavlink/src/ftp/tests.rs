extern crate std;
use std::string::String;
use std::vec::Vec;

use proptest::prelude::*;

use super::*;

static LONG: [u8; 1000] = {
    let mut bytes = [0; 1000];
    let mut i = 0;
    while i < bytes.len() {
        bytes[i] = (i * 7 % 251) as u8;
        i += 1;
    }
    bytes
};
static FILES: [File; 3] = [
    File {
        path: "a.json",
        bytes: b"{}",
    },
    File {
        path: "long",
        bytes: &LONG,
    },
    File {
        path: "empty",
        bytes: b"",
    },
];

fn request(op: u8, session: u8, offset: u32, data: &[u8]) -> [u8; PAYLOAD] {
    let head = Head {
        sequence: 65_535,
        session,
        op,
        offset,
        ..Head::default()
    };
    head.with(data)
}

/// A read's size stands where others have the length of their data.
fn read(op: u8, session: u8, offset: u32, size: u8) -> [u8; PAYLOAD] {
    let mut payload = request(op, session, offset, &[]);
    payload[4] = size;
    payload
}

fn parts(payload: &[u8; PAYLOAD]) -> (Head, Vec<u8>) {
    let head = Head::of(payload);
    (head, payload[HEADER..HEADER + usize::from(head.size)].to_vec())
}

fn ask(payload: [u8; PAYLOAD]) -> (Head, Vec<u8>) {
    parts(&Ftp::new(&FILES).answer(&payload).unwrap())
}

fn refusal(payload: [u8; PAYLOAD]) -> u8 {
    let (head, data) = ask(payload);
    assert_eq!((head.op, head.size), (op::NAK, 1));
    data[0]
}

#[test]
fn a_file_is_opened_by_its_path_and_read_to_its_end() {
    for path in ["long", "/long", "long\0\0"] {
        let (head, size) = ask(request(op::OPEN_FILE_RO, 9, 0, path.as_bytes()));
        assert_eq!(
            (head.op, head.request, head.sequence),
            (op::ACK, op::OPEN_FILE_RO, 0)
        );
        assert_eq!((head.session, size), (1, 1000_u32.to_le_bytes().to_vec()));
    }
    let mut found = Vec::new();
    for offset in (0..1000).step_by(239) {
        let (head, data) = ask(read(op::READ_FILE, 1, offset, 239));
        assert_eq!((head.op, head.offset), (op::ACK, offset));
        found.extend(data);
    }
    assert_eq!(found, LONG);
    assert_eq!(
        refusal(read(op::READ_FILE, 1, 1000, 239)),
        Refusal::EndOfFile as u8
    );
    assert_eq!(
        refusal(read(op::READ_FILE, 1, u32::MAX, 239)),
        Refusal::EndOfFile as u8
    );
    assert_eq!(refusal(read(op::READ_FILE, 2, 0, 239)), Refusal::EndOfFile as u8);
}

#[test]
fn a_burst_has_the_whole_rest_and_says_where_it_ends() {
    let mut ftp = Ftp::new(&FILES);
    assert!(ftp.answer(&read(op::BURST_READ_FILE, 1, 300, 100)).is_none() && ftp.bursting());
    let mut found = Vec::new();
    let mut sequence = 0_u16;
    while let Some(payload) = ftp.piece() {
        let (head, data) = parts(&payload);
        assert_eq!(
            (head.op, head.request, head.session),
            (op::ACK, op::BURST_READ_FILE, 1)
        );
        assert_eq!((head.sequence, head.offset), (sequence, 300 + found.len() as u32));
        found.extend(data);
        sequence += 1;
        assert_eq!(head.burst_complete, found.len() == 700);
    }
    assert_eq!(found, LONG[300..]);
    assert!(!ftp.bursting());
    assert_eq!(
        refusal(read(op::BURST_READ_FILE, 1, 1000, 100)),
        Refusal::EndOfFile as u8
    );
}

#[test]
fn a_reader_that_leaves_ends_its_burst() {
    let mut ftp = Ftp::new(&FILES);
    assert!(ftp.answer(&read(op::BURST_READ_FILE, 1, 0, 0)).is_none());
    assert!(ftp.piece().is_some());
    assert!(ftp.answer(&request(op::TERMINATE_SESSION, 1, 0, &[])).is_some());
    assert!(ftp.piece().is_none());
}

#[test]
fn the_directory_is_listed_from_any_entry_on() {
    let (_, all) = ask(request(op::LIST_DIRECTORY, 0, 0, b"/"));
    assert_eq!(
        String::from_utf8(all).unwrap(),
        "Fa.json\t2\0Flong\t1000\0Fempty\t0\0"
    );
    let (_, rest) = ask(request(op::LIST_DIRECTORY, 0, 2, b""));
    assert_eq!(rest, b"Fempty\t0\0");
    assert_eq!(
        refusal(request(op::LIST_DIRECTORY, 0, 3, b"/")),
        Refusal::EndOfFile as u8
    );
    assert_eq!(
        refusal(request(op::LIST_DIRECTORY, 0, 0, b"/fs")),
        Refusal::FileNotFound as u8
    );
}

#[test]
fn what_would_change_a_file_is_refused_and_the_rest_by_the_protocols_own_numbers() {
    for op in op::CREATE_FILE..=op::RENAME {
        assert_eq!(
            refusal(request(op, 0, 0, b"a.json")),
            Refusal::FileProtected as u8
        );
    }
    assert_eq!(refusal(request(16, 0, 0, &[])), Refusal::UnknownCommand as u8);
    assert_eq!(
        refusal(request(op::OPEN_FILE_RO, 0, 0, b"none")),
        Refusal::FileNotFound as u8
    );
    assert_eq!(
        refusal(read(op::OPEN_FILE_RO, 0, 0, 240)),
        Refusal::InvalidDataSize as u8
    );
    assert_eq!(
        refusal(read(op::READ_FILE, 3, 0, 10)),
        Refusal::InvalidSession as u8
    );
}

#[test]
fn the_checksum_is_mavlinks() {
    // 0x2DFD2D88: pymavlink's crc32 of b"123456789" (zlib's of the same is 0xCBF43926: begun with and turned at the end).
    assert_eq!(crc32(b"123456789"), 0x2DFD_2D88);
    let (_, data) = ask(request(op::CALC_FILE_CRC32, 0, 0, b"long"));
    assert_eq!(data, crc32(&LONG).to_le_bytes());
}

proptest! {
    #[test]
    fn whatever_comes_in_is_answered_or_let_be(
        mut payload in prop::array::uniform32(any::<u8>()).prop_map(|head| {
            let mut payload = [0; PAYLOAD];
            payload[..32].copy_from_slice(&head);
            payload
        }),
        op in 0..20_u8,
    ) {
        payload[3] = op;
        let mut ftp = Ftp::new(&FILES);
        if let Some(answer) = ftp.answer(&payload) {
            let head = Head::of(&answer);
            prop_assert!(matches!(head.op, op::ACK | op::NAK) && head.request == op);
            prop_assert!(usize::from(head.size) <= DATA);
        }
        let pieces = std::iter::from_fn(|| ftp.piece()).take(2000).count();
        prop_assert!(pieces <= LONG.len());
    }
}
