//! An image of one function.
#![no_std]
#![no_main]

firmware_image::main!(firmware_cases::single::fit_only);
