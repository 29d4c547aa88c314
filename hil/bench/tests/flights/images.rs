use super::*;

/// The complaint about an image with `bytes`.
fn refused(name: &str, bytes: &[u8]) -> String {
    let path = std::env::temp_dir().join(format!("sophie-image-{}-{name}", std::process::id()));
    std::fs::write(&path, bytes).unwrap();
    let told = Firmware::read(&path).err().unwrap_or_default();
    std::fs::remove_file(&path).unwrap();
    assert!(!told.contains('\n') && told.contains(name), "{told}");
    told
}

#[test]
fn what_is_no_image_of_the_board_is_refused_in_one_line() {
    assert!(refused("text", b"no program").contains("is no ELF file"));
    let host = std::fs::read(std::env::current_exe().unwrap()).unwrap();
    assert!(refused("host", &host).contains("not for a 32-bit Arm"));
    let missing = Firmware::read(Path::new("/nowhere/image.elf")).err().unwrap();
    assert!(
        missing.contains("/nowhere/image.elf: cannot be read"),
        "{missing}"
    );

    let good = std::fs::read(image()).unwrap();
    assert!(Firmware::read(image()).is_ok());
    assert!(!refused("half", &good[..good.len() / 2]).is_empty());
    // The names of symbols and sections, made unreadable one at a time.
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
