//! The flash that is kept for parameters: flashing a firmware must leave it alone.

use crate::Error;
use crate::image::{Image, Load};

/// Checks that nothing is loaded where parameters are stored; returns how many bytes are kept, none where the board
/// stores them elsewhere.
///
/// # Errors
/// Part of the image lies there: its address.
pub fn check(image: &Image) -> Result<u64, Error> {
    let (Ok(start), Ok(end)) = (image.symbol("_params_start"), image.symbol("_params_end")) else {
        return Ok(0);
    };
    match first_in(&image.loads, start, end) {
        Some(load) => Err(format!(
            "{} bytes at {:#010x} lie in the parameters' flash ({start:#010x} to {end:#010x})",
            load.size, load.address
        )
        .into()),
        None => Ok(end - start),
    }
}

fn first_in(loads: &[Load], start: u64, end: u64) -> Option<&Load> {
    loads
        .iter()
        .find(|load| load.address < end && load.address + load.size > start)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_touches_the_range_is_found_and_what_ends_before_it_is_not() {
        let load = |address, size| Load { address, size };
        for (address, size, inside) in [
            (0x000, 0x100, false),
            (0x000, 0x101, true),
            (0x1FF, 1, true),
            (0x200, 1, false),
            (0x000, 0x300, true),
        ] {
            let loads = [load(0x400, 8), load(address, size)];
            assert_eq!(
                first_in(&loads, 0x100, 0x200).is_some(),
                inside,
                "{address:#x} {size:#x}"
            );
        }
    }
}
