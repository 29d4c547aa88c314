//! Word copies, which the compiler calls for every message longer than 64 bytes.
//!
//! They replace the weak symbols of `compiler_builtins`: eight words in four instructions instead of one in five. The
//! rig compares all counts up to 32 words with every rest of bytes (`hil/rig/tests/rig/t11_copies.rs`).

use core::arch::global_asm;

// Run-time ABI for the Arm architecture (IHI 0043), §4.3.4: r0 to, r1 from, r2 bytes, both addresses word-aligned; r0
// to r3 and r12 are the callee's. Eight words a turn, then the rest by the bits of its length.
global_asm!(
    ".syntax unified",
    ".section .text.copy_words, \"ax\", %progbits",
    ".global __aeabi_memcpy4",
    ".global __aeabi_memcpy8",
    ".type __aeabi_memcpy4, %function",
    ".type __aeabi_memcpy8, %function",
    ".p2align 3",
    ".thumb_func",
    "__aeabi_memcpy4:",
    ".thumb_func",
    "__aeabi_memcpy8:",
    "subs r2, r2, #32",
    "blo 2f",
    "push {{r4-r10, lr}}",
    "1:",
    "ldmia r1!, {{r3-r10}}",
    "subs r2, r2, #32",
    "stmia r0!, {{r3-r10}}",
    "bhs 1b",
    "pop {{r4-r10, lr}}",
    // Carry: 16 bytes are left; negative: 8.
    "2:",
    "lsls r12, r2, #28",
    "bcc 3f",
    "ldrd r3, r12, [r1], #8",
    "strd r3, r12, [r0], #8",
    "ldrd r3, r12, [r1], #8",
    "strd r3, r12, [r0], #8",
    "3:",
    "bpl 4f",
    "ldrd r3, r12, [r1], #8",
    "strd r3, r12, [r0], #8",
    // Carry: 4 bytes; negative: 2.
    "4:",
    "lsls r2, r2, #30",
    "itt cs",
    "ldrcs r3, [r1], #4",
    "strcs r3, [r0], #4",
    "it eq",
    "bxeq lr",
    "itt mi",
    "ldrhmi r3, [r1], #2",
    "strhmi r3, [r0], #2",
    "lsls r2, r2, #1",
    "itt mi",
    "ldrbmi r3, [r1]",
    "strbmi r3, [r0]",
    "bx lr",
    ".size __aeabi_memcpy4, . - __aeabi_memcpy4",
    ".size __aeabi_memcpy8, . - __aeabi_memcpy8",
    ".text",
);
