use super::*;

fn refused(name: &str, bytes: &[u8]) -> String {
    let path = std::env::temp_dir().join(format!("sophie-image-{}-{name}", std::process::id()));
    std::fs::write(&path, bytes).unwrap();
    let board = board_kind::find("matek-h743").unwrap();
    let complaint = Firmware::read(&path, board).err().unwrap_or_default();
    std::fs::remove_file(&path).unwrap();
    assert!(
        !complaint.contains('\n') && complaint.contains(name),
        "{complaint}"
    );
    complaint
}

#[test]
fn an_image_of_another_board_or_none_is_refused_in_one_line() {
    assert!(refused("text", b"no program").contains("is no ELF file"));
    let host = std::fs::read(std::env::current_exe().unwrap()).unwrap();
    assert!(refused("host", &host).contains("not for a 32-bit Arm"));
    let board = board_kind::find("matek-h743").unwrap();
    let missing = Firmware::read(Path::new("/nowhere/image.elf"), board)
        .err()
        .unwrap();
    assert!(
        missing.contains("/nowhere/image.elf: cannot be read"),
        "{missing}"
    );

    let good = std::fs::read(image()).unwrap();
    assert!(Firmware::read(image(), board).is_ok());
    assert!(!refused("half", &good[..good.len() / 2]).is_empty());
    for (name, wanted) in [
        ("_SEGGER_RTT", "has no log"),
        (".vector_table", "has no vector table"),
        ("matek-h743", "does not call itself matek-h743"),
    ] {
        let mut bad = good.clone();
        let name = name.as_bytes();
        for at in 0..bad.len() - name.len() {
            if bad[at..].starts_with(name) {
                bad[at + 1] = b'#';
            }
        }
        assert!(refused("nameless", &bad).contains(wanted));
    }
}

#[test]
fn an_image_of_another_board_is_refused() {
    let complaint = Firmware::read(small_image(), board_kind::find("matek-h743").unwrap())
        .err()
        .unwrap();
    assert!(complaint.contains("where an STM32H743 has no RAM"), "{complaint}");
    let complaint = Firmware::read(image(), board_kind::find("f405").unwrap())
        .err()
        .unwrap();
    assert!(
        complaint.contains("wanted is what `cargo xtask firmware f405` builds"),
        "{complaint}"
    );
}

#[test]
fn an_image_that_a_loader_jumps_to_takes_its_vectors_from_its_own_table() {
    for (path, board) in [(image(), "matek-h743"), (small_image(), "f405")] {
        let mut firmware = Firmware::read(path, board_kind::find(board).unwrap()).unwrap();
        firmware.behind_a_loader().unwrap();
        let flight = fly_image(&firmware, &hover(5.0), 1.0, &[]);
        let log = log(&flight);
        assert!(logged_at(&flight, 0.0, "DISARMED").is_some(), "{board}\n{log}");
        assert!(
            flight.board.resets.is_empty(),
            "{board}: {:?}\n{log}",
            flight.board.resets
        );
    }
}
