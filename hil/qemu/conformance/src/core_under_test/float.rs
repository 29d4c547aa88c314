//! Every floating-point instruction on critical operands, in every mode, with its flags.

use core::fmt::Arguments;

use cortex_m::register::fpscr::{self, Fpscr};

use sophie_conformance::fold::{Fold, Noise};

/// Zeros, subnormals, ends of the range, infinities, quiet and signalling NaNs, rounding halves, ends of the integers.
const AWKWARD: [u32; 32] = [
    0x0000_0000, // 0
    0x8000_0000, // -0
    0x0000_0001, // least subnormal
    0x8000_0001,
    0x007F_FFFF, // largest subnormal
    0x0080_0000, // least normal
    0x8080_0000,
    0x0100_0000,
    0x3F80_0000, // 1
    0xBF80_0000,
    0x3F80_0001, // 1 + epsilon
    0x3F7F_FFFF,
    0x3F00_0000, // 1/2
    0x3FC0_0000, // 3/2
    0xC020_0000, // -5/2
    0x4049_0FDB, // pi
    0x3EAA_AAAB, // 1/3
    0x4B7F_FFFF, // 2^24 - 1
    0x4B80_0000,
    0x4EFF_FFFF, // below 2^31
    0x4F00_0000, // 2^31
    0xCF00_0000,
    0x4F80_0000, // 2^32
    0x477F_E000, // largest half
    0x3380_0000, // least half
    0x7F7F_FFFF, // largest
    0xFF7F_FFFF,
    0x7F80_0000, // infinity
    0xFF80_0000,
    0x7FC0_1234, // quiet NaN with a payload
    0x7F80_5678, // signalling NaN
    0xFFA0_0001,
];
const RANDOM: usize = 16;
const OPERANDS: usize = AWKWARD.len() + RANDOM;

/// Rounding to nearest, up, down, to zero; each with subnormals kept or flushed, NaNs kept or replaced.
const ROUNDING: [(&str, u32); 4] = [("rn", 0), ("rp", 1), ("rm", 2), ("rz", 3)];
const ROUNDING_AT: u32 = 22;
const FLUSH: u32 = 1 << 24;
const DEFAULT_NAN: u32 = 1 << 25;
/// Flags of operations and of comparisons.
const LEFT: u32 = 0xF000_009F;

/// Operands and result are bits.
type Operation = unsafe extern "C" fn(a: u32, b: u32, c: u32) -> u32;

macro_rules! instructions {
    ($($name:ident: $($line:literal),+;)+) => {
        $(
            core::arch::global_asm!(
                ".syntax unified",
                ".thumb_func",
                concat!(".global conformance_", stringify!($name)),
                concat!("conformance_", stringify!($name), ":"),
                fpu!(),
                "vmov s0, r0",
                "vmov s1, r1",
                "vmov s2, r2",
                $($line,)+
                "bx lr",
            );
        )+
        unsafe extern "C" {
            $(
                #[link_name = concat!("conformance_", stringify!($name))]
                fn $name(a: u32, b: u32, c: u32) -> u32;
            )+
        }
        const LIST: &[(&str, Operation)] = &[$((stringify!($name), $name as Operation),)+];
    };
}

#[cfg(feature = "m7")]
macro_rules! fpu {
    () => {
        ".fpu fpv5-d16"
    };
}
#[cfg(not(feature = "m7"))]
macro_rules! fpu {
    () => {
        ".fpu fpv4-sp-d16"
    };
}

mod single {
    use super::Operation;

    instructions! {
        vadd: "vadd.f32 s3, s0, s1", "vmov r0, s3";
        vsub: "vsub.f32 s3, s0, s1", "vmov r0, s3";
        vmul: "vmul.f32 s3, s0, s1", "vmov r0, s3";
        vnmul: "vnmul.f32 s3, s0, s1", "vmov r0, s3";
        vdiv: "vdiv.f32 s3, s0, s1", "vmov r0, s3";
        vsqrt: "vsqrt.f32 s3, s0", "vmov r0, s3";
        vabs: "vabs.f32 s3, s0", "vmov r0, s3";
        vneg: "vneg.f32 s3, s0", "vmov r0, s3";
        vmla: "vmla.f32 s2, s0, s1", "vmov r0, s2";
        vmls: "vmls.f32 s2, s0, s1", "vmov r0, s2";
        vnmla: "vnmla.f32 s2, s0, s1", "vmov r0, s2";
        vnmls: "vnmls.f32 s2, s0, s1", "vmov r0, s2";
        vfma: "vfma.f32 s2, s0, s1", "vmov r0, s2";
        vfms: "vfms.f32 s2, s0, s1", "vmov r0, s2";
        vfnma: "vfnma.f32 s2, s0, s1", "vmov r0, s2";
        vfnms: "vfnms.f32 s2, s0, s1", "vmov r0, s2";
        vcmp: "vcmp.f32 s0, s1", "vmrs r0, fpscr";
        vcmpe: "vcmpe.f32 s0, s1", "vmrs r0, fpscr";
        vcmp_zero: "vcmp.f32 s0, #0.0", "vmrs r0, fpscr";
        to_s32: "vcvt.s32.f32 s3, s0", "vmov r0, s3";
        to_u32: "vcvt.u32.f32 s3, s0", "vmov r0, s3";
        to_s32_rounded: "vcvtr.s32.f32 s3, s0", "vmov r0, s3";
        to_u32_rounded: "vcvtr.u32.f32 s3, s0", "vmov r0, s3";
        from_s32: "vcvt.f32.s32 s3, s0", "vmov r0, s3";
        from_u32: "vcvt.f32.u32 s3, s0", "vmov r0, s3";
        to_fixed: "vcvt.s32.f32 s0, s0, #12", "vmov r0, s0";
        from_fixed: "vcvt.f32.u16 s0, s0, #4", "vmov r0, s0";
        to_half_bottom: "vmov s3, r1", "vcvtb.f16.f32 s3, s0", "vmov r0, s3";
        to_half_top: "vmov s3, r1", "vcvtt.f16.f32 s3, s0", "vmov r0, s3";
        from_half_bottom: "vcvtb.f32.f16 s3, s0", "vmov r0, s3";
        from_half_top: "vcvtt.f32.f16 s3, s0", "vmov r0, s3";
    }

    /// Instructions of every core with a floating-point unit.
    pub const ALL: &[(&str, Operation)] = LIST;
}

#[cfg(feature = "m7")]
mod fpv5 {
    use super::Operation;

    instructions! {
        vmaxnm: "vmaxnm.f32 s3, s0, s1", "vmov r0, s3";
        vminnm: "vminnm.f32 s3, s0, s1", "vmov r0, s3";
        vsel_ge: "vcmp.f32 s0, s1", "vmrs apsr_nzcv, fpscr", "vselge.f32 s3, s0, s2", "vmov r0, s3";
        vsel_vs: "vcmp.f32 s0, s1", "vmrs apsr_nzcv, fpscr", "vselvs.f32 s3, s0, s2", "vmov r0, s3";
        to_s32_away: "vcvta.s32.f32 s3, s0", "vmov r0, s3";
        to_s32_even: "vcvtn.s32.f32 s3, s0", "vmov r0, s3";
        to_u32_up: "vcvtp.u32.f32 s3, s0", "vmov r0, s3";
        to_u32_down: "vcvtm.u32.f32 s3, s0", "vmov r0, s3";
        round_away: "vrinta.f32 s3, s0", "vmov r0, s3";
        round_even: "vrintn.f32 s3, s0", "vmov r0, s3";
        round_exact: "vrintx.f32 s3, s0", "vmov r0, s3";
        round_zero: "vrintz.f32 s3, s0", "vmov r0, s3";
        // Doubles made of singles: the operands unchanged, and with a low half that needs rounding.
        double_add: "vcvt.f64.f32 d2, s0", "vmov d3, r0, r1", "vadd.f64 d2, d2, d3", "vmov r0, r1, d2", "eor r0, r1";
        double_mul: "vcvt.f64.f32 d2, s0", "vmov d3, r1, r0", "vmul.f64 d2, d2, d3", "vmov r0, r1, d2", "eor r0, r1";
        double_div: "vmov d2, r0, r1", "vmov d3, r2, r0", "vdiv.f64 d2, d2, d3", "vmov r0, r1, d2", "eor r0, r1";
        double_sqrt: "vmov d2, r0, r1", "vsqrt.f64 d2, d2", "vmov r0, r1, d2", "eor r0, r1";
        double_fma: "vmov d2, r0, r1", "vmov d3, r1, r2", "vmov d4, r2, r0", "vfma.f64 d2, d3, d4", "vmov r0, r1, d2", "eor r0, r1";
        double_to_single: "vmov d2, r0, r1", "vcvt.f32.f64 s3, d2", "vmov r0, s3";
        double_to_s32: "vmov d2, r0, r1", "vcvt.s32.f64 s3, d2", "vmov r0, s3";
        double_cmp: "vmov d2, r0, r1", "vmov d3, r1, r0", "vcmp.f64 d2, d3", "vmrs r0, fpscr";
        double_round: "vmov d2, r0, r1", "vrintr.f64 d2, d2", "vmov r0, r1, d2", "eor r0, r1";
    }

    /// Additional instructions of FPv5, double precision among them.
    pub const ALL: &[(&str, Operation)] = LIST;
}

pub fn run(print: &mut dyn FnMut(Arguments<'_>)) {
    let mut noise = Noise::new(4);
    let mut operands = [0; OPERANDS];
    for (i, operand) in operands.iter_mut().enumerate() {
        *operand = AWKWARD.get(i).copied().unwrap_or_else(|| noise.word());
    }
    let before = fpscr::read();
    for &(name, operation) in single::ALL {
        modes(print, name, operation, &operands);
    }
    #[cfg(feature = "m7")]
    for &(name, operation) in fpv5::ALL {
        modes(print, name, operation, &operands);
    }
    // SAFETY: restores the mode that the compiler's code relies on.
    unsafe { fpscr::write(before) };
}

fn modes(print: &mut dyn FnMut(Arguments<'_>), name: &str, operation: Operation, operands: &[u32]) {
    for (rounding, bits) in ROUNDING {
        let mut results = Fold::new();
        let mut flags = Fold::new();
        for special in [0, FLUSH, DEFAULT_NAN, FLUSH | DEFAULT_NAN] {
            let mode = bits << ROUNDING_AT | special;
            for (i, &a) in operands.iter().enumerate() {
                for (j, &b) in operands.iter().enumerate() {
                    // Fused instructions: one third operand per pair suffices.
                    let c = operands.get((7 * i + 3 * j) % OPERANDS).copied().unwrap_or(0);
                    let (result, left) = at(mode, operation, [a, b, c]);
                    results.add(result);
                    flags.add(left);
                }
            }
        }
        print(format_args!("{name} {rounding}: {results}, flags {flags}"));
    }
}

#[inline(never)]
fn at(mode: u32, operation: Operation, [a, b, c]: [u32; 3]) -> (u32, u32) {
    // SAFETY: any mode is allowed; until `run` restores it no other floating-point arithmetic is done.
    unsafe { fpscr::write(Fpscr::from_bits(mode)) };
    // SAFETY: the operations above use only registers that a call may change.
    let result = unsafe { operation(a, b, c) };
    (result, fpscr::read().bits() & LEFT)
}
