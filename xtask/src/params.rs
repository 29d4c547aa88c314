//! Checks that flashing keeps the parameter flash.

use crate::boards::{Board, Sectors};
use crate::image::{Image, Load};
use crate::{Error, dfu};

/// Checks that flashing does not erase the parameters' sectors; returns their bytes, 0 if stored elsewhere.
///
/// # Errors
/// Part of the image lies there: its address.
pub fn check(board: &Board, image: &Image) -> Result<u64, Error> {
    let (Ok(start), Ok(end)) = (image.symbol("_params_start"), image.symbol("_params_end")) else {
        return Ok(0);
    };
    match first_in(&image.loads, board.flash, start, end) {
        Some(load) => Err(format!(
            "{} bytes at {:#010x} lie in the sectors of the parameters' flash ({start:#010x} to {end:#010x})",
            load.size(),
            load.address
        )
        .into()),
        None => Ok(end - start),
    }
}

fn first_in<'a>(loads: &'a [Load], flash: &[Sectors], start: u64, end: u64) -> Option<&'a Load> {
    let erased = |address| dfu::sector(flash, address).unwrap_or((address, address + 1));
    loads.iter().filter(|load| load.size() > 0).find(|load| {
        let (first, _) = erased(load.address);
        let (_, beyond) = erased(load.address + load.size() - 1);
        first < end && beyond > start
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards;

    #[test]
    fn what_shares_a_sector_with_parameters_is_found_and_what_ends_before_it_is_not() {
        let flash = boards::find("f405").unwrap().flash;
        let load = |address, size| Load {
            address,
            bytes: vec![0; size],
        };
        for (address, size, inside) in [
            (0x0800_0000, 0x4000, false),
            (0x0800_0000, 0x4001, true),
            (0x0800_BFFF, 1, true),
            (0x0800_C000, 1, false),
            (0x0800_0000, 0xC000, true),
        ] {
            let loads = [load(0x0800_C000, 8), load(address, size)];
            assert_eq!(
                first_in(&loads, flash, 0x0800_4000, 0x0800_C000).is_some(),
                inside,
                "{address:#x} {size:#x}"
            );
            let found = first_in(&loads, flash, 0x0801_8000, 0x0802_0000).is_some();
            assert!(!found, "{address:#x} {size:#x}");
        }
        let loads = [load(0x0801_0000, 8)];
        assert!(first_in(&loads, flash, 0x0801_8000, 0x0802_0000).is_some());
    }
}
