//! Stack use: paint the free stack, do the work, look how far down the paint is gone.

use core::arch::asm;

const PAINT: u32 = 0x5AC3_A53C;
/// How far down the paint goes, in words: 64 KB.
const DEPTH: usize = 16 * 1024;
/// Left unpainted just below the stack pointer: room for this module's own calls, in words.
const MARGIN: usize = 32;

/// The bytes of stack below the caller's that `work` takes; `None` at 64 KB and beyond.
///
/// Rounded up to the margin: nothing below 128 bytes is told apart.
#[inline(never)]
pub fn bytes(work: &mut dyn FnMut()) -> Option<usize> {
    let top: *mut u32;
    // SAFETY: reads the stack pointer.
    unsafe { asm!("mov {}, sp", out(reg) top, options(nomem, nostack)) };
    // SAFETY: memory below the stack pointer, inside the 1 MB that the linker script leaves the
    // stack, less what the image has used; no interrupt is enabled.
    unsafe {
        for word in MARGIN..DEPTH {
            top.sub(word).write_volatile(PAINT);
        }
        work();
        let mut deepest = DEPTH;
        while deepest >= MARGIN && top.sub(deepest - 1).read_volatile() == PAINT {
            deepest -= 1;
        }
        if deepest == DEPTH { None } else { Some(4 * deepest) }
    }
}
