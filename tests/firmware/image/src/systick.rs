//! Instructions by SysTick: QEMU, told to count one nanosecond an instruction, drives the timer
//! by the number of instructions run. The runner knows how many one tick is.

const CONTROL: *mut u32 = 0xE000_E010 as *mut u32;
const RELOAD: *mut u32 = 0xE000_E014 as *mut u32;
const CURRENT: *mut u32 = 0xE000_E018 as *mut u32;
const ENABLE_PROCESSOR_CLOCK: u32 = 0b101;
const WRAPPED: u32 = 1 << 16;
const LARGEST: u32 = 0x00FF_FFFF;

/// The ticks that `work` takes; `None` if the timer wrapped round.
pub fn ticks(work: &mut dyn FnMut()) -> Option<u32> {
    // SAFETY: SysTick's registers (Armv7-M and Armv6-M Architecture Reference Manuals, B3.3),
    // used by nothing else in this image.
    unsafe {
        RELOAD.write_volatile(LARGEST);
        CURRENT.write_volatile(0);
        CONTROL.write_volatile(ENABLE_PROCESSOR_CLOCK);
        // The timer loads its reload value with the first tick.
        while CURRENT.read_volatile() == 0 {}
        CONTROL.read_volatile();
        let before = CURRENT.read_volatile();
        work();
        let after = CURRENT.read_volatile();
        let wrapped = CONTROL.read_volatile() & WRAPPED != 0;
        CONTROL.write_volatile(0);
        if wrapped { None } else { Some(before.wrapping_sub(after)) }
    }
}
