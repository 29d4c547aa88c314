extern crate std;
use std::string::String;
use std::vec::Vec;

use proptest::prelude::*;

use crate::services::ftp::*;

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

const A: Peer = Peer {
    system: 255,
    component: 190,
};
const B: Peer = Peer {
    system: 254,
    component: 190,
};

fn ask(payload: [u8; PAYLOAD]) -> (Head, Vec<u8>) {
    let mut ftp = Ftp::new(&FILES);
    ftp.ask(A, &payload);
    let (to, answer) = ftp.answer().unwrap();
    assert_eq!(to, A);
    parts(&answer)
}

/// All that is due, in order.
fn due(ftp: &mut Ftp) -> Vec<(Peer, Head, Vec<u8>)> {
    let answers = std::iter::from_fn(|| ftp.answer());
    answers
        .map(|(to, payload)| {
            let (head, data) = parts(&payload);
            (to, head, data)
        })
        .collect()
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
        ErrorCode::EndOfFile as u8
    );
    assert_eq!(
        refusal(read(op::READ_FILE, 1, u32::MAX, 239)),
        ErrorCode::EndOfFile as u8
    );
    assert_eq!(
        refusal(read(op::READ_FILE, 2, 0, 239)),
        ErrorCode::EndOfFile as u8
    );
}

#[test]
fn a_burst_has_the_whole_rest_and_says_where_it_ends() {
    let mut ftp = Ftp::new(&FILES);
    ftp.ask(A, &read(op::BURST_READ_FILE, 1, 300, 100));
    let mut found = Vec::new();
    for (sequence, (to, head, data)) in (0_u16..).zip(due(&mut ftp)) {
        assert_eq!(
            (to, head.op, head.request, head.session),
            (A, op::ACK, op::BURST_READ_FILE, 1)
        );
        assert_eq!((head.sequence, head.offset), (sequence, 300 + found.len() as u32));
        found.extend(data);
        assert_eq!(head.burst_complete, found.len() == 700);
    }
    assert_eq!(found, LONG[300..]);
    assert_eq!(
        refusal(read(op::BURST_READ_FILE, 1, 1000, 100)),
        ErrorCode::EndOfFile as u8
    );
}

#[test]
fn a_reader_that_leaves_ends_its_burst_and_no_other_s() {
    for leave in [op::TERMINATE_SESSION, op::RESET_SESSIONS] {
        let mut ftp = Ftp::new(&FILES);
        for reader in [A, B] {
            ftp.ask(reader, &read(op::BURST_READ_FILE, 1, 0, 100));
        }
        assert_eq!(ftp.answer().map(|(to, _)| to), Some(A));
        ftp.ask(A, &request(leave, 1, 0, &[]));
        let left = due(&mut ftp);
        let of_a = left.iter().filter(|(to, ..)| *to == A);
        assert_eq!(of_a.map(|(_, head, _)| head.request).collect::<Vec<_>>(), [leave]);
        assert_eq!(left.iter().filter(|(to, ..)| *to == B).count(), 10);
    }
}

#[test]
fn a_burst_goes_to_who_asked_for_it_whatever_others_say() {
    let others = [
        request(op::LIST_DIRECTORY, 0, 0, b"/"),
        request(op::OPEN_FILE_RO, 0, 0, b"long"),
        read(op::READ_FILE, 1, 0, 10),
        request(op::ACK, 0, 0, &[]),
        request(op::NAK, 0, 0, &[1]),
        request(op::NONE, 0, 0, &[]),
        request(op::RESET_SESSIONS, 0, 0, &[]),
        read(op::BURST_READ_FILE, 1, 0, 0),
    ];
    for other in others {
        let mut ftp = Ftp::new(&FILES);
        ftp.ask(A, &read(op::BURST_READ_FILE, 1, 0, 100));
        let first = ftp.answer().unwrap();
        ftp.ask(B, &other);
        let rest = due(&mut ftp);
        let mut found = parts(&first.1).1;
        for (_, head, data) in rest.iter().filter(|(to, ..)| *to == A) {
            assert_eq!(
                (head.request, head.offset),
                (op::BURST_READ_FILE, found.len() as u32)
            );
            found.extend(data);
        }
        assert_eq!(found, LONG, "{}", other[3]);
        let of_b = rest.iter().filter(|(to, ..)| *to == B);
        assert!(of_b.clone().all(|(_, head, _)| head.request == other[3]));
        let answered = !matches!(other[3], op::ACK | op::NAK);
        assert_eq!(of_b.count() > 0, answered, "{}", other[3]);
    }
}

#[test]
fn any_number_of_readers_read_a_file_by_bursts_at_once() {
    let mut ftp = Ftp::new(&FILES);
    let readers = (1..=10).map(|system| Peer {
        system,
        component: 190,
    });
    let mut found: Vec<(Peer, Vec<u8>)> = readers.map(|reader| (reader, Vec::new())).collect();
    for (reader, _) in &found {
        ftp.ask(*reader, &read(op::BURST_READ_FILE, 1, 0, 0));
    }
    // As clients do: behind the last piece of a burst they ask for the rest, and after silence again.
    for _ in 0..1000 {
        match ftp.answer() {
            Some((to, payload)) => {
                let (head, data) = parts(&payload);
                let (_, bytes) = found.iter_mut().find(|(reader, _)| *reader == to).unwrap();
                assert_eq!(head.offset, bytes.len() as u32);
                bytes.extend(data);
                if head.burst_complete && bytes.len() < LONG.len() {
                    ftp.ask(to, &read(op::BURST_READ_FILE, 1, bytes.len() as u32, 0));
                }
            }
            None => {
                for (reader, bytes) in found.iter().filter(|(_, bytes)| bytes.len() < LONG.len()) {
                    ftp.ask(*reader, &read(op::BURST_READ_FILE, 1, bytes.len() as u32, 0));
                }
            }
        }
    }
    assert!(found.iter().all(|(_, bytes)| *bytes == LONG));
}

#[test]
fn a_reader_that_asks_again_and_again_leaves_room_for_others() {
    let mut ftp = Ftp::new(&FILES);
    for _ in 0..100 {
        ftp.ask(A, &read(op::BURST_READ_FILE, 1, 0, 0));
        ftp.ask(A, &read(op::READ_FILE, 1, 0, 0));
    }
    ftp.ask(B, &request(op::LIST_DIRECTORY, 0, 0, b"/"));
    let due = due(&mut ftp);
    assert_eq!(due.iter().filter(|(to, ..)| *to == B).count(), 1);
    assert_eq!(due.len(), 5 + 1 + 1);
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
        ErrorCode::EndOfFile as u8
    );
    assert_eq!(
        refusal(request(op::LIST_DIRECTORY, 0, 0, b"/fs")),
        ErrorCode::FileNotFound as u8
    );
}

#[test]
fn what_would_change_a_file_is_refused_and_the_rest_by_the_protocols_own_numbers() {
    for op in op::CREATE_FILE..=op::RENAME {
        assert_eq!(
            refusal(request(op, 0, 0, b"a.json")),
            ErrorCode::FileProtected as u8
        );
    }
    assert_eq!(refusal(request(16, 0, 0, &[])), ErrorCode::UnknownCommand as u8);
    assert_eq!(
        refusal(request(op::OPEN_FILE_RO, 0, 0, b"none")),
        ErrorCode::FileNotFound as u8
    );
    assert_eq!(
        refusal(read(op::OPEN_FILE_RO, 0, 0, 240)),
        ErrorCode::InvalidDataSize as u8
    );
    assert_eq!(
        refusal(read(op::READ_FILE, 3, 0, 10)),
        ErrorCode::InvalidSession as u8
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
        ftp.ask(A, &payload);
        let mut answers = 0;
        while let Some((_, answer)) = ftp.answer() {
            let head = Head::of(&answer);
            prop_assert!(matches!(head.op, op::ACK | op::NAK) && head.request == op);
            prop_assert!(usize::from(head.size) <= DATA);
            answers += 1;
        }
        prop_assert!((1..=LONG.len()).contains(&answers));
    }
}
