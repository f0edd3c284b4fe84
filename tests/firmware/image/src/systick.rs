//! Instructions by SysTick: QEMU, told to count one nanosecond an instruction, drives the timer
//! by the number of instructions run. The runner knows how many one tick is. Not told so, it keeps real time.

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

/// The timer as a clock that strikes, and owes those strokes for which nobody waited in time.
#[derive(Debug)]
pub struct Every {
    interval: u32,
    /// Ticks since the last stroke, and the counter's value then.
    elapsed: u32,
    before: u32,
}

impl Every {
    /// Strikes every so many ticks.
    #[must_use]
    pub fn ticks(interval: u32) -> Self {
        // SAFETY: as above.
        unsafe {
            RELOAD.write_volatile(LARGEST);
            CURRENT.write_volatile(0);
            CONTROL.write_volatile(ENABLE_PROCESSOR_CLOCK);
        }
        Self { interval, elapsed: 0, before: 0 }
    }

    /// Waits for the next stroke; to be called more often than the counter of 24 bits comes round.
    pub fn wait(&mut self) {
        while self.elapsed < self.interval {
            // SAFETY: as above. It counts down.
            let now = unsafe { CURRENT.read_volatile() };
            self.elapsed = self.elapsed.saturating_add(self.before.wrapping_sub(now) & LARGEST);
            self.before = now;
        }
        self.elapsed = self.elapsed.wrapping_sub(self.interval);
    }
}
