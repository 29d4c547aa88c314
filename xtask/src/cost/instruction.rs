//! Cycles of a Cortex-M4 (FPU) instruction by its encoding: ARM DDI 0439B, tables 3-1 and 7-1; encodings of ARMv7-M
//! (DDI 0403E, A5), as far as they determine the time.

/// Fewest and most cycles after a taken branch.
const REFILL: [u32; 2] = [1, 3];

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instruction {
    /// Length, 2 or 4 bytes.
    pub bytes: u64,
    /// Fewest and most cycles if no branch is taken.
    pub cycles: [u32; 2],
    /// Reads a constant between instructions, thus from flash.
    pub constant: bool,
}

impl Instruction {
    /// Of two halfwords; the second is the next instruction's after a short one.
    pub fn of(first: u16, second: u16) -> Self {
        if first >> 11 >= 0b11101 {
            let (cycles, constant) = long(first, second);
            Self {
                bytes: 4,
                cycles,
                constant,
            }
        } else {
            let (cycles, constant) = short(first);
            Self {
                bytes: 2,
                cycles,
                constant,
            }
        }
    }

    /// Fewest and most cycles, with the refill if `taken`.
    pub fn cycles(&self, taken: bool) -> [u32; 2] {
        let [least, most] = self.cycles;
        let [quick, slow] = if taken { REFILL } else { [0, 0] };
        [least + quick, most + slow]
    }
}

/// A load or store of a word shares its second cycle with a neighbour of its kind.
const SINGLE: [u32; 2] = [1, 2];
const PLAIN: [u32; 2] = [1, 1];

const fn several(registers: u32) -> [u32; 2] {
    [1 + registers, 1 + registers]
}

fn short(i: u16) -> ([u32; 2], bool) {
    match i >> 11 {
        // LDR from the constants; loads and stores by register, offset and stack pointer.
        0b01001 => (SINGLE, true),
        0b01010..=0b10011 => (SINGLE, false),
        // STM, LDM.
        0b11000 | 0b11001 => (several((i & 0xFF).count_ones()), false),
        // PUSH, POP.
        0b10110 | 0b10111 if i >> 9 & 0b11 == 0b10 => (several((i & 0x1FF).count_ones()), false),
        // IT, which may fold into the instruction before.
        0b10111 if i >> 8 == 0xBF && i & 0xF != 0 => ([0, 1], false),
        _ => (PLAIN, false),
    }
}

fn long(first: u16, second: u16) -> ([u32; 2], bool) {
    // The group: bits 12 to 9 of the first halfword, and some below.
    match first >> 9 & 0xF {
        0b0100 if first >> 6 & 1 == 1 => {
            // LDRD, STRD; TBB and TBH, which load before they branch.
            let table = first & 0xFFF0 == 0xE8D0 && second & 0xFFE0 == 0xF000;
            (if table { [2, 2] } else { several(2) }, false)
        }
        0b0100 => (several(second.count_ones()), false),
        0b0110 | 0b0111 | 0b1110 | 0b1111 => float(first, second),
        // Single loads and stores; base PC is a constant.
        0b1100 => (SINGLE, first & 0xF == 0xF),
        // SDIV, UDIV.
        0b1101 if first & 0xFFD0 == 0xFB90 && second & 0xF0 == 0xF0 => ([2, 12], false),
        _ => (PLAIN, false),
    }
}

fn float(first: u16, second: u16) -> ([u32; 2], bool) {
    // Two core registers: VMOV.
    if first & 0xFFE0 == 0xEC40 {
        return ([2, 2], false);
    }
    if first & 0xFE00 == 0xEC00 {
        let words = u32::from(second & 0xFF);
        // VLDR and VSTR have an offset without write-back; several registers take a cycle each.
        let single = first >> 8 & 1 == 1 && first >> 5 & 1 == 0;
        let double = second >> 8 & 1 == 1;
        return match (single, double) {
            (true, false) => (SINGLE, first & 0xF == 0xF),
            (true, true) => (several(2), first & 0xF == 0xF),
            (false, _) => (several(words), false),
        };
    }
    // Moves between core and FPU, VMRS.
    if second >> 4 & 1 == 1 {
        return (PLAIN, false);
    }
    // A cycle more if the next instruction uses the result.
    let with_use = |cycles| ([cycles, cycles + 1], false);
    match (first >> 7 & 1, first >> 4 & 0b11) {
        // VMLA, VMLS, VNMLA, VNMLS; VMUL; VADD, VSUB.
        (0, 0b00 | 0b01) => with_use(3),
        (0, _) => with_use(1),
        // VDIV; VFNMA, VFNMS, VFMA, VFMS.
        (1, 0b00) => with_use(14),
        (1, 0b01 | 0b10) => with_use(3),
        // VSQRT; others of one operand take a cycle.
        (_, _) if first & 0xF == 1 && second >> 6 & 0b11 == 0b11 => with_use(14),
        _ => with_use(1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn takes(what: &str, code: [u16; 2], bytes: u64, expected: [u32; 2], constant: bool) {
        let [first, second] = code;
        let instruction = Instruction {
            bytes,
            cycles: expected,
            constant,
        };
        assert_eq!(Instruction::of(first, second), instruction, "{what}");
    }

    #[test]
    fn instructions_take_what_the_manual_says() {
        takes("adds r0, #1", [0x3001, 0], 2, [1, 1], false);
        takes("ldr r0, [pc, #4]", [0x4801, 0], 2, [1, 2], true);
        takes("ldr r0, [r1, #4]", [0x6848, 0], 2, [1, 2], false);
        takes("str r0, [sp, #4]", [0x9001, 0], 2, [1, 2], false);
        takes("push {r4, r5, lr}", [0xB530, 0], 2, [4, 4], false);
        takes("pop {r4, pc}", [0xBD10, 0], 2, [3, 3], false);
        takes("sub sp, #8", [0xB082, 0], 2, [1, 1], false);
        takes("it eq", [0xBF08, 0], 2, [0, 1], false);
        takes("nop", [0xBF00, 0], 2, [1, 1], false);
        takes("bne", [0xD1FC, 0], 2, [1, 1], false);
        takes("bl", [0xF7FF, 0xFFFE], 4, [1, 1], false);
        takes("mov.w r0, #1", [0xF04F, 0x0001], 4, [1, 1], false);
        takes("ldr.w r0, [pc, #8]", [0xF8DF, 0x0008], 4, [1, 2], true);
        takes("ldr.w r0, [r8, #8]", [0xF8D8, 0x0008], 4, [1, 2], false);
        takes("ldrd r0, r1, [r2]", [0xE9D2, 0x0100], 4, [3, 3], false);
        takes("stmdb sp!, {r4-r8, lr}", [0xE92D, 0x41F0], 4, [7, 7], false);
        takes("udiv r0, r1, r2", [0xFBB1, 0xF0F2], 4, [2, 12], false);
        takes("mul r0, r1, r2", [0xFB01, 0xF002], 4, [1, 1], false);
        takes("vldr s0, [r0, #4]", [0xED90, 0x0A01], 4, [1, 2], false);
        takes("vldr s0, [pc, #4]", [0xED9F, 0x0A01], 4, [1, 2], true);
        takes("vstr d8, [sp]", [0xED8D, 0x8B00], 4, [3, 3], false);
        takes("vpush {d8, d9}", [0xED2D, 0x8B04], 4, [5, 5], false);
        takes("vldmia r0, {s0, s1, s2}", [0xEC90, 0x0A03], 4, [4, 4], false);
        takes("vmov r0, r1, d0", [0xEC51, 0x0B10], 4, [2, 2], false);
        takes("vmov s0, r0", [0xEE00, 0x0A10], 4, [1, 1], false);
        takes("vmrs apsr_nzcv, fpscr", [0xEEF1, 0xFA10], 4, [1, 1], false);
        takes("vadd.f32 s0, s1, s2", [0xEE30, 0x0A81], 4, [1, 2], false);
        takes("vmul.f32 s0, s1, s2", [0xEE20, 0x0A81], 4, [1, 2], false);
        takes("vmla.f32 s0, s1, s2", [0xEE00, 0x0A81], 4, [3, 4], false);
        takes("vfma.f32 s0, s1, s2", [0xEEA0, 0x0A81], 4, [3, 4], false);
        takes("vfnms.f32 s0, s1, s2", [0xEE90, 0x0A81], 4, [3, 4], false);
        takes("vdiv.f32 s0, s1, s2", [0xEE80, 0x0A81], 4, [14, 15], false);
        takes("vsqrt.f32 s0, s1", [0xEEB1, 0x0AE0], 4, [14, 15], false);
        takes("vneg.f32 s0, s1", [0xEEB1, 0x0A60], 4, [1, 2], false);
        takes("vcmp.f32 s0, s1", [0xEEB4, 0x0A60], 4, [1, 2], false);
    }

    #[test]
    fn a_branch_that_is_taken_fills_the_pipeline_anew() {
        let bne = Instruction::of(0xD1FC, 0);
        assert_eq!([bne.cycles(false), bne.cycles(true)], [[1, 1], [2, 4]]);
    }
}
