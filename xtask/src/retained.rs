//! Checks that retained data lie in memory that survives resets, untouched by loading and start-up.

use crate::Error;
use crate::boards::Board;
use crate::image::Image;

const SECTION: &str = ".retained";

/// Checks the place of retained data; returns their bytes.
///
/// # Errors
/// The data are missing, misplaced or written by flashing.
pub fn check(board: &Board, image: &Image) -> Result<u64, Error> {
    let section = image.sections.iter().find(|section| section.name == SECTION);
    let section = section.ok_or("the image has nothing that outlives a reset")?;
    let (start, end) = board.retained;
    let (first, beyond) = (section.address, section.address + section.size);
    if first < start || beyond > end {
        return Err(format!(
            "what outlives a reset lies at {first:#010x} to {beyond:#010x}, {} keeps {start:#010x} to {end:#010x}",
            board.name
        )
        .into());
    }
    if section.in_image {
        return Err("what outlives a reset has contents in the image".into());
    }
    // Start-up clears .bss and fills .data.
    for (begin, end) in [("__sbss", "__ebss"), ("__sdata", "__edata")] {
        let (from, to) = (image.symbol(begin)?, image.symbol(end)?);
        if from < to && from < beyond && to > first {
            return Err(format!(
                "start-up writes {from:#010x} to {to:#010x} (`{begin}`), where what outlives a reset lies"
            )
            .into());
        }
    }
    Ok(section.size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards;
    use crate::image::Section;

    /// The error for 0x184 bytes at `address` while start-up clears from `bss` on.
    fn complaint(address: u64, in_image: bool, bss: (u64, u64)) -> Option<String> {
        let symbols = [
            ("__sbss", bss.0),
            ("__ebss", bss.1),
            ("__sdata", 0),
            ("__edata", 0),
        ];
        let image = Image {
            sections: vec![Section {
                name: SECTION.into(),
                address,
                size: 0x184,
                in_image,
                writable: true,
            }],
            symbols: symbols.map(|(name, at)| (name.to_string(), at)).into(),
            ..Image::default()
        };
        let board = boards::find("matek-h743").unwrap();
        check(board, &image).err().map(|e| e.to_string())
    }

    #[test]
    fn what_outlives_a_reset_lies_where_nothing_writes() {
        let (place, elsewhere) = (0x2001_FC00, (0x2400_0000, 0x2400_7000));
        assert_eq!(complaint(place, false, elsewhere), None);
        for (address, in_image, bss, words) in [
            (0x2400_0000, false, elsewhere, "lies at 0x24000000"),
            (place + 0x300, false, elsewhere, "lies at 0x2001ff00"),
            (place, true, elsewhere, "has contents"),
            (place, false, (0x2000_8000, 0x2002_0000), "start-up writes"),
            (place, false, (place, place + 4), "start-up writes"),
        ] {
            let complaint = complaint(address, in_image, bss).unwrap_or_default();
            assert!(complaint.contains(words), "{address:#x}: {complaint}");
        }
    }
}
