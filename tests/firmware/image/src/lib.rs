//! A bare-metal image: start-up, words to the host by semihosting, SysTick, a serial line, a painted stack.
//!
//! A binary is `firmware_image::main!(function)`; everything here is free of panics, so that the
//! panic handler, which calls a function that does not exist, links only if `imu_core` is too.
#![no_std]

mod print;
mod semihosting;
mod stack;
mod startup;
mod systick;
mod uart;

pub use print::Printer;
pub use semihosting::exit;
pub use systick::Every;
pub use uart::Uart;

/// Makes a function the one that the image runs after reset; the image then leaves QEMU.
#[macro_export]
macro_rules! main {
    ($main:path) => {
        #[unsafe(no_mangle)]
        extern "C" fn image_main() -> ! {
            $main();
            $crate::exit(true)
        }
    };
}

#[cfg(not(feature = "find-panics"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe extern "C" {
        fn a_panic_is_reachable_from_imu_core() -> !;
    }
    // SAFETY: never linked: the function does not exist.
    unsafe { a_panic_is_reachable_from_imu_core() }
}

#[cfg(feature = "find-panics")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    exit(false)
}
