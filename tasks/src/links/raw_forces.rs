//! The newest raw readings of the accelerometer, for a reader below the flight level.
//!
//! The writer takes three stores and an index, no lock and no wake-up. A reader that is more than 30 ms late may read axes of
//! two steps; that is one reading of the thousand in a second's RMS.

use core::sync::atomic::{AtomicU32, Ordering};

use sophie_control::maths::vector::Vec3;

/// Readings kept: three periods of the commander and what it may be late.
const KEPT: usize = 32;
/// Readings that a reader takes at most; the others may be written while it reads.
const TAKEN: u32 = 24;

/// One raw reading a millisecond, from one writer to one reader.
pub struct RawForces {
    rows: [[AtomicU32; 3]; KEPT],
    /// Readings written, modulo 2^32.
    written: AtomicU32,
}

impl Default for RawForces {
    fn default() -> Self {
        Self::new()
    }
}

impl RawForces {
    /// Without a reading.
    pub const fn new() -> Self {
        Self {
            rows: [const { [const { AtomicU32::new(0) }; 3] }; KEPT],
            written: AtomicU32::new(0),
        }
    }

    /// Writes the next reading: specific force, m/s², board axes.
    #[inline]
    pub fn push(&self, force: Vec3) {
        let written = self.written.load(Ordering::Relaxed);
        if let Some(row) = self.rows.get(written as usize % KEPT) {
            for (kept, axis) in row.iter().zip(force.to_array()) {
                kept.store(axis.to_bits(), Ordering::Relaxed);
            }
        }
        self.written.store(written.wrapping_add(1), Ordering::Release);
    }

    /// Number of the newest reading.
    pub fn newest(&self) -> u32 {
        self.written.load(Ordering::Acquire)
    }

    /// Passes the readings after `seen`, oldest first, to `f` and counts them there; those that were overwritten are left
    /// out.
    pub fn take(&self, seen: &mut u32, mut f: impl FnMut(Vec3)) {
        let written = self.newest();
        if written.wrapping_sub(*seen) > TAKEN {
            *seen = written.wrapping_sub(TAKEN);
        }
        while *seen != written {
            if let Some([x, y, z]) = self.rows.get(*seen as usize % KEPT) {
                let [x, y, z] = [x, y, z].map(|axis| f32::from_bits(axis.load(Ordering::Relaxed)));
                f(Vec3::new(x, y, z));
            }
            *seen = seen.wrapping_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;

    fn taken(forces: &RawForces, seen: &mut u32) -> Vec<f32> {
        let mut found = Vec::new();
        forces.take(seen, |force| {
            assert_eq!((force.y, force.z), (-force.x, 0.5));
            found.push(force.x);
        });
        found
    }

    #[test]
    fn a_reader_gets_each_reading_once_and_the_newest_if_it_was_late() {
        let forces = RawForces::new();
        let (mut seen, mut next) = (0, 0.0f32);
        let mut write = |count| {
            for _ in 0..count {
                forces.push(Vec3::new(next, -next, 0.5));
                next += 1.0;
            }
        };
        assert!(taken(&forces, &mut seen).is_empty());
        write(3);
        assert_eq!(taken(&forces, &mut seen), [0.0, 1.0, 2.0]);
        assert!(taken(&forces, &mut seen).is_empty());
        write(100);
        let newest: Vec<f32> = (79..103).map(|n| n as f32).collect();
        assert_eq!(taken(&forces, &mut seen), newest);
        write(1);
        assert_eq!(taken(&forces, &mut seen), [103.0]);
    }

    #[test]
    fn the_count_may_run_over() {
        let forces = RawForces::new();
        forces.written.store(u32::MAX, Ordering::Relaxed);
        let mut seen = u32::MAX;
        forces.push(Vec3::new(1.0, -1.0, 0.5));
        forces.push(Vec3::new(2.0, -2.0, 0.5));
        assert_eq!(taken(&forces, &mut seen), [1.0, 2.0]);
    }
}
