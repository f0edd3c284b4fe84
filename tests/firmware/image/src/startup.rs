//! Reset and faults: the vector table, the FPU switched on, memory initialised.

use core::arch::global_asm;

// The vector table (Armv7-M Architecture Reference Manual, B1.5.3): the initial stack pointer,
// reset, and for every other exception the fault handler.
global_asm!(
    ".section .vectors, \"a\"",
    ".global vectors",
    "vectors:",
    ".word stack_top",
    ".word reset",
    ".rept 14",
    ".word fault",
    ".endr",
);

// CPACR (0xE000ED88): full access to coprocessors 10 and 11, the FPU, before any code that uses it.
#[cfg(target_abi = "eabihf")]
global_asm!(
    ".section .text.reset, \"ax\"",
    ".global reset",
    ".thumb_func",
    "reset:",
    "ldr r0, =0xE000ED88",
    "ldr r1, [r0]",
    "ldr r2, =0x00F00000",
    "orr r1, r1, r2",
    "str r1, [r0]",
    "dsb",
    "isb",
    "bl initialise",
    ".ltorg",
);

#[cfg(not(target_abi = "eabihf"))]
global_asm!(
    ".section .text.reset, \"ax\"",
    ".global reset",
    ".thumb_func",
    "reset:",
    "bl initialise"
);

// The fault handler passes the stacked frame on: r0-r3, r12, lr, pc, xpsr.
global_asm!(
    ".section .text.fault, \"ax\"",
    ".global fault",
    ".thumb_func",
    "fault:",
    "mov r0, sp",
    "bl report_fault",
);

unsafe extern "C" {
    static mut data_start: u32;
    static mut data_end: u32;
    static data_image: u32;
    static mut bss_start: u32;
    static mut bss_end: u32;
    fn image_main() -> !;
}

#[unsafe(no_mangle)]
unsafe extern "C" fn initialise() -> ! {
    // SAFETY: the linker script defines these bounds, word-aligned, of memory that nothing else
    // uses before `image_main`. Volatile accesses keep the loops loops.
    unsafe {
        let mut from = &raw const data_image;
        let mut to = &raw mut data_start;
        while to < &raw mut data_end {
            to.write_volatile(from.read_volatile());
            from = from.add(1);
            to = to.add(1);
        }
        let mut to = &raw mut bss_start;
        while to < &raw mut bss_end {
            to.write_volatile(0);
            to = to.add(1);
        }
        image_main()
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn report_fault(frame: *const u32) -> ! {
    // SAFETY: the exception entry pushed eight words; the seventh is the program counter.
    let pc = unsafe { frame.add(6).read_volatile() };
    let mut printer = crate::Printer::new();
    printer.text("fault ");
    printer.hex(u64::from(pc), 8);
    printer.line();
    crate::exit(false)
}
