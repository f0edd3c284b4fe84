//! Runs every case and prints what it reports.
#![no_std]
#![no_main]

use firmware_cases::CASES;
use firmware_image::Printer;

firmware_image::main!(run);

fn run() {
    let mut printer = Printer::new();
    for case in CASES {
        printer.case(case.name);
        (case.run)(&mut printer);
        printer.end();
    }
    printer.text("done");
    printer.line();
}
