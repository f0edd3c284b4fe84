//! Semihosting calls to QEMU (Arm "Semihosting for AArch32 and AArch64", 2.0).

use core::arch::asm;

const SYS_WRITE0: u32 = 0x04;
const SYS_EXIT: u32 = 0x18;
const APPLICATION_EXIT: u32 = 0x2_0026;
const RUN_TIME_ERROR: u32 = 0x2_0023;

fn call(operation: u32, argument: u32) {
    // SAFETY: semihosting traps to QEMU, which returns to the next instruction and changes r0 only.
    unsafe {
        asm!("bkpt 0xab", inout("r0") operation => _, in("r1") argument, options(nostack));
    }
}

/// Writes text up to its first zero byte; writes nothing if it has none.
pub fn write(text: &[u8]) {
    if text.contains(&0) {
        call(SYS_WRITE0, text.as_ptr() as u32);
    }
}

/// Leaves QEMU, with exit code 0 if `success`.
pub fn exit(success: bool) -> ! {
    let reason = if success { APPLICATION_EXIT } else { RUN_TIME_ERROR };
    loop {
        call(SYS_EXIT, reason);
    }
}
