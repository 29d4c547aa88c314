//! Effect of an instruction on stack pointer and control flow, by its encoding (ARMv7-M, DDI 0403E, A5 to A7).

/// Control flow of an instruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flow {
    /// To the next alone.
    Next,
    /// Here or to the next.
    Branch(u64),
    /// Here alone.
    Jump(u64),
    /// To a function that comes back.
    Call(u64),
    /// The same, by an address in a register.
    CallRegister,
    /// To an address in a register, not back.
    JumpRegister,
    /// By a table behind it, of entries of this many bytes.
    Table(u64),
    /// Return to the caller, or end of execution.
    End,
}

/// Effect of an instruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect {
    /// Length, 2 or 4 bytes.
    pub bytes: u64,
    /// Bytes that the stack grows by; negative: shrinks.
    pub grows: i64,
    pub flow: Flow,
    /// Instructions after it that are executed on a condition (IT).
    pub conditional: u8,
}

const SP: u16 = 13;
const LR: u16 = 14;
const PC: u16 = 15;

impl Effect {
    const fn plain(bytes: u64) -> Self {
        Self {
            bytes,
            grows: 0,
            flow: Flow::Next,
            conditional: 0,
        }
    }

    const fn flow(bytes: u64, flow: Flow) -> Self {
        Self {
            flow,
            ..Self::plain(bytes)
        }
    }

    const fn grows(bytes: u64, grows: i64) -> Self {
        Self {
            grows,
            ..Self::plain(bytes)
        }
    }

    /// Registers taken from the stack, with the program counter or without.
    const fn pops(bytes: u64, words: u32, returns: bool) -> Self {
        Self {
            grows: -4 * words as i64,
            flow: if returns { Flow::End } else { Flow::Next },
            ..Self::plain(bytes)
        }
    }

    /// Of two halfwords at `at`; the second is the next instruction's after a short one. `None`: it changes the stack by
    /// a register's value.
    pub fn of(at: u64, first: u16, second: u16) -> Option<Self> {
        if first >> 11 >= 0b11101 {
            long(at, first, second)
        } else {
            short(at, first)
        }
    }
}

/// `at` and the pipeline's 4 bytes, with a signed offset of `bits` bits in half words.
fn target(at: u64, offset: u32, bits: u32) -> u64 {
    let offset = (offset << (32 - bits)) as i32 >> (32 - bits);
    at.wrapping_add(4).wrapping_add_signed(2 * i64::from(offset))
}

fn short(at: u64, i: u16) -> Option<Effect> {
    let low = u32::from(i & 0xFF);
    Some(match i >> 8 {
        // PUSH, POP.
        0xB4 | 0xB5 => Effect::grows(2, 4 * i64::from((i & 0x1FF).count_ones())),
        0xBC | 0xBD => Effect::pops(2, (i & 0x1FF).count_ones(), i >> 8 & 1 == 1),
        // ADD and SUB of the stack pointer.
        0xB0 if i & 0x80 == 0 => Effect::grows(2, -4 * i64::from(i & 0x7F)),
        0xB0 => Effect::grows(2, 4 * i64::from(i & 0x7F)),
        // IT.
        0xBF if i & 0xF != 0 => Effect {
            conditional: 4 - (i & 0xF).trailing_zeros() as u8,
            ..Effect::plain(2)
        },
        // CBZ, CBNZ.
        0xB1 | 0xB3 | 0xB9 | 0xBB => {
            let offset = u64::from(i >> 9 & 1) << 6 | u64::from(i >> 3 & 0x1F) << 1;
            Effect::flow(2, Flow::Branch(at + 4 + offset))
        }
        // BKPT, UDF.
        0xBE | 0xDE => Effect::flow(2, Flow::End),
        0xD0..=0xDD => Effect::flow(2, Flow::Branch(target(at, low, 8))),
        0xE0..=0xE7 => Effect::flow(2, Flow::Jump(target(at, u32::from(i & 0x7FF), 11))),
        // BX, BLX.
        0x47 if i >> 7 & 1 == 1 => Effect::flow(2, Flow::CallRegister),
        0x47 if i >> 3 & 0xF == LR => Effect::flow(2, Flow::End),
        0x47 => Effect::flow(2, Flow::JumpRegister),
        // ADD, MOV of any registers. A stack pointer that is moved back ends a frame.
        0x44 | 0x46 => match i >> 4 & 8 | i & 7 {
            PC => Effect::flow(2, Flow::JumpRegister),
            SP if i >> 8 == 0x44 => return None,
            _ => Effect::plain(2),
        },
        _ => Effect::plain(2),
    })
}

fn long(at: u64, first: u16, second: u16) -> Option<Effect> {
    let words = second.count_ones();
    let [rt, byte] = [second >> 12, second & 0xFF];
    Some(match first {
        // STMDB and LDMIA of the stack; STR and LDR of one register.
        0xE92D => Effect::grows(4, 4 * i64::from(words)),
        0xE8BD => Effect::pops(4, words, second >> 15 == 1),
        0xF84D if second & 0x0F00 == 0x0D00 => Effect::grows(4, byte.into()),
        0xF85D if second & 0x0F00 == 0x0B00 => Effect::pops(4, u32::from(byte) / 4, rt == PC),
        // LDR of the program counter.
        _ if first & 0xFF70 == 0xF850 && rt == PC => Effect::flow(4, Flow::JumpRegister),
        // STRD and LDRD.
        0xE96D => Effect::grows(4, 4 * i64::from(byte)),
        0xE8FD => Effect::grows(4, -4 * i64::from(byte)),
        // VPUSH, VPOP.
        0xED2D | 0xED6D if second & 0x0E00 == 0x0A00 => Effect::grows(4, 4 * i64::from(byte)),
        0xECBD | 0xECFD if second & 0x0E00 == 0x0A00 => Effect::grows(4, -4 * i64::from(byte)),
        // SUB and ADD of the stack pointer and a constant, which is modified or plain; from another register they end a frame.
        _ if second & 0x8F00 == 0x0D00 && matches!(first & 0xFBEF, 0xF1AD | 0xF10D) => {
            let value = modified(first, second);
            Effect::grows(4, if first & 0x00A0 == 0x00A0 { value } else { -value })
        }
        _ if second & 0x8F00 == 0x0D00 && matches!(first & 0xFBFF, 0xF2AD | 0xF20D) => {
            let value = i64::from(immediate(first, second));
            Effect::grows(4, if first & 0x00A0 == 0x00A0 { value } else { -value })
        }
        // SUB and ADD of the stack pointer and a register.
        0xEBAD | 0xEB0D if second >> 8 & 0xF == SP => return None,
        // TBB, TBH.
        _ if first & 0xFFF0 == 0xE8D0 && second & 0xFFE0 == 0xF000 => {
            Effect::flow(4, Flow::Table(1 + u64::from(second >> 4 & 1)))
        }
        // Branches and BL.
        _ if first >> 11 == 0b11110 && second >> 15 == 1 => branch(at, first, second),
        _ => Effect::plain(4),
    })
}

fn branch(at: u64, first: u16, second: u16) -> Effect {
    let [first, second] = [u32::from(first), u32::from(second)];
    let (sign, j1, j2) = (first >> 10 & 1, second >> 13 & 1, second >> 11 & 1);
    let low = second & 0x7FF;
    if second >> 12 & 1 == 0 {
        // Under a condition; others in its place are hints, barriers and special registers, and UDF.
        return match first >> 6 & 0xF {
            0xE | 0xF if first & 0xFFF0 == 0xF7F0 => Effect::flow(4, Flow::End),
            0xE | 0xF => Effect::plain(4),
            _ if second >> 14 & 1 == 1 => Effect::plain(4),
            _ => {
                let offset = sign << 19 | j2 << 18 | j1 << 17 | (first & 0x3F) << 11 | low;
                Effect::flow(4, Flow::Branch(target(at, offset, 20)))
            }
        };
    }
    let [i1, i2] = [j1, j2].map(|j| !(j ^ sign) & 1);
    let offset = sign << 23 | i1 << 22 | i2 << 21 | (first & 0x3FF) << 11 | low;
    let to = target(at, offset, 24);
    Effect::flow(
        4,
        if second >> 14 & 1 == 1 {
            Flow::Call(to)
        } else {
            Flow::Jump(to)
        },
    )
}

/// The twelve bits of a constant.
fn immediate(first: u16, second: u16) -> u32 {
    u32::from(first >> 10 & 1) << 11 | u32::from(second >> 12 & 7) << 8 | u32::from(second & 0xFF)
}

/// A modified constant (A5.3.2); a constant of repeated bytes is never a frame's size.
fn modified(first: u16, second: u16) -> i64 {
    let bits = immediate(first, second);
    match bits >> 10 {
        0 => i64::from(bits & 0xFF),
        _ => i64::from((0x80 | bits & 0x7F).rotate_right(bits >> 7)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: u64 = 0x0800_C000;

    fn does(what: &str, code: [u16; 2], grows: i64, flow: Flow) {
        let [first, second] = code;
        let effect = Effect::of(AT, first, second).unwrap();
        assert_eq!((effect.grows, effect.flow), (grows, flow), "{what}");
    }

    #[test]
    fn the_stack_grows_and_shrinks_as_the_manual_says() {
        does("push {r4-r7, lr}", [0xB5F0, 0], 20, Flow::Next);
        does("push.w {r8-r11}", [0xE92D, 0x0F00], 16, Flow::Next);
        does("str r4, [sp, #-4]!", [0xF84D, 0x4D04], 4, Flow::Next);
        does("strd r0, r1, [sp, #-8]!", [0xE96D, 0x0102], 8, Flow::Next);
        does("vpush {d8, d9}", [0xED2D, 0x8B04], 16, Flow::Next);
        does("sub sp, #100", [0xB099, 0], 100, Flow::Next);
        does("sub.w sp, sp, #17792", [0xF5AD, 0x4D8B], 17792, Flow::Next);
        does("subw sp, sp, #1028", [0xF2AD, 0x4D04], 1028, Flow::Next);
        does("add sp, #100", [0xB019, 0], -100, Flow::Next);
        does("add.w sp, sp, #17792", [0xF50D, 0x4D8B], -17792, Flow::Next);
        does("addw sp, sp, #1028", [0xF20D, 0x4D04], -1028, Flow::Next);
        does("pop {r4, pc}", [0xBD10, 0], -8, Flow::End);
        does("pop.w {r8, r9, r10}", [0xE8BD, 0x0700], -12, Flow::Next);
        does("ldr pc, [sp], #4", [0xF85D, 0xFB04], -4, Flow::End);
        does("vpop {d8}", [0xECBD, 0x8B02], -8, Flow::Next);
        does("adds r0, #1", [0x3001, 0], 0, Flow::Next);
        does("sub.w r4, r7, #16", [0xF1A7, 0x0410], 0, Flow::Next);
        assert_eq!(Effect::of(AT, 0xEBAD, 0x0D00), None, "sub.w sp, sp, r0");
    }

    #[test]
    fn branches_lead_where_the_manual_says() {
        does("bl -4", [0xF7FF, 0xFFFE], 0, Flow::Call(AT));
        does("bl far ahead", [0xF048, 0xF800], 0, Flow::Call(AT + 4 + 0x4_8000));
        does("b.w", [0xF7FF, 0xBFFE], 0, Flow::Jump(AT));
        does("beq.w", [0xF000, 0x8001], 0, Flow::Branch(AT + 6));
        does("bne", [0xD1FC, 0], 0, Flow::Branch(AT - 4));
        does("b", [0xE7FE, 0], 0, Flow::Jump(AT));
        does("cbz r0, 8", [0xB110, 0], 0, Flow::Branch(AT + 8));
        does("blx r3", [0x4798, 0], 0, Flow::CallRegister);
        does("bx r3", [0x4718, 0], 0, Flow::JumpRegister);
        does("bx lr", [0x4770, 0], 0, Flow::End);
        does("tbb [pc, r0]", [0xE8DF, 0xF000], 0, Flow::Table(1));
        does("tbh [pc, r0]", [0xE8DF, 0xF010], 0, Flow::Table(2));
        does("udf", [0xDE00, 0], 0, Flow::End);
        does("dsb", [0xF3BF, 0x8F4F], 0, Flow::Next);
        does("mrs r0, msp", [0xF3EF, 0x8008], 0, Flow::Next);
        assert_eq!(Effect::of(AT, 0xBF08, 0).unwrap().conditional, 1, "it eq");
        assert_eq!(Effect::of(AT, 0xBF06, 0).unwrap().conditional, 3, "itte eq");
    }
}
